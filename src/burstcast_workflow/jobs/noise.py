"""Settings of each case that the table of the hyperparameters of networks shows."""

from burstcast_workflow.harness.settings import JobSettings, at


class CaseNoise(JobSettings):
    """Noise of a case."""

    noise: float = at("case.training.noise")
