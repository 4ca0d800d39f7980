"""Integrate the ensemble of a case and keep the series that do not laminarise."""

import numpy as np

from burstcast import random_streams
from burstcast.dataset import generate_ensemble, initial_states
from burstcast.systems.sampling import sampled_initial_states
from burstcast_workflow.harness.job import Provenance, run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import Variable, write_json, write_netcdf
from burstcast_workflow.jobs.systems import equations_of


def simulate(
    *,
    ensemble: str,
    summary: str,
    settings: Settings,
    provenance: Provenance,
) -> None:
    """Write the kept series, their observable, and a summary."""
    system = equations_of(settings)
    given = settings["case.ensemble"]
    generator = random_streams.stream(settings["random_seed"], "ensemble", settings["case"])
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
            laminarisation_threshold=settings["case.laminarisation_threshold"],
        )
    )
    index = np.concatenate([batch.index for batch in batches])
    if index.size == 0:
        raise ValueError(
            f"all {given['series']} series exceeded laminarisation_threshold, "
            f"{settings['case.laminarisation_threshold']}: raise it, or ensemble.series"
        )
    states = np.concatenate([batch.states for batch in batches])
    observable = np.stack([system.observable(series.T) for series in states])
    interval = given["time_step"] * given["sampling_stride"]
    write_netcdf(
        ensemble,
        {
            "series": Variable(("series",), index, "1", "number of the series in the ensemble"),
            "lifetime": Variable(
                ("generated",),
                np.concatenate([batch.lifetimes for batch in batches]),
                "1",
                "steps until each series that was generated laminarised; all of a kept one",
            ),
            "time": Variable(
                ("time",), interval * np.arange(states.shape[1]), "1", "time after the transient"
            ),
            "state": Variable(
                ("series", "time", "component"),
                states,
                "1",
                "state of the system",
                chunks=(1, *states.shape[1:]),
            ),
            "observable": Variable(
                ("series", "time"),
                observable,
                "1",
                system.observable_name,
                chunks=(1, observable.shape[1]),
            ),
        },
        provenance,
    )
    write_json(
        summary,
        {
            "series_generated": given["series"],
            "series_kept": len(index),
            "laminarised_fraction": 1 - len(index) / given["series"],
            "mean_observable": float(observable.mean()),
            "provenance": provenance,
        },
    )


if __name__ == "__main__":
    run_job(snakemake, simulate)  # noqa: F821 - Snakemake puts it there
