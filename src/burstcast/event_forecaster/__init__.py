"""The library in a notebook: `burstcast.event_forecaster.forecaster.EventForecaster`."""
