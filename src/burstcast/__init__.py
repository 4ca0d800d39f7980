"""burstcast: forecasting and control of extreme events in chaotic flows."""


def __getattr__(name: str) -> object:
    """Load what is exported on first access: ``import burstcast`` loads nothing."""
    if name == "EventForecaster":
        from burstcast.event_forecaster.forecaster import EventForecaster

        return EventForecaster
    if name == "control_system":
        from burstcast.event_forecaster.closed_loop import control_system

        return control_system
    if name == "__version__":
        from importlib.metadata import version

        return version("burstcast")
    raise AttributeError(f"module 'burstcast' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*globals(), "EventForecaster", "__version__", "control_system"])
