"""What each rule makes, from what, with which settings and code, and where that ends.

::

    burstcast explain [RULE ...] [options of snakemake]

It is of the campaign of config.yaml, or of the one that options name; without a rule, of all of
them, as a page.
"""

import ast
import re
import sys
import textwrap
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from burstcast.base.discovery import suggestion
from burstcast_workflow.campaign.job_settings import meaning_of
from burstcast_workflow.commands.planned import options_of, planned
from burstcast_workflow.harness.call import is_script
from burstcast_workflow.snakemake_internals import jobs_with_sources, rules_of
from burstcast_workflow.stages.stages import RuleSettings
from burstcast_workflow.start import rules_of_burstcast

_HEAD = """\
# Rules

What does each rule make, from what, with which settings and code, and in which tables and figures
does that end? `burstcast explain RULE` says it of one, and with `--configfile` of your campaign.

A setting is a path in config.yaml, of one setting or of a section. `case.` stands for the case of
the job, `forecaster.` for the section of its kind of forecaster, `job.` and `shown.` for what
follows from the campaign. What does not concern a job is left out of its settings. Code is what the
script uses of these packages (`burstcast explain RULE` lists the modules), beside what all jobs
use. A job runs again if one of all this has changed ([selective rebuilds](selective_rebuilds.md)).
Names in parentheses are of the rules that make an input in the paper's campaign.
"""
_MOST = 12
"""Names that are listed; of more, their number is said."""


@dataclass(frozen=True)
class Explained:
    """A rule: names of files, rules, settings, modules, tables and figures."""

    name: str
    does: str
    makes: list[str]
    inputs: dict[str, list[str]]  #: rules that make an input, by its name; empty for files of users
    settings: list[str]
    code: list[str]
    tables: list[str]
    figures: list[str]
    jobs: int


def main(arguments: Sequence[str]) -> int:
    """Print what some rules are, or a page of all."""
    named = sorted(options_of(arguments).targets)
    workflow = planned([each for each in arguments if each not in named])
    explained = {rule.name: rule for rule in explained_rules(workflow)}
    for name in named:
        if name not in explained:
            print(f"there is no rule {name}{suggestion(name, explained)}", file=sys.stderr)
            return 2
    if named:
        rules = [explained[name] for name in named]
        texts = [text_of(rule, modules(rule.code)) for rule in rules]
    else:
        rules = [*explained.values()]
        texts = [_HEAD, *(text_of(rule, rooms(rule.code)) for rule in rules)]
    print("\n".join([*texts, *meanings(rules)]), end="")
    return 0


def explained_rules(workflow: Any) -> Iterator[Explained]:
    """Rules with a script, in the order of the files of rules."""
    results = rules_of_burstcast(workflow)["started"].results
    jobs = jobs_with_sources(workflow)
    shared = set.intersection(*({*job.params.code} for job in jobs if job.rule.script))
    users: dict[Any, set[Any]] = {}
    for job, sources in jobs.items():
        for source in sources:
            users.setdefault(source, set()).add(job)
    for rule in rules_of(workflow):
        if not rule.script:
            continue
        own = [job for job in jobs if job.rule is rule]
        inputs: dict[str, list[str]] = {name: [] for name, _ in rule.input.items()}
        for job in own:
            makers = {path: source.rule.name for source in jobs[job] for path in source.output}
            for name, paths in job.input.items():
                listed = [paths] if isinstance(paths, str) else paths
                made = {makers[path] for path in listed if path in makers}
                inputs[name] = sorted({*inputs.get(name, []), *made})
        ends = _reached(own, users)
        code = {name for job in own for name in job.params.code}
        yield Explained(
            name=rule.name,
            does=_does(rule),
            makes=[_pattern(str(path).removeprefix(f"{results}/")) for path in rule.output],
            inputs=inputs,
            settings=_settings_of(rule, own),
            code=sorted(code - shared),
            tables=sorted(
                {
                    Path(path).stem
                    for job in ends
                    for path in job.output
                    if path.startswith(f"{results}/tables/") and path.endswith(".csv")
                }
            ),
            figures=sorted({Path(job.output[0]).stem for job in ends if job.rule.name == "figure"}),
            jobs=len(own),
        )


def _settings_of(rule: Any, jobs: Iterable[Any]) -> list[str]:
    if isinstance(rule.params.settings, RuleSettings):
        return rule.params.settings.names
    return sorted({name for job in jobs for name in job.params.settings})


def _reached(jobs: Iterable[Any], users: Mapping[Any, set[Any]]) -> set[Any]:
    """Jobs, and all that read what they make, directly or not."""
    reached, waiting = set(jobs), [*jobs]
    while waiting:
        more = users.get(waiting.pop(), set()) - reached
        reached |= more
        waiting += more
    return reached


def _does(rule: Any) -> str:
    """First line of the docstring of what the rule runs: a maker of tables, or a script."""
    maker = rule.params.get("maker")
    if maker:
        from burstcast.tables.makers.registry import maker as maker_of

        text = sys.modules[maker_of(maker).__module__].__doc__ or ""
    else:
        script = Path(str(rule.basedir)) / str(rule.script)
        text = ast.get_docstring(ast.parse(script.read_bytes())) or ""
    return text.partition("\n\n")[0].replace("\n", " ").strip()


def _pattern(path: str) -> str:
    """Path with the names of its wildcards, without what these may be."""
    return re.sub(r"\{(\w+),[^}]*\}", r"{\1}", path)


def modules(code: Iterable[str]) -> str:
    """Names of code by the packages that they lie in: ``burstcast.base (arrays, events)``."""
    by_package: dict[str, list[str]] = {}
    for name in code:
        package, _, module = ("", "", name) if is_script(name) else name.rpartition(".")
        by_package.setdefault(package, []).append(module)
    return ", ".join(
        f"`{package}` ({', '.join(names)})" if package else f"`{names[0]}`"
        for package, names in by_package.items()
    )


def rooms(code: Iterable[str]) -> str:
    """The script, and the packages that its code lies in: ``burstcast.base``."""
    scripts = [f"`{name}`" for name in code if is_script(name)]
    packages = {".".join(name.split(".")[:2]) for name in code if not is_script(name)}
    return ", ".join([*scripts, *(f"`{name}`" for name in sorted(packages))])


def meanings(rules: Iterable[Explained]) -> list[str]:
    """A section about settings that do not stand in the config as they are; none without any."""
    paths = sorted({path for rule in rules for path in rule.settings})
    lines = [f"* `{path}`: {meaning}" for path in paths if (meaning := meaning_of(path))]
    head = "## Settings that follow from others\n"
    return ["\n".join([head, *map(_wrapped, lines), ""])] if lines else []


def _wrapped(line: str) -> str:
    return textwrap.fill(
        line, 100, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False
    )


def text_of(rule: Explained, code: str) -> str:
    """A section of the page, in which the code is called so."""
    read = [
        f"`{name}` ({', '.join(makers)})" if makers else f"`{name}`"
        for name, makers in rule.inputs.items()
    ]
    lines = [
        f"## {rule.name}\n\n{rule.does}\n",
        f"* makes {_listed(rule.makes, '`')}",
        f"* from {', '.join(read) or 'the settings alone'}",
        f"* settings: {_listed(rule.settings, '`', most=len(rule.settings))}",
    ]
    if rule.jobs:
        ends = f"{_counted(rule.tables, 'table')}; {_counted(rule.figures, 'figure')}"
        lines += [f"* code: {code}", f"* ends in {ends}"]
    else:
        lines += ["* no job in this campaign"]
    return "\n".join([lines[0], *map(_wrapped, lines[1:])]) + "\n"


def _listed(names: Sequence[str], mark: str = "", most: int = _MOST) -> str:
    shown = [f"{mark}{name}{mark}" for name in names[:most]]
    more = [f"{len(names) - most} more"] if len(names) > most else []
    return ", ".join([*shown, *more]) or "none"


def _counted(names: Sequence[str], noun: str) -> str:
    if not names:
        return f"no {noun}"
    if len(names) > _MOST:
        return f"{len(names)} {noun}s"
    return f"the {noun}{'s' if len(names) > 1 else ''} {_listed(names)}"
