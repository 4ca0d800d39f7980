"""Which networks a campaign has, and which settings the rules read of it."""

import re
from dataclasses import replace

import pytest
from helpers_configs import campaign, networks, tiny_campaign
from hypothesis import given, settings
from hypothesis import strategies as st

from burstcast.base.names import NETWORK as NETWORKS
from burstcast.base.names import ForecasterName, parsed
from burstcast.forecasters.registry import available_kinds
from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.campaign.job_settings import Job, settings_of_cases, settings_of_job
from burstcast_workflow.campaign.loading import load
from burstcast_workflow.campaign.members import CaseForecaster
from burstcast_workflow.config.case import Encoded, Simulated
from burstcast_workflow.config.cases import own_modules
from burstcast_workflow.config.model import Choice, Configuration
from burstcast_workflow.config.reference import schema_of
from burstcast_workflow.figures.registry import (
    FIGURES,
    cases_of,
    figure_names,
    files_of,
    settings_of,
)
from burstcast_workflow.harness.canonical import canonical, canonical_json
from burstcast_workflow.jobs import data
from burstcast_workflow.jobs.networks import Networks
from burstcast_workflow.jobs.systems import System
from burstcast_workflow.tables.registry import cases_of_tables, table_names
from kolmogorov_flow import KolmogorovFlow

PAPER = campaign()


def of(case, identifier):
    return CaseForecaster(case, parsed(identifier))


def test_the_papers_forecasters():
    assert len(PAPER.networks) == len(set(PAPER.networks)) == (6 + 3) * 2 * 10
    at_400 = PAPER.select(case="Re400", kind="esn")
    assert {network.name.neurons for network in at_400} == {500, 1000, 1500, 2000, 2500, 3000}
    assert len(PAPER.select(case="Re1000", validation="RV")) == 10
    assert {network.name.seed for network in PAPER.networks} == set(range(10))
    assert PAPER.case_names == ("Re400", "Re600", "Re800", "Re1000")
    reynolds = [PAPER.cases[case].parameters["reynolds"] for case in PAPER.case_names]
    assert reynolds == [400, 600, 800, 1000]
    assert PAPER.networks[0].directory == "Re400/networks/esn-N500-RV-seed0"
    others = [other for other in PAPER.forecasters if other not in PAPER.networks]
    assert [other.directory for other in others] == [
        f"{case}/models/{kind}"
        for case in PAPER.case_names
        for kind in ("equations", "equations_noisy")
    ]


def test_blocks_that_overlap_share_their_forecasters():
    equations = {"equations": {}, "equations_noisy": None}
    both = {**networks([100], ["RV", "SSV"]), "equations": {}}
    shared = campaign(
        {"control": {"forecasters": {"esn": None}}},
        blocks=[
            {"reynolds": [400], "forecasters": {**networks([100, 200], seeds=2), **equations}},
            {"reynolds": [400, 600], "forecasters": both},
        ],
    )
    of_400 = ("N100-RV-seed0", "N100-RV-seed1", "N100-SSV-seed0", "N200-RV-seed0", "N200-RV-seed1")
    first = [of("Re400", f"esn-{name}") for name in of_400]
    second = [of("Re600", f"esn-N100-{validation}-seed0") for validation in ("RV", "SSV")]
    equations = [of(case, "equations") for case in ("Re400", "Re600")]
    assert shared.forecasters == (equations[0], *first, equations[1], *second)


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
    equations = [run for run in runs if run.controller.kind == "equations"]
    assert len(equations) == 4 * 2
    directories = {run.directory for run in runs}
    paper = "prediction_triggered-prediction_time1-window1"
    assert f"Re400/control/esn-N2000-RV-seed3/{paper}" in directories
    assert f"Re400/control/esn-N2000-RV-seed3-random/{paper}" in directories
    assert f"Re1000/control/equations/{paper.replace('time1', 'time2')}" in directories
    assert PAPER.strategy_runs == runs


def test_random_alarms_a_case_and_a_sweep_are_chosen():
    changed = campaign({"control": {"random_alarms": False}})
    without = tuple(run for run in PAPER.control_runs if run.controller.role is None)
    assert changed.control_runs == without
    changed = campaign({"cases": {"Re600": {"actuation": None}}})
    assert {run.case for run in changed.control_runs} == {"Re400", "Re800", "Re1000"}
    swept = campaign({"control": {"sweep": {"cases": ["Re400"], "seeds": 1}}})
    more = set(swept.control_runs) - set(PAPER.control_runs)
    assert {run.prediction_time_lt for run in more} == {3, 4, 5}
    assert {run.case for run in more} == {"Re400"}
    controllers = {run.controller.identifier for run in more}
    assert controllers == {"esn-N2000-RV-seed0", "esn-N2000-RV-seed0-random", "equations"}
    assert set(PAPER.control_runs) < set(swept.control_runs)


def test_committees_control_as_one():
    forecasters = {**networks([500, 2000], seeds=3), "quadratic_filtered": {}}
    settings = {"horizon_lt": [2], "decision_interval_lt": [0.25], "vote_share": [0.1, 1]}
    block = {"strategy": "receding_horizon", "settings": settings, "cases": ["Re400"]}
    block["forecasters"] = {"esn": {"neurons": [2000]}, "quadratic_filtered": {}}
    strategies = [{**block, "committee": True}]
    blocks = [{"reynolds": [400, 600], "forecasters": forecasters}]
    voting = campaign({"control": {"strategies": strategies}}, blocks=blocks)
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
        assert run.controller.seed is None
    committee = "esn-N2000-RV-committee"
    voters = [member.name.identifier for member in voting.controlling("Re400", committee)]
    assert voters == [f"esn-N2000-RV-seed{seed}" for seed in range(3)]
    (alone,) = voting.controlling("Re400", "quadratic_filtered-committee")
    assert alone.directory == "Re400/models/quadratic_filtered"
    # a job of a committee is about the kind of those who vote
    first = min(runs, key=lambda run: run.directory)
    wildcards = {"case": "Re400", "controller": committee, "strategy": f"{plan}0.1"}
    assert first.identity == wildcards
    modules = voting.modules(wildcards)
    assert modules["burstcast.forecasters"] == ["esn"]
    assert settings_of_job(voting, ["control.run"], wildcards)["control.run"]["noise"] == 0.01


@pytest.mark.parametrize(
    ("reynolds", "name"), [(412.5, "Re412.5"), (600.0, "Re600"), (1234567, "Re1234567")]
)
def test_names_of_cases_are_the_reynolds_numbers_in_full(reynolds, name):
    named = campaign(blocks=[{"reynolds": [400, reynolds], "forecasters": networks([2000])}])
    assert named.case_names == ("Re400", name)
    assert named.cases[name].parameters.get("reynolds") == reynolds
    settings = settings_of_job(named, ["case.parameters"], {"case": name})
    assert settings["case.parameters"]["reynolds"] == reynolds


def test_time_units():
    steps = [PAPER.cases[case].steps_per_lyapunov_time for case in PAPER.case_names]
    assert steps == [61, 74, 79, 82]
    assert PAPER.cases["Re400"].ensemble.sampling_interval == 1
    computed = campaign({"case_defaults": {"lyapunov": {"time_unit": "computed"}}})
    assert computed.cases["Re400"].steps_per_lyapunov_time is None
    unknown = campaign({"cases": {"Re600": {"lyapunov": {"given_exponent": None}}}})
    assert unknown.cases["Re600"].steps_per_lyapunov_time is None
    assert unknown.cases["Re400"].steps_per_lyapunov_time == 61


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


@pytest.mark.parametrize("kind", ["esn-N2000-SSV-seed7", "equations", "equations_noisy"])
def test_settings_are_those_that_concern_a_job_and_no_other_name_is_taken(kind):
    job = {"case": "Re600", "forecaster": kind}
    record = settings_of_job(PAPER, ["random_seed", "case.training.noise"], job, {})
    # who sees the truth is given no noise
    assert ("case.training.noise" in record) == (kind != "equations")
    for path in ("horizon.evnts", "no_such_section", "case.trainig"):
        with pytest.raises(LookupError, match=f"there is no setting {path}"):
            settings_of_job(PAPER, [path], job)


@pytest.mark.parametrize(
    ("overlay", "paths"),
    [
        ({"case_defaults": {"training": {"noise": 0.02}}}, set(PATHS[1:3])),
        # only who judges long forecasts depends on their bound
        ({"forecasters": {"esn": {"divergence_bound": 20}}}, {"forecaster.divergence_bound"}),
        ({"forecasters": {"esn": {"connectivity": 10}}}, set(PATHS[3:5])),
        ({"forecasters": {"esn": {"backend": "scipy"}}}, {"forecaster.options"}),
        ({"search": {"grid": 3}}, {"search"}),
        # another case's settings, and how the figures look, are nobody's business
        ({"cases": {"Re400": {"training": {"noise": 0.02}}}}, set()),
        ({"figures": {"example_forecaster": "esn-N2000-RV-seed3"}}, set()),
        ({"results": "results/elsewhere"}, set()),
    ],
)
def test_a_change_of_the_config_changes_the_settings_at_its_path_only(overlay, paths):
    before, after = (settings_of_job(of, PATHS, NETWORK) for of in (PAPER, campaign(overlay)))
    assert {path for path in PATHS if before[path] != after[path]} == paths


def test_what_a_job_is_found_by_does_not_depend_on_who_else_is_in_the_campaign():
    small = campaign(
        {"control": {"forecasters": {"esn": None}}, "figures": {"example_case": "Re600"}},
        blocks=[{"reynolds": [600], "forecasters": networks([2000])}],
    )
    wildcards = {"case": "Re600", "forecaster": "esn-N2000-RV-seed0"}
    assert settings_of_job(small, PATHS, wildcards) == settings_of_job(PAPER, PATHS, wildcards)
    assert small.modules(wildcards) == PAPER.modules(wildcards)
    assert small.scan_of(wildcards["forecaster"]) == PAPER.scan_of(wildcards["forecaster"])


ALL = "equations equations_noisy esn", "recycle single_shot"
SCAN = {"reservoir": "esn-N2000-seed1", "strategies": "RV+SSV"}


@pytest.mark.parametrize(
    ("wildcards", "kinds", "strategies"),
    [
        (NETWORK, "esn", "single_shot"),
        ({"case": "Re600", "forecaster": "esn-N2000-RV-seed1"}, "esn", "recycle"),
        ({"case": "Re600", "forecaster": "equations"}, "equations", ""),
        ({"case": "Re600", **SCAN}, *ALL),
        ({"case": "Re600"}, *ALL),
        ({}, *ALL),
    ],
)
def test_modules_that_a_job_is_about(wildcards, kinds, strategies):
    assert PAPER.modules(wildcards) == {
        "burstcast.systems": ["mfe"],
        "burstcast.forecasters": kinds.split(),
        "burstcast.control.strategies": [],
        "burstcast.networks.validation_strategies": strategies.split(),
    }


def test_strategies_that_share_their_sums_share_a_scan():
    for validation, scan in {"RV": "RV+SSV", "SSV": "RV+SSV", "WFV": "WFV"}.items():
        assert PAPER.scan_of(f"esn-N500-{validation}-seed3") == ("esn-N500-seed3", scan)


def test_runs_of_control_tell_random_alarms_apart():
    controllers = [run.controller for run in PAPER.control_runs]
    roles = {(name.role, name.keys["forecaster"]) for name in controllers}
    assert roles == {(None, "esn"), (None, "equations"), ("random", "random")}
    identities = {canonical_json(run.identity) for run in PAPER.control_runs}
    assert len(identities) == len(PAPER.control_runs)
    for run in PAPER.control_runs:
        record = settings_of_job(PAPER, ["control.run"], run.identity)["control.run"]
        assert record["settings"]["prediction_time_lt"] == run.prediction_time_lt
        assert f"-prediction_time{run.prediction_time_lt:g}-" in run.identity["strategy"]
        # equations see the truth
        assert ("noise" in record) == (run.controller.kind != "equations")


def test_noise_of_a_plan_is_said_also_where_the_truth_is_seen():
    settings = {"level": [0.05], "decision_interval_lt": [0.5]}
    block = {"strategy": "reactive", "settings": settings, "noise": [0.03]}
    noisy = campaign({"control": {"strategies": [block]}})
    run = next(run for run in noisy.strategy_runs if run.plan.noise)
    wildcards = {**run.identity, "controller": "equations"}
    assert settings_of_job(noisy, ["control.run"], wildcards)["control.run"]["noise"] == 0.03


def test_settings_of_cases_are_those_of_the_jobs_of_each():
    records = settings_of_cases(PAPER, data.Tested)
    paths = ["case.training.series", "case.test_series"]
    assert records == {case: settings_of_job(PAPER, paths, {"case": case}) for case in records}
    assert list(records) == list(PAPER.case_names)
    assert [record["case.test_series"] for record in records.values()] == [150, 300, 300, 300]


@settings(deadline=None, max_examples=15)
@given(st.randoms())
def test_settings_do_not_depend_on_the_order_of_the_config(generator):
    def shuffled(values):
        if isinstance(values, dict):
            return {name: shuffled(values[name]) for name in shuffled(list(values))}
        return generator.sample(values, len(values)) if isinstance(values, list) else values

    names = ["alpha", "Zeta", "zeta", "b10", "b9"]
    cases = {name: {"parameters": {"reynolds": 400 + len(name)}} for name in names}
    forecasters = [networks([2000], ["SSV", "RV"], 2), networks([500, 2000], ["SSV", "RV"])]
    blocks = [
        {"cases": names, "forecasters": {**forecasters[0], "equations": {}}},
        {"reynolds": [400, 1000], "forecasters": {"equations": {}, **forecasters[1]}},
    ]
    times = {"prediction_times_lt": shuffled([0.5, 1, 1.5, 2, 2.5, 3])}
    other = campaign(
        {
            "cases": {name: cases[name] for name in shuffled(names)},
            "classification": times,
            "search": {"tikhonov": shuffled([1e-6, 1e-9, 1e-12])},
        },
        blocks=shuffled([shuffled(block) for block in blocks]),
    )
    sorted_times = {"classification": {"prediction_times_lt": sorted(times["prediction_times_lt"])}}
    plain = campaign({"cases": cases}, sorted_times, blocks=blocks)
    assert other.forecasters == plain.forecasters
    assert other.control_runs == plain.control_runs
    for names_of in (table_names, cases_of_tables, figure_names):
        assert names_of(other) == names_of(plain)
    for name, figure in FIGURES.items():
        for case in cases_of(plain, figure):
            assert files_of(other, figure, case) == files_of(plain, figure, case), name
            assert settings_of(other, figure, case) == settings_of(plain, figure, case), name
    sections = ("classification", "control", "search", "bootstrap")
    assert settings_of_job(other, sections, {}) == settings_of_job(plain, sections, {})
    assert settings_of_cases(other, System) == settings_of_cases(plain, System)


def test_realisations_are_cases_that_differ_by_their_training_series_only():
    realised = campaign(
        blocks=[{"reynolds": [400], "realisations": 3, "forecasters": networks([2000], seeds=2)}]
    )
    chosen, *others = realised.case_names
    assert (chosen, others) == ("Re400", ["Re400-training1", "Re400-training2"])
    assert all(realised.cases[case].dump() == realised.cases["Re400"].dump() for case in others)
    assert realised.realised_cases == tuple(others)
    assert realised.simulated_cases == (chosen, *others)
    assert {network.case for network in realised.networks} == {chosen, *others}
    assert "training_realisations" in table_names(realised)
    assert "training_realisations" not in table_names(PAPER)


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
    searched = [with_truth.searched(network).directory for network in with_truth.networks]
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
    assert [name.identifier for name in names] == [
        f"esn{label}-N500-RV-seed{seed}"
        for label in ("", "-leaking", "-squares")
        for seed in (0, 1)
    ]
    assert [name.keys["forecaster"] for name in names[::2]] == ["esn", "esn_leaking", "esn_squares"]
    # those of a kind are plain ones
    assert [network.name for network in varied.select(case="Re400", kind="esn")] == names[:2]
    assert varied.controlling("Re400", "esn-squares-N500-RV-committee") == tuple(
        of("Re400", f"esn-squares-N500-RV-seed{seed}") for seed in (0, 1)
    )
    paths = ["forecaster.options", "forecasters.esn.leak_rate", "forecasters.esn.readout"]
    expected = [([1], "linear"), ([1, 0.5], "linear"), ([1], "quadratic")]
    for name, (leak_rate, readout) in zip(names[::2], expected, strict=True):
        wildcards = {"case": "Re400", "forecaster": name.identifier}
        record = settings_of_job(varied, paths, wildcards)
        options = record["forecaster.options"]
        assert [record[path] for path in paths[1:]] == [leak_rate, readout]
        assert (options["leak_rate"], options["readout"]) == (leak_rate, readout)
        assert options["connectivity"] == 20
    scan = varied.scan_of("esn-squares-N500-RV-seed1")
    assert scan == ("esn-squares-N500-seed1", "RV+SSV")
    assert "leak_rate" not in varied.unused_columns
    assert "leak_rate" in PAPER.unused_columns
    # random alarms are as often as those of plain networks
    random = [run for run in varied.control_runs if run.controller.role == "random"]
    assert {run.controller.label for run in random} == {None}
    # the workflow's rules accept the names
    for name in names:
        assert re.fullmatch(NETWORKS, name.identifier)


# -- names of forecasters --------------------------------------------------------------------------

NAMES = st.builds(
    ForecasterName,
    st.from_regex(r"[a-z][a-z0-9_]*", fullmatch=True),
    st.none() | st.integers(0, 10**6),
    st.none() | st.from_regex(r"[A-Z]+", fullmatch=True),
    st.none() | st.integers(0, 10**6),
    st.sampled_from([None, "committee", "random"]),
)


@pytest.mark.parametrize(
    ("name", "identifier"),
    [
        (ForecasterName("equations"), "equations"),
        (ForecasterName("equations_noisy"), "equations_noisy"),
        (ForecasterName("esn", 2000, "RV", 3), "esn-N2000-RV-seed3"),
        (ForecasterName("esn", 2000, None, 0), "esn-N2000-seed0"),
        (ForecasterName("esn", 2000, "RV", 3, "random"), "esn-N2000-RV-seed3-random"),
        (ForecasterName("esn", 2000, "RV", role="committee"), "esn-N2000-RV-committee"),
    ],
)
def test_identifiers(name, identifier):
    assert name.identifier == identifier


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


def test_keys_of_tables():
    expected = {"forecaster": "esn", "neurons": 20, "validation": "RV", "seed": 0}
    assert ForecasterName("esn", 20, "RV", 0).keys == expected


def test_the_example_of_the_config_is_an_identifier():
    figures = schema_of(Configuration)["$defs"]["Figures"]["properties"]
    (example,) = re.findall(r"esn-[\w-]+", figures["example_forecaster"]["allowed"])
    assert parsed(example).identifier == example


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


def test_who_has_trajectories():
    campaign = Campaign(load(tiny_campaign("precursor")))
    assert [classifier.directory for classifier in campaign.classifiers] == [
        "modes_4/classifiers/precursor",
        "Re400/classifiers/esn_direct",
        "Re400/classifiers/precursor",
    ]
    assert [model.name.kind for model in campaign.trajectory_forecasters] == ["equations_noisy"]


def test_channels_are_known_beforehand():
    campaign, flow = Campaign(load(tiny_campaign("encoded"))), KolmogorovFlow(40.0, 4, 4)
    assert {name: case.space.dimension for name, case in campaign.cases.items()} == {
        "turbulence": 80,
        "sensors": 49,
        "invariants": len(flow.invariant_names) + 1,
        "sensors_pod": 9,
    }
    components = campaign.cases["invariants"].parameters["components"]
    assert components == list(flow.invariant_names)
    kinds = {name: type(case) for name, case in campaign.cases.items()}
    encoded = dict.fromkeys(["sensors", "invariants", "sensors_pod"], Encoded)
    assert kinds == {"turbulence": Simulated, **encoded}
    assert campaign.cases["sensors"].source is campaign.cases["turbulence"]


def test_own_modules_are_those_of_systems_and_encoders():
    modules = own_modules(load(tiny_campaign("encoded")))
    assert modules == {"kolmogorov_flow": None, "shift_invariants": None}
    files = {"cases": {"invariants": {"files": ["campaign.yaml", "again.yaml"]}}}
    modules = own_modules(load(tiny_campaign("encoded", files)))
    assert modules["shift_invariants"] == ["again.yaml", "campaign.yaml"]
