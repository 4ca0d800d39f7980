"""The paper's tables of parameters: of the data, and of the networks."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from burstcast.tables.latex import escape, latex_number

_COLUMNS = ["Parameter", "Explanation", "Value"]


def data_parameters(
    *,
    system: Sequence[Sequence[Any]],
    time_step: float,
    laminarisation_threshold: float | None,
    event_threshold: float,
    series_kept: int,
    series_duration: float,
    training_series: int,
    symbol: str = "k",
) -> pd.DataFrame:
    """Parameters used for data generation; the first and the last column are LaTeX.

    ``system``: Parameters of the equations: symbol (LaTeX in math mode), explanation, value.
    """
    rows = [(f"${name}$", explanation, value) for name, explanation, value in system]
    rows += [
        ("$dt$", "Integration time step", time_step),
        (f"${symbol}_l$", "Laminarisation threshold", laminarisation_threshold),
        (f"${symbol}_e$", "Extreme event threshold", event_threshold),
        ("", "Number of time series", series_kept),
        ("", "Length of each time series", series_duration),
        ("", "Number of time series in the training set", training_series),
    ]
    with_values = [(*names, latex_number(value)) for *names, value in rows if value is not None]
    return pd.DataFrame(with_values, columns=_COLUMNS)


def network_parameters(
    *,
    spectral_radius: Sequence[float],
    input_scaling: Sequence[float],
    tikhonov: Sequence[float],
    connectivity: float,
    input_bias: float,
    noise: float,
) -> pd.DataFrame:
    """Hyperparameters of the echo state networks; the first and the last column are LaTeX.

    ``noise``: Standard deviation of the training noise, in standard deviations of the data.
    """

    def several(values: Sequence[float]) -> str:
        return "$[" + ", ".join(latex_number(value).strip("$") for value in values) + "]$"

    noise_name = "Standard deviation of the noise in the training inputs"
    rows = [
        (r"$\rho$", "Spectral radius", several(spectral_radius)),
        (r"$\sigma_{\mathrm{in}}$", "Input scaling", several(input_scaling)),
        (r"$\beta$", "Tikhonov parameter", several(tikhonov)),
        ("$d$", "Connectivity", latex_number(connectivity)),
        (r"$b_{\mathrm{in}}$", "Input bias", latex_number(input_bias)),
        (r"$\sigma_n$", noise_name, latex_number(noise)[:-1] + r"\,\sigma_u$"),
    ]
    return pd.DataFrame(rows, columns=_COLUMNS)


def side_by_side(tables: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Join parameter tables of several cases: one column of values for each.

    A cell is empty where a case has no such parameter. The table itself if there is one only.
    """
    if len(tables) == 1:
        return next(iter(tables.values()))
    rows: dict[tuple[str, str], dict[str, str]] = {}
    for case, table in tables.items():
        for parameter, explanation, value in table.itertuples(index=False, name=None):
            row = dict(zip(_COLUMNS, (parameter, explanation), strict=False))
            rows.setdefault((parameter, explanation), row)[case] = value
    return pd.DataFrame([*rows.values()], columns=[*_COLUMNS[:2], *tables])


def described_parameters(name: str, values: Mapping[str, float]) -> list[list[Any]]:
    """Symbol in LaTeX, explanation and value of each parameter of a system's equations.

    The shear flow ``mfe`` has the paper's symbols, other systems the names of their parameters.
    """
    if name != "mfe":
        return [
            [rf"\mathrm{{{escape(parameter)}}}", "Parameter of the equations", value]
            for parameter, value in values.items()
        ]
    # the walls are at y = -1 and y = 1: the unit of length
    lengths = {"x": values["length_x"], "y": 2.0, "z": values["length_z"]}
    return [
        *(
            [f"L_{axis}", f"Length of the domain in the ${axis}$-direction", length]
            for axis, length in lengths.items()
        ),
        [r"\mathrm{Re}", "Reynolds number", values["reynolds"]],
    ]
