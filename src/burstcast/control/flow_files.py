"""Control as files: what happened in each flow, and densities of the observable."""

import dataclasses

from burstcast.control.counts import FlowCounts
from burstcast.control.records import FlowRecords
from burstcast.files.netcdf import Variable
from burstcast.files.units import NUMBER, OBSERVABLE, POWER

# of `FlowRecords`: per unit of time; all others are counts
_ENERGIES = ("input", "dissipation")


def flow_variables(records: FlowRecords, first: int) -> dict[str, Variable]:
    """Variables of the records of flows.

    Parameters
    ----------
    records
        Of the flows.
    first
        Row of the first of the given flows' series in the ensemble.
    """
    which = "row of the series in the ensemble"
    return {
        "series": Variable(("flow",), first + records.row, NUMBER, which),
        **{
            field.name: Variable(
                ("flow",),
                getattr(records, field.name),
                POWER if field.name.startswith(_ENERGIES) else NUMBER,
                field.name.replace("_", " "),
            )
            for field in dataclasses.fields(records)
        },
    }


def histogram_variables(counts: FlowCounts) -> dict[str, Variable]:
    """Variables of the histograms of the observable."""
    samples = {
        "uncontrolled": "without control",
        "controlled": "with control",
        "free": "with control, outside actuation",
    }
    return {
        "edge": Variable(("edge",), counts.edges, OBSERVABLE, "edges of the bins"),
        **{
            name: Variable(
                ("bin",), getattr(counts, f"histogram_{name}"), NUMBER, f"steps, {meaning}"
            )
            for name, meaning in samples.items()
        },
    }
