"""Average the Lyapunov exponents of the data and of the forecasters' own flows."""

from collections.abc import Mapping, Sequence
from typing import Any

from burstcast.base import random_streams
from burstcast.base.declared import at, declaring, gathered, read
from burstcast.base.names import ForecasterName
from burstcast.statistics.lyapunov_spectrum import summarise
from burstcast.tables.cells import with_ends
from burstcast.tables.makers.registry import Gathered, Rows


@declaring
def make(
    *,
    spectrum: Mapping[str, Any] | None = read("simulated_case/lyapunov_spectrum.nc", "exponents"),
    forecasters: Sequence[Gathered] = gathered(
        "spectrum_forecasters/lyapunov_spectrum.nc", "exponents"
    ),
    case: str = at("case"),
    root_seed: int = at("random_seed"),
    resamples: int = at("bootstrap.resamples"),
    confidence: float = at("bootstrap.confidence"),
) -> dict[str, Rows]:
    """A row for each exponent, and one with the dimension for each forecaster."""
    rows: Rows = []
    of_dimensions: Rows = []
    # measured series have none
    spectra = [] if spectrum is None else [(ForecasterName("data"), spectrum)]
    spectra += [(file.name, file.content) for file in forecasters]
    for name, content in spectra:
        exponents = content["exponents"]
        generator = random_streams.stream(root_seed, "bootstrap", "lyapunov spectrum", case)
        mean, dimension = summarise(exponents, confidence, resamples, generator)
        rows += [
            {**name.keys, "number": number, **with_ends("lyapunov_exponent", *ends)}
            for number, ends in enumerate(zip(mean.mean, mean.low, mean.high, strict=True), 1)
        ]
        of_dimensions.append(
            {**name.keys, "runs": len(exponents), **with_ends("kaplan_yorke_dimension", *dimension)}
        )
    return {"lyapunov_spectrum": rows, "kaplan_yorke": of_dimensions}
