"""What must hold between the settings of a config, each of which is allowed by itself.

Bounds of one setting that are other settings stand in the model. Here are the others.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from burstcast import durations
from burstcast.control.controllers.committee import VOTE_SHARE, votes
from burstcast.control.experiment import Schedule
from burstcast.control.strategies.registry import make_strategy, strategy_class
from burstcast.discovery import module_file
from burstcast.forecaster_options import sections_of_kind
from burstcast.forecasters.registry import forecaster_class
from burstcast.statistics.profiles import flow_modes
from burstcast.systems.base import has_own
from burstcast.systems.registry import make_system, module_of, system_class
from burstcast_workflow.config.cases import (
    block_cases,
    campaign_cases,
    case_name,
    case_record,
    missing_settings,
    realisation_of,
    said_by_class,
)
from burstcast_workflow.config.kinds import RELATIONS, Section
from burstcast_workflow.config.measured_cases import (
    is_measured,
    kinds_with_equations,
    own_problems,
    problems_of_data,
    problems_of_delays,
    space_of,
)
from burstcast_workflow.config.messages import model_problems, suggestion
from burstcast_workflow.config.model import Case, Configuration, MeasuredCase
from burstcast_workflow.config.places import Place
from burstcast_workflow.control_plans import block_plans
from burstcast_workflow.identifiers import parsed
from burstcast_workflow.jobs.length_checks import check_learnt_equations, misfits

Settings = Mapping[str, Any]


def contradictions(config: Settings) -> list[str]:
    """Check what the model cannot; one message for each thing that is wrong.

    Cases that the campaign does not use are not looked at: an overlay may shorten the series of all
    cases without adjusting those that it leaves out.
    """
    if unsound := list(_class_defaults(config)):  # no case can be made of them
        return unsound
    problems = [
        *_related(config, Configuration),
        *_campaign(config),
        *_strategies(config),
        *_figures(config),
    ]
    cases_of: dict[str, list[str]] = {}
    for name in campaign_cases(config):
        if name in _known_cases(config):
            for problem in _case(config, name):
                cases_of.setdefault(problem, []).append(name)
    for problem, names in cases_of.items():
        problems.append(f"case{'s' if len(names) > 1 else ''} {', '.join(names)}: {problem}")
    return list(dict.fromkeys(problems))


# -- bounds that are other settings ----------------------------------------------------------------


def _is_multiple(value: float, unit: float) -> bool:
    """Whether value is unit times 1, 2, 3, ..., up to rounding errors."""
    ratio = value / unit
    return round(ratio) >= 1 and math.isclose(ratio, round(ratio), rel_tol=1e-9)


_HOLDS: dict[str, Callable[[Any, Any], bool]] = {
    "below": lambda value, other: value < other,
    "at_most": lambda value, other: value <= other,
    "not_beyond": lambda value, other: value <= other,
    "multiple_of": _is_multiple,
    "one_of": lambda value, other: value in other,
}


def _related(settings: Settings, model: type[Section]) -> Iterator[str]:
    """Check the settings of a model against those that bound them."""
    for place in Place(model).settings():
        # what bounds a setting of a case is in the same case
        in_case = place.name.startswith("case_defaults.")
        if in_case or (place.when and _at(settings, place.when) in (None, [])):
            continue
        for relation, other in place.relations.items():
            factors = [_at(settings, factor) for factor in other.split(" * ")]
            bound = factors[0] if len(factors) == 1 else math.prod(factors)
            value = _at(settings, place.name)
            for item in value if isinstance(value, list) else [value]:
                if item is None or isinstance(item, Mapping):  # left out; known to a job only
                    continue
                if bound not in (None, []) and not _HOLDS[relation](item, bound):
                    verb = "has" if isinstance(value, list) else "is"
                    limit = ", ".join(map(str, bound if isinstance(bound, list) else [bound]))
                    unless = f", unless {place.when} is empty" if place.when else ""
                    must = f"{RELATIONS[relation]} {other}, {limit}{unless}"
                    yield f"{place.name} {verb} {item}; it {must}"


def _at(settings: Settings, name: str) -> Any:
    """Value of a setting; in the blocks of the campaign, all its values."""
    value: Any = settings
    for count, part in enumerate(name.replace("[]", "").split(".")):
        if isinstance(value, list):
            rest = ".".join(name.replace("[]", "").split(".")[count:])
            found = [_at(block, rest) or [] for block in value]
            return sorted({item for items in found for item in items})
        value = value.get(part) if isinstance(value, Mapping) else None
    return value


# -- between sections ------------------------------------------------------------------------------


def _known_cases(config: Settings) -> list[str]:
    """Names with an entry in ``cases``, and those of Reynolds numbers, which need none."""
    numbers = [value for block in config["campaign"] for value in block.get("reynolds", [])]
    return list(dict.fromkeys([*config["cases"], *map(case_name, numbers)]))


def _campaign(config: Settings) -> Iterator[str]:
    if config["case_defaults"].get("data") is not None:
        yield "case_defaults.data must be null: each case has data of its own, in cases.<name>.data"
    connectivity = config["forecasters"]["esn"]["connectivity"]
    known = _known_cases(config)
    for index, block in enumerate(config["campaign"]):
        place = f"campaign[{index}]"
        if not block_cases(block):
            yield f"{place} names no case: give it reynolds: [...] or cases: [...]"
        for name in block.get("cases", []):
            if name not in known:
                yield f"{place}.cases: there is no case {name} in cases; {suggestion(name, known)}"
        names = [*block.get("cases", []), *map(case_name, block.get("reynolds", []))]
        for name in dict.fromkeys(names):
            if name in known:
                yield from _realisations(config, place, block, name)
        if not any(axes is not None for axes in block["forecasters"].values()):
            yield f"{place}.forecasters names no kind: give it esn, equations, ..."
        networks = block["forecasters"].get("esn")
        smallest = min(networks["neurons"]) if networks else math.inf
        if connectivity > smallest - 1:
            yield (
                f"forecasters.esn.connectivity is {connectivity}, but a reservoir of {smallest} "
                f"neurons ({place}.forecasters.esn.neurons) has at most {smallest - 1} connections "
                "per neuron"
            )
    for name in config["cases"]:
        base, number = realisation_of(name)
        if number:
            yield (
                f"cases.{name}: names that end so are those of other training series of {base} "
                "(campaign.realisations); take another name"
            )
    used = campaign_cases(config)
    for name in config["control"]["sweep"]["cases"]:
        if name not in used:
            yield f"control.sweep.cases: the campaign has no case {name}; {suggestion(name, used)}"


def _realisations(config: Settings, place: str, block: Settings, name: str) -> Iterator[str]:
    """Whether an ensemble may have as many choices of training series as are wanted."""
    count, record = block.get("realisations", 1), case_record(config, name)
    series = record.get("ensemble", {}).get("series")
    if count > 1 and series is not None and not model_problems(record, Case):
        needed = count * record["training"]["series"] + record["test_series"]
        needed += config["probability"]["calibration_series"]
        if needed > series:
            yield (
                f"{place}.realisations is {count}; choices of training series that share none, "
                f"the test series and those of the calibration are {needed} series of {name}, but "
                f"ensemble.series is {series}"
            )


def _strategies(config: Settings) -> Iterator[str]:
    used = campaign_cases(config)
    for index, block in enumerate(config["control"]["strategies"]):
        place, name = f"control.strategies[{index}]", block["strategy"]
        for case in block.get("cases", []):
            if case not in used:
                yield f"{place}.cases: the campaign has no case {case}; {suggestion(case, used)}"
        kinds = block.get("forecasters") or {}
        chosen = any(axes is not None for axes in kinds.values())
        if strategy_class(name).forecasts and not chosen:
            yield f"{place}.forecasters names no kind, but {name} asks forecasters"
        if chosen and not strategy_class(name).forecasts:
            yield f"{place}.forecasters: {name} asks no forecaster; leave it out"
        for plan in block_plans(block):
            try:
                make_strategy(name, dict(plan.settings))
            except ValueError as error:
                yield f"{place}.settings: {error}"
        yield from _votes(block, place, [kind for kind, axes in kinds.items() if axes is not None])


def _votes(block: Settings, place: str, kinds: Sequence[str]) -> Iterator[str]:
    """What is wrong with who votes in a block of strategies of control."""
    shares = block.get("settings", {}).get(VOTE_SHARE)
    if not block.get("committee"):
        if shares:
            yield f"{place}.settings.{VOTE_SHARE} is for committees; say committee: true as well"
        return
    name = block["strategy"]
    if not votes(strategy_class(name)):
        yield f"{place}.committee: {name} lets nobody vote; leave it out"
    for share in shares or []:
        if not 0 < share <= 1:
            yield (
                f"{place}.settings.{VOTE_SHARE} has {share}, but a share of the votes is above 0, "
                "and 1 at most"
            )
    if block.get("seeds") is not None:
        yield f"{place}.seeds: all networks of a size and strategy are a committee; leave it out"
    for kind in kinds:
        if kind != "esn" and not forecaster_class(kind).provides_ensemble:
            yield f"{place}.forecasters names {kind}, which provides no ensemble that could vote"


def _figures(config: Settings) -> Iterator[str]:
    figures = config["figures"]
    name, example = figures["example_case"], parsed(figures["example_forecaster"])
    blocks = [block for block in config["campaign"] if name in block_cases(block)]
    if not any(
        example.neurons in networks["neurons"]
        and example.validation in networks["validation"]
        and (example.seed or 0) < networks["seeds"]
        for networks in (block["forecasters"].get("esn") for block in blocks)
        if networks
    ):
        yield (
            f"the example network of the figures ({name}, {example.identifier}) is not part of the "
            "campaign: change figures.example_case or figures.example_forecaster"
        )
    if name in _known_cases(config):
        record = case_record(config, name)
        threshold, peak = record.get("event_threshold"), figures["flow_event"]["peak"]
        known = isinstance(threshold, int | float)
        if known and not peak > threshold and _is_flow(record):
            yield (
                f"figures.flow_event.peak is {peak}; it must be above the event_threshold of "
                f"{name}, {threshold}"
            )


def _is_flow(record: Settings) -> bool:
    """Whether the figures of the flow are drawn for a case."""
    try:
        return flow_modes(make_system(record["system"], record["parameters"])) is not None
    except (ValueError, TypeError):  # told with the case
        return False


# -- cases -----------------------------------------------------------------------------------------


def _class_defaults(config: Settings) -> Iterator[str]:
    """Check what classes of systems say of their cases as if it stood in the config."""
    entries = [config["cases"].get(name) or {} for name in campaign_cases(config)]
    for system in dict.fromkeys(entry["system"] for entry in entries if "system" in entry):
        try:
            problems = model_problems(said_by_class(system), Case, partial=True)
        except (TypeError, ValueError) as error:  # no plain data
            problems = [str(error)]
        if problems:
            name = system_class(system).__name__
            yield f"case_defaults of the class {name} (system {system}): {'; '.join(problems)}"


def _case(config: Settings, name: str) -> Iterator[str]:
    if is_measured(own := config["cases"].get(name) or {}):
        yield from _measured(config, name, own)
        return
    record = case_record(config, name)
    try:
        owner = system_class(record["system"]).__name__
    except (ValueError, TypeError) as error:
        yield f"system: {error}"
        return
    yield from _files(record)
    another = record["system"] != config["case_defaults"]["system"]
    if another and (missing := missing_settings(record)):
        are, it = ("is", "it") if len(missing) == 1 else ("are", "them")
        yield (
            f"{', '.join(missing)} {are} missing: the class {owner} says nothing of {it} in its "
            f"case_defaults, and those of config.yaml are in units of another system; say {it} in "
            f"cases.{name}"
        )
        return
    if wrong := model_problems(record, Case):
        yield from wrong
        return
    yield from _related(record, Case)
    yield from _system(name, record)
    if any(forecaster_class(kind).has_filter for kind in _kinds(config, name)):
        yield from _filter(
            config["forecasters"]["filter"], record, f"the system {record['system']}"
        )
    yield from _counts_of_series(config, record)
    yield from _left_out_one_by_one(
        config, record, "further series (probability.calibration_series)"
    )
    if config["search"]["choice"] == "survival" and record["laminarisation_threshold"] is None:
        yield (
            "search.choice is survival, but without a laminarisation_threshold no series leaves "
            "the chaotic phase; take best"
        )
    yield from _starts_of_actuation(config["control"], record)
    yield from _durations(config, name, record)


def _files(record: Settings) -> Iterator[str]:
    """What is wrong with the files that a user's module reads."""
    files, system = record.get("files") or [], record["system"]
    if files and ":" not in system:
        yield "files belong to a system of your own (<module>:<class>): leave them out"
    elif files and (module := module_file(module_of(system))):
        missing = [name for name in files if not (module.parent / name).is_file()]
        if missing:
            yield f"files: there is no file {', '.join(missing)} in {module.parent}"


def _counts_of_series(config: Settings, record: Settings) -> Iterator[str]:
    """What is wrong with how many series there are, and what they are for."""
    series, training = record["ensemble"]["series"], record["training"]["series"]
    test, more = record["test_series"], config["probability"]["calibration_series"]
    if training + test > series:
        yield (
            f"training.series and test_series are {training} and {test}; together they must be at "
            f"most ensemble.series, {series}"
        )
    if more and training + test + more > series:
        yield (
            f"probability.calibration_series is {more}; together with training.series and "
            f"test_series, {training + test}, it must be at most ensemble.series, {series}"
        )


def _left_out_one_by_one(config: Settings, record: Settings, others: str) -> Iterator[str]:
    """Whether something is left to learn from without a training series."""
    if not config["probability"]["calibration_series"] and record["training"]["series"] < 2:
        yield (
            "training.series is 1, but probabilities are calibrated on series that are left out of "
            f"the training one by one: take 2 at least, or {others}"
        )


def _starts_of_actuation(control: Settings, record: Settings) -> Iterator[str]:
    start = record["actuation"]["start_lt"] if record["actuation"] else 0
    for time in control["prediction_times_lt"] if any(control["forecasters"].values()) else []:
        if time + start < 0:
            yield (
                f"control.prediction_times_lt has {time}, but an actuation that starts at "
                f"actuation.start_lt, {start}, would then begin before its alarm"
            )


def _durations(config: Settings, name: str, record: Settings) -> Iterator[str]:
    """What does not fit into series, where the config knows how long a Lyapunov time is."""
    ensemble, lyapunov = record["ensemble"], record["lyapunov"]
    if lyapunov["time_unit"] != "published" or lyapunov["published_exponent"] is None:
        return
    interval = ensemble["time_step"] * ensemble["sampling_stride"]
    try:
        steps = durations.steps_per_lyapunov_time(lyapunov["published_exponent"], interval)
    except ValueError as error:
        yield f"lyapunov.published_exponent: {error}"
        return
    # both ends of a series are sampled
    samples = math.floor(ensemble["duration"] / interval + 1e-9) + 1
    yield from misfits(config, record, samples, steps)
    if any("quadratic" in sections_of_kind(kind) for kind in _kinds(config, name)):
        try:
            window_lt = config["forecasters"]["quadratic"]["window_lt"]
            check_learnt_equations(samples, steps, window_lt)
        except ValueError as error:
            yield str(error)
    yield from _unfit_strategies(config, name, record, steps)


def _kinds(config: Settings, name: str) -> set[str]:
    """Kinds of forecasters that the campaign has of a case."""
    return {
        kind
        for block in config["campaign"]
        if name in block_cases(block)
        for kind, axes in block["forecasters"].items()
        if axes is not None
    }


def _measured(config: Settings, name: str, own: Settings) -> Iterator[str]:
    """What is wrong with a case of measured series."""
    if wrong := list(own_problems(own)):
        yield from wrong
        return
    source, cases = own["data"].get("case"), campaign_cases(config)
    if source is not None and (source not in cases or is_measured(config["cases"].get(source, {}))):
        others = [case for case in cases if not is_measured(config["cases"].get(case) or {})]
        yield (
            f"data.case is {source}; it must be a case of the campaign that is simulated: "
            f"{', '.join(others) or 'there is none'}"
        )
        return
    record = case_record(config, name)
    if wrong := list(problems_of_delays(record)):
        yield from wrong
        return
    if wrong := model_problems(record, MeasuredCase):
        if "range" not in record["density"]:  # what follows from it is not asked for
            wrong = [text for text in wrong if not text.startswith("fixed_point is missing")]
        yield from wrong
        return
    yield from _related(record, MeasuredCase)
    yield from problems_of_data(record)
    if config["statistics"]["duration"] is None and record["ensemble"].get("duration") is None:
        yield "statistics.duration is null, but how long the series are, only the data tell: say it"
    kinds = sorted(_kinds(config, name))
    if needing := kinds_with_equations(kinds):
        yield f"there are no equations of measured series to forecast with ({', '.join(needing)})"
    if any(forecaster_class(kind).has_filter for kind in kinds):
        yield from _filter(config["forecasters"]["filter"], record, name)
    for index, block in enumerate(config["control"]["strategies"]):
        if name in block.get("cases", []):
            yield f"control.strategies[{index}].cases: control needs equations, which data have not"
    yield from _left_out_one_by_one(config, record, "cut a long one (data.blocks)")


def _filter(settings: Settings, record: Settings, whose: str) -> Iterator[str]:
    members, space = settings["members"], space_of(record)
    if space is None:  # told with the case
        return
    dimension = space.dimension
    if members % 2 or members < 2 * dimension:
        yield (
            f"forecasters.filter.members is {members}; it must be even, and at least twice the "
            f"components of a state: {2 * dimension} for {whose}"
        )


def _unfit_strategies(config: Settings, name: str, record: Settings, steps: int) -> Iterator[str]:
    """Settings of strategies that mean nothing with so many steps in a Lyapunov time."""
    actuation, ensemble = record["actuation"], record["ensemble"]
    for index, block in enumerate(config["control"]["strategies"]):
        if actuation is None or name not in (block.get("cases") or [name]):
            continue
        for plan in block_plans(block):
            try:
                strategy = make_strategy(plan.strategy, dict(plan.settings))
                strategy.check(
                    Schedule(
                        washout=max(1, durations.steps(config["washout_lt"], steps)),
                        quiet_lt=plan.quiet_lt,
                        span_lt=plan.span_lt or config["control"]["span_lt"],
                        delay_lt=plan.delay_lt,
                        actuation_start_lt=actuation["start_lt"],
                        actuation_duration_lt=actuation["duration_lt"],
                        steps_per_lyapunov_time=steps,
                        sampling_stride=ensemble["sampling_stride"],
                        time_step=ensemble["time_step"],
                    )
                )
            except ValueError as error:
                yield f"control.strategies[{index}]: {error}"


def _system(name: str, record: Settings) -> Iterator[str]:
    parameters, ensemble, actuation = record["parameters"], record["ensemble"], record["actuation"]
    reynolds = parameters.get("reynolds")
    if name.startswith("Re") and reynolds is not None and _is_reynolds_of_another(name, reynolds):
        yield f"parameters.reynolds is {reynolds}, which contradicts the name {name}: leave it out"
    try:
        system = make_system(record["system"], parameters)
        dimension = system.dimension
    except (ValueError, TypeError) as error:
        yield f"system or parameters: {error}"
        return
    state, component = ensemble["initial_state"], ensemble["perturbed_component"]
    of_system = f"the system {record['system']}"
    if state is None and not has_own(system, "sample_initial_states"):
        yield f"ensemble.initial_state is null, but {of_system} draws no initial states: give one"
    if state is not None and len(state) != dimension:
        yield f"ensemble.initial_state has {len(state)} numbers; {of_system} needs {dimension}"
    if state is not None and None in (component, ensemble["perturbation"]):
        yield (
            "ensemble.perturbed_component and ensemble.perturbation are needed beside "
            "ensemble.initial_state: without them all series are the same"
        )
    if component is not None and component > dimension:
        yield (
            f"ensemble.perturbed_component is {component}; {of_system} has the components 1 to "
            f"{dimension}"
        )
    if actuation is not None:
        try:
            make_system(record["system"], {**parameters, **actuation["parameters"]})
        except ValueError as error:
            yield f"actuation.parameters: {error}"
        if actuation["force"] is not None and has_own(system, "flow_map"):
            yield (
                f"actuation.force: {of_system} has an integrator of its own, to which no force can "
                "be added; let the actuation change a parameter"
            )
        if actuation["force"] is not None and len(actuation["force"]) != dimension:
            yield f"actuation.force has {len(actuation['force'])} numbers; it needs {dimension}"


def _is_reynolds_of_another(name: str, reynolds: float) -> bool:
    try:
        return float(name.removeprefix("Re")) != reynolds
    except ValueError:  # a name such as Reference
        return False
