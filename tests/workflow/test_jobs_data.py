"""Jobs of the data: lengths of series, units of time, other training series."""

import json

import numpy as np
import pytest
from helpers_configs import computed_files, tiny_with
from helpers_rebuilds import loaded_script

from burstcast.base.files.netcdf import Variable, read_netcdf, write_netcdf
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.campaign.job_settings import settings_of_job
from burstcast_workflow.campaign.loading import load
from burstcast_workflow.harness.storage import write_json
from burstcast_workflow.jobs import series as data
from burstcast_workflow.jobs.cases import Clock

# -- lengths ---------------------------------------------------------------------------------------

LENGTHS = loaded_script("data/lengths.py")
ASKED = "job.asked_of_series"
FITTING = settings_of_job(
    Campaign(load(tiny_with())), LENGTHS.LengthsOfCase.paths(), {"case": "Re400"}
) | {"statistics.duration": None}


def problems(tmp_path, steps=20, samples=400, **changed):
    """Message of the job over a series of so many samples, and so many steps of a Lyapunov time."""
    ensemble, lengths = tmp_path / "ensemble.nc", tmp_path / "lengths.json"
    write_netcdf(ensemble, {"time": Variable(("time",), np.arange(samples) * 1.0, "1", "t")}, {})
    files = computed_files(tmp_path, steps_per_lyapunov_time=steps)
    settings = LENGTHS.LengthsOfCase({**FITTING, **changed}, {"case": "A"}, files=files)
    lengths.unlink(missing_ok=True)
    try:
        LENGTHS.lengths_of_case(ensemble=str(ensemble), lengths=str(lengths), settings=settings)
    except ValueError as error:
        assert not lengths.exists()
        return str(error)
    record = json.loads(lengths.read_text())
    assert (record["steps_per_lyapunov_time"], record["samples"]) == (steps, samples)
    return ""


def test_all_that_does_not_fit_is_one_list_of_what_the_case_has(tmp_path):
    assert not problems(tmp_path)
    message = problems(tmp_path, steps=200, **{"forecasters.quadratic.window_lt": 30})
    assert "a series of 400 samples has 2 Lyapunov times of 200 steps" in message
    for named in ("search.interval_lt", "classification.longest_prediction_time_lt", "horizon."):
        assert named in message
    assert "quadratic.window_lt" in message
    assert "statistics" not in message
    for asked, value, name, too_much in (
        ("long_runs", False, "statistics.duration", 0.1),
        ("kinds", ["esn"], "forecasters.quadratic.window_lt", 30),
        ("validations", [], "search.interval_lt", 25),
    ):
        assert problems(tmp_path, **{name: too_much})
        unasked = {f"{ASKED}.{asked}": value}
        assert not problems(tmp_path, **{name: too_much}, **unasked)


def test_test_series_follow_the_training_series_as_far_as_they_are_kept(tmp_path):
    path, kept = tmp_path / "ensemble.nc", Variable(("series",), np.arange(6), "1", "number")
    write_netcdf(path, {"series": kept}, {})

    def rows(wanted):
        settings = {"case.training.series": 3, "case.test_series": wanted}
        return data.Tested(settings, {"case": "A"}).rows(str(path))

    assert rows(None) == range(3, 6)
    assert rows(2) == range(3, 5)
    with pytest.raises(ValueError, match="only 6 series"):
        rows(4)


# -- units of time ---------------------------------------------------------------------------------


UNIT = loaded_script("data/time_unit.py")


def unit(tmp_path, published, time_unit="given", time_step=0.25, stride=4, computed=None):
    """The unit of time of a case, as its job writes it; ``computed``: An exponent of another."""
    declared = {
        "case.ensemble.time_step": time_step,
        "case.ensemble.sampling_stride": stride,
        "case.lyapunov.time_unit": time_unit,
        "case.lyapunov.given_exponent": published,
    }
    exponents, file = tmp_path / "lyapunov.json", tmp_path / "time_unit.json"
    write_json(exponents, {"leading": {"mean": computed, "low": 0.001, "high": 9}})
    settings = UNIT.TimeUnit(declared, {})
    UNIT.time_unit_of_case(
        exponents=[] if computed is None else str(exponents), time_unit=str(file), settings=settings
    )
    return Clock({}, {}, files={"time_unit": str(file)})


def test_the_computed_exponent_is_the_unit_where_none_is_published_or_the_config_says_so(tmp_path):
    assert unit(tmp_path, 0.0163).lyapunov_time == 61
    assert unit(tmp_path, 0.9, time_step=0.01, stride=2).sampling_interval == 0.02
    assert unit(tmp_path, None, computed=0.0155).lyapunov_time == 64
    assert unit(tmp_path, 0.01, "computed", computed=0.0155).lyapunov_time == 64
    assert unit(tmp_path, 0.01, computed=0.0155).lyapunov_time == 100


def test_an_exponent_without_a_time_unit_names_the_settings(tmp_path):
    with pytest.raises(ValueError, match=r"lyapunov\.given_exponent.*: .*must be positive"):
        unit(tmp_path, None, computed=-0.01)


def test_a_threshold_is_a_number_or_a_quantile_of_the_training_series(tmp_path):
    script, ensemble = loaded_script("data/event_threshold.py"), str(tmp_path / "ensemble.nc")
    observable = np.arange(24.0).reshape(4, 6)
    variables = {
        "series": Variable(("series",), np.arange(4), "1", "number"),
        "observable": Variable(("series", "time"), observable, "1", "observable"),
    }
    write_netcdf(ensemble, variables, {})
    file = tmp_path / "event_threshold.json"
    for threshold, value in ((0.1, 0.1), ({"quantile": 0.5}, np.quantile(observable[:2], 0.5))):
        declared = {"case.event_threshold": threshold, "case.training.series": 2}
        script.event_threshold_of_case(
            ensemble=ensemble, event_threshold=str(file), settings=script.Threshold(declared, {})
        )
        assert json.loads(file.read_text())["event_threshold"] == pytest.approx(value)


# -- other training series -------------------------------------------------------------------------

KEPT, LENGTH, TRAINING, TEST = 90, 50, 4, 30
SETTINGS = {
    "case.system": "mfe",
    "case.parameters": {"reynolds": 400, "length_x": 12.6, "length_z": 6.3},
    "case.ensemble.time_step": 0.25,
    "case.ensemble.sampling_stride": 4,
    "case.training.series": TRAINING,
    "case.test_series": TEST,
    "probability.calibration_series": 1,
    "random_seed": 7,
    "case.realisation": 2,
}


@pytest.fixture
def source(tmp_path):
    """An ensemble in which each series says by its first component which one it is."""
    generator = np.random.default_rng(1)
    states = generator.normal(size=(KEPT, LENGTH, 9))
    states[:, :, 0] = np.arange(KEPT)[:, np.newaxis]
    happens = generator.random((KEPT, LENGTH)) < generator.beta(2, 12, size=(KEPT, 1))
    # at the threshold itself, an event is under way
    observable = np.where(happens, 0.1, 0.0999)
    variables = {
        "series": Variable(("series",), np.arange(KEPT), "1", "number"),
        "lifetime": Variable(("generated",), np.full(KEPT, LENGTH - 1), "1", "steps"),
        "state": Variable(("series", "time", "component"), states, "1", "state"),
        "observable": Variable(("series", "time"), observable, "1", "observable"),
    }
    path = tmp_path / "source.nc"
    write_netcdf(path, variables, {})
    return path, happens


def chosen(source, drawn, **settings):
    """Numbers of the series in their new order."""
    script = loaded_script("data/training_realisation.py")
    ensemble, summary = source.with_name("ensemble.nc"), source.with_name("dataset.json")
    script.choose_training_series(
        source=str(source),
        ensemble=str(ensemble),
        summary=str(summary),
        settings=script.Realisation(
            {**SETTINGS, "job.drawn_shares": drawn, **settings}, {"case": "Re400-training2"}
        ),
    )
    assert json.loads(summary.read_text())["series_kept"] == KEPT
    return read_netcdf(ensemble, "state")["state"][:, 0, 0].astype(int)


def test_drawn_series_have_the_share_and_the_test_series_stay(source):
    path, happens = source
    shares, drawn = happens.mean(axis=1), {"shares": [0.2, "all"], "threshold": 0.1}
    order = chosen(path, drawn)
    held = slice(TRAINING, TRAINING + TEST + 1)
    assert sorted(order.tolist()) == list(range(KEPT))
    np.testing.assert_array_equal(order[held], np.arange(KEPT)[held])
    assert abs(shares[order[:TRAINING]].mean() - shares.mean()) < 0.005
    first, other_root = (chosen(path, drawn | {"shares": [0.2]}, random_seed=n) for n in (7, 8))
    assert abs(shares[first[:TRAINING]].mean() - 0.2) < 0.005
    assert not set(first[:TRAINING]) & set(order[:TRAINING])
    assert other_root[:TRAINING].tolist() != first[:TRAINING].tolist()


def test_blocks_of_series_are_taken_where_none_are_drawn(source):
    order = chosen(source[0], None)
    assert order[:TRAINING].tolist() == [82, 83, 84, 85]
    assert order[82:86].tolist() == [0, 1, 2, 3]
    with pytest.raises(ValueError, match=r"only 90 series did not laminarise"):
        chosen(source[0], {"shares": [0.2], "threshold": 0.1}, **{"case.test_series": 80})
