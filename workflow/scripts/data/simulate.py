"""Integrate the ensemble of a case and keep the series that do not laminarise."""

from typing import Any

import numpy as np

from burstcast.base import random_streams
from burstcast.data.dataset import generate_ensemble, initial_states
from burstcast.data.ensemble_files import ensemble_variables
from burstcast.systems.sampling import sampled_initial_states
from burstcast_workflow.harness.job import JobSettings, at, job, write_json, write_netcdf
from burstcast_workflow.jobs.cases import System


class Simulation(JobSettings):
    """The ensemble of a case."""

    system: System
    random_seed: int = at("random_seed")
    ensemble: dict[str, Any] = at("case.ensemble")
    laminarisation_threshold: float | None = at("case.laminarisation_threshold")


@job
def simulate(*, ensemble: str, summary: str, settings: Simulation) -> None:
    """Write the kept series, their observable, and a summary."""
    system, given = settings.system.equations, settings.ensemble
    generator = random_streams.stream(settings.random_seed, "ensemble", settings.case)
    if given["initial_state"] is None:
        start = sampled_initial_states(system, given["series"], generator)
    else:
        start = initial_states(
            np.asarray(given["initial_state"], dtype=np.float64),
            given["perturbed_component"] - 1,
            given["perturbation"],
            given["series"],
            generator,
        )
    batches = list(
        generate_ensemble(
            system,
            start,
            time_step=given["time_step"],
            sampling_stride=given["sampling_stride"],
            transient_steps=round(given["transient"] / given["time_step"]),
            kept_steps=round(given["duration"] / given["time_step"]),
            laminarisation_threshold=settings.laminarisation_threshold,
        )
    )
    index = np.concatenate([batch.index for batch in batches])
    if index.size == 0:
        raise ValueError(
            f"all {given['series']} series exceeded laminarisation_threshold, "
            f"{settings.laminarisation_threshold}: raise it, or ensemble.series"
        )
    states = np.concatenate([batch.states for batch in batches])
    observable = np.stack([system.observable(series.T) for series in states])
    variables, of_all = ensemble_variables(
        states,
        observable,
        system.observable_name,
        index,
        np.concatenate([batch.lifetimes for batch in batches]),
        given["time_step"] * given["sampling_stride"],
    )
    write_netcdf(ensemble, variables, settings.provenance)
    write_json(summary, of_all, settings.provenance)
