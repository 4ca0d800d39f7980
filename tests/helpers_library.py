"""What tests of the library make up: forecasters, systems, forecasts and their outcomes."""

import io
import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import ClassVar

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst
from PIL import Image

from burstcast.forecasters.base import Forecaster
from burstcast.forecasts.scores import outcomes_by_series
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63

ROOT = Path(__file__).parents[1]


class MadeUpForecaster(Forecaster):
    """Forecaster that is neither fitted nor kept in files: only its forecasts matter."""

    def fit(self, training, case):
        raise NotImplementedError

    def record(self):
        raise NotImplementedError

    def restore(self, record, case):
        raise NotImplementedError


def textbook_step(dynamics, current, state):
    """One step of one trajectory with dense matrices, number by number where neurons leak.

    ``current``: input that is scaled already, ``(dimension,)``.
    """
    reservoir, leak = dynamics.reservoir, dynamics.leak_rate
    input_matrix = np.zeros((reservoir.neurons, reservoir.dimension + 1))
    input_matrix[np.arange(reservoir.neurons), reservoir.input_column] = reservoir.input_weight
    fed = np.append(current, reservoir.input_bias)
    recurrent = dynamics.spectral_radius * reservoir.recurrent.toarray() @ state
    reached = np.tanh(dynamics.input_scaling * input_matrix @ fed + recurrent)
    return np.array([(1 - leak) * x + leak * y for x, y in zip(state, reached, strict=True)])


def lorenz_states(count, seed=3):
    """States of the Lorenz equations at random, ``(3, count)``."""
    return np.random.default_rng(seed).normal(size=(3, count)) + np.array([[1.0], [1.0], [25.0]])


def lorenz_series(count, first, stop):
    """Series of the Lorenz equations from a sample up to another, ``(count, stop - first, 3)``."""
    states = integrate(Lorenz63(), lorenz_states(count), 0.01, 2 * (stop - 1), stride=2)
    return states[first:].transpose(2, 0, 1)


class FirstObserved:
    """The observable is the first component."""

    observable_name: ClassVar[str] = "x"
    observable_symbol: ClassVar[str] = "x"

    def observable(self, state):
        return np.array(state[0])


SERIES = 6


def count_by_series(probability, happened, series, number=SERIES):
    """Outcomes by series, all points scored."""
    return outcomes_by_series(probability, happened, np.ones(len(series), bool), series, number)


@st.composite
def samples(draw, values=None, most=60):
    """Probabilities, outcomes and the series of each forecast."""
    count = draw(st.integers(1, most))
    values = st.floats(0, 1, width=16) if values is None else values
    return (
        draw(npst.arrays(np.float64, count, elements=values)),
        draw(npst.arrays(bool, count)),
        draw(npst.arrays(np.int64, count, elements=st.integers(0, SERIES - 1))),
    )


def informative_sample():
    """A thousand probabilities that are informative and not reliable, of forty series."""
    generator = np.random.default_rng(8)
    probability = np.round(generator.beta(0.4, 1.5, 1000), 2)
    happened = generator.random(1000) < 0.7 * probability + 0.05
    return probability, happened, generator.integers(0, 40, 1000)


def assert_perturbations_grow_as_differences(forecaster, memory):
    """Perturbations that are advanced with a memory, ``(rows, batch)``, by central differences."""
    tangent = np.random.default_rng(2).normal(size=(len(memory), 2, memory.shape[1]))
    there, grown = forecaster.advance_tangent(memory, tangent, 5)
    np.testing.assert_array_equal(there, forecaster.advance(memory, 5)[1])
    for number in range(2):
        ahead, behind = (
            forecaster.advance(memory + sign * 1e-6 * tangent[:, number], 5)[1] for sign in (1, -1)
        )
        np.testing.assert_allclose(grown[:, number], (ahead - behind) / 2e-6, rtol=1e-3, atol=1e-5)


def assert_depends_on_its_washout_alone(forecaster, washout, steps, case):
    """Not on pauses, nor on its batch at any step, nor on having been in a file; the forecast."""
    start = forecaster.start(washout)
    whole, _ = forecaster.advance(start, steps)
    parts, memory = [], start
    for count in (5, 1, steps - 6):
        part, memory = forecaster.advance(memory, count)
        parts.append(part)
    np.testing.assert_array_equal(np.concatenate(parts), whole)
    _, memory = forecaster.advance(start, 4)
    for part in ([3, 1], [0], [4, 3, 2, 1, 0]):
        some, _ = forecaster.advance(np.ascontiguousarray(memory[..., part]), steps - 4)
        np.testing.assert_array_equal(some, whole[4:, :, part])
        alone = forecaster.start(np.ascontiguousarray(washout[..., part]))
        np.testing.assert_array_equal(alone, start[..., part])
    restored = type(forecaster)(**forecaster.options).restore(forecaster.record(), case)
    assert restored.options == forecaster.options
    np.testing.assert_array_equal(restored.advance(restored.start(washout), steps)[0], whole)
    outputs = np.full((1, whole.shape[1], 1), 11.0)
    assert restored.diverged(outputs).tolist() == forecaster.diverged(outputs).tolist()
    return whole


def assert_same_picture(made: bytes, kept):
    """But for edges, which other libraries may draw otherwise; ``kept``: path of a picture."""
    pictures = (Image.open(file).convert("L") for file in (io.BytesIO(made), kept))
    now, then = (np.asarray(picture, dtype=float) for picture in pictures)
    assert now.shape == then.shape
    assert (np.abs(now - then) > 64).mean() < 1e-3


def copied_repository(directory):
    """A copy of all files that git knows, and of new ones; the directory."""
    listed = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
    for name in said_by(listed, ROOT).splitlines():
        if (ROOT / name).exists():
            (directory / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, directory / name)
    return directory


def said_by(arguments, cwd, status=0, **environment):
    """What a command says on both channels."""
    result = subprocess.run(
        list(map(str, arguments)),
        **{"cwd": cwd, "env": {**os.environ, **environment}, "text": True, "check": False},
        **{"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT},
    )
    assert result.returncode == status, result.stdout
    return result.stdout


def code_cells(path):
    """Cells of a notebook that hold code."""
    notebook = json.loads(path.read_text(encoding="utf-8"))
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
