"""Campaigns with forecasters that know the parameters: from the config to control that plans."""

import numpy as np
import pytest
import yaml
from helpers_rebuilds import ROOT, Project

from burstcast.base.files.netcdf import read_netcdf
from burstcast.base.files.tables import read_table

# control and forecasters that know parameters have tests in their rooms
pytestmark = pytest.mark.long
OVERLAY = yaml.safe_load((ROOT / "tests" / "workflow" / "tiny_aware.yaml").read_text())
TARGETS = (
    "Re600/tables/control_strategies.csv",
    "Re600/tables/control_choices.csv",
    "Re600/models/quadratic_aware/calibration_forecast.nc",
    "Re400switched/tables/classification.csv",
    "figures/control_frontier_Re600.png",
    "figures/skill_by_parameter.png",
    "Re400/tables/control_choices.csv",
    "figures/return_levels_Re600.png",
)


# -- a run -----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def results(tmp_path_factory, job_server):
    project = Project.create(tmp_path_factory.mktemp("aware") / "project", job_server)
    directory = OVERLAY["results"]
    project.made(*(f"{directory}/{name}" for name in TARGETS), overlay=OVERLAY)
    return project.directory / directory


def test_the_schedule_is_stored_with_the_series(results):
    free, switched = (
        read_netcdf(results / case / "scheduled_series.nc") for case in ("Re400", "Re800")
    )
    assert free["parameter"].shape == (3, 400, 1)
    assert free["state"].shape == (3, 401, 9)
    assert np.unique(free["parameter"]).tolist() == [400]
    assert np.unique(switched["parameter"]).tolist() == [800, 2000]
    assert 0.1 < (switched["parameter"] == 2000).mean() < 0.6
    noise = free["observed"] - free["state"]
    scatter = free["state"].reshape(-1, 9).std(axis=0)
    np.testing.assert_allclose(noise.reshape(-1, 9).std(axis=0), 0.01 * scatter, rtol=0.1)


def test_a_network_of_an_unseen_case_has_the_hyperparameters_of_the_first_it_is_trained_on(results):
    identifier = "esn_aware-N40-RV-seed0"
    assert (results / "Re400" / "networks" / identifier / "hyperparameters.json").exists()
    assert not (results / "Re600" / "networks" / identifier / "hyperparameters.json").exists()
    forecaster = read_netcdf(results / "Re600" / "networks" / identifier / "forecaster.nc")
    assert forecaster["parameter_low"].tolist() == [400]
    assert forecaster["parameter_high"].tolist() == [2000]


def test_control_says_what_it_was_told_and_what_it_cost(results):
    table = read_table(results / "Re600" / "tables" / "control_strategies.csv")
    planned = table[table["strategy"] == "planned"]
    learnt = planned[planned["forecaster"] != "equations"]
    assert set(learnt["options"]) == {"durations_lt=0.25+0.5 starts_lt=0+0.5"}
    assert set(planned["forecaster"]) == {"esn_aware", "quadratic_aware", "equations"}
    assert set(table[table["strategy"] == "reactive"]["options"]) == {"watch=a1"}
    keys = ["forecaster", "strategy", "margin", "delay_lt"]
    wide = table.pivot_table(index=keys, columns="metric", values="value", dropna=False).dropna(
        how="all"
    )
    for metric in ("effort", "power"):
        assert ((wide[metric] > 0) == (wide["control_fraction"] > 0)).all()


def test_long_runs_have_return_times_of_each_level(results):
    table = read_table(results / "Re600" / "tables" / "return_times.csv")
    assert sorted(set(table["strategy"])) == ["planned", "uncontrolled"]
    assert sorted(set(table["return_level"])) == [0.07, 0.1, 0.2]
    free = table[table["strategy"] == "uncontrolled"]
    assert (free["control_fraction"] == 0).all()
    assert (table["lyapunov_times"] <= 6.5 * table["flows"]).all()
    seen = table[table["events"] > 0]
    np.testing.assert_allclose(seen["return_time"], seen["lyapunov_times"] / seen["events"])
    assert (seen["return_time_low"] < seen["return_time"]).all()
    assert table.loc[table["events"] == 0, "return_time"].isna().all()


def test_choices_are_the_cheapest_runs_of_half_of_the_flows_scored_on_the_others(results):
    table = read_table(results / "Re600" / "tables" / "control_choices.csv")
    table = table[(table["forecaster"] == "esn_aware") & (table["strategy"] == "receding_horizon")]
    assert set(table["candidates"]) == {2}
    for delay, rows in table.groupby("delay_lt"):
        ending = f"-delay{delay:g}" if delay else ""
        runs = {}
        for margin in ("0", "0.01"):
            plan = f"receding_horizon-awareTrue-decision_interval0.5-horizon2-margin{margin}"
            place = results / "Re600" / "control" / "esn_aware-N40-RV-seed0" / f"{plan}{ending}"
            runs[float(margin)] = read_netcdf(place / "flows.nc")
        ranks = {}
        for margin, flows in runs.items():
            kept = flows["row"] % 2 == 0
            assert (flows["laminar_step_controlled"] < 0).all()
            left = flows["exceeding_controlled"][kept].sum() / max(
                1, flows["exceeding_uncontrolled"][kept].sum()
            )
            effort = flows["effort"][kept].mean()
            ranks[margin] = (left > 0.01, effort if left <= 0.01 else left, margin)
        chosen = min(ranks, key=ranks.__getitem__)
        assert set(rows["margin"]) == {chosen}
        scored = runs[chosen]["row"] % 2 == 1
        values = rows.set_index("metric")["value"]
        assert values["effort"] == pytest.approx(runs[chosen]["effort"][scored].mean())
        assert set(rows["scored_flows"]) == {scored.sum()}


def test_equations_that_are_told_of_the_switching_actuator_are_never_wrong(results):
    truth = read_netcdf(results / "Re400switched" / "evaluation_set.nc")
    assert np.unique(truth["parameter"]).tolist() == [400, 2000]
    of_equations = read_netcdf(results / "Re400switched/models/equations" / "forecast.nc")
    np.testing.assert_array_equal(of_equations["largest"], truth["largest"])
    # forecasts that are told of another actuation are other ones
    parameter = truth["parameter"][:, truth["washout"].shape[1] - 1 :]
    acting = (parameter == 2000).any(axis=(1, 2))
    untold = read_netcdf(results / "Re400switched/models/quadratic_filtered" / "forecast.nc")
    filtered = read_netcdf(results / "Re400switched/models/equations_filtered" / "forecast.nc")
    errors = [
        np.abs(forecast["largest"][acting, 0] - truth["largest"][acting, 0]).mean()
        for forecast in (filtered, untold)
    ]
    assert errors[0] < errors[1]


def test_equations_that_are_told_leave_no_event(results):
    (plan,) = (results / "Re600" / "control" / "equations").iterdir()
    flows = read_netcdf(plan / "flows.nc")
    assert flows["events_uncontrolled"].sum() > 0 == flows["events_controlled"].sum()
    assert flows["actuated_integration_steps"].sum() > 0


def test_control_that_observes_four_quantities_sees_no_more(results):
    run = "receding_horizon-decision_interval0.5-horizon2"
    place = results / "Re400" / "control" / "esn-N40-RV-seed0"
    part, full = (
        read_netcdf(place / name / "flows.nc") for name in (f"{run}-observedmodes_5f4", run)
    )
    # the same flows; another forecaster, that of the part
    np.testing.assert_array_equal(part["row"], full["row"])
    np.testing.assert_array_equal(part["exceeding_uncontrolled"], full["exceeding_uncontrolled"])
    assert not np.array_equal(
        part["actuated_integration_steps"], full["actuated_integration_steps"]
    )
    table = read_table(results / "Re400" / "tables" / "control_choices.csv")
    assert set(table["observed"].dropna()) == {"modes_4"}
