"""Dynamics of the reservoir in machine code: the fast implementation.

A batch is cut into tiles of 16 trajectories, or one narrower tile. A tile's state is held as
``(neurons, 16)``: an entry of the recurrent matrix multiplies 16 neighbouring numbers, and all that
happens to a neuron happens while it is in the registers or the nearest cache. This is several times
faster than `burstcast.networks.backend_scipy`. The arithmetic is spelt out in vectors with explicit
fused multiply-adds (`burstcast.base.compiled.machine_code`): a trajectory goes through the same
operations in the same order wherever it stands in a batch, on any processor: the same bits.
"""

from collections.abc import Callable, Sequence
from functools import cache, cached_property, partial

import numpy as np
import scipy

from burstcast.base.arrays import FloatArray, Int32Array
from burstcast.base.compiled.machine_code import ALIGNMENT, Lanes, compiled
from burstcast.networks.backend import Backend

# Trajectories in a tile, for batches up to this size, or of any. Eight leave the processor waiting
# for results, 32 do not fit its registers.
_WIDTHS = (4, 8, 16)
# Neurons whose states are fed to the readout together, while they are in the nearest cache.
_READOUT_BLOCK = 32

# Arguments of the compiled functions: the reservoir's matrices with the leak rate and its negative,
# and room for a tile.
_MATRICES = ("row_start", "column", "value", "input_column", "input_weight", "leak")
_ROOM = ("fed", "old", "new")


# --- The step ------------------------------------------------------------------------------------


def _tanh(code: Lanes, x: str) -> str:
    """Hyperbolic tangent, off by at most seven units in the last place (0.6 in the mean).

    The Pade approximant [9/10] of tanh(x / 4) = p / q, and twice (p, q) <- (2 p q, p^2 + q^2): one
    division and no table. Beyond 20, tanh is one to the last place.
    """
    y = code.multiply(code.clamp(x, 20.0), code.fill(0.25))
    s = code.multiply(y, y)
    p = code.fill(55.0)
    for coefficient in (25740.0, 2837835.0, 91891800.0, 654729075.0):
        p = code.fused(p, s, code.fill(coefficient))
    p = code.multiply(p, y)
    q = code.add(s, code.fill(1485.0))
    for coefficient in (315315.0, 18918900.0, 310134825.0, 654729075.0):
        q = code.fused(q, s, code.fill(coefficient))
    for _ in range(2):
        p, q = code.multiply(code.add(p, p), q), code.fused(p, p, code.multiply(q, q))
    return code.divide(p, q)


def _advance(code: Lanes, leaking: bool, old: str, new: str, first: str, last: str) -> None:
    """Compute the new states of the neurons ``first`` to ``last - 1`` of a tile.

    Rows have an even number of entries, summed in two chains. A leak goes to x + a (tanh - x).
    """

    def neuron(i: str) -> None:
        fed = code.load("%fed", code.integer_at("%input_column", i))
        driven = code.multiply(code.fill_from("%input_weight", i), fed)

        def entries(k: str, even: str, odd: str) -> list[str]:
            following = code.plus(k, 1)
            x = code.load(old, code.integer_at("%column", k))
            y = code.load(old, code.integer_at("%column", following))
            return [
                code.fused(code.fill_from("%value", k), x, even),
                code.fused(code.fill_from("%value", following), y, odd),
            ]

        start = code.integer_at("%row_start", i)
        stop = code.integer_at("%row_start", code.plus(i, 1))
        even, odd = code.loop(start, stop, entries, [driven, code.fill(0.0)], step=2)
        reached = _tanh(code, code.add(even, odd))
        if leaking:
            x = code.load(old, i)
            rest = code.fused(code.fill_from("%leak", "1"), x, x)
            reached = code.fused(code.fill_from("%leak", "0"), reached, rest)
        code.store(new, i, reached)

    code.loop(first, last, neuron)


def _read_out(code: Lanes, squares: bool, states: str, first: str, last: str) -> None:
    """Add the share of the neurons ``first`` to ``last - 1`` to the outputs of a tile.

    ``weights`` is ``(neurons, rows)``, with an even number of rows. With squares, ``first`` is
    even.
    """

    def pair(row: str) -> None:
        other = code.plus(row, 1)

        def neuron(i: str, even: str, odd: str, squared: bool = False) -> list[str]:
            state = code.load(states, i)
            if squared:
                state = code.multiply(state, state)
            entry = code.plus(code.times(i, "%rows"), row)
            return [
                code.fused(code.fill_from("%weights", entry), state, even),
                code.fused(code.fill_from("%weights", code.plus(entry, 1)), state, odd),
            ]

        so_far = [code.load("%read", row), code.load("%read", other)]
        if squares:
            so_far = code.loop(first, last, neuron, so_far, step=2)
            second = code.plus(first, 1)
            even, odd = code.loop(second, last, partial(neuron, squared=True), so_far, step=2)
        else:
            even, odd = code.loop(first, last, neuron, so_far)
        code.store("%read", row, even)
        code.store("%read", other, odd)

    code.loop("0", "%rows", pair, step=2)


# --- The loops -----------------------------------------------------------------------------------


def _drive(width: int, leaking: bool) -> Lanes:
    """Drive a tile of trajectories by data.

    ``inputs`` and ``record`` point to the first trajectory in ``(steps, dimension, batch)`` and
    ``(neurons, steps, batch)``; ``old`` holds the states; ``fed``, ``(dimension + 1, width)``, the
    bias in its last row. The final states are in ``new`` after an odd number of steps, in ``old``
    after an even one. ``bytes`` is the number of bytes of the tile's trajectories.
    """
    code = Lanes(
        width,
        "drive",
        [*_MATRICES, *_ROOM, "inputs", "record"],
        ["neurons", "dimension", "steps", "batch", "bytes", "recording"],
    )

    def step(t: str, old: str, new: str) -> list[str]:
        def component(d: str) -> None:
            row = code.times(code.plus(code.times(t, "%dimension"), d), "%batch")
            code.copy(code.vector_at("%fed", d), code.number_at("%inputs", row), "%bytes")

        def keep(i: str) -> None:
            row = code.times(code.plus(code.times(i, "%steps"), t), "%batch")
            code.copy(code.number_at("%record", row), code.vector_at(new, i), "%bytes")

        code.loop("0", "%dimension", component)
        _advance(code, leaking, old, new, "0", "%neurons")
        code.loop("0", code.times("%neurons", "%recording"), keep)
        return [new, old]

    code.loop("0", "%steps", step, ["%old", "%new"], kind="ptr")
    return code


def _forecast(width: int, leaking: bool, squares: bool) -> Lanes:
    """Forecast a tile of trajectories; arguments as of `_drive`.

    ``outputs`` points to the first trajectory in ``(steps, dimension, batch)``; ``read`` is room
    for the outputs of the tile, with as many rows as ``output_bias`` and ``weights`` (an even
    number).
    """
    code = Lanes(
        width,
        "forecast",
        [*_MATRICES, *_ROOM, "weights", "output_bias", "input_range", "read", "outputs"],
        ["neurons", "dimension", "steps", "batch", "bytes", "rows"],
    )

    def bias(row: str) -> None:
        code.store("%read", row, code.fill_from("%output_bias", row))

    def last_of(first: str) -> str:
        return code.smaller(code.plus(first, _READOUT_BLOCK), "%neurons")

    def step(t: str, old: str, new: str) -> list[str]:
        def component(d: str) -> None:
            predicted = code.load("%read", d)
            code.store("%fed", d, code.divide(predicted, code.fill_from("%input_range", d)))
            row = code.times(code.plus(code.times(t, "%dimension"), d), "%batch")
            code.copy(code.number_at("%outputs", row), code.vector_at("%read", d), "%bytes")

        def block(first: str) -> None:
            last = last_of(first)
            _advance(code, leaking, old, new, first, last)
            _read_out(code, squares, new, first, last)

        code.loop("0", "%dimension", component)
        code.loop("0", "%rows", bias)
        code.loop("0", "%neurons", block, step=_READOUT_BLOCK)
        return [new, old]

    code.loop("0", "%rows", bias)
    code.loop(
        "0",
        "%neurons",
        lambda first: _read_out(code, squares, "%old", first, last_of(first)),
        step=_READOUT_BLOCK,
    )
    code.loop("0", "%steps", step, ["%old", "%new"], kind="ptr")
    return code


@cache
def _function(make: Callable[..., Lanes], *options: int) -> Callable[..., None]:
    try:
        return compiled(make(*options))
    except Exception as error:
        raise RuntimeError(
            f"the compiled backend does not run ({type(error).__name__}: {error}); repair the "
            'installation of llvmlite, or take the backend "scipy", which is several times slower'
        ) from error


# --- The interface -------------------------------------------------------------------------------


class CompiledBackend(Backend):
    """Open and closed loop in machine code."""

    def open_loop(
        self, inputs: FloatArray, states: FloatArray, record: FloatArray | None
    ) -> FloatArray:
        """Drive the states by data (see `Backend.open_loop`); ``record`` is C-contiguous."""
        inputs = np.ascontiguousarray(inputs)
        drive = _function(_drive, _width(inputs.shape[2]), self.leak_rate != 1)
        moving = (inputs.ctypes.data, 0 if record is None else record.ctypes.data)
        return self._run(drive, states, inputs.shape, (), moving, record is not None)

    def closed_loop(
        self, weights: FloatArray, input_range: FloatArray, states: FloatArray, steps: int
    ) -> tuple[FloatArray, FloatArray]:
        """Let the network drive itself (see `Backend.closed_loop`)."""
        dimension, width = weights.shape[1], _width(states.shape[1])
        # Rows come in pairs: an odd number is filled up by a row of zeros.
        padded = np.zeros((len(weights), dimension + dimension % 2))
        padded[:, :dimension] = weights
        input_range = np.ascontiguousarray(input_range, dtype=np.float64)
        squares = self.readout == "quadratic"
        forecast = _function(_forecast, width, self.leak_rate != 1, squares)
        outputs = np.empty((steps, dimension, states.shape[1]))
        fixed = (padded, padded[-1], input_range, _tile(padded.shape[1], width))
        moving = (outputs.ctypes.data,)
        final = self._run(forecast, states, outputs.shape, fixed, moving, padded.shape[1])
        return outputs, final

    def _run(
        self,
        function: Callable[..., None],
        states: FloatArray,
        shape: tuple[int, ...],
        fixed: Sequence[FloatArray],
        moving: Sequence[int],
        last: int,
    ) -> FloatArray:
        """Advance the states of a batch tile by tile; returns the final ones.

        ``shape``: Steps, dimension and batch. ``fixed``, ``moving``, ``last``: Further arguments of
        the function: arrays common to all tiles, addresses of the first trajectory, an integer.
        """
        steps, dimension, batch = shape
        neurons, width = len(states), _width(batch)
        fed, old, new = (_tile(rows, width) for rows in (dimension + 1, neurons, neurons))
        fed[dimension] = self.input_bias
        addresses = [array.ctypes.data for array in (*self._matrices, fed, old, new, *fixed)]
        final = np.empty_like(states)
        for first in range(0, batch, width):
            part = states[:, first : first + width]
            count = part.shape[1]
            old[:, :count] = part
            old[:, count:] = 0.0
            starts = [address + 8 * first for address in moving]
            function(*addresses, *starts, neurons, dimension, steps, batch, 8 * count, last)
            reached = new if steps % 2 else old
            final[:, first : first + width] = reached[:, :count]
        return final

    @cached_property
    def _matrices(self) -> tuple[FloatArray | Int32Array, ...]:
        """Arrays of the arguments `_MATRICES`."""
        return (
            *_even_rows(self.recurrent),
            np.ascontiguousarray(self.input_column, dtype=np.int32),
            np.ascontiguousarray(self.input_weight, dtype=np.float64),
            np.array([self.leak_rate, -self.leak_rate]),
        )


def _even_rows(matrix: "scipy.sparse.csr_array") -> tuple[Int32Array, Int32Array, FloatArray]:
    """Row starts, columns and values, with a zero more on the diagonal in rows of odd length."""
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


def _width(batch: int) -> int:
    return next((width for width in _WIDTHS if batch <= width), _WIDTHS[-1])


def _tile(rows: int, width: int) -> FloatArray:
    """Zeros of shape ``(rows, width)``, aligned to a cache line."""
    spare = ALIGNMENT // 8
    memory = np.zeros(rows * width + spare)
    offset = -memory.ctypes.data % ALIGNMENT // 8
    return memory[offset : offset + rows * width].reshape(rows, width)
