"""Share of the exceedance of the event threshold that control removes, (a) against the prediction
time and (b) against the share of the time under actuation, with medians and quartiles over the
networks of an ensemble. For comparison: alarms by the equations themselves, started from the true
state, and random alarms at the rate of the networks'. Open markers, if any: the paper's exceedance
with control, over ours without control.
"""

from matplotlib.figure import Figure

from burstcast.figures.control_tradeoff import control_tradeoff
from burstcast.published import published_reductions
from burstcast_workflow.harness.figures import Settings, Table, figure
from burstcast_workflow.jobs.figures import published_beside
from burstcast_workflow.jobs.systems import system_of


@figure
def draw(*, percentiles: Table, settings: Settings, published: Table | None = None) -> Figure:
    """Draw the networks of one kind, and the forecasters to compare them with."""
    of_kind = (percentiles["neurons"] == settings["controlling"]["neurons"]) & (
        percentiles["validation"] == settings["controlling"]["validation"]
    )
    shown = percentiles[percentiles["neurons"].isna() | of_kind]
    exceedances = published_beside(percentiles, published, "control")
    return control_tradeoff(
        shown,
        symbol=system_of(settings).observable_symbol,
        published=None if exceedances is None else published_reductions(exceedances, shown),
    )
