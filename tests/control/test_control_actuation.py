from dataclasses import replace

import numpy as np
import pytest
from helpers_control import PAPER, Rotor

from burstcast.control.actuation import ForcedSystem, actuated_system, actuation_interval
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.integration import integrate
from burstcast.systems.mfe import MoehlisFaisstEckhardt

FLOW = MoehlisFaisstEckhardt(reynolds=400.0)
STATES = np.random.default_rng(0).normal(scale=0.1, size=(9, 5))


def test_interval_of_the_paper_s_control() -> None:
    # 1.5 Lyapunov times of 61 steps are 366 integration steps, although 91.5 steps of the network
    for prediction_time_lt, interval in ((1.0, (0, 366)), (2.0, (244, 610)), (1.5, (122, 488))):
        timing = replace(PAPER, prediction_time_lt=prediction_time_lt)
        assert actuation_interval(timing, -1.0, 1.5) == interval


def test_actuation_before_the_alarm_is_refused() -> None:
    early = replace(PAPER, prediction_time_lt=0.5)
    with pytest.raises(ValueError, match=r"not defined for a prediction time of 0\.5"):
        actuation_interval(early, -1.0, 1.5)
    assert actuation_interval(early, -0.5, 1.5) == (0, 366)


def test_actuation_that_lasts_no_step_is_refused() -> None:
    with pytest.raises(ValueError, match="lasts no step"):
        actuation_interval(PAPER, -1.0, 0.0)


def test_changed_parameter_is_the_system_with_that_parameter() -> None:
    actuated = actuated_system(FLOW, {"reynolds": 2000.0})
    expected = MoehlisFaisstEckhardt(reynolds=2000.0).right_hand_side(STATES)
    np.testing.assert_array_equal(actuated.right_hand_side(STATES), expected)
    assert FLOW.reynolds == 400.0


def test_force_is_added_to_the_changed_system() -> None:
    force = np.arange(9.0)
    actuated = actuated_system(FLOW, {"reynolds": 2000.0}, list(force))
    expected = MoehlisFaisstEckhardt(reynolds=2000.0).right_hand_side(STATES) + force[:, np.newaxis]
    np.testing.assert_array_equal(actuated.right_hand_side(STATES), expected)
    np.testing.assert_array_equal(actuated.observable(STATES), FLOW.observable(STATES))
    assert (actuated.dimension, actuated.observable_symbol) == (9, "k")


def test_jacobian_does_not_know_the_force() -> None:
    forced = ForcedSystem(FLOW, [1.0] * 9)
    np.testing.assert_array_equal(forced.jacobian(STATES), FLOW.jacobian(STATES))


def test_forced_batches_of_more_than_one_are_integrated_like_single_flows() -> None:
    forced: DynamicalSystem = ForcedSystem(Rotor(1.0), [0.3, -0.1])
    states = np.random.default_rng(1).normal(size=(2, 4))
    together = integrate(forced, states, 0.1, 20)
    for flow in range(4):
        alone = integrate(forced, states[:, flow : flow + 1], 0.1, 20)
        np.testing.assert_array_equal(together[:, :, flow : flow + 1], alone)


@pytest.mark.parametrize("force", [[1.0], [np.inf] * 9])
def test_bad_force_is_refused(force: list[float]) -> None:
    with pytest.raises(ValueError, match="9 finite components"):
        actuated_system(FLOW, {}, force)


def test_unknown_parameter_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match=r"renolds.*reynolds"):
        actuated_system(FLOW, {"renolds": 2000.0})


def test_actuation_that_changes_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="changes a parameter"):
        actuated_system(FLOW, {})


def test_parameters_of_a_forced_system_cannot_be_changed() -> None:
    with pytest.raises(ValueError, match="dataclass"):
        actuated_system(ForcedSystem(FLOW, [0.0] * 9), {"reynolds": 2000.0})
