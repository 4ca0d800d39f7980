"""Checks within a case, and between a case and the settings of the whole campaign.

Whether forecasts fit into the series of a case is checked by `burstcast_workflow.campaign.lengths`.
"""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import Any

import numpy as np
from pydantic import ValidationError

from burstcast.base import durations
from burstcast.control.actuation import actuated_system
from burstcast.data.encoders.registry import encoder_class
from burstcast.forecasters._parameter_factors import ParameterFactors
from burstcast.forecasters.precursor import lag_steps
from burstcast.forecasters.registry import kind_class, sections_of_kind
from burstcast.systems.base import has_own
from burstcast.systems.registry import make_system, system_class
from burstcast_workflow.config.bounds import out_of_bounds
from burstcast_workflow.config.case import Case, Encoded, Measured, Simulated
from burstcast_workflow.config.cases import case_record, kind_of, reynolds_in, sound_case
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

FINE = 1000
"""Steps per Lyapunov time where it is unknown: no duration is too short then."""


class CaseChecks:
    """Checks of one case of the campaign: each yields a message for each mistake."""

    def __init__(self, config: Configuration, name: str) -> None:
        self.config, self.name = config, name
        self.blocks, self.kinds = config.blocks_of(name), config.kinds_of(name)
        self.learning = [kind for kind in self.kinds if kind_class(kind).learns_parameters]

    def problems(self) -> Iterator[str]:
        """Mistakes in the case."""
        yield from self._simulated() if self.config.data_of(self.name) is None else self._measured()

    def _simulated(self) -> Iterator[str]:
        record = case_record(self.config, self.name)
        try:
            owner = system_class(record["system"]).__name__
        except (ValueError, TypeError) as error:
            yield f"system: {error}"
            return
        try:
            case = Simulated.model_validate(record)
        except ValidationError as error:
            mistakes = error.errors(include_url=False)
            missing = [
                name_of(mistake["loc"]) for mistake in mistakes if mistake["type"] == "missing"
            ]
            if missing and record["system"] != self.config.case_defaults.system:
                are, it = ("is", "it") if len(missing) == 1 else ("are", "them")
                yield (
                    f"{', '.join(missing)} {are} missing: the class {owner} says nothing of {it} "
                    "in its case_defaults, and config.yaml's are in units of another system; say "
                    f"{it} in cases.{self.name}"
                )
            else:
                yield from problems_of(error, Simulated)
            return
        if case.sensors is not None or case.encoder is not None:
            yield ONLY_ENCODED
        yield from _files(case)
        yield from out_of_bounds(case)
        yield from self._system(case)
        if any(kind_class(kind).has_filter for kind in self.kinds):
            yield from self._filter(case, f"the system {case.system}")
        uses = {
            "training.series": case.training.series,
            "test_series": case.test_series,
            "probability.calibration_series": self.config.probability.calibration_series,
        }
        if sum(uses.values()) > case.ensemble.series:
            listed = " and ".join(f"{name} is {count}" for name, count in uses.items() if count)
            yield f"{listed}; together they must be at most ensemble.series, {case.ensemble.series}"
        yield from self._left_out(case, "further series (probability.calibration_series)")
        yield from self._starts_of_actuation(case)
        yield from self._lags(case)
        if self.learning:
            yield from self._parameters(case)

    def _system(self, case: Simulated) -> Iterator[str]:
        parameters, ensemble, actuation = case.parameters, case.ensemble, case.actuation
        reynolds = parameters.get("reynolds")
        if reynolds_in(self.name) not in (None, reynolds):
            yield (
                f"parameters.reynolds is {reynolds:g}, which contradicts the name {self.name}: "
                "leave it out"
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
            yield (
                f"ensemble.initial_state is null, but {of_system} draws no initial states: give one"
            )
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
            for block in self.config.control.strategies
            if self.name in (block.cases or [self.name])
            for strength in block.strength
        )
        try:
            make_system(case.system, {**parameters, **actuation.parameters})
            for strength in (1.0, *strengths):
                actuated_system(system, actuation.parameters, actuation.force, strength)
        except ValueError as error:
            yield f"actuation: {error}"

    def _left_out(self, case: Case, others: str) -> Iterator[str]:
        """Checks that leave-one-out calibration has at least two training series."""
        if not self.config.probability.calibration_series and case.training.series < 2:
            yield (
                "training.series is 1, but probabilities are calibrated on series that are left "
                f"out of the training one by one: take 2 at least, or {others}"
            )

    def _starts_of_actuation(self, case: Case) -> Iterator[str]:
        control = self.config.control
        start = case.actuation.start_lt if case.actuation else 0
        for time in control.prediction_times_lt:
            if control.forecasters.kinds and time + start < 0:
                yield (
                    f"control.prediction_times_lt has {time:g}, but an actuation that starts at "
                    f"actuation.start_lt, {start:g}, would then begin before its alarm"
                )

    def _filter(self, case: Case, whose: str) -> Iterator[str]:
        members, space = self.config.forecasters.filter.members, space_of(vars(case))
        if space is not None and members < 2 * space.dimension:
            yield (
                f"forecasters.filter.members is {members}; it must be at least twice the "
                f"components of a state: {2 * space.dimension} for {whose}"
            )

    def _measured(self) -> Iterator[str]:
        """Mistakes in a case of measured series."""
        config, name = self.config, self.name
        entry, data = config.entry_of(name), config.data_of(name)
        assert data is not None
        if problems := list(problems_of_entry(entry)):
            yield from problems
            return
        source, used = data.case, config.case_names
        simulated = [case for case in used if config.data_of(case) is None]
        if source is not None and source not in simulated:
            yield (
                f"data.case is {source}; it must be a case of the campaign that is simulated: "
                f"{', '.join(simulated) or 'there is none'}"
            )
            return
        record = case_record(config, name)
        duration, delays = record["ensemble"]["duration"], data.delays
        if delays and duration is not None and duration <= 0:  # and so is what follows from it
            yield f"data.delays reach back by {max(delays)} steps: more than a series is long"
            return
        try:
            case = kind_of(config, name).model_validate(record)
            assert isinstance(case, Measured)
        except ValidationError as error:
            yield from problems_of(error, Measured)
            return
        yield from out_of_bounds(case)
        yield from problems_of_data(case)
        if isinstance(case, Encoded):
            try:
                encoder_class(case.kind_of_encoder)
            except (ValueError, TypeError) as error:
                yield f"encoder.kind: {error}"
                return
            yield from _files(case)
        if source is not None and case.is_encoded:
            yield from problems_of_encoding(case, sound_case(config, source))
        needing = [kind for kind in self.kinds if kind_class(kind).needs_equations]
        kinds = ", ".join(needing)
        if needing and not case.is_encoded:
            yield f"there are no equations of measured series to forecast with ({kinds})"
        elif needing and (encoder := case.undecoded):
            yield (
                f"the encoder {encoder} cannot be decoded, so that equations have no state to "
                f"start from ({kinds})"
            )
        if self.learning:
            if not data.known:
                learning = ", ".join(self.learning)
                yield f"data.known is empty, but {learning} learn from what is known in advance"
            for key in ("trained_on", "actuation"):
                if getattr(case.training, key):
                    yield f"training.{key} means nothing for measured series (data): leave it out"
        yield from self._lags(case)
        filters = [kind for kind in self.kinds if kind_class(kind).has_filter]
        if any(not (case.is_encoded and kind in needing) for kind in filters):
            yield from self._filter(case, name)
        for index, block in enumerate(config.control.strategies):
            if name in block.cases:
                place = f"control.strategies[{index}].cases"
                yield f"{place}: control needs equations, which data have not"
        yield from self._left_out(case, "cut a long one (data.blocks)")

    def _lags(self, case: Case) -> Iterator[str]:
        """Whether lags of a precursor, or starting points of classifiers, do not fit the steps."""
        forecasters, steps = self.config.forecasters, FINE
        sections = {name for kind in self.kinds for name in sections_of_kind(kind)}
        with suppress(ValueError):  # reported for the case
            steps = case.steps_per_lyapunov_time or FINE
        try:
            if "precursor" in sections:
                washout = durations.steps(self.config.washout_lt, steps)
                lag_steps(forecasters.precursor.lags_lt, steps, washout)
            if sections & {"precursor", "esn_direct"}:
                name = "forecasters.classifiers.start_spacing_lt"
                durations.positive_steps(forecasters.classifiers.start_spacing_lt, steps, name)
        except ValueError as error:
            yield str(error)

    # -- parameters that forecasters know ----------------------------------------------------------

    def _parameters(self, case: Simulated) -> Iterator[str]:
        """Mistakes in the settings of a case for forecasters that know the parameters."""
        config = self.config
        simulated = [name for name in config.case_names if config.data_of(name) is None]
        sources = case.training.trained_on or [self.name]
        text = "training.trained_on: {} is no case that is simulated here"
        if missing := list(unknown(sources, simulated, text)):
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
        networks = any(block.forecasters.esn_aware for block in self.blocks)
        if networks and first != sources:
            yield (
                "training.trained_on: networks have the hyperparameters that are found for the "
                f"first case, {sources[0]}, which must be trained on the same cases: "
                f"{', '.join(sources)}"
            )


def _files(case: Simulated | Encoded) -> Iterator[str]:
    """Mistakes in the files that a user's module reads."""
    if case.files and case.own_module is None:
        yield "files belong to a system or encoder of your own (<module>:<class>): leave them out"
    elif case.files and case.own_module and (module := module_file(case.own_module)):
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
