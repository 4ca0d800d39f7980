"""Monitors: the forecast or observation that raises an alarm."""
