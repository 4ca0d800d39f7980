"""Time stepping in machine code, made from a system's own numpy expressions.

A system is written down once, in numpy (`burstcast.systems.base.DynamicalSystem`). Here one
Runge-Kutta step of it is taken with symbols instead of numbers: each operation on a symbol is
recorded as an instruction on eight numbers, one per trajectory, from which LLVM makes machine code
(`burstcast.base.compiled.machine_code`).

The recorded operations are numpy's, in numpy's order, and none is fused or reordered: sums,
differences, products, quotients and square roots are exactly rounded in both, so that the results
are the same bits, in any batch, on any processor. What cannot be recorded (another function, a
decision that depends on a state, a matrix product, thousands of components) is left to numpy, and
so is a system whose compiled step and numpy step differ in a single bit.
"""

import logging
import numbers
import traceback
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from burstcast.base.arrays import ByteArray, FloatArray
from burstcast.base.compiled.machine_code import Lanes, compiled
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.runge_kutta import step, whole_power

logger = logging.getLogger(__name__)

WIDTH = 8
"""Trajectories that advance together: one register of AVX-512, two of AVX2."""

# A step of so many takes a second to compile.
_MOST_OPERATIONS = 5000


# --- Recording -----------------------------------------------------------------------------------


class _Recorder:
    """Appends operations on symbols to a program."""

    def __init__(self, code: Lanes) -> None:
        self._code = code
        self._operations = 0

    def symbols(self, vectors: Sequence[str]) -> FloatArray:
        """State of a batch of one trajectory, ``(dimension, 1)``, whose entries are symbols."""
        return np.array([[_Symbol(self, vector)] for vector in vectors], dtype=object)

    def vector(self, value: Any) -> str:
        """Vector that stands for a symbol or a number."""
        return value.vector if isinstance(value, _Symbol) else self._code.fill(value)

    def record(self, operation: str, *operands: object) -> Any:
        """Append an operation, a method of `Lanes`; its result."""
        if not all(isinstance(operand, _Symbol | numbers.Real) for operand in operands):
            return NotImplemented  # an array, which asks each of its entries
        if self._operations == _MOST_OPERATIONS:
            raise OverflowError(f"a step has more than {_MOST_OPERATIONS} operations")
        self._operations += 1
        return _Symbol(self, getattr(self._code, operation)(*map(self.vector, operands)))


def _operators(operation: str) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """An operator of symbols and its reflected form."""

    def operator(self: "_Symbol", other: object) -> Any:
        return self.recorder.record(operation, self, other)

    def reflected(self: "_Symbol", other: object) -> Any:
        return self.recorder.record(operation, other, self)

    return operator, reflected


class _Symbol:
    """A number of each trajectory, as the entry of an array of objects.

    Numpy hands operations on such an array to its entries. Whatever is not defined here (the sine,
    a comparison, the conversion to a number) raises an error, and numpy has to do the integration.
    """

    def __init__(self, recorder: _Recorder, vector: str) -> None:
        self.recorder = recorder
        self.vector = vector

    __add__, __radd__ = _operators("add")
    __sub__, __rsub__ = _operators("subtract")
    __mul__, __rmul__ = _operators("multiply")
    __truediv__, __rtruediv__ = _operators("divide")

    def __pow__(self, exponent: object) -> Any:
        return whole_power(self, exponent)

    def __neg__(self) -> Any:
        return self.recorder.record("negate", self)

    def __pos__(self) -> "_Symbol":
        return self

    def sqrt(self) -> Any:
        """Square root; numpy calls the method of this name."""
        return self.recorder.record("square_root", self)

    # all objects have these by themselves
    def __bool__(self) -> bool:
        raise TypeError("a decision that depends on a state")

    def __eq__(self, other: object) -> bool:
        raise TypeError("a decision that depends on a state")

    __hash__ = None  # type: ignore[assignment]


# --- The program ---------------------------------------------------------------------------------


def _program(systems: Sequence[DynamicalSystem], time_step: float, observed: bool) -> Lanes:
    """Time stepping of a batch, eight trajectories at a time; arguments as of `CompiledSteps.run`.

    Arrays have rows of ``row`` numbers, one for each trajectory; the first ``trajectories`` of them
    are integrated, a multiple of the width.
    """
    pointers, integers = ("states", "choice", "largest"), ("row", "trajectories", "kept", "stride")
    code = Lanes(WIDTH, "run", pointers, integers)
    dimension = systems[0].dimension
    state = code.room(dimension)
    size = code.times("%row", dimension)

    def stepped(system: DynamicalSystem, vectors: list[str]) -> list[str]:
        recorder = _Recorder(code)
        new = step(system, recorder.symbols(vectors), time_step)
        return [recorder.vector(component) for (component,) in new]

    def current() -> list[str]:
        return [code.load(state, str(i)) for i in range(dimension)]

    def replace(vectors: list[str]) -> None:
        for i, vector in enumerate(vectors):
            code.store(state, str(i), vector)

    def obey(number: int, system: DynamicalSystem, vectors: list[str], choice: str) -> None:
        """Take the step of one of several systems where it is chosen."""
        chosen = code.equal_bytes(choice, number)

        def select() -> None:
            new, other = stepped(system, vectors), current()
            replace([code.select(chosen, *pair) for pair in zip(new, other, strict=True)])

        code.when_any(chosen, select)

    def watch(first: str) -> None:
        """Raise the largest observable to the state's; NaN stays, as with `numpy.maximum`."""
        recorder = _Recorder(code)
        (observable,) = systems[0].observable(recorder.symbols(current()))
        largest = code.number_at("%largest", first)
        code.store_row(largest, code.maximum(code.load_row(largest), recorder.vector(observable)))

    def tile(first: str) -> None:
        def component(sample: str, i: int) -> str:
            row = code.plus(code.times(sample, size), code.times("%row", i))
            return code.number_at("%states", code.plus(row, first))

        def sample(index: str) -> None:
            before = code.times(code.plus(index, -1), "%stride")

            def advance(count: str) -> None:
                vectors = current()
                if len(systems) == 1:
                    replace(stepped(systems[0], vectors))
                else:
                    row = code.times(code.plus(before, count), "%row")
                    choice = code.load_bytes("%choice", code.plus(row, first))
                    for number, system in enumerate(systems):
                        obey(number, system, vectors, choice)
                if observed:
                    watch(first)

            code.loop("0", "%stride", advance)
            for i, vector in enumerate(current()):
                code.store_row(component(index, i), vector)

        replace([code.load_row(component("0", i)) for i in range(dimension)])
        code.loop("1", "%kept", sample)

    code.loop("0", "%trajectories", tile, step=WIDTH)
    return code


# --- The interface -------------------------------------------------------------------------------


class CompiledSteps:
    """Compiled time stepping under one system, or under one of several at each step.

    Made by `compiled_steps`.
    """

    def __init__(self, program: Lanes) -> None:
        self._run = compiled(program)

    def run(
        self,
        states: FloatArray,
        stride: int,
        *,
        choice: ByteArray | None = None,
        largest: FloatArray | None = None,
    ) -> None:
        """Integrate a batch of trajectories.

        ``states``: ``(samples, dimension, batch)``, C-contiguous. The first sample is given; the
        others, ``stride`` steps apart, are filled in. ``choice``: Number of the system that each
        step obeys, ``((samples - 1) * stride, batch)``, C-contiguous; needed if, and only if, there
        are several systems. ``largest``: Largest observable so far, ``(batch,)``, contiguous, which
        is kept up to date; needed if, and only if, the program watches it.
        """
        samples, _, batch = states.shape
        whole = batch - batch % WIDTH
        if samples < 2 or stride < 1:
            return
        if whole:
            self._call(states, whole, stride, choice, largest)
        if whole < batch:
            # the trajectories left over, in a tile that the last of them fills up
            lanes = np.minimum(np.arange(whole, whole + WIDTH), batch - 1)
            tile = np.empty((samples, states.shape[1], WIDTH))
            tile[0] = states[0][:, lanes]
            tile_choice = None if choice is None else np.ascontiguousarray(choice[:, lanes])
            tile_largest = None if largest is None else largest[lanes]
            self._call(tile, WIDTH, stride, tile_choice, tile_largest)
            states[1:, :, whole:] = tile[1:, :, : batch - whole]
            if largest is not None and tile_largest is not None:
                largest[whole:] = tile_largest[: batch - whole]

    def _call(
        self,
        states: FloatArray,
        trajectories: int,
        stride: int,
        choice: ByteArray | None,
        largest: FloatArray | None,
    ) -> None:
        samples, _, row = states.shape
        choice_address = None if choice is None else choice.ctypes.data
        largest_address = None if largest is None else largest.ctypes.data
        addresses = (states.ctypes.data, choice_address, largest_address)
        self._run(*addresses, row, trajectories, samples, stride)


def compiled_steps(
    systems: tuple[DynamicalSystem, ...], time_step: float, observed: bool
) -> CompiledSteps | None:
    """Compiled time stepping of these systems; None if they have to be integrated by numpy.

    ``systems``: One, or up to 128 of one dimension between which each step of a trajectory chooses.
    ``observed``: Whether the observable of the first system is watched at every step.
    """
    return _attempt(systems, time_step, observed)[0]


def hindrance(system: DynamicalSystem, time_step: float) -> str | None:
    """The operation that cannot be compiled, with its line; None if the system is compiled."""
    try:
        return _attempt((system,), time_step, False)[1]
    except TypeError:  # no hash
        return "the system has no hash"


@lru_cache(maxsize=64)
def _attempt(
    systems: tuple[DynamicalSystem, ...], time_step: float, observed: bool
) -> tuple[CompiledSteps | None, str | None]:
    """Compiled steps, or the reason why there are none."""
    # Numpy takes over whatever the reason. Should the system be in error, numpy will say so.
    try:
        steps = CompiledSteps(_program(systems, time_step, observed))
        if _same_as_numpy(steps, systems, time_step, observed):
            return steps, None
        reason = "compiled and numpy steps differ in their last bits"
    except Exception as error:
        reason = f"{_place(error)}{type(error).__name__}: {error}"
    logger.info("%s is integrated by numpy (%s)", type(systems[0]).__name__, reason)
    return None, reason


def _place(error: Exception) -> str:
    """Line of a system that raised an error while its operations were noted down."""
    frames = traceback.extract_tb(error.__traceback__)
    step_calls = [number for number, frame in enumerate(frames) if frame.filename == _STEP]
    for frame in frames[step_calls[-1] + 1 :] if step_calls else []:
        return f"{frame.filename}:{frame.lineno}, {frame.line}: "
    return ""


_STEP = step.__code__.co_filename


def _same_as_numpy(
    steps: CompiledSteps,
    systems: tuple[DynamicalSystem, ...],
    time_step: float,
    observed: bool,
) -> bool:
    """Whether one step from some states, no matter which, is the same bits both ways."""
    dimension = systems[0].dimension
    start = np.sin(np.arange(1.0, dimension * WIDTH + 1.0)).reshape(dimension, WIDTH)
    several = len(systems) > 1
    for number, system in enumerate(systems):
        with np.errstate(all="ignore"):
            expected = step(system, start, time_step)
            seen = system.observable(expected)
        states = np.empty((2, dimension, WIDTH))
        states[0] = start
        choice = np.full((1, WIDTH), number, dtype=np.uint8) if several else None
        largest = np.full(WIDTH, -np.inf) if observed else None
        steps.run(states, 1, choice=choice, largest=largest)
        if not np.array_equal(states[1], expected, equal_nan=True):
            return False
        if largest is not None and not np.array_equal(largest, seen, equal_nan=True):
            return False
    return True
