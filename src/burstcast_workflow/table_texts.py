"""How tables are typeset: captions, heads and formats of columns."""

from burstcast.tables import escape

CAPTIONS = {
    "data_generation_parameters": "Parameters used for data generation.",
    "network_hyperparameters": (
        "Echo state networks' hyperparameters. Multiple values indicate that the parameter is "
        "optimised in the shown range."
    ),
    "dataset": (
        "The ensembles: series, share that laminarises, extreme events, and leading Lyapunov "
        "exponent with its confidence interval, by QR factorisation and by the growth of "
        r"perturbations ($\Lambda_g$; $\Lambda_p$: published)."
    ),
    "hyperparameters": "Hyperparameters of each network.",
    "classification": "Precision, recall and F-score of each network.",
    "classification_intervals": (
        "Bootstrap confidence intervals of each network's precision, recall and F-score."
    ),
    "horizon": "Prediction horizon of extreme events of each network, averaged over the events.",
    "horizon_intervals": (
        "Bootstrap confidence intervals, over the events, of each network's average horizon."
    ),
    "statistics_intervals": (
        "Bootstrap confidence intervals, over the long runs, of each network's long-term "
        "statistics."
    ),
    "statistics": "Long-term statistics of each network's flow, against those of the data.",
    "survival": (
        "Escapes from the chaotic phase: time at risk after the first quarter of each run, and "
        "escape rate with its confidence interval."
    ),
    "survival_curve": "Share of the runs still in the chaotic phase, with its confidence interval.",
    "lyapunov_spectrum": (
        "Lyapunov exponents of the data and of each network's own flow, with confidence intervals."
    ),
    "kaplan_yorke": (
        "Kaplan--Yorke dimension of the data and of each network's own flow, with its confidence "
        "interval over runs."
    ),
    "control": "Control of extreme events by each network and by the reference forecasters.",
    "control_strategies": (
        "Costs and gains of control, with bootstrap intervals over flows; where nothing was left, "
        "the upper end is that of the rule of three."
    ),
}
"""LaTeX, by table."""

HEADS = {
    "reynolds": r"$\mathrm{Re}$",
    "neurons": "$N_r$",
    "prediction_time_lt": "PT [LT]",
    "p25": r"25\%",
    "p50": r"50\%",
    "p75": r"75\%",
    "series_generated": "series",
    "series_kept": "kept",
    "laminarised_fraction": "laminarised",
    "mean_observable": "mean",
    "events_per_series": "events per series",
    "lyapunov_exponent": r"$\Lambda$",
    "lyapunov_exponent_low": r"$\Lambda_{\mathrm{low}}$",
    "lyapunov_exponent_high": r"$\Lambda_{\mathrm{high}}$",
    "lyapunov_exponent_by_growth": r"$\Lambda_g$",
    "lyapunov_exponent_by_growth_low": r"$\Lambda_{g,\mathrm{low}}$",
    "lyapunov_exponent_by_growth_high": r"$\Lambda_{g,\mathrm{high}}$",
    "lyapunov_exponent_paper": r"$\Lambda_p$",
    "steps_per_lyapunov_time": "steps per LT",
    "spectral_radius": r"$\rho$",
    "input_scaling": r"$\sigma_{\mathrm{in}}$",
    "tikhonov": r"$\beta$",
    "objective": r"$\log_{10}$ MSE",
    "true_positive": "TP",
    "false_positive": "FP",
    "false_negative": "FN",
    "true_negative": "TN",
    "f_score": "F-score",
    "mean_horizon_lt": r"mean $\mathrm{PH}_{\mathrm{ee}}$ [LT]",
    "median_horizon_lt": r"median $\mathrm{PH}_{\mathrm{ee}}$ [LT]",
    "kantorovich": r"$\mathcal{K}$",
    "mean_log_error": "MLE",
    "nrmse_u": r"NRMSE of $\langle\overline{u}\rangle$",
    "nrmse_uu": r"NRMSE of $\langle\overline{u^2}\rangle$",
    "nrmse_uv": r"NRMSE of $\langle\overline{uv}\rangle$",
    "exceedance_uncontrolled": r"$P(k \geq k_e)$",
    "exceedance_controlled": r"$P(k \geq k_e)$, controlled",
    "exceedance_free": r"$P(k \geq k_e)$, free",
}
"""LaTeX heads of columns and names of metrics; others show their name without underscores."""

FORMATS = {
    "laminarised_fraction": ".3f",
    "mean_observable": ".4f",
    "events_per_series": ".2f",
    "lyapunov_exponent": ".5f",
    "lyapunov_exponent_low": ".5f",
    "lyapunov_exponent_high": ".5f",
    "lyapunov_exponent_by_growth": ".5f",
    "lyapunov_exponent_by_growth_low": ".5f",
    "lyapunov_exponent_by_growth_high": ".5f",
    "lyapunov_exponent_paper": ".4f",
    "kaplan_yorke_dimension": ".2f",
    "kaplan_yorke_dimension_low": ".2f",
    "kaplan_yorke_dimension_high": ".2f",
    "spectral_radius": ".3f",
    "input_scaling": ".3f",
    "objective": ".3f",
    "precision": ".3f",
    "recall": ".3f",
    "f_score": ".3f",
    "low": ".3f",
    "high": ".3f",
    "mean_horizon_lt": ".2f",
    "median_horizon_lt": ".2f",
}
"""Formats of columns; others show four significant digits."""


OWN_FORMATS = {"statistics_intervals": {"low": ".5f", "high": ".5f"}}
"""Formats of columns of single tables."""

PARAMETER_TABLES = ("data_generation_parameters", "network_hyperparameters")
"""Tables whose text is LaTeX already."""


def head(column: str) -> str:
    """LaTeX head of a column, or name of a metric."""
    return HEADS.get(column, escape(column.replace("_", " ")))
