"""Validation strategies: Single Shot and Recycle Validation."""
