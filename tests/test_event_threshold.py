"""Thresholds as quantiles, and their way into the settings of a job."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from burstcast.data.event_threshold import threshold_at
from burstcast_workflow.harness.settings import cases_of_thresholds, with_thresholds


@given(st.lists(st.floats(-1e6, 1e6), min_size=2, unique=True), st.floats(0.01, 0.99))
def test_the_share_below_is_the_quantile(values, quantile) -> None:
    observable = np.array(values).reshape(1, -1)
    try:
        threshold = threshold_at(quantile, observable)
    except ValueError:  # neighbouring floats
        return
    below = (observable < threshold).sum()
    assert abs(below - quantile * (len(values) - 1)) <= 1 + 1e-9 * len(values)


def test_known_quantiles() -> None:
    assert threshold_at(0.95, np.arange(101.0)) == 95.0
    assert threshold_at(0.5, -np.arange(5.0)) == -2.0


@pytest.mark.parametrize(
    ("quantile", "observable", "message"),
    [
        (1.0, np.arange(3.0), "between 0 and 1"),
        (0.5, np.array([]), "finite samples"),
        (0.5, np.array([1.0, np.nan]), "finite samples"),
        (0.5, np.array([0.0, 1.0, 1.0, 1.0]), r"no sample is above the quantile 0\.5"),
    ],
)
def test_what_has_no_threshold(quantile, observable, message) -> None:
    with pytest.raises(ValueError, match=message):
        threshold_at(quantile, observable)


def test_values_replace_quantiles_wherever_they_are() -> None:
    unknown = {"case": "a", "quantile": 0.9}
    settings = {
        "case.event_threshold": unknown,
        "cases": [
            {
                "identity": {"case": "b"},
                "settings": {"case.event_threshold": {**unknown, "case": "b"}},
            },
            {"identity": {"case": "c"}, "settings": {"case.event_threshold": 3.0}},
        ],
        "quantile": 0.5,
    }
    assert list(cases_of_thresholds(settings)) == ["a", "b"]
    known = with_thresholds(settings, {"a": 1.5, "b": 2.5}.get)
    assert known["case.event_threshold"] == 1.5
    found = [record["settings"]["case.event_threshold"] for record in known["cases"]]
    assert found == [2.5, 3.0]
    assert (known["quantile"], list(cases_of_thresholds(known))) == (0.5, [])
