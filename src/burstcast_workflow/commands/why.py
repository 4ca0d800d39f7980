"""Jobs that would run again, and the reasons, in words.

::

    burstcast why [options of snakemake]

Snakemake's dry run lists the jobs that would run. This command compares their present settings,
code and inputs with the records of their results (`snaketrust.records`), and names the differences:
settings by their path in the config, modules, files.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from burstcast.forecasters._names import parsed
from burstcast.natural_order import natural_order
from burstcast_workflow.harness.settings import leaves
from burstcast_workflow.start import names_of_rules
from snaketrust.plan import planned
from snaketrust.planning import Known, KnownResults

UNMADE = "not made yet"
"""Text of the cause of jobs that never ran, and that the last run was to make, too."""

_MISSING = object()
_LONGEST_VALUE = 60
_DIMENSIONS = {
    "case": ("case", "cases"),
    "kind": ("kind of forecaster", "kinds of forecasters"),
    "neurons": ("size", "sizes"),
    "validation": ("validation strategy", "validation strategies"),
    "strategies": ("set of validation strategies", "sets of validation strategies"),
    "seed": ("seed", "seeds"),
    "strategy": ("strategy of control", "strategies of control"),
    "table": ("table", "tables"),
    "figure": ("figure", "figures"),
}

Identity = Mapping[str, Any]
Leaf = tuple[str, str]


@dataclass(frozen=True)
class Job:
    """A job that would run: what it is, what it has now and what it last ran with."""

    #: rule, wildcards: rule and wildcards of the job
    rule: str
    wildcards: Mapping[str, str]
    #: settings, code, inputs: its parameters and inputs now
    settings: Any
    code: Sequence[str]
    inputs: Sequence[str]
    #: recorded_settings, recorded_code, recorded_inputs: parameters of the last run, and whether
    #: its inputs are still the same; None where nothing is recorded
    recorded_settings: Any = None
    recorded_code: Sequence[str] | None = None
    recorded_inputs: Mapping[str, bool] | None = None
    #: missing, incomplete, changed_files: outputs that are not there or half-written, and inputs
    #: that are newer than the outputs
    missing: Sequence[str] = ()
    incomplete: Sequence[str] = ()
    changed_files: Sequence[str] = ()
    #: what is wrong with outputs that are there: damaged, or without a record of what made them
    problems: Sequence[str] = ()
    asked_before: bool = False  #: whether the last run was to make it, too
    forced: bool = False  #: whether it was asked for by an option
    upstream: Sequence[int] = ()  #: numbers of the jobs that would run before it, among all jobs
    #: wildcards of the jobs that made the inputs, now and at its last run, by file
    makers: Mapping[str, Identity] = field(default_factory=dict)


@dataclass
class Cause:
    """A reason with its cases and the jobs that it would run."""

    text: str
    cases: set[str] = field(default_factory=set)
    jobs: set[int] = field(default_factory=set)


# -- differences -----------------------------------------------------------------------------------


def flat(settings: Mapping[str, Any]) -> dict[Leaf, Any]:
    """Settings of a job by case (or "") and path in the config; cases are those in ``cases``."""
    of_cases = {"": {path: settings[path] for path in settings if path != "cases"}}
    return {
        (case, path): value
        for case, own in {**of_cases, **settings.get("cases", {})}.items()
        for path, value in leaves(own)
        if path
    }


def differences(old: Mapping[str, Any], new: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Case (or "") and text of each difference of two settings."""
    before, after = flat(old), flat(new)
    cases = [set(settings.get("cases", {})) for settings in (old, new)]
    for text in more_and_fewer(*([{"case": case} for case in found] for found in cases)):
        yield "", text
    for case, path in sorted({*before, *after}):
        pair = before.get((case, path), _MISSING), after.get((case, path), _MISSING)
        came_with_it = case in cases[0] ^ cases[1]
        if pair[0] != pair[1] and not came_with_it:
            yield case, f"{path} {_change(*pair)}"


def more_and_fewer(before: Sequence[Identity], after: Sequence[Identity]) -> list[str]:
    """Describe added and removed jobs or files (`new_values`)."""
    added = [one for one in after if one not in before]
    removed = [one for one in before if one not in after]
    return [*new_values(added, before), *new_values(removed, after, gone=True)]


def new_values(
    added: Sequence[Identity], known: Sequence[Identity], *, gone: bool = False
) -> list[str]:
    """Describe jobs or files that are new, or gone, beside others: "one more seed, 9 -> 10 (9)"."""
    unexplained = [_dimensions(one) for one in added]
    others = [_dimensions(one) for one in known]
    texts = []
    for name, labels in _DIMENSIONS.items():
        before = {one.get(name) for one in others} - {None}
        values = {one.get(name) for one in unexplained} - before - {None}
        if not values or not known:
            continue
        unexplained = [one for one in unexplained if one.get(name) not in values]
        counts = [len(before), len(before) + len(values)]
        number = f"{'one' if len(values) == 1 else len(values)} {'fewer' if gone else 'more'}"
        listed = ", ".join(sorted(map(str, values), key=natural_order))
        first, last = reversed(counts) if gone else counts
        texts.append(f"{number} {labels[len(values) > 1]}, {first} -> {last} ({listed})")
    if unexplained:
        texts.append("forecasters or cases left out" if gone else "new combinations")
    return texts


def _dimensions(identity: Identity) -> dict[str, Any]:
    """An identity by the names in `_DIMENSIONS`, with a forecaster's name in its parts."""
    found = {name: value for name, value in identity.items() if name in _DIMENSIONS}
    whose = (identity.get(name) for name in ("forecaster", "controller", "reservoir"))
    if name := next(filter(None, whose), None):
        keys = parsed(name).keys
        found |= {**keys, "kind": keys["forecaster"]}
    return found


def _change(old: Any, new: Any) -> str:
    if isinstance(old, list) and isinstance(new, list) and len(old) + len(new) > 4:
        before, after = (Counter(map(_shown, values)) for values in (old, new))
        added = [f"with {value}" for value in (after - before).elements()]
        removed = [f"without {value}" for value in (before - after).elements()]
        if len(added) + len(removed) < min(len(old), len(new)):
            return ", ".join([*added, *removed]) or "in another order"
    return f"{_shown(old)} -> {_shown(new)}"


def _shown(value: Any) -> str:
    if value is _MISSING:
        return "none"
    if value is None:
        return "null"
    text = value if isinstance(value, str) else repr(value)
    return text if len(text) <= _LONGEST_VALUE else text[: _LONGEST_VALUE - 3] + "..."


def changed_modules(old: Sequence[str], new: Sequence[str]) -> list[str]:
    """Names of modules with other fingerprints; if there are none, of new and removed modules."""
    before, after = (dict(entry.rsplit("@", 1) for entry in entries) for entries in (old, new))
    changed = sorted(name for name in before if name in after and before[name] != after[name])
    return changed or sorted(before.keys() ^ after.keys())


# -- causes ----------------------------------------------------------------------------------------


def causes(jobs: Sequence[Job], known: Mapping[str, Sequence[Identity]]) -> list[Cause]:
    """Causes of the jobs that would run, each with all jobs that it sets off, directly or not.

    ``known`` has the wildcards of the jobs that have results already, by rule.
    """
    found: dict[str, Cause] = {}
    unmade = {number for number, job in enumerate(jobs) if _unmade(job, known)}
    for number, job in enumerate(jobs):
        if number in unmade:
            continue
        for case, text in _own_causes(job, known):
            cause = found.setdefault(text, Cause(text))
            cause.jobs.add(number)
            cause.cases.update(filter(None, [case or job.wildcards.get("case", "")]))
    downstream = _downstream(jobs)
    for cause in found.values():
        cause.jobs = set().union(*(downstream[number] for number in cause.jobs)) - unmade
    unmade |= (
        set()
        .union(*(downstream[number] for number in unmade))
        .difference(*(cause.jobs for cause in found.values()))
    )
    unexplained = set(range(len(jobs))).difference(
        unmade, *(cause.jobs for cause in found.values())
    )
    if unexplained:
        # neither they nor their inputs' jobs have changed: only Snakemake knows the reason
        text = "other reasons (see snakemake -n)"
        found[text] = Cause(text, jobs=unexplained)
    first = [Cause(UNMADE, jobs=unmade)] if unmade else []
    return [*first, *_joined(found.values())]


def _unmade(job: Job, known: Mapping[str, Sequence[Identity]]) -> bool:
    """Whether a job never ran, and nothing was added to the campaign that asks for it."""
    never_made = bool(job.missing) and job.recorded_settings is None
    return never_made and (job.asked_before or not _additions(job, known))


def _additions(job: Job, known: Mapping[str, Sequence[Identity]]) -> list[str]:
    others = known.get(job.rule, [])
    return new_values([job.wildcards], others) if others and job.wildcards else []


def _own_causes(job: Job, known: Mapping[str, Sequence[Identity]]) -> Iterator[tuple[str, str]]:
    """Yield case and text of each cause that lies in the job itself."""
    if job.forced:
        yield "", "asked for by an option"
    for path in job.changed_files:
        same = (job.recorded_inputs or {}).get(path, False)
        what = "has a later time and the same content (cp -a keeps times)" if same else "changed"
        yield "", f"file {path} {what}"
    if job.incomplete:
        yield "", "interrupted before it was complete"
    for problem in job.problems:
        yield "", problem
    if job.missing and job.recorded_settings is None:
        for text in _additions(job, known):
            yield "", text
        return
    settled = False
    if job.recorded_settings is not None:
        for case, text in differences(job.recorded_settings, job.settings):
            settled = True
            yield case, text
    if job.recorded_code is not None:
        for module in changed_modules(job.recorded_code, job.code):
            settled, read = True, module.partition("file:")[2]
            yield "", f"file {read} changed" if read else f"code of {module} changed"
    if job.missing and not settled:
        yield "", "results are missing"
    recorded = job.recorded_inputs
    if not settled and recorded is not None:
        former = sorted(path for path, same in recorded.items() if not same)
        other = []
        if {*recorded} == {*job.inputs} and [*recorded] != [*dict.fromkeys(job.inputs)]:
            other = ["inputs in another order"]
        elif {*recorded} != {*job.inputs}:
            makers = [
                [job.makers[path] for path in paths if path in job.makers]
                for paths in (recorded, job.inputs)
            ]
            other = more_and_fewer(*makers) or ["made from other files"]
        for text in [f"made from another {path}" for path in former] or other:
            yield "", text


def _downstream(jobs: Sequence[Job]) -> list[set[int]]:
    """All jobs that a job sets off, itself included; jobs come after their upstream jobs."""
    reached: list[set[int]] = [{number} for number in range(len(jobs))]
    for number in reversed(range(len(jobs))):
        for earlier in jobs[number].upstream:
            reached[earlier] |= reached[number]
    return reached


def _joined(found: Iterable[Cause]) -> list[Cause]:
    """Join causes that set off the same jobs: settings that were changed together."""
    by_jobs: dict[tuple[frozenset[int], frozenset[str]], Cause] = {}
    for cause in found:
        first = by_jobs.setdefault((frozenset(cause.jobs), frozenset(cause.cases)), cause)
        if first is not cause:
            first.text += f"; {cause.text}"
    return list(by_jobs.values())


def report(jobs: Sequence[Job], known: Mapping[str, Sequence[Identity]]) -> str:
    """Jobs that would run again, and the reasons, as text: the largest reason first."""
    if not jobs:
        return "Nothing would run: all results are up to date."
    lines = []
    found = sorted(causes(jobs, known), key=lambda cause: (cause.text != UNMADE, -len(cause.jobs)))
    for cause in found:
        if cause.text == UNMADE:
            lines.append(f"{UNMADE}: {len(cause.jobs)} job{'s' * (len(cause.jobs) != 1)}")
            continue
        cases = f" ({', '.join(sorted(cause.cases, key=natural_order))})" if cause.cases else ""
        counted = _counted(jobs[number] for number in sorted(cause.jobs))
        lines.append(f"{cause.text}{cases}: {counted}")
    rules = f": {_counted(jobs)}" if len(found) > 1 or found[0].text == UNMADE else ""
    lines.append(f"\nIn all {len(jobs)} job{'' if len(jobs) == 1 else 's'}{rules}")
    return "\n".join(lines)


def _counted(jobs: Iterable[Job]) -> str:
    counts = Counter(job.rule for job in jobs)
    return ", ".join(f"{rule} ({count})" for rule, count in counts.items())


# -- from Snakemake --------------------------------------------------------------------------------


def jobs_to_run(workflow: Any) -> tuple[list[Job], dict[str, list[Identity]]]:
    """Jobs that would run by a plan of Snakemake, in its order, with their reasons.

    Beside them, the wildcards of the jobs that have results already, by rule.
    """
    run, dag = names_of_rules(workflow)["run"], workflow.dag
    results, wanted = KnownResults(run.results), {*run.claimed().get("wanted", ())}
    known: dict[str, list[Identity]] = {}
    running = {}
    for level in dag.toposorted():
        for job in sorted(level, key=lambda job: [job.rule.name, *map(str, job.output)]):
            if not job.output:
                continue  # a target: it runs nothing
            found = [results.of(str(path)) for path in job.output]
            if dag.needrun(job):
                running[job] = found
            if any(one.record or one.problem for one in found):
                known.setdefault(job.rule.name, []).append(dict(job.wildcards_dict))
    numbers = {job: number for number, job in enumerate(running)}
    jobs = [_described_job(job, dag, results, found, numbers) for job, found in running.items()]
    asked = [
        any(results.records.name(str(path)) in wanted for path in job.output) for job in running
    ]
    pairs = zip(jobs, asked, strict=True)
    return [replace(job, asked_before=before) for job, before in pairs], known


def _described_job(
    job: Any, dag: Any, results: KnownResults, known: Sequence[Known], numbers: Mapping[Any, int]
) -> Job:
    reason = dag.reason(job)
    record = next((one.record for one in known if one.record), None)
    inputs = None if record is None else results.inputs(record)
    parameters = {} if record is None else record.parameters
    makers: dict[str, Identity] = {
        str(path): dict(maker.wildcards_dict)
        for maker, paths in dag.dependencies[job].items()
        for path in paths
    }
    for path in inputs or ():
        if path not in makers and path in results and (made := results.of(path).record):
            makers[path] = {name: made.identity[name] for name in made.identity if name != "rule"}
    return Job(
        rule=job.rule.name,
        wildcards=dict(job.wildcards_dict),
        settings=job.params.get("settings"),
        code=job.params.get("code", []),
        inputs=[str(path) for path in job.input],
        recorded_settings=parameters.get("settings"),
        recorded_code=parameters.get("code"),
        recorded_inputs=inputs,
        missing=[str(path) for path in reason.missing_output],
        incomplete=[str(path) for path in reason.incomplete_output],
        changed_files=[str(path) for path in reason.updated_input],
        problems=[one.problem for one in known if one.problem],
        forced=bool(reason.forced),
        upstream=[numbers[earlier] for earlier in dag.dependencies[job] if earlier in numbers],
        makers=makers,
    )


def main(arguments: Sequence[str]) -> int:
    """Print what would run again, and why."""
    print(report(*jobs_to_run(planned(arguments))))
    return 0
