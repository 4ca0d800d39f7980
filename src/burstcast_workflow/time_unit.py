"""Network steps in a Lyapunov time: from the config, or from the exponent that a job computed."""

from collections.abc import Mapping
from typing import Any

from burstcast import durations
from burstcast_workflow.storage import read_json


def read_steps_per_lyapunov_time(settings: Mapping[str, Any], lyapunov: Any) -> int:
    """Network steps in a Lyapunov time.

    Parameters
    ----------
    settings
        Of a job; ``steps_per_lyapunov_time`` is None where the exponent is computed.
    lyapunov
        The job's input of that name: the file of the computed exponents, or nothing.

    Raises
    ------
    ValueError
        If the computed exponent gives no time unit.
    """
    known = settings["steps_per_lyapunov_time"]
    if known is not None:
        return int(known)
    exponent = read_json(str(lyapunov))["leading"]["mean"]
    try:
        return durations.steps_per_lyapunov_time(exponent, settings["sampling_interval"])
    except ValueError as error:
        raise ValueError(
            f"the computed Lyapunov exponent cannot be the unit of time: {error} "
            f"(lyapunov.published_exponent, lyapunov.time_unit)"
        ) from error
