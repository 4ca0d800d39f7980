"""Settings of each case that the table of the hyperparameters of networks shows."""

from burstcast_workflow.harness.settings import JobSettings, at


class CaseInputs(JobSettings):
    """Noise of a case, and the bias of its networks' inputs."""

    noise: float = at("case.training.noise")
    input_bias: float = at("forecasters.esn.input_bias")
