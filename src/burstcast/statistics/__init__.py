"""Densities, profiles, long runs, survival, bootstrap intervals, exponents from data."""
