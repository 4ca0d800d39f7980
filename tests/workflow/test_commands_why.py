"""What would run again, and why, in words."""

from types import SimpleNamespace

import pytest

from burstcast_workflow.commands.why import (
    Job,
    causes,
    changed_modules,
    differences,
    jobs_to_run,
    main,
    more_and_fewer,
    new_values,
    report,
)
from snaketrust.records import Records
from snaketrust.run import Run

CODE = ["burstcast.systems.mfe@1", "train.py@2"]


def job(rule="train", settings=None, recorded=None, **values) -> Job:
    defaults = {
        "wildcards": {"case": "Re400"},
        "settings": settings or {"noise": 0.01},
        "code": CODE,
        "inputs": ["ensemble.nc"],
        "recorded_settings": {"noise": 0.01} if recorded is None else recorded,
        "recorded_code": CODE,
        "recorded_inputs": {"ensemble.nc": True},
    }
    return Job(rule=rule, **{**defaults, **values})


def of_cases(**thresholds):
    return {"cases": {case: {"case.event_threshold": value} for case, value in thresholds.items()}}


OLD = {"case.training": {"series": 10, "noise": 0.01}, "search.grid": 4, "gone": 1}
NEW = {"case.training": {"series": 10, "noise": 0.02}, "search.grid": 4, "added": None}


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (OLD, NEW, ["added none -> null", "case.training.noise 0.01 -> 0.02", "gone 1 -> none"]),
        # values of a list are counted; of long ones what came and went is shown
        ({"grid": [1, 1, 1, 2, 2]}, {"grid": [1, 1, 2, 2, 2]}, ["grid with 2, without 1"]),
        ({"grid": [1, 2, 3, 4]}, {"grid": [2, 1, 3, 4]}, ["grid in another order"]),
        ({"times": [1, 2, 3, 4]}, {"times": [1, 2, 3, 5]}, ["times with 5, without 4"]),
        ({"times": [1, 2, 3]}, {"times": [1, 3, 2]}, ["times in another order"]),
        ({"range": [0, 1]}, {"range": [0, 2]}, ["range [0, 1] -> [0, 2]"]),
        # what is longer than a line is cut
        ({"name": None}, {"name": "a" * 60}, ["name null -> " + "a" * 60]),
        ({"name": None}, {"name": "a" * 61}, ["name null -> " + "a" * 57 + "..."]),
        # what comes with a case is no change of its own
        (of_cases(Re400=1), of_cases(Re400=1, Re600=1), ["one more case, 1 -> 2 (Re600)"]),
    ],
)
def test_differences_name_what_changed(old, new, said):
    assert list(differences(old, new)) == [("", text) for text in said]


def test_settings_of_all_cases_are_those_of_single_ones():
    old, new = of_cases(Re400=0.1, Re600=0.1), of_cases(Re400=0.12, Re600=0.1)
    assert list(differences(old, new)) == [("Re400", "case.event_threshold 0.1 -> 0.12")]


def network(neurons=500, validation="RV", seed=0):
    return {"case": "Re400", "forecaster": f"esn-N{neurons}-{validation}-seed{seed}"}


NETWORKS = [network(neurons, seed=seed) for neurons in (500, 1000) for seed in range(3)]
SEED = network(seed=3)


@pytest.mark.parametrize(
    ("found", "known", "said"),
    [
        ([SEED], NETWORKS, ["one more seed, 3 -> 4 (3)"]),
        ([network(2000), network(1500)], NETWORKS, ["2 more sizes, 2 -> 4 (1500, 2000)"]),
        (
            [SEED, network(validation="SSV")],
            NETWORKS,
            ["one more validation strategy, 1 -> 2 (SSV)", "one more seed, 3 -> 4 (3)"],
        ),
        ([NETWORKS[-1]], NETWORKS[:-1], ["new combinations"]),
        (
            [{"case": "Re400", "forecaster": "equations"}],
            NETWORKS,
            ["one more kind of forecaster, 1 -> 2 (equations)"],
        ),
    ],
)
def test_new_values_are_counted(found, known, said):
    assert new_values(found, known) == said


def test_more_and_fewer_forecasters():
    assert new_values([SEED], NETWORKS, gone=True) == ["one fewer seed, 4 -> 3 (3)"]
    more = [*NETWORKS, SEED]
    assert more_and_fewer(NETWORKS, more) == ["one more seed, 3 -> 4 (3)"]
    assert more_and_fewer(more, NETWORKS) == ["one fewer seed, 4 -> 3 (3)"]


def test_changed_modules():
    assert changed_modules(CODE, ["burstcast.systems.mfe@9", "train.py@2", "new@1"]) == [
        "burstcast.systems.mfe"
    ]
    assert changed_modules(CODE, [*CODE, "new@1"]) == ["new"]
    assert changed_modules(CODE, CODE) == []


def test_a_cause_counts_what_follows_from_it():
    jobs = [
        job("events", {"threshold": 2}, {"threshold": 1}),
        job("horizon", upstream=[0]),
        job("horizon", upstream=[0], wildcards={"case": "Re600"}),
        job("horizon_table", upstream=[1, 2], wildcards={}),
        job("classification_table", {"threshold": 2}, {"threshold": 1}, wildcards={}),
    ]
    assert report(jobs, {}).splitlines()[0] == (
        "threshold 1 -> 2 (Re400): events (1), horizon (2), horizon_table (1), "
        "classification_table (1)"
    )


MAKERS = {f"{seed}/horizon.nc": network(seed=seed) for seed in range(3)}
THREE, TWO = dict.fromkeys(MAKERS, True), dict.fromkeys([*MAKERS][:2], True)
TABLE = {"rule": "horizon_table", "makers": MAKERS}
IN_ORDER = {"a.nc": True, "b.nc": True}
TOUCHED = {"changed_files": ["a.csv"], "inputs": ["a.csv"]}


@pytest.mark.parametrize(
    ("values", "text"),
    [
        (
            {"settings": {"a": 2, "b": {"c": 4}}, "recorded": {"a": 1, "b": {"c": 2}}},
            "a 1 -> 2; b.c 2 -> 4",
        ),
        ({"recorded_code": [CODE[0], "train.py@1"]}, "code of train.py changed"),
        ({"code": [*CODE, "file:my.flows:a.csv@1"]}, "file my.flows:a.csv changed"),
        ({"changed_files": ["a.csv"]}, "file a.csv changed"),
        ({"incomplete": ["a.nc"]}, "interrupted before it was complete"),
        (
            {**TOUCHED, "recorded_inputs": {"a.csv": True}},
            "file a.csv has a later time and the same content (cp -a keeps times)",
        ),
        (
            {**TOUCHED, "recorded_inputs": {"a.csv": False}},
            "file a.csv changed; made from another a.csv",
        ),
        ({"missing": ["a.nc"]}, "results are missing"),
        ({"forced": True}, "asked for by an option"),
        ({"recorded_inputs": {}}, "made from other files"),
        ({"recorded_inputs": {"ensemble.nc": False}}, "made from another ensemble.nc"),
        ({"inputs": ["b.nc", "a.nc"], "recorded_inputs": IN_ORDER}, "inputs in another order"),
        ({**TABLE, "inputs": [*THREE], "recorded_inputs": TWO}, "one more seed, 2 -> 3 (2)"),
        ({**TABLE, "inputs": [*TWO], "recorded_inputs": THREE}, "one fewer seed, 3 -> 2 (2)"),
        ({}, "other reasons (see snakemake -n)"),
    ],
)
def test_causes_are_told_in_a_line(values, text):
    assert [cause.text for cause in causes([job(**values)], {})] == [text]


def test_jobs_with_results_are_known_whether_they_run_or_not(tmp_path):
    run = Run.new(str(tmp_path))
    (tmp_path / "made").write_text("")
    Records(run.results).write([f"{tmp_path}/made"], {"rule": "train"}, {}, {}, "", 1.0)
    rule = SimpleNamespace(name="train", module_globals={"campaign": None, "run": run})
    jobs = [
        SimpleNamespace(rule=rule, output=[f"{tmp_path}/{name}"], wildcards_dict={"seed": name})
        for name in ("made", "new")
    ]
    jobs.append(SimpleNamespace(rule=rule, output=[], wildcards_dict={}))  # a target
    dag = SimpleNamespace(toposorted=lambda: [jobs], needrun=lambda job: not job.output)
    found = jobs_to_run(SimpleNamespace(dag=dag, rules=[rule]))
    assert found == ([], {"train": [{"seed": "made"}]})


NOT_MADE = {"missing": ["n.nc"], "recorded_settings": None, "recorded_code": None}
KNOWN = {"train": [network(seed=0), network(seed=1)]}


def test_new_jobs_are_described_by_what_is_new_about_them():
    made = job(wildcards=network(seed=2), recorded_inputs=None, **NOT_MADE)
    assert [cause.text for cause in causes([made], KNOWN)] == ["one more seed, 2 -> 3 (2)"]
    assert [cause.text for cause in causes([made], {})] == ["not made yet"]


def test_an_unfinished_campaign_is_told_in_a_line_before_what_changed():
    rest = [job(wildcards=network(seed=seed), asked_before=True, **NOT_MADE) for seed in (2, 3)]
    edited = job("events", {"threshold": 2}, {"threshold": 1})
    table = job("horizon_table", wildcards={}, upstream=[0, 2], asked_before=True, **NOT_MADE)
    made = job("horizon", upstream=[2])
    jobs = [*rest, edited, table, made]
    assert report(jobs, KNOWN).splitlines() == [
        "not made yet: 3 jobs",
        "threshold 1 -> 2 (Re400): events (1), horizon (1)",
        "",
        "In all 5 jobs: train (2), events (1), horizon_table (1), horizon (1)",
    ]
    more = job(wildcards=network(seed=4), **NOT_MADE)
    assert report([*rest, more], KNOWN).splitlines()[:2] == [
        "not made yet: 2 jobs",
        "one more seed, 2 -> 3 (4) (Re400): train (1)",
    ]
    waiting = job("horizon", upstream=[0])
    assert report([rest[0], waiting], KNOWN).splitlines()[0] == "not made yet: 2 jobs"


def test_report_counts_figures_together_and_says_that_nothing_runs():
    jobs = [job("figure", {"noise": 1}, wildcards={"figure": name}) for name in ("a", "b")]
    assert report(jobs, {}) == "noise 0.01 -> 1: figure (2)\n\nIn all 2 jobs"
    assert report([], {}) == "Nothing would run: all results are up to date."


@pytest.mark.parametrize(
    "option", [["--unlock"], ["--touch"], ["--delete-all-output"], ["--cleanup-metadata", "a.nc"]]
)
def test_it_takes_no_option_that_changes_anything(option, tmp_path, capsys, monkeypatch):
    """Such as one that takes the lock from a campaign that is running."""
    monkeypatch.chdir(tmp_path)
    locks = tmp_path / ".snakemake" / "locks"
    locks.mkdir(parents=True)
    (locks / "0.output.lock").write_text("results/a.nc")
    (tmp_path / "a.nc").write_text("kept")
    (tmp_path / "Snakefile").write_text(
        'rule a:\n    output: "a.nc"\n    shell: "touch {output}"\n'
    )
    with pytest.raises(SystemExit) as stop:
        main(option)
    assert stop.value.code == 2
    assert f"leave out {option[0]}" in capsys.readouterr().err
    assert (locks / "0.output.lock").exists()
    assert (tmp_path / "a.nc").read_text() == "kept"
