"""An extreme event of the test set as committees see it from one starting point: the forecasts of
all members and their median beside the truth (above), and the probability of an event in the window
that begins at each time (below): the share of the members that forecast one, what calibration on
the training series makes of it, and the probability from which on an alarm is raised. Of all
starting points of the test set that an event follows in the window farthest ahead, the one is shown
to which the first committee's share of votes is the median: half of the events were seen better,
half worse.
"""

from matplotlib.figure import Figure

from burstcast.figures.committee_event import CommitteeForecast, SeenEvent, committee_event
from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast.netcdf import read_attributes, read_record
from burstcast.probability.committee_event import CommitteeEvent
from burstcast_workflow.harness.figures import Settings, figure
from burstcast_workflow.jobs.systems import system_of


@figure
def draw(*, event: str, settings: Settings) -> Figure:
    """Draw the event."""
    data, system = read_record(event, CommitteeEvent), system_of(settings)
    if not data.time_lt.size:
        return nothing_to_show("No event occurred in the test set.")
    kinds = str(read_attributes(event)["committees"]).split()
    return committee_event(
        SeenEvent(
            data.time_lt,
            data.true,
            data.observed,
            data.prediction_time_lt,
            data.happened,
        ),
        [
            CommitteeForecast(
                kind,
                data.forecast[data.committee == number],
                data.votes[number],
                data.probability[number],
                data.alarm_threshold[number],
            )
            for number, kind in enumerate(kinds)
        ],
        settings["case.event_threshold"],
        settings["classification.window_lt"],
        symbol=system.observable_symbol,
        observable_name=system.observable_name,
    )
