"""Data of one's own: five lines, records with gaps, and what is far simpler than networks."""

import numpy as np
import pytest
from helpers_rebuilds import Project
from matplotlib.image import imread

from burstcast.base.arrays import FloatArray
from burstcast.base.files.netcdf import read_netcdf
from burstcast.base.files.tables import read_table
from burstcast.forecasters.precursor import fitted_classifiers
from burstcast.forecasts.windows import WindowSummaries, crosses
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from burstcast_workflow.harness.storage import read_json

FIVE_LINES = """\
results: results/own
campaign: [{{cases: [own], forecasters: {{{forecasters}}}}}]
cases:
  own: {{event_threshold: {{quantile: 0.95}},
        data: {data}}}
"""
BLOCKS = "{files: [own.csv], observable: z, time_step: 0.02, blocks: {duration: 16}}"


def configure(project, forecasters, data=BLOCKS):
    text = FIVE_LINES.format(forecasters=forecasters, data=data)
    assert len(text.splitlines()) == 5
    (project.directory / "own.yaml").write_text(text)


@pytest.fixture
def project(tmp_path, job_server):
    """A working copy with a table of three columns, times and a header, and nothing else."""
    project = Project.create(tmp_path / "project", job_server, "own.yaml")
    states = integrate(Lorenz63(), np.array([[1.0], [1.0], [20.0]]), 0.01, 2 * 14000, stride=2)
    project.write_series("own.csv", "x,y,z", 0.02, states[1000:, :, 0])
    return project


def test_own_data_with_five_lines_of_config(project):
    configure(project, "esn: {neurons: [30], validation: [RV], seeds: 1}")
    case = "results/own/own"
    network = f"{case}/networks/esn-N30-RV-seed0"
    project.made(
        f"{network}/forecast.nc",
        f"{network}/search.csv",
        "results/own/tables/survival.csv",
        "results/own/tables/statistics.csv",
        "results/own/figures/validation_strategies.png",
        "results/own/figures/observable_and_density.png",
    )
    ensemble = read_netcdf(project.directory / case / "ensemble.nc")
    assert ensemble["state"].shape == (16, 801, 3)
    points = read_netcdf(project.directory / case / "evaluation_set.nc")
    assert set(points["series"]) == set(range(6))  # all after those of the training
    statistics = read_netcdf(project.directory / case / "statistics_data.nc")
    assert statistics["edge"][0] == ensemble["observable"].min()
    assert statistics["edge"][-1] == ensemble["observable"].max()
    survival = read_table(project.directory / "results/own/tables/survival.csv")
    assert set(survival["forecaster"]) >= {"esn", "data"}


@pytest.mark.long
def test_a_campaign_that_is_too_small_for_its_stages_ends(tmp_path, job_server):
    """Series in whose washouts events are always under way: nothing to calibrate with."""
    project = Project.create(tmp_path / "project", job_server)
    networks = {"neurons": [40], "validation": ["RV"], "seeds": 2}
    forecasters = {"esn": networks, "equations": {}, "quadratic_filtered": {}}
    validation = {"series": 2, "intervals_per_series": None}
    overlay = {
        "campaign": [{"reynolds": [1000, 400, 800], "forecasters": forecasters}],
        "case_defaults": {"test_series": 12, "recycle_validation": validation},
    }
    outcome = project.made(overlay=overlay)
    results = project.results
    calibration = read_json(results / "Re1000/calibration.json")
    (rule,) = calibration["alarms"]["climatology"]["1"].values()
    assert rule["values"] == []
    scores = read_table(results / "tables/probability_scores.csv")
    scores = scores[scores["probability"] == "calibrated"]
    undefined = scores[(scores["case"] == "Re1000") & (scores["metric"] == "brier_score")]
    assert len(undefined) > 3
    assert undefined["value"].isna().all()
    warnings = read_table(results / "tables/warnings.csv")
    expected = {"few_events", "few_positives", "nothing_to_calibrate_with"}
    assert expected <= set(warnings[warnings["case"] == "Re1000"]["warning"])
    assert "nothing_to_calibrate_with" not in set(warnings[warnings["case"] == "Re400"]["warning"])
    assert "no calibration of probabilities" in outcome.text
    drawn = imread(results / "figures/forecast_skill_Re1000.png")[..., :3]
    assert (drawn.min(axis=2) < 0.9).mean() > 0.01  # where there is ink


@pytest.mark.long
def test_a_campaign_without_any_event_ends(tmp_path, job_server):
    """Scores, horizons, probabilities and control have nothing to count."""
    project = Project.create(tmp_path / "project", job_server)
    quiet = {"case_defaults": {"event_threshold": 0.47}, "figures": {"flow_event": {"peak": 0.475}}}
    project.made(overlay=quiet)
    results = project.results
    assert read_table(results / "tables/classification.csv")["recall"].isna().all()
    assert set(read_table(results / "tables/dataset.csv")["events_per_series"]) == {0}
    strategies = read_table(results / "tables/control_strategies.csv")
    left = strategies[strategies["metric"] == "relative_exceedance"]
    assert left["value"].isna().all()
    assert "few_events" in set(read_table(results / "tables/warnings.csv")["warning"])
    drawn = {path.stem for path in (results / "figures").glob("*.png")}
    assert {"forecast_skill", "control_tradeoff", "reliability", "horizon_by_size"} <= drawn


def test_mistakes_in_rows_are_told_before_any_job(project):
    configure(project, "persistence: {}")
    states = np.random.default_rng(1).normal(size=(1001, 3))
    project.write_series("own.csv", "x,y,z", 0.02, states)
    outcome = project.snakemake("results/own/own/ensemble.nc")
    assert outcome.status != 0
    assert "The configuration has a mistake: case own: " in outcome.text
    assert "but the data have 1 series in all" in outcome.text
    assert "import_data" not in outcome.text


# -- data of others --------------------------------------------------------------------------------

GROWTH = np.array([[1.0], [0.72], [1.53], [1.27]])
COMPETITION = np.array(
    [[1, 1.09, 1.52, 0], [0, 1, 0.44, 1.36], [2.33, 0, 1, 0.47], [1.21, 0.51, 0.35, 1]]
)
EXPONENT = 0.0203
SPECIES = (
    "{files: [species.csv], observable: n1, time_step: 1, blocks: {duration: 800}}",
    "esn: {neurons: [100], validation: [RV], seeds: 3}",
)


def species(samples: int, step: float = 0.1, stride: int = 10) -> FloatArray:
    """Competition of four species by the classical Runge-Kutta method, ``(samples, species)``.

    Vano et al., Nonlinearity 19 (2006), with their parameters; the exponent is theirs.
    """

    def rates(state: FloatArray) -> FloatArray:
        return GROWTH * state * (1 - COMPETITION @ state)

    start = np.array([[0.301], [0.459], [0.131], [0.356]])
    state = start * (1 + 0.1 * np.random.default_rng(1).random((4, 1)))
    states = []
    for number in range((500 + samples) * stride):
        if number >= 500 * stride and number % stride == 0:
            states.append(state[:, 0])
        first = rates(state)
        second = rates(state + step / 2 * first)
        third = rates(state + step / 2 * second)
        fourth = rates(state + step * third)
        state = state + step / 6 * (first + 2 * second + 2 * third + fourth)
    return np.stack(states)


def logistic_f_score(case, threshold: float, windows: tuple[int, int]) -> float:
    """F-score of alarms by a logistic regression of the present components and their products.

    It learns from the starting points in the training series, and alarms from the probability on
    that is best there. A point whose washout holds an event is no point, as for all forecasters.
    """
    sets = {}
    for name in ("calibration_set", "evaluation_set"):
        points = read_netcdf(case / f"{name}.nc")
        truth = WindowSummaries(points["first"], points["largest"])
        happened = crosses(truth, *windows, threshold)
        kept = points["washout_maximum"] < threshold
        sets[name] = points["washout"][kept, -1], happened[kept]
    features, happened = sets["calibration_set"]
    (precursor,) = fitted_classifiers("logistic", features, happened[:, np.newaxis])

    def f_score(probability, truth, alarm):
        alarms = probability >= alarm
        return 2 * (alarms & truth).sum() / (alarms.sum() + truth.sum())

    probabilities = precursor.predict_proba(features)[:, 1]
    best = max(np.unique(probabilities), key=lambda alarm: f_score(probabilities, happened, alarm))
    features, happened = sets["evaluation_set"]
    return float(f_score(precursor.predict_proba(features)[:, 1], happened, best))


@pytest.mark.long
def test_from_generation_to_summary(tmp_path, job_server):
    data, networks = SPECIES
    project = Project.create(tmp_path / "project", job_server, "own.yaml")
    configure(project, networks, data)
    project.write_series("species.csv", "n1,n2,n3,n4", 1.0, species(40_000))
    outcome = project.made()
    summary = outcome.text.partition("F-score")[2]
    assert "permanent alarm" in summary
    results = project.directory / "results/own"

    leading = read_json(results / "own/lyapunov.json")["leading"]
    assert leading["low"] < EXPONENT < leading["high"]
    assert leading["mean"] == pytest.approx(EXPONENT, rel=0.2)

    table = read_table(results / "tables/classification.csv")
    at_one = table[table["prediction_time_lt"] == 1].groupby("forecaster")["f_score"].median()
    threshold = read_json(results / "own/event_threshold.json")["event_threshold"]
    logistic = logistic_f_score(results / "own", threshold, (1, 2))
    # the present says little more of this time than a permanent alarm does; the networks know
    assert logistic > at_one["permanent_alarm"] - 0.05
    assert at_one["esn"] > max(logistic, at_one["permanent_alarm"]) + 0.2

    # networks that have learnt the system have its exponent, as far as a few runs tell
    spectrum = read_table(results / "tables/lyapunov_spectrum.csv")
    exponents = spectrum[(spectrum["forecaster"] == "esn") & (spectrum["number"] == 1)]
    assert exponents["lyapunov_exponent"].median() == pytest.approx(EXPONENT, rel=0.25)
    warnings = read_table(results / "tables/warnings.csv")
    assert "no_chaos_learnt" not in set(warnings["warning"])
