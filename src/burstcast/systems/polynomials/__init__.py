"""Polynomial equations learnt from series."""
