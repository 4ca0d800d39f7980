"""Encode the series of another case: what is observed of them, as the channels of this one."""

from dataclasses import replace
from typing import Any

import numpy as np

from burstcast.base.files.netcdf import coefficients, read_netcdf, read_rows, variables_of
from burstcast.data.dataset import component_scales, observed_series
from burstcast.data.encoders.channels import IDENTITY, StateChannels, encoding_case
from burstcast.data.ensemble_files import ensemble_variables
from burstcast.systems.registry import make_space
from burstcast_workflow.harness.job import JobSettings, at, job, write_json, write_netcdf
from burstcast_workflow.jobs.cases import Sampling, System


class Encoding(JobSettings):
    """What is observed of another case, and how it is encoded."""

    system: System
    sampling: Sampling
    random_seed: int = at("random_seed")
    training_series: int = at("case.training.series")
    sensors: dict[str, Any] | None = at("case.sensors")
    encoder: dict[str, Any] | None = at("case.encoder")
    noise_of_data: dict[str, Any] | None = at("job.noise_of_data")
    source: dict[str, Any] = at("case.source_system")


@job
def encode(*, source: str, ensemble: str, summary: str, encoder: str, settings: Encoding) -> None:
    """Write the channels of all series, as they truly are and as observed, and the encoder."""
    of_source, options = settings.source, settings.encoder or {}
    space = make_space(of_source["system"], of_source["parameters"])
    case = encoding_case(space, settings.sensors, options)
    data = read_netcdf(source, "series", "lifetime", "observable")
    observable, count = data["observable"][..., np.newaxis], settings.training_series
    training = read_rows(source, "state", 0, count)
    seed, name = settings.random_seed, of_source["name"]
    level = settings.noise_of_data["level"] if settings.noise_of_data else 0.0
    kind = options.get("kind", IDENTITY)
    channels, scales = StateChannels.of_training(kind, training, case, level, seed, name)
    true, observed = [], []
    for row in range(len(observable)):
        # one series after the other, since series of a flow are large
        readings = case.readings_of_series(read_rows(source, "state", row, row + 1))
        seen = observed_series(readings, row, level, scales, seed, name)
        true.append(channels.encode_series(readings))
        observed.append(channels.encode_series(seen))
    scales = component_scales(observable[:count])
    noisy = observed_series(observable, 0, level, scales, seed, f"{name} observable")
    variables, of_all = ensemble_variables(
        np.concatenate([np.concatenate(true), observable], axis=2),
        data["observable"],
        settings.system.space.observable_name,
        data["series"],
        data["lifetime"],
        settings.sampling.interval,
    )
    variables["observed"] = replace(
        variables["state"],
        data=np.concatenate([np.concatenate(observed), noisy], axis=2),
        description="what is observed of the state, with noise",
    )
    if channels.decodes:
        variables |= variables_of(channels.maps(training))
    write_netcdf(ensemble, variables, settings.provenance)
    write_netcdf(encoder, coefficients(channels.arrays), settings.provenance)
    write_json(summary, of_all, settings.provenance)
