"""What the columns of tables mean: the one place where each is declared.

``python -m burstcast_workflow.table_columns > docs/tables.md``, where config.yaml is.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from textwrap import fill

from burstcast_workflow.identifiers import KEYS
from burstcast_workflow.table_metrics import NETWORK_KEYS, SUMMARIES
from burstcast_workflow.table_registry import PARAMETER_TABLES


@dataclass(frozen=True)
class TableText:
    """What a table holds.

    Attributes
    ----------
    says
        What a row is, in a sentence or two: the caption in the report, too.
    columns
        Names in their order, the keys aside.
    metrics
        What its column ``metric`` names, if it has one.
    keys
        Columns that tell rows apart.
    """

    says: str
    columns: str
    metrics: str = ""
    keys: tuple[str, ...] = KEYS


_INTERVAL = "value low high"
_ALARM = "alarm probability prediction_time_lt"
_ENSEMBLE = KEYS[:-1]
_STATISTICS = " ".join(SUMMARIES["statistics"].metrics)


def _ends(name: str) -> str:
    """Columns of a value and of its interval."""
    return f"{name} {name}_low {name}_high"


TABLES: dict[str, TableText] = {
    "dataset": TableText(
        "The ensemble of each case: series kept, extreme events, and the leading Lyapunov exponent "
        "with its confidence interval beside the published one.",
        "series_generated series_kept laminarised_fraction mean_observable events_per_series "
        f"{_ends('lyapunov_exponent')} {_ends('lyapunov_exponent_by_growth')} "
        "lyapunov_exponent_paper steps_per_lyapunov_time",
        keys=KEYS[:2],
    ),
    "hyperparameters": TableText(
        "Hyperparameters that the search chose for each network.",
        "spectral_radius input_scaling tikhonov objective solver",
    ),
    "classification": TableText(
        "Counts and scores of the forecasts of each forecaster at each prediction time.",
        "prediction_time_lt true_positive false_positive false_negative true_negative precision "
        "recall f_score",
    ),
    "classification_intervals": TableText(
        "Bootstrap confidence intervals of those scores, over test series.",
        "prediction_time_lt metric low high",
        "precision recall f_score",
    ),
    "horizon": TableText(
        "Prediction horizon of extreme events of each forecaster, averaged over the events.",
        "events mean_horizon_lt median_horizon_lt",
    ),
    "horizon_intervals": TableText(
        "Bootstrap confidence intervals of those averages, over the events.",
        "metric low high",
        "mean_horizon_lt median_horizon_lt",
    ),
    "horizon_differences": TableText(
        "Differences of those averages between two forecasters, on the same resamples of the "
        "events; networks that differ by their seeds are one, by their median in each.",
        f"compared other metric {_INTERVAL}",
        "mean_horizon_lt median_horizon_lt",
        keys=("case",),
    ),
    "probability_scores": TableText(
        "Scores of the probabilities of all who raise alarms, with intervals over test series.",
        f"{_ALARM} metric {_INTERVAL}",
        "alarm_threshold base_rate brier_score brier_skill reliability resolution uncertainty "
        "calibration_error roc_area average_precision precision recall f_score",
    ),
    "probability_differences": TableText(
        "Differences between two who raise alarms, on the same resamples of the test series.",
        f"alarm other prediction_time_lt metric {_INTERVAL}",
        "brier_skill average_precision f_score",
        keys=("case",),
    ),
    "reliability": TableText(
        "Reliability diagrams: how often events follow probabilities of a bin.",
        f"{_ALARM} bin forecasts mean_probability observed_frequency consistency_low "
        "consistency_high",
    ),
    "economic_value": TableText(
        "Relative economic value of alarms to users of each ratio of cost to loss.",
        f"{_ALARM} cost_loss_ratio {_INTERVAL}",
    ),
    "alarm_curves": TableText(
        "Alarms from every probability on: points of the ROC and precision-recall curves.",
        f"{_ALARM} threshold false_alarm_rate recall precision",
    ),
    "lead_times": TableText(
        "How early events were warned of, and how many alarms were false, with intervals over "
        "test series.",
        f"alarm lead_time_lt metric {_INTERVAL}",
        "mean_lead_time_lt mean_first_alarm_lt mean_possible_lead_time_lt missed_fraction "
        "warned_fraction false_alarms_per_lt",
    ),
    "threshold_sweep": TableText(
        "Scores of alarms for events beyond other thresholds.",
        f"alarm event_threshold prediction_time_lt metric {_INTERVAL}",
        "base_rate brier_skill average_precision f_score",
    ),
    "statistics": TableText(
        "Long-term statistics of each forecaster's own flow against those of the data; forecaster "
        "training: of the training series; floor: of random halves of the data (seed: the split).",
        _STATISTICS,
    ),
    "statistics_intervals": TableText(
        "Bootstrap confidence intervals of those statistics, over the long runs.",
        "metric low high",
        _STATISTICS,
    ),
    "survival": TableText(
        "Escapes of the data and of the forecasters' long runs from the chaotic phase, counted "
        "after the first quarter of each run.",
        f"series survived_fraction escapes time_at_risk {_ends('escape_rate')}",
    ),
    "survival_curve": TableText(
        "Share of the series, and of the long runs, that are still in the chaotic phase.",
        f"time {_ends('survival')}",
    ),
    "lyapunov_spectrum": TableText(
        "Lyapunov exponents of the data and of each network's own flow.",
        f"number {_ends('lyapunov_exponent')}",
    ),
    "kaplan_yorke": TableText(
        "Kaplan-Yorke dimension of the data and of each network's own flow.",
        f"runs {_ends('kaplan_yorke_dimension')}",
    ),
    "training_realisations": TableText(
        "Scatter of scores over choices of the training series, and over seeds that share one.",
        "prediction_time_lt metric mean standard_deviation_over_training_sets "
        "standard_deviation_over_seeds training_sets networks",
        metrics="precision recall f_score mean_horizon_lt median_horizon_lt "
        "survived_fraction escape_rate",
        keys=NETWORK_KEYS,
    ),
    "control": TableText(
        "The paper's control by each forecaster; forecaster random: alarms at random, as often as "
        "those of the network.",
        "prediction_time_lt exceedance_uncontrolled exceedance_controlled reduction alarms "
        "false_alarms missed_events unsuppressed_events control_fraction exceedance_free "
        "alarm_rate actuated_integration_steps delayed_events early_alarms "
        "events_after_false_alarms events_after_true_alarms events_between_windows "
        "events_controlled events_uncontrolled events_under_way exceeding_controlled "
        "exceeding_free exceeding_uncontrolled flows forecasts integration_steps laminarised "
        "laminarised_controlled laminarised_uncontrolled left_out steps steps_free "
        "suppressed_events true_alarms",
    ),
    "control_density": TableText(
        "Densities of the observable with and without control, averaged over the networks of an "
        "ensemble.",
        "prediction_time_lt low high density_uncontrolled density_controlled density_free "
        "density_controlled_p25 density_controlled_p75",
        keys=_ENSEMBLE,
    ),
    "control_strategies": TableText(
        "Costs and gains of control in all ways, with bootstrap intervals over flows; where "
        "nothing was left, the upper end is that of the rule of three.",
        "strategy delay_lt noise quiet_lt span_lt starts strength decision_interval_lt horizon_lt "
        "level margin prediction_time_lt probability vote_share window_lt "
        f"metric {_INTERVAL}",
        "exceedance_uncontrolled exceedance_controlled relative_exceedance control_fraction "
        "switchings_per_lyapunov_time events_per_lyapunov_time_uncontrolled "
        "events_per_lyapunov_time_controlled input_uncontrolled input_controlled relative_input "
        "dissipation_uncontrolled dissipation_controlled relative_dissipation "
        "laminarisation_hazard_uncontrolled laminarisation_hazard_controlled",
    ),
    "control_differences": TableText(
        "Differences between two runs of control of the same flows, on the same resamples of them: "
        "another forecaster, or another strategy; networks that differ by their seeds are one, by "
        "their median in each.",
        f"compared strategy other other_strategy metric {_INTERVAL}",
        "relative_exceedance control_fraction",
        keys=("case",),
    ),
    "warnings": TableText(
        "Signs that a result is less than it seems, and what to try. No row, no sign.",
        "warning finding advice",
        keys=_ENSEMBLE,
    ),
    "data_generation_parameters": TableText(
        "Parameters used for data generation; text in LaTeX.",
        "Parameter Explanation Value",
        keys=(),
    ),
    "network_hyperparameters": TableText(
        "Hyperparameters of the echo state networks; several values: optimised in that range. "
        "Text in LaTeX.",
        "Parameter Explanation Value",
        keys=(),
    ),
}
"""Tables by name; percentiles follow from `burstcast_workflow.table_metrics`."""

_PERCENTILES = (
    "25th, 50th and 75th percentiles over the networks of an ensemble, in long form: one row for "
    "each metric. Networks for which a metric is undefined are left out."
)

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
    "low": (
        "of the metric",
        "lower end of the confidence interval; of control_density: of the bin",
    ),
    "high": (
        "of the metric",
        "upper end of the confidence interval; of control_density: of the bin",
    ),
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
    "lyapunov_exponent": (_RATE, "by QR factorisation: of the data the leading one in dataset"),
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
    "survived_fraction": ("", "of them, those that never leave the chaotic phase"),
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
    "exceedance_controlled": ("", "the same with control"),
    "exceedance_free": ("", "the same with control, time under actuation left out"),
    "reduction": ("", "share of the exceedance that control removes"),
    "relative_exceedance": ("", "share of the exceedance that is left"),
    "control_fraction": ("", "share of the time under actuation"),
    "alarms": ("", "forecasts that raised an alarm"),
    "alarm_rate": ("", "alarms / forecasts"),
    "true_alarms": ("", "after which the event would have come, had nobody acted"),
    "false_alarms": ("", "the others"),
    "early_alarms": ("", "of the false ones: the event had begun before the window"),
    "suppressed_events": ("", "true alarms after which no event comes in the window"),
    "delayed_events": ("", "of them: the event comes before the next forecast after all"),
    "unsuppressed_events": ("", "true alarms after which the event comes"),
    "missed_events": ("", "events in a window for which no alarm was raised"),
    "events_under_way": ("", "the same, a former event not being over"),
    "events_after_true_alarms": ("", "events in the window of a true alarm"),
    "events_after_false_alarms": ("", "events in the window of a false alarm"),
    "events_between_windows": ("", "events in no forecast's window"),
    "events_uncontrolled": ("", "all events without control"),
    "events_controlled": ("", "all events with control"),
    "flows": ("", "flows that count"),
    "left_out": ("", "flows with an event before anything could be done about it"),
    "laminarised": ("", "flows that laminarise with control or without: they do not count"),
    "laminarised_controlled": ("", "of them, with control"),
    "laminarised_uncontrolled": ("", "of them, without control"),
    "steps": ("", "steps that count"),
    "steps_free": ("", "of the controlled flows, those that are reached without actuation"),
    "exceeding_uncontrolled": ("", "of the steps, those at or above the threshold"),
    "exceeding_controlled": ("", "the same with control"),
    "exceeding_free": ("", "the same with control, outside actuation"),
    "integration_steps": ("", "integration steps that count"),
    "actuated_integration_steps": ("", "of them, under actuation"),
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


def table_text(name: str) -> TableText:
    """What a table holds, those of percentiles included."""
    if name in TABLES:
        return TABLES[name]
    results = name.removesuffix("_percentiles")
    summary = SUMMARIES[results]
    return TableText(
        f"{TABLES[results].says} {_PERCENTILES}",
        " ".join([*summary.keys, "metric p25 p50 p75 networks"]),
        " ".join(summary.metrics),
        NETWORK_KEYS,
    )


_HEAD = """\
# Tables

Every table of `<results>/tables`, and every column. Each case has tables of the same names in
`<results>/<case>/tables`, with its own rows alone. Tables are CSV: one line of names, numbers in
full, an empty cell where something is undefined or does not apply. Columns have no unit where none
is given; "observable" is that of the case (the kinetic energy of the shear flow). Tables for papers
(`*.tex`, LaTeX with `booktabs`) show part of them: medians and quartiles, or intervals.

This page is made by `python -m burstcast_workflow.table_columns > docs/tables.md`.
"""


def text() -> str:
    """Text of the dictionary of all columns."""
    return _HEAD + "".join(f"{line}\n" for line in _lines())


def _lines() -> Iterator[str]:
    names = [name for name in TABLES if name not in PARAMETER_TABLES]
    names += [f"{name}_percentiles" for name in SUMMARIES]
    for name in [*names, *PARAMETER_TABLES]:
        table = table_text(name)
        yield f"\n## {name}\n\n{fill(table.says, 99)}\n"
        if table.keys:
            yield f"Keys: {', '.join(f'`{key}`' for key in table.keys)}.\n"
        if name.endswith("_percentiles"):
            metrics = ", ".join(f"`{metric}`" for metric in table.metrics.split())
            yield fill(f"Metrics: {metrics}.", 99) + "\n"
            continue
        yield from ("| Column | Unit | Meaning |", "| --- | --- | --- |")
        for column in table.columns.split():
            yield _row(column)
            if column == "metric":
                yield from (_row(metric, "metric ") for metric in table.metrics.split())
    yield "\n## Keys, and columns of percentiles\n"
    yield from ("| Column | Unit | Meaning |", "| --- | --- | --- |")
    yield from map(_row, [*KEYS, "metric", "p25", "p50", "p75", "networks"])


def _row(column: str, kind: str = "") -> str:
    unit, meaning = COLUMNS[column]
    return f"| {kind}`{column}` | {unit} | {meaning} |"


if __name__ == "__main__":
    print(text(), end="")
