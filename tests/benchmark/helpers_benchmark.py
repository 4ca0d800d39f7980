"""Files of forecasts for a case of the benchmark."""

import netCDF4
import numpy as np

HEAD = "# case=small case_version=3f seed=2026"


def write_netcdf(path, facts, **variables):
    """Write arrays with their dimensions: name = (dimensions, array)."""
    with netCDF4.Dataset(path, "w") as file:
        file.setncatts(facts)
        for name, (dimensions, array) in variables.items():
            for dimension, length in zip(dimensions, np.shape(array), strict=True):
                if dimension not in file.dimensions:
                    file.createDimension(dimension, length)
            kind = np.asarray(array).dtype
            file.createVariable(name, kind, dimensions, fill_value=False)[...] = array
    return path


def write_csv(path, header, rows, head=HEAD, separator=","):
    lines = [separator.join(f"{value:.17g}" for value in row) for row in rows]
    path.write_text("\n".join([head, header, *lines, ""]), encoding="utf-8")
    return path


def table(array, first=(0, 0)):
    """Rows of a CSV file: all indices, then the value."""
    indices = np.indices(array.shape).reshape(array.ndim, -1).T
    offsets = [0] * (array.ndim - 2) + list(first)
    return np.column_stack([indices + offsets, array.ravel()])
