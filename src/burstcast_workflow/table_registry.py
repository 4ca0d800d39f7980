"""The tables: what each holds, and which cases of a campaign have it.

Each case has tables of its own, made by a stage of ``workflow/rules/tables.smk`` or
``probabilities.smk``; those of the campaign have the rows of all cases.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from burstcast_workflow.campaign import Campaign, CaseForecaster, ControlRun
from burstcast_workflow.identifiers import KEYS
from burstcast_workflow.table_metrics import NETWORK_KEYS, SUMMARIES
from burstcast_workflow.table_texts import LAYOUTS, source_of

Cases = Callable[[Campaign], Sequence[str]]


def _all(campaign: Campaign) -> Sequence[str]:
    return campaign.case_names


def _cases_of(whose: Callable[[Campaign], Iterable[CaseForecaster | ControlRun]]) -> Cases:
    """Cases of some forecasters, or of some runs of control."""
    return lambda campaign: list(dict.fromkeys(one.case for one in whose(campaign)))


_with_networks = _cases_of(lambda campaign: campaign.networks)
_with_long_runs = _cases_of(lambda campaign: campaign.long_term_forecasters)
_with_spectra = _cases_of(lambda campaign: campaign.spectrum_forecasters)
_controlled = _cases_of(lambda campaign: campaign.control_runs)
_controlled_in_any_way = _cases_of(lambda campaign: campaign.strategy_runs)


@dataclass(frozen=True)
class Table:
    """A table.

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
    cases
        Those of a campaign that it has rows of.
    of_cases
        Whether each case has one of its own, which are joined to that of the campaign.
    """

    says: str
    columns: str
    metrics: str = ""
    keys: tuple[str, ...] = KEYS
    cases: Cases = _all
    of_cases: bool = True


_INTERVAL = "value low high"
_PARAMETERS = "Parameter Explanation Value"
_ALARM = "alarm probability prediction_time_lt"
_ENSEMBLE = KEYS[:-1]
_STATISTICS = " ".join(SUMMARIES["statistics"].metrics)


def _ends(name: str) -> str:
    """Columns of a value and of its interval."""
    return f"{name} {name}_low {name}_high"


SCATTERED = ("classification", "horizon", "statistics", "survival")
"""Tables whose scatter over seeds is told apart from that over training sets."""


TABLES: dict[str, Table] = {
    "dataset": Table(
        "The ensemble of each case: series kept, extreme events, and the leading Lyapunov exponent "
        "with its confidence interval beside the published one.",
        "series_generated series_kept laminarised_fraction mean_observable events_per_series "
        f"{_ends('lyapunov_exponent')} {_ends('lyapunov_exponent_by_growth')} "
        "lyapunov_exponent_paper steps_per_lyapunov_time",
        keys=KEYS[:2],
    ),
    "hyperparameters": Table(
        "Hyperparameters that the search chose for each network.",
        "spectral_radius input_scaling tikhonov objective solver",
        cases=_with_networks,
    ),
    "classification": Table(
        "Counts and scores of the forecasts of each forecaster at each prediction time.",
        "prediction_time_lt true_positive false_positive false_negative true_negative precision "
        "recall f_score",
    ),
    "classification_intervals": Table(
        "Bootstrap confidence intervals of those scores, over test series.",
        "prediction_time_lt metric low high",
        "precision recall f_score",
    ),
    "horizon": Table(
        "Prediction horizon of extreme events of each forecaster, averaged over the events.",
        "events mean_horizon_lt median_horizon_lt",
    ),
    "horizon_intervals": Table(
        "Bootstrap confidence intervals of those averages, over the events.",
        "metric low high",
        "mean_horizon_lt median_horizon_lt",
    ),
    "horizon_differences": Table(
        "Differences of those averages between two forecasters, on the same resamples of the "
        "events; networks that differ by their seeds are one, by their median in each.",
        f"compared other metric {_INTERVAL}",
        "mean_horizon_lt median_horizon_lt",
        keys=("case",),
    ),
    "probability_scores": Table(
        "Scores of the probabilities of all who raise alarms, with intervals over test series.",
        f"{_ALARM} metric {_INTERVAL}",
        "alarm_threshold base_rate brier_score brier_skill reliability resolution uncertainty "
        "calibration_error roc_area average_precision precision recall f_score",
    ),
    "probability_differences": Table(
        "Differences between two who raise alarms, on the same resamples of the test series.",
        f"alarm other prediction_time_lt metric {_INTERVAL}",
        "brier_skill average_precision f_score",
        keys=("case",),
    ),
    "reliability": Table(
        "Reliability diagrams: how often events follow probabilities of a bin.",
        f"{_ALARM} bin forecasts mean_probability observed_frequency consistency_low "
        "consistency_high",
    ),
    "economic_value": Table(
        "Relative economic value of alarms to users of each ratio of cost to loss.",
        f"{_ALARM} cost_loss_ratio {_INTERVAL}",
    ),
    "alarm_curves": Table(
        "Alarms from every probability on: points of the ROC and precision-recall curves.",
        f"{_ALARM} threshold false_alarm_rate recall precision",
    ),
    "lead_times": Table(
        "How early events were warned of, and how many alarms were false, with intervals over "
        "test series.",
        f"alarm lead_time_lt metric {_INTERVAL}",
        "mean_lead_time_lt mean_first_alarm_lt mean_possible_lead_time_lt missed_fraction "
        "warned_fraction false_alarms_per_lt",
    ),
    "threshold_sweep": Table(
        "Scores of alarms for events beyond other thresholds.",
        f"alarm event_threshold prediction_time_lt metric {_INTERVAL}",
        "base_rate brier_skill average_precision f_score",
    ),
    "statistics": Table(
        "Long-term statistics of each forecaster's own flow against those of the data; forecaster "
        "training: of the training series; floor: of random halves of the data (seed: the split).",
        _STATISTICS,
        cases=_with_long_runs,
    ),
    "statistics_intervals": Table(
        "Bootstrap confidence intervals of those statistics, over the long runs.",
        "metric low high",
        _STATISTICS,
        cases=_with_long_runs,
    ),
    "survival": Table(
        "Escapes of the data and of the forecasters' long runs from the chaotic phase, counted "
        "after the first quarter of each run.",
        f"series survived_fraction escapes time_at_risk {_ends('escape_rate')}",
        cases=_with_long_runs,
    ),
    "survival_curve": Table(
        "Share of the series, and of the long runs, that are still in the chaotic phase.",
        f"time {_ends('survival')}",
        cases=_with_long_runs,
    ),
    "lyapunov_spectrum": Table(
        "Lyapunov exponents of the data and of each network's own flow.",
        f"number {_ends('lyapunov_exponent')}",
        cases=_with_spectra,
    ),
    "kaplan_yorke": Table(
        "Kaplan-Yorke dimension of the data and of each network's own flow.",
        f"runs {_ends('kaplan_yorke_dimension')}",
        cases=_with_spectra,
    ),
    "training_realisations": Table(
        "Scatter of scores over choices of the training series, and over seeds that share one.",
        "prediction_time_lt metric mean standard_deviation_over_training_sets "
        "standard_deviation_over_seeds training_sets networks",
        metrics=" ".join(name for table in SCATTERED for name in SUMMARIES[table].metrics),
        keys=NETWORK_KEYS,
        cases=lambda campaign: campaign.realised_cases,
        of_cases=False,
    ),
    "control": Table(
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
        cases=_controlled,
    ),
    "control_density": Table(
        "Densities of the observable with and without control, averaged over the networks of an "
        "ensemble.",
        "prediction_time_lt low high density_uncontrolled density_controlled density_free "
        "density_controlled_p25 density_controlled_p75",
        keys=_ENSEMBLE,
        cases=_controlled,
    ),
    "control_strategies": Table(
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
        cases=_controlled_in_any_way,
    ),
    "control_differences": Table(
        "Differences between two runs of control of the same flows, on the same resamples of them: "
        "another forecaster, or another strategy; networks that differ by their seeds are one, by "
        "their median in each.",
        f"compared strategy other other_strategy metric {_INTERVAL}",
        "relative_exceedance control_fraction",
        keys=("case",),
        cases=_controlled_in_any_way,
    ),
    "warnings": Table(
        "Signs that a result is less than it seems, and what to try. No row, no sign.",
        "warning finding advice",
        keys=_ENSEMBLE,
    ),
    "data_generation_parameters": Table(
        "Parameters used for data generation; text in LaTeX.",
        _PARAMETERS,
        keys=(),
        cases=lambda campaign: campaign.simulated_cases,
        of_cases=False,
    ),
    "network_hyperparameters": Table(
        "Hyperparameters of the echo state networks; several values: optimised in that range. "
        "Text in LaTeX.",
        _PARAMETERS,
        keys=(),
        cases=_with_networks,
        of_cases=False,
    ),
}
"""Tables by name; percentiles follow from `burstcast_workflow.table_metrics`."""

PARAMETER_TABLES = tuple(name for name, table in TABLES.items() if table.columns == _PARAMETERS)
"""Tables whose text is LaTeX already."""

_PERCENTILES = (
    "25th, 50th and 75th percentiles over the networks of an ensemble, in long form: one row for "
    "each metric. Networks for which a metric is undefined are left out."
)


def table_of(name: str) -> Table:
    """A table by its name, those of percentiles included."""
    if name in TABLES:
        return TABLES[name]
    table = TABLES[name.removesuffix("_percentiles")]
    summary = SUMMARIES[name.removesuffix("_percentiles")]
    return Table(
        f"{table.says} {_PERCENTILES}",
        " ".join([*summary.keys, "metric p25 p50 p75 networks"]),
        " ".join(summary.metrics),
        NETWORK_KEYS,
        table.cases,
    )


def cases_of_tables(campaign: Campaign) -> dict[str, list[str]]:
    """Cases by table that has rows of them, percentiles over networks included."""
    names = [name for name, table in TABLES.items() if table.of_cases]
    names += [f"{name}_percentiles" for name in SUMMARIES]
    found = {name: list(table_of(name).cases(campaign)) for name in names}
    return {name: cases for name, cases in found.items() if cases}


def table_names(campaign: Campaign) -> list[str]:
    """Names of all tables of a campaign."""
    others = [
        name for name, table in TABLES.items() if not table.of_cases and table.cases(campaign)
    ]
    return [*cases_of_tables(campaign), *others]


def latex_names(campaign: Campaign) -> list[str]:
    """Names of a campaign's tables for papers."""
    names = table_names(campaign)
    return [name for name in [*LAYOUTS, *PARAMETER_TABLES] if source_of(name) in names]
