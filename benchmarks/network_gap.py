"""What narrows the gap of one echo state network to the limit: bias, input noise, targets, washout.

    nice python benchmarks/network_gap.py train gap --neurons 500 --sets 0 1 2 3
    python benchmarks/network_gap.py report gap

Networks of Re = 400 (Recycle Validation, the paper's search for every variant separately) learn
from disjoint sets of ten series of one ensemble, whose random seed is not the campaign's; the test
series are common to all. A variant has its own input bias, may replace the targets by smoothed
series, and may bring the inputs nearer to them. Series are smoothed with the equations that are
learnt from them, by an ensemble filter whose estimates are updated by later observations, too.
`train` writes one file a network, and skips those that are there; `report` prints F-scores and
their differences from the paper's choices, paired by networks and test series.
"""

import argparse
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from pathlib import Path

import numpy as np
from scipy.stats import wasserstein_distance

from burstcast.base import random_streams
from burstcast.base.resampling import bootstrap_weights, percentile_interval
from burstcast.data.dataset import (
    component_scales,
    generate_ensemble,
    initial_states,
    observed_series,
)
from burstcast.data.observation_noise import observation_noise
from burstcast.data.starting_points import segments, starting_points
from burstcast.forecasters._square_root_filter import assimilate, mean, symmetric_members
from burstcast.forecasters.base import ForecastingCase
from burstcast.forecasters.quadratic import QuadraticModel
from burstcast.forecasts.windows import crosses, summarise, window_boundaries
from burstcast.networks.dynamics import Dynamics
from burstcast.networks.hyperparameters import SearchSpace
from burstcast.networks.network import EchoStateNetwork
from burstcast.networks.network_search import best, optimiser_seed, search
from burstcast.networks.reservoir import ReservoirSeed
from burstcast.networks.scan import scan
from burstcast.networks.training import TrainingSeries, train
from burstcast.networks.validation import PointValidator
from burstcast.networks.validation_strategies.base import ValidationPlan
from burstcast.networks.validation_strategies.registry import make_strategy
from burstcast.systems.mfe import MoehlisFaisstEckhardt

ROOT, NOISE, STEPS_PER_LT, WASHOUT = 41, 0.01, 61, 30
THRESHOLD, LAMINAR = 0.1, 0.48
GENERATED, SETS, PER_SET, TEST_SERIES = 260, 8, 10, 60
WASHOUTS, RESAMPLES = ("observed", "filtered", "true"), 2000
SYSTEM = MoehlisFaisstEckhardt(400.0)
TIMES = (1, 2, 3, 4)
BOUNDARIES = window_boundaries(0.5, 9, STEPS_PER_LT)
PLAN = ValidationPlan(washout=WASHOUT, interval=2 * STEPS_PER_LT, series=3, intervals=30)
SPACE = SearchSpace((0.1, 1.0), (0.1, 10.0))
TIKHONOV = (1e-6, 1e-9, 1e-12)
CASE = ForecastingCase(SYSTEM, 0.25, 4, STEPS_PER_LT)


@dataclass(frozen=True)
class Variant:
    """A choice for networks: their bias, and what they learn from.

    ``noise`` is the share of the observation noise that inputs keep where targets are smoothed
    series; None: inputs and targets are the observed series.
    """

    bias: float = 0.1
    noise: float | None = None


PAPER = "paper"
VARIANTS = {
    PAPER: Variant(),
    "bias 0.3": Variant(0.3),
    "bias 1": Variant(1.0),
    "bias 3": Variant(3.0),
    "smoothed targets": Variant(noise=1.0),
    "half of the noise": Variant(noise=0.5),
    "smoothed inputs": Variant(noise=0.0),
    "bias 1, smoothed targets": Variant(1.0, 1.0),
    "bias 1, half of the noise": Variant(1.0, 0.5),
    "bias 1, quarter of the noise": Variant(1.0, 0.25),
    "bias 1, smoothed inputs": Variant(1.0, 0.0),
}


@dataclass(frozen=True)
class OtherInputs(Dynamics):
    """A reservoir that is driven in training by other series than its targets.

    ``errors`` are what the inputs have beyond the targets, ``(time, dimension, series)``, in units
    of the range that inputs are divided by.
    """

    errors: np.ndarray | None = None

    def state_panels(self, inputs, states=None, **options):
        """Stream the states that inputs with their errors drive (see `Dynamics`)."""
        return super().state_panels(inputs + self.errors[: len(inputs)], states, **options)


@dataclass(frozen=True)
class Validator(PointValidator):
    """Validates reservoirs that are driven by other series than their targets (`OtherInputs`)."""

    errors: np.ndarray | None = None

    def dynamics(self, point):
        """Reservoir at a point of the search."""
        return OtherInputs(**vars(super().dynamics(point)), errors=self.errors)


def ensemble():
    """Kept series ``(series, time, dimension)``: training sets first, then test series."""
    generator = random_streams.stream(ROOT, "ensemble", "Re400")
    laminar_perturbed = np.array([1, 0, 0.07066, -0.07076, 0, 0, 0, 0, 0])
    batches = generate_ensemble(
        SYSTEM,
        initial_states(laminar_perturbed, 3, 0.01, GENERATED, generator),
        time_step=0.25,
        sampling_stride=4,
        transient_steps=800,
        kept_steps=16000,
        laminarisation_threshold=LAMINAR,
    )
    return np.concatenate([batch.states for batch in batches])


def smoothed_batch(model, observed, noise, lag, members=20):
    """Estimates ``(steps, dimension, batch)`` from the observations up to ``lag`` steps later."""
    steps, dimension, batch = observed.shape
    past = [symmetric_members(observed[0], noise, members)]
    estimates = np.empty_like(observed)
    for step in range(1, steps):
        present = np.ascontiguousarray(past[0]).reshape(dimension, -1)
        outputs, _ = model.advance(present, 1)
        # estimates of past states follow an observation by their covariance with its forecast
        rows = np.concatenate([outputs[0].reshape(dimension, members, batch), *past])
        updated = assimilate(rows, observed[step], noise, 1.0)
        past = np.split(updated, len(rows) // dimension)[: lag + 1]
        estimates[step + 1 - len(past)] = mean(past[-1])
    for age, ensemble in enumerate(past):
        estimates[steps - 1 - age] = mean(ensemble)
    return estimates


def smoothed_series(model, series, noise, lag=20, length=250, before=40):
    """Smoothed ``(series, time, dimension)``, from pieces of ``length`` steps side by side."""
    steps = series.shape[1]
    starts = np.arange(0, steps, length)
    whole = before + length + lag
    firsts = np.clip(starts - before, 0, steps - whole)
    pieces = np.concatenate([series[:, first : first + whole] for first in firsts])
    smoothed = smoothed_batch(model, pieces.transpose(1, 2, 0), noise, lag).transpose(2, 0, 1)
    smooth = np.empty_like(series)
    for piece, start, first in zip(np.split(smoothed, len(starts)), starts, firsts, strict=True):
        stop = min(start + length, steps)
        smooth[:, start:stop] = piece[:, start - first : stop - first]
    return smooth


class TrainingSet:
    """Ten observed series, what is learnt from them, and the common starting points of the test."""

    def __init__(self, states, number):
        """Observe the training series, and the washouts before quiet points of the test series."""
        self.number, start = number, SETS * PER_SET
        self.all_energies = SYSTEM.observable(states.transpose(2, 0, 1)).ravel()
        first = number * PER_SET
        self.true = states[first : first + PER_SET]
        self.scales = component_scales(self.true)
        self.observed = observed_series(self.true, first, NOISE, self.scales, ROOT, "Re400")
        self.noise = observation_noise(self.observed, None)
        test = states[start : start + TEST_SERIES]
        seen = observed_series(test, start, NOISE, self.scales, ROOT, "Re400")
        reach = BOUNDARIES[-1]
        points = starting_points(TEST_SERIES, test.shape[1], STEPS_PER_LT, WASHOUT, reach)
        washouts = segments(seen, points, WASHOUT - 1, 0)
        quiet = SYSTEM.observable(washouts.transpose(2, 0, 1)).max(axis=1) < THRESHOLD
        ahead = segments(test, points, 0, reach)[quiet, 1:]
        truth = summarise(SYSTEM.observable(ahead.transpose(2, 1, 0)), BOUNDARIES)
        self.series = points.series[quiet]
        self.happened = [crosses(truth, 2 * time - 1, 2, THRESHOLD) for time in TIMES]
        self.washouts = {
            "observed": washouts[quiet],
            "true": segments(test, points, WASHOUT - 1, 0)[quiet],
        }

    @cached_property
    def model(self):
        """Quadratic equations learnt from the training series."""
        return QuadraticModel().fit(self.observed, CASE)

    @cached_property
    def smooth(self):
        """Training series smoothed with the learnt equations."""
        return smoothed_series(self.model, self.observed, self.noise)

    def filter_washouts(self):
        """Add washouts smoothed with the learnt equations; the last state is the filter's."""
        parts = np.array_split(self.washouts["observed"].transpose(1, 2, 0), 8, axis=2)
        filtered = [smoothed_batch(self.model, part, self.noise, 12) for part in parts]
        self.washouts["filtered"] = np.concatenate(filtered, axis=2).transpose(2, 0, 1)

    def learnt(self, variant):
        """Targets of a variant, and what its inputs have beyond them in units of the range."""
        training = TrainingSeries(self.observed, self.scales.range)
        if variant.noise is None:
            return training, np.zeros_like(self.observed).transpose(1, 2, 0)
        errors = variant.noise * (self.observed - self.smooth) / self.scales.range
        return TrainingSeries(self.smooth, self.scales.range), errors.transpose(1, 2, 0)


def network(given, variant, neurons):
    """Search and train one network, and tell the chosen evaluation."""
    training, errors = given.learnt(variant)
    seed = ReservoirSeed(ROOT, neurons, given.number, 20.0, variant.bias)
    validator = Validator(
        seed.reservoir(9), training, SYSTEM.observable, PLAN, TIKHONOV, "compiled", errors=errors
    )
    strategy = make_strategy("RV")
    optimiser = optimiser_seed(seed, "Re400", strategy.name)
    scanned = scan(validator, SPACE, [strategy], 4)
    chosen = best(search(validator, SPACE, strategy, scanned, 9, optimiser))
    dynamics = validator.dynamics(chosen.point)
    readout = train(dynamics, training, washout=WASHOUT, tikhonov=chosen.validation.tikhonov)
    return EchoStateNetwork(dynamics, readout, given.scales.range), chosen


@np.errstate(over="ignore", invalid="ignore")
def counts(given, trained, kind):
    """Hits, false alarms and misses, ``(times, 3, test series)``, from a kind of washouts."""
    observable = []
    for part in np.array_split(given.washouts[kind], 8):
        states = trained.washout(np.ascontiguousarray(part.transpose(1, 2, 0)))
        outputs, _ = trained.forecast(states, BOUNDARIES[-1])
        observable.append(SYSTEM.observable(outputs.transpose(1, 0, 2)))
    summaries = summarise(np.concatenate(observable, axis=1), BOUNDARIES)
    rows = []
    for time, happened in zip(TIMES, given.happened, strict=True):
        alarm = crosses(summaries, 2 * time - 1, 2, THRESHOLD)
        outcomes = (alarm & happened, alarm & ~happened, ~alarm & happened)
        rows.append(
            [np.bincount(given.series[points], minlength=TEST_SERIES) for points in outcomes]
        )
    return np.array(rows)


@np.errstate(over="ignore", invalid="ignore")
def long_term(given, trained):
    """Share of discarded closed loops, and of the others share of time in events and distance.

    The loops start in the training series and last as long; the distance of their distribution of
    k from the distribution over all series is Kantorovich's.
    """
    points = starting_points(PER_SET, given.observed.shape[1], 200, WASHOUT, 0)
    washouts = segments(given.observed, points, WASHOUT - 1, 0).transpose(1, 2, 0)
    states = trained.washout(np.ascontiguousarray(washouts))
    outputs, _ = trained.forecast(states, given.observed.shape[1])
    observable = SYSTEM.observable(outputs.transpose(1, 0, 2))
    kept = (observable <= LAMINAR).all(axis=0)
    kept &= np.ptp(observable[-10 * STEPS_PER_LT :], axis=0) >= 0.01
    if not kept.any():
        return np.array([1.0, np.nan, np.nan])
    chaotic = observable[:, kept].ravel()
    distance = wasserstein_distance(chaotic[::5], given.all_energies[::5])
    return np.array([1 - kept.mean(), (chaotic >= THRESHOLD).mean(), distance])


def f_scores(counted, weights):
    """F-scores ``(resamples, networks, times)`` of counts ``(networks, times, 3, series)``."""
    hits, false, missed = np.moveaxis(np.tensordot(weights, counted, axes=(1, 3)), 3, 0)
    return 2 * hits / (2 * hits + false + missed)


def train_all(arguments):
    """Train and test networks that are missing."""
    states = ensemble()
    for number in arguments.sets:
        given = TrainingSet(states, number)
        if "filtered" in arguments.washouts:
            given.filter_washouts()
        for name in arguments.variants:
            path = arguments.folder / f"{name}-N{arguments.neurons}-set{number}.npz"
            if path.exists():
                continue
            trained, chosen = network(given, VARIANTS[name], arguments.neurons)
            counted = {kind: counts(given, trained, kind) for kind in arguments.washouts}
            np.savez(path, **counted, long_term=long_term(given, trained))
            print(f"{path.stem}: {trained!r}, objective {chosen.objective:.3f}", flush=True)


def paired(folder, neurons, names, kind):
    """Counts of networks that all the variants have, ``(variants, networks, times, 3, series)``."""
    counted = []
    for number in range(SETS):
        paths = [folder / f"{name}-N{neurons}-set{number}.npz" for name in names]
        files = [np.load(path) for path in paths if path.exists()]
        if len(files) == len(names) and all(kind in file for file in files):
            counted.append([file[kind] for file in files])
    return np.array(counted).swapaxes(0, 1) if counted else None


def report(arguments):
    """Print a table of F-scores, and of their differences from a variant by the same networks."""
    generator = random_streams.stream(ROOT, "bootstrap")
    print("| neurons | variant | washouts | networks | F(2) | F(3) | gain(2) | gain(3) |")
    print("|---" * 8 + "|")
    sizes = {int(path.stem.split("-N")[1].split("-")[0]) for path in arguments.folder.glob("*.npz")}
    for neurons, variant, kind in product(sorted(sizes), VARIANTS, WASHOUTS):
        both = paired(arguments.folder, neurons, [variant, arguments.reference], kind)
        if both is None:
            continue
        networks = both.shape[1]
        of_all, of_reference = (
            f_scores(counts, np.ones((1, TEST_SERIES)))[0].mean(axis=0) for counts in both
        )
        # networks, each with its training set, and test series are both drawn
        by_series = bootstrap_weights(TEST_SERIES, RESAMPLES, generator)
        by_network = bootstrap_weights(networks, RESAMPLES, generator) / networks
        gains = f_scores(both[0], by_series) - f_scores(both[1], by_series)
        samples = np.einsum("rn,rnt->rt", by_network, gains)
        cells = [f"{of_all[column]:.3f}" for column in (1, 2)]
        for column in (1, 2):
            low, high = percentile_interval(samples[:, column], 0.95)
            gain = of_all[column] - of_reference[column]
            cells.append(f"{gain:.3f} ({low:.3f} to {high:.3f})")
        cells = [cell.replace("0.", ".") for cell in cells]
        print(f"| {' | '.join([str(neurons), variant, kind, str(networks), *cells])} |")
    print("\nLong closed loops: share discarded, share of time in events, distance from the data")
    for path in sorted(arguments.folder.glob("*.npz")):
        print(path.stem, np.round(np.load(path).get("long_term", np.full(3, np.nan)), 4))


def main():
    """Train networks, or print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("stage", choices=["train", "report"])
    parser.add_argument("folder", type=Path, help="of the files, one for each network")
    parser.add_argument("--neurons", type=int, default=500)
    parser.add_argument("--sets", type=int, nargs="*", default=list(range(4)))
    parser.add_argument("--variants", nargs="*", default=list(VARIANTS), choices=list(VARIANTS))
    parser.add_argument("--washouts", nargs="*", default=WASHOUTS)
    parser.add_argument("--reference", default=PAPER, choices=list(VARIANTS))
    arguments = parser.parse_args()
    arguments.folder.mkdir(exist_ok=True, parents=True)
    {"train": train_all, "report": report}[arguments.stage](arguments)


if __name__ == "__main__":
    main()
