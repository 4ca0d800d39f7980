"""Evaluations of a search as files: a table of their records, and their errors beside it."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from burstcast.base.files.netcdf import Variable, read_netcdf
from burstcast.base.files.units import NUMBER
from burstcast.networks.scan import Evaluation


def log_error_variables(evaluations: Sequence[Evaluation]) -> dict[str, Variable]:
    """Variables of the errors in each interval, by row of the table; filled up with NaN."""
    log_errors = [evaluation.validation.log_errors for evaluation in evaluations]
    errors = np.full((len(log_errors), max(map(len, log_errors))), np.nan)
    for row, of_row in zip(errors, log_errors, strict=True):
        row[: len(of_row)] = of_row
    meaning = "log10 of the mean square error of the observable in each interval"
    return {"log_error": Variable(("row", "interval"), errors, NUMBER, meaning)}


def read_evaluations(rows: Sequence[Mapping[Any, Any]], log_errors: str) -> list[Evaluation]:
    """Evaluations from the rows of their table, and the file of `log_error_variables`."""
    errors = read_netcdf(log_errors, "log_error")["log_error"]
    return [
        Evaluation.restore(row, tuple(of_row[~np.isnan(of_row)].tolist()))
        for row, of_row in zip(rows, errors, strict=True)
    ]
