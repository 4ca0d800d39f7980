"""How tables are typeset for papers: which rows of which table, captions, heads and formats."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from burstcast.tables import escape


@dataclass(frozen=True)
class Layout:
    """A table for papers: who it is about as rows, what is known of them as columns.

    Attributes
    ----------
    caption
        LaTeX.
    source
        Table whose rows it shows.
    metrics
        Values of its column ``metric``, or columns of it, that are shown.
    columns
        What stands side by side: the metrics, or the values of a key, such as prediction times.
    more_rows
        Keys that tell rows of one forecaster apart.
    where
        Rows that are shown, by the value of a column.
    """

    caption: str
    source: str
    metrics: tuple[str, ...]
    columns: str = "metric"
    more_rows: tuple[str, ...] = ()
    where: Mapping[str, str] = field(default_factory=dict)


_OF_NETWORKS = "Medians over the networks of an ensemble (quartiles)."
_OF_SERIES = "In parentheses: bootstrap intervals over the test series."


def _by_time(what: str, metric: str) -> Layout:
    caption = f"{what} by the prediction time in Lyapunov times. {_OF_NETWORKS}"
    return Layout(caption, "classification_percentiles", (metric,), "prediction_time_lt")


LAYOUTS: Mapping[str, Layout] = {
    "dataset": Layout(
        "The ensembles: series, share that laminarises, extreme events, and leading Lyapunov "
        "exponent with its confidence interval, by QR factorisation and by the growth of "
        r"perturbations ($\Lambda_g$; $\Lambda_p$: published).",
        "dataset",
        (
            *("series_generated", "series_kept", "laminarised_fraction", "mean_observable"),
            *("events_per_series", "lyapunov_exponent", "lyapunov_exponent_by_growth"),
            *("lyapunov_exponent_paper", "steps_per_lyapunov_time"),
        ),
    ),
    "hyperparameters": Layout(
        f"Hyperparameters that the search chose. {_OF_NETWORKS}",
        "hyperparameters_percentiles",
        ("spectral_radius", "input_scaling", "tikhonov", "objective"),
    ),
    "precision": _by_time("Precision", "precision"),
    "recall": _by_time("Recall", "recall"),
    "f_score": _by_time("F-score", "f_score"),
    "brier_skill": Layout(
        f"Brier skill of the calibrated probabilities by the prediction time in Lyapunov times. "
        f"{_OF_SERIES}",
        "probability_scores",
        ("brier_skill",),
        "prediction_time_lt",
        where={"probability": "calibrated"},
    ),
    "horizon": Layout(
        f"Prediction horizon of extreme events, averaged over the events. {_OF_NETWORKS}",
        "horizon_percentiles",
        ("mean_horizon_lt", "median_horizon_lt"),
    ),
    "statistics": Layout(
        f"Long-term statistics of the networks' own flows, against those of the data. "
        f"{_OF_NETWORKS}",
        "statistics_percentiles",
        ("discarded_fraction", "kantorovich", "mean_log_error", "nrmse_u", "nrmse_uu", "nrmse_uv"),
    ),
    "survival": Layout(
        f"Escapes from the chaotic phase: share of the runs that stay, and escape rate. "
        f"{_OF_NETWORKS}",
        "survival_percentiles",
        ("survived_fraction", "escape_rate"),
    ),
    "lyapunov_spectrum": Layout(
        f"Lyapunov exponents of the data and of the networks' own flows. {_OF_NETWORKS}",
        "lyapunov_spectrum_percentiles",
        ("lyapunov_exponent",),
        "number",
    ),
    "kaplan_yorke": Layout(
        f"Kaplan--Yorke dimension of the data and of the networks' own flows. {_OF_NETWORKS}",
        "kaplan_yorke_percentiles",
        ("kaplan_yorke_dimension",),
    ),
    "control": Layout(
        "Control of extreme events: share of the time at or above the threshold, without control "
        f"and under control, and share of the time with actuation. {_OF_NETWORKS}",
        "control_percentiles",
        ("exceedance_uncontrolled", "exceedance_controlled", "reduction", "control_fraction"),
        more_rows=("prediction_time_lt",),
    ),
    "control_strategies": Layout(
        "Costs and gains of control: share of the time at or above the threshold under control, "
        "what share of the exceedance that leaves, share of the time with actuation. Intervals "
        "over flows; where nothing was left, the upper end is that of the rule of three. "
        "In parentheses after a strategy: its settings, in the order of the alphabet.",
        "control_strategies",
        ("exceedance_controlled", "relative_exceedance", "control_fraction"),
        more_rows=("seed", "strategy"),
    ),
}
"""Tables for papers, by name, beside the two of the parameters."""

_CAPTIONS = {
    "data_generation_parameters": "Parameters used for data generation.",
    "network_hyperparameters": (
        "Echo state networks' hyperparameters. Multiple values indicate that the parameter is "
        "optimised in the shown range."
    ),
}

HEADS = {
    "prediction_time_lt": "PT [LT]",
    "series_generated": "series",
    "series_kept": "kept",
    "laminarised_fraction": "laminarised",
    "mean_observable": "mean",
    "events_per_series": "events per series",
    "lyapunov_exponent": r"$\Lambda$",
    "lyapunov_exponent_by_growth": r"$\Lambda_g$",
    "lyapunov_exponent_paper": r"$\Lambda_p$",
    "steps_per_lyapunov_time": "steps per LT",
    "spectral_radius": r"$\rho$",
    "input_scaling": r"$\sigma_{\mathrm{in}}$",
    "tikhonov": r"$\beta$",
    "objective": r"$\log_{10}$ MSE",
    "f_score": "F-score",
    "kaplan_yorke_dimension": "Kaplan--Yorke dimension",
    "mean_horizon_lt": r"mean $\mathrm{PH}_{\mathrm{ee}}$ [LT]",
    "median_horizon_lt": r"median $\mathrm{PH}_{\mathrm{ee}}$ [LT]",
    "kantorovich": r"$\mathcal{K}$",
    "mean_log_error": "MLE",
    "nrmse_u": r"NRMSE of $\langle\overline{u}\rangle$",
    "nrmse_uu": r"NRMSE of $\langle\overline{u^2}\rangle$",
    "nrmse_uv": r"NRMSE of $\langle\overline{uv}\rangle$",
    "exceedance_uncontrolled": "exceedance",
    "exceedance_controlled": "under control",
    "relative_exceedance": "share left",
    "control_fraction": "actuation",
}
"""LaTeX heads of columns and names of metrics; others show their name without underscores."""

FORMATS = {
    "laminarised_fraction": ".3f",
    "mean_observable": ".4f",
    "events_per_series": ".2f",
    "lyapunov_exponent": ".5f",
    "lyapunov_exponent_by_growth": ".5f",
    "lyapunov_exponent_paper": ".4f",
    "spectral_radius": ".3f",
    "input_scaling": ".3f",
    "objective": ".3f",
    "precision": ".3f",
    "recall": ".3f",
    "f_score": ".3f",
    "kaplan_yorke_dimension": ".2f",
    "brier_skill": ".3f",
    "survived_fraction": ".3f",
    "exceedance_uncontrolled": ".4f",
    "exceedance_controlled": ".4f",
    "reduction": ".3f",
    "relative_exceedance": ".3f",
    "control_fraction": ".3f",
    "mean_horizon_lt": ".2f",
    "median_horizon_lt": ".2f",
}
"""Formats of numbers; others show three significant digits."""


def head(column: str) -> str:
    """LaTeX head of a column, or name of a metric."""
    return HEADS.get(column, escape(column.replace("_", " ")))


def latex_caption(name: str) -> str:
    """LaTeX caption of a table for papers."""
    return LAYOUTS[name].caption if name in LAYOUTS else _CAPTIONS[name]


def source_of(name: str) -> str:
    """Table that a table for papers is made of."""
    return LAYOUTS[name].source if name in LAYOUTS else name
