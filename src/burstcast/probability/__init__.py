"""Probabilities of events: calibration, Brier scores, alarms, lead times, committees."""
