"""The configuration: its model, its checks, its cases, and how it is loaded."""

from burstcast_workflow.config.cases import block_cases, case_name, case_record, case_records
from burstcast_workflow.config.loading import ConfigError, duplicated_keys, load

__all__ = [
    "ConfigError",
    "block_cases",
    "case_name",
    "case_record",
    "case_records",
    "duplicated_keys",
    "load",
]
