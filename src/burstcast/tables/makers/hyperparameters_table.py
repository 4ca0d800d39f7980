"""Gather the hyperparameters of all networks."""

from collections.abc import Sequence

from burstcast.tables.makers.registry import Declaration, Gathered, Rows

TABLES = Declaration(gathered={"hyperparameters": ""})

NAMES = ("spectral_radius", "input_scaling", "tikhonov", "objective", "solver")


def make(*, hyperparameters: Sequence[Gathered]) -> dict[str, Rows]:
    """One row for each network."""
    rows = [
        {**one.name.keys, **{name: one.content[name] for name in NAMES}} for one in hyperparameters
    ]
    return {"hyperparameters": rows}
