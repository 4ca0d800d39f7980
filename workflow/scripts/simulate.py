"""Integrate the ensemble of a case and keep the series that do not laminarise."""

from typing import Any

import numpy as np

from burstcast import random_streams
from burstcast.dataset import generate_ensemble, initial_states
from burstcast.systems.registry import make_system
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.storage import Variable, write_json, write_netcdf


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write the kept series, their observable, and a summary."""
    system = make_system(settings["system"], settings["parameters"])
    ensemble = settings["ensemble"]
    start = initial_states(
        np.asarray(ensemble["initial_state"], dtype=np.float64),
        ensemble["perturbed_component"] - 1,
        ensemble["perturbation"],
        ensemble["series"],
        random_streams.stream(settings["random_seed"], "ensemble", settings["case"]),
    )
    batches = list(
        generate_ensemble(
            system,
            start,
            time_step=ensemble["time_step"],
            sampling_stride=ensemble["sampling_stride"],
            transient_steps=round(ensemble["transient"] / ensemble["time_step"]),
            kept_steps=round(ensemble["duration"] / ensemble["time_step"]),
            laminarisation_threshold=settings["laminarisation_threshold"],
        )
    )
    index = np.concatenate([batch.index for batch in batches])
    if index.size == 0:
        raise ValueError(
            f"all {ensemble['series']} series exceeded laminarisation_threshold, "
            f"{settings['laminarisation_threshold']}: raise it, or ensemble.series"
        )
    states = np.concatenate([batch.states for batch in batches])
    observable = np.stack([system.observable(series.T) for series in states])
    interval = ensemble["time_step"] * ensemble["sampling_stride"]
    write_netcdf(
        outputs.ensemble,
        {
            "series": Variable(("series",), index, "1", "number of the series in the ensemble"),
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
        outputs.summary,
        {
            "series_generated": ensemble["series"],
            "series_kept": len(index),
            "laminarised_fraction": 1 - len(index) / ensemble["series"],
            "mean_observable": float(observable.mean()),
            "provenance": provenance,
        },
    )


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
