"""The paper's tables of parameters, and numbers and text in LaTeX."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

_ESCAPES = str.maketrans(
    {
        "\\": r"\textbackslash{}",
        "&": r"\&",
        "%": r"\%",
        "$": r"\$",
        "#": r"\#",
        "_": r"\_",
        "{": r"\{",
        "}": r"\}",
        "~": r"\textasciitilde{}",
        "^": r"\textasciicircum{}",
        "<": r"\textless{}",
        ">": r"\textgreater{}",
    }
)


def escape(text: str) -> str:
    """Text with the characters that are special to LaTeX made literal."""
    return text.translate(_ESCAPES)


def latex_number(value: float, digits: int = 4) -> str:
    r"""Write a number as LaTeX in math mode: ``$400$``, ``$4\pi$``, ``$1.6\times10^{-3}$``.

    Whole multiples of pi up to 20 are written as such (lengths of periodic domains), powers of
    ten without a mantissa, other numbers with ``digits`` significant digits; whole numbers in full.
    """
    if not math.isfinite(value):
        raise ValueError(f"a table cannot show {value}")
    if value == int(value) and abs(value) < 1e6:
        return f"${int(value)}$"
    multiple = round(value / math.pi)
    if 1 <= abs(multiple) <= 20 and math.isclose(value, multiple * math.pi, rel_tol=1e-9):
        return rf"${multiple if multiple != 1 else ''}\pi$"
    plain = f"{value:.{digits}g}"
    if "e" not in plain:
        return f"${plain}$"
    mantissa, exponent = plain.split("e")
    power = f"10^{{{int(exponent)}}}"
    return f"${power}$" if mantissa == "1" else rf"${mantissa}\times{power}$"


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
    """Parameters used for data generation (the paper's first table).

    ``system``: Parameters of the equations: symbol (LaTeX in math mode), explanation, value.
    ``laminarisation_threshold``, ``event_threshold``: Both in units of the observable. Without a
    laminarisation threshold there is no row for it. Returns columns ``Parameter``, ``Explanation``,
    ``Value``; the first and the last are LaTeX.
    """
    rows = [(f"${name}$", explanation, latex_number(value)) for name, explanation, value in system]
    rows.append(("$dt$", "Integration time step", latex_number(time_step)))
    if laminarisation_threshold is not None:
        limit = latex_number(laminarisation_threshold)
        rows.append((f"${symbol}_l$", "Laminarisation threshold", limit))
    rows += [
        (f"${symbol}_e$", "Extreme event threshold", latex_number(event_threshold)),
        ("", "Number of time series", latex_number(series_kept)),
        ("", "Length of each time series", latex_number(series_duration)),
        ("", "Number of time series in the training set", latex_number(training_series)),
    ]
    return pd.DataFrame(rows, columns=["Parameter", "Explanation", "Value"])


def network_parameters(
    *,
    spectral_radius: tuple[float, float],
    input_scaling: tuple[float, float],
    tikhonov: Sequence[float],
    connectivity: float,
    input_bias: float,
    noise: float,
) -> pd.DataFrame:
    """Hyperparameters of the echo state networks (the paper's second table).

    ``connectivity``, ``input_bias``: Mean number of connections of a neuron; the constant input.
    ``noise``: Standard deviation of the training noise, in standard deviations of the data. Returns
    columns ``Parameter``, ``Explanation``, ``Value``; the first and the last are LaTeX.
    """

    def several(values: Sequence[float]) -> str:
        return "$[" + ", ".join(latex_number(value).strip("$") for value in values) + "]$"

    rows = [
        (r"$\rho$", "Spectral radius", several(spectral_radius)),
        (r"$\sigma_{\mathrm{in}}$", "Input scaling", several(input_scaling)),
        (r"$\beta$", "Tikhonov parameter", several(tikhonov)),
        ("$d$", "Connectivity", latex_number(connectivity)),
        (r"$b_{\mathrm{in}}$", "Input bias", latex_number(input_bias)),
        (
            r"$\sigma_n$",
            "Standard deviation of the noise in the training inputs",
            latex_number(noise)[:-1] + r"\,\sigma_u$",
        ),
    ]
    return pd.DataFrame(rows, columns=["Parameter", "Explanation", "Value"])


def side_by_side(tables: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Join parameter tables of several cases: one column of values for each.

    ``tables``: By case: ``Parameter``, ``Explanation``, ``Value``, each pair of the first two once.
    Returns ``Parameter``, ``Explanation`` and a column per case, empty where a case has no such
    parameter; the table itself if there is one only.
    """
    if len(tables) == 1:
        return next(iter(tables.values()))
    rows: dict[tuple[str, str], dict[str, str]] = {}
    for case, table in tables.items():
        for parameter, explanation, value in table.itertuples(index=False, name=None):
            rows.setdefault((parameter, explanation), {})[case] = value
    return pd.DataFrame(
        [
            {
                "Parameter": parameter,
                "Explanation": explanation,
                **{case: values.get(case) for case in tables},
            }
            for (parameter, explanation), values in rows.items()
        ]
    )


_FLOW_PARAMETERS: tuple[tuple[str, str, str | float], ...] = (
    ("L_x", "Length of the domain in the $x$-direction", "length_x"),
    # the walls are at y = -1 and y = 1: the unit of length
    ("L_y", "Length of the domain in the $y$-direction", 2.0),
    ("L_z", "Length of the domain in the $z$-direction", "length_z"),
    (r"\mathrm{Re}", "Reynolds number", "reynolds"),
)


def described_parameters(name: str, values: Mapping[str, float]) -> list[list[Any]]:
    """Symbol in LaTeX, explanation and value of each parameter of a system's equations.

    ``name``: Name of the system: the shear flow ``mfe`` has the paper's symbols, others their own
    names.
    """
    if name == "mfe":
        return [
            [symbol, explanation, values[value] if isinstance(value, str) else value]
            for symbol, explanation, value in _FLOW_PARAMETERS
        ]
    return [
        [rf"\mathrm{{{escape(parameter)}}}", "Parameter of the equations", value]
        for parameter, value in values.items()
    ]
