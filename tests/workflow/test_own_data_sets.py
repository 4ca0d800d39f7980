"""Two data sets of others from numbers to a summary, beside what is far simpler than networks.

Neither system is one of the library's: they are integrated here, written to files, and known from
then on as measured series.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from helpers_rebuilds import Project

from burstcast.arrays import FloatArray
from burstcast.files.netcdf import read_netcdf
from burstcast.files.tables import read_table
from burstcast.forecast.windows import WindowSummaries, crosses
from burstcast.probability.precursor import Precursor, PrecursorOptions, precursor_features
from burstcast_workflow.harness.storage import read_json

GROWTH = np.array([[1.0], [0.72], [1.53], [1.27]])
COMPETITION = np.array(
    [[1, 1.09, 1.52, 0], [0, 1, 0.44, 1.36], [2.33, 0, 1, 0.47], [1.21, 0.51, 0.35, 1]]
)


def four_species(state: FloatArray) -> FloatArray:
    """Competition of four species: Vano et al., Nonlinearity 19 (2006), with their parameters."""
    return GROWTH * state * (1 - COMPETITION @ state)


def bursting_neuron(state: FloatArray) -> FloatArray:
    """Membrane potential, recovery, adaptation: Hindmarsh & Rose, Proc. R. Soc. B 221 (1984)."""
    x, y, z = state
    fast = y + 3 * x**2 - x**3 - z + 3.25, 1 - 5 * x**2 - y
    return np.stack([*fast, 0.006 * (4 * (x + 1.6) - z)])


@dataclass(frozen=True)
class DataSet:
    """Equations, how they are sampled, and what is known of them.

    ``exponent`` is the leading one: Vano's, and that of perturbations followed for 64 series of
    4000 time units, 0.01326 +- 0.00016.
    """

    rates: Callable[[FloatArray], FloatArray]
    start: tuple[float, ...]
    series: int
    samples: int
    step: float
    stride: int
    header: str
    config: str
    exponent: float

    def integrate(self) -> FloatArray:
        """Series ``(series, samples, component)`` by the classical Runge-Kutta method."""
        generator = np.random.default_rng(1)
        start = np.array(self.start)[:, np.newaxis]
        state = start * (1 + 0.1 * generator.random((len(start), self.series)))
        found = []
        transient = 500 * self.stride
        for number in range(transient + self.samples * self.stride):
            if number >= transient and (number - transient) % self.stride == 0:
                found.append(state)
            one = self.rates(state)
            two = self.rates(state + self.step / 2 * one)
            three = self.rates(state + self.step / 2 * two)
            four = self.rates(state + self.step * three)
            state = state + self.step / 6 * (one + 2 * two + 2 * three + four)
        return np.stack(found).transpose(2, 0, 1)


DATA_SETS = {
    "four species": DataSet(
        four_species,
        (0.301, 0.459, 0.131, 0.356),
        1,
        40_000,
        0.1,
        10,
        "n1,n2,n3,n4",
        """\
results: results/own
campaign: [{cases: [own], forecasters: {esn: {neurons: [100], validation: [RV], seeds: 3}}}]
cases:
  own: {event_threshold: {quantile: 0.95},
        data: {files: ["own_*.csv"], observable: n1, time_step: 1, blocks: {duration: 800}}}
""",
        0.0203,
    ),
    "bursting neuron": DataSet(
        bursting_neuron,
        (-1.0, 0.3, 3.0),
        24,
        4_000,
        0.05,
        10,
        "x,y,z",
        """\
results: results/own
campaign: [{cases: [own], forecasters: {esn: {neurons: [300], validation: [RV], seeds: 3}}}]
cases:
  own: {event_threshold: {quantile: 0.95},
        data: {files: ["own_*.csv"], observable: z, time_step: 0.5}}
""",
        0.0133,
    ),
}


def logistic_f_score(own, threshold: float, windows: tuple[int, int]) -> float:
    """F-score of alarms by a logistic regression of the present components and their products.

    It learns from the starting points in the training series, and alarms from the probability on
    that is best there. A point whose washout holds an event is no point, as for all forecasters.
    """
    sets = {}
    for name in ("calibration_set", "evaluation_set"):
        points = read_netcdf(own / f"{name}.nc")
        truth = WindowSummaries(points["first"], points["largest"])
        happened = crosses(truth, *windows, threshold)
        kept = points["washout_maximum"] < threshold
        sets[name] = precursor_features(points["washout"])[kept], happened[kept]
    features, happened = sets["calibration_set"]
    precursor = Precursor.fit(features, happened[:, np.newaxis], PrecursorOptions("logistic"))

    def f_score(probability, truth, alarm):
        alarms = probability >= alarm
        return 2 * (alarms & truth).sum() / (alarms.sum() + truth.sum())

    known = precursor.probabilities(features)[:, 0]
    best = max(np.unique(known), key=lambda alarm: f_score(known, happened, alarm))
    features, happened = sets["evaluation_set"]
    return float(f_score(precursor.probabilities(features)[:, 0], happened, best))


@pytest.mark.long
@pytest.mark.parametrize("name", DATA_SETS)
def test_from_generation_to_summary(name, tmp_path, job_server):
    data = DATA_SETS[name]
    project = Project.create(tmp_path / "project", job_server, "own.yaml")
    assert len(data.config.splitlines()) == 5
    (project.directory / "own.yaml").write_text(data.config)
    for number, series in enumerate(data.integrate()):
        rows = np.column_stack([data.step * data.stride * np.arange(len(series)), series])
        header = {"delimiter": ",", "header": f"time,{data.header}", "comments": ""}
        np.savetxt(project.directory / f"own_{number}.csv", rows, **header)
    outcome = project.snakemake()
    assert outcome.status == 0, outcome.text[-3000:]
    summary = outcome.text.partition("F-score")[2]
    assert "permanent alarm" in summary
    results = project.directory / "results/own"

    leading = read_json(results / "own/lyapunov.json")["leading"]
    assert leading["low"] < data.exponent < leading["high"]
    assert leading["mean"] == pytest.approx(data.exponent, rel=0.2)

    table = read_table(results / "tables/classification.csv")
    at_one = table[table["prediction_time_lt"] == 1].groupby("forecaster")["f_score"].median()
    threshold = read_json(results / "own/event_threshold.json")["event_threshold"]
    logistic = logistic_f_score(results / "own", threshold, (1, 2))
    # the present says little more of this time than a permanent alarm does; the networks know
    assert logistic > at_one["permanent_alarm"] - 0.05
    assert at_one["esn"] > max(logistic, at_one["permanent_alarm"]) + 0.2

    # networks that have learnt the system have its exponent, as far as a few runs tell
    spectrum = read_table(results / "tables/lyapunov_spectrum.csv")
    own = spectrum[(spectrum["forecaster"] == "esn") & (spectrum["number"] == 1)]
    assert own["lyapunov_exponent"].median() == pytest.approx(data.exponent, rel=0.25)
    warnings = read_table(results / "tables/warnings.csv")
    assert "no_chaos_learnt" not in set(warnings["warning"])
