"""Forecasters, their training series and their searches as jobs make, read and write them."""

import numpy as np
import pytest
from helpers_configs import computed_files

from burstcast.base.files.netcdf import Variable, read_attributes
from burstcast.base.names import parsed
from burstcast.forecasters._limits import TrainingLimits
from burstcast.forecasters.esn import NetworkForecaster
from burstcast.forecasters.registry import make_kind, options_of_kind
from burstcast.networks.dynamics import Dynamics
from burstcast.networks.network import EchoStateNetwork
from burstcast.networks.training import train
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.parameters import SHARE
from burstcast_workflow.harness.storage import write_json, write_netcdf
from burstcast_workflow.jobs.forecasters import Observing, seen, seen_rows, write_forecaster
from burstcast_workflow.jobs.forecasts import Horizons
from burstcast_workflow.jobs.networks import Networks

IDENTIFIER = "esn-N40-RV-seed2"
SETTINGS = {
    "case.system": "lorenz63",
    "case.parameters": {"rho": 30},
    "case.ensemble.time_step": 0.01,
    "case.ensemble.sampling_stride": 4,
    "case.training.series": 3,
    "case.training.noise": 0.01,
    "random_seed": 2022,
    "forecasters.esn.connectivity": 6,
    "forecasters.esn.input_bias": 0.1,
    "forecasters.esn.input_range": "all",
    "forecasters.esn.input_offset": "none",
}
SECTIONS = {
    "esn": {"backend": "scipy"},
    "observation": {"noise": 0.01},
    "filter": {"members": 20, "inflation": 1.0},
    "quadratic": {"window_lt": 0.2, "degree": 2},
    "analogues": {"neighbours": 5},
    "nvar": {"lags": 2, "ridge": 0.01},
}


@pytest.fixture(autouse=True)
def directory(tmp_path, monkeypatch):
    """A directory with the unit of time and the event threshold of the case."""
    computed_files(
        tmp_path, sampling_interval=0.04, steps_per_lyapunov_time=27, event_threshold=38.0
    )
    monkeypatch.chdir(tmp_path)


FILES = {name: f"{name}.json" for name in ("time_unit", "event_threshold")}


def networks(settings=SETTINGS, case="lorenz"):
    return Networks(settings, {"case": case, "forecaster": IDENTIFIER}, files=FILES)


def job(settings=SETTINGS, case="lorenz", forecaster=IDENTIFIER):
    options: dict = {"forecaster.options": options_of_kind(parsed(forecaster).kind, SECTIONS)}
    options["forecaster.divergence_bound"] = 10.0
    identity = {"case": case, "forecaster": forecaster}
    return Observing({**options, **settings}, identity, files=FILES)


def forecasting(settings=SETTINGS, forecaster=IDENTIFIER):
    return job(settings, forecaster=forecaster).forecasting


def test_without_actuation_the_share_of_the_actuator_is_zero():
    known = forecasting().system.forecaster_parameters([SHARE])
    assert (known.names, known.defaults) == ((SHARE,), (0.0,))


@pytest.fixture
def ensemble(tmp_path):
    path, axes = tmp_path / "ensemble.nc", ("series", "time", "component")
    states = np.random.default_rng(1).normal(size=(7, 90, 3)).cumsum(axis=1)
    variables = {
        "series": Variable(("series",), np.arange(7), "1", "number"),
        "state": Variable(axes, states, "1", "state", chunks=(1, 90, 3)),
    }
    write_netcdf(path, variables, {})
    return path


@pytest.fixture
def network(ensemble):
    """A trained network, as the job that trains makes it."""
    training = networks().learnt(ensemble)
    seed = networks().reservoir_seed(IDENTIFIER)
    dynamics = Dynamics(seed.reservoir(3), 0.7, 1.3, "scipy")
    readout = train(dynamics, training, washout=10, tikhonov=1e-6)
    return NetworkForecaster(
        divergence_bound=np.inf,
        backend="scipy",
        network=EchoStateNetwork(dynamics, readout, training.input_range),
        seed=seed,
    )


def test_a_network_is_restored_with_the_bound_and_the_backend_that_the_job_is_told(
    network, tmp_path
):
    path = tmp_path / "forecaster.nc"
    extent = network.network.input_range
    limits = TrainingLimits(-0.5 * extent, 0.5 * extent)
    write_forecaster(str(path), network, {"source": "test"}, limits)
    record = read_attributes(path)
    assert record["source"] == "test"
    assert (record["neurons"], record["seed"], record["random_seed"]) == (40, 2, 2022)
    assert path.stat().st_size < 40_000  # no big matrix
    # what training told of it is kept
    back = forecasting().read_forecaster(str(path))
    assert back.seed == network.seed
    for name in ("tikhonov", "solver", "reciprocal_condition"):
        assert getattr(back.network.readout, name) == getattr(network.network.readout, name)
    outputs = np.full((2, 3, 1), 3.0) * network.network.input_range[:, np.newaxis]
    for bound, lost in ((2.0, True), (4.0, False)):
        told = forecasting({**SETTINGS, "forecaster.divergence_bound": bound})
        assert told.read_forecaster(str(path)).diverged(outputs).tolist() == [lost]
    assert network.diverged(outputs).tolist() == [False]
    with pytest.raises(ValueError, match="backend"):
        forecasting({**SETTINGS, "forecaster.options": {"backend": "fortran"}}).read_forecaster(
            str(path)
        )


def test_what_forecasters_may_know_of_their_case_and_their_options():
    case = forecasting().forecasting_case()
    assert (case.system.rho, case.system.dimension) == (30, 3)
    assert (case.time_step, case.sampling_stride, case.steps_per_lyapunov_time) == (0.01, 4, 27)
    assert (case.random_seed, case.parameters, case.source, case.maps) == (2022, None, None, None)
    # the equations of encoded states
    source = {"system": "lorenz63", "parameters": {"rho": 31}}
    case = forecasting({**SETTINGS, "forecaster.source": source}).forecasting_case()
    assert case.source == Lorenz63(rho=31)
    filtered = forecasting(forecaster="quadratic_filtered").unfitted()
    assert filtered.options == SECTIONS["observation"] | SECTIONS["filter"] | SECTIONS["quadratic"]
    given = {**SETTINGS, "forecaster.options": {"neighbours": 3, "lags": 2}}
    with pytest.raises(ValueError, match="'analogues' has no option 'lags'"):
        forecasting(given, "analogues").unfitted()


def test_only_the_bound_is_given_the_truth_and_aware_kinds_the_inputs():
    observed, true, inputs = np.zeros((2, 4, 3)), np.ones((2, 4, 3)), np.full((2, 9, 1), 5.0)
    for kind, expected, shape in (
        ("equations", true, (2, 10, 4)),
        ("equations_filtered", observed, (2, 10, 4)),
        ("esn_true_washout", true, (2, 4, 3)),
        ("esn", observed, (2, 4, 3)),
    ):
        forecaster = make_kind(kind, {})
        assert seen(forecaster, observed, true) is expected
        given = seen(forecaster, observed, true, inputs)
        assert given.shape == shape
        np.testing.assert_array_equal(given[:, :4, :3], expected)
        np.testing.assert_array_equal(given[..., 3:], 5.0)


def test_who_learns_from_noise_and_who_sees_the_truth_reads_none(ensemble):
    kinds = ("equations", "esn", "esn_true_washout", "equations_noisy")
    truth, esn, same, noisy = (make_kind(kind, {}) for kind in kinds)
    states = job().observed.training.states(str(ensemble))
    learnt = networks().learnt(ensemble).observed
    np.testing.assert_array_equal(job().learnt_rows(truth, str(ensemble)), states)
    np.testing.assert_array_equal(job().learnt_rows(esn, str(ensemble)), learnt)
    np.testing.assert_array_equal(job().learnt_rows(same, str(ensemble)), learnt)
    unread = {key: value for key, value in SETTINGS.items() if key != "case.training.noise"}
    assert seen_rows(truth, job(unread).observed, str(ensemble), 0, states) is states
    seen_by_others = seen_rows(noisy, job().observed, str(ensemble), 0, states)
    assert 0 < np.abs(seen_by_others - states).max() < 1


def test_a_forecast_may_be_wrong_by_a_share_of_the_thresholds_distance_from_the_mean(tmp_path):
    write_json(tmp_path / "statistics.json", {"mean_observable": 23.5})
    settings = {"washout_lt": 0.4, "horizon.tolerance": 0.2}
    settings |= {"horizon.longest_lead_time_lt": 10, "horizon.lead_time_step_lt": 0.5}
    made = Horizons(settings, {"case": "lorenz", "forecaster": IDENTIFIER}, files=FILES)
    search = made.search(tmp_path / "statistics.json")
    assert search.largest_error == pytest.approx(0.2 * (38.0 - 23.5))
    assert (search.longest_lead_time_lt, search.lead_time_step_lt) == (10, 0.5)
