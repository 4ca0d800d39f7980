"""The workflow around burstcast: a campaign's config, its jobs, and its results."""


def __getattr__(name: str) -> object:
    """Load ``open_campaign`` on first access: ``import burstcast_workflow`` loads nothing."""
    if name == "open_campaign":
        from burstcast_workflow.opened import open_campaign

        return open_campaign
    raise AttributeError(f"module 'burstcast_workflow' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*globals(), "open_campaign"])
