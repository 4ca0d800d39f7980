"""What a stream costs: each sample, each probability, and states that would advance with samples.

::

    python benchmarks/stream.py [--neurons 1000] [--members 10]

Milliseconds of one core, the least of several repetitions. A probability costs the washout and the
forecasts of all members. States that advanced with each sample would have to be as many as the
washout has samples, since each washout begins from zero: the last line is what that would cost for
each sample, asked for a probability or not.
"""

import argparse
import time
from collections.abc import Callable

import numpy as np

from burstcast.event_forecaster.forecaster import EventForecaster
from burstcast.forecasters.esn import NetworkForecaster
from burstcast.systems.integration import integrate
from burstcast.systems.mfe import MoehlisFaisstEckhardt


def least(function: Callable[[], object], repetitions: int = 10) -> float:
    """Milliseconds of the fastest call."""
    seconds = []
    for _ in range(repetitions):
        start = time.perf_counter()
        function()
        seconds.append(time.perf_counter() - start)
    return 1e3 * min(seconds)


def main() -> None:
    """Fit networks to series of the shear flow, and watch another one."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--neurons", type=int, default=1000)
    parser.add_argument("--members", type=int, default=10)
    chosen = parser.parse_args()
    flow, lyapunov_time = MoehlisFaisstEckhardt(400.0), 1 / 0.0163
    start = np.array([1, 0, 0.07066, -0.07076, 0, 0, 0, 0, 0])[:, np.newaxis]
    start = start + 0.01 * np.random.default_rng(0).random((9, 4))
    *training, series = integrate(flow, start, 0.25, 6000, stride=4)[200:].transpose(2, 0, 1)
    forecaster = EventForecaster(
        flow,
        0.1,
        prediction_times=(1.0, 3.0),
        lyapunov_time=lyapunov_time,
        sampling_interval=1.0,
        washout=0.5,
        neurons=chosen.neurons,
        members=chosen.members,
        grid=2,
        bayesian_points=1,
        calibrate=False,
    ).fit(np.stack(training)[:, :1000])
    for sample in series[:200]:
        forecaster.update(sample)
    washout = int(lyapunov_time / 2)
    batch = series[np.newaxis, 200 - washout : 200]
    for lead in (1.0, 3.0):
        assert forecaster.probability(lead) == forecaster.predict_proba(batch, lead)[0, 1]
    samples = iter(np.tile(series, (3, 1)))
    inputs = np.ascontiguousarray(batch.transpose(1, 2, 0))
    members = forecaster.members_
    networks = [member.network for member in members if isinstance(member, NetworkForecaster)]
    memories = [member.start(inputs) for member in members]
    several = np.ascontiguousarray(np.repeat(inputs[-1:], washout, axis=2))
    states = [np.repeat(memory, washout, axis=1) for memory in memories]
    print(f"{chosen.members} networks of {chosen.neurons} neurons, a washout of {washout} samples")
    rows = {
        "update, one sample": lambda: forecaster.update(next(samples)),
        "probability at 1 LT": lambda: forecaster.probability(1.0),
        "probability at 3 LT": lambda: forecaster.probability(3.0),
        "  of this: the washout": lambda: [member.start(inputs) for member in members],
        "states of all washouts, one sample": lambda: [
            network.dynamics.open_loop(several / network.input_range[:, np.newaxis], state)
            for network, state in zip(networks, states, strict=True)
        ],
    }
    for name, function in rows.items():
        print(f"{name:36}{least(function, 50 if 'update' in name else 10):9.4f} ms")


if __name__ == "__main__":
    main()
