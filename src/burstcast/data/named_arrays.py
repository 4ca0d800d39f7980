"""The door of arrays: what xarray opens or holds becomes runs by one check.

Dimensions are called series, time and component, in any order; one that is missing has one entry,
but for time. Variables, or the entries of component, are what columns are in a table.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from burstcast.base.arrays import AXES, FloatArray, float_array
from burstcast.data.measured_data import Content, Run
from burstcast.data.series_layout import LabelledRun, labels_of
from burstcast.data.times import TIME, TimesError, times_in, with_units


class NamedArrays:
    """Variables of a data set, or an array, of xarray."""

    def __init__(self, source: str, data: Any) -> None:
        #: whether components have names of their own
        self.has_labels = "component" in data.coords or "component" not in data.dims
        if not hasattr(data, "data_vars"):
            self.has_labels &= "component" in data.dims or data.name not in (None, *AXES)
            name = "c1" if data.name in (None, *AXES) else str(data.name)
            data = data.to_dataset(name=name)
        self.source, self.variables = source, data.variables
        _check_coordinates(source, data)
        #: for each component, its variable, and its place along the dimension of components
        self.columns: dict[str, tuple[str, int]] = {}
        #: variables with times that no component can be: "wind (time, latitude)"
        self.fields: list[str] = []
        for name, variable in self.variables.items():
            axes = set(variable.dims)
            if name in AXES or name in data.coords or TIME not in axes:
                continue
            if not axes <= set(AXES):
                if not _has_bounds(name):
                    self.fields.append(f"{name} ({', '.join(map(str, variable.dims))})")
                continue
            labels = self._labels(variable.sizes["component"]) if "component" in axes else [name]
            for number, label in enumerate(labels):
                if label in self.columns:
                    raise ValueError(
                        f"{source} has {label!r} in {self.columns[label][0]} and in {name}: keep "
                        f"one of them"
                    )
                self.columns[label] = name, number
        if not self.columns:
            listed = ", ".join(
                f"{name} ({', '.join(map(str, variable.dims))})"
                for name, variable in self.variables.items()
            )
            raise ValueError(
                f"{source} has no variable with the dimensions {', '.join(AXES)} or some of them; "
                f"it has {listed or 'none'}: rename them (.rename of xarray)"
            )

    def _labels(self, count: int) -> list[str]:
        """Names of components."""
        if "component" not in self.variables:
            return [f"c{number}" for number in range(1, count + 1)]
        return list(labels_of(self.variables["component"].values))

    def states(self, names: Sequence[str]) -> FloatArray:
        """Some components, ``(series, time, component)``; what is missing is NaN."""
        columns = [self.columns[name] for name in names]
        arrays = {name: self._ordered(name) for name in dict.fromkeys(name for name, _ in columns)}
        values = [arrays[name][:, :, number] for name, number in columns]
        shape = max(map(len, values)), values[0].shape[1]
        return np.stack([np.broadcast_to(column, shape) for column in values], axis=2)

    def _ordered(self, name: str) -> FloatArray:
        """A variable as ``(series, time, component)``; outside its valid range it is NaN."""
        variable = self.variables[name]
        values = float_array(_in_order(variable), f"{self.source}, {name}")
        if not values.size:
            raise ValueError(f"{self.source}, {name} is empty: its shape is {variable.shape}")
        of, stored = variable.attrs, variable.encoding
        limits = of.get("valid_range", (of.get("valid_min", -np.inf), of.get("valid_max", np.inf)))
        low, high = stored.get("scale_factor", 1.0) * np.asarray(limits, dtype=np.float64)
        offset = stored.get("add_offset", 0.0)
        return np.where((values < low + offset) | (values > high + offset), np.nan, values)

    def times(self, unit: str | None) -> FloatArray | None:
        """Times ``(series or 1, time)``, in the unit of the time step if it has one."""
        if TIME not in self.variables:
            return None
        try:
            time = _without_zone(self.variables[TIME])
            values = _in_order(time if unit is None else with_units(time, unit))[:, :, 0]
            return times_in(values.ravel(), unit).reshape(values.shape)
        except TimesError as error:
            raise ValueError(f"{self.source}: {TIME!r} {error}") from None

    def labelled_runs(self) -> list[LabelledRun]:
        """All components of each series, with their labels and times where there are any."""
        self.content().check_all_taken()
        states, names, times, dated = self.states(list(self.columns)), None, None, False
        units = self._units()
        if self.has_labels:
            names = tuple(map(str, self.columns))
        if TIME in self.variables:
            time = _without_zone(self.variables[TIME])
            dated = time.dtype.kind not in "iuf" or bool(time.attrs.get("units"))
            times = self.times("second" if dated else None)
        if times is None:
            return [LabelledRun(names, series, units=units) for series in states]
        rows = np.broadcast_to(times, (len(states), times.shape[1]))
        return [
            LabelledRun(names, series, time, dated, units)
            for series, time in zip(states, rows, strict=True)
        ]

    def _units(self) -> tuple[str, ...]:
        """Units of all components, by the attribute ``units`` of their variables."""
        return tuple(
            str(self.variables[name].attrs.get("units", "")).strip()
            for name, _ in self.columns.values()
        )

    def runs(self, names: Sequence[str], unit: str | None) -> list[Run]:
        """Runs of the series, each up to its last sample: one of several may end with NaN."""
        states, times = self.states(names), self.times(unit)
        if len(states) == 1:
            return [self._run(self.source, names, states[0], None if times is None else times[0])]
        runs = []
        for row, series in enumerate(states):
            (there,) = np.nonzero(~np.isnan(series).all(axis=1))
            stop = there[-1] + 1 if there.size else len(series)
            time = None if times is None else times[min(row, len(times) - 1)][:stop]
            runs.append(self._run(f"{self.source}, series {row + 1}", names, series[:stop], time))
        return runs

    def _run(
        self, source: str, names: Sequence[str], states: FloatArray, time: FloatArray | None
    ) -> Run:
        columns = dict(zip(names, states.T, strict=True))
        units = dict(zip(self.columns, self._units(), strict=True))
        return Run(source, columns if time is None else {**columns, TIME: time}, units)

    def content(self) -> Content:
        """What there is to read."""
        return Content(self.source, list(self.columns), self.runs, tuple(self.fields))


def _has_bounds(name: Any) -> bool:
    """Whether a variable has the bounds of the cells of a coordinate, by the names that CF has."""
    return str(name).endswith(("_bnds", "_bounds"))


def _without_zone(time: Any) -> Any:
    """Times of xarray, with those of a time zone in UTC."""
    if isinstance(time.dtype, np.dtype):
        return time
    index = time.to_index()
    if getattr(index, "tz", None) is not None:
        index = index.tz_convert("UTC").tz_localize(None)
    return type(time)(time.dims, np.asarray(index), time.attrs)


def _check_coordinates(source: str, data: Any) -> None:
    """Check that no other coordinate than ``time`` has the times of the samples."""
    for name, coordinate in data.coords.items():
        if coordinate.dims == (TIME,) and name != TIME and TIME not in data.coords:
            raise ValueError(
                f"{source} has the coordinate {name!r} along its dimension {TIME!r}, which has no "
                f"times itself: make it the coordinate of times "
                f"(.assign_coords(time={name!r} values)), or drop it (.drop_vars({name!r}))"
            )


def _in_order(variable: Any) -> Any:
    return variable.set_dims({axis: variable.sizes.get(axis, 1) for axis in AXES}).values
