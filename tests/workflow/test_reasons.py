"""What a dry run says: reasons with all jobs that they set off, from what Snakemake tells."""

import random

import pytest
from snakemake.persistence import ParamsChange

from snakemake_logger_plugin_burstcast.reasons import PlannedJob, explanation, own_causes


def params(before, now):
    """Snakemake's reason where parameters are others; None is one that has not changed."""
    texts = ({repr(value) for value in values if value is not None} for values in (before, now))
    return f"Params have changed since last execution: {ParamsChange(*texts, {'a'})}"


def settings_changed(before, now):
    return params([before], [now])


def code_changed(before, now):
    """Of a script that is the same."""
    return params([{"script.py": "0", **before}], [{"script.py": "0", **now}])


def job(rule, reason="", inputs=(), outputs=None, case="Re400"):
    return PlannedJob(rule, case, inputs, outputs or [f"{case}/{rule}"], reason)


Y = "y" * 56
NINE = range(9), range(1, 10)


def causes(reason):
    return [text for text, _ in own_causes(job("train", reason))]


@pytest.mark.parametrize(
    ("before", "now", "words"),
    [
        ({"a.b": 0.2}, {"a.b": 0.25}, ["a.b 0.2 -> 0.25"]),
        ({"a": 1, "b": 1}, {"b": 2, "a": 2}, ["a 1 -> 2", "b 1 -> 2"]),
        ({"a": 1, "b": 1}, {"b": 2, "a": 1}, ["b 1 -> 2"]),
        ({"a": "it's"}, {"a": 'x; now: y, "z"'}, ['a it\'s -> x; now: y, "z"']),
        ({"a": "it now: y"}, {"a": 1}, ["a it now: y -> 1"]),
        ({"a": None}, {}, ["a null -> none"]),
        (*({"a": {"b": {"c": 1, "d": [d]}}} for d in (2, 3)), ["a.b.d [2] -> [3]"]),
        ({"a": [1, 2, 3]}, {"a": [1, 2, 3, 4]}, ["a with 4"]),
        ({"a": [1, 2, 3]}, {"a": [3, 2, 1]}, ["a in another order"]),
        ({}, {"a": 1}, ["a none -> 1"]),
        ({"a": "x"}, {"a": "y" * 99}, [f"a x -> {'y' * 57}..."]),
        # whole values are compared, and what they differ in is shown
        (*({"a": f"{'y' * 99}{end}"} for end in "pq"), [f"a ...{Y}p -> ...{Y}q"]),
        (
            *({"a": f"{'y' * 99}{middle}{'z' * 99}"} for middle in "pq"),
            [f"a ...{Y[:20]}p{'z' * 33}... -> ...{Y[:20]}q{'z' * 33}..."],
        ),
        (
            *({"a": f"{'y' * 99}{end}"} for end in ("", "more")),
            [f"a ...{'y' * 57} -> ...{'y' * 53}more"],
        ),
        (
            *({"a": [Y * 2 + f"_{n}.csv" for n in some]} for some in NINE),
            [f"a with ...{Y[:51]}_9.csv, without ...{Y[:51]}_0.csv"],
        ),
        (
            *({"a": [{Y * 2: n} for n in some]} for some in NINE),
            [f'a with ...{Y[:52]}": 9}}, without ...{Y[:52]}": 0}}'],
        ),
        # other values, which look alike
        ({"a": 1}, {"a": True}, ["a 1 -> true"]),
        ({"a": 1}, {"a": "1"}, ['a 1 -> "1"']),
        ({"a": None}, {"a": "null"}, ['a null -> "null"']),
        ({"a": [1, 2, 3]}, {"a": [3, 2, "1"]}, ['a with "1", without 1']),
        ({"a": "x @12ab"}, {"a": "x @34cd"}, ["a x @12ab -> x @34cd"]),
    ],
)
def test_changes_of_settings_in_words(before, now, words):
    assert causes(settings_changed(before, now)) == words


@pytest.mark.parametrize(
    ("before", "now", "words"),
    [
        ({"one.part": "12ab"}, {"one.part": "34cd"}, ["code of one.part"]),
        # modules that are used since, or no more, where an edited one explains it
        ({"b": "1", "a": "1", "new": "1"}, {"a": "2", "b": "2", "old": "2"}, ["code of a, b"]),
        ({}, {"a": "1"}, ["code of a"]),
        (*({f"m{n}": m for n in range(9)} for m in "12"), ["code of m0, m1, m2 and 6 more"]),
        ({"library:numpy": "2.1"}, {"library:numpy": "2.2"}, ["numpy 2.1 -> 2.2"]),
        ({}, {"library:numpy": "2.2"}, ["numpy none -> 2.2"]),
        ({"file:own:my a.csv": "1"}, {"file:own:my a.csv": "2"}, ["code of file:own:my a.csv"]),
        ({"file:my:a = b.txt": "1"}, {"file:my:a = b.txt": "2"}, ["code of file:my:a = b.txt"]),
    ],
)
def test_changes_of_code_in_words(before, now, words):
    assert causes(code_changed(before, now)) == words


def test_settings_and_code_that_changed_at_once_and_parameters_of_other_rules():
    code = [{"x.py": "1"}, {"x.py": "2"}]
    both = params([{"a": 1}, code[0]], [{"a": 2}, code[1]])
    assert causes(both) == ["a 1 -> 2", "code of x.py"]
    assert causes(params(["text", 3], [])) == []
    assert causes("Params have changed since last execution: in a form of the future") == []


def test_a_setting_of_several_cases_says_whose():
    before, now = (
        {"cases": {"Re400": {"case.noise": n}, "Re600": {"case.noise": 1}}} for n in (1, 2)
    )
    reasons = own_causes(job("table", settings_changed(before, now), case=""))
    assert list(reasons) == [("case.noise 1 -> 2", "Re400")]


SEVERAL = ["changed: a", "another software environment"]


@pytest.mark.parametrize(
    ("reason", "words"),
    [
        ("Forced execution", ["asked for by an option"]),
        ("Missing output files: a/b.nc, c", ["results are missing"]),
        ("Incomplete output files: a/b.nc", ["interrupted before it was complete"]),
        ("Updated input files: lab/run 1.csv", ["changed: lab/run 1.csv"]),
        ("Input files updated by another job: a, b", []),
        ("Set of input files has changed since last execution", ["made from other files"]),
        ("Software environment definition has changed; Updated input files: a", SEVERAL),
    ],
)
def test_other_reasons_in_words(reason, words):
    assert causes(reason) == words


def test_a_reason_counts_what_it_sets_off_directly_or_not():
    noise = settings_changed({"case.noise": 0.1}, {"case.noise": 0.12})
    jobs = [
        job("events", noise),
        job("horizon", "Input files updated by another job: x", ["Re400/events"]),
        job("horizon", noise, ["Re600/events"], case="Re600"),
        job("table", "", ["Re400/horizon", "Re600/horizon"], case=""),
        job("figure", code_changed({"style": "1"}, {"style": "2"}), [], case=""),
    ]
    assert explanation(jobs).splitlines() == [
        "case.noise 0.1 -> 0.12 (Re400, Re600): events (1), horizon (2), table (1)",
        "code of style: figure (1)",
        "in all 5 jobs: events (1), figure (1), horizon (2), table (1)",
    ]


def test_reasons_of_the_same_jobs_are_one_line_and_of_none_nothing():
    jobs = [job("train", params([{"a": 1}, {"m.py": "1"}], [{"a": 2}, {"m.py": "2"}]))]
    assert explanation(jobs) == "a 1 -> 2; code of m.py (Re400): train (1)\nin all 1 job"
    assert explanation([]) == "Nothing to be done"


def test_every_job_is_counted_by_some_reason():
    chance = random.Random(3)
    jobs = []
    for n in range(200):
        inputs = [f"f{chance.randrange(n)}" for _ in range(2)] if n > 5 else []
        reason = "" if inputs else settings_changed({f"a{n % 3}": 1}, {f"a{n % 3}": 2})
        jobs.append(job(f"rule{n % 7}", reason, inputs, [f"f{n}"]))
    lines = explanation(jobs).splitlines()
    assert lines[-1].startswith("in all 200 jobs: ")
    assert len(lines) == 4


def test_a_chain_of_a_thousand_jobs():
    first = settings_changed({"a": 1}, {"a": 2})
    jobs = [job("step", "" if n else first, [f"f{n - 1}"], [f"f{n}"]) for n in range(1500)]
    assert "step (1500)" in explanation(jobs)


def test_reasons_are_the_same_in_whatever_order_jobs_are_told():
    first = settings_changed({"a": 1}, {"a": 2})
    jobs = [
        job("events", first),
        *(job("horizon", first, ["Re400/events"], [f"h{n}"]) for n in range(3)),
        job("examples", first, ["h0"]),
        job("table", "", ["h0", "h1", "h2", "Re400/examples"]),
    ]
    expected = "a 1 -> 2 (Re400): events (1), horizon (3), examples (1), table (1)\nin all 6 jobs"
    for seed in range(5):
        assert explanation(random.Random(seed).sample(jobs, len(jobs))) == expected
