"""A bank of systems of many shapes, each forecast by every kind with its defaults.

::

    python benchmarks/bank.py [--systems NAME ...] [--kinds KIND ...] [--points 20]

For each system: 10 training and 8 test series of 800 samples, 20 in a dominant period, with 1 %
noise; maps have a period of one sample. An event is a rise of one component to its 0.95 quantile in
a window of half a period, one period ahead (of a map: the next sample but one). A row has the Brier
skill of each kind against the base rate. A kind fails silently where it has a skill below 0.05,
another kind has one above 0.3, and none of its warnings says why.
"""

import argparse
import math
import time
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from burstcast import EventForecaster
from burstcast.base.arrays import FloatArray
from burstcast.base.threads import single_threaded

KINDS = (
    *("quadratic", "quadratic_filtered", "nvar", "linear_inverse", "analogues"),
    *("precursor", "esn"),
)
NETWORKS = {"neurons": 100, "members": 2, "searches": 1, "grid": 3, "bayesian_points": 3}
TRAINING, TESTS, SAMPLES, NOISE = 10, 8, 800, 0.01
NO_SKILL, SKILL = 0.05, 0.3
CAUSES = ("likely cause", "no cause is seen")

Rate = Callable[[FloatArray, float], Sequence[FloatArray]]


@dataclass(frozen=True)
class Bank:
    """A system of the bank."""

    source: str
    rate: Rate  #: right-hand side of states ``(dimension, series)`` and time; of a map: next state
    start: tuple[float, ...]  #: a state in its basin of attraction
    event: int  #: component that has the events
    period: float = 1.0  #: mean time between rises of the event's component to its mean; 1: a map
    step: float = 0.01  #: largest one of the integration; 0: a map
    spread: float = 0.05  #: of initial states about `start`
    shown: Callable[[FloatArray, float], FloatArray] | None = None  #: what is observed; None: all


def _duffing(s: FloatArray, t: float) -> list[FloatArray]:
    x, v = s
    return [v, -0.05 * v - x**3 + 7.5 * np.cos(t)]


def _forced(frequency: float) -> Callable[[FloatArray, float], FloatArray]:
    """States, and the phase of what they are forced by."""

    def shown(s: FloatArray, t: float) -> FloatArray:
        ones = np.ones_like(s[:1])
        return np.concatenate([s, np.cos(frequency * t) * ones, np.sin(frequency * t) * ones])

    return shown


def _chua(s: FloatArray, t: float) -> list[FloatArray]:
    x, y, z = s
    slope = -0.714 * x + 0.5 * (-1.143 + 0.714) * (np.abs(x + 1) - np.abs(x - 1))
    return [15.6 * (y - x - slope), x - y + z, -28.0 * y]


def _food_chain(s: FloatArray, t: float) -> list[FloatArray]:
    x, y, z = s
    first, second = 5.0 * x / (1 + 3.0 * x) * y, 0.1 * y / (1 + 2.0 * y) * z
    return [x * (1 - x) - first, first - second - 0.4 * y, second - 0.01 * z]


def _lattice(s: FloatArray, t: float) -> FloatArray:
    mapped = 1 - 1.75 * s**2
    return 0.9 * mapped + 0.05 * (np.roll(mapped, 1, axis=0) + np.roll(mapped, -1, axis=0))


def _ikeda(s: FloatArray, t: float) -> list[FloatArray]:
    x, y = s
    angle = 0.4 - 6.0 / (1 + x**2 + y**2)
    return [
        1 + 0.9 * (x * np.cos(angle) - y * np.sin(angle)),
        0.9 * (x * np.sin(angle) + y * np.cos(angle)),
    ]


_DELAY = 20
"""Steps of the Mackey-Glass equation in its delay of 17: its history is its state."""


def _mackey_glass(s: FloatArray, t: float) -> FloatArray:
    now, then, h = s[-1], s[0], 17.0 / _DELAY
    growth = 0.2 * then / (1 + then**10)
    decay = np.exp(-0.1 * h)
    return np.concatenate([s[1:], (now * decay + growth * (1 - decay) / 0.1)[np.newaxis]])


BANK: dict[str, Bank] = {
    "Roessler": Bank(
        "Roessler, Phys. Lett. A 57 (1976) 397",
        lambda s, t: [-s[1] - s[2], s[0] + 0.2 * s[1], 0.2 + s[2] * (s[0] - 5.7)],
        (1.0, 1.0, 0.1),
        2,
        step=0.05,
        period=6.0,
    ),
    "Lorenz 63": Bank(
        "Lorenz, J. Atmos. Sci. 20 (1963) 130",
        lambda s, t: [
            10 * (s[1] - s[0]),
            s[0] * (28 - s[2]) - s[1],
            s[0] * s[1] - 8 / 3 * s[2],
        ],
        (1.0, 1.0, 20.0),
        2,
        step=0.01,
        period=0.75,
    ),
    "Lorenz 84": Bank(
        "Lorenz, Tellus A 36 (1984) 98",
        lambda s, t: [
            -(s[1] ** 2) - s[2] ** 2 - 0.25 * s[0] + 0.25 * 8.0,
            s[0] * s[1] - 4.0 * s[0] * s[2] - s[1] + 1.0,
            4.0 * s[0] * s[1] + s[0] * s[2] - s[2],
        ],
        (1.0, 0.5, 0.5),
        0,
        step=0.03,
        period=3.5,
    ),
    "Thomas": Bank(
        "Thomas, Int. J. Bifurc. Chaos 9 (1999) 1889",
        lambda s, t: [
            np.sin(s[1]) - 0.18 * s[0],
            np.sin(s[2]) - 0.18 * s[1],
            np.sin(s[0]) - 0.18 * s[2],
        ],
        (1.0, 0.0, 0.5),
        0,
        step=0.3,
        period=30.0,
    ),
    "Chua": Bank(
        "Matsumoto, IEEE Trans. Circuits Syst. 31 (1984) 1055",
        _chua,
        (0.7, 0, 0),
        0,
        step=0.03,
        period=2.5,
    ),
    "Halvorsen": Bank(
        "Sprott, Chaos and Time-Series Analysis (2003)",
        lambda s, t: [
            -1.4 * s[0] - 4 * s[1] - 4 * s[2] - s[1] ** 2,
            -1.4 * s[1] - 4 * s[2] - 4 * s[0] - s[2] ** 2,
            -1.4 * s[2] - 4 * s[0] - 4 * s[1] - s[0] ** 2,
        ],
        (-5.0, 0.0, 0.0),
        0,
        step=0.01,
        period=1.4,
    ),
    "Sprott A": Bank(
        "Sprott, Phys. Rev. E 50 (1994) R647",
        lambda s, t: [s[1], -s[0] + s[1] * s[2], 1 - s[1] ** 2],
        (0.0, 5.0, 0.0),
        1,
        step=0.05,
        period=8.0,
    ),
    "Sprott B": Bank(
        "Sprott, Phys. Rev. E 50 (1994) R647",
        lambda s, t: [s[1] * s[2], s[0] - s[1], 1 - s[0] * s[1]],
        (0.5, 0.5, 0.5),
        2,
        step=0.05,
        period=7.0,
    ),
    "Sprott H": Bank(
        "Sprott, Phys. Rev. E 50 (1994) R647",
        lambda s, t: [-s[1] + s[2] ** 2, s[0] + 0.5 * s[1], s[0] - s[2]],
        (0.1, 0.1, 0.1),
        2,
        step=0.05,
        period=8.9,
    ),
    "Arneodo": Bank(
        "Arneodo, Coullet & Tresser, Commun. Math. Phys. 79 (1981) 573",
        lambda s, t: [s[1], s[2], 5.5 * s[0] - 3.5 * s[1] - s[2] - s[0] ** 3],
        (0.2, 0.2, -0.75),
        0,
        step=0.05,
        period=9.0,
    ),
    "Dadras": Bank(
        "Dadras & Momeni, Phys. Lett. A 373 (2009) 3637",
        lambda s, t: [
            s[1] - 3 * s[0] + 2.7 * s[1] * s[2],
            1.7 * s[1] - s[0] * s[2] + s[2],
            2 * s[0] * s[1] - 9 * s[2],
        ],
        (1.0, 1.0, 0.5),
        0,
        step=0.02,
        period=4.0,
    ),
    "Rucklidge": Bank(
        "Rucklidge, J. Fluid Mech. 237 (1992) 209",
        lambda s, t: [-2 * s[0] + 6.7 * s[1] - s[1] * s[2], s[0], -s[2] + s[1] ** 2],
        (1.0, 0.0, 4.5),
        2,
        step=0.04,
        period=3.6,
    ),
    "Vallis": Bank(
        "Vallis, Science 232 (1986) 243",
        lambda s, t: [102 * s[1] - 3 * (s[0] + 0.0), s[0] * s[2] - s[1], -s[0] * s[1] - s[2] + 1],
        (1.0, 0.5, 0.5),
        0,
        step=0.01,
        period=3.8,
    ),
    "Nose-Hoover, slow": Bank(
        "Posch, Hoover & Vesely, Phys. Rev. A 33 (1986) 4253",
        lambda s, t: [s[1], -s[0] - 0.5 * s[1] * s[2], 2.0 * (s[1] ** 2 - 1)],
        (0.0, 2.5, 0.0),
        0,
        step=0.05,
        period=6.0,
    ),
    "Moore-Spiegel": Bank(
        "Moore & Spiegel, Astrophys. J. 143 (1966) 871",
        lambda s, t: [s[1], s[2], -s[2] - (26 - 100 + 100 * s[0] ** 2) * s[1] - 26 * s[0]],
        (0.1, 0.1, 0.1),
        0,
        step=0.006,
        period=3.6,
    ),
    "Hindmarsh-Rose": Bank(
        "Hindmarsh & Rose, Proc. R. Soc. B 221 (1984) 87",
        lambda s, t: [
            s[1] - s[0] ** 3 + 3 * s[0] ** 2 - s[2] + 3.25,
            1 - 5 * s[0] ** 2 - s[1],
            0.005 * (4 * (s[0] + 1.6) - s[2]),
        ],
        (-1.0, -4.0, 3.0),
        0,
        step=0.05,
        period=25.0,
    ),
    "food chain": Bank(
        "Hastings & Powell, Ecology 72 (1991) 896",
        _food_chain,
        (0.8, 0.2, 9.0),
        2,
        step=0.7,
        spread=0.01,
        period=130.0,
    ),
    "Duffing": Bank(
        "Ueda, J. Stat. Phys. 20 (1979) 181",
        _duffing,
        (1.0, 0.0),
        0,
        shown=_forced(1.0),
        step=0.04,
        period=6.4,
    ),
    "van der Pol": Bank(
        "Parlitz & Lauterborn, Phys. Rev. A 36 (1987) 1428",
        lambda s, t: [s[1], 5 * (1 - s[0] ** 2) * s[1] - s[0] + 5 * np.cos(2.463 * t)],
        (0.5, 0.0),
        1,
        step=0.01,
        shown=_forced(2.463),
        period=3.45,
    ),
    "pendulum": Bank(
        "Baker & Gollub, Chaotic Dynamics (1990)",
        lambda s, t: [s[1], -0.5 * s[1] - np.sin(s[0]) + 1.15 * np.cos(2 / 3 * t)],
        (0.5, 0.0),
        2,
        shown=lambda s, t: np.concatenate(
            [np.sin(s[:1]), np.cos(s[:1]), s[1:], _forced(2 / 3)(s, t)[2:]]
        ),
        step=0.05,
        period=16.7,
    ),
    "Mackey-Glass": Bank(
        "Mackey & Glass, Science 197 (1977) 287",
        _mackey_glass,
        (0.9,) * (_DELAY + 1),
        0,
        step=0.0,
        spread=0.2,
        shown=lambda s, t: s[[-1, 10, 0]],
        period=59.0,
    ),
    "Henon map": Bank(
        "Henon, Commun. Math. Phys. 50 (1976) 69",
        lambda s, t: [1 - 1.4 * s[0] ** 2 + s[1], 0.3 * s[0]],
        (0.1, 0.1),
        0,
        step=0.0,
    ),
    "Lozi map": Bank(
        "Lozi, J. Phys. Colloques 39 (1978) C5-9",
        lambda s, t: [1 - 1.7 * np.abs(s[0]) + s[1], 0.5 * s[0]],
        (0.1, 0.1),
        0,
        step=0.0,
    ),
    "Ikeda map": Bank("Ikeda, Opt. Commun. 30 (1979) 257", _ikeda, (0.1, 0.1), 0, step=0.0),
    "coupled maps": Bank(
        "Kaneko, Prog. Theor. Phys. 72 (1984) 480",
        _lattice,
        (0.1, 0.3, -0.2, 0.5, 0.7),
        0,
        step=0.0,
    ),
    "intermittent map": Bank(
        "Pomeau & Manneville, Commun. Math. Phys. 74 (1980) 189",
        lambda s, t: [3.8282 * s[0] * (1 - s[0])],
        (0.3,),
        0,
        step=0.0,
    ),
}


def trajectories(system: Bank, interval: float, samples: int, count: int) -> FloatArray:
    """Observed series without noise, after 40 periods, ``(count, samples, component)``.

    ``interval``: Between samples; of a map, the number of its steps.
    """
    generator = np.random.default_rng(3)
    state = np.array(system.start)[:, np.newaxis]
    state = state + system.spread * generator.normal(size=(len(state), count))
    substeps = math.ceil(interval / system.step) if system.step else round(interval)
    step = interval / substeps if system.step else 1.0
    skipped, now = max(100, round(40 * system.period / interval)), 0.0

    def rate(at: FloatArray, when: float) -> FloatArray:
        return np.asarray(system.rate(at, when))

    series = []
    for number in range(skipped + samples):
        for _ in range(substeps):
            if system.step:
                first = rate(state, now)
                second = rate(state + step / 2 * first, now + step / 2)
                third = rate(state + step / 2 * second, now + step / 2)
                fourth = rate(state + step * third, now + step)
                state = state + step / 6 * (first + 2 * second + 2 * third + fourth)
            else:
                state = rate(state, now)
            now += step
        if number >= skipped:
            series.append(state if system.shown is None else system.shown(state, now))
    return np.stack(series).transpose(2, 0, 1)


@dataclass(frozen=True)
class Trial:
    """One kind on one system."""

    skill: float  #: Brier skill; NaN: refused
    invalid: float  #: share of invalid forecasts
    seconds: float
    words: str  #: warnings of the fit, or why it was refused

    @property
    def names_a_reason(self) -> bool:
        """Whether its words say why it fails."""
        return np.isnan(self.skill) or any(cause in self.words for cause in CAUSES)


def trials(
    name: str, kinds: Sequence[str], points: int, samples: int = SAMPLES
) -> dict[str, Trial]:
    """Each kind on a system of the bank."""
    system = BANK[name]
    interval = system.period / points
    if not system.step:  # steps of a map
        interval = max(1.0, round(interval))
    states = trajectories(system, interval, samples, TRAINING + TESTS)
    assert np.isfinite(states).all(), name
    generator = np.random.default_rng(4)
    states = states + NOISE * states.std(axis=(0, 1)) * generator.normal(size=states.shape)
    settings = {"lyapunov_time": system.period, "sampling_interval": interval, "window": 0.5}
    settings |= {"prediction_times": (1.0,), "washout": 1.0}
    if system.period == 1:
        settings = {"prediction_times": (1.0,), "window": 1.0, "washout": 5.0}
        settings |= {"calibration_spacing": 3.0, "start_spacing": 3.0}
    results = {}
    for kind in kinds:
        forecaster = EventForecaster(system.event, kind=kind, **settings, **NETWORKS)
        began = time.process_time()
        with warnings.catch_warnings(), single_threaded():
            warnings.simplefilter("ignore")
            try:
                forecaster.fit(list(states[:TRAINING]))
                scores = forecaster.scores(list(states[TRAINING:]))
            except ValueError as error:
                nothing = float("nan")
                results[kind] = Trial(nothing, nothing, time.process_time() - began, str(error))
                continue
        results[kind] = Trial(
            scores["brier_skill"],
            scores["invalid_fraction"],
            time.process_time() - began,
            "; ".join(forecaster.warnings_),
        )
    return results


def silent(results: dict[str, Trial]) -> list[str]:
    """Kinds that fail without a reason, where another kind has skill."""
    best = np.nanmax([trial.skill for trial in results.values()])
    return [
        kind
        for kind, trial in results.items()
        if best > SKILL and trial.skill < NO_SKILL and not trial.names_a_reason
    ]


def main() -> None:
    """Print a table in Markdown, and what fails silently."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--systems", nargs="+", default=list(BANK), choices=list(BANK))
    parser.add_argument("--kinds", nargs="+", default=list(KINDS))
    parser.add_argument("--points", type=int, default=20, help="samples in a period")
    parser.add_argument("--words", action="store_true", help="print all warnings, too")
    given = parser.parse_args()
    print(f"| system | {' | '.join(f'`{kind}`' for kind in given.kinds)} | best |")
    print("|---" * (len(given.kinds) + 2) + "|")
    failures = []
    for name in given.systems:
        results = trials(name, given.kinds, given.points)
        cells = []
        for trial in results.values():
            lost = f", {trial.invalid:.0%} invalid" if trial.invalid > 0.01 else ""
            cells.append("refused" if np.isnan(trial.skill) else f"{trial.skill:.2f}{lost}")
        best = max(results, key=lambda kind: np.nan_to_num(results[kind].skill, nan=-np.inf))
        print(f"| {name} | {' | '.join(cells)} | `{best}` |", flush=True)
        failures += [f"{name}, {kind}: {results[kind].words!r}" for kind in silent(results)]
        if given.words:
            for kind, trial in results.items():
                print(f"    {kind} ({trial.seconds:.1f} s): {trial.words}", flush=True)
    print(f"\n{len(failures)} fail silently")
    print("\n".join(failures))


if __name__ == "__main__":
    main()
