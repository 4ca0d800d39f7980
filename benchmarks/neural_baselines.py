"""A gated recurrent network, and reservoirs beside a wrong model, for the shear flow, as a table.

    pip install -r examples/neural/requirements.lock
    python benchmarks/neural_baselines.py [--rows ROW ...] [--csv FILE]

The shear flow at Re = 400: training sets, test series and starting points of smoothing.py, whose
table has echo state networks of the same series. Rows: the equations with a box 5 % too long, with
a filter whose inflation is 1 or chosen in training; hybrid networks of this model, from the last
sample and with a filter (examples/neural/hybrid_network.py); and the gated network of
examples/neural/gated_network.py. Its size and loss are those of `CANDIDATES` with the best closed
loops of two training series that are held out, after a short training each; no test series is
looked at. `search_seconds` is the processor time of that search, `seconds` that of the fit. Columns
as in shear_flow_starts.py. Rows that the file has are not made again.
"""

import argparse
import sys
import time
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
from shear_flow_starts import BOUNDARIES, SYSTEM, TIMES, WASHOUT, Starts, true_series, with_noise
from smoothing import CASE, IN_SET, SETS

from burstcast.base.threads import single_threaded
from burstcast.forecasts.windows import window_forecasts

EXAMPLES = Path(__file__).parents[1] / "examples"
sys.path += [str(EXAMPLES / name) for name in ("neural", "wrong_model")]
from another_box import EquationsOfAnotherBox, FilteredEquationsOfAnotherBox  # noqa: E402

from gated_network import GatedNetwork  # noqa: E402
from hybrid_network import FilteredHybridNetwork, HybridNetwork  # noqa: E402

FACTOR = 1.05
CANDIDATES = [*product((50, 100), (0.0, 1e-3))]
"""Neurons and bound of the loss of gated networks."""
SHORT = {"updates": (400, 200, 300), "closed": (0, 10, 30), "rates": (3e-3, 2e-3, 1e-3)}
MODELS = {
    "wrong model": lambda: EquationsOfAnotherBox(factor=FACTOR),
    "wrong model, filter": lambda: FilteredEquationsOfAnotherBox(factor=FACTOR, inflation=1.0),
    "wrong model, filter, inflation chosen": lambda: FilteredEquationsOfAnotherBox(factor=FACTOR),
    "hybrid": lambda: HybridNetwork(factor=FACTOR),
    "hybrid, filter": lambda: FilteredHybridNetwork(factor=FACTOR, members=24),
}
GATED = "gated network"
ROWS = [
    *((name, 0) for name in MODELS),
    (GATED, 0),
    *product(("hybrid", "hybrid, filter"), range(1, SETS)),
]
"""Name and training set."""


def gated(training):
    """Gated network with the settings that the held-out training series choose; seconds of that."""
    began = time.process_time()
    errors = {}
    for neurons, robust in CANDIDATES:
        short = GatedNetwork(neurons=neurons, robust=robust, **SHORT).fit(training, CASE)
        errors[neurons, robust] = short.held_out_error
        print(f"{neurons} neurons, {robust:g}: {short.held_out_error:.3f}", flush=True)
    neurons, robust = min(errors, key=errors.__getitem__)
    return GatedNetwork(neurons=neurons, robust=robust), time.process_time() - began


def main():
    """Add the rows that are missing."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rows", nargs="*", type=int, default=[*range(len(ROWS))])
    parser.add_argument("--csv", type=Path, default=Path(__file__).with_suffix(".csv"))
    parser.add_argument("--tests", type=int, default=60, help="test series")
    arguments = parser.parse_args()
    states = true_series(130)[: SETS * IN_SET + arguments.tests]
    energy, first = SYSTEM.observable(states.transpose(2, 0, 1)), SETS * IN_SET
    observed = with_noise(states, slice(first))
    starts = Starts(energy[first:], SYSTEM.observable(observed[first:].transpose(2, 0, 1)))
    washouts = starts.washouts(observed[first:], WASHOUT)
    for name, number in (ROWS[row] for row in arguments.rows):
        table = pd.read_csv(arguments.csv) if arguments.csv.exists() else pd.DataFrame()
        if len(table) and ((table["model"] == name) & (table["set"] == number)).any():
            continue
        training = observed[number * IN_SET : (number + 1) * IN_SET]
        searched = ""
        with single_threaded():
            if name == GATED:
                model, searched = gated(training)
            else:
                model = MODELS[name]()
            began = time.process_time()
            model = model.fit(training, CASE)
            fitted = time.process_time()
            forecasts = window_forecasts(model, SYSTEM.observable, washouts, BOUNDARIES)
            forecast = time.process_time()
        scores = starts.scores(forecasts)
        neurons = getattr(model, "neurons", "")
        factor = getattr(model, "chosen_inflation", None)
        row = {"model": name, "neurons": neurons, "set": number}
        row |= {f"f_{at}": scores[f"f_{at}"] for at in TIMES}
        row |= {key: scores[key] for key in ("f_3_low", "f_3_high")}
        row |= {f"brier_{at}": scores[f"brier_{at}"] for at in TIMES}
        row |= {
            "inflation": "" if factor is None else factor,
            "robust": getattr(model, "robust", ""),
            "held_out_error": getattr(model, "held_out_error", ""),
            "search_seconds": searched,
            "seconds": fitted - began,
            "forecast_ms": 1e3 * (forecast - fitted) / len(washouts),
        }
        table = pd.concat([table, pd.DataFrame([row])])
        table.to_csv(arguments.csv, index=False, float_format="%.4g")
        print(f"{name}, {number}: {np.round([row[f'f_{at}'] for at in TIMES], 3)}", flush=True)


if __name__ == "__main__":
    main()
