"""Names in declarations of figures: places of files, choices of cases, settings of what is shown.

A figure is a module of `burstcast.figures`, which declares what it is made of
(`burstcast.figures.registry.Declaration`). One rule makes all of them
(``workflow/rules/figures.smk``).
"""

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from burstcast.discovery import suggestion
from burstcast.figures.registry import Declaration, available_figures, declaration
from burstcast.forecasters.registry import kind_class
from burstcast.observation.velocity_sensors import PlaneFlow
from burstcast_workflow.campaign.campaign import Campaign, CaseForecaster, ControlRun, nearest
from burstcast_workflow.campaign.job_settings import settings_of_job
from burstcast_workflow.tables.declarations import SECTIONS

Value = TypeVar("Value")


def _declared() -> dict[str, Declaration]:
    figures = {name: declaration(name) for name in available_figures()}

    def place(name: str) -> tuple[str, int]:
        return _named(SECTIONS, figures[name].section, "section"), figures[name].position

    return {name: figures[name] for name in sorted(figures, key=place)}


# -- what figures choose of the campaign -----------------------------------------------------------


def _reynolds_cases(campaign: Campaign) -> list[str]:
    """One case for each Reynolds number that has networks of the size that is held fixed."""
    cases: dict[float, str] = {}
    for one in campaign.select(neurons=campaign.config.figures.fixed_neurons):
        reynolds = campaign.cases[one.case].parameters.get("reynolds")
        if reynolds is not None:
            cases.setdefault(reynolds, one.case)
    return list(cases.values())


def long_term_candidates(campaign: Campaign, case: str) -> list[CaseForecaster]:
    """Networks of a case, the best of which stands for all where only one can be shown."""
    size = campaign.config.figures.fixed_neurons
    networks = [
        one
        for one in campaign.long_term_forecasters
        if one.case == case and one.name.neurons == size and one.name.label is None
    ]
    example = campaign.example.name.validation
    strategies = {str(one.name.validation) for one in networks}
    shown = example if example in strategies else min(strategies, default=example)
    return [one for one in networks if one.name.validation == shown]


def _by_network(run: ControlRun) -> bool:
    controller = run.controller
    return controller.kind == "esn" and controller.role is None and controller.label is None


def _network_runs(campaign: Campaign) -> list[ControlRun]:
    """The paper's control by networks."""
    return [run for run in campaign.control_runs if _by_network(run)]


def control_example(campaign: Campaign) -> ControlRun | None:
    """Run of control that the figures of one event are taken from; None if there is none.

    The example's network, or else the first one that controls so far ahead.
    """
    time = nearest(campaign.config.control.prediction_times_lt, 2)
    runs = [run for run in _network_runs(campaign) if run.prediction_time_lt == time]
    example = campaign.example
    own = [run for run in runs if (run.case, run.controller) == (example.case, example.name)]
    return next(iter([*own, *runs]), None)


def _control_kind(campaign: Campaign, case: str) -> dict[str, Any]:
    """Size and validation strategy that the figures of control show for a case."""
    names = [run.controller for run in _network_runs(campaign) if run.case == case]
    kinds = [{"neurons": name.neurons, "validation": name.validation} for name in names]
    wanted = {
        "neurons": campaign.config.figures.fixed_neurons,
        "validation": campaign.example.name.validation,
    }
    return wanted if wanted in kinds else kinds[0]


def _controlled_cases(campaign: Campaign, case: str) -> list[str]:
    """All controlled cases of a case's system."""
    system = campaign.cases[case].system
    return [one for one in _controlled(campaign) if campaign.cases[one].system == system]


def _panels(campaign: Campaign, case: str) -> list[dict[str, Any]]:
    """Event threshold of each controlled case, and the kind of networks that are shown."""
    path = "case.event_threshold"
    return [
        {
            "case": other,
            "event_threshold": settings_of_job(campaign, [path], {"case": other})[path],
            **_control_kind(campaign, other),
        }
        for other in _controlled_cases(campaign, case)
    ]


def _frontier_network(campaign: Campaign, case: str) -> dict[str, Any] | None:
    """Network whose control by all strategies is shown: the example's, or else the first one."""
    names = [
        run.controller for run in campaign.strategy_runs if run.case == case and _by_network(run)
    ]
    name = next((name for name in names if name == campaign.example.name), next(iter(names), None))
    return None if name is None else name.keys


def _aware_cases(campaign: Campaign) -> list[str]:
    """Cases of the example's system with forecasters that know the parameters, tested freely."""
    system = campaign.cases[campaign.example.case].system
    free = [case for case in campaign.aware_cases if case not in campaign.switched_cases]
    return [case for case in free if campaign.cases[case].system == system]


def _parameter(campaign: Campaign, case: str) -> dict[str, Any]:
    """The first parameter that forecasters know: its values by case, and those trained on."""
    cases = _aware_cases(campaign)
    kinds = sorted({one.name.kind for one in campaign.forecasters if one.case in cases})
    trained = {
        campaign.own_values(source)[0]
        for one in cases
        for source in campaign.cases[one].training.trained_on or [one]
    }
    return {
        "name": campaign.config.forecasters.aware.parameters[0],
        "values": {one: campaign.own_values(one)[0] for one in cases},
        "trained": sorted(trained),
        "kinds": [kind for kind in kinds if kind_class(kind).learns_parameters],
    }


def _strategies(campaign: Campaign, case: str) -> list[str]:
    names = {one.name.validation for one in campaign.networks if one.case == case}
    return sorted((str(name) for name in names), reverse=True)


def _with_other_strategies(campaign: Campaign, case: str) -> list[str]:
    name = campaign.example.name
    networks = campaign.select(case=case, kind="esn", neurons=name.neurons, seed=name.seed)
    return [one.directory for one in networks]


def _is_plane(campaign: Campaign, case: str) -> bool:
    return isinstance(campaign.cases[case].space, PlaneFlow)


def _suppressed_event(campaign: Campaign, case: str) -> str:
    run = control_example(campaign)
    assert run is not None
    return f"{run.directory}/suppressed_event.nc"


def _decoded(campaign: Campaign, case: str) -> list[CaseForecaster]:
    """Forecasters of the channels of a plane flow, if states follow from them: networks first."""
    one = campaign.cases[case]
    if one.undecoded or not _is_plane(campaign, one.source.name):
        return []
    found = [*campaign.select(case=case, kind="esn"), *campaign.trajectory_forecasters]
    return [each for each in found if each.case == case and not each.kind.sees_truth]


def _decoded_example(campaign: Campaign, case: str) -> CaseForecaster:
    return next(iter([*_decoded(campaign, case), campaign.example]))


# Places of inputs: directories or files below the results directory, lists where there are several.
_PLACES: Mapping[str, Callable[[Campaign, str], str | list[str]]] = {
    "case": lambda campaign, case: case,
    # the file of the computed exponents, if they are the unit of time
    "time_unit": lambda campaign, case: campaign.cases[case].time_unit,
    "example": lambda campaign, case: campaign.example.directory,
    # networks that differ from the example in the validation strategy only
    "example_strategies": _with_other_strategies,
    # networks the best of which is shown
    "long_term_networks": lambda campaign, case: [
        one.directory for one in long_term_candidates(campaign, case)
    ],
    # the case, if spectra of its networks are computed
    "spectrum_case": lambda campaign, case: [case] if case in _with_spectrum(campaign) else [],
    "suppressed_event": _suppressed_event,
    # the case that another is a part of
    "source": lambda campaign, case: campaign.cases[case].source.name,
    "decoded_forecaster": lambda campaign, case: _decoded_example(campaign, case).directory,
    "reynolds_cases": lambda campaign, case: _reynolds_cases(campaign),
    "controlled_cases": _controlled_cases,
    "aware_cases": lambda campaign, case: _aware_cases(campaign),
    # a case and the cases encoded from it
    "encoded_cases": lambda campaign, case: [
        one for one in campaign.ranked_cases if campaign.cases[one].source.name == case
    ],
}
_OF_SEVERAL_CASES = ("reynolds_cases", "controlled_cases", "aware_cases", "encoded_cases")

# Settings that are not in the config, by what follows ``shown.``
_SHOWN: Mapping[str, Callable[[Campaign, str], Any]] = {
    "symbol": lambda campaign, case: campaign.cases[case].space.observable_symbol,
    "observable_name": lambda campaign, case: campaign.cases[case].space.observable_name,
    "dimension": lambda campaign, case: campaign.cases[case].space.dimension,
    "neurons": lambda campaign, case: campaign.example.name.neurons,
    "validation": lambda campaign, case: campaign.example.name.validation,
    "source": lambda campaign, case: campaign.cases[case].source_system,
    "decoded_kind": lambda campaign, case: _decoded_example(campaign, case).name.kind,
    "strategies": _strategies,
    "example_prediction_time_lt": lambda campaign, case: campaign.prediction_time(2),
    "fixed_prediction_time_lt": lambda campaign, case: campaign.prediction_time(3),
    "prediction_times_lt": lambda campaign, case: sorted(
        {campaign.prediction_time(2), campaign.prediction_time(3)}
    ),
    "control_prediction_time_lt": lambda campaign, case: getattr(
        control_example(campaign), "prediction_time_lt", None
    ),
    "control_networks": _control_kind,
    "frontier_network": _frontier_network,
    "panels": _panels,
    "parameter": _parameter,
}


# -- for which cases a figure is made: the first of them has the plain name ------------------------


def _example(campaign: Campaign) -> list[str]:
    return [campaign.example.case]


def _every(campaign: Campaign) -> list[str]:
    """All cases, the example's first."""
    return list(dict.fromkeys([campaign.example.case, *campaign.case_names]))


def _with_networks(campaign: Campaign) -> list[str]:
    """Cases with networks that are not aware, the example's first."""
    return [case for case in _every(campaign) if campaign.select(case=case, kind="esn")]


def _with_sizes(campaign: Campaign) -> list[str]:
    """The example's, and others with networks of several sizes."""
    sizes = {
        case: {one.name.neurons for one in campaign.networks if one.case == case}
        for case in _every(campaign)
    }
    return [case for case in sizes if case == campaign.example.case or len(sizes[case]) > 1]


def _with_reynolds(campaign: Campaign) -> list[str]:
    return _example(campaign) if len(_reynolds_cases(campaign)) > 1 else []


def _with_parameters(campaign: Campaign) -> list[str]:
    values = {tuple(campaign.own_values(case)) for case in _aware_cases(campaign)}
    return _example(campaign) if len(values) > 1 else []


def _encoded(campaign: Campaign) -> list[str]:
    """Cases that others are encoded from."""
    return list(dict.fromkeys(campaign.cases[one].source.name for one in campaign.encoded_cases))


def _plane_flows(campaign: Campaign) -> list[str]:
    """Cases of flows in a plane."""
    return [case for case in campaign.simulated_cases if _is_plane(campaign, case)]


def _decoded_planes(campaign: Campaign) -> list[str]:
    """Encoded cases of flows in a plane, with a forecaster whose channels can be decoded."""
    return [case for case in campaign.encoded_cases if _decoded(campaign, case)]


def _with_long_term(campaign: Campaign) -> list[str]:
    return [case for case in _every(campaign) if long_term_candidates(campaign, case)]


def _with_spectrum(campaign: Campaign) -> list[str]:
    cases = {one.case for one in campaign.spectrum_forecasters} & {*campaign.simulated_cases}
    return [case for case in _with_long_term(campaign) if case in cases]


def _control_example(campaign: Campaign) -> list[str]:
    run = control_example(campaign)
    return [] if run is None else [run.case]


def _controlled(campaign: Campaign) -> list[str]:
    """Cases that networks control, the example's first if it is included."""
    cases = dict.fromkeys(run.case for run in _network_runs(campaign))
    return sorted(cases, key=lambda case: case != campaign.example.case)


def _controlled_systems(campaign: Campaign) -> list[str]:
    """One controlled case of each system: a figure shows all cases of a system."""
    first: dict[str, str] = {}
    for case in _controlled(campaign):
        first.setdefault(campaign.cases[case].system, case)
    return list(first.values())


def _with_frontier(campaign: Campaign) -> list[str]:
    """Cases that are controlled in other ways than the paper's, too, the example's first."""
    own = set(campaign.control_runs)
    cases = {run.case for run in campaign.strategy_runs if run not in own}
    return [case for case in _every(campaign) if case in cases]


CASES: Mapping[str, Callable[[Campaign], list[str]]] = {
    "example": _example,
    "every": _every,
    "networks": _with_networks,
    "several_sizes": _with_sizes,
    "several_reynolds": _with_reynolds,
    "several_parameters": _with_parameters,
    "encoded": _encoded,
    "plane_flows": _plane_flows,
    "decoded_planes": _decoded_planes,
    "long_term": _with_long_term,
    "control_example": _control_example,
    "controlled": _controlled,
    "controlled_systems": _controlled_systems,
    "other_control": _with_frontier,
}
"""Choices of cases by name."""


# -- what the rule asks for ------------------------------------------------------------------------


def cases_of(campaign: Campaign, figure: Declaration) -> list[str]:
    """Cases that a figure is made for."""
    cases = _named(CASES, figure.cases, "choice of cases")(campaign)
    if not campaign.networks and _shows_networks(figure):
        return []
    return [case for case in cases if not figure.only_flows or campaign.cases[case].is_flow]


def _shows_networks(figure: Declaration) -> bool:
    """Whether there is nothing to draw without networks."""
    shown = [*figure.inputs.values(), *figure.paths.values()]
    return figure.cases == "several_sizes" or any(
        place.startswith(("example", "shown.strategies")) or "/classification_percentiles" in place
        for place in shown
    )


def files_of(campaign: Campaign, figure: Declaration, case: str) -> dict[str, str | list[str]]:
    """Inputs of a figure by name, below the results directory."""
    return {name: _paths(place, campaign, case) for name, place in figure.inputs.items()}


def settings_of(campaign: Campaign, figure: Declaration, case: str) -> dict[str, Any]:
    """Settings of a figure by path."""
    paths = set(figure.paths.values())
    shown = {path: path.removeprefix("shown.") for path in paths if path.startswith("shown.")}
    values = {
        path: _named(_SHOWN, name, "setting to show")(campaign, case)
        for path, name in shown.items()
    }
    return settings_of_job(campaign, sorted(paths - shown.keys()), {"case": case}, values)


def is_of_several_cases(figure: Declaration) -> bool:
    """Whether a figure shows more than one case."""
    return any(place.partition("/")[0] in _OF_SEVERAL_CASES for place in figure.inputs.values())


def figure_case(campaign: Campaign, name: str, suffix: str) -> str:
    """Case that a figure shows: named by its name's end, or the first that it is made for."""
    if suffix:
        return suffix.removeprefix("_")
    return next(iter(cases_of(campaign, FIGURES[name])), campaign.example.case)


def figure_names(campaign: Campaign) -> list[str]:
    """Names of all figures of a campaign."""
    return [
        name if index == 0 else f"{name}_{case}"
        for name, figure in FIGURES.items()
        for index, case in enumerate(dict.fromkeys(cases_of(campaign, figure)))
    ]


def _paths(place: str, campaign: Campaign, case: str) -> str | list[str]:
    name, slash, file = place.partition(":")[0].partition("/")
    found = _named(_PLACES, name, "place")(campaign, case)
    if isinstance(found, str):
        return f"{found}{slash}{file}"
    return [f"{directory}{slash}{file}" for directory in found]


def _named(known: Mapping[str, Value], name: str, what: str) -> Value:
    if name not in known:
        raise ValueError(
            f"a figure declares the {what} {name!r}{suggestion(name, known)}; known are "
            f"{', '.join(known)}"
        )
    return known[name]


FIGURES: Mapping[str, Declaration] = _declared()
"""Declarations of all figures by name, in the order of the report."""
