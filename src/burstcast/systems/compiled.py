"""Time stepping in machine code, made from a system's own numpy expressions.

A system is written down once, in numpy (`burstcast.systems.base.DynamicalSystem`). Here one
Runge-Kutta step of it is taken with symbols instead of numbers: each operation on a symbol is noted
down as an instruction on eight numbers, one per trajectory. LLVM makes machine code of the notes
(`burstcast.base.compiled.machine_code`), in which a step's temporaries stay in registers or the
nearest cache.

It does the operations that numpy does, in numpy's order, and none is fused or reordered: sums,
differences, products, quotients and square roots are exactly rounded in both, so that the results
are the same bits, in any batch, on any processor. Small whole powers are products in both. What
cannot be noted down (another function, a decision that depends on a state, a matrix product,
thousands of components) is left to numpy, and so is a system whose compiled step and numpy step
differ in a single bit.
"""

import logging
import numbers
import traceback
from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from burstcast.base.arrays import ByteArray, FloatArray
from burstcast.base.compiled.machine_code import compiled, hexadecimal
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.runge_kutta import step, whole_power

logger = logging.getLogger(__name__)

WIDTH = 8
"""Trajectories that advance together: one register of AVX-512, two of AVX2."""

# A step of so many takes a second to compile.
_MOST_OPERATIONS = 5000

_VECTOR = f"<{WIDTH} x double>"
_MASK = f"<{WIDTH} x i1>"
_CHOICE = f"<{WIDTH} x i8>"


# --- Noting down ---------------------------------------------------------------------------------


class _Notes:
    """Instructions, in the order in which they were noted down."""

    def __init__(self, prefix: str) -> None:
        self.lines: list[str] = []
        self._prefix = prefix

    def add(self, instruction: str) -> "_Symbol":
        """Note an instruction down; its result."""
        if len(self.lines) == _MOST_OPERATIONS:
            raise OverflowError(f"a step has more than {_MOST_OPERATIONS} operations")
        name = f"%{self._prefix}{len(self.lines)}"
        self.lines.append(f"{name} = {instruction}")
        return _Symbol(self, name)


class _Symbol:
    """A number of each trajectory, as the entry of an array of objects.

    Numpy hands operations on such an array to its entries. Whatever is not defined here (the sine,
    a comparison, the conversion to a number) raises an error, and numpy has to do the integration.
    """

    def __init__(self, notes: _Notes, name: str) -> None:
        self.notes = notes
        self.name = name

    def __add__(self, other: object) -> Any:
        return _noted("fadd", self, other)

    def __radd__(self, other: object) -> Any:
        return _noted("fadd", other, self)

    def __sub__(self, other: object) -> Any:
        return _noted("fsub", self, other)

    def __rsub__(self, other: object) -> Any:
        return _noted("fsub", other, self)

    def __mul__(self, other: object) -> Any:
        return _noted("fmul", self, other)

    def __rmul__(self, other: object) -> Any:
        return _noted("fmul", other, self)

    def __truediv__(self, other: object) -> Any:
        return _noted("fdiv", self, other)

    def __rtruediv__(self, other: object) -> Any:
        return _noted("fdiv", other, self)

    def __pow__(self, exponent: object) -> Any:
        return whole_power(self, exponent)

    def __neg__(self) -> "_Symbol":
        return self.notes.add(f"fneg {_VECTOR} {self.name}")

    def __pos__(self) -> "_Symbol":
        return self

    # all objects have these by themselves
    def __bool__(self) -> bool:
        raise TypeError("a decision that depends on a state")

    def __eq__(self, other: object) -> bool:
        raise TypeError("a decision that depends on a state")

    __hash__ = None  # type: ignore[assignment]

    def sqrt(self) -> "_Symbol":
        """Square root; numpy calls the method of this name."""
        return self.notes.add(f"call {_VECTOR} @llvm.sqrt.v{WIDTH}f64({_VECTOR} {self.name})")


def _noted(instruction: str, left: object, right: object) -> Any:
    symbol = left if isinstance(left, _Symbol) else right
    assert isinstance(symbol, _Symbol)
    if not all(isinstance(operand, _Symbol | numbers.Real) for operand in (left, right)):
        return NotImplemented  # an array, which asks each of its entries
    return symbol.notes.add(f"{instruction} {_VECTOR} {_operand(left)}, {_operand(right)}")


def _operand(value: Any) -> str:
    """Reference of an instruction to a symbol or a number."""
    if isinstance(value, _Symbol):
        return value.name
    return _everywhere(f"double {hexadecimal(value)}")


def _everywhere(entry: str) -> str:
    """Vector of equal entries."""
    return f"<{', '.join([entry] * WIDTH)}>"


# --- The program ---------------------------------------------------------------------------------

# The state lies in %state, a vector for each component. The arguments are as in
# `CompiledSteps.run`. Arrays have rows of `row` numbers, one for each trajectory; the first
# `trajectories` of them are integrated, a multiple of the width.
_PROGRAM = """
declare {vector} @llvm.sqrt.v{width}f64({vector})

define void @run(ptr %states, ptr %choice, ptr %largest,
                 i64 %row, i64 %trajectories, i64 %kept, i64 %stride) {{
entry:
  %state = alloca {vector}, i64 {dimension}, align 64
  %rows = mul i64 %row, {dimension}
  br label %tile

tile:
  %first = phi i64 [ 0, %entry ], [ %next_first, %tile_end ]
  %tile_states = getelementptr double, ptr %states, i64 %first
  %tile_choice = getelementptr i8, ptr %choice, i64 %first
  %tile_largest = getelementptr double, ptr %largest, i64 %first
  {load}
  br label %sample

sample:
  %index = phi i64 [ 1, %tile ], [ %next_index, %sample_end ]
  %before = phi i64 [ 0, %tile ], [ %next_before, %sample_end ]
  br label %step

step:
  %count = phi i64 [ 0, %sample ], [ %next_count, %step_end ]
  {step}
  br label %step_end

step_end:
  {watch}
  %next_count = add i64 %count, 1
  %more_steps = icmp slt i64 %next_count, %stride
  br i1 %more_steps, label %step, label %sample_end

sample_end:
  %sample_offset = mul i64 %index, %rows
  %sample_states = getelementptr double, ptr %tile_states, i64 %sample_offset
  {store}
  %next_before = add i64 %before, %stride
  %next_index = add i64 %index, 1
  %more_samples = icmp slt i64 %next_index, %kept
  br i1 %more_samples, label %sample, label %tile_end

tile_end:
  %next_first = add i64 %first, {width}
  %more_tiles = icmp slt i64 %next_first, %trajectories
  br i1 %more_tiles, label %tile, label %end

end:
  ret void
}}
"""


def _program(systems: Sequence[DynamicalSystem], time_step: float, observed: bool) -> str:
    """Text of the program, in LLVM's language."""
    dimension = systems[0].dimension
    # copies between the rows of an array in memory and the state
    load, store = [], []
    for i in range(dimension):
        load += [
            f"%row{i} = mul i64 %row, {i}",
            f"%state{i} = getelementptr {_VECTOR}, ptr %state, i64 {i}",
            f"%given{i} = getelementptr double, ptr %tile_states, i64 %row{i}",
            f"%start{i} = load {_VECTOR}, ptr %given{i}, align 8",
            f"store {_VECTOR} %start{i}, ptr %state{i}",
        ]
        store += [
            f"%kept{i} = getelementptr double, ptr %sample_states, i64 %row{i}",
            f"%sampled{i} = load {_VECTOR}, ptr %state{i}",
            f"store {_VECTOR} %sampled{i}, ptr %kept{i}, align 8",
        ]
    steps = _step(systems[0], time_step) if len(systems) == 1 else _choice(systems, time_step)
    return _PROGRAM.format(
        vector=_VECTOR,
        width=WIDTH,
        dimension=dimension,
        load="\n  ".join(load),
        step="\n  ".join(steps),
        watch="\n  ".join(_watch(systems[0]) if observed else []),
        store="\n  ".join(store),
    )


def _step(system: DynamicalSystem, time_step: float) -> list[str]:
    """One step of all trajectories of the tile."""
    lines, state = _loaded_state(system.dimension, "old")
    notes, new = _noted_step(system, time_step, "now", state)
    stores = [f"store {_VECTOR} {value}, ptr %state{i}" for i, value in enumerate(new)]
    return [*lines, *notes, *stores]


def _choice(systems: Sequence[DynamicalSystem], time_step: float) -> list[str]:
    """One step of each trajectory of the tile under its own system."""
    lines, state = _loaded_state(systems[0].dimension, "old")
    lines += [
        "%steps_taken = add i64 %before, %count",
        "%choice_offset = mul i64 %steps_taken, %row",
        "%step_choice = getelementptr i8, ptr %tile_choice, i64 %choice_offset",
        f"%chosen = load {_CHOICE}, ptr %step_choice, align 1",
    ]
    for number, system in enumerate(systems):
        name = f"system{number}"
        notes, new = _noted_step(system, time_step, f"{name}_now", state)
        lines += [
            f"%{name}_mask = icmp eq {_CHOICE} %chosen, {_everywhere(f'i8 {number}')}",
            f"%{name}_bits = bitcast {_MASK} %{name}_mask to i{WIDTH}",
            f"%{name}_any = icmp ne i{WIDTH} %{name}_bits, 0",
            f"br i1 %{name}_any, label %{name}_step, label %{name}_end",
            f"{name}_step:",
            *notes,
        ]
        for i, value in enumerate(new):
            lines += [
                f"%{name}_other{i} = load {_VECTOR}, ptr %state{i}",
                f"%{name}_new{i} = select {_MASK} %{name}_mask, {_VECTOR} {value}, "
                f"{_VECTOR} %{name}_other{i}",
                f"store {_VECTOR} %{name}_new{i}, ptr %state{i}",
            ]
        lines += [f"br label %{name}_end", f"{name}_end:"]
    return lines


def _watch(system: DynamicalSystem) -> list[str]:
    """Raise the largest observable to the state's; NaN stays, as with `numpy.maximum`."""
    lines, state = _loaded_state(system.dimension, "reached")
    notes = _Notes("seen")
    (observable,) = system.observable(_symbols(notes, state))
    value = _operand(observable)
    return [
        *lines,
        *notes.lines,
        f"%so_far = load {_VECTOR}, ptr %tile_largest, align 8",
        f"%larger = fcmp olt {_VECTOR} %so_far, {value}",
        f"%undefined = fcmp uno {_VECTOR} {value}, {value}",
        f"%taken = or {_MASK} %larger, %undefined",
        f"%largest_now = select {_MASK} %taken, {_VECTOR} {value}, {_VECTOR} %so_far",
        f"store {_VECTOR} %largest_now, ptr %tile_largest, align 8",
    ]


def _loaded_state(dimension: int, prefix: str) -> tuple[list[str], list[str]]:
    """Instructions that load the state, and the names that they give its components."""
    names = [f"%{prefix}{i}" for i in range(dimension)]
    return [f"{name} = load {_VECTOR}, ptr %state{i}" for i, name in enumerate(names)], names


def _noted_step(
    system: DynamicalSystem, time_step: float, prefix: str, state: list[str]
) -> tuple[list[str], list[str]]:
    """Instructions of a step from the state of these names, and the operands that it leads to."""
    notes = _Notes(prefix)
    new = step(system, _symbols(notes, state), time_step)
    return notes.lines, [_operand(component) for (component,) in new]


def _symbols(notes: _Notes, names: list[str]) -> FloatArray:
    # a batch of one trajectory: an array that computes like one of numbers
    return np.array([[_Symbol(notes, name)] for name in names], dtype=object)


# --- The interface -------------------------------------------------------------------------------


class CompiledSteps:
    """Compiled time stepping under one system, or under one of several at each step.

    Made by `compiled_steps`.
    """

    def __init__(self, program: str) -> None:
        self._run = compiled(program, "run", pointers=3, integers=4)

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
        self._run(
            states.ctypes.data,
            None if choice is None else choice.ctypes.data,
            None if largest is None else largest.ctypes.data,
            *(row, trajectories, samples, stride),
        )


def compiled_steps(
    systems: tuple[DynamicalSystem, ...], time_step: float, observed: bool
) -> CompiledSteps | None:
    """Compiled time stepping of these systems; None if they have to be integrated by numpy.

    ``systems``: One, or up to 128 of one dimension between which each step of a trajectory chooses.
    ``observed``: Whether the observable of the first system is watched at every step.
    """
    return _attempt(systems, time_step, observed)[0]


def hindrance(system: DynamicalSystem, time_step: float) -> str | None:
    """Why a system is integrated by numpy: the operation that cannot be compiled, with its line.

    None if the system is compiled.
    """
    try:
        return _attempt((system,), time_step, False)[1]
    except TypeError:  # no hash
        return "a parameter is an array"


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
