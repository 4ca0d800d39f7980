"""The paper's control: forecasts in windows, alarms, and their outcomes."""
