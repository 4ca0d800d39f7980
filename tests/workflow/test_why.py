import pytest

from burstcast_workflow.why import Job, causes, changed_modules, differences, new_values, report

CODE = ["burstcast.systems.mfe@1", "train.py@2"]


def job(rule="train", settings=None, recorded=None, **values) -> Job:
    defaults = {
        "wildcards": {"case": "Re400"},
        "settings": settings or {"noise": 0.01},
        "code": CODE,
        "inputs": ["ensemble.nc"],
        "recorded_settings": {"noise": 0.01} if recorded is None else recorded,
        "recorded_code": CODE,
        "recorded_inputs": ["ensemble.nc"],
    }
    return Job(rule=rule, **{**defaults, **values})


def test_changed_values_are_named():
    old = {"training": {"series": 10, "noise": 0.01}, "case": "Re400", "gone": 1}
    new = {"training": {"series": 10, "noise": 0.02}, "case": "Re400", "added": None}
    assert list(differences(old, new)) == [
        ("", "added", "none -> null"),
        ("", "gone", "1 -> none"),
        ("", "training.noise", "0.01 -> 0.02"),
    ]


def test_settings_of_all_cases_are_those_of_single_ones():
    old, new = ({"event_thresholds": {"Re400": value, "Re600": 0.1}} for value in (0.1, 0.12))
    assert list(differences(old, new)) == [("Re400", "event_threshold", "0.1 -> 0.12")]
    old, new = ({"cases": [["Re400", {"noise": value}]]} for value in (1, 2))
    assert list(differences(old, new)) == [("Re400", "noise", "1 -> 2")]
    old, new = ({"cases": [{"case": "Re400", "exponent": value}]} for value in (1, 2))
    assert list(differences(old, new)) == [("Re400", "exponent", "1 -> 2")]


def test_long_lists_show_what_came_and_went():
    old, new = {"times": [1, 2, 3, 4]}, {"times": [1, 2, 3, 5]}
    assert list(differences(old, new)) == [("", "times", "with 5, without 4")]
    assert list(differences({"range": [0, 1]}, {"range": [0, 2]})) == [
        ("", "range", "[0, 1] -> [0, 2]")
    ]
    assert list(differences({"times": [1, 2, 3]}, {"times": [1, 3, 2]})) == [
        ("", "times", "in another order")
    ]


NETWORKS = [
    {"case": "Re400", "neurons": neurons, "validation": "RV", "seed": seed, "forecaster": "esn"}
    for neurons in (500, 1000)
    for seed in range(3)
]


def test_more_and_fewer_networks():
    seed = [{**NETWORKS[0], "seed": 3}]
    assert new_values(seed, NETWORKS) == ["one more seed, 3 -> 4 (3)"]
    assert new_values(seed, NETWORKS, gone=True) == ["one fewer seed, 4 -> 3 (3)"]
    sizes = [{**NETWORKS[0], "neurons": neurons} for neurons in (2000, 1500)]
    assert new_values(sizes, NETWORKS) == ["2 more sizes, 2 -> 4 (1500, 2000)"]
    both = [*seed, {**NETWORKS[0], "validation": "SSV"}]
    assert new_values(both, NETWORKS) == [
        "one more validation strategy, 1 -> 2 (SSV)",
        "one more seed, 3 -> 4 (3)",
    ]
    lacking = [NETWORKS[-1]]
    assert new_values(lacking, NETWORKS[:-1]) == ["new combinations in the campaign"]
    old, new = {"networks": NETWORKS}, {"networks": [*NETWORKS, *seed]}
    assert list(differences(old, new)) == [("", "one more seed, 3 -> 4 (3)", "")]
    assert list(differences(new, old)) == [("", "one fewer seed, 4 -> 3 (3)", "")]
    assert list(differences(old, {"networks": NETWORKS[::-1]})) == [("", "order of networks", "")]


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
        job("classify", {"threshold": 2}, {"threshold": 1}, wildcards={}),
    ]
    assert report(jobs, {}).splitlines()[0] == (
        "threshold 1 -> 2 (Re400): events (1), horizon (2), horizon_table (1), classify (1)"
    )


def test_settings_that_follow_from_one_another_share_a_line():
    jobs = [job("test_set", {"windows": {"count": 4}, "a": 2}, {"windows": {"count": 2}, "a": 1})]
    (cause,) = causes(jobs, {})
    assert cause.text in ("a 1 -> 2; windows.count 2 -> 4", "windows.count 2 -> 4; a 1 -> 2")


def test_a_setting_in_a_section_of_one_rule_is_the_same_setting():
    jobs = [
        job("scan", {"tikhonov": 2}, {"tikhonov": 1}),
        job("parameters", {"network": {"tikhonov": 2}}, {"network": {"tikhonov": 1}}),
    ]
    (cause,) = causes(jobs, {})
    assert (cause.text, cause.jobs) == ("tikhonov 1 -> 2", {0, 1})


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ({"recorded_code": [CODE[0], "train.py@1"]}, "code of train.py changed"),
        ({"changed_files": ["a.csv"]}, "file a.csv changed"),
        ({"incomplete": ["a.nc"]}, "interrupted before it was complete"),
        ({"missing": ["a.nc"]}, "results were deleted"),
        ({"forced": True}, "asked for by an option"),
        ({"recorded_inputs": []}, "made from other files"),
        ({}, "other reasons (see snakemake -n)"),
    ],
)
def test_other_reasons(values, text):
    assert [cause.text for cause in causes([job(**values)], {})] == [text]


def test_new_jobs_are_described_by_what_is_new_about_them():
    new = {"missing": ["n.nc"], "recorded_settings": None, "recorded_code": None}
    known = {"train": [{"case": "Re400", "seed": "0"}, {"case": "Re400", "seed": "1"}]}
    made = job(wildcards={"case": "Re400", "seed": "2"}, recorded_inputs=None, **new)
    assert [cause.text for cause in causes([made], known)] == ["one more seed, 2 -> 3 (2)"]
    assert [cause.text for cause in causes([made], {})] == ["not made yet"]


def test_figures_are_counted_together():
    jobs = [job(f"figure_{name}", {"noise": 1}) for name in ("a", "b")]
    assert report(jobs, {}) == "noise 0.01 -> 1 (Re400): figures (2)\n\nIn all 2 jobs"


def test_nothing():
    assert report([], {}) == "Nothing would run: all results are up to date."
