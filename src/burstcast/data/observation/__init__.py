"""Sensors: partial and noisy observations of the state of a flow."""
