"""Which networks a campaign has, and which settings the rules read of it."""

import re
from dataclasses import replace

import pytest
from helpers_configs import campaign, networks, tiny_campaign
from hypothesis import given
from hypothesis import strategies as st

from burstcast.base.names import NETWORK as NETWORKS
from burstcast.base.names import ForecasterName, parsed
from burstcast.forecasters.registry import available_kinds
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.campaign.job_settings import Job, settings_of_cases, settings_of_job
from burstcast_workflow.campaign.loading import load
from burstcast_workflow.campaign.members import CaseForecaster
from burstcast_workflow.config.case import Measured, Simulated
from burstcast_workflow.config.cases import own_modules
from burstcast_workflow.config.model import Choice
from burstcast_workflow.harness.canonical import canonical, canonical_json
from burstcast_workflow.jobs import series
from burstcast_workflow.jobs.networks import Networks
from burstcast_workflow.tables.registry import cases_of, table_names
from kolmogorov_flow import KolmogorovFlow

PAPER = campaign()


def of(case, identifier):
    return CaseForecaster(case, parsed(identifier))


def test_blocks_that_overlap_share_their_forecasters():
    chosen = networks([100, 200], seeds=2) | {"equations": {}, "equations_noisy": None}
    both = {**networks([100], ["RV", "SSV"]), "equations": {}}
    blocks = [
        {"reynolds": [400], "forecasters": chosen},
        {"reynolds": [400, 600], "forecasters": both},
    ]
    shared = campaign({"control": {"forecasters": {"esn": None}}}, blocks=blocks)
    of_400 = ("N100-RV-seed0", "N100-RV-seed1", "N100-SSV-seed0", "N200-RV-seed0", "N200-RV-seed1")
    of_600 = ("N100-RV-seed0", "N100-SSV-seed0")
    assert shared.forecasters == tuple(
        of(case, name)
        for case, others in (("Re400", of_400), ("Re600", of_600))
        for name in ("equations", *(f"esn-{other}" for other in others))
    )


def test_choices_name_kinds_and_may_restrict_their_axes():
    def run_freely(choice):
        chosen = PAPER.chosen(Choice.model_validate(choice))
        return {forecaster.name for forecaster in chosen}

    assert run_freely({}) == run_freely({"esn": None}) == set()
    assert run_freely({"equations": {}}) == {ForecasterName("equations")}
    assert run_freely({"esn": {}}) == {network.name for network in PAPER.networks}
    assert run_freely({"esn": {"neurons": [500], "validation": ["SSV"]}}) == {
        ForecasterName("esn", 500, "SSV", seed) for seed in range(10)
    }
    long_term = {(run.name.kind, run.name.validation) for run in PAPER.long_term_forecasters}
    assert long_term == {("esn", "RV")}


def test_who_controls_in_the_paper():
    runs = PAPER.control_runs
    by_networks = [run for run in runs if run.controller.kind == "esn" and not run.controller.role]
    assert {run.controller for run in by_networks} == {
        ForecasterName("esn", 2000, "RV", seed) for seed in range(10)
    }
    assert {run.prediction_time_lt for run in runs} == {1, 2}
    # one run of random alarms for each run of a network, and none for the equations
    assert {run for run in runs if run.controller.role} == {
        replace(run, controller=replace(run.controller, role="random")) for run in by_networks
    }
    assert len([run for run in runs if run.controller.kind == "equations"]) == 4 * 2
    roles = {(run.controller.role, run.controller.keys["forecaster"]) for run in runs}
    assert roles == {(None, "esn"), (None, "equations"), ("random", "random")}
    paper = "prediction_triggered-prediction_time1-window1"
    assert f"Re400/control/esn-N2000-RV-seed3-random/{paper}" in {run.directory for run in runs}
    assert PAPER.strategy_runs == runs
    assert len({canonical_json(run.identity) for run in runs}) == len(runs)
    for run in runs:
        record = settings_of_job(PAPER, ["control.run"], run.identity)["control.run"]
        assert record["settings"]["prediction_time_lt"] == run.prediction_time_lt
        assert f"-prediction_time{run.prediction_time_lt:g}-" in run.identity["strategy"]
        # equations see the truth
        assert ("noise" in record) == (run.controller.kind != "equations")


def test_random_alarms_a_case_and_a_sweep_are_chosen():
    changed = campaign({"control": {"random_alarms": False}})
    without = tuple(run for run in PAPER.control_runs if run.controller.role is None)
    assert changed.control_runs == without
    changed = campaign({"cases": {"Re600": {"actuation": None}}})
    assert {run.case for run in changed.control_runs} == {"Re400", "Re800", "Re1000"}
    swept = campaign({"control": {"sweep": {"cases": ["Re400"], "seeds": 1}}})
    assert set(PAPER.control_runs) < set(swept.control_runs)
    more = set(swept.control_runs) - set(PAPER.control_runs)
    assert {(run.case, run.prediction_time_lt) for run in more} == {
        ("Re400", time) for time in (3, 4, 5)
    }
    controllers = {run.controller.identifier for run in more}
    assert controllers == {"esn-N2000-RV-seed0", "esn-N2000-RV-seed0-random", "equations"}


def test_committees_control_as_one():
    forecasters = {**networks([500, 2000], seeds=3), "quadratic_filtered": {}}
    settings = {"horizon_lt": [2], "decision_interval_lt": [0.25], "vote_share": [0.1, 1]}
    block = {"strategy": "receding_horizon", "settings": settings, "cases": ["Re400"]}
    block |= {"forecasters": {"esn": {"neurons": [2000]}, "quadratic_filtered": {}}}
    strategies = {"control": {"strategies": [{**block, "committee": True}]}}
    voting = campaign(strategies, blocks=[{"reynolds": [400, 600], "forecasters": forecasters}])
    runs = set(voting.strategy_runs) - set(voting.control_runs)
    plan = "receding_horizon-decision_interval0.25-horizon2-vote_share"
    assert {run.directory for run in runs} == {
        f"Re400/control/{kind}-committee/{plan}{share}"
        for kind in ("esn-N2000-RV", "quadratic_filtered")
        for share in ("0.1", "1")
    }
    for run in runs:
        record = settings_of_job(voting, ["control.run"], run.identity)["control.run"]
        assert run.directory.endswith(f"vote_share{record['settings']['vote_share']:g}")
        assert run.controller.keys["forecaster"] == f"{run.controller.kind}_committee"
    committee = "esn-N2000-RV-committee"
    assert voting.controlling("Re400", committee) == tuple(
        of("Re400", f"esn-N2000-RV-seed{seed}") for seed in range(3)
    )
    (alone,) = voting.controlling("Re400", "quadratic_filtered-committee")
    assert alone.directory == "Re400/models/quadratic_filtered"
    # a job of a committee is about the kind of those who vote
    wildcards = {"case": "Re400", "controller": committee, "strategy": f"{plan}0.1"}
    assert min(runs, key=lambda run: run.directory).identity == wildcards
    assert voting.modules(wildcards)["burstcast.forecasters"] == ["esn"]
    assert settings_of_job(voting, ["control.run"], wildcards)["control.run"]["noise"] == 0.01


def test_a_lyapunov_time_that_is_to_be_computed_is_not_known():
    computed = campaign({"case_defaults": {"lyapunov": {"time_unit": "computed"}}})
    assert computed.cases["Re400"].steps_per_lyapunov_time is None
    unknown = campaign({"cases": {"Re600": {"lyapunov": {"given_exponent": None}}}})
    steps = [unknown.cases[case].steps_per_lyapunov_time for case in ("Re400", "Re600")]
    assert steps == [61, None]


NETWORK = {"case": "Re600", "forecaster": "esn-N2000-SSV-seed7"}
PATHS = (
    *("random_seed", "case.training", "case.training.noise", "forecasters.esn.connectivity"),
    *("forecaster.options", "forecaster.divergence_bound", "washout_lt", "search"),
)


def test_settings_are_found_by_their_path_in_canonical_form():
    record = settings_of_job(PAPER, PATHS, NETWORK, {"neurons": 3.0, "pair": (1.0, 2.5)})
    assert record == {
        "random_seed": 2022,
        "case.training": {"actuation": None, "noise": 0.01, "series": 10, "trained_on": []},
        "case.training.noise": 0.01,
        "forecasters.esn.connectivity": 20,
        "forecaster.options": {
            **{"backend": "compiled", "connectivity": 20, "input_bias": 0.1},
            **{"input_range": "all", "input_offset": "none"},
            **{"leak_rate": [1], "readout": "linear"},
        },
        "forecaster.divergence_bound": 10,
        "washout_lt": 0.5,
        "search": PAPER.config.search.dump(),
        **{"neurons": 3, "pair": [1, 2.5]},
    }
    assert repr(record) == repr(canonical(record))


def test_kinds_share_sections_of_options():
    def settings(kind):
        paths = ["forecaster.options", "forecaster.divergence_bound"]
        return settings_of_job(PAPER, paths, {"case": "Re600", "forecaster": kind})

    forecasters = PAPER.config.forecasters.dump()
    sections = [forecasters[name] for name in ("observation", "quadratic", "filter")]
    options = settings("quadratic_filtered")["forecaster.options"]
    assert options == {key: value for section in sections for key, value in section.items()}
    assert len(options) == sum(map(len, sections))
    options = settings("equations_filtered")["forecaster.options"]
    assert options.keys() == {"noise", "members", "inflation"}
    assert list(settings("equations").values()) == [None, {}]


def test_settings_are_those_that_concern_a_job_and_no_other_name_is_taken():
    for kind in ("esn-N2000-SSV-seed7", "equations", "equations_noisy"):
        job = {"case": "Re600", "forecaster": kind}
        record = settings_of_job(PAPER, ["random_seed", "case.training.noise"], job)
        # who sees the truth is given no noise
        assert ("case.training.noise" in record) == (kind != "equations")
    for path in ("horizon.evnts", "no_such_section", "case.trainig"):
        with pytest.raises(LookupError, match=f"there is no setting {path}"):
            settings_of_job(PAPER, [path], NETWORK)


ALL = "equations equations_noisy esn", "recycle single_shot"


@pytest.mark.parametrize(
    ("wildcards", "kinds", "strategies"),
    [
        (NETWORK, "esn", "single_shot"),
        ({"case": "Re600", "forecaster": "equations"}, "equations", ""),
        ({"case": "Re600", "reservoir": "esn-N2000-seed1", "strategies": "RV+SSV"}, *ALL),
        ({}, *ALL),
    ],
)
def test_modules_that_a_job_is_about(wildcards, kinds, strategies):
    assert PAPER.modules(wildcards) == {
        "burstcast.systems": ["mfe"],
        "burstcast.forecasters": kinds.split(),
        "burstcast.control.strategies": [],
        "burstcast.networks.validation_strategies": strategies.split(),
        "burstcast.data.encoders": [],
    }


def test_strategies_that_share_their_sums_share_a_scan():
    scans = [PAPER.scan_of(f"esn-N500-{name}-seed3") for name in ("RV", "SSV", "WFV")]
    assert scans == [("esn-N500-seed3", name) for name in ("RV+SSV", "RV+SSV", "WFV")]


def test_noise_of_a_plan_is_said_also_where_the_truth_is_seen():
    settings = {"level": [0.05], "decision_interval_lt": [0.5]}
    block = {"strategy": "reactive", "settings": settings, "noise": [0.03]}
    noisy = campaign({"control": {"strategies": [block]}})
    (run,) = {run.identity["strategy"] for run in noisy.strategy_runs if run.plan.noise}
    job = {"case": "Re400", "controller": "equations", "strategy": run}
    assert settings_of_job(noisy, ["control.run"], job)["control.run"]["noise"] == 0.03


def test_settings_of_cases_are_those_of_the_jobs_of_each():
    records = settings_of_cases(PAPER, series.Tested)
    paths = ["case.training.series", "case.test_series"]
    assert records == {case: settings_of_job(PAPER, paths, {"case": case}) for case in records}
    assert list(records) == list(PAPER.case_names)
    assert [record["case.test_series"] for record in records.values()] == [150, 300, 300, 300]


def test_realisations_are_cases_that_differ_by_their_training_series_only():
    block = {"reynolds": [400], "realisations": 3, "forecasters": networks([2000], seeds=2)}
    realised = campaign(blocks=[block])
    chosen, *others = realised.case_names
    assert (chosen, others) == ("Re400", ["Re400-training1", "Re400-training2"])
    assert all(realised.cases[case].dump() == realised.cases["Re400"].dump() for case in others)
    assert realised.realised_cases == tuple(others)
    assert realised.simulated_cases == realised.case_names
    assert {network.case for network in realised.networks} == {chosen, *others}
    assert "training_realisations" in table_names(realised)


def test_drawn_training_sets_stand_in_the_place_of_the_cases_own():
    simulated = {"reynolds": [400], "forecasters": {"equations": {}}}
    drawn = {"event_shares": [0.17, "all"], "forecasters": networks([500], seeds=2)}
    mixed = campaign(blocks=[simulated, {"reynolds": [400], **drawn}])
    assert mixed.case_names == ("Re400", "Re400-training1", "Re400-training2")
    assert {network.case for network in mixed.networks} == set(mixed.realised_cases)
    first, both = (Job(mixed, {"case": case}).drawn_shares for case in mixed.realised_cases)
    assert first == {"shares": [0.17], "threshold": 0.1}
    assert both == {"shares": [0.17, "all"], "threshold": 0.1}
    assert Job(PAPER, {"case": "Re400"}).drawn_shares is None


def test_networks_with_true_washouts_share_the_search_of_the_others():
    chosen = {"esn_true_washout": networks([500], seeds=2)["esn"]}
    with_truth = campaign(blocks=[{"reynolds": [400], "forecasters": chosen}])
    assert len(with_truth.networks) == 2
    assert with_truth.searched_networks == ()
    searched = [with_truth.search_source(network).directory for network in with_truth.networks]
    assert searched == [f"Re400/networks/esn-N500-RV-seed{seed}" for seed in range(2)]
    # they have learnt from noisy series
    wildcards = {"case": "Re400", "forecaster": "esn_true_washout-N500-RV-seed0"}
    noise = {"case.training.noise": 0.01}
    assert settings_of_job(with_truth, [*noise], wildcards) == noise


def test_variants_are_networks_with_other_settings():
    chosen = networks([500], seeds=2)
    other = {"esn": {**chosen["esn"], "variants": ["leaking", "squares"]}}
    blocks = [{"reynolds": [400], "forecasters": forecasters} for forecasters in (chosen, other)]
    variants = {"squares": {"readout": "quadratic"}, "leaking": {"leak_rate": [0.5, 1]}}
    varied = campaign({"forecasters": {"variants": variants}}, blocks=blocks)
    names = [network.name for network in varied.networks]
    identifiers = [name.identifier for name in names]
    labels = ("", "-leaking", "-squares")
    assert identifiers == [f"esn{label}-N500-RV-seed{n}" for label in labels for n in (0, 1)]
    assert all(re.fullmatch(NETWORKS, name) for name in identifiers)  # in the rules
    assert [name.keys["forecaster"] for name in names[::2]] == ["esn", "esn_leaking", "esn_squares"]
    # those of a kind are plain ones
    assert [network.name for network in varied.select(case="Re400", kind="esn")] == names[:2]
    voters = varied.controlling("Re400", "esn-squares-N500-RV-committee")
    assert [member.name for member in voters] == names[4:]
    paths = ["forecasters.esn.leak_rate", "forecasters.esn.readout", "forecaster.options"]
    expected = [([1], "linear"), ([1, 0.5], "linear"), ([1], "quadratic")]
    for name, (leak_rate, readout) in zip(identifiers[::2], expected, strict=True):
        record = settings_of_job(varied, paths, {"case": "Re400", "forecaster": name})
        options = {"leak_rate": leak_rate, "readout": readout, "connectivity": 20}
        assert options.items() <= record["forecaster.options"].items()
        assert [record[path] for path in paths[:2]] == [leak_rate, readout]
    scan = varied.scan_of("esn-squares-N500-RV-seed1")
    assert scan == ("esn-squares-N500-seed1", "RV+SSV")
    assert "leak_rate" in PAPER.unused_columns - varied.unused_columns
    # random alarms are as often as those of plain networks
    random = [run for run in varied.control_runs if run.controller.role == "random"]
    assert {run.controller.label for run in random} == {None}


# -- names of forecasters --------------------------------------------------------------------------

NAMES = st.builds(
    ForecasterName,
    st.from_regex(r"[a-z][a-z0-9_]*", fullmatch=True),
    st.none() | st.integers(0, 10**6),
    st.none() | st.from_regex(r"[A-Z]+", fullmatch=True),
    st.none() | st.integers(0, 10**6),
    st.sampled_from([None, "committee", "random"]),
)


@given(NAMES | st.builds(ForecasterName, st.sampled_from([*available_kinds()])))
def test_identifiers_tell_everything(name):
    assert parsed(name.identifier) == name


@pytest.mark.parametrize(
    "identifier",
    [
        *("", "ESN", "esn-", "esn-RV-N20", "esn-N20-rv", "esn-N20-RV-seed", "esn-N20-RV-seed1x"),
        *("a/b", "esn-N20-N20", "esn-N020-RV-seed1", "my_models.", "esn-random-committee"),
    ],
)
def test_what_is_no_identifier(identifier):
    with pytest.raises(ValueError, match=re.escape(f"{identifier!r} is no forecaster")):
        parsed(identifier)


def test_only_forecasters_that_know_the_parameters_are_given_them():
    campaign = Campaign(load(tiny_campaign("aware")))
    paths = [*Networks.paths(), "control.cost"]
    plain, aware = (
        settings_of_job(campaign, paths, {"case": "Re600", "forecaster": f"{kind}-N40-RV-seed0"})
        for kind in ("esn", "esn_aware")
    )
    assert "forecasters.aware" not in plain
    assert aware["forecasters.aware"]["own"] == [600]
    assert plain["control.cost"] is True


def test_channels_are_known_beforehand():
    campaign, flow = Campaign(load(tiny_campaign("encoded"))), KolmogorovFlow(40.0, 4, 4)
    invariants = list(flow.invariant_names)
    dimensions = {"turbulence": 80, "sensors": 49, "invariants": len(invariants) + 1}
    dimensions |= {"sensors_pod": 9}
    assert {name: case.space.dimension for name, case in campaign.cases.items()} == dimensions
    assert campaign.cases["invariants"].parameters["components"] == invariants
    kinds = {name: type(case) for name, case in campaign.cases.items()}
    assert kinds == dict.fromkeys(dimensions, Measured) | {"turbulence": Simulated}
    assert campaign.cases["sensors"].source is campaign.cases["turbulence"]


def test_own_modules_are_those_of_systems_and_encoders():
    modules = own_modules(load(tiny_campaign("encoded")))
    assert modules == {"kolmogorov_flow": None, "shift_invariants": None}
    files = {"cases": {"invariants": {"files": ["campaign.yaml", "again.yaml"]}}}
    modules = own_modules(load(tiny_campaign("encoded", files)))
    assert modules["shift_invariants"] == ["again.yaml", "campaign.yaml"]


def test_options_of_a_class_of_ones_own_are_the_same_for_every_job():
    chosen = {"burstcast.forecasters.esn:NetworkForecaster": {"divergence_bound": 3.0}}
    campaign_of_own = campaign(blocks=[{"reynolds": [400], "forecasters": chosen}])
    (member,) = [m for m in campaign_of_own.forecasters if "NetworkForecaster" in m.name.kind]
    paths = ["forecaster.options", "forecaster.divergence_bound"]
    for _ in range(2):
        expected = {"forecaster.options": {}, "forecaster.divergence_bound": 3}
        assert settings_of_job(campaign_of_own, paths, member.identity) == expected


def test_long_runs_are_of_their_own_blocks_and_leave_other_runs_as_they_are():
    block = {"strategy": "uncontrolled", "cases": ["Re400"], "span_lt": 50}
    receding = {
        "strategy": "receding_horizon",
        "settings": {"horizon_lt": [1, 2], "decision_interval_lt": [0.25]},
        "forecasters": {"equations_noisy": {}},
        "cases": ["Re400"],
    }
    with_long = campaign({"control": {"long_runs": [block, receding], "return_levels": [0.2]}})
    assert with_long.strategy_runs == PAPER.strategy_runs
    assert PAPER.long_runs == ()
    free, *others = sorted(with_long.long_runs, key=lambda run: run.controller.kind != "none")
    assert free.plan.identifier == "uncontrolled-unselected-quiet20-span50"
    assert [run.controller.kind for run in others] == ["equations_noisy"] * 2
    assert {run.plan.span_lt for run in others} == {1000}
    for run in with_long.long_runs:
        assert with_long.plan(run.plan.identifier) == run.plan
    assert cases_of(with_long, "return_times") == ["Re400"]
    assert cases_of(PAPER, "return_times") == []
