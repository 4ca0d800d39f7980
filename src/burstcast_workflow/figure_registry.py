"""The figures: which files and settings each is made of, and for which cases.

A figure is an entry here, a script of the same name in ``workflow/scripts/figures``, whose
docstring is the caption, and a module of `burstcast.figures` that draws it. One rule makes them all
(``workflow/rules/figures.smk``).
"""

import ast
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from burstcast_workflow.alarm_sources import shown_committees
from burstcast_workflow.campaign import Campaign, CaseForecaster, ControlRun
from burstcast_workflow.config.measured_cases import OBSERVABLE
from burstcast_workflow.setting_groups import listed

Cases = Callable[[Campaign], Sequence[str]]


# -- what figures choose of the campaign -----------------------------------------------------------


def _reynolds_cases(campaign: Campaign) -> list[str]:
    """One case for each Reynolds number that has networks of the size that is held fixed."""
    cases: dict[float, str] = {}
    for one in campaign.select(neurons=campaign.config["figures"]["fixed_neurons"]):
        reynolds = campaign.reynolds(one.case)
        if reynolds is not None:
            cases.setdefault(reynolds, one.case)
    return list(cases.values())


def long_term_candidates(campaign: Campaign, case: str) -> list[CaseForecaster]:
    """Networks of a case, the best of which stands for all where only one can be shown."""
    size = campaign.config["figures"]["fixed_neurons"]
    networks = [
        one
        for one in campaign.long_term_forecasters
        if one.case == case and one.name.neurons == size
    ]
    example = campaign.example.name.validation
    strategies = {str(one.name.validation) for one in networks}
    shown = example if example in strategies else min(strategies, default=example)
    return [one for one in networks if one.name.validation == shown]


def _by_network(run: ControlRun) -> bool:
    return run.controller.kind == "esn" and run.controller.role is None


def _network_runs(campaign: Campaign) -> list[ControlRun]:
    """The paper's control by networks."""
    return [run for run in campaign.control_runs if _by_network(run)]


def control_example(campaign: Campaign) -> ControlRun | None:
    """Run of control that the figures of one event are taken from; None if there is none.

    The example's network, or else the first one that controls so far ahead.
    """
    time = campaign.config["figures"]["control_prediction_time_lt"]
    runs = [run for run in _network_runs(campaign) if run.prediction_time_lt == time]
    example = campaign.example
    own = [run for run in runs if (run.case, run.controller) == (example.case, example.name)]
    return next(iter([*own, *runs]), None)


def _control_kind(campaign: Campaign, case: str) -> dict[str, Any]:
    """Size and validation strategy that the figures of control show for a case."""
    names = [run.controller for run in _network_runs(campaign) if run.case == case]
    kinds = [{"neurons": name.neurons, "validation": name.validation} for name in names]
    wanted = {
        "neurons": campaign.config["figures"]["fixed_neurons"],
        "validation": campaign.example.name.validation,
    }
    return wanted if wanted in kinds else kinds[0]


def _panels(campaign: Campaign, case: str) -> list[dict[str, Any]]:
    """All controlled cases of a case's system."""
    return [
        {
            "identity": {"case": other},
            "settings": campaign.settings(["case.event_threshold"], {"case": other}, {}),
            "kind": _control_kind(campaign, other),
        }
        for other in _controlled(campaign)
        if campaign.cases[other]["system"] == campaign.cases[case]["system"]
    ]


def _frontier_network(campaign: Campaign, case: str) -> dict[str, Any] | None:
    """Network whose control by all strategies is shown: the example's, or else the first one."""
    names = [
        run.controller for run in campaign.strategy_runs if run.case == case and _by_network(run)
    ]
    name = next((name for name in names if name == campaign.example.name), next(iter(names), None))
    return None if name is None else name.keys


def _observed(campaign: Campaign, case: str) -> dict[str, int]:
    """How many components are observed beside the observable, in a case and in its parts.

    Parts whose past is seen, too, are others.
    """
    parts = {
        part: sum(name != OBSERVABLE for name in campaign.cases[part]["data"]["components"])
        for part in campaign.measured_cases
        if campaign.source_case(part) == case and not campaign.cases[part]["data"]["delays"]
    }
    return {case: campaign.dimension(case), **parts} if parts else {}


def _strategies(campaign: Campaign, case: str) -> list[str]:
    names = {one.name.validation for one in campaign.networks if one.case == case}
    return sorted((str(name) for name in names), reverse=True)


def _with_other_strategies(campaign: Campaign, case: str) -> list[str]:
    name = campaign.example.name
    networks = campaign.select(case=case, kind="esn", neurons=name.neurons, seed=name.seed)
    return [one.directory for one in networks]


def _suppressed_event(campaign: Campaign, case: str) -> str:
    run = control_example(campaign)
    assert run is not None
    return f"{run.directory}/suppressed_event.nc"


# What entries name: places below the results directory (several, where files are gathered), ...
_PLACES: Mapping[str, Callable[[Campaign, str], str | list[str]]] = {
    "case": lambda campaign, case: case,
    "shown_cases": lambda campaign, case: _reynolds_cases(campaign),
    "panels": lambda campaign, case: [
        panel["identity"]["case"] for panel in _panels(campaign, case)
    ],
    "time_unit": Campaign.time_unit,
    "example": lambda campaign, case: campaign.example.directory,
    "example_hyperparameters": lambda campaign, case: (
        f"{campaign.example.directory}/{campaign.hyperparameters_file}"
    ),
    "example_strategies": _with_other_strategies,
    "candidates": lambda campaign, case: [
        one.directory for one in long_term_candidates(campaign, case)
    ],
    "suppressed_event": _suppressed_event,
    # a case and those that are parts of it
    "parts": lambda campaign, case: list(_observed(campaign, case)),
}
# Those that gather files of several cases.
_OF_SEVERAL_CASES = ("shown_cases", "panels", "parts")
# ... and settings that are not in the config.
_SHOWN: Mapping[str, Callable[[Campaign, str], Any]] = {
    "shown_neurons": lambda campaign, case: campaign.example.name.neurons,
    "shown_validation": lambda campaign, case: campaign.example.name.validation,
    "observed": _observed,
    "strategies": _strategies,
    "rows": lambda campaign, case: campaign.keys(long_term_candidates(campaign, case)),
    "prediction_time_lt": lambda campaign, case: getattr(
        control_example(campaign), "prediction_time_lt", None
    ),
    "controlling": _control_kind,
    "frontier_network": _frontier_network,
    "panels": _panels,
}


# -- for which cases a figure is made: the first of them has the plain name ------------------------


def _example(campaign: Campaign) -> list[str]:
    return [campaign.example.case]


def _every(campaign: Campaign) -> list[str]:
    """All cases, the example's first."""
    return list(dict.fromkeys([campaign.example.case, *campaign.case_names]))


def _with_sizes(campaign: Campaign) -> list[str]:
    """The example's, and others with networks of several sizes."""
    sizes = {
        case: {one.name.neurons for one in campaign.networks if one.case == case}
        for case in _every(campaign)
    }
    return [case for case in sizes if case == campaign.example.case or len(sizes[case]) > 1]


def _with_reynolds(campaign: Campaign) -> list[str]:
    return _example(campaign) if len(_reynolds_cases(campaign)) > 1 else []


def _with_committees(campaign: Campaign) -> list[str]:
    return [case for case in _example(campaign) if shown_committees(campaign, case)]


def _with_parts(campaign: Campaign) -> list[str]:
    """Cases that others are parts of."""
    return [case for case in _every(campaign) if _observed(campaign, case)]


def _with_long_term(campaign: Campaign) -> list[str]:
    return [case for case in _every(campaign) if long_term_candidates(campaign, case)]


def _with_spectrum(campaign: Campaign) -> list[str]:
    cases = {one.case for one in campaign.spectrum_forecasters} & {*campaign.simulated_cases}
    return [case for case in _with_long_term(campaign) if case in cases]


def _control_example(campaign: Campaign) -> list[str]:
    run = control_example(campaign)
    return [] if run is None else [run.case]


def _controlled(campaign: Campaign) -> list[str]:
    """Cases that networks control, the example's first if it is one of them."""
    cases = dict.fromkeys(run.case for run in _network_runs(campaign))
    return sorted(cases, key=lambda case: case != campaign.example.case)


def _controlled_systems(campaign: Campaign) -> list[str]:
    """One controlled case of each system: a figure shows all cases of a system."""
    first: dict[str, str] = {}
    for case in _controlled(campaign):
        first.setdefault(campaign.cases[case]["system"], case)
    return list(first.values())


def _with_frontier(campaign: Campaign) -> list[str]:
    """Cases that are controlled in other ways than the paper's, too, the example's first."""
    own = set(campaign.control_runs)
    cases = {run.case for run in campaign.strategy_runs if run not in own}
    return [case for case in _every(campaign) if case in cases]


def _flows(cases: Cases) -> Cases:
    """Those cases that are flows."""
    return lambda campaign: [case for case in cases(campaign) if campaign.has_flow(case)]


# -- the registry ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Figure:
    """A figure of the report.

    Attributes
    ----------
    places
        Inputs of its script by name: a name of `_PLACES`, or one and a file there.
    settings
        Settings that its script reads, as one text (`burstcast_workflow.setting_groups.listed`).
    shows
        Further settings, names of `_SHOWN`.
    cases
        Cases that it is made for: the first has the plain name, those of others end in ``_<case>``.
    published
        Whether the paper's published values can be drawn on it.
    """

    places: Mapping[str, str] = field(default_factory=dict)
    settings: str = ""
    shows: str = ""
    cases: Cases = _example
    published: bool = False

    @property
    def reads(self) -> list[str]:
        """Paths of the settings."""
        return listed(self.settings)

    @property
    def of_several_cases(self) -> bool:
        """Whether it shows more than one case."""
        return any(place.partition("/")[0] in _OF_SEVERAL_CASES for place in self.places.values())

    def files(self, campaign: Campaign, case: str) -> dict[str, str | list[str]]:
        """Inputs of the script by name, below the results directory."""
        return {name: _paths(place, campaign, case) for name, place in self.places.items()}

    def values(self, campaign: Campaign, case: str) -> dict[str, Any]:
        """Further settings by name."""
        return {name: _SHOWN[name](campaign, case) for name in self.shows.split()}


def _paths(place: str, campaign: Campaign, case: str) -> str | list[str]:
    name, slash, file = place.partition("/")
    found = _PLACES[name](campaign, case)
    if isinstance(found, str):
        return f"{found}{slash}{file}"
    return [f"{directory}{slash}{file}" for directory in found]


_SERIES = {"ensemble": "case/ensemble.nc", "time_unit": "time_unit"}
_STATISTICS = {
    "data": "case/statistics_data.nc",
    "training": "case/statistics_training.nc",
    "long_term": "candidates/long_term.nc",
}
_OF_STATISTICS = {
    **_STATISTICS,
    "percentiles": "case/tables/statistics_percentiles.csv",
    "intervals": "case/tables/statistics_intervals.csv",
}

FIGURES: Mapping[str, Figure] = {
    "observable_and_density": Figure(
        _SERIES, "SYSTEM TIME case.event_threshold case.density", cases=_every
    ),
    "validation_strategies": Figure(
        _SERIES,
        "SYSTEM TIME case.event_threshold case.recycle_validation washout_lt search.interval_lt",
        "strategies",
    ),
    "network_schematic": Figure(
        {"hyperparameters": "example_hyperparameters"},
        "SYSTEM forecasters.esn.connectivity forecasters.esn.input_bias",
        "shown_neurons",
    ),
    "search_landscape": Figure({"traces": "example_strategies/search.csv"}),
    "prediction_schematic": Figure(
        {"examples": "example/examples.nc"},
        "SYSTEM case.event_threshold figures.example_prediction_time_lt classification.window_lt "
        "washout_lt",
    ),
    "prediction_examples": Figure(
        {"examples": "example/examples.nc"},
        "SYSTEM case.event_threshold figures.example_prediction_time_lt classification.window_lt",
    ),
    "classification_scores": Figure(
        {"percentiles": "case/tables/classification_percentiles.csv"},
        "figures.fixed_neurons figures.fixed_prediction_time_lt",
        "shown_validation",
        _every,
        published=True,
    ),
    "horizon_schematic": Figure(
        settings="SYSTEM horizon.longest_lead_time_lt horizon.lead_time_step_lt horizon.tolerance"
    ),
    "horizon_evaluations": Figure(
        {"examples": "example/examples.nc"}, "SYSTEM case.event_threshold washout_lt"
    ),
    "horizon_by_size": Figure(
        {
            "percentiles": "case/tables/horizon_percentiles.csv",
            "intervals": "case/tables/horizon_intervals.csv",
        },
        cases=_with_sizes,
        published=True,
    ),
    "forecast_skill": Figure(
        {"scores": "case/tables/probability_scores.csv"},
        "figures.fixed_neurons",
        "shown_validation",
        _every,
    ),
    "reliability": Figure(
        {"bins": "case/tables/reliability.csv"},
        "figures.fixed_neurons figures.reynolds_prediction_times_lt",
        "shown_validation",
    ),
    "economic_value": Figure(
        {"values": "case/tables/economic_value.csv"},
        "figures.fixed_neurons figures.reynolds_prediction_times_lt",
        "shown_validation",
    ),
    "alarm_lead_times": Figure(
        {"lead_times": "case/tables/lead_times.csv"},
        "figures.fixed_neurons",
        "shown_validation",
    ),
    "committee_event": Figure(
        {"event": "case/committee_event.nc"},
        "SYSTEM case.event_threshold classification.window_lt",
        cases=_with_committees,
    ),
    "by_reynolds": Figure(
        {
            "horizons": "shown_cases/tables/horizon_percentiles.csv",
            "scores": "shown_cases/tables/classification_percentiles.csv",
        },
        "figures.fixed_neurons figures.reynolds_prediction_times_lt",
        cases=_with_reynolds,
        published=True,
    ),
    "observed_components": Figure(
        {"percentiles": "parts/tables/classification_percentiles.csv"},
        "figures.fixed_neurons figures.reynolds_prediction_times_lt",
        "observed",
        _with_parts,
    ),
    "long_term_density": Figure(
        _OF_STATISTICS,
        "SYSTEM case.event_threshold",
        "rows",
        _with_long_term,
        published=True,
    ),
    "survival": Figure(
        {
            "curves": "case/tables/survival_curve.csv",
            "curve_percentiles": "case/tables/survival_curve_percentiles.csv",
            "rates": "case/tables/survival.csv",
            "rate_percentiles": "case/tables/survival_percentiles.csv",
        },
        "figures.fixed_neurons",
        cases=_with_long_term,
    ),
    "lyapunov_spectrum": Figure(
        {
            "exponents": "case/tables/lyapunov_spectrum.csv",
            "exponent_percentiles": "case/tables/lyapunov_spectrum_percentiles.csv",
            "dimensions": "case/tables/kaplan_yorke.csv",
            "dimension_percentiles": "case/tables/kaplan_yorke_percentiles.csv",
        },
        "figures.fixed_neurons",
        cases=_with_spectrum,
    ),
    "profile_errors": Figure(
        _OF_STATISTICS,
        "SYSTEM statistics.profile_points",
        "rows",
        _flows(_with_long_term),
        published=True,
    ),
    "midplane_mean_square": Figure(
        _STATISTICS, "SYSTEM figures.flow_points", "rows", _flows(_with_long_term)
    ),
    "midplane_planes": Figure(
        {"event": "example/flow_event.nc"},
        "SYSTEM figures.flow_points case.event_threshold",
        cases=_flows(_example),
    ),
    "vorticity_isosurfaces": Figure(
        {"event": "example/flow_event.nc"},
        "SYSTEM figures.flow_points figures.isosurface_level",
        cases=_flows(_example),
    ),
    "control_schematic": Figure(
        {"event": "suppressed_event"},
        "SYSTEM case.event_threshold case.actuation.parameters case.actuation.force "
        "control.window_lt",
        "prediction_time_lt",
        _control_example,
    ),
    "suppressed_event": Figure(
        {"event": "suppressed_event"},
        "SYSTEM figures.flow_points case.event_threshold",
        cases=_flows(_control_example),
    ),
    "control_tradeoff": Figure(
        {"percentiles": "case/tables/control_percentiles.csv"},
        "SYSTEM",
        "controlling",
        _controlled,
        published=True,
    ),
    "control_density": Figure(
        {"densities": "panels/tables/control_density.csv"},
        "SYSTEM control.prediction_times_lt",
        "panels",
        _controlled_systems,
    ),
    "control_frontier": Figure(
        {"scores": "case/tables/control_strategies.csv"},
        "SYSTEM case.training.noise control.span_lt",
        "frontier_network",
        _with_frontier,
    ),
}
"""All figures by name, in the order of the paper."""


def figure_case(campaign: Campaign, name: str, suffix: str) -> str:
    """Case that a figure shows: that of its name's end, or the first that it is made for."""
    if suffix:
        return suffix.removeprefix("_")
    return next(iter(FIGURES[name].cases(campaign)), campaign.example.case)


def figure_names(campaign: Campaign) -> list[str]:
    """Names of all figures of a campaign."""
    return [
        name if index == 0 else f"{name}_{case}"
        for name, figure in FIGURES.items()
        for index, case in enumerate(dict.fromkeys(figure.cases(campaign)))
    ]


def caption(script: Path) -> str:
    """What a figure shows, in reStructuredText: the docstring of its script."""
    return " ".join((ast.get_docstring(ast.parse(script.read_bytes())) or "").split())
