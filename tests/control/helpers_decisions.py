"""Decisions at equal intervals written as one plain loop, one flow at a time."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.control.timing import DecisionTiming
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.runge_kutta import step


@dataclass(frozen=True)
class PlainDecisions:
    controlled: FloatArray  # states (steps, dimension)
    acting: list[bool]  # integration steps since step 0
    on: list[bool]
    event_ahead: list[bool]
    washout_actuated: list[bool]


def plain_decisions(
    system: DynamicalSystem,
    actuated: DynamicalSystem,
    washout: FloatArray,
    decide: Callable[[int, FloatArray], bool],
    timing: DecisionTiming,
    threshold: float,
    horizon: int,
) -> PlainDecisions:
    """One flow: ``decide`` sees the number of a decision and the last true states."""
    stride = timing.sampling_stride
    states = [state[:, np.newaxis] for state in washout]
    acting = [False] * ((timing.counted_until + timing.delay + timing.interval + 1) * stride)
    on, ahead, behind = [], [], []
    end = timing.counted_until
    for now in range(timing.washout - 1, end):
        since = now - (timing.washout - 1)
        if since % timing.interval == 0 and now + timing.delay < end:
            seen = np.stack(states[now + 1 - timing.washout : now + 1])[:, :, 0]
            on.append(decide(len(on), seen))
            for number in range((now + timing.delay) * stride, len(acting)):
                acting[number] = on[-1]  # until a later decision says otherwise
            first = (now + 1 - timing.washout) * stride
            behind.append(any(acting[first : now * stride]))
            free = states[now]
            heights = []
            for number in range(1, horizon * stride + 1):
                free = step(system, free, timing.time_step)
                if number % stride == 0:
                    heights.append(float(system.observable(free)[0]))
            ahead.append(max(heights) >= threshold)
        state = states[now]
        for number in range(now * stride, (now + 1) * stride):
            state = step(actuated if acting[number] else system, state, timing.time_step)
        states.append(state)
    return PlainDecisions(np.stack(states)[:, :, 0], acting, on, ahead, behind)
