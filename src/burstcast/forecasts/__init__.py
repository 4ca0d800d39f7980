"""Forecasts of events: windows, classification, the prediction horizon, examples."""
