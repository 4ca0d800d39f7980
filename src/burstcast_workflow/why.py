"""What would run again, and why, in words.

::

    python -m burstcast_workflow.why [options of snakemake]

Snakemake's dry run says which jobs would run. Here the settings, code and inputs that each of them
has now are compared with those that it last ran with, as Snakemake recorded them, and the
differences are named: settings with their values, modules, files.
"""

import ast
import io
import sys
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass, field
from typing import Any

from snakemake.api import DAGApi
from snakemake.cli import args_to_api, parse_args

_MISSING = object()
_LONGEST_VALUE = 60

# settings of all cases or networks together, which single jobs read under another name
_SAME_SETTING = {"event_thresholds": "event_threshold"}
# what identifies a record in a list of records
_KEYS = ("case", "neurons", "validation", "seed", "forecaster", "prediction_time_lt")
_DIMENSIONS = {
    "case": "case",
    "neurons": "size",
    "validation": "validation strategy",
    "seed": "seed",
    "prediction_time_lt": "prediction time of control",
    "forecaster": "forecaster",
    "table": "table",
    "figure": "figure",
}


@dataclass(frozen=True)
class Job:
    """A job that would run: what it is, what it has now and what it last ran with.

    Attributes
    ----------
    rule, wildcards
        Which job.
    settings, code, inputs
        Its parameters and inputs now.
    recorded_settings, recorded_code, recorded_inputs
        Those of its last run; None where nothing is recorded.
    missing, incomplete, changed_files
        Outputs that are not there or half-written, and inputs that are newer than the outputs.
    forced
        Whether it was asked for by an option.
    upstream
        Numbers of the jobs that would run before it, among all jobs.
    """

    rule: str
    wildcards: Mapping[str, str]
    settings: Any
    code: Sequence[str]
    inputs: Sequence[str]
    recorded_settings: Any = None
    recorded_code: Sequence[str] | None = None
    recorded_inputs: Sequence[str] | None = None
    missing: Sequence[str] = ()
    incomplete: Sequence[str] = ()
    changed_files: Sequence[str] = ()
    forced: bool = False
    upstream: Sequence[int] = ()


@dataclass
class Cause:
    """A reason, the cases that it concerns, and the jobs that would run because of it."""

    text: str
    cases: set[str] = field(default_factory=set)
    jobs: set[int] = field(default_factory=set)


# -- differences -----------------------------------------------------------------------------------


def differences(old: Any, new: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[str, str, str]]:
    """Changed leaves of two settings: the case concerned (or ""), what, and how."""
    if old == new:
        return
    old, new = _by_name(old), _by_name(new)
    if isinstance(old, Mapping) and isinstance(new, Mapping):
        for name in sorted({*old, *new}):
            yield from differences(old.get(name, _MISSING), new.get(name, _MISSING), (*path, name))
    elif _are_records(old) and _are_records(new):
        yield from _record_differences(old, new, path)
    else:
        case, name = _named(path)
        yield case, name, _change(old, new)


def _by_name(value: Any) -> Any:
    """Pairs of a name and a record, as a mapping."""
    pairs = isinstance(value, list) and all(
        isinstance(item, list) and len(item) == 2 and isinstance(item[0], str) for item in value
    )
    return dict(value) if pairs and value else value


def _named(path: tuple[str, ...]) -> tuple[str, str]:
    """Case and name of a setting, from where it is."""
    if len(path) > 2 and path[0] == "cases":
        return path[1], ".".join(path[2:])
    if len(path) == 2 and path[0] in _SAME_SETTING:
        return path[1], _SAME_SETTING[path[0]]
    return "", ".".join(path)


def _are_records(value: Any) -> bool:
    return isinstance(value, list) and all(
        isinstance(item, Mapping) and any(key in item for key in _KEYS) for item in value
    )


def _record_differences(
    old: Sequence[Mapping[str, Any]], new: Sequence[Mapping[str, Any]], path: tuple[str, ...]
) -> Iterator[tuple[str, str, str]]:
    before = {_identity(record): record for record in old}
    after = {_identity(record): record for record in new}
    added = [dict(zip(_KEYS, key, strict=True)) for key in after if key not in before]
    removed = [dict(zip(_KEYS, key, strict=True)) for key in before if key not in after]
    known = [dict(zip(_KEYS, key, strict=True)) for key in before]
    left = [dict(zip(_KEYS, key, strict=True)) for key in after]
    for text in new_values(added, known):
        yield "", text, ""
    for text in new_values(removed, left, gone=True):
        yield "", text, ""
    if not added and not removed:
        changed = False
        for key, record in after.items():
            for case, name, change in differences(before[key], record):
                changed = True
                yield case or str(record.get("case", "")), name, change
        if not changed:
            yield "", f"order of {'.'.join(path)}", ""


def _identity(record: Mapping[str, Any]) -> tuple[Any, ...]:
    return tuple(record.get(key) for key in _KEYS)


def new_values(
    added: Sequence[Mapping[str, Any]], known: Sequence[Mapping[str, Any]], *, gone: bool = False
) -> list[str]:
    """Say what is new about some records: "one more seed, 9 -> 10 (9)".

    Parameters
    ----------
    added
        Records that are new, or gone.
    known
        The others.
    gone
        Whether the former are gone.
    """
    texts = []
    unexplained = list(added)
    for name in dict.fromkeys(key for record in added for key in record):
        others = {record.get(name) for record in known}
        values = {record.get(name) for record in added} - others - {None}
        if not values or not known:
            continue
        unexplained = [record for record in unexplained if record.get(name) not in values]
        count, label = len(values), _DIMENSIONS.get(name, name)
        number = "one" if count == 1 else str(count)
        known_count = len(others - {None})
        change = (
            f"{known_count + count} -> {known_count}"
            if gone
            else f"{known_count} -> {known_count + count}"
        )
        listed = ", ".join(sorted((str(value) for value in values), key=_natural))
        plural = label if count == 1 else _plural(label)
        texts.append(f"{number} {'fewer' if gone else 'more'} {plural}, {change} ({listed})")
    if unexplained:
        texts.append("networks or cases left out" if gone else "new combinations in the campaign")
    return texts


def _plural(label: str) -> str:
    if label == "validation strategy":
        return "validation strategies"
    return label.replace("time", "times", 1) if label.startswith("prediction") else label + "s"


def _natural(text: str) -> tuple[float, str]:
    try:
        return float(text), text
    except ValueError:
        return float("inf"), text


def _change(old: Any, new: Any) -> str:
    if isinstance(old, list) and isinstance(new, list):
        added = [value for value in new if value not in old]
        removed = [value for value in old if value not in new]
        if len(old) + len(new) > 4 and len(added) + len(removed) < min(len(old), len(new)):
            parts = [f"with {_shown(value)}" for value in added]
            parts += [f"without {_shown(value)}" for value in removed]
            return ", ".join(parts) or "in another order"
    return f"{_shown(old)} -> {_shown(new)}"


def _shown(value: Any) -> str:
    if value is _MISSING:
        return "none"
    if value is None:
        return "null"
    text = value if isinstance(value, str) else repr(value)
    return text if len(text) <= _LONGEST_VALUE else text[: _LONGEST_VALUE - 3] + "..."


def changed_modules(old: Sequence[str], new: Sequence[str]) -> list[str]:
    """Names of the modules whose fingerprints differ; of those that are new or gone otherwise."""
    before, after = (dict(_split(entry) for entry in entries) for entries in (old, new))
    changed = sorted(name for name in before if name in after and before[name] != after[name])
    return changed or sorted(before.keys() ^ after.keys())


def _split(entry: str) -> tuple[str, str]:
    name, _, digest = entry.rpartition("@")
    return name, digest


# -- causes ----------------------------------------------------------------------------------------


def causes(jobs: Sequence[Job], known: Mapping[str, Sequence[Mapping[str, str]]]) -> list[Cause]:
    """Why jobs would run, each cause with all jobs that it sets off, directly or further down.

    Parameters
    ----------
    jobs
        All jobs that would run.
    known
        Wildcards of the jobs that have results already, by rule.
    """
    found: dict[str, Cause] = {}
    for number, job in enumerate(jobs):
        for case, text in _own_causes(job, known):
            cause = found.setdefault(text, Cause(text))
            cause.jobs.add(number)
            cause.cases.update(filter(None, [case or job.wildcards.get("case", "")]))
    downstream = _downstream(jobs)
    for cause in found.values():
        cause.jobs = set().union(*(downstream[number] for number in cause.jobs))
    unexplained = set(range(len(jobs))).difference(*(cause.jobs for cause in found.values()))
    if unexplained:
        # nothing of their own has changed, nor anything they come from: Snakemake knows why
        text = "other reasons (see snakemake -n)"
        found[text] = Cause(text, jobs=unexplained)
    return _joined(_renamed(found.values()))


def _is_new(job: Job) -> bool:
    return bool(job.missing) and job.recorded_settings is None


def _own_causes(
    job: Job, known: Mapping[str, Sequence[Mapping[str, str]]]
) -> Iterator[tuple[str, str]]:
    """Yield case and text of each cause that lies in the job itself."""
    if job.forced:
        yield "", "asked for by an option"
    for path in job.changed_files:
        yield "", f"file {path} changed"
    if job.incomplete:
        yield "", "interrupted before it was complete"
    if _is_new(job):
        others = known.get(job.rule, [])
        texts = new_values([job.wildcards], others) if others and job.wildcards else []
        for text in texts or ["not made yet"]:
            yield "", text
        return
    if job.missing:
        yield "", "results were deleted"
    settled = False
    if job.recorded_settings is not None:
        for case, name, change in differences(job.recorded_settings, job.settings):
            settled = True
            yield case, f"{name} {change}".strip()
    if job.recorded_code is not None:
        for module in changed_modules(job.recorded_code, job.code):
            yield "", f"code of {module} changed"
    recorded = job.recorded_inputs
    if not settled and recorded is not None and sorted(recorded) != sorted(job.inputs):
        yield "", "made from other files"


def _downstream(jobs: Sequence[Job]) -> list[set[int]]:
    """All jobs that a job sets off, itself included."""
    followers: list[set[int]] = [set() for _ in jobs]
    for number, job in enumerate(jobs):
        for earlier in job.upstream:
            followers[earlier].add(number)
    closures: dict[int, set[int]] = {}

    def close(start: int) -> set[int]:
        waiting, reached = [start], {start}
        while waiting:
            for follower in followers[waiting.pop()]:
                if follower in closures:
                    reached |= closures[follower]
                elif follower not in reached:
                    reached.add(follower)
                    waiting.append(follower)
        closures[start] = reached
        return reached

    return [close(number) for number in range(len(jobs))]


def _renamed(found: Iterable[Cause]) -> list[Cause]:
    """Join causes that differ in the section that jobs read the setting in: windows.x and x."""
    kept: list[Cause] = []
    for cause in sorted(found, key=lambda cause: len(cause.text)):
        same = [other for other in kept if cause.text.endswith(f".{other.text}")]
        if same:
            same[0].jobs |= cause.jobs
            same[0].cases |= cause.cases
        else:
            kept.append(cause)
    return kept


def _joined(found: Iterable[Cause]) -> list[Cause]:
    """Join causes that set off the same jobs: settings that follow from one another."""
    by_jobs: dict[tuple[frozenset[int], frozenset[str]], Cause] = {}
    for cause in found:
        key = frozenset(cause.jobs), frozenset(cause.cases)
        if key in by_jobs:
            by_jobs[key].text += f"; {cause.text}"
        else:
            by_jobs[key] = cause
    return list(by_jobs.values())


def report(jobs: Sequence[Job], known: Mapping[str, Sequence[Mapping[str, str]]]) -> str:
    """What would run again, and why, as text: what sets off most comes first."""
    if not jobs:
        return "Nothing would run: all results are up to date."
    lines = []
    found = sorted(causes(jobs, known), key=lambda cause: -len(cause.jobs))
    for cause in found:
        cases = f" ({', '.join(sorted(cause.cases, key=_natural_case))})" if cause.cases else ""
        lines.append(
            f"{cause.text}{cases}: {_counted(jobs[number] for number in sorted(cause.jobs))}"
        )
    rules = f": {_counted(jobs)}" if len(found) > 1 else ""
    lines.append(f"\nIn all {len(jobs)} jobs{rules}")
    return "\n".join(lines)


def _natural_case(name: str) -> tuple[str, float]:
    letters = name.rstrip("0123456789.")
    number = name[len(letters) :]
    return letters, _natural(number)[0]


def _counted(jobs: Iterable[Job]) -> str:
    counts = Counter("figures" if job.rule.startswith("figure_") else job.rule for job in jobs)
    return ", ".join(f"{rule} ({count})" for rule, count in counts.items())


# -- from Snakemake --------------------------------------------------------------------------------


def snakemake_jobs(
    arguments: Sequence[str],
) -> tuple[list[Job], dict[str, list[Mapping[str, str]]]]:
    """Ask Snakemake which jobs would run.

    Parameters
    ----------
    arguments
        Options of snakemake.

    Returns
    -------
    Jobs in the order of the workflow, and the wildcards of those that have results already, by
    rule.

    Raises
    ------
    SystemExit
        If Snakemake fails; it has said why.
    """
    workflows: list[Any] = []
    execute = DAGApi.execute_workflow

    def execute_and_keep(self: DAGApi, *args: Any, **options: Any) -> Any:
        result = execute(self, *args, **options)
        workflows.append(self.workflow_api._workflow)
        return result

    said = io.StringIO()
    DAGApi.execute_workflow = execute_and_keep
    try:
        with redirect_stdout(said), redirect_stderr(said):
            # quiet in this way, Snakemake ends a dry run before it pretends to execute the jobs
            parser, parsed = parse_args([*arguments, "--dry-run", "--quiet", "rules", "progress"])
            succeeded = args_to_api(parsed, parser)
    finally:
        DAGApi.execute_workflow = execute
    if not succeeded or not workflows:
        print(said.getvalue(), file=sys.stderr)
        raise SystemExit(1)
    return _described(workflows[0])


def _described(workflow: Any) -> tuple[list[Job], dict[str, list[Mapping[str, str]]]]:
    dag, persistence = workflow.dag, workflow.persistence
    known: dict[str, list[Mapping[str, str]]] = {}
    running = []
    for level in dag.toposorted():
        for job in sorted(level, key=lambda job: [job.rule.name, *map(str, job.output)]):
            if not job.output:
                continue  # a target: it runs nothing
            if dag.needrun(job):
                running.append(job)
            if any(persistence.params(path) is not None for path in job.output):
                known.setdefault(job.rule.name, []).append(dict(job.wildcards_dict))
    numbers = {job: number for number, job in enumerate(running)}
    return [_described_job(job, dag, persistence, numbers) for job in running], known


def _described_job(job: Any, dag: Any, persistence: Any, numbers: Mapping[Any, int]) -> Job:
    reason = dag.reason(job)
    recorded = [values for path in job.output if (values := persistence.params(path)) is not None]
    settings, code = _parsed(recorded[0]) if recorded else (None, None)
    return Job(
        rule=job.rule.name,
        wildcards=dict(job.wildcards_dict),
        settings=job.params.get("settings"),
        code=job.params.get("code", []),
        inputs=[str(path) for path in job.input],
        recorded_settings=settings,
        recorded_code=code,
        recorded_inputs=persistence.input(job.output[0]) if recorded else None,
        missing=[str(path) for path in reason.missing_output],
        incomplete=[str(path) for path in reason.incomplete_output],
        changed_files=[str(path) for path in reason.updated_input],
        forced=bool(reason.forced),
        upstream=[numbers[earlier] for earlier in dag.dependencies[job] if earlier in numbers],
    )


def _parsed(recorded: Sequence[str]) -> tuple[Any, Sequence[str] | None]:
    """Settings and code from the representations that Snakemake recorded."""
    settings, code = None, None
    for text in recorded:
        try:
            value = ast.literal_eval(text)
        except (ValueError, SyntaxError):
            continue
        if isinstance(value, dict):
            settings = value
        elif isinstance(value, list):
            code = value
    return settings, code


def main(arguments: Sequence[str] | None = None) -> int:
    """Print what would run again, and why."""
    jobs, known = snakemake_jobs(sys.argv[1:] if arguments is None else arguments)
    print(report(jobs, known))
    return 0


if __name__ == "__main__":
    sys.exit(main())
