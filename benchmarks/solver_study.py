"""Which solver for the ridge regression at beta = 1e-12? Five of them against QR of the states.

    python benchmarks/solver_study.py results/paper/Re400/ensemble.nc --neurons 1000 --networks 10

For each network: which factorisations fail, how far the weights are from the solution by QR of
[R; sqrt(beta) I], and the objective of the Recycle Validation that they lead to. Results are in
benchmarks/measured.md.
"""

import argparse

import numpy as np
import scipy.linalg

from burstcast.base import random_streams
from burstcast.base.files.netcdf import read_rows
from burstcast.data.dataset import component_scales, observed_series
from burstcast.networks.dynamics import Dynamics
from burstcast.networks.readout import MomentsAccumulator, solve_ridge
from burstcast.networks.reservoir import make_reservoir

WASHOUT, INTERVAL, SERIES, INTERVALS = 30, 122, 3, 30


def states_and_targets(dynamics, observed, input_range):
    """All states after the washout with their bias, ``(rows, neurons + 1)``, and their targets."""
    inputs = np.ascontiguousarray(observed[:, :-1].transpose(1, 2, 0)) / input_range[:, np.newaxis]
    panels, targets = [], []
    for panel in dynamics.state_panels(inputs, breakpoints=[WASHOUT - 1]):
        if panel.start >= WASHOUT - 1:
            panels.append(panel.columns)
            wanted = observed[:, panel.start + 1 : panel.stop + 1]
            targets.append(wanted.transpose(2, 1, 0).reshape(observed.shape[2], -1))
    states = np.concatenate(panels, axis=1)
    return states, np.concatenate(targets, axis=1)


def solve_all(states, targets, beta):
    """Weights by each solver, None where it fails."""
    rows = np.vstack([states, np.ones(states.shape[1])])
    gram = rows @ rows.T
    cross = rows @ targets.T
    matrix = gram + beta * np.eye(len(gram))
    augmented = np.vstack([rows.T, np.sqrt(beta) * np.eye(len(gram))])
    right = np.vstack([targets.T, np.zeros((len(gram), len(targets)))])
    q_right, factor = scipy.linalg.qr_multiply(augmented, right.T, mode="right")
    solutions = {"QR": scipy.linalg.solve_triangular(factor, q_right.T)}
    solutions["LU"] = scipy.linalg.solve(matrix, cross)
    try:
        solutions["Cholesky"] = scipy.linalg.cho_solve(scipy.linalg.cho_factor(matrix), cross)
    except np.linalg.LinAlgError:
        solutions["Cholesky"] = None
    values, vectors = scipy.linalg.eigh(gram)
    solutions["eigh"] = vectors @ ((vectors.T @ cross) / (np.maximum(values, 0) + beta)[:, None])
    accumulator = MomentsAccumulator(len(states), len(targets))
    for start in range(0, states.shape[1], 1000):
        part = slice(start, start + 1000)
        accumulator.add(np.ascontiguousarray(states[:, part]), targets[:, part])
    readout = solve_ridge(accumulator.moments(), beta)
    solutions["centred moments"] = readout.weights
    return solutions, readout.solver


def objective(dynamics, weights, states, observed, input_range):
    """Recycle Validation's objective (states are in the order step, then series)."""
    series = len(observed)
    errors = []
    starts = [WASHOUT + index * INTERVAL for index in range(INTERVALS)]
    columns = [(start - WASHOUT) * series + row for start in starts for row in range(SERIES)]
    outputs, _ = dynamics.closed_loop(
        weights, input_range, np.ascontiguousarray(states[:, columns]), INTERVAL
    )
    energy = 0.5 * (outputs**2).sum(axis=1)
    for column, (start, row) in enumerate((s, r) for s in starts for r in range(SERIES)):
        truth = 0.5 * (observed[row, start : start + INTERVAL] ** 2).sum(axis=1)
        errors.append(np.log10(np.mean((energy[:, column] - truth) ** 2)))
    return np.mean(errors)


def main():
    """Print one row for each network and solver, and a summary."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("ensemble")
    parser.add_argument("--neurons", type=int, default=1000)
    parser.add_argument("--networks", type=int, default=10)
    parser.add_argument("--spectral-radius", type=float, default=0.3)
    parser.add_argument("--input-scaling", type=float, default=0.4)
    parser.add_argument("--tikhonov", type=float, default=1e-12)
    arguments = parser.parse_args()
    states = read_rows(arguments.ensemble, "state", 0, 10)
    scales = component_scales(states)
    observed = observed_series(states, 0, 0.01, scales, 2022, "Re400")
    summary = {}
    for seed in range(arguments.networks):
        generator = random_streams.stream(2022, "reservoir", arguments.neurons, seed)
        reservoir = make_reservoir(arguments.neurons, observed.shape[2], 20, 0.1, generator)
        dynamics = Dynamics(reservoir, arguments.spectral_radius, arguments.input_scaling)
        driven, targets = states_and_targets(dynamics, observed, scales.range)
        solutions, used = solve_all(driven, targets, arguments.tikhonov)
        reference = solutions["QR"]
        for name, weights in solutions.items():
            record = summary.setdefault(name, {"failures": 0, "error": [], "objective": []})
            if weights is None:
                record["failures"] += 1
                continue
            error = np.linalg.norm(weights - reference) / np.linalg.norm(reference)
            record["error"].append(error)
            record["objective"].append(objective(dynamics, weights, driven, observed, scales.range))
        print(f"network {seed}: centred moments solved by {used}", flush=True)
    print(f"| solver ({arguments.neurons} neurons) | failures | weight error | objective |")
    print("|---|---|---|---|")
    for name, record in summary.items():
        print(
            f"| {name} | {record['failures']} | {np.median(record['error']):.2g} "
            f"| {np.median(record['objective']):.3f} |"
        )


if __name__ == "__main__":
    main()
