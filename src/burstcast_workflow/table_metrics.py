"""What percentiles over networks are taken of, by table."""

from dataclasses import dataclass

from burstcast_workflow.identifiers import KEYS

NETWORK_KEYS = KEYS[:-1]
"""What tells the ensembles of a table apart: all keys but the seed."""


@dataclass(frozen=True)
class Summary:
    """What percentiles over networks are taken of.

    Attributes
    ----------
    metrics
        Columns of the table.
    keys
        Columns that tell rows of one network apart.
    """

    metrics: tuple[str, ...]
    keys: tuple[str, ...] = ()


SUMMARIES = {
    "hyperparameters": Summary(("spectral_radius", "input_scaling", "tikhonov", "objective")),
    "classification": Summary(("precision", "recall", "f_score"), ("prediction_time_lt",)),
    "horizon": Summary(("mean_horizon_lt", "median_horizon_lt")),
    "statistics": Summary(
        (
            "discarded_fraction",
            "laminarised_fraction",
            "fixed_point_fraction",
            "diverged_fraction",
            "kantorovich",
            "mean_log_error",
            "nrmse_u",
            "nrmse_uu",
            "nrmse_uv",
        )
    ),
    "survival": Summary(("survived_fraction", "escape_rate")),
    "survival_curve": Summary(("survival",), ("time",)),
    "lyapunov_spectrum": Summary(("lyapunov_exponent",), ("number",)),
    "kaplan_yorke": Summary(("kaplan_yorke_dimension",)),
    "control": Summary(
        (
            "exceedance_uncontrolled",
            "exceedance_controlled",
            "exceedance_free",
            "reduction",
            "control_fraction",
            "alarms",
            "false_alarms",
            "missed_events",
            "unsuppressed_events",
        ),
        ("prediction_time_lt",),
    ),
}
"""Tables with one row for each network, by name."""
