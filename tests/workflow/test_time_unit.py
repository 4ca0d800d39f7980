import pytest

from burstcast_workflow.harness.settings import Settings, exponent_in
from burstcast_workflow.harness.storage import write_json
from burstcast_workflow.jobs.time_unit import lyapunov_time, sampling_interval


def settings(published, time_unit="published", time_step=0.25, stride=4, file=""):
    declared = {
        "case.ensemble.time_step": time_step,
        "case.ensemble.sampling_stride": stride,
        "case.lyapunov.time_unit": time_unit,
        "case.lyapunov.published_exponent": published,
    }
    return Settings(declared, {}, computed_exponent=exponent_in(file))


def computed(tmp_path, exponent):
    path = tmp_path / "lyapunov.json"
    write_json(path, {"leading": {"mean": exponent, "low": 0.001, "high": 9}})
    return str(path)


def test_the_interval_of_the_networks():
    assert sampling_interval(settings(None, time_step=0.01, stride=2)) == 0.02


def test_the_config_is_believed_without_a_file():
    assert lyapunov_time(settings(0.0163)) == 61
    assert lyapunov_time(settings(0.9, time_step=0.01, stride=2)) == 55


@pytest.mark.parametrize(
    ("exponent", "time_step", "stride", "steps"),
    [(0.0155, 0.25, 4, 64), (0.9, 0.01, 2, 55), (0.1, 0.1, 1, 100)],
)
def test_the_computed_exponent(tmp_path, exponent, time_step, stride, steps):
    path = computed(tmp_path, exponent)
    of_steps = {"time_step": time_step, "stride": stride, "file": path}
    assert lyapunov_time(settings(None, **of_steps)) == steps
    # where it sets the unit of time although there is a published one
    assert lyapunov_time(settings(0.01, "computed", **of_steps)) == steps
    published = round(1 / (0.01 * time_step * stride))
    assert lyapunov_time(settings(0.01, **of_steps)) == published != steps


@pytest.mark.parametrize(
    ("exponent", "reason"), [(-0.01, "must be positive"), (0, "positive"), (2, "shorter than one")]
)
def test_an_exponent_without_a_time_unit_names_the_settings(tmp_path, exponent, reason):
    with pytest.raises(ValueError, match=rf"lyapunov\.published_exponent.*: .*{reason}"):
        lyapunov_time(settings(None, file=computed(tmp_path, exponent)))
