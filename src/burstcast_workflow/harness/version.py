"""The version of the harness, which stands for it in the fingerprint of every job."""

HARNESS_VERSION = 3
"""Raised when this package or `burstcast.files.netcdf` changes written files: all jobs run again.

The digests of what each version makes of fixed inputs are in tests/workflow/test_written_files.py.
"""
