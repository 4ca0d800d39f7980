"""The version of the harness, which stands for it in the fingerprint of every job."""

HARNESS_VERSION = 1
"""Raised when a change of this package changes what a job writes: then all jobs run again."""
