"""Policies: what decides, at a look at flows, whether they are actuated.

A policy is a function of a `Look` at many flows at once; it decides on each of them independently
of the others. Those of the strategies lie in their modules; here are those of whole committees, and
of chance.

Source: section "Control of extreme events" of the paper.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from burstcast.base.arrays import BoolArray, ByteArray, FloatArray, IntArray
from burstcast.base.exogenous import with_inputs
from burstcast.control.actuation import ActuationValues
from burstcast.control.experiment import ControlExperiment
from burstcast.forecasters.base import Forecaster
from burstcast.forecasts.windows import side_by_side

FLOWS_PER_CALL = 64
"""Flows whose members forecast side by side: bounds the memory, changes no result."""


@dataclass(frozen=True)
class Look:
    """A look at flows: what a policy is given."""

    rows: IntArray  #: which of the experiment's flows they are, ``(batch,)``
    number: IntArray  #: number of the look at each of them, from 0, ``(batch,)``
    #: observed states up to and including now, ``(steps, observed components, batch)``
    washout: FloatArray
    #: actuation from each of them to the next, and, after those, during the steps before this
    #: decision takes effect, ``(steps - 1 + delay, batch)``: 0 is none, 1 the actuation, 2 the
    #: reversed one
    acting: ByteArray

    def of(self, flows: slice) -> "Look":
        """The same look at some of the flows."""
        return Look(
            self.rows[flows], self.number[flows], self.washout[..., flows], self.acting[:, flows]
        )

    @property
    def delay(self) -> int:
        """Steps until the decision takes effect."""
        return len(self.acting) - len(self.washout) + 1


Policy = Callable[[Look], BoolArray | ByteArray]
"""Actuation that is set off at a look, ``(batch,)``: 0 (False) is none, 1 (True) the actuation, 2
the reversed one; plus `WITHOUT_FORECAST` where a fallback decided."""

WITHOUT_FORECAST = 4
"""Added to a decision that no valid forecast stands behind."""

REACTIVE, OFF, ON = "reactive", "off", "on"
FALLBACKS = (REACTIVE, OFF, ON)
"""What a strategy does where its forecast is invalid: act while the observable is high, leave the
actuation off, or switch it on."""


class Fallback:
    """Decision at a look at which a forecast is invalid.

    The reactive one acts while the observed observable is at or above a level: halfway from its
    mean over the flows' first washouts to the event threshold.
    """

    def __init__(self, name: str, experiment: ControlExperiment) -> None:
        check_fallback(name)
        self.name, self._observable = name, experiment.observed_space.observable
        states = experiment.washouts
        seen = experiment.system.observable(np.ascontiguousarray(states.transpose(2, 0, 1)))
        self.level = float(0.5 * (seen.mean() + experiment.threshold))

    def __call__(self, look: Look) -> BoolArray:
        """Whether to act at a look, ``(batch,)``."""
        if self.name == REACTIVE:
            return np.asarray(self._observable(look.washout[-1]) >= self.level)
        return np.full(look.washout.shape[-1], self.name == ON)

    def where(self, invalid: BoolArray, decided: BoolArray | ByteArray, look: Look) -> ByteArray:
        """Decisions, with the fallback's where a forecast is invalid.

        ``invalid``, ``decided``: Of each flow, or of all flows for each member of an ensemble one
        after the other, ``(batch,)`` or ``(members * batch,)``.
        """
        decisions = np.asarray(decided).astype(np.uint8)
        if invalid.any():
            own = np.tile(self(look), len(invalid) // len(look.rows)).astype(np.uint8)
            decisions[invalid] = own[invalid] + WITHOUT_FORECAST
        return decisions


def check_fallback(name: str) -> None:
    """Raise ValueError if there is no fallback of this name."""
    if name not in FALLBACKS:
        raise ValueError(f"fallback must be one of {', '.join(FALLBACKS)}, not {name!r}")


@np.errstate(over="ignore", invalid="ignore")
def forecast(forecaster: Forecaster, look: Look, steps: int) -> FloatArray:
    """Forecast of the free flow after a look, components first, ``(dimension, steps, batch)``.

    NaN where it is invalid (`Forecaster.invalid`).
    """
    outputs, _ = forecaster.advance(forecaster.start(look.washout), steps)
    return forecaster.valid(outputs).transpose(1, 0, 2)


def is_invalid(states: FloatArray) -> BoolArray:
    """Whether forecasts ``(dimension, steps, batch)`` are invalid at their end, ``(batch,)``."""
    return np.asarray(np.isnan(states[:, -1]).any(axis=0))


@np.errstate(over="ignore", invalid="ignore")
def informed_memory(forecaster: Forecaster, look: Look, values: ActuationValues) -> FloatArray:
    """Memory of a forecaster at the step at which a decision takes effect.

    The forecaster knows the parameters: it has followed the past actuation, and the one that is on
    its way.
    """
    acting = values.schedule(look.acting).transpose(2, 0, 1)
    washout = with_inputs(look.washout.transpose(2, 0, 1), acting).transpose(1, 2, 0)
    memory = forecaster.start(washout)
    if look.delay:
        _, memory = forecaster.advance(memory, look.delay)
    return memory


def by_vote(policies: Sequence[Policy], share: float) -> Policy:
    """Act where a share of policies, in (0, 1], does: 0.5 of ten are five or more.

    Policies without a valid forecast abstain; where most of them have none, their fallback decides.
    """
    check_share(share)
    if not policies:
        raise ValueError("a vote needs one member at least")

    def decide(look: Look) -> ByteArray:
        return _elected(np.array([policy(look) for policy in policies], dtype=np.uint8), share)

    return decide


class Members:
    """Members of an ensemble side by side, asked like a forecaster with a batch for each."""

    def __init__(self, forecaster: Forecaster) -> None:
        self.forecaster, self.aware = forecaster, forecaster.aware
        self.advance, self.valid = forecaster.advance, forecaster.valid

    def start(self, washout: FloatArray) -> FloatArray:
        """Memories of all members after an observed washout, ``(..., members * batch)``."""
        return side_by_side(self.forecaster.ensemble(washout))


def by_members(policy: Policy, share: float) -> Policy:
    """Act where a share of an ensemble does (`by_vote`): ``policy`` asks its `Members`."""
    check_share(share)

    def decide(look: Look) -> ByteArray:
        decided = np.zeros(len(look.rows), dtype=np.uint8)
        for start in range(0, len(decided), FLOWS_PER_CALL):
            flows = slice(start, start + FLOWS_PER_CALL)
            votes = np.asarray(policy(look.of(flows)), dtype=np.uint8)
            decided[flows] = _elected(votes.reshape(-1, len(decided[flows])), share)
        return decided

    return decide


def at_random(probability: float, draws: FloatArray) -> Policy:
    """Act with a probability: control without information.

    ``draws``: Uniform random numbers in [0, 1), ``(flows, looks)``. Row i is for flow i, so that
    what happens in one flow does not depend on the others.
    """
    if not 0 <= probability <= 1:
        raise ValueError(f"the probability of an alarm must lie in [0, 1], not {probability}")
    return lambda look: draws[look.rows, look.number] < probability


def check_share(share: float) -> None:
    """Raise ValueError if a share of a vote is not in (0, 1]."""
    if not 0 < share <= 1:
        raise ValueError(f"the share of a vote must lie in (0, 1], not {share}")


def _elected(decisions: ByteArray, share: float) -> ByteArray:
    """Decision of a vote, ``(batch,)``, from the decisions of each voter, ``(voters, batch)``."""
    acts, without = decisions % WITHOUT_FORECAST != 0, decisions >= WITHOUT_FORECAST
    voters = (~without).sum(axis=0)
    # a share such as 0.7 of ten misses seven by rounding error only
    elected = ((acts & ~without).sum(axis=0) >= share * voters - 1e-9).astype(np.uint8)
    mostly_without = 2 * voters < len(decisions)
    fallback = (acts & without).any(axis=0)
    elected[mostly_without] = fallback[mostly_without] + np.uint8(WITHOUT_FORECAST)
    return np.asarray(elected)
