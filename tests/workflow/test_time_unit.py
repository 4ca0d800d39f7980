import pytest

from burstcast_workflow.storage import write_json
from burstcast_workflow.time_unit import read_steps_per_lyapunov_time


def settings(known, interval=1.0):
    return {"steps_per_lyapunov_time": known, "sampling_interval": interval}


def computed(tmp_path, exponent):
    path = tmp_path / "lyapunov.json"
    write_json(path, {"leading": {"mean": exponent, "low": 0.001, "high": 9}})
    return path


def test_the_config_is_believed_without_a_file():
    assert read_steps_per_lyapunov_time(settings(61), []) == 61


@pytest.mark.parametrize(
    ("exponent", "interval", "steps"), [(0.0155, 1, 64), (0.9, 0.02, 55), (0.1, 0.1, 100)]
)
def test_the_computed_exponent(tmp_path, exponent, interval, steps):
    path = computed(tmp_path, exponent)
    assert read_steps_per_lyapunov_time(settings(None, interval), path) == steps
    assert read_steps_per_lyapunov_time(settings(7, interval), path) == 7


@pytest.mark.parametrize(
    ("exponent", "reason"), [(-0.01, "must be positive"), (0, "positive"), (2, "shorter than one")]
)
def test_an_exponent_without_a_time_unit_names_the_settings(tmp_path, exponent, reason):
    with pytest.raises(ValueError, match=rf"{reason}.*lyapunov\.published_exponent"):
        read_steps_per_lyapunov_time(settings(None), computed(tmp_path, exponent))
