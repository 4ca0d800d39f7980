"""Lyapunov exponents of a case: the spectrum by QR, the leading one by growth of perturbations."""

from typing import Any

import numpy as np

from burstcast import random_streams
from burstcast.systems.lyapunov import (
    alignment_of,
    attractor_size,
    lyapunov_spectrum,
    mean_with_interval,
    perturbation_growth,
)
from burstcast.systems.registry import make_system
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.series_fit import check_kept_series
from burstcast_workflow.storage import read_netcdf, read_rows, write_json


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write the exponents with their 95 % confidence intervals."""
    system = make_system(settings["system"], settings["parameters"])
    ensemble, lyapunov = settings["ensemble"], settings["lyapunov"]
    kept = read_netcdf(inputs.ensemble, "series")["series"].size
    check_kept_series(kept, {"lyapunov.series": lyapunov["series"]})
    states = read_rows(inputs.ensemble, "state", 0, lyapunov["series"])
    start = np.ascontiguousarray(states[:, 0].T)
    # along the kept series, which are known not to laminarise
    steps = (states.shape[1] - 1) * ensemble["sampling_stride"]
    interval = round(lyapunov["orthonormalisation_interval"] / ensemble["time_step"])
    alignment = alignment_of(steps, interval)
    spectrum = lyapunov_spectrum(
        system,
        start,
        ensemble["time_step"],
        steps - alignment,
        interval,
        alignment_steps=alignment,
    )
    size = attractor_size(states.reshape(-1, states.shape[2]).T)
    growth = perturbation_growth(
        system,
        start,
        ensemble["time_step"],
        steps - alignment,
        lyapunov["perturbation"] * size,
        lyapunov["saturation"] * size,
        random_streams.stream(settings["random_seed"], "lyapunov", settings["case"]),
        alignment_steps=alignment,
    )
    exponents = mean_with_interval(spectrum.exponents)
    by_growth = mean_with_interval(growth.exponents)
    write_json(
        outputs.exponents,
        {
            "leading": {
                "mean": float(exponents.mean[0]),
                "low": float(exponents.low[0]),
                "high": float(exponents.high[0]),
            },
            "leading_by_growth": {
                "mean": float(by_growth.mean),
                "low": float(by_growth.low),
                "high": float(by_growth.high),
            },
            "spectrum": exponents.mean.tolist(),
            "spectrum_low": exponents.low.tolist(),
            "spectrum_high": exponents.high.tolist(),
            "series": len(states),
            "duration": spectrum.duration,
            "provenance": provenance,
        },
    )


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
