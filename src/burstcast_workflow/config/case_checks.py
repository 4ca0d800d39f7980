"""Checks within a case, and between a case and the settings of the whole campaign."""

from collections.abc import Iterator

from pydantic import ValidationError

from burstcast.control.actuation import actuated_system
from burstcast.forecasters.registry import kind_class, learns_parameters
from burstcast.systems.base import has_own
from burstcast.systems.registry import make_system, system_class, system_module
from burstcast_workflow.config.aware_checks import problems_of_parameters
from burstcast_workflow.config.bounds import out_of_bounds
from burstcast_workflow.config.cases import (
    blocks_of,
    campaign_cases,
    case_record,
    data_of,
    reynolds_in,
    sound_case,
)
from burstcast_workflow.config.external_files import problems_of_external
from burstcast_workflow.config.lengths import lag_misfits, misfits, room_misfits
from burstcast_workflow.config.measured_cases import (
    ONLY_ENCODED,
    is_encoded,
    own_problems,
    problems_of_data,
    problems_of_encoding,
    space_of,
    undecoded,
)
from burstcast_workflow.config.messages import model_problems
from burstcast_workflow.config.model import Case, Configuration, Filter, Measured, Simulated
from snaketrust.modules import module_file


def problems_of_case(config: Configuration, name: str) -> Iterator[str]:
    """Mistakes in a case of the campaign, one message each."""
    check = _simulated if data_of(config, name) is None else _measured
    yield from check(config, name)
    yield from problems_of_external(config, name)


def _simulated(config: Configuration, name: str) -> Iterator[str]:
    record = case_record(config, name)
    try:
        owner = system_class(record["system"]).__name__
    except (ValueError, TypeError) as error:
        yield f"system: {error}"
        return
    yield from _files(record["system"], record.get("files") or [])
    try:
        case = Simulated.model_validate(record)
    except ValidationError as error:
        problems = error.errors(include_url=False)
        missing = [".".join(map(str, one["loc"])) for one in problems if one["type"] == "missing"]
        if missing and record["system"] != config.case_defaults.system:
            are, it = ("is", "it") if len(missing) == 1 else ("are", "them")
            yield (
                f"{', '.join(missing)} {are} missing: the class {owner} says nothing of {it} in "
                f"its case_defaults, and config.yaml's are in units of another system; say "
                f"{it} in cases.{name}"
            )
        else:
            yield from model_problems(error, Simulated)
        return
    kinds = _kinds(config, name)
    if is_encoded(case):
        yield ONLY_ENCODED
    yield from out_of_bounds(case)
    yield from _system(config, name, case)
    if any(kind_class(kind).has_filter for kind in kinds):
        yield from _filter(config.forecasters.filter, case, f"the system {case.system}")
    yield from _counts_of_series(config, case)
    yield from _left_out_one_by_one(config, case, "further series (probability.calibration_series)")
    if config.search.choice == "survival" and case.laminarisation_threshold is None:
        yield (
            "search.choice is survival, but without a laminarisation_threshold no series leaves "
            "the chaotic phase; take best"
        )
    yield from _starts_of_actuation(config, case)
    networks = [axes for block in blocks_of(config, name) for axes in block.forecasters.networks]
    validations = [one for axes in networks for one in axes.validation]
    yield from misfits(config, name, case, kinds, validations)
    yield from lag_misfits(config, case, kinds)
    if any(map(learns_parameters, kinds)):
        yield from problems_of_parameters(config, name, case)


def _files(system: str, files: list[str]) -> Iterator[str]:
    """Mistakes in the files that a user's module reads."""
    if files and ":" not in system:
        yield "files belong to a system of your own (<module>:<class>): leave them out"
    elif files and (module := module_file(system_module(system))):
        missing = [name for name in files if not (module.parent / name).is_file()]
        if missing:
            yield f"files: there is no file {', '.join(missing)} in {module.parent}"


def _system(config: Configuration, name: str, case: Simulated) -> Iterator[str]:
    parameters, ensemble, actuation = case.parameters, case.ensemble, case.actuation
    reynolds = parameters.get("reynolds")
    if reynolds_in(name) not in (None, reynolds):
        yield (
            f"parameters.reynolds is {reynolds:g}, which contradicts the name {name}: leave it out"
        )
    try:
        system = make_system(case.system, parameters)
        dimension = system.dimension
    except (ValueError, TypeError) as error:
        yield f"system or parameters: {error}"
        return
    state, component = ensemble.initial_state, ensemble.perturbed_component
    of_system = f"the system {case.system}"
    if state is None and not has_own(system, "sample_initial_states"):
        yield f"ensemble.initial_state is null, but {of_system} draws no initial states: give one"
    if state is not None and len(state) != dimension:
        yield f"ensemble.initial_state has {len(state)} numbers; {of_system} needs {dimension}"
    if state is not None and None in (component, ensemble.perturbation):
        yield (
            "ensemble.perturbed_component and ensemble.perturbation are needed beside "
            "ensemble.initial_state: without them all series are the same"
        )
    if component is not None and component > dimension:
        yield (
            f"ensemble.perturbed_component is {component}; {of_system} has the components 1 to "
            f"{dimension}"
        )
    if actuation is None:
        return
    blocks = [one for one in config.control.strategies if name in (one.cases or [name])]
    try:
        make_system(case.system, {**parameters, **actuation.parameters})
        for strength in (1.0, *(value for block in blocks for value in block.strength)):
            actuated_system(system, actuation.parameters, actuation.force, strength)
    except ValueError as error:
        yield f"actuation: {error}"


def _counts_of_series(config: Configuration, case: Simulated) -> Iterator[str]:
    """Mistakes in the numbers of series and their uses."""
    series, training = case.ensemble.series, case.training.series
    test, more = case.test_series, config.probability.calibration_series
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


def _left_out_one_by_one(config: Configuration, case: Case, others: str) -> Iterator[str]:
    """Whether something is left to learn from without a training series."""
    if not config.probability.calibration_series and case.training.series < 2:
        yield (
            "training.series is 1, but probabilities are calibrated on series that are left out of "
            f"the training one by one: take 2 at least, or {others}"
        )


def _starts_of_actuation(config: Configuration, case: Case) -> Iterator[str]:
    start = case.actuation.start_lt if case.actuation else 0
    times = config.control.prediction_times_lt if config.control.forecasters.kinds else []
    for time in times:
        if time + start < 0:
            yield (
                f"control.prediction_times_lt has {time:g}, but an actuation that starts at "
                f"actuation.start_lt, {start:g}, would then begin before its alarm"
            )


def _kinds(config: Configuration, name: str) -> list[str]:
    """Kinds of forecasters that the campaign has of a case."""
    return sorted({kind for block in blocks_of(config, name) for kind in block.forecasters.kinds})


def _filter(settings: Filter, case: Case, whose: str) -> Iterator[str]:
    members, space = settings.members, space_of(case)
    if space is not None and members < 2 * space.dimension:
        yield (
            f"forecasters.filter.members is {members}; it must be at least twice the components "
            f"of a state: {2 * space.dimension} for {whose}"
        )


def _known(config: Configuration, case: Measured, kinds: list[str]) -> Iterator[str]:
    """Mistakes in a measured case with kinds that learn from what is known in advance."""
    assert case.data is not None
    if not case.data.known:
        yield f"data.known is empty, but {', '.join(kinds)} learn from what is known in advance"
    for key in ("trained_on", "actuation"):
        if getattr(case.training, key):
            yield f"training.{key} means nothing for measured series (data): leave it out"
    if config.search.choice == "survival":
        yield f"search.choice is survival, but {', '.join(kinds)} have no long runs; take best"


def _measured(config: Configuration, name: str) -> Iterator[str]:
    """Mistakes in a case of measured series."""
    own = config.cases[name]
    assert own.data is not None
    if wrong := list(own_problems(own)):
        yield from wrong
        return
    source, used = own.data.case, campaign_cases(config)
    simulated = [case for case in used if data_of(config, case) is None]
    if source is not None and source not in simulated:
        yield (
            f"data.case is {source}; it must be a case of the campaign that is simulated: "
            f"{', '.join(simulated) or 'there is none'}"
        )
        return
    record = case_record(config, name)
    duration, delays = record["ensemble"]["duration"], own.data.delays
    if delays and duration is not None and duration <= 0:  # and so is what follows from it
        yield f"data.delays reach back by {max(delays)} steps, which is more than a series is long"
        return
    try:
        case = Measured.model_validate(record)
    except ValidationError as error:
        yield from model_problems(error, Measured)
        return
    yield from out_of_bounds(case)
    yield from problems_of_data(case)
    if source is not None and is_encoded(case):
        yield from problems_of_encoding(case, sound_case(config, source))
    kinds = _kinds(config, name)
    needing = [kind for kind in kinds if kind_class(kind).needs_equations]
    if needing and not is_encoded(case):
        yield f"there are no equations of measured series to forecast with ({', '.join(needing)})"
    elif needing and (encoder := undecoded(case)):
        yield (
            f"the encoder {encoder} cannot be decoded, so that equations have no state "
            f"to start from ({', '.join(needing)})"
        )
    if knowing := [kind for kind in kinds if learns_parameters(kind)]:
        yield from _known(config, case, knowing)
    yield from lag_misfits(config, case, kinds)
    yield from room_misfits(config, case)
    filters = [kind for kind in kinds if kind_class(kind).has_filter]
    if any(not (is_encoded(case) and kind in needing) for kind in filters):
        yield from _filter(config.forecasters.filter, case, name)
    for index, block in enumerate(config.control.strategies):
        if name in block.cases:
            yield f"control.strategies[{index}].cases: control needs equations, which data have not"
    yield from _left_out_one_by_one(config, case, "cut a long one (data.blocks)")
