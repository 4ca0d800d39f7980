"""Probes that measure the velocity of a plane flow at the points of a regular grid."""

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol, runtime_checkable

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.data.observation.base import Observation

_UNSEEN = 1e-9
"""Largest reading of a component that no sensor sees, as a share of the largest of all."""


@runtime_checkable
class PlaneFlow(Protocol):
    """A periodic flow in a plane, whose velocity is linear in its state."""

    @property
    def dimension(self) -> int:
        """Number of components of a state."""

    @property
    def domain(self) -> tuple[float, float]:
        """Periods along x and y."""

    def velocity(self, state: FloatArray, points: FloatArray) -> FloatArray:
        """Velocities (u, v) of states at points ``(points, 2)``: ``(2, points, ...)``."""


@dataclass(frozen=True)
class VelocitySensors(Observation):
    """Velocities u and v at the points of a grid.

    Examples
    --------
    >>> class SineFlow:
    ...     dimension, domain = 1, (2 * np.pi, 2 * np.pi)
    ...
    ...     def velocity(self, state, points):
    ...         u = np.multiply.outer(np.sin(points[:, 1]), state[0])
    ...         return np.stack([u, np.zeros_like(u)])
    >>> sensors = VelocitySensors(SineFlow(), (8, 4))
    >>> sensors.matrix.shape
    (64, 1)
    """

    flow: PlaneFlow  #: its domain is covered by the grid
    points: tuple[int, int] = (8, 8)  #: sensors along x and y, at equal distances
    #: coordinates of the first sensor: a grid that begins at the origin can miss a force that is
    #: zero at all its points, as sin(4 y) is at multiples of pi / 4
    offset: tuple[float, float] = (0.31, 0.17)

    def __post_init__(self) -> None:
        if min(self.points) < 1:
            raise ValueError(f"points must be at least 1 in each direction, not {self.points}")
        for axis, start, number, period in zip(
            "xy", self.offset, self.points, self.flow.domain, strict=True
        ):
            last = start + (number - 1) * period / number
            if not (start >= 0.0 and last < period):
                raise ValueError(
                    f"{number} sensors along {axis} from {start:g} on reach {last:.4g}, but the "
                    f"domain is 0 to {period:.4g}: offset must lie between 0 and the distance of "
                    f"two sensors, {period / number:.4g}"
                )

    @cached_property
    def coordinates(self) -> FloatArray:
        """Coordinates (x, y) of all sensors, ``(sensors, 2)``."""
        lines = [
            start + np.arange(number) * period / number
            for start, number, period in zip(
                self.offset, self.points, self.flow.domain, strict=True
            )
        ]
        return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 2)

    @property
    def channels(self) -> tuple[str, ...]:
        """Names by component and place in the grid: "u_0_3"."""
        places = [f"{x}_{y}" for x in range(self.points[0]) for y in range(self.points[1])]
        return tuple(f"{component}_{place}" for component in "uv" for place in places)

    @cached_property
    def matrix(self) -> FloatArray:
        """Velocities of each component of a state, ``(2 * sensors, dimension)``: u, then v."""
        units = np.eye(self.flow.dimension)
        return self.flow.velocity(units, self.coordinates).reshape(-1, self.flow.dimension)

    @property
    def unseen(self) -> list[int]:
        """Components of a state of which no sensor measures anything, counted from 0."""
        largest = np.abs(self.matrix).max(axis=0)
        return np.flatnonzero(largest <= _UNSEEN * largest.max()).tolist()
