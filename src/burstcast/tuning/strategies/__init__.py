"""Validation strategies: Single Shot, Recycle and Walk Forward Validation."""
