"""How strategies are found, and what the walk forward leaves out."""

from dataclasses import replace

import pytest

from burstcast.tuning.strategies import base, registry
from burstcast.tuning.strategies.base import ValidationPlan, use_of_series
from burstcast.tuning.strategies.recycle import RecycleValidation
from burstcast.tuning.strategies.registry import (
    available_strategies,
    make_strategy,
    strategy_module,
)
from burstcast.tuning.strategies.walk_forward import WalkForwardValidation

PLAN = ValidationPlan(washout=5, interval=10, series=2, intervals=3)


def test_strategies_are_found_by_their_names():
    assert available_strategies() == ["RV", "SSV", "WFV"]
    assert isinstance(make_strategy("RV"), RecycleValidation)
    assert strategy_module("WFV") == "burstcast.tuning.strategies.walk_forward"


def test_unknown_strategies_are_refused():
    with pytest.raises(ValueError, match=r"unknown validation strategy 'SV' .*mean 'SSV'.* RV, SS"):
        make_strategy("SV")


def test_a_name_belongs_to_one_strategy(monkeypatch):
    monkeypatch.setattr(WalkForwardValidation, "name", "RV")
    with pytest.raises(TypeError, match="both define 'RV'"):
        available_strategies()


@pytest.mark.parametrize("name", available_strategies())
def test_folds_never_train_on_a_step_twice_and_keep_within_the_series(name):
    series, length = 4, 40
    folds = make_strategy(name).folds(PLAN, series, length)
    assert folds
    for fold in folds:
        rows = [row for block in fold.trained for row in block.series]
        assert len(rows) == len(set(rows))
        assert set(rows) <= set(range(series))
        assert all(PLAN.washout < block.stop <= length for block in fold.trained)
        assert all(PLAN.washout <= start <= length - PLAN.interval for start in fold.starts)


def test_the_walk_forward_knows_the_past_of_its_series_and_all_of_the_others():
    folds = WalkForwardValidation().folds(PLAN, 4, 40)
    assert [(fold.series[0], *fold.starts) for fold in folds] == [
        (row, start) for row in (0, 1) for start in (5, 15, 25)
    ]
    for fold in folds:
        stops = {row: block.stop for block in fold.trained for row in block.series}
        own = stops.pop(fold.series[0], PLAN.washout)
        assert own == fold.starts[0]
        assert len(stops) == 3
        assert set(stops.values()) == {40}


def test_the_walk_forward_in_one_series_starts_with_its_second_interval():
    plan = ValidationPlan(washout=5, interval=10, series=1, intervals=3)
    folds = WalkForwardValidation().folds(plan, 1, 40)
    assert [fold.starts for fold in folds] == [(15,), (25,)]
    with pytest.raises(ValueError, match="nothing to train on"):
        WalkForwardValidation().folds(ValidationPlan(5, 10, 1, 1), 1, 40)


def test_use_of_a_series():
    assert use_of_series(make_strategy("SSV").folds(PLAN, 4, 40), 0) == (30, [30])
    assert use_of_series(make_strategy("SSV").folds(PLAN, 4, 40), 1) == (30, [])
    assert use_of_series(make_strategy("RV").folds(PLAN, 4, 40), 1) == (40, [5, 15, 25])
    assert use_of_series([], 1) == (0, [])  # neither trained on nor validated


def test_the_interface_is_no_strategy():
    assert base.ValidationStrategy not in registry._classes().values()


def test_the_single_shot_may_start_within_the_training_data():
    (own,) = make_strategy("SSV").folds(PLAN, 4, 40)
    (authors,) = make_strategy("SSV").folds(replace(PLAN, single_shot_lead=1), 4, 40)
    assert (own.starts, authors.starts) == ((30,), (29,))
    assert own.trained == authors.trained
    with pytest.raises(ValueError, match="leave nothing to train on"):
        make_strategy("SSV").folds(replace(PLAN, single_shot_lead=25), 4, 40)
