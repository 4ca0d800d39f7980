"""The job that chooses other training series, on a made-up ensemble."""

import json

import numpy as np
import pytest
from helpers_rebuilds import loaded_script

from burstcast.files.netcdf import Variable, read_netcdf, write_netcdf
from burstcast_workflow.harness.settings import Settings

KEPT, LENGTH, TRAINING, TEST = 90, 50, 4, 30
SETTINGS = {
    "case": "Re400-training2",
    "case.system": "mfe",
    "case.parameters": {"reynolds": 400, "length_x": 12.6, "length_z": 6.3},
    "case.ensemble.time_step": 0.25,
    "case.ensemble.sampling_stride": 4,
    "case.training.series": TRAINING,
    "case.test_series": TEST,
    "probability.calibration_series": 1,
    "random_seed": 7,
    "realisation": 2,
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
        settings=Settings({**SETTINGS, "drawn": drawn, **settings}, {}),
    )
    assert json.loads(summary.read_text())["series_kept"] == KEPT
    return read_netcdf(ensemble, "state")["state"][:, 0, 0].astype(int)


def test_drawn_series_have_the_share_and_the_test_series_stay(source):
    path, happens = source
    shares = happens.mean(axis=1)
    wanted = (0.2, float(shares.mean()))
    rows = [chosen(path, {"shares": given, "threshold": 0.1}) for given in ([0.2], [0.2, "all"])]
    held = slice(TRAINING, TRAINING + TEST + 1)
    for order, share in zip(rows, wanted, strict=True):
        assert sorted(order.tolist()) == list(range(KEPT))
        np.testing.assert_array_equal(order[held], np.arange(KEPT)[held])
        assert abs(shares[order[:TRAINING]].mean() - share) < 0.005
    assert not set(rows[0][:TRAINING]) & set(rows[1][:TRAINING])
    other_root = chosen(path, {"shares": [0.2], "threshold": 0.1}, random_seed=8)
    assert other_root[:TRAINING].tolist() != rows[0][:TRAINING].tolist()


def test_blocks_of_series_are_taken_where_none_are_drawn(source):
    order = chosen(source[0], None)
    assert order[:TRAINING].tolist() == [82, 83, 84, 85]
    assert order[82:86].tolist() == [0, 1, 2, 3]


def test_an_ensemble_without_enough_series_is_refused(source):
    with pytest.raises(ValueError, match=r"only 90 series did not laminarise"):
        chosen(source[0], {"shares": [0.2], "threshold": 0.1}, **{"case.test_series": 80})
