from dataclasses import replace

import pytest
from helpers_control import PAPER


def test_steps_of_the_paper_s_control() -> None:
    assert (PAPER.window_start, PAPER.window_end, PAPER.window_steps) == (61, 122, 61)
    assert PAPER.first_forecast == 29
    assert PAPER.counted_from == 29 + 122
    assert PAPER.counted_until == 29 + 122 + 1220
    assert PAPER.length == 29 + 122 + 1220 + 1


@pytest.mark.parametrize("prediction_time_lt", [1.0, 1.5, 2.0, 2.5])
@pytest.mark.parametrize("window_lt", [0.5, 1.0])
def test_windows_without_an_alarm_leave_no_gap(prediction_time_lt: float, window_lt: float) -> None:
    timing = replace(PAPER, prediction_time_lt=prediction_time_lt, window_lt=window_lt)
    assert timing.window_steps + timing.window_start == timing.window_end


@pytest.mark.parametrize(
    "change", [{"span_lt": 1 / 61}, {"washout": 1}, {"sampling_stride": 1}, {"quiet_lt": 0.0}]
)
def test_one_step_is_enough(change: dict[str, float]) -> None:
    timing = replace(PAPER, **change)  # type: ignore[arg-type]
    assert timing.span_steps >= 1


@pytest.mark.parametrize(
    "change",
    [
        {"prediction_time_lt": 0.0},
        {"window_lt": 0.0},
        {"span_lt": 0.0},
        {"washout": 0},
        {"sampling_stride": 0},
    ],
)
def test_durations_shorter_than_a_step_are_refused(change: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=r"step|input"):
        replace(PAPER, **change)  # type: ignore[arg-type]
