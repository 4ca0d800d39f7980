# Numba gives the compiled functions types of its own, which mypy cannot follow.
# mypy: disable-error-code="no-untyped-call,no-untyped-def,call-arg,var-annotated,import-untyped"
"""Dynamics of the reservoir, compiled with numba: the fast implementation.

A batch is cut into tiles of 16 trajectories. A tile's state is held as ``(neurons, 16)``, so that
an entry of the recurrent matrix multiplies 16 neighbouring numbers, and everything that happens to
a neuron (its row of the matrix, its input, the hyperbolic tangent, its share of the readout)
happens while it is in the registers or the nearest cache. This is several times faster than a
sparse product followed by ``numpy.tanh``, which `burstcast.esn.backend_scipy` does.

The arithmetic is spelt out in vectors of 16 numbers (`Lanes`) with explicit fused multiply-adds
rather than left to the compiler's vectoriser. Hence every trajectory goes through the same
operations in the same order wherever it stands in a tile or a batch, whatever the processor: the
same bits. A processor without fused multiply-add instructions is slow, not wrong.

The machine code is cached beside this file (or in ``NUMBA_CACHE_DIR``) per processor type. The
cache notices changes to this file only: all that is compiled must stay in it.
"""

from typing import Any

import numpy as np
import scipy.sparse
from llvmlite import ir
from numba import njit, types
from numba.core import cgutils
from numba.core.datamodel.models import PrimitiveModel
from numba.core.datamodel.registry import register_default
from numba.extending import intrinsic, register_jitable
from numba.np.arrayobj import make_array

from burstcast.arrays import FloatArray, Int32Array

# Trajectories in a tile. Eight leave the processor waiting for results, 32 do not fit its
# registers. Arrays of tiles are aligned to a cache line, 64 bytes.
_WIDTH = 16
_ALIGNMENT = 64
# Neurons whose states are fed to the readout together, while they are in the nearest cache.
_READOUT_BLOCK = 32


# --- Vectors -------------------------------------------------------------------------------------

_VECTOR = ir.VectorType(ir.DoubleType(), _WIDTH)
_INDICES = ir.VectorType(ir.IntType(32), _WIDTH)


class Lanes(types.Type):
    """Numba type of a vector of 16 numbers, one per trajectory of a tile."""

    def __init__(self) -> None:
        super().__init__(name=f"Lanes({_WIDTH})")


@register_default(Lanes)
class _LanesModel(PrimitiveModel):
    def __init__(self, manager: Any, lanes_type: Any) -> None:
        super().__init__(manager, lanes_type, _VECTOR)


_lanes = Lanes()


def _element(context: Any, builder: Any, array_type: Any, array: Any, index: Any) -> Any:
    """Pointer to an element of a one-dimensional contiguous array; no check of any bound."""
    return builder.gep(make_array(array_type)(context, builder, array).data, [index])


def _splat(builder: Any, number: Any) -> Any:
    undefined = ir.Constant(_VECTOR, ir.Undefined)
    first = builder.insert_element(undefined, number, ir.Constant(ir.IntType(32), 0))
    return builder.shuffle_vector(first, undefined, ir.Constant(_INDICES, [0] * _WIDTH))


@intrinsic
def _at(typing: Any, array: Any, index: Any) -> Any:
    """``array[index]`` for an int32 array, without numba's handling of negative indices."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        value = builder.load(_element(context, builder, signature.args[0], *arguments))
        return builder.sext(value, ir.IntType(64))

    return types.int64(array, types.intp), generate


@intrinsic
def _load(typing: Any, array: Any, index: Any) -> Any:
    """Vector number ``index`` of an aligned array of vectors."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        values, position = arguments
        start = builder.mul(position, ir.Constant(ir.IntType(64), _WIDTH))
        pointer = _element(context, builder, signature.args[0], values, start)
        return builder.load(builder.bitcast(pointer, _VECTOR.as_pointer()), align=_ALIGNMENT)

    return _lanes(array, types.intp), generate


@intrinsic
def _store(typing: Any, array: Any, index: Any, vector: Any) -> Any:
    """Make ``vector`` vector number ``index`` of an aligned array of vectors."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        values, position, stored = arguments
        start = builder.mul(position, ir.Constant(ir.IntType(64), _WIDTH))
        pointer = _element(context, builder, signature.args[0], values, start)
        builder.store(stored, builder.bitcast(pointer, _VECTOR.as_pointer()), align=_ALIGNMENT)
        return context.get_dummy_value()

    return types.void(array, types.intp, _lanes), generate


@intrinsic
def _fill(typing: Any, number: Any) -> Any:
    """Vector of equal numbers."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return _splat(builder, arguments[0])

    return _lanes(types.float64), generate


@intrinsic
def _fill_from(typing: Any, array: Any, index: Any) -> Any:
    """Vector whose numbers all equal ``array[index]``."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return _splat(
            builder, builder.load(_element(context, builder, signature.args[0], *arguments))
        )

    return _lanes(array, types.intp), generate


@intrinsic
def _fused(typing: Any, x: Any, y: Any, z: Any) -> Any:
    """``x * y + z``, rounded once."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        function = cgutils.get_or_insert_function(
            builder.module, ir.FunctionType(_VECTOR, [_VECTOR] * 3), f"llvm.fma.v{_WIDTH}f64"
        )
        return builder.call(function, arguments)

    return _lanes(_lanes, _lanes, _lanes), generate


@intrinsic
def _add(typing: Any, x: Any, y: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.fadd(*arguments)

    return _lanes(_lanes, _lanes), generate


@intrinsic
def _multiply(typing: Any, x: Any, y: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.fmul(*arguments)

    return _lanes(_lanes, _lanes), generate


@intrinsic
def _divide(typing: Any, x: Any, y: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.fdiv(*arguments)

    return _lanes(_lanes, _lanes), generate


@intrinsic
def _clamp(typing: Any, x: Any, bound: Any) -> Any:
    """``x`` limited to [-bound, bound]; nan stays nan."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        value, largest = arguments
        upper, lower = _splat(builder, largest), _splat(builder, builder.fneg(largest))
        value = builder.select(builder.fcmp_ordered(">", value, upper), upper, value)
        return builder.select(builder.fcmp_ordered("<", value, lower), lower, value)

    return _lanes(_lanes, types.float64), generate


# --- The step ------------------------------------------------------------------------------------


@register_jitable
def _tanh(x):
    """Hyperbolic tangent, off by at most seven units in the last place (0.6 in the mean).

    The Pade approximant [9/10] of tanh(x / 4) = p / q, and twice
    tanh(2 y) = 2 tanh(y) / (1 + tanh(y)^2), that is (p, q) <- (2 p q, p^2 + q^2). It needs one
    division and no table. Beyond 20, tanh is one to the last place.
    """
    y = _multiply(_clamp(x, 20.0), _fill(0.25))
    s = _multiply(y, y)
    p = _fused(_fill(55.0), s, _fill(25740.0))
    p = _fused(p, s, _fill(2837835.0))
    p = _fused(p, s, _fill(91891800.0))
    p = _fused(p, s, _fill(654729075.0))
    p = _multiply(p, y)
    q = _add(s, _fill(1485.0))
    q = _fused(q, s, _fill(315315.0))
    q = _fused(q, s, _fill(18918900.0))
    q = _fused(q, s, _fill(310134825.0))
    q = _fused(q, s, _fill(654729075.0))
    for _ in range(2):
        p, q = _multiply(_add(p, p), q), _fused(p, p, _multiply(q, q))
    return _divide(p, q)


@register_jitable
def _advance(row_start, column, value, input_column, input_weight, fed, old, new, first, last):
    """Compute the new states of the neurons ``first`` to ``last - 1`` of a tile.

    Rows have an even number of entries, which are summed in two chains.
    """
    for neuron in range(first, last):
        even = _multiply(_fill_from(input_weight, neuron), _load(fed, _at(input_column, neuron)))
        odd = _fill(0.0)
        for k in range(_at(row_start, neuron), _at(row_start, neuron + 1), 2):
            even = _fused(_fill_from(value, k), _load(old, _at(column, k)), even)
            odd = _fused(_fill_from(value, k + 1), _load(old, _at(column, k + 1)), odd)
        _store(new, neuron, _tanh(_add(even, odd)))


@register_jitable
def _read_out(weights, rows, states, first, last, outputs):
    """Add the share of the neurons ``first`` to ``last - 1`` to the outputs of a tile.

    ``weights`` is ``(neurons, rows)``, flat, with an even number of rows.
    """
    for row in range(0, rows, 2):
        even, odd = _load(outputs, row), _load(outputs, row + 1)
        for neuron in range(first, last):
            state = _load(states, neuron)
            even = _fused(_fill_from(weights, neuron * rows + row), state, even)
            odd = _fused(_fill_from(weights, neuron * rows + row + 1), state, odd)
        _store(outputs, row, even)
        _store(outputs, row + 1, odd)


# --- The loops -----------------------------------------------------------------------------------

# What is only read may be a read-only array.
_INTEGERS = types.Array(types.int32, 1, "C", readonly=True)
_FLOATS = types.Array(types.float64, 1, "C", readonly=True)
_FLOATS_3D = types.Array(types.float64, 3, "C", readonly=True)
_ROOM = types.float64[::1]
_ROOM_3D = types.float64[:, :, ::1]
_MATRICES = (_INTEGERS, _INTEGERS, _FLOATS, _INTEGERS, _FLOATS)


@njit(
    types.boolean(*_MATRICES, _FLOATS_3D, types.int64, _ROOM, _ROOM, _ROOM, _ROOM_3D),
    cache=True,
)
def _drive_tile(
    row_start,
    column,
    value,
    input_column,
    input_weight,
    inputs,
    first,
    fed,
    old,
    new,
    record,
):
    """Drive the tile of trajectories from ``first`` on by data.

    ``inputs`` is ``(steps, dimension, batch)``; ``old`` holds the states; ``fed``,
    ``(dimension + 1, 16)``, holds the bias in its last row. ``record``, ``(neurons, steps, batch)``
    or empty, receives the state after each input. Returns whether the final states are in ``new``.
    """
    steps, dimension, batch = inputs.shape
    neurons = row_start.size - 1
    used = min(_WIDTH, batch - first)
    recording = record.size > 0
    for step in range(steps):
        for component in range(dimension):
            for lane in range(used):
                fed[component * _WIDTH + lane] = inputs[step, component, first + lane]
        _advance(row_start, column, value, input_column, input_weight, fed, old, new, 0, neurons)
        if recording:
            for neuron in range(neurons):
                for lane in range(used):
                    record[neuron, step, first + lane] = new[neuron * _WIDTH + lane]
        old, new = new, old
    return steps % 2 == 1


@njit(
    types.boolean(
        *_MATRICES,
        _FLOATS,
        _FLOATS,
        _FLOATS,
        types.int64,
        _ROOM,
        _ROOM,
        _ROOM,
        _ROOM,
        _ROOM_3D,
    ),
    cache=True,
)
def _forecast_tile(
    row_start,
    column,
    value,
    input_column,
    input_weight,
    weights,
    output_bias,
    input_range,
    first,
    fed,
    read,
    old,
    new,
    outputs,
):
    """Forecast the tile of trajectories from ``first`` on into ``outputs``.

    ``outputs`` is ``(steps, dimension, batch)``; ``read`` is room for the outputs of the tile, with
    as many rows as ``output_bias`` and ``weights`` have (an even number). The rest is as in
    `_drive_tile`.
    """
    steps, dimension, batch = outputs.shape
    neurons = row_start.size - 1
    rows = output_bias.size
    used = min(_WIDTH, batch - first)
    for row in range(rows):
        _store(read, row, _fill_from(output_bias, row))
    for start in range(0, neurons, _READOUT_BLOCK):
        _read_out(weights, rows, old, start, min(start + _READOUT_BLOCK, neurons), read)
    for step in range(steps):
        for component in range(dimension):
            predicted = _load(read, component)
            _store(fed, component, _divide(predicted, _fill_from(input_range, component)))
            for lane in range(used):
                outputs[step, component, first + lane] = read[component * _WIDTH + lane]
        for row in range(rows):
            _store(read, row, _fill_from(output_bias, row))
        for start in range(0, neurons, _READOUT_BLOCK):
            stop = min(start + _READOUT_BLOCK, neurons)
            _advance(
                row_start, column, value, input_column, input_weight, fed, old, new, start, stop
            )
            _read_out(weights, rows, new, start, stop, read)
        old, new = new, old
    return steps % 2 == 1


# --- The interface -------------------------------------------------------------------------------


class NumbaBackend:
    """Open and closed loop of one reservoir with its hyperparameters applied.

    The same interface as `burstcast.esn.backend_scipy.ScipyBackend`.
    """

    def __init__(
        self,
        recurrent: scipy.sparse.csr_array,
        input_column: Int32Array,
        input_weight: FloatArray,
        input_bias: float,
    ) -> None:
        self._matrices = (
            *_even_rows(recurrent),
            np.ascontiguousarray(input_column, dtype=np.int32),
            np.ascontiguousarray(input_weight, dtype=np.float64),
        )
        self._input_bias = input_bias

    def open_loop(
        self, inputs: FloatArray, states: FloatArray, record: FloatArray | None
    ) -> FloatArray:
        """Drive the states by data; arguments as in `burstcast.esn.dynamics.Dynamics.open_loop`.

        ``record``, of shape ``(neurons, steps, batch)``, receives the state after each input.
        """
        if record is None:
            record = np.empty((0, 0, 0))
        neurons, batch = states.shape
        fed = self._fed(inputs.shape[1])
        old, new = _tiles(neurons), _tiles(neurons)
        final = np.empty_like(states)
        for first in range(0, batch, _WIDTH):
            _fill_tile(old, states, first)
            swapped = _drive_tile(
                *self._matrices, inputs, first, fed.ravel(), old.ravel(), new.ravel(), record
            )
            _read_tile(new if swapped else old, final, first)
        return final

    def closed_loop(
        self, weights: FloatArray, input_range: FloatArray, states: FloatArray, steps: int
    ) -> tuple[FloatArray, FloatArray]:
        """Let the network drive itself; see `burstcast.esn.dynamics.Dynamics.closed_loop`."""
        neurons, batch = states.shape
        dimension = weights.shape[1]
        # Rows come in pairs: an odd number is filled up by a row of zeros.
        padded = np.zeros((neurons + 1, dimension + dimension % 2))
        padded[:, :dimension] = weights
        fed, read = self._fed(dimension), _tiles(padded.shape[1])
        old, new = _tiles(neurons), _tiles(neurons)
        outputs = np.empty((steps, dimension, batch))
        final = np.empty_like(states)
        for first in range(0, batch, _WIDTH):
            _fill_tile(old, states, first)
            swapped = _forecast_tile(
                *self._matrices,
                padded[:-1].ravel(),
                padded[-1],
                input_range,
                first,
                fed.ravel(),
                read.ravel(),
                old.ravel(),
                new.ravel(),
                outputs,
            )
            _read_tile(new if swapped else old, final, first)
        return outputs, final

    def _fed(self, dimension: int) -> FloatArray:
        fed = _tiles(dimension + 1)
        fed[dimension] = self._input_bias
        return fed


def _even_rows(matrix: scipy.sparse.csr_array) -> tuple[Int32Array, Int32Array, FloatArray]:
    """Row starts, columns and values with an even number of entries in each row.

    An odd row gets one more entry, zero, in the column of the row itself.
    """
    neurons = matrix.shape[0]
    length = np.diff(matrix.indptr)
    row_start = np.concatenate([[0], np.cumsum(length + length % 2)]).astype(np.int32)
    row = np.repeat(np.arange(neurons), length)
    position = np.arange(matrix.nnz) + (row_start[:-1] - matrix.indptr[:-1])[row]
    column = np.repeat(np.arange(neurons, dtype=np.int32), np.diff(row_start))
    value = np.zeros(column.size)
    column[position] = matrix.indices
    value[position] = matrix.data
    return row_start, column, value


def _tiles(rows: int) -> FloatArray:
    """Zeros of shape ``(rows, 16)``, aligned to a cache line."""
    spare = _ALIGNMENT // 8
    memory = np.zeros(rows * _WIDTH + spare)
    offset = -memory.ctypes.data % _ALIGNMENT // 8
    return memory[offset : offset + rows * _WIDTH].reshape(rows, _WIDTH)


def _fill_tile(tile: FloatArray, states: FloatArray, first: int) -> None:
    """Copy the states of the trajectories from ``first`` on; the lanes left over are zero."""
    part = states[:, first : first + _WIDTH]
    tile[:, : part.shape[1]] = part
    tile[:, part.shape[1] :] = 0.0


def _read_tile(tile: FloatArray, states: FloatArray, first: int) -> None:
    part = states[:, first : first + _WIDTH]
    part[:] = tile[:, : part.shape[1]]
