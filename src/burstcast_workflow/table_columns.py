"""What the columns of tables mean, and the page that says it.

``python -m burstcast_workflow.table_columns > docs/tables.md``, where config.yaml is.
"""

from collections.abc import Iterator
from textwrap import fill

from burstcast_workflow.identifiers import KEYS
from burstcast_workflow.table_metrics import SUMMARIES
from burstcast_workflow.table_registry import PARAMETER_TABLES, TABLES, table_of

_LT, _TIME, _RATE = "Lyapunov times", "time units", "1 / time unit"

COLUMNS: dict[str, tuple[str, str]] = {
    # keys
    "case": ("", "where the series come from: name in the config"),
    "reynolds": ("", "Reynolds number; empty for a system that has none"),
    "forecaster": ("", "kind of forecaster, or what stands beside them (see the table)"),
    "neurons": ("", "size of the reservoir; empty for what is no network"),
    "validation": ("", "validation strategy of the network"),
    "seed": ("", "of the network; empty for what has none"),
    "metric": ("", "which quantity the row is about (below)"),
    "value": ("of the metric", "from all the data"),
    "low": ("of the metric", "lower end of the confidence interval"),
    "high": ("of the metric", "upper end of the confidence interval"),
    "p25": ("of the metric", "first quartile"),
    "p50": ("of the metric", "median"),
    "p75": ("of the metric", "third quartile"),
    "networks": ("", "number of networks with a defined value"),
    "prediction_time_lt": (_LT, "from the start of a forecast to its window"),
    # dataset
    "series_generated": ("", "trajectories that were integrated"),
    "series_kept": ("", "of them, those that did not laminarise"),
    "laminarised_fraction": ("", "share that laminarised: of series, or of long runs"),
    "mean_observable": ("observable", "mean of the observable over all data"),
    "events_per_series": ("", "extreme events, per kept series"),
    "lyapunov_exponent": (_RATE, "by QR factorisation"),
    "lyapunov_exponent_by_growth": (_RATE, "leading one, by the growth of perturbations"),
    "lyapunov_exponent_paper": (_RATE, "published one, if the config has it"),
    "steps_per_lyapunov_time": ("", "steps of a forecast in a Lyapunov time"),
    # hyperparameters
    "spectral_radius": ("", "rho"),
    "input_scaling": ("", "sigma_in"),
    "tikhonov": ("", "beta, of the ridge regression"),
    "objective": ("log10", "mean squared error of the validation at the chosen point"),
    "solver": ("", "factorisation: cholesky, or ldl where rounding made the matrix indefinite"),
    # classification
    "true_positive": ("", "forecasts of an event that comes in the window"),
    "false_positive": ("", "forecasts of an event that does not"),
    "false_negative": ("", "events in the window that were not forecast"),
    "true_negative": ("", "neither"),
    "precision": ("", "TP / (TP + FP); empty without positives"),
    "recall": ("", "TP / (TP + FN); empty without events"),
    "f_score": ("", "harmonic mean of precision and recall"),
    # horizon
    "events": ("", "events that were forecast"),
    "mean_horizon_lt": (_LT, "prediction horizon PH_ee, mean over the events"),
    "median_horizon_lt": (_LT, "the same, median over the events"),
    # probabilities
    "alarm": ("", "who raises it: a forecaster, a committee, or a baseline"),
    "compared": ("", "a forecaster, or the median of networks"),
    "other": ("", "whose score is taken away"),
    "other_strategy": ("", "of the other run, with its settings and conditions"),
    "probability": ("", "calibrated, or votes as they are; of control: the setting of its name"),
    "alarm_threshold": ("", "probability from which on an alarm is raised"),
    "base_rate": ("", "share of the starting points that an event follows"),
    "brier_score": ("", "mean squared error of the probabilities"),
    "brier_skill": ("", "1 - Brier score / Brier score of the base rate"),
    "reliability": ("", "of the Brier score's decomposition; small is good"),
    "resolution": ("", "of the decomposition; large is good"),
    "uncertainty": ("", "of the decomposition: variance of what happened"),
    "calibration_error": ("", "expected error of the probabilities, over their bins"),
    "roc_area": ("", "area below the ROC curve"),
    "average_precision": ("", "area below the precision-recall curve"),
    "bin": ("", "of the probability, from 0"),
    "forecasts": ("", "forecasts in the bin; of control: that were made"),
    "mean_probability": ("", "of the forecasts in the bin"),
    "observed_frequency": ("", "share of them that an event follows"),
    "consistency_low": ("", "where the frequency of a reliable forecaster would be: lower end"),
    "consistency_high": ("", "the same, upper end"),
    "cost_loss_ratio": ("", "what acting costs, over what an event costs who did not act"),
    "threshold": ("", "probability from which on alarms are raised"),
    "false_alarm_rate": ("", "FP / (FP + TN)"),
    "lead_time_lt": (_LT, "that warned_fraction or false alarms are told for"),
    "mean_lead_time_lt": (_LT, "from when an alarm came and stayed to the event"),
    "mean_first_alarm_lt": (_LT, "from the first alarm about the event to the event"),
    "mean_possible_lead_time_lt": (_LT, "from the first starting point that could warn of it"),
    "missed_fraction": ("", "events that the last starting point before was not right about"),
    "warned_fraction": ("", "of events that could be warned of so early, those that were"),
    "false_alarms_per_lt": (f"1 / {_LT}", "false alarms in the time that was watched"),
    "event_threshold": ("observable", "beyond which an event counts"),
    # long runs
    "discarded_fraction": ("", "long runs that laminarise, settle or diverge"),
    "fixed_point_fraction": ("", "long runs that come to rest elsewhere"),
    "diverged_fraction": ("", "long runs that diverge"),
    "kantorovich": ("observable", "Kantorovich metric of the densities of the observable"),
    "mean_log_error": ("", "mean logarithmic error of those densities"),
    "nrmse_u": ("", "normalised root mean square error of the profile of u"),
    "nrmse_uu": ("", "the same, of u^2"),
    "nrmse_uv": ("", "the same, of uv"),
    "series": ("", "series, or long runs"),
    "survived_fraction": ("", "share that never leaves the chaotic phase"),
    "escapes": ("", "that are counted"),
    "time_at_risk": (_TIME, "spent in the chaotic phase while escapes are counted"),
    "escape_rate": (_RATE, "escapes / time_at_risk"),
    "time": (_TIME, "since the start of a run"),
    "survival": ("", "share still in the chaotic phase"),
    "number": ("", "of the exponent, from the largest, 1"),
    "runs": ("", "that are averaged over"),
    "kaplan_yorke_dimension": ("", "of the mean spectrum"),
    # scatter
    "mean": ("", "over all of them"),
    "standard_deviation_over_training_sets": ("", "beyond what seeds explain"),
    "standard_deviation_over_seeds": ("", "of those that share a training set"),
    "training_sets": ("", "choices of the training series"),
    # control
    "exceedance_uncontrolled": ("", "share of the time at or above the threshold, no control"),
    "exceedance_controlled": ("", "share of the time at or above it, with control"),
    "exceedance_free": ("", "with control, time under actuation left out"),
    "reduction": ("", "share of the exceedance that control removes"),
    "relative_exceedance": ("", "share of the exceedance that is left"),
    "control_fraction": ("", "share of the time under actuation"),
    "alarms": ("", "forecasts that raised an alarm"),
    "alarm_rate": ("", "alarms / forecasts"),
    "true_alarms": ("", "after which the event would have come, had nobody acted"),
    "false_alarms": ("", "alarms after which no event would have come"),
    "early_alarms": ("", "false alarms whose event had begun before the window"),
    "suppressed_events": ("", "true alarms after which no event comes in the window"),
    "delayed_events": ("", "suppressed ones that come before the next forecast after all"),
    "unsuppressed_events": ("", "true alarms after which the event comes"),
    "missed_events": ("", "events in a window for which no alarm was raised"),
    "events_under_way": ("", "events in a window without alarm, a former one not being over"),
    "events_after_true_alarms": ("", "events in the window of a true alarm"),
    "events_after_false_alarms": ("", "events in the window of a false alarm"),
    "events_between_windows": ("", "events in no forecast's window"),
    "events_uncontrolled": ("", "all events without control"),
    "events_controlled": ("", "all events with control"),
    "flows": ("", "flows that count"),
    "left_out": ("", "flows with an event before anything could be done about it"),
    "laminarised": ("", "flows that laminarise with control or without: they do not count"),
    "laminarised_controlled": ("", "flows that laminarise with control"),
    "laminarised_uncontrolled": ("", "flows that laminarise without control"),
    "steps": ("", "steps that count"),
    "steps_free": ("", "of the controlled flows, those that are reached without actuation"),
    "exceeding_uncontrolled": ("", "of the steps, those at or above the threshold"),
    "exceeding_controlled": ("", "of the steps with control, those at or above the threshold"),
    "exceeding_free": ("", "of the steps without actuation, those at or above the threshold"),
    "integration_steps": ("", "integration steps that count"),
    "actuated_integration_steps": ("", "integration steps under actuation"),
    "density_uncontrolled": ("1 / observable", "density in the bin without control"),
    "density_controlled": ("1 / observable", "with control"),
    "density_free": ("1 / observable", "with control, time under actuation left out"),
    "density_controlled_p25": ("1 / observable", "with control: first quartile over networks"),
    "density_controlled_p75": ("1 / observable", "with control: third quartile over networks"),
    "strategy": ("", "of control: module of burstcast.control.strategies"),
    "decision_interval_lt": (_LT, "setting: between two decisions"),
    "horizon_lt": (_LT, "setting: how far forecasts look ahead"),
    "window_lt": (_LT, "setting: length of the window of an alarm"),
    "level": ("observable", "setting: from which on the reactive strategy acts"),
    "margin": ("observable", "setting: taken from the threshold of forecast events"),
    "vote_share": ("", "setting: share of forecasters that must agree"),
    "delay_lt": (_LT, "condition: between a decision and the actuation"),
    "noise": ("standard deviations", "condition: of what is observed"),
    "quiet_lt": (_LT, "condition: least time before steps count"),
    "span_lt": (_LT, "condition: how long each flow counts"),
    "starts": ("", "condition: quiet, free of events, or unselected"),
    "strength": ("", "condition: of the actuator"),
    "switchings_per_lyapunov_time": (f"1 / {_LT}", "times that the actuation is switched on"),
    "events_per_lyapunov_time_uncontrolled": (f"1 / {_LT}", "events without control"),
    "events_per_lyapunov_time_controlled": (f"1 / {_LT}", "events with control"),
    "input_uncontrolled": ("energy / time", "energy input without control"),
    "input_controlled": ("energy / time", "with control"),
    "relative_input": ("", "with control over without"),
    "dissipation_uncontrolled": ("energy / time", "dissipation without control"),
    "dissipation_controlled": ("energy / time", "with control"),
    "relative_dissipation": ("", "with control over without"),
    "laminarisation_hazard_uncontrolled": (f"1 / {_LT}", "of flows that are not laminar yet"),
    "laminarisation_hazard_controlled": (f"1 / {_LT}", "the same with control"),
    # warnings
    "warning": ("", "which sign: a function of burstcast.warning_signs"),
    "finding": ("", "what was found"),
    "advice": ("", "what to try"),
    # parameters
    "Parameter": ("", "symbol"),
    "Explanation": ("", "of the symbol"),
    "Value": ("", "one column for each case where they differ"),
}
"""Unit and meaning of every column and metric; shares, counts and names have no unit."""

_INTERVALS = (
    *("lyapunov_exponent", "lyapunov_exponent_by_growth", "kaplan_yorke_dimension"),
    *("survival", "escape_rate"),
)
COLUMNS |= {
    f"{name}_{end}": (COLUMNS[name][0], f"{which} end of its confidence interval")
    for name in _INTERVALS
    for end, which in (("low", "lower"), ("high", "upper"))
}

_OTHERWISE = {
    ("control_density", "low"): ("observable", "lower end of the bin"),
    ("control_density", "high"): ("observable", "upper end of the bin"),
    **{("economic_value", end): ("", COLUMNS[end][1]) for end in ("value", "low", "high")},
    ("dataset", "lyapunov_exponent"): (_RATE, "leading one, by QR factorisation"),
}
"""Unit and meaning of what a table calls as others do, and means something else by."""


def unit_and_meaning(column: str, table: str = "") -> tuple[str, str]:
    """Unit and meaning of a column in a table; nothing for one that nobody declared."""
    return _OTHERWISE.get((table, column)) or COLUMNS.get(column, ("", ""))


_HEAD = """\
# Tables

Every table of `<results>/tables`, and every column. Each case has tables of the same names in
`<results>/<case>/tables`, with its own rows alone. Tables are CSV: one line of names, numbers in
full, an empty cell where something is undefined or does not apply. Columns without a unit are
counts, shares or names; "observable" is that of the case (the kinetic energy of the shear flow).
Tables for papers (`*.tex`, LaTeX with `booktabs`) show part of them: medians and quartiles, or
intervals.

This page is made by `python -m burstcast_workflow.table_columns > docs/tables.md`.
"""


def text() -> str:
    """Text of the dictionary of all columns."""
    return _HEAD + "".join(f"{line}\n" for line in _lines())


def _lines() -> Iterator[str]:
    names = [name for name in TABLES if name not in PARAMETER_TABLES]
    names += [f"{name}_percentiles" for name in SUMMARIES]
    for name in [*names, *PARAMETER_TABLES]:
        table = table_of(name)
        yield f"\n## {name}\n\n{fill(table.says, 99)}\n"
        percentiles = name.endswith("_percentiles")
        keys = list(table.keys)
        if percentiles:
            keys += SUMMARIES[name.removesuffix("_percentiles")].keys
        if keys:
            yield f"Keys: {', '.join(f'`{key}`' for key in keys)}.\n"
        if percentiles:
            metrics = ", ".join(f"`{metric}`" for metric in table.metrics.split())
            yield fill(f"Metrics: {metrics}.", 99) + "\n"
            continue
        yield from ("| Column | Unit | Meaning |", "| --- | --- | --- |")
        for column in table.columns.split():
            yield _row(column, of_table=name)
            if column == "metric":
                yield from (_row(metric, "metric ") for metric in table.metrics.split())
    yield "\n## Keys, and columns of percentiles\n"
    yield from ("| Column | Unit | Meaning |", "| --- | --- | --- |")
    yield from map(_row, [*KEYS, "metric", "p25", "p50", "p75", "networks"])


def _row(column: str, kind: str = "", of_table: str = "") -> str:
    unit, meaning = unit_and_meaning(column, of_table)
    return f"| {kind}`{column}` | {unit} | {meaning} |"


if __name__ == "__main__":
    print(text(), end="")
