"""The version of the harness, which stands for it in the fingerprint of every job."""

HARNESS_VERSION = 3
"""Raised when this package, or what writes files in `burstcast.base.files`, changes written files.

All jobs run again then. The digests of what each version makes of fixed inputs are in
tests/workflow/test_harness_files.py.
"""
