from dataclasses import replace
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


def test_changed_values_are_named():
    old = {"case.training": {"series": 10, "noise": 0.01}, "search.grid": 4, "gone": 1}
    new = {"case.training": {"series": 10, "noise": 0.02}, "search.grid": 4, "added": None}
    assert list(differences(old, new)) == [
        ("", "added none -> null"),
        ("", "case.training.noise 0.01 -> 0.02"),
        ("", "gone 1 -> none"),
    ]


def test_values_of_a_list_are_counted():
    found = differences({"grid": [1, 1, 1, 2, 2]}, {"grid": [1, 1, 2, 2, 2]})
    assert list(found) == [("", "grid with 2, without 1")]
    found = differences({"grid": [1, 2, 3, 4]}, {"grid": [2, 1, 3, 4]})
    assert list(found) == [("", "grid in another order")]


def test_long_values_are_cut_to_a_line():
    for value, shown in (("a" * 60, "a" * 60), ("a" * 61, "a" * 57 + "...")):
        assert list(differences({"name": None}, {"name": value})) == [("", f"name null -> {shown}")]


def of_cases(**thresholds):
    return {"cases": {case: {"case.event_threshold": value} for case, value in thresholds.items()}}


def test_settings_of_all_cases_are_those_of_single_ones():
    old, new = of_cases(Re400=0.1, Re600=0.1), of_cases(Re400=0.12, Re600=0.1)
    assert list(differences(old, new)) == [("Re400", "case.event_threshold 0.1 -> 0.12")]
    # what comes with a case is no change of its own
    assert list(differences(of_cases(Re400=0.1), old)) == [("", "one more case, 1 -> 2 (Re600)")]


def test_long_lists_show_what_came_and_went():
    old, new = {"times": [1, 2, 3, 4]}, {"times": [1, 2, 3, 5]}
    assert list(differences(old, new)) == [("", "times with 5, without 4")]
    assert list(differences({"range": [0, 1]}, {"range": [0, 2]})) == [
        ("", "range [0, 1] -> [0, 2]")
    ]
    assert list(differences({"times": [1, 2, 3]}, {"times": [1, 3, 2]})) == [
        ("", "times in another order")
    ]


def network(neurons=500, validation="RV", seed=0):
    return {"case": "Re400", "forecaster": f"esn-N{neurons}-{validation}-seed{seed}"}


NETWORKS = [network(neurons, seed=seed) for neurons in (500, 1000) for seed in range(3)]


def test_more_and_fewer_forecasters():
    seed = [network(seed=3)]
    assert new_values(seed, NETWORKS) == ["one more seed, 3 -> 4 (3)"]
    assert new_values(seed, NETWORKS, gone=True) == ["one fewer seed, 4 -> 3 (3)"]
    sizes = [network(neurons) for neurons in (2000, 1500)]
    assert new_values(sizes, NETWORKS) == ["2 more sizes, 2 -> 4 (1500, 2000)"]
    both = [*seed, network(validation="SSV")]
    assert new_values(both, NETWORKS) == [
        "one more validation strategy, 1 -> 2 (SSV)",
        "one more seed, 3 -> 4 (3)",
    ]
    assert new_values([NETWORKS[-1]], NETWORKS[:-1]) == ["new combinations"]
    equations = {"case": "Re400", "forecaster": "equations"}
    assert new_values([equations], NETWORKS) == ["one more kind of forecaster, 1 -> 2 (equations)"]
    more = [*NETWORKS, *seed]
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


def test_settings_that_set_off_the_same_share_a_line():
    jobs = [job("evaluation_set", {"a": 2, "b": {"c": 4}}, {"a": 1, "b": {"c": 2}})]
    (cause,) = causes(jobs, {})
    assert cause.text == "a 1 -> 2; b.c 2 -> 4"


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ({"recorded_code": [CODE[0], "train.py@1"]}, "code of train.py changed"),
        ({"code": [*CODE, "file:my.flows:a.csv@1"]}, "file my.flows:a.csv changed"),
        ({"changed_files": ["a.csv"]}, "file a.csv changed"),
        ({"incomplete": ["a.nc"]}, "interrupted before it was complete"),
        (
            {"changed_files": ["a.csv"], "inputs": ["a.csv"], "recorded_inputs": {"a.csv": True}},
            "file a.csv has a later time and the same content (cp -a keeps times)",
        ),
        (
            {"changed_files": ["a.csv"], "inputs": ["a.csv"], "recorded_inputs": {"a.csv": False}},
            "file a.csv changed; made from another a.csv",
        ),
        ({"missing": ["a.nc"]}, "results are missing"),
        ({"forced": True}, "asked for by an option"),
        ({"recorded_inputs": {}}, "made from other files"),
        ({"recorded_inputs": {"ensemble.nc": False}}, "made from another ensemble.nc"),
        ({}, "other reasons (see snakemake -n)"),
    ],
)
def test_other_reasons(values, text):
    assert [cause.text for cause in causes([job(**values)], {})] == [text]


def test_files_of_more_and_of_fewer_forecasters():
    makers = {f"{seed}/horizon.nc": network(seed=seed) for seed in range(3)}
    three, two = dict.fromkeys(makers, True), dict.fromkeys([*makers][:2], True)
    table = job(rule="horizon_table", wildcards={"case": "Re400"}, makers=makers)
    more = replace(table, inputs=[*three], recorded_inputs=two)
    fewer = replace(table, inputs=[*two], recorded_inputs=three)
    assert [cause.text for cause in causes([more], {})] == ["one more seed, 2 -> 3 (2)"]
    assert [cause.text for cause in causes([fewer], {})] == ["one fewer seed, 3 -> 2 (2)"]


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


def test_new_jobs_are_described_by_what_is_new_about_them():
    new = {"missing": ["n.nc"], "recorded_settings": None, "recorded_code": None}
    known = {"train": [network(seed=0), network(seed=1)]}
    made = job(wildcards=network(seed=2), recorded_inputs=None, **new)
    assert [cause.text for cause in causes([made], known)] == ["one more seed, 2 -> 3 (2)"]
    assert [cause.text for cause in causes([made], {})] == ["not made yet"]


def test_an_unfinished_campaign_is_told_in_a_line_before_what_changed():
    new = {"missing": ["n.nc"], "recorded_settings": None, "recorded_code": None}
    known = {"train": [network(seed=0), network(seed=1)]}
    rest = [job(wildcards=network(seed=seed), asked_before=True, **new) for seed in (2, 3)]
    edited = job("events", {"threshold": 2}, {"threshold": 1})
    table = job("horizon_table", wildcards={}, upstream=[0, 2], asked_before=True, **new)
    made = job("horizon", upstream=[2])
    jobs = [*rest, edited, table, made]
    assert report(jobs, known).splitlines() == [
        "not made yet: 3 jobs",
        "threshold 1 -> 2 (Re400): events (1), horizon (1)",
        "",
        "In all 5 jobs: train (2), events (1), horizon_table (1), horizon (1)",
    ]
    more = job(wildcards=network(seed=4), **new)
    assert report([*rest, more], known).splitlines()[:2] == [
        "not made yet: 2 jobs",
        "one more seed, 2 -> 3 (4) (Re400): train (1)",
    ]
    waiting = job("horizon", upstream=[0])
    assert report([rest[0], waiting], known).splitlines()[0] == "not made yet: 2 jobs"


def test_another_order_of_inputs_is_told():
    inputs = ["a.nc", "b.nc"]
    exchanged = job(inputs=inputs[::-1], recorded_inputs=dict.fromkeys(inputs, True))
    assert [cause.text for cause in causes([exchanged], {})] == ["inputs in another order"]


def test_figures_are_counted_together():
    jobs = [job("figure", {"noise": 1}, wildcards={"figure": name}) for name in ("a", "b")]
    assert report(jobs, {}) == "noise 0.01 -> 1: figure (2)\n\nIn all 2 jobs"


def test_nothing():
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
