"""How validation strategies are found, and the folds that they lay out."""

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
from burstcast.tuning.strategies.single_shot import SingleShotValidation

PLAN = ValidationPlan(washout=5, interval=10, series=2, intervals=3)


def test_strategies_are_found_by_their_names():
    assert available_strategies() == ["RV", "SSV"]
    assert isinstance(make_strategy("RV"), RecycleValidation)
    assert strategy_module("RV") == "burstcast.tuning.strategies.recycle"


def test_unknown_strategies_are_refused():
    with pytest.raises(ValueError, match=r"unknown validation strategy 'SV' .*mean 'SSV'.* RV, SS"):
        make_strategy("SV")


def test_a_name_belongs_to_one_strategy(monkeypatch):
    monkeypatch.setattr(SingleShotValidation, "name", "RV")
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
