"""Forecasters: each module is one kind, found by its name."""
