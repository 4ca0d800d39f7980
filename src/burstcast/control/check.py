"""Check that a controller keeps to the interface: shapes, limits, no state between runs."""

import traceback
from pathlib import Path
from typing import NamedTuple

import numpy as np

import burstcast
from burstcast.base.arrays import FloatArray
from burstcast.base.discovery import UnsoundError
from burstcast.control.arenas import LAMINAR_STATE, Lorenz96Arena, checked_action
from burstcast.control.controller import Controller, ControlTask
from burstcast.data.dataset import initial_states
from burstcast.systems.integration import integrate
from burstcast.systems.mfe import MoehlisFaisstEckhardt

_PACKAGE = str(Path(burstcast.__file__).parent)
_FLOWS, _DECISIONS = 5, 36


class _Problem(NamedTuple):
    text: str
    misfit: bool  #: whether the controller may be for the other arena alone


def check_controller(controller: Controller) -> str:
    """Report on a controller, after a few decisions in each of the arenas.

    It need not be for both: a controller of the shear flow has one actuator to switch, one of the
    model of Lorenz 1996 forty variables to push. Raises UnsoundError with all violations of the
    interface that were noticed, if it fits neither, and if in an arena that it fits it changes
    observations, or acts otherwise in a second run.

    Examples
    --------
    >>> from burstcast.control.rules import NoAction
    >>> print(check_controller(NoAction()).splitlines()[0])
    NoAction(): keeps to the interface
    """
    trials = {"shear flow": _shear_flow(), "Lorenz 96": _lorenz96()}
    problems = {name: _problem(controller, *trial) for name, trial in trials.items()}
    found = [problem for problem in problems.values() if problem]
    if len(found) == len(trials) or not all(problem.misfit for problem in found):
        raise UnsoundError(
            [f"{name}: {problem.text}" for name, problem in problems.items() if problem]
        )
    lines = []
    for name, problem in problems.items():
        if problem:
            text = f"does not fit: {problem.text}"
        else:
            text = _share_of_actions(controller, trials[name])
        lines.append(f"  {name:20s} {text}\n")
    return f"{controller!r}: keeps to the interface\n{''.join(lines)}"


def _shear_flow() -> tuple[ControlTask, FloatArray]:
    """Task of the shear flow, and observations of free flows ``(time, components, flows)``."""
    system, generator = MoehlisFaisstEckhardt(reynolds=400.0), np.random.default_rng(0)
    start = initial_states(LAMINAR_STATE, 3, 0.01, _FLOWS + 3, generator)
    states = integrate(system, start, 0.25, 4 * 800, stride=4)[200:]
    noise = 0.01 * states.std(axis=(0, 2))
    seen = states + noise[:, np.newaxis] * generator.normal(size=states.shape)
    task = ControlTask(
        space=system,
        threshold=0.1,
        interval=1.0,
        stride=4,
        steps_per_lyapunov_time=61,
        between=15,
        window=30,
        noise=noise,
        actuators=1,
        limit=1.0,
        most=1,
        switched=True,
        training=np.ascontiguousarray(seen[..., _FLOWS:].transpose(2, 0, 1)),
        equations=system,
    )
    return task, np.ascontiguousarray(seen[..., :_FLOWS])


def _lorenz96() -> tuple[ControlTask, FloatArray]:
    """Task of the model of Lorenz, and observations of free flows."""
    arena = Lorenz96Arena(flows=_FLOWS)
    task = arena.task()
    return task, np.ascontiguousarray(task.training[:_FLOWS, :_DECISIONS].transpose(1, 2, 0))


def _run(controller: Controller, task: ControlTask, seen: FloatArray) -> list[FloatArray]:
    """Actions of a controller at all decisions; ValueError where one is not allowed."""
    controller.begin(task, _FLOWS)
    actions = []
    for number in range(_DECISIONS):
        end = task.window + number * task.between
        window = seen[end - task.window : end].copy()
        before = window.copy()
        controller.observe(window)
        if not np.array_equal(window, before):
            raise UnsoundError(["observe changes the observations that it is given"])
        actions.append(checked_action(controller.act(), task, _FLOWS).copy())
    return actions


def _problem(controller: Controller, task: ControlTask, seen: FloatArray) -> _Problem | None:
    """The first problem of two runs; None if they have none."""
    try:
        first, second = (_run(controller, task, seen) for _ in range(2))
    except UnsoundError as error:
        return _Problem(str(error), misfit=False)
    except Exception as error:  # whatever the controller raises
        kind = "" if isinstance(error, ValueError) else f"{type(error).__name__}: "
        place = traceback.extract_tb(error.__traceback__)[-1]
        where = f" ({Path(place.filename).name}, line {place.lineno})"
        ours = place.filename.startswith(_PACKAGE)
        return _Problem(f"{kind}{error}{'' if ours else where}", misfit=True)
    if np.array_equal(first, second):
        return None
    text = "a second run acts otherwise: begin leaves something of the run before, or seeds no "
    return _Problem(f"{text}generator", misfit=False)


def _share_of_actions(controller: Controller, trial: tuple[ControlTask, FloatArray]) -> str:
    acts = np.array(_run(controller, *trial)).any(axis=1)
    return f"acts at {100 * acts.mean():.0f} % of the decisions on free flows"
