"""Lyapunov exponents of single runs as files: of the flow itself, or of a forecaster's own flow."""

from collections.abc import Mapping
from pathlib import Path

from burstcast.arrays import FloatArray
from burstcast.netcdf import Variable, read_netcdf
from burstcast.systems.lyapunov import LyapunovSpectrum
from burstcast.units import RATE, TIME
from burstcast_workflow.harness.storage import write_netcdf


def write_spectrum(
    path: str | Path, spectrum: LyapunovSpectrum, provenance: Mapping[str, str]
) -> None:
    """Write the exponents of each run."""
    write_netcdf(
        path,
        {
            "exponents": Variable(
                ("run", "exponent"), spectrum.exponents, RATE, "Lyapunov exponents of each run"
            ),
            "duration": Variable((), spectrum.duration, TIME, "time that they are averaged over"),
        },
        provenance,
    )


def read_exponents(path: str | Path) -> FloatArray:
    """Exponents ``(runs, exponents)`` that `write_spectrum` wrote."""
    exponents: FloatArray = read_netcdf(path, "exponents")["exponents"]
    return exponents
