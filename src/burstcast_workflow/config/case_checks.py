"""Checks within a case, and between a case and the settings of the whole campaign.

Whether forecasts fit into the series of a case is checked by `burstcast_workflow.campaign.lengths`.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from pydantic import ValidationError

from burstcast.control.actuation import actuated_system
from burstcast.data.encoders.registry import encoder_class
from burstcast.forecasters._parameter_factors import ParameterFactors
from burstcast.forecasters.registry import kind_class, sections_of_kind
from burstcast.systems.base import has_own
from burstcast.systems.registry import make_system, system_class
from burstcast_workflow.config.bounds import out_of_bounds
from burstcast_workflow.config.case import Case, Data, Measured, Simulated
from burstcast_workflow.config.cases import case_record, kind_of, reynolds_in, valid_case
from burstcast_workflow.config.measured_cases import (
    ONLY_ENCODED,
    problems_of_data,
    problems_of_encoding,
    problems_of_entry,
    space_of,
)
from burstcast_workflow.config.model import Configuration
from burstcast_workflow.config.problems import name_of, problems_of, unknown
from burstcast_workflow.tracking.code import module_file


def problems_of_case(config: Configuration, name: str) -> Iterator[str]:
    """Mistakes in a case of the campaign, a message for each."""
    data = config.data_of(name)
    if data is not None and (problems := list(_source(config, name, data))):
        yield from problems
        return
    record = case_record(config, name)
    try:
        owner = None if data else system_class(record["system"]).__name__
    except (ValueError, TypeError) as error:
        yield f"system: {error}"
        return
    try:
        case = kind_of(config, name).model_validate(record)
    except ValidationError as error:
        yield from _invalid(error, config, name, record, owner)
        return
    yield from out_of_bounds(case)
    yield from _files(case)
    if isinstance(case, Simulated):
        yield from _simulated(config, name, case)
    elif isinstance(case, Measured):
        yield from _measured(config, name, case)
    filters = [kind for kind in config.kinds_of(name) if "filter" in sections_of_kind(kind)]
    if any(not (case.is_encoded and kind_class(kind).needs_equations) for kind in filters):
        members, space = config.forecasters.filter.members, space_of(vars(case))
        if space is not None and members < 2 * space.dimension:
            whose = f"the system {case.system}" if isinstance(case, Simulated) else name
            yield (
                f"forecasters.filter.members is {members}; it must be at least twice the "
                f"components of a state: {2 * space.dimension} for {whose}"
            )
    start_up = config.forecasters.esn_filtered.start_up_lt
    if "esn_filtered" in config.kinds_of(name) and start_up >= config.washout_lt:
        yield (
            f"forecasters.esn_filtered.start_up_lt is {start_up:g}; it must be below washout_lt, "
            f"{config.washout_lt:g}, whose other observations correct the filter"
        )
    if not config.probability.calibration_series and case.training.series < 2:
        others = "cut a long one (data.blocks)"
        if data is None:
            others = "further series (probability.calibration_series)"
        yield (
            "training.series is 1, but probabilities are calibrated on series that are left "
            f"out of the training one by one: take 2 at least, or {others}"
        )


def _source(config: Configuration, name: str, data: Data) -> Iterator[str]:
    """Mistakes in where measured series come from."""
    yield from problems_of_entry(config.entry_of(name), data)
    simulated = config.simulated_cases
    if data.case is not None and data.case not in simulated:
        yield (
            f"data.case is {data.case}; it must be a case of the campaign that is simulated: "
            f"{', '.join(simulated) or 'there is none'}"
        )


def _invalid(
    error: ValidationError,
    config: Configuration,
    name: str,
    record: Mapping[str, Any],
    owner: str | None,
) -> Iterator[str]:
    """Mistakes that pydantic finds in the settings of a case, whose system has a class."""
    delays = (record.get("data") or {}).get("delays")
    duration = record["ensemble"].get("duration")
    if delays and duration is not None and duration <= 0:  # and so is what follows from it
        yield f"data.delays reach back by {max(delays)} steps: more than a series is long"
        return
    mistakes = error.errors(include_url=False)
    missing = [name_of(mistake["loc"]) for mistake in mistakes if mistake["type"] == "missing"]
    if not missing or owner is None or record["system"] == config.case_defaults.system:
        yield from problems_of(error, kind_of(config, name))
        return
    are, it = ("is", "it") if len(missing) == 1 else ("are", "them")
    yield (
        f"{', '.join(missing)} {are} missing: the class {owner} says nothing of {it} in its "
        f"case_defaults, and config.yaml's are in units of another system; say {it} in "
        f"cases.{name}"
    )


def _simulated(config: Configuration, name: str, case: Simulated) -> Iterator[str]:
    if case.sensors is not None or case.encoder is not None:
        yield ONLY_ENCODED
    yield from _system(config, name, case)
    uses = {
        "training.series": case.training.series,
        "test_series": case.test_series,
        "probability.calibration_series": config.probability.calibration_series,
    }
    if sum(uses.values()) > case.ensemble.series:
        listed = " and ".join(f"{use} is {count}" for use, count in uses.items() if count)
        yield f"{listed}; together they must be at most ensemble.series, {case.ensemble.series}"
    control, start = config.control, case.actuation.start_lt if case.actuation else 0
    for time in control.prediction_times_lt:
        if control.forecasters.kinds and time + start < 0:
            yield (
                f"control.prediction_times_lt has {time:g}, but an actuation that starts at "
                f"actuation.start_lt, {start:g}, would then begin before its alarm"
            )
    if _kinds(config, name, "learns_parameters"):
        yield from _parameters(config, name, case)


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
    strengths = dict.fromkeys(
        strength
        for _, block in config.control.blocks
        if name in (block.cases or [name])
        for strength in block.strength
    )
    try:
        make_system(case.system, {**parameters, **actuation.parameters})
        for strength in (1.0, *strengths):
            actuated_system(system, actuation.parameters, actuation.force, strength)
    except ValueError as error:
        yield f"actuation: {error}"


def _measured(config: Configuration, name: str, case: Measured) -> Iterator[str]:
    """Mistakes in a case of measured series."""
    try:
        encoder_class(case.kind_of_encoder)
    except (ValueError, TypeError) as error:
        yield f"encoder.kind: {error}"
        return
    yield from problems_of_data(case)
    if case.is_encoded:
        yield from problems_of_encoding(case, valid_case(config, str(case.data.case)))
    kinds = ", ".join(_kinds(config, name, "needs_equations"))
    if kinds and not case.is_encoded:
        yield f"there are no equations of measured series to forecast with ({kinds})"
    elif kinds and (encoder := case.undecoded):
        yield (
            f"the encoder {encoder} cannot be decoded, so that equations have no state to "
            f"start from ({kinds})"
        )
    if learning := ", ".join(_kinds(config, name, "learns_parameters")):
        if not case.data.known:
            yield f"data.known is empty, but {learning} learn from what is known in advance"
        for key in ("trained_on", "actuation"):
            if getattr(case.training, key):
                yield f"training.{key} means nothing for measured series (data): leave it out"
    for place, block in config.control.blocks:
        if name in block.cases:
            yield f"{place}.cases: control needs equations, which data have not"


def _parameters(config: Configuration, name: str, case: Simulated) -> Iterator[str]:
    """Mistakes in the settings of a case for forecasters that know the parameters."""
    sources = case.training.trained_on or [name]
    text = "training.trained_on: {} is no case that is simulated here"
    if missing := list(unknown(sources, config.simulated_cases, text)):
        yield from missing
        return
    try:
        cases = [Simulated.model_validate(case_record(config, source)) for source in sources]
        factors = factors_of(config, cases)
    except ValidationError:
        return  # reported for the case
    except ValueError as error:
        yield f"forecasters.aware: {error}"
        return
    intervals = [source.ensemble.sampling_interval for source in (case, *cases)]
    alike: dict[str, list[Any]] = {
        "system": [source.system for source in (case, *cases)],
        "ensemble.time_step x ensemble.sampling_stride": intervals,
        "ensemble.duration": [source.ensemble.duration for source in cases],
    }
    for setting, values in alike.items():
        if len(set(values)) > 1:
            yield (
                f"training.trained_on: {', '.join(sources)} must have the same {setting}, not "
                f"{', '.join(map(str, dict.fromkeys(values)))}"
            )
    if factors.count == 0:
        yield (
            f"forecasters.aware.parameters: {', '.join(factors.names)} does not vary in "
            "training; name cases with other values in training.trained_on, or switch an "
            "actuator (training.actuation)"
        )
    first = cases[0].training.trained_on or [sources[0]]
    networks = any(block.forecasters.esn_aware for block in config.blocks_of(name))
    if networks and first != sources:
        yield (
            "training.trained_on: networks have the hyperparameters that are found for the "
            f"first case, {sources[0]}, which must be trained on the same cases: "
            f"{', '.join(sources)}"
        )


def _kinds(config: Configuration, name: str, trait: str) -> list[str]:
    """Kinds of forecasters of a case whose class says yes to a trait, such as ``has_filter``."""
    return [kind for kind in config.kinds_of(name) if getattr(kind_class(kind), trait)]


def _files(case: Case) -> Iterator[str]:
    """Mistakes in the files that a user's module reads."""
    if case.files and case.own_module is None:
        yield "files belong to a system or encoder of your own (<module>:<class>): leave them out"
    elif case.files and (module := module_file(str(case.own_module))):
        missing = [name for name in case.files if not (module.parent / name).is_file()]
        if missing:
            yield f"files: there is no file {', '.join(missing)} in {module.parent}"


def factors_of(config: Configuration, cases: Sequence[Case]) -> ParameterFactors:
    """Factors scaled by the values in training on the series of some cases."""
    aware = config.forecasters.aware
    names, degree = aware.parameters, aware.parameter_degree
    values = []
    for case in cases:
        values.append(case.values_of(names))
        if case.training.actuation is not None:
            values.append(case.values_of(names, case.training.actuation.strength))
    return ParameterFactors.of(names, np.array(values), aware.transform, degree)
