"""Jobs that a dry run would start, grouped by what they would run for.

Snakemake lists each job with its reason, which has the representations of parameters that changed,
before and now. Those of burstcast's rules are mappings: settings by their paths, and code, hashes
by the names of scripts and modules and versions by those of libraries.
"""

import ast
import json
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

_LIBRARY = "library:"
_NOW = " now: "
_LITERAL_OR_NOW = re.compile(rf"'(?:[^'\\]|\\.)*'|\"(?:[^\"\\]|\\.)*\"|{_NOW}")
_PARAMETERS = "Params have changed since last execution: "
_BEFORE_ALL = "Union of exclusive params before and now across all output: before: "
_REASONS = (
    (re.compile(r"Forced execution"), "asked for by an option"),
    (re.compile(r"Missing output files: "), "results are missing"),
    (re.compile(r"Incomplete output files: "), "interrupted before it was complete"),
    (re.compile(r"Updated input files: (?P<files>[^;]+)"), "changed: {files}"),
    (re.compile(r"Set of input files has changed"), "made from other files"),
    (re.compile(r"Code has changed"), "the code has changed"),
    (re.compile(r"Software environment definition has changed"), "another software environment"),
)
_UNRECORDED = "made with other settings, code or inputs than now, or by no job"
_LONGEST_VALUE = 60
_BEFORE = 20
"""Characters of a long value that are shown before where it differs from others."""

_MOST_MODULES = 3

unrecorded: set[str] = set()
"""Results that Snakemake would believe in, and the workflow does not."""


@dataclass(frozen=True)
class PlannedJob:
    """A job of a dry run, and Snakemake's reason for it."""

    rule: str
    case: str  #: "" if it belongs to none
    inputs: Sequence[str]
    outputs: Sequence[str]
    reason: str


def explanation(jobs: Sequence[PlannedJob]) -> str:
    """What the jobs would run for: each reason with all jobs that it sets off, directly or not."""
    if not jobs:
        return "Nothing to be done"
    jobs = _in_order(jobs)
    causes: dict[str, set[int]] = {}
    cases: dict[str, set[str]] = {}
    for number, job in enumerate(jobs):
        for text, case in own_causes(job):
            causes.setdefault(text, set()).add(number)
            cases.setdefault(text, set()).update(filter(None, [case or job.case]))
    users = _users(jobs)
    by_jobs: dict[tuple[frozenset[int], str], list[str]] = {}
    for text, numbers in causes.items():
        whole = _set_off(numbers, users)
        by_jobs.setdefault((whole, ", ".join(sorted(cases[text]))), []).append(text)
    lines = []
    for (whole, whose), texts in sorted(by_jobs.items(), key=lambda item: -len(item[0][0])):
        reason = "; ".join(sorted(texts)) + (f" ({whose})" if whose else "")
        lines.append(f"{reason}: {_counted(jobs[number] for number in sorted(whole))}")
    total = f"in all {len(jobs)} job" if len(jobs) == 1 else f"in all {len(jobs)} jobs"
    return "\n".join([*lines, f"{total}: {_counted(jobs)}" if len(lines) > 1 else total])


def own_causes(job: PlannedJob) -> Iterator[tuple[str, str]]:
    """Text of each cause that lies in the job itself, and the case of a setting of several."""
    reason, _, parameters = job.reason.partition(_PARAMETERS)
    if unrecorded.intersection(job.outputs):
        yield _UNRECORDED, ""
        return
    for pattern, text in _REASONS:
        if match := pattern.search(reason):
            yield text.format(**match.groupdict()).strip(), ""
    if parameters:
        yield from differences(*_before_and_now(parameters))


def _before_and_now(text: str) -> tuple[list[Any], list[Any]]:
    """Parameters before and now, from Snakemake's text of both."""
    for match in _LITERAL_OR_NOW.finditer(text):
        if match[0] == _NOW:
            return _values(text[: match.start()]), _values(text[match.end() :])
    return [], []


@cache
def _values(text: str) -> list[Any]:
    """Values of representations with commas between them."""
    try:
        return [*ast.literal_eval(f"[{text.removeprefix(_BEFORE_ALL).strip()}]")]
    except (ValueError, SyntaxError):
        return []  # "<nothing exclusive>", or of a rule of others


def differences(before: Iterable[Any], now: Iterable[Any]) -> Iterator[tuple[str, str]]:
    """Text of each difference of parameters, and the case that it is of, or ""."""
    settings, code = _sorted_out(before)
    settings_now, code_now = _sorted_out(now)
    for case, path in sorted({*settings, *settings_now}):
        pair = (settings.get((case, path), _NONE), settings_now.get((case, path), _NONE))
        if _text(pair[0]) != _text(pair[1]):
            yield f"{path} {_change(*pair)}", case
    names = {*code, *code_now}
    libraries = {name for name in names if name.startswith(_LIBRARY)}
    differing = {name for name in names if code.get(name) != code_now.get(name)}
    # a module that was edited explains why others are used that were not
    both = code.keys() & code_now.keys()
    modules = sorted(differing & both - libraries) or sorted(differing - libraries)
    if modules:
        more = f" and {len(modules) - _MOST_MODULES} more" if len(modules) > _MOST_MODULES else ""
        yield f"code of {', '.join(modules[:_MOST_MODULES])}{more}", ""
    for name in sorted(differing & libraries):
        versions = f"{code.get(name, 'none')} -> {code_now.get(name, 'none')}"
        yield f"{name.removeprefix(_LIBRARY)} {versions}", ""


_NONE = object()


def _sorted_out(
    parameters: Iterable[Any],
) -> tuple[dict[tuple[str, str], Any], dict[str, str]]:
    """Settings by case (or "") and path, and code by name: only the latter has a script."""
    settings: dict[tuple[str, str], Any] = {}
    code: dict[str, str] = {}
    for value in parameters:
        if not isinstance(value, Mapping):
            continue
        if any(name.endswith(".py") for name in value):
            code |= value
        else:
            for path, below in value.items():
                settings.update(_leaves(path, below))
    return settings, code


def _leaves(path: str, value: Any) -> Iterator[tuple[tuple[str, str], Any]]:
    """Values that are no mappings, by case (or "") and path; cases are those in ``cases``."""
    if isinstance(value, Mapping) and value:
        for name, inner in value.items():
            yield from _leaves(f"{path}.{name}", inner)
    else:
        first, _, others = path.partition(".")
        case, _, setting = others.partition(".")
        yield (case, setting) if first == "cases" and setting else ("", path), value


def _change(before: Any, now: Any) -> str:
    if isinstance(before, list) and isinstance(now, list) and len(before) + len(now) > 4:
        old, new = Counter(map(_text, before)), Counter(map(_text, now))
        added, removed = [*(new - old).elements()], [*(old - new).elements()]
        if len(added) + len(removed) < min(len(before), len(now)):
            others = {*old, *new}
            changes = [f"with {_shown(text, others)}" for text in added]
            changes += [f"without {_shown(text, others)}" for text in removed]
            return ", ".join(changes) or "in another order"
    pair = _text(before), _text(now)
    return " -> ".join(_shown(text, pair) for text in pair)


def _text(value: Any) -> str:
    """A value as JSON, which tells 1 from true and from "1"."""
    return "none" if value is _NONE else json.dumps(value, ensure_ascii=False, sort_keys=True)


def _shown(text: str, others: Iterable[str]) -> str:
    """A value for a person: of a long one, what no other begins with is among the characters."""
    if text.startswith('"') and text[1:-1] not in others:
        text, others = json.loads(text), [json.loads(o) for o in others if o.startswith('"')]
    if len(text) <= _LONGEST_VALUE:
        return text
    shared = max((_shared(text, other) for other in others if other != text), default=0)
    room = _LONGEST_VALUE - len("...")
    if shared < room:
        return f"{text[:room]}..."
    start = shared - _BEFORE
    if start >= len(text) - room:
        return f"...{text[-room:]}"
    return f"...{text[start : start + room - len('...')]}..."


def _shared(one: str, other: str) -> int:
    """Number of characters that two texts begin with alike."""
    pairs = enumerate(zip(one, other, strict=False))
    return next((n for n, (a, b) in pairs if a != b), min(len(one), len(other)))


def _users(jobs: Sequence[PlannedJob]) -> list[set[int]]:
    """Jobs that read what each job makes."""
    maker = {path: number for number, job in enumerate(jobs) for path in job.outputs}
    users: list[set[int]] = [set() for _ in jobs]
    for number, job in enumerate(jobs):
        for path in job.inputs:
            if path in maker:
                users[maker[path]].add(number)
    return users


def _in_order(jobs: Sequence[PlannedJob]) -> list[PlannedJob]:
    """Jobs after all that they read from, level by level: Snakemake tells groups in any order."""
    users = _users(jobs)
    lacking = Counter(user for of_job in users for user in of_job)
    level = [number for number in range(len(jobs)) if not lacking[number]]
    ordered: list[PlannedJob] = []
    while level:
        level.sort(key=lambda number: (jobs[number].rule, [*jobs[number].outputs]))
        ordered += [jobs[number] for number in level]
        after: list[int] = []
        for user in (user for number in level for user in users[number]):
            lacking[user] -= 1
            after += [] if lacking[user] else [user]
        level = after
    return ordered


def _set_off(first: Iterable[int], users: Sequence[set[int]]) -> frozenset[int]:
    """Jobs, and all that these set off, directly or not."""
    reached, waiting = set(first), [*first]
    while waiting:
        more = users[waiting.pop()] - reached
        reached |= more
        waiting += more
    return frozenset(reached)


def _counted(jobs: Iterable[PlannedJob]) -> str:
    counts = Counter(job.rule for job in jobs)
    return ", ".join(f"{rule} ({count})" for rule, count in counts.items())
