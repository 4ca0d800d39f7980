"""Gather the hyperparameters of all networks."""

from collections.abc import Sequence

from burstcast.base.declared import declaring, gathered
from burstcast.networks.scan import leak_rate_of
from burstcast.tables.makers.registry import Gathered, Rows

NAMES = ("spectral_radius", "input_scaling", "tikhonov", "objective", "solver")


@declaring
def make(
    *, hyperparameters: Sequence[Gathered] = gathered("searched_networks/hyperparameters.json")
) -> dict[str, Rows]:
    """One row for each network; leak rates where any network leaks."""
    rows = []
    leaking = any("leak_rate" in file.content for file in hyperparameters)
    for file in hyperparameters:
        row = {**file.name.keys, **{name: file.content[name] for name in NAMES}}
        rows.append({**row, "leak_rate": leak_rate_of(file.content)} if leaking else row)
    return {"hyperparameters": rows}
