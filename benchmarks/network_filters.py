"""Ensemble filters over the washout around an echo state network: which, and whether they help.

    python benchmarks/network_filters.py results/paper/Re400 choose
    python benchmarks/network_filters.py results/paper/Re400 test --networks 5 \
        --filters "inflation 1.1"

The state that is filtered is the reservoir's, and an observation is compared with the network's own
next prediction. The model error is either multiplicative (inflation) or additive (normal errors of
each prediction, whose variance makes the innovations on the training series consistent: mean square
innovation = spread of the members + model error + noise). `choose` scores filters on series that
are neither for training nor for the test, `test` the chosen ones on the first test series.
"""

import argparse
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from burstcast.base import random_streams
from burstcast.base.files.netcdf import read_attributes, read_netcdf, read_rows
from burstcast.data.dataset import component_scales, observed_series
from burstcast.data.starting_points import segments, starting_points
from burstcast.forecasters._square_root_filter import assimilate, mean
from burstcast.forecasters.base import ForecasterRecord, ForecastingCase
from burstcast.forecasters.esn import NetworkForecaster
from burstcast.forecasts.windows import WindowSummaries, crosses, summarise, window_boundaries
from burstcast.systems.mfe import MoehlisFaisstEckhardt

SEED, NOISE, TRAINING, STEPS_PER_LT, THRESHOLD = 2022, 0.01, 10, 61, 0.1
WASHOUT, START_UP, VOTERS = 30, 10, 10
FIRST_OTHER_SERIES = 300
BOUNDARIES = window_boundaries(0.5, 11, STEPS_PER_LT)
SYSTEM = MoehlisFaisstEckhardt(400.0)
PREDICTION_TIMES = (1, 2, 3, 4, 5)


@dataclass
class Points:
    """Starting points: observed washouts ``(points, steps, dimension)``, truth, first summaries."""

    washouts: np.ndarray
    true_states: np.ndarray
    truth: WindowSummaries
    largest: np.ndarray
    series: np.ndarray


def make_points(ensemble, scales, first, count):
    """All starting points, 1 LT apart, of some series at which no event is under way."""
    states = read_rows(ensemble, "state", first, first + count)
    observed = observed_series(states, first, NOISE, scales, SEED, "Re400")
    reach = BOUNDARIES[-1]
    points = starting_points(count, states.shape[1], STEPS_PER_LT, WASHOUT, reach)
    washouts = segments(observed, points, WASHOUT - 1, 0)
    largest = SYSTEM.observable(washouts.transpose(2, 0, 1)).max(axis=1)
    quiet = largest < THRESHOLD
    future = segments(states, points, 0, reach)
    truth = summarise(SYSTEM.observable(future[:, 1:].transpose(2, 1, 0)), BOUNDARIES)
    return Points(
        washouts[quiet],
        future[quiet, 0],
        WindowSummaries(truth.first[quiet], truth.largest[quiet]),
        largest[quiet],
        points.series[quiet],
    )


def predict(network, states):
    """The network's next prediction from states ``(neurons, ...)``, ``(dimension, ...)``."""
    weights = network.readout.weights
    flat = weights[:-1].T @ states.reshape(len(states), -1) + weights[-1][:, np.newaxis]
    return flat.reshape(-1, *states.shape[1:])


def feed(network, states, inputs):
    """States after one more input, any number of trailing axes."""
    flat = np.ascontiguousarray(inputs.reshape(1, inputs.shape[0], -1))
    after = network.washout(flat, np.ascontiguousarray(states.reshape(len(states), -1)))
    return after.reshape(states.shape)


def filtered(network, washouts, noise, inflation, model_error, members=20):
    """Memories of all members after the washouts, and what the innovations were.

    Members first follow the observations, with errors as large as the noise, until the reservoir
    has forgotten where it started from; then each prediction is corrected.

    Returns
    -------
    States ``(neurons, members, batch)``, and the mean squares of the innovations, of the members'
    spread with inflation and model error, and of the estimate's distance from the observation, each
    ``(dimension,)``.
    """
    generator = random_streams.stream(SEED, "network_filters")
    washout = washouts.transpose(1, 2, 0)
    batch = washout.shape[2]
    scatter = noise[:, np.newaxis, np.newaxis]
    states = np.zeros((network.dynamics.reservoir.neurons, members, batch))
    squares = []
    for step, observation in enumerate(washout):
        if step < START_UP:
            errors = generator.standard_normal((len(noise), members, batch))
            states = feed(network, states, observation[:, np.newaxis] + scatter * errors)
            continue
        predictions = predict(network, states)
        if model_error.any():
            errors = generator.standard_normal((len(noise), members // 2, batch))
            errors = np.concatenate([errors, -errors], axis=1)  # their mean is exactly zero
            predictions = predictions + model_error[:, np.newaxis, np.newaxis] * errors
        rows = np.concatenate([predictions, states])
        innovation = observation - mean(predictions)
        spread = inflation**2 * predictions.var(axis=1, ddof=1)
        updated = assimilate(rows, observation, noise, inflation)
        inputs, states = updated[: len(noise)], updated[len(noise) :]
        if step >= WASHOUT - 10:
            squares.append([np.square(innovation).mean(1), spread.mean(1)])
        states = feed(network, states, inputs)
    return states, np.mean(squares, axis=0), mean(inputs)


def in_batches(function, washouts, size=16):
    """Concatenated results ``(..., points)`` over batches of points."""
    parts = [function(washouts[at : at + size]) for at in range(0, len(washouts), size)]
    return np.concatenate(parts, axis=-1)


def nudged(network, washouts, share):
    """States after feeding back the prediction and a share of each innovation."""
    washout = washouts.transpose(1, 2, 0)
    states = feed(
        network, np.zeros((network.dynamics.reservoir.neurons, len(washouts))), washout[0]
    )
    for step, observation in enumerate(washout[1:], start=1):
        weight = 1.0 if step < START_UP else share
        predicted = predict(network, states)
        states = feed(network, states, predicted + weight * (observation - predicted))
    return states


def estimated_model_error(network, training, noise):
    """Standard deviation of the additive model error, by consistency of the innovations."""
    points = starting_points(len(training), training.shape[1], 4 * STEPS_PER_LT, WASHOUT, 0)
    washouts = segments(training, points, WASHOUT - 1, 0)
    variance = 0.1 * np.square(noise)
    for _ in range(6):
        _, (innovation, spread), _ = filtered(network, washouts, noise, 1.0, np.sqrt(variance))
        missing = innovation - spread - np.square(noise)
        variance = np.maximum(variance + missing, 1e-4 * np.square(noise))
    return np.sqrt(variance), innovation / (spread + np.square(noise))


def forecast(network, states):
    """Window summaries of closed loops from states ``(neurons, batch)``."""
    parts = []
    for at in range(0, states.shape[1], 500):
        outputs, _ = network.forecast(states[:, at : at + 500], BOUNDARIES[-1])
        parts.append(summarise(SYSTEM.observable(outputs.transpose(1, 0, 2)), BOUNDARIES))
    return WindowSummaries(
        np.concatenate([part.first for part in parts]),
        np.concatenate([part.largest for part in parts]),
    )


def share_of_votes(summaries, time_lt):
    """Share of forecasts of the same points that cross the threshold, ``(points,)``."""
    votes = [crosses(summary, 2 * time_lt - 1, 2, THRESHOLD) for summary in summaries]
    return np.mean(votes, axis=0)


def scores(summaries, points):
    """F-score of the majority and Brier skill of the share of votes, by prediction time."""
    f_scores, skills = [], []
    for time_lt in PREDICTION_TIMES:
        share = share_of_votes(summaries, time_lt)
        happened = crosses(points.truth, 2 * time_lt - 1, 2, THRESHOLD)
        alarm = share >= 0.5
        hits = (alarm & happened).sum()
        f_scores.append(2 * hits / (alarm.sum() + happened.sum()))
        rate = happened.mean()
        skills.append(1 - np.square(share - happened).mean() / (rate * (1 - rate)))
    return f_scores, skills


def report(name, summaries, points, remark=""):
    """Print one row of the table."""
    f_scores, skills = scores(summaries, points)
    row = [f"{value:.3f}".lstrip("0") for value in (*f_scores, *skills)]
    print(f"| {name} | {' | '.join(row)} | {remark} |", flush=True)


def forecasts_with(name, network, points, noise, model_error, number):
    """Forecasts from the mean state, forecasts of the voting members, and a remark."""
    kind, _, value = name.partition(" ")
    if kind == "none":
        return forecast(network, nudged(network, points.washouts, 1.0)), [], ""
    if kind == "share":
        return forecast(network, nudged(network, points.washouts, float(value))), [], ""
    inflation, error = 1.0, np.zeros_like(noise)
    if kind == "inflation":
        inflation = float(value)
    else:
        error = float(value) * model_error
    squares, estimates = [], []

    def voters(washouts):
        states, square, estimate = filtered(network, washouts, noise, inflation, error, number)
        squares.append(square)
        estimates.append(estimate)
        voting = states[:, :: states.shape[1] // VOTERS]
        return np.concatenate([mean(states)[:, np.newaxis], voting], axis=1)

    states = in_batches(voters, points.washouts)
    innovation, spread = np.mean(squares, axis=0)
    consistency = np.mean(innovation / (spread + np.square(noise)))
    miss = (np.concatenate(estimates, axis=1) - points.true_states.T) / noise[:, np.newaxis]
    remark = f"{consistency:.2f}, {np.sqrt(np.square(miss).mean()):.3f}"
    alone = forecast(network, np.ascontiguousarray(states[:, 0]))
    members = [
        forecast(network, np.ascontiguousarray(states[:, 1 + voter])) for voter in range(VOTERS)
    ]
    return alone, members, remark


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("case", type=Path, help="directory of the case, with its ensemble")
    parser.add_argument("stage", choices=["choose", "test"])
    parser.add_argument("--neurons", type=int, default=1000)
    parser.add_argument("--networks", type=int, default=1)
    parser.add_argument("--series", type=int, default=20)
    parser.add_argument("--members", type=int, default=20)
    parser.add_argument(
        "--filters",
        nargs="*",
        default=["share 0.8", "share 0.6", "inflation 1.05", "inflation 1.1", "additive 1"],
    )
    arguments = parser.parse_args()
    ensemble = str(arguments.case / "ensemble.nc")
    training_states = read_rows(ensemble, "state", 0, TRAINING)
    scales = component_scales(training_states)
    noise = NOISE * scales.standard_deviation
    training = observed_series(training_states, 0, NOISE, scales, SEED, "Re400")
    first = TRAINING if arguments.stage == "test" else FIRST_OTHER_SERIES
    points = make_points(ensemble, scales, first, arguments.series)
    print(f"{len(points.series)} starting points of {arguments.series} series from {first}")
    print("| | " + " | ".join(f"F({time})" for time in PREDICTION_TIMES), end=" | ")
    print(" | ".join(f"skill({time})" for time in PREDICTION_TIMES), end=" | remark |\n")
    print("|---" * (2 * len(PREDICTION_TIMES) + 2) + "|")
    alone, voting = {}, {}
    for seed in range(arguments.networks):
        network = f"esn-N{arguments.neurons}-RV-seed{seed}"
        path = arguments.case / "networks" / network / "forecaster.nc"
        record = ForecasterRecord(read_netcdf(path), read_attributes(path))
        case = ForecastingCase(SYSTEM, 0.25, 4, STEPS_PER_LT)
        network = NetworkForecaster(divergence_bound=None).restore(record, case).network
        model_error = None
        if any(name.startswith("additive") for name in arguments.filters):
            model_error, consistency = estimated_model_error(network, training, noise)
            sizes, consistency = np.round(model_error / noise, 2), np.round(consistency, 2)
            print(f"model error of network {seed} / noise {sizes}, consistency {consistency}")
        for name in ["none", *arguments.filters]:
            started = time.process_time()
            mean_forecast, members, remark = forecasts_with(
                name, network, points, noise, model_error, arguments.members
            )
            alone.setdefault(name, []).append(mean_forecast)
            voting.setdefault(name, []).extend(members)
            seconds = time.process_time() - started
            report(f"{seed}: {name}", [mean_forecast], points, f"{remark}; {seconds:.0f} s")
            if members:
                report(f"{seed}: {name}, vote of members", members, points)
    if arguments.networks > 1:
        for name in alone:
            report(f"vote of networks: {name}", alone[name], points)
            if voting[name]:
                report(f"vote of all members of all networks: {name}", voting[name], points)


if __name__ == "__main__":
    main()
