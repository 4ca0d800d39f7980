"""The table of return times, from the counts of long runs."""

import numpy as np
import pytest

from burstcast.base.names import parsed
from burstcast.statistics.return_times import return_times
from burstcast.tables.makers.registry import Gathered
from burstcast.tables.makers.return_times_table import make


def test_each_level_of_a_run_has_its_return_time():
    generator, levels = np.random.default_rng(1), np.array([0.1, 0.2, 0.3])
    counts = {
        "level": levels,
        "events": generator.poisson([2.0, 0.3, 0.0], size=(50, 3)),
        "exceeding": generator.integers(40, size=(50, 3)),
        "steps": np.full(50, 610),
        "actuated_steps": np.full(50, 61),
        "decisions": np.full(50, 40),
        "laminarisations": np.eye(50, dtype=np.int64)[0],
        "escapes": 2 * np.eye(50, dtype=np.int64)[1],
        "steps_per_lyapunov_time": 61,
    }
    plan = {"strategy": "reactive", "settings": {"level": 0.06}, "delay_lt": 0.0}
    run = Gathered(parsed("none"), counts, plan)
    rows = make(runs=[run], noise=0.01, confidence=0.9)["return_times"]
    expected = return_times(counts["events"], 10.0, levels, 0.9)
    assert [row["return_level"] for row in rows] == levels.tolist()
    assert [row["events"] for row in rows] == counts["events"].sum(axis=0).tolist()
    for column in ("return_time", "return_time_low", "return_time_high"):
        ends = getattr(expected, column.removeprefix("return_time_"))
        assert [row[column] for row in rows[:2]] == pytest.approx(ends[:2].tolist())
    # nothing was observed: a bound, and neither a return time nor an upper end
    last = rows[2]
    assert last["return_time_low"] == pytest.approx(500 / -np.log(0.1))
    assert np.isnan([last["return_time"], last["return_time_high"]]).all()
    for row in rows:
        assert (row["lyapunov_times"], row["flows"], row["laminarisations"]) == (500.0, 50, 1)
        assert row["escapes"] == 2
        assert row["control_fraction"] == pytest.approx(0.1)
        assert (row["strategy"], row["level"]) == ("reactive", 0.06)
    exceedances = counts["exceeding"].sum(axis=0) / (50 * 610)
    assert [row["exceedance"] for row in rows] == pytest.approx(exceedances.tolist())
    assert [row["independent"] for row in rows] == (~expected.clustered).tolist()
