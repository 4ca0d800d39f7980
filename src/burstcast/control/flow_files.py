"""Files of control: records of each flow, and densities of the observable."""

import dataclasses

from burstcast.control.cost import ActuationCost
from burstcast.control.counts import FlowCounts
from burstcast.control.records import FlowRecords
from burstcast.files.netcdf import Variable
from burstcast.files.units import COMPONENT, NUMBER, OBSERVABLE, POWER

# of `FlowRecords`: per unit of time; all others are counts
_ENERGIES = ("input", "dissipation")


def flow_variables(
    records: FlowRecords, first: int, cost: ActuationCost | None = None
) -> dict[str, Variable]:
    """Variables of the records of flows.

    Parameters
    ----------
    records
        Records of the flows.
    first
        Row of the first of the given flows' series in the ensemble.
    cost
        Cost of the actuation; None: it is not recorded.
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
        **({} if cost is None else _cost_variables(cost)),
    }


def _cost_variables(cost: ActuationCost) -> dict[str, Variable]:
    effort = "mean length of the force that acts as the actuation"
    power = "mean energy that this force puts in or takes out"
    return {
        "effort": Variable(("flow",), cost.effort, COMPONENT, effort),
        "power": Variable(("flow",), cost.power, POWER, power),
    }


def histogram_variables(counts: FlowCounts) -> dict[str, Variable]:
    """Variables of the histograms of the observable, of each flow that counts."""
    samples = {
        "uncontrolled": "without control",
        "controlled": "with control",
        "free": "with control, outside actuation",
    }
    return {
        "edge": Variable(("edge",), counts.edges, OBSERVABLE, "edges of the bins"),
        "row": Variable(("flow",), counts.row, NUMBER, "row of the flow among those given"),
        **{
            name: Variable(
                ("flow", "bin"), getattr(counts, f"histogram_{name}"), NUMBER, f"steps, {meaning}"
            )
            for name, meaning in samples.items()
        },
    }
