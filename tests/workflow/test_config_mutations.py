"""Whatever is wrong with a config: a plan, or messages that name settings; never a traceback.

The number of mutations is BURSTCAST_MUTATIONS (500), their seed BURSTCAST_SEED (it is printed).
"""

import copy
import datetime
import functools
import json
import math
import operator
import os
import random

import pytest
from helpers_configs import paper_with, read
from helpers_rebuilds import ROOT

from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.campaign.job_settings import settings_of_cases, settings_of_job
from burstcast_workflow.campaign.loading import ConfigError, load
from burstcast_workflow.config.model import Configuration
from burstcast_workflow.figures import registry
from burstcast_workflow.figures.registry import FIGURES, figure_names
from burstcast_workflow.harness.canonical import canonical_json
from burstcast_workflow.jobs.forecasters import CaseInputs
from burstcast_workflow.tables.registry import latex_names, table_names

NUMBER = int(os.environ.get("BURSTCAST_MUTATIONS", "500"))
SEED = int(os.environ.get("BURSTCAST_SEED", "2026"))
PRESETS = ("tiny", "miniature", "quick", "beyond_the_paper")

# of all types, in and out of range, as YAML reads them
VALUES = [
    *(None, True, False, "", " ", "text", "1", "1e-6", "1.0e5", "nan", "../x", "a/b", "{case}"),
    *(0, 1, 2, 3, -1, 7, 100, 10**6, 10**12, 2**64, 10**400, -(10**400), "é\n"),
    *(0.0, -0.0, 0.5, 1.5, -2.5, 1e-9, 1e-320, 1e300, math.nan, math.inf, -math.inf),
    *([], {}, [1], [1, 1], [0.5, "x"], [[]], [None], [2, 1], {"x": 1}, {1: 2}, {None: []}, [{}]),
    *(datetime.date(2026, 1, 1), b"bytes", "Re400", "Re1e3", "esn-N40-RV-seed0", "mfe", "RV"),
]
Place = tuple[str | int, ...]


def places(node: object, path: Place = ()) -> list[Place]:
    """Paths of everything in a config, sections and settings."""
    listed = dict(enumerate(node)) if isinstance(node, list) else node
    items = listed.items() if isinstance(listed, dict) else []
    deeper = [place for key, value in items for place in places(value, (*path, key))]
    return [path, *deeper] if path else deeper


def at(node, path: Place):
    return functools.reduce(operator.getitem, path, node)


def mutated(config: dict, chance: random.Random) -> tuple[dict, list[str]]:
    """A config with one to three changes, and what they are."""
    config, changes = copy.deepcopy(config), []
    for _ in range(chance.choice([1, 1, 1, 2, 3])):
        path = chance.choice(places(config))
        *above, key = path
        parent, value = at(config, above), at(config, path)
        kind = chance.choice(["value", "value", "scaled", "scaled", "missing", "extra", "copied"])
        if kind == "scaled" and isinstance(value, (int, float)) and not isinstance(value, bool):
            new = value * chance.choice([-1, 0.1, 0.5, 2, 3, 10, 1000])
        elif kind == "copied":
            new = copy.deepcopy(at(config, chance.choice(places(config))))
        else:
            new = copy.deepcopy(chance.choice(VALUES))
        if kind == "missing":
            del parent[key]
        elif kind == "extra" and isinstance(parent, dict):
            key = chance.choice([f"{key}x", f"{key}"[:-1], "", 3, None, chance.choice(path)])
            parent[key] = new
        else:
            parent[key] = new
        changes.append(f"{kind} {'.'.join(map(str, (*above, key)))}: {new!r:.80}")
        if not config:
            break
    return config, changes


def base(chance: random.Random) -> dict:
    """The config of a campaign, as Snakemake merges it."""
    preset = chance.choice(["", *PRESETS])
    return paper_with(read(ROOT / f"workflow/presets/{preset}.yaml") if preset else {})


def plan(config: dict) -> None:
    """Expand a campaign as the workflow does."""
    campaign = Campaign(config)
    runs = [*campaign.control_runs, *campaign.strategy_runs]
    records = [settings_of_job(campaign, ["control.run"], run.identity) for run in runs]
    directories = [forecaster.directory for forecaster in campaign.forecasters]
    canonical_json([records, settings_of_cases(campaign, CaseInputs), directories])
    canonical_json([table_names(campaign), latex_names(campaign)])
    of_each_kind = {(model.case, model.name.kind): model for model in campaign.forecasters}
    for forecaster in of_each_kind.values():
        campaign.modules(forecaster.identity)
        settings_of_job(campaign, ["forecaster.options", "case.training"], forecaster.identity)
    for name in figure_names(campaign):
        figure = max((figure for figure in FIGURES if name.startswith(figure)), key=len)
        case = registry.figure_case(campaign, figure, name.removeprefix(figure))
        registry.files_of(campaign, FIGURES[figure], case)
        canonical_json(registry.settings_of(campaign, FIGURES[figure], case))


def outcome(config: dict) -> list[str]:
    """What is wrong with a config; nothing if it has a plan."""
    try:
        loaded = load(config, defaults=ROOT / "config.yaml")
    except ConfigError as error:
        return error.problems
    plan(loaded)
    return []


@pytest.mark.long
def test_mutated_configs_have_a_plan_or_clear_messages(capsys):
    trials = [random.Random(f"{SEED} {number}") for number in range(NUMBER)]
    counts, failures = {"plans": 0, "messages": 0}, []
    sections = (*Configuration.model_fields, "case", "the key")
    for number, chance in enumerate(trials):
        config, changes = mutated(base(chance), chance)
        try:
            problems = outcome(config)
        except Exception as error:
            failures.append(f"{number}: {changes}: {type(error).__name__}: {error}")
            continue
        counts["messages" if problems else "plans"] += 1
        for problem in problems:
            # of a reasonable length, and about a setting
            if len(problem) > 600 or not any(name in problem for name in sections):
                failures.append(f"{number}: {changes}: {problem}")
    with capsys.disabled():
        print(f"\nseed {SEED}: {NUMBER} mutations, {json.dumps(counts)}, {len(failures)} failures")
    assert not failures, "\n".join(failures)
    assert min(counts.values()) > NUMBER / 20  # it tries both
