"""Ensembles, training series, noise, event thresholds, measured series, delays."""
