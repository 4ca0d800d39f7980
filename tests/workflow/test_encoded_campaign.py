"""Campaigns of a flow that sensors see and encoders encode: from the config to the ranking."""

import copy
import dataclasses
import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml
from helpers_rebuilds import Project, tiny_with
from sklearn.metrics import average_precision_score

from burstcast import random_streams
from burstcast.files.netcdf import read_attributes, read_netcdf
from burstcast.files.tables import read_table
from burstcast.systems.kolmogorov import KolmogorovFlow
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.config.loading import ConfigError, load

ROOT = Path(__file__).parents[2]
OVERLAY = yaml.safe_load((ROOT / "tests" / "workflow" / "tiny_encoded.yaml").read_text())
FLOW = KolmogorovFlow(40.0, 4, 4)
TARGETS = (
    "tables/ranking.csv",
    "tables/dataset.csv",
    "tables/control_strategies.csv",
    "figures/forecast_skill_sensors.png",
)


def config(change=None):
    """The tiny campaign of these tests with a change."""
    return tiny_with(OVERLAY, change or {})


# -- mistakes, told before any job -----------------------------------------------------------------


def case(name, **changes):
    return {"cases": {name: changes}}


def controlled(strategy, kind, observed="invariants", conditions=None, **settings):
    """Control of the flow by forecasters of its invariants."""
    block = {
        "strategy": strategy,
        "settings": {"decision_interval_lt": [0.5], **settings},
        "observed": [observed],
        "forecasters": {kind: {}},
    }
    return {"control": {"strategies": [block | (conditions or {})]}}


@pytest.mark.parametrize(
    ("change", "parts"),
    [
        (case("sensors_pod", encoder={"modes": 81}), ["case sensors_pod", "from 1 to 80"]),
        (
            case("invariants", encoder={"kind": "invariant"}),
            ["encoder.kind is invariant; the encoders are"],
        ),
        (
            {
                **case("modes", data={"case": "Re400"}, encoder={"kind": "invariants"}),
                "campaign": [
                    *OVERLAY["campaign"],
                    {"reynolds": [400], "cases": ["modes"], "forecasters": {"persistence": {}}},
                ],
            },
            ["case modes: sensors, encoder: MoehlisFaisstEckhardt has no invariants to encode"],
        ),
        (
            {
                "campaign": [
                    *OVERLAY["campaign"],
                    {"cases": ["invariants"], "forecasters": {"equations_filtered": {}}},
                ]
            },
            ["the encoder invariants cannot be decoded", "(equations_filtered)"],
        ),
        (
            case("sensors_pod", data={"delays": [2]}),
            ["data.delays means nothing beside sensors or an encoder"],
        ),
        (case("turbulence", sensors={}), ["sensors and encoder are for cases of another case's"]),
        (case("sensors_pod", training={"noise": 0}), ["training.noise is 0"]),
        (case("turbulence", lyapunov={"series": 7}), ["lyapunov.series is 7; it must be at most"]),
        (
            controlled("receding_horizon", "precursor", horizon_lt=[1]),
            ["control.strategies[0].forecasters names precursor", "forecasts no states"],
        ),
        (
            controlled("probability_triggered", "esn", probability=[0.2], hold_lt=[1]),
            [
                "control.strategies[0].forecasters names esn",
                "takes classifiers: esn_direct, precursor",
            ],
        ),
        (
            controlled(
                "probability_triggered", "precursor", probability=[0.2], hold_lt=[1], windows=[4]
            ),
            ["control.strategies[0].settings.windows: classifiers have 3"],
        ),
        (case("sensors", sensors={"points": [8, 21]}), ["points[1] is 21", "not above 20"]),
        (
            case("invariants", encoder={"modes": 5}),
            ["encoder.modes is no option of the encoder invariants"],
        ),
        (
            {
                "cases": {
                    "turbulence": {"parameters": {"largest_wavenumber": 10}},
                    "sensors_pod": {"encoder": {"modes": 364}},
                },
            },
            ["case sensors_pod: sensors, encoder: encoder.modes is 364", "have 363 snapshots"],
        ),
        (
            case("sensors", training={"noise": 0}),
            ["case sensors: sensors, encoder: training.noise"],
        ),
        (
            case("turbulence", parameters={"largest_wavenumber": 3.5}),
            ["case turbulence: system or parameters: largest_wavenumber must be a positive whole"],
        ),
        (
            case("turbulence", actuation={"parameters": {"largest_wavenumber": 5}}),
            ["actuation: an actuation must leave the number of components", "80, not make it 120"],
        ),
        (
            controlled(
                "receding_horizon",
                "equations_filtered",
                "sensors",
                {"strength": [1, 3]},
                horizon_lt=[1],
            ),
            ["case turbulence: actuation: at a strength of 3, reynolds must be positive"],
        ),
        (
            controlled("probability_triggered", "precursor", probability=[0.2]),
            ["control.strategies[0].settings: strategy", "needs the setting 'hold_lt'"],
        ),
        (
            controlled("receding_horizon", "equations_filtered", horizon_lt=[1]),
            ["strategies[0].forecasters: the campaign has no equations_filtered for invariants"],
        ),
        (
            {
                **controlled("receding_horizon", "equations_filtered", "sensors", horizon_lt=[1]),
                **case("turbulence", actuation=None),
            },
            ["strategies[0].observed: sensors is a part of turbulence, which this block does not"],
        ),
        ({"forecasters": {"filter": {"members": 5}}}, ["is 5; it must be an even number above 0"]),
        (case("sensors", ensemble={"series": 10}), ["case sensors: ensemble means nothing for"]),
        (
            case("sensors", actuation={"parameters": {"reynolds": 20}}),
            ["case sensors: actuation means nothing for measured series"],
        ),
        (
            {
                "campaign": [{"cases": ["turbulence"], "forecasters": {"persistence": {}}}],
                "control": {"strategies": []},
                **case("turbulence", data={"known": ["a_1_0"]}),
            },
            ["case turbulence: data needs files: [...], or else the name of another case"],
        ),
    ],
)
def test_a_mistake_is_told_before_any_job(change, parts):
    with pytest.raises(ConfigError) as caught:
        load(config(change))
    assert len(caught.value.problems) == 1, caught.value.problems
    assert [part for part in parts if part not in str(caught.value)] == []


def test_channels_are_known_beforehand():
    campaign = Campaign(load(config()))
    assert {name: campaign.space(name).dimension for name in campaign.cases} == {
        "turbulence": 80,
        "sensors": 49,
        "invariants": len(FLOW.invariant_names) + 1,
        "sensors_pod": 9,
    }
    components = campaign.cases["invariants"].parameters["components"]
    assert components == list(FLOW.invariant_names)


# -- a run -----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def results(tmp_path_factory, job_server):
    project = Project.create(tmp_path_factory.mktemp("encoded") / "project", job_server)
    directory = OVERLAY["results"]
    targets = [f"{directory}/{one}" for one in TARGETS]
    outcome = project.snakemake(*targets, overlay=copy.deepcopy(OVERLAY))
    assert outcome.status == 0, outcome.text[-3000:]
    return project.directory / directory


def test_noise_comes_before_the_encoder(results):
    """Channels of the noisy state, noise and all made again from the name of its stream."""
    whole, encoded = (
        read_netcdf(results / case / "ensemble.nc") for case in ("turbulence", "invariants")
    )
    scales = whole["state"][:3].reshape(-1, 80).std(axis=0)
    for row in (0, 4):
        generator = random_streams.stream(2022, "noise", "turbulence", row)
        states = whole["state"][row]
        seen = states + 0.01 * scales * generator.standard_normal(states.shape)
        np.testing.assert_allclose(
            encoded["observed"][row, :, :-1].T, FLOW.invariants(seen.T), atol=1e-12
        )
        np.testing.assert_allclose(
            encoded["state"][row, :, :-1].T, FLOW.invariants(states.T), atol=1e-12
        )
    np.testing.assert_array_equal(encoded["state"][..., -1], whole["observable"])
    error = (encoded["observed"] - encoded["state"])[..., -1]
    assert error.std() == pytest.approx(0.01 * whole["observable"][:3].std(), rel=0.1)


def errors(results, case, forecaster):
    """Errors of the largest dissipation in the first window."""
    truth = read_netcdf(results / case / "evaluation_set.nc", "largest")["largest"]
    found = read_netcdf(results / case / forecaster / "forecast.nc", "largest")["largest"]
    return np.abs(found - truth)[:, 0].mean()


def test_the_filter_sees_more_than_the_linear_estimate_and_modes_less(results):
    assert errors(results, "turbulence", "equations") == 0
    filtered = errors(results, "sensors", "equations_filtered")
    assert filtered < errors(results, "sensors", "equations_noisy")
    assert errors(results, "turbulence", "equations_noisy") < errors(
        results, "sensors_pod", "equations_noisy"
    )


def test_ranking_by_other_means(results):
    """Average precision of onsets and of any time above the threshold, by scikit-learn."""
    table = read_table(results / "tables" / "ranking.csv")
    assert set(table["case"]) == {"turbulence", "sensors", "invariants", "sensors_pod"}
    points = read_netcdf(results / "turbulence" / "evaluation_set.nc")
    forecast = read_netcdf(results / "turbulence" / "equations_noisy" / "forecast.nc")
    found = json.loads((results / "turbulence" / "event_threshold.json").read_text())
    level = found["event_threshold"]
    here = points["washout_maximum"] < level
    for time, first in ((1, 1), (2, 3)):
        window = slice(first, first + 2)
        true, found = (one["largest"][here][:, window].max(axis=1) for one in (points, forecast))
        begins, foreseen = (one["first"][here][:, first] < level for one in (points, forecast))
        ranked = np.where(foreseen, found, found[foreseen].mean())
        expected = {
            "onset": average_precision_score(begins & (true >= level), ranked),
            "any": average_precision_score(true >= level, found),
        }
        for event, value in expected.items():
            keys = {
                "case": "turbulence",
                "alarm": "equations_noisy",
                "event": event,
                "prediction_time_lt": time,
                "metric": "average_precision",
            }
            row = table[(table[list(keys)] == pd.Series(keys)).all(axis=1)]
            assert row["value"].item() == pytest.approx(value)
            assert row["low"].item() <= value <= row["high"].item()
    alarms = set(table[table["case"] == "turbulence"]["alarm"])
    assert {"published_precursor", "observable_now", "equations"} <= alarms
    assert "published_precursor" not in set(table[table["case"] == "invariants"]["alarm"])


def test_control_through_sensors_and_encoders(results):
    """Exceedance of each run, from the observables of its flows."""
    table = read_table(results / "tables" / "control_strategies.csv")
    table = table[table["metric"] == "exceedance_controlled"]
    found = dict(zip(table["forecaster"], table["observed"].fillna(""), strict=True))
    assert found == {"equations": "", "equations_filtered": "sensors", "precursor": "invariants"}
    uncontrolled = []
    for forecaster in found:
        (path,) = (results / "turbulence" / "control" / forecaster).iterdir()
        flows, span = read_netcdf(path / "flows.nc"), read_attributes(path / "flows.nc")
        row, steps = table[table["forecaster"] == forecaster], span["steps"]
        assert row["value"].item() == pytest.approx(flows["exceeding_controlled"].mean() / steps)
        uncontrolled.append(flows["exceeding_uncontrolled"].tolist())
        acting = flows["actuated_integration_steps"].mean() / span["integration_steps"]
        assert 0 < acting < 1
    assert uncontrolled == [uncontrolled[0]] * 3


def test_the_flow_is_that_of_the_case():
    found = Campaign(load(config())).source_system("sensors")
    assert KolmogorovFlow(**found["parameters"]) == dataclasses.replace(FLOW)
