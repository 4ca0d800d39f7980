"""The tables: which there are, and which cases of a campaign have them.

Each case has tables of its own, made by a stage of ``workflow/rules/tables.smk`` or
``probabilities.smk``; those of the campaign have the rows of all cases.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence

from burstcast_workflow.campaign import Campaign, CaseForecaster, ControlRun
from burstcast_workflow.table_metrics import SUMMARIES
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

TABLES: Mapping[str, Cases] = {
    "dataset": _all,
    "hyperparameters": _with_networks,
    "classification": _all,
    "classification_intervals": _all,
    "horizon": _all,
    "horizon_intervals": _all,
    "horizon_differences": _all,
    "probability_scores": _all,
    "probability_differences": _all,
    "reliability": _all,
    "economic_value": _all,
    "alarm_curves": _all,
    "lead_times": _all,
    "threshold_sweep": _all,
    "statistics": _with_long_runs,
    "statistics_intervals": _with_long_runs,
    "survival": _with_long_runs,
    "survival_curve": _with_long_runs,
    "lyapunov_spectrum": _with_spectra,
    "kaplan_yorke": _with_spectra,
    "control": _controlled,
    "control_density": _controlled,
    "control_strategies": _controlled_in_any_way,
    "control_differences": _controlled_in_any_way,
    "warnings": _all,
}
"""Tables of cases."""

PARAMETER_TABLES: Mapping[str, Cases] = {
    "data_generation_parameters": lambda campaign: campaign.simulated_cases,
    "network_hyperparameters": _with_networks,
}
"""Tables of the campaign that no case has by itself: their text is LaTeX already."""


def cases_of_tables(campaign: Campaign) -> dict[str, list[str]]:
    """Cases by table that has rows of them, percentiles over networks included."""
    found = {name: list(cases(campaign)) for name, cases in TABLES.items()}
    percentiles = {f"{name}_percentiles": found[name] for name in SUMMARIES}
    return {name: cases for name, cases in {**found, **percentiles}.items() if cases}


def table_names(campaign: Campaign) -> list[str]:
    """Names of all tables of a campaign."""
    parameters = [name for name, cases in PARAMETER_TABLES.items() if cases(campaign)]
    realisations = ["training_realisations"] if campaign.realised_cases else []
    return [*cases_of_tables(campaign), *realisations, *parameters]


def latex_names(campaign: Campaign) -> list[str]:
    """Names of a campaign's tables for papers."""
    names = table_names(campaign)
    return [name for name in [*LAYOUTS, *PARAMETER_TABLES] if source_of(name) in names]
