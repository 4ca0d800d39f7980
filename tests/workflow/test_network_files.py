"""Networks and their training series as jobs read and write them."""

import numpy as np
import pytest

from burstcast import random_streams
from burstcast.esn.dynamics import Dynamics
from burstcast.esn.network import EchoStateNetwork
from burstcast.esn.training import train
from burstcast_workflow.network_files import (
    read_forecaster,
    read_network,
    reservoir,
    training_series,
    write_network,
)
from burstcast_workflow.storage import Variable, read_attributes, write_netcdf

SETTINGS = {
    "case": "Re400",
    "random_seed": 2022,
    "training": {"series": 3, "noise": 0.01},
    "neurons": 40,
    "seed": 2,
    "connectivity": 6,
    "input_bias": 0.1,
}


@pytest.fixture
def ensemble(tmp_path):
    path = tmp_path / "ensemble.nc"
    write(path, np.random.default_rng(1).normal(size=(7, 90, 4)).cumsum(axis=1))
    return path


def write(path, states):
    variables = {
        "series": Variable(("series",), np.arange(len(states)), "1", "number"),
        "state": Variable(
            ("series", "time", "component"), states, "1", "state", chunks=(1, *states.shape[1:])
        ),
    }
    write_netcdf(path, variables, {})
    return states


def test_training_series_are_the_first_with_noise(tmp_path):
    states = write(tmp_path / "e.nc", np.random.default_rng(1).normal(size=(7, 90, 4)))
    training = training_series(SETTINGS, tmp_path / "e.nc")
    flat = states[:3].reshape(-1, 4)
    np.testing.assert_array_equal(training.input_range, np.ptp(flat, axis=0))
    assert training.observed.shape == (3, 90, 4)
    for series in range(3):
        numbers = random_streams.stream(2022, "noise", "Re400", series).standard_normal((90, 4))
        expected = states[series] + 0.01 * flat.std(axis=0) * numbers
        np.testing.assert_allclose(training.observed[series], expected, rtol=1e-14, atol=1e-14)


def test_the_series_after_them_change_nothing(tmp_path):
    states = write(tmp_path / "a.nc", np.random.default_rng(1).normal(size=(7, 90, 4)))
    write(tmp_path / "b.nc", states[:4])
    first, second = (training_series(SETTINGS, tmp_path / name) for name in ("a.nc", "b.nc"))
    np.testing.assert_array_equal(first.observed, second.observed)


def test_an_ensemble_that_is_too_small_names_the_setting(ensemble):
    settings = {**SETTINGS, "training": {"series": 8, "noise": 0}}
    with pytest.raises(ValueError, match=r"training\.series is 8, but only 7 series"):
        training_series(settings, ensemble)


def same(one, other):
    return (
        np.array_equal(one.input_weight, other.input_weight)
        and np.array_equal(one.input_column, other.input_column)
        and np.array_equal(one.recurrent.toarray(), other.recurrent.toarray())
    )


def test_a_reservoir_is_its_size_and_seed_whatever_the_case_and_strategy():
    one = reservoir(SETTINGS, 4)
    assert same(one, reservoir({**SETTINGS, "case": "Re600", "validation": "SSV"}, 4))
    assert not same(one, reservoir({**SETTINGS, "seed": 3}, 4))
    assert not same(one, reservoir({**SETTINGS, "random_seed": 1}, 4))


@pytest.fixture
def network(ensemble):
    training = training_series(SETTINGS, ensemble)
    dynamics = Dynamics(reservoir(SETTINGS, 4), 0.7, 1.3, "scipy")
    readout = train(dynamics, training, washout=10, tikhonov=1e-6)
    return EchoStateNetwork(dynamics, readout, training.input_range)


def test_a_network_comes_back_bit_for_bit(network, tmp_path):
    path = tmp_path / "network.nc"
    write_network(path, network, SETTINGS, {"source": "test"})
    back = read_network(path, "scipy")
    assert same(back.dynamics.reservoir, network.dynamics.reservoir)
    assert back.dynamics.reservoir.input_bias == 0.1
    np.testing.assert_array_equal(back.readout.weights, network.readout.weights)
    for name in ("tikhonov", "solver", "reciprocal_condition"):
        assert getattr(back.readout, name) == getattr(network.readout, name)
    washout = np.random.default_rng(5).normal(size=(12, 4, 3))
    outputs = [
        made.forecast(made.washout(washout), 20)[0]
        for made in (network, back, read_forecaster(path, "scipy").network)
    ]
    np.testing.assert_array_equal(outputs[0], outputs[1])
    np.testing.assert_array_equal(outputs[0], outputs[2])


def test_the_file_says_what_it_is_made_of_and_holds_no_big_matrix(network, tmp_path):
    path = tmp_path / "network.nc"
    write_network(path, network, SETTINGS, {"source": "test"})
    record = read_attributes(path)
    assert record["source"] == "test"
    assert (record["spectral_radius"], record["input_scaling"]) == (0.7, 1.3)
    assert (record["neurons"], record["seed"], record["random_seed"]) == (40, 2, 2022)
    assert record["solver"] in ("cholesky", "ldl")
    assert path.stat().st_size < 40_000


def test_a_forecaster_has_its_bound(network, tmp_path):
    write_network(tmp_path / "network.nc", network, SETTINGS, {})
    outputs = np.full((2, 4, 1), 3.0) * network.input_range[:, np.newaxis]
    for bound, lost in ((2.0, True), (4.0, False)):
        forecaster = read_forecaster(tmp_path / "network.nc", "scipy", bound)
        assert forecaster.diverged(outputs).tolist() == [lost]
    assert read_forecaster(tmp_path / "network.nc", "scipy").diverged(outputs).tolist() == [False]


def test_unknown_kernels_are_refused(network, tmp_path):
    write_network(tmp_path / "network.nc", network, SETTINGS, {})
    with pytest.raises(ValueError, match="kernel"):
        read_network(tmp_path / "network.nc", "fortran")
