"""The figures: what each shows, which files and settings it is made of, and for which cases.

A figure is an entry here, a script of the same name in ``workflow/scripts/figures`` and a module of
`burstcast.figures` that draws it. The one rule of ``workflow/rules/figures.smk`` makes them all.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from burstcast_workflow.campaign import Campaign, CaseForecaster, ControlRun

Files = dict[str, str | list[str]]
_SYSTEM = ("case.system", "case.parameters")
_TIME = (
    "case.ensemble.time_step",
    "case.ensemble.sampling_stride",
    "case.lyapunov.time_unit",
    "case.lyapunov.published_exponent",
)
_THRESHOLD = (*_SYSTEM, "case.event_threshold")
_EXAMPLES = (*_THRESHOLD, "figures.example_prediction_time_lt", "classification.window_lt")
_FLOW = (*_SYSTEM, "figures.flow_points")


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


def _with_long_term(campaign: Campaign) -> list[str]:
    return [case for case in _every(campaign) if long_term_candidates(campaign, case)]


def _with_long_term_flow(campaign: Campaign) -> list[str]:
    return [case for case in _with_long_term(campaign) if campaign.has_flow(case)]


def _example_flow(campaign: Campaign) -> list[str]:
    return [case for case in _example(campaign) if campaign.has_flow(case)]


def _control_example(campaign: Campaign) -> list[str]:
    run = control_example(campaign)
    return [] if run is None else [run.forecaster.case]


def _control_example_flow(campaign: Campaign) -> list[str]:
    return [case for case in _control_example(campaign) if campaign.has_flow(case)]


def _controlled(campaign: Campaign) -> list[str]:
    """Cases that networks control, the example's first if it is one of them."""
    cases = dict.fromkeys(run.forecaster.case for run in _network_runs(campaign))
    return sorted(cases, key=lambda case: case != campaign.example.case)


def _controlled_systems(campaign: Campaign) -> list[str]:
    """One controlled case of each system: a figure shows all cases of a system."""
    first: dict[str, str] = {}
    for case in _controlled(campaign):
        first.setdefault(campaign.cases[case]["system"], case)
    return list(first.values())


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


def _network_runs(campaign: Campaign) -> list[ControlRun]:
    return [
        run for run in campaign.control_runs if run.forecaster.name.kind == "esn" and not run.random
    ]


def control_example(campaign: Campaign) -> ControlRun | None:
    """Run of control that the figures of one event are taken from; None if there is none.

    The example's network, or else the first one that controls so far ahead.
    """
    time = campaign.config["figures"]["control_prediction_time_lt"]
    runs = [run for run in _network_runs(campaign) if run.prediction_time_lt == time]
    own = [run for run in runs if run.forecaster == campaign.example]
    return next(iter([*own, *runs]), None)


def _control_kind(campaign: Campaign, case: str) -> dict[str, Any]:
    """Size and validation strategy that the figures of control show for a case."""
    names = [run.forecaster.name for run in _network_runs(campaign) if run.forecaster.case == case]
    kinds = [{"neurons": name.neurons, "validation": name.validation} for name in names]
    wanted = {
        "neurons": campaign.config["figures"]["fixed_neurons"],
        "validation": campaign.example.name.validation,
    }
    return wanted if wanted in kinds else kinds[0]


# -- files, below the results directory ------------------------------------------------------------


def _nothing(campaign: Campaign, case: str) -> Files:
    return {}


def _series(campaign: Campaign, case: str) -> Files:
    known = campaign.steps_per_lyapunov_time(case) is not None
    return {
        "ensemble": f"{case}/ensemble.nc",
        "time_unit": [] if known else f"{case}/lyapunov.json",
    }


def _of_example(**names: str) -> Callable[[Campaign, str], Files]:
    return lambda campaign, case: {
        key: f"{campaign.example.directory}/{name}" for key, name in names.items()
    }


def _tables(**names: str) -> Callable[[Campaign, str], Files]:
    return lambda campaign, case: {key: f"tables/{name}.csv" for key, name in names.items()}


def _searches(campaign: Campaign, case: str) -> Files:
    name = campaign.example.name
    networks = campaign.select(case=case, kind="esn", neurons=name.neurons, seed=name.seed)
    return {"traces": [f"{one.directory}/search.csv" for one in networks]}


def _long_term(campaign: Campaign, case: str) -> Files:
    return {
        "data": f"{case}/statistics_data.nc",
        "training": f"{case}/statistics_training.nc",
        "long_term": [
            f"{one.directory}/long_term.nc" for one in long_term_candidates(campaign, case)
        ],
    }


def _long_term_and_table(campaign: Campaign, case: str) -> Files:
    return {**_long_term(campaign, case), "percentiles": "tables/statistics_percentiles.csv"}


def _suppressed(campaign: Campaign, case: str) -> Files:
    run = control_example(campaign)
    assert run is not None
    time = f"{run.prediction_time_lt:g}"
    return {"event": f"{run.forecaster.directory}/suppressed_event_PT{time}.nc"}


# -- further settings ------------------------------------------------------------------------------


def _no_values(campaign: Campaign, case: str) -> dict[str, Any]:
    return {}


def _which_case(campaign: Campaign, case: str) -> dict[str, Any]:
    return {"shown_case": case}


def _scores(campaign: Campaign, case: str) -> dict[str, Any]:
    return {**_which_case(campaign, case), "shown_validation": campaign.example.name.validation}


def _candidates(campaign: Campaign, case: str) -> dict[str, Any]:
    return {"rows": campaign.keys(long_term_candidates(campaign, case))}


def _candidates_and_case(campaign: Campaign, case: str) -> dict[str, Any]:
    return {**_which_case(campaign, case), **_candidates(campaign, case)}


def _strategies(campaign: Campaign, case: str) -> dict[str, Any]:
    names = {one.name.validation for one in campaign.networks if one.case == case}
    return {"strategies": sorted((str(name) for name in names), reverse=True)}


def _control_time(campaign: Campaign, case: str) -> dict[str, Any]:
    run = control_example(campaign)
    return {"prediction_time_lt": run.prediction_time_lt if run else None}


def _kind_of_case(campaign: Campaign, case: str) -> dict[str, Any]:
    return {"shown_case": case, **_control_kind(campaign, case)}


def _kinds_of_system(campaign: Campaign, case: str) -> dict[str, Any]:
    system = campaign.cases[case]["system"]
    return {
        "panels": [
            {
                "identity": {"case": other},
                "settings": campaign.settings(["case.event_threshold"], {"case": other}, {}),
                "kind": _control_kind(campaign, other),
            }
            for other in _controlled(campaign)
            if campaign.cases[other]["system"] == system
        ],
        "prediction_times_lt": campaign.config["control"]["prediction_times_lt"],
    }


# -- the registry ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Figure:
    """A figure of the report.

    Attributes
    ----------
    caption
        What it shows, in reStructuredText. It is no setting: another one draws nothing again.
    files
        Inputs of its script by name, for a campaign and a case.
    reads
        Settings that its script reads.
    cases
        Cases that it is made for: the first has the plain name, those of others end in ``_<case>``.
    values
        Further settings, for a campaign and a case.
    published
        Whether the paper's published values can be drawn on it.
    """

    caption: str
    files: Callable[[Campaign, str], Files] = _nothing
    reads: tuple[str, ...] = ()
    cases: Callable[[Campaign], Sequence[str]] = _example
    values: Callable[[Campaign, str], dict[str, Any]] = _no_values
    published: bool = False


FIGURES: Mapping[str, Figure] = {
    "observable_and_density": Figure(
        "Typical evolution of the observable (the first kept series; extreme events shaded) and "
        "its probability density over all kept data. The line is the event threshold.",
        _series,
        (*_THRESHOLD, *_TIME, "case.density"),
        _every,
    ),
    "validation_strategies": Figure(
        "Where each strategy trains and validates, on the first training series. The network sees "
        "the data in open loop during washout and training, and forecasts in closed loop during "
        "validation.",
        _series,
        (
            *_THRESHOLD,
            *_TIME,
            "case.recycle_validation",
            "washout_lt",
            "search.interval_lt",
        ),
        values=_strategies,
    ),
    "network_schematic": Figure(
        "The echo state network with the sizes and hyperparameters of the example network; open "
        "loop and closed loop.",
        _of_example(hyperparameters="hyperparameters.json"),
        (*_SYSTEM, "forecasters.esn.connectivity", "forecasters.esn.input_bias"),
        values=lambda campaign, case: {"neurons": campaign.example.name.neurons},
    ),
    "search_landscape": Figure(
        "Objective of the hyperparameter search at each point, best Tikhonov parameter: "
        "interpolated between the evaluated points (dots: the grid; numbers: points of the "
        "Bayesian search in their order; in colour: the optimum), and how far the best value found "
        "so far lay above the final one.",
        _searches,
    ),
    "prediction_schematic": Figure(
        "One forecast of the example network with its parts: washout, prediction time, and the "
        "window that is classified.",
        _of_example(examples="examples.nc"),
        (*_EXAMPLES, "washout_lt"),
    ),
    "prediction_examples": Figure(
        "Forecasts of the example network with each outcome. Of all forecasts with an outcome, the "
        "one is shown whose burst has the median height; misses and false alarms that are more "
        "than an error of timing come first.",
        _of_example(examples="examples.nc"),
        _EXAMPLES,
    ),
    "classification_scores": Figure(
        "Precision, recall and F-score: medians (lines) and quartiles (bands) over the networks of "
        "an ensemble. In grey: forecasters to compare with.",
        _tables(percentiles="classification_percentiles"),
        ("figures.fixed_neurons", "figures.fixed_prediction_time_lt"),
        _every,
        _scores,
        published=True,
    ),
    "horizon_schematic": Figure(
        "How the prediction horizon of an extreme event is measured.",
        reads=(
            *_SYSTEM,
            "horizon.longest_lead_time_lt",
            "horizon.lead_time_step_lt",
            "horizon.tolerance",
        ),
    ),
    "horizon_evaluations": Figure(
        "The last evaluations of the example network before an event is predicted: the forecast "
        "starts ever later until it stays within the tolerance up to the event.",
        _of_example(examples="examples.nc"),
        (*_THRESHOLD, "washout_lt"),
    ),
    "horizon_by_size": Figure(
        "Mean prediction horizon of extreme events against reservoir size: medians (lines) and "
        "quartiles (bands) over the networks of an ensemble. In grey: forecasters to compare with.",
        _tables(percentiles="horizon_percentiles"),
        cases=_with_sizes,
        values=_which_case,
        published=True,
    ),
    "by_reynolds": Figure(
        "Mean prediction horizon of extreme events and F-score against the Reynolds number: "
        "medians and quartiles over the networks of an ensemble.",
        _tables(horizon="horizon_percentiles", classification="classification_percentiles"),
        ("figures.fixed_neurons", "figures.reynolds_prediction_times_lt"),
        _with_reynolds,
        lambda campaign, case: {"shown_cases": _reynolds_cases(campaign)},
        published=True,
    ),
    "energy_density": Figure(
        "(a) Density of the observable over all data, the training set and the long closed loops "
        "of one network: of those of the size and strategy shown, the one with the smallest "
        "Kantorovich metric. (b) Kantorovich metric and (c) mean logarithmic error against "
        "reservoir size, medians and quartiles over the networks of an ensemble. In grey: the same "
        "measures between two random halves of the data, in the median.",
        _long_term_and_table,
        _THRESHOLD,
        _with_long_term,
        _candidates_and_case,
        published=True,
    ),
    "profile_errors": Figure(
        "(a-c) Profiles of the velocity along x, its square and the Reynolds stress, averaged over "
        "x, z and time, of all data, the training set and one network: of those of the size and "
        "strategy shown, the one with the smallest Kantorovich metric. (d-f) Errors of the "
        "profiles, normalised by the range of the true profile, against reservoir size: medians "
        "and quartiles over the networks of an ensemble. In grey: the same errors between two "
        "random halves of the data, in the median.",
        _long_term_and_table,
        (*_SYSTEM, "statistics.profile_points"),
        _with_long_term_flow,
        _candidates_and_case,
        published=True,
    ),
    "midplane_mean_square": Figure(
        "(a) Time average of the square of the velocity along x in the midplane. Its absolute "
        "error (b) in the long closed loops of one network, that of its ensemble with the smallest "
        "Kantorovich metric, and (c) in the training set.",
        _long_term,
        _FLOW,
        _with_long_term_flow,
        _candidates,
    ),
    "midplane_planes": Figure(
        "An extreme event of the test set and the velocity along x in the midplane: data, forecast "
        "of the example network, and their difference. t_1: last time that the observable is at or "
        "below its mean; t_2: half-way up; t_3: peak; t_4: first time after it below the "
        "threshold. Of the isolated events whose state the network predicts within a tolerance "
        "from before t_1 to t_4, the one is shown whose peak is nearest to the configured one.",
        _of_example(event="flow_event.nc"),
        (*_FLOW, "case.event_threshold"),
        _example_flow,
    ),
    "vorticity_isosurfaces": Figure(
        "Isosurfaces of plus and minus one value of the streamwise vorticity, and velocity "
        "vectors, at the peak of the event of the midplane figure and after its breakdown. The "
        "mean flow is along x, sheared in y between the walls.",
        _of_example(event="flow_event.nc"),
        (*_FLOW, "figures.isosurface_level"),
        _example_flow,
    ),
    "control_schematic": Figure(
        "The control strategy on the suppressed event: a forecast from time 0 crosses the "
        "threshold in the window after the prediction time, which raises an alarm; the equations "
        "are changed over the shaded interval.",
        _suppressed,
        (*_THRESHOLD, "case.actuation.parameters", "case.actuation.force", "control.window_lt"),
        _control_example,
        _control_time,
    ),
    "suppressed_event": Figure(
        "An extreme event that control suppresses, and the velocity along x in the midplane with "
        "and without control. t_1: start of the actuation (shaded), up to which both flows are the "
        "same; t_2: the event begins without control; t_3: its peak; t_4: its end. Of all events "
        "that the network predicts and control suppresses, the largest one is shown.",
        _suppressed,
        (*_FLOW, "case.event_threshold"),
        _control_example_flow,
    ),
    "control_tradeoff": Figure(
        "Share of the exceedance of the event threshold that control removes, (a) against the "
        "prediction time and (b) against the share of the time under actuation, with medians and "
        "quartiles over the networks of an ensemble. For comparison: alarms by the equations "
        "themselves, started from the true state, and random alarms at the rate of the networks'.",
        _tables(percentiles="control_percentiles"),
        _SYSTEM,
        _controlled,
        _kind_of_case,
    ),
    "control_density": Figure(
        "Density of the observable with and without control, averaged over the networks of an "
        "ensemble. Both flows start from the same states and are compared over the same times. The "
        "table control_density.csv has these densities, and those without the time under "
        "actuation.",
        _tables(densities="control_density"),
        _SYSTEM,
        _controlled_systems,
        _kinds_of_system,
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
        for index, case in enumerate(_distinct(figure.cases(campaign)))
    ]


def _distinct(cases: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(cases))
