"""burstcast: forecasting and control of extreme events in chaotic flows."""


def __getattr__(name: str) -> object:
    """Load what a notebook begins with when it is asked for: ``import burstcast`` loads nothing."""
    if name == "EventForecaster":
        from burstcast.event_forecaster.forecaster import EventForecaster

        return EventForecaster
    if name == "open_campaign":
        # a campaign's files are the workflow's, of which the library itself knows nothing
        from burstcast_workflow.opened import open_campaign

        return open_campaign
    raise AttributeError(f"module 'burstcast' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*globals(), "EventForecaster", "open_campaign"])
