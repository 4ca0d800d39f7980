"""Checks for kinds of forecasters that know the parameters, and warnings of extrapolation."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from pydantic import ValidationError

from burstcast.control.actuation import actuated_system
from burstcast.control.strategies.registry import make_strategy
from burstcast.data.parameter_factors import ParameterFactors
from burstcast.forecasters.registry import learns_parameters
from burstcast.systems.parameters import SHARE, SystemParameters
from burstcast.systems.registry import make_system
from burstcast_workflow.config.cases import blocks_of, campaign_cases, case_of, data_of
from burstcast_workflow.config.control_plans import block_plans
from burstcast_workflow.config.messages import suggestion
from burstcast_workflow.config.model import Case, Configuration, Simulated


def problems_of_parameters(config: Configuration, name: str, case: Simulated) -> Iterator[str]:
    """Mistakes in the settings of a case for forecasters that know the parameters."""
    used, sources = campaign_cases(config), case.training.trained_on or [name]
    for source in sources:
        if source not in used or data_of(config, source) is not None:
            simulated = [one for one in used if data_of(config, one) is None]
            yield f"training.trained_on: {source} is no case that is simulated here; " + suggestion(
                source, simulated
            )
            return
    try:
        cases = [one for source in sources if isinstance(one := case_of(config, source), Simulated)]
        factors = _factors(config, cases)
    except ValidationError:
        return  # told with the case
    except ValueError as error:
        yield f"forecasters.aware: {error}"
        return
    alike: dict[str, list[Any]] = {
        "system": [one.system for one in (case, *cases)],
        "ensemble.time_step x ensemble.sampling_stride": [
            one.ensemble.sampling_interval for one in (case, *cases)
        ],
        "ensemble.duration": [one.ensemble.duration for one in cases],
    }
    for setting, values in alike.items():
        if len(set(values)) > 1:
            yield (
                f"training.trained_on: {', '.join(sources)} must have the same {setting}, not "
                f"{', '.join(map(str, dict.fromkeys(values)))}"
            )
    if factors.count == 0:
        yield (
            f"forecasters.aware.parameters: {', '.join(factors.names)} does not vary in training; "
            "name cases with other values in training.trained_on, or switch an actuator "
            "(training.actuation)"
        )
    first = cases[0].training.trained_on or [sources[0]]
    networks = any(block.forecasters.esn_aware for block in blocks_of(config, name))
    if networks and first != sources:
        yield (
            f"training.trained_on: networks have the hyperparameters that are found for the first "
            f"case, {sources[0]}, which must be trained on the same cases: {', '.join(sources)}"
        )


def extrapolations(config: Configuration) -> Iterator[str]:
    """Warn of parameter values outside of those in training."""
    for name in campaign_cases(config):
        kinds = [kind for block in blocks_of(config, name) for kind in block.forecasters.kinds]
        if not any(map(learns_parameters, kinds)) or data_of(config, name) is not None:
            continue
        case = case_of(config, name)
        sources = case.training.trained_on or [name]
        factors = _factors(config, [case_of(config, source) for source in sources])
        strengths = sorted(
            {
                sign * plan.strength
                for block in config.control.strategies
                if case.actuation is not None and name in (block.cases or [name])
                for plan in block_plans(block)
                for sign in ((1, -1) if dict(plan.settings).get("reversible") else (1,))
                if make_strategy(block.strategy, dict(plan.settings)).told
            }
            | ({tests.strength} if (tests := case.training.actuation) and tests.tested else set())
        )
        told = [_values(config, case, strength) for strength in (0.0, *strengths)]
        for values in told:
            if message := factors.outside(np.array([values])):
                yield f"{name}: {message}"


def _factors(config: Configuration, cases: Sequence[Case]) -> ParameterFactors:
    """Factors scaled by the values in training on the series of some cases."""
    aware = config.forecasters.aware
    found = []
    for case in cases:
        found.append(_values(config, case, 0.0))
        if case.training.actuation is not None:
            found.append(_values(config, case, case.training.actuation.strength))
    names, degree = aware.parameters, aware.parameter_degree
    return ParameterFactors.of(names, np.array(found), aware.transform, degree)


def _values(config: Configuration, case: Case, strength: float) -> tuple[float, ...]:
    """Values of the parameters in a case, under a share of its actuation."""
    names, actuation = config.forecasters.aware.parameters, case.actuation
    if names == [SHARE]:
        return (strength,)
    system = make_system(case.system, case.parameters)
    if strength:
        if actuation is None:
            raise ValueError("training.actuation needs a case with an actuation")
        system = actuated_system(system, actuation.parameters, None, strength)
    return SystemParameters.of(system, names).own
