"""Settings of each case that the table of the parameters of the data shows."""

from burstcast_workflow.harness.settings import at
from burstcast_workflow.jobs.systems import System


class CaseData(System):
    """How the data of a case are made."""

    time_step: float = at("case.ensemble.time_step")
    duration: float = at("case.ensemble.duration")
    training_series: int = at("case.training.series")
    laminarisation_threshold: float | None = at("case.laminarisation_threshold")
    event_threshold: float = at("case.event_threshold")
