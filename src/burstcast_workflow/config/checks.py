"""Checks between settings of a config that are valid by themselves.

Bounds of one setting that are other settings stand in the model, what holds within a case in
`burstcast_workflow.config.case_checks`. Here are the others.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any

from pydantic import TypeAdapter, ValidationError

from burstcast.base.names import parsed
from burstcast.control.controllers import VOTE_SHARE, votes
from burstcast.control.strategies.registry import strategy_class
from burstcast.data.training_realisations import realisation_of
from burstcast.forecasters.registry import (
    all_kinds,
    available_kinds,
    kind_class,
    trajectory_kinds,
)
from burstcast.systems.registry import system_class
from burstcast_workflow.config.bounds import out_of_bounds
from burstcast_workflow.config.case import CaseEntry, Simulated
from burstcast_workflow.config.case_checks import CaseChecks
from burstcast_workflow.config.cases import (
    said_by_class,
    sound_case,
)
from burstcast_workflow.config.control_plans import ControlPlan, plan_values
from burstcast_workflow.config.forecasters import NetworkChoice
from burstcast_workflow.config.kinds import Quantile
from burstcast_workflow.config.measured_cases import is_encoded
from burstcast_workflow.config.model import Block, Configuration, StrategyBlock, case_name
from burstcast_workflow.config.problems import of_cases, problems_of, suggestion


def contradictions(config: Configuration) -> list[str]:
    """Check relations between settings; one message for each mistake.

    Unused cases are not checked: an overlay may shorten the series of all cases without adjusting
    cases that it does not use.
    """
    if unsound := list(_class_defaults(config)):  # no case can be made of them
        return unsound
    problems = [
        *out_of_bounds(config),
        *_campaign(config),
        *_strategies(config),
        *_without_trajectories(config),
        *_figures(config),
    ]
    known = [name for name in config.case_names if name in _known_cases(config)]
    problems += of_cases((name, CaseChecks(config, name).problems()) for name in known)
    return list(dict.fromkeys(problems))


def _known_cases(config: Configuration) -> list[str]:
    """Names with an entry in ``cases``, and names of Reynolds numbers, which need none."""
    numbers = [value for block in config.campaign for value in block.reynolds]
    return list(dict.fromkeys([*config.cases, *map(case_name, numbers)]))


def _class_defaults(config: Configuration) -> Iterator[str]:
    """Check what classes of systems say of their cases as if it stood in the config."""
    used = [config.cases[name] for name in config.case_names if name in config.cases]
    for system in dict.fromkeys(entry["system"] for entry in used if entry.get("system")):
        problems = []
        try:
            TypeAdapter(CaseEntry).validate_python(said_by_class(system))
        except ValidationError as error:
            problems = problems_of(error, Simulated)
        except (TypeError, ValueError) as error:  # no plain data
            problems = [str(error)]
        if problems:
            name = system_class(system).__name__
            yield f"case_defaults of the class {name} (system {system}): {'; '.join(problems)}"


def _campaign(config: Configuration) -> Iterator[str]:
    if config.case_defaults.data is not None:
        yield "case_defaults.data must be null: each case has data of its own, in cases.<name>.data"
    known, variants = _known_cases(config), config.forecasters.variants
    if config.forecasters.esn.readout != "linear":
        yield (
            "forecasters.esn.readout: networks with squares have a name of their own: say "
            "forecasters.variants: {quadratic: {readout: quadratic}}, and variants: [quadratic] in "
            "the campaign"
        )
    connectivity = config.forecasters.esn.connectivity
    for name, variant in variants.items():
        if f"esn_{name}" in all_kinds():
            yield f"forecasters.variants.{name}: esn_{name} is another kind; take another name"
        if "connectivity" in variant.model_fields_set:
            connectivity = max(connectivity, variant.connectivity)
    named: dict[tuple[str, str | None], tuple[str, Any]] = {}
    for index, block in enumerate(config.campaign):
        place = f"campaign[{index}]"
        for kind, own in block.forecasters.own.items():
            key = kind.rpartition(":")[2], own.label
            if named.setdefault(key, (kind, own.options)) != (kind, own.options):
                yield (
                    f"{place}.forecasters: {kind} and another forecaster of the campaign are both "
                    f"called {'_'.join(filter(None, key))} in tables; give one of them a label: "
                    f"{{{kind}: {{label: other, ...}}}}"
                )
        if not block.case_names:
            yield f"{place} names no case: give it reynolds: [...] or cases: [...]"
        for name in block.cases:
            if name not in known:
                yield f"{place}.cases: there is no case {name} in cases; {suggestion(name, known)}"
        for name in dict.fromkeys([*block.cases, *map(case_name, block.reynolds)]):
            if name in known:
                yield from _realisations(config, place, block, name)
        if not block.forecasters.kinds:
            yield f"{place}.forecasters names no kind: give it esn, equations, ..."
        for axes in block.forecasters.networks:
            for name in axes.variants:
                if name not in variants:
                    yield (
                        f"{place}.forecasters: there is no {name} in forecasters.variants; "
                        f"{suggestion(name, variants)}"
                    )
        sizes = [
            (min(axes.neurons), f"{place}.forecasters.esn.neurons")
            for axes in block.forecasters.networks
        ]
        if "esn_direct" in block.forecasters.kinds:
            sizes.append((config.forecasters.esn_direct.neurons, "forecasters.esn_direct.neurons"))
        smallest, where = min(sizes, default=(math.inf, ""))
        if connectivity > smallest - 1:
            yield (
                f"forecasters.esn.connectivity is {connectivity:g}, but a reservoir of {smallest} "
                f"neurons ({where}) has at most {smallest - 1} connections per neuron"
            )
    for name in config.cases:
        base, number = realisation_of(name)
        if number:
            yield (
                f"cases.{name}: names that end so belong to other training series of {base} "
                "(campaign.realisations); take another name"
            )
    used = config.case_names
    for name in config.control.sweep.cases:
        if name not in used:
            yield f"control.sweep.cases: the campaign has no case {name}; {suggestion(name, used)}"


def _realisations(config: Configuration, place: str, block: Block, name: str) -> Iterator[str]:
    """Whether an ensemble may have as many choices of training series as are wanted."""
    case, shares = sound_case(config, name), block.event_shares
    if shares and block.realisations > 1:
        yield f"{place} has realisations and event_shares; take one of them"
    if shares and name not in config.case_names:
        yield (
            f"{place}.event_shares: the series are drawn from the series of {name}, which no block "
            "of the campaign has without event_shares; add one"
        )
    longest = config.event_shares_of(name)
    if shares != longest[: len(shares)] or (block.realisations > 1 and longest):
        yield (
            f"{place}: another block chooses other training series of {name}, under the same "
            "names; one list of event_shares must begin with the other"
        )
    if case and shares and isinstance(case.event_threshold, Quantile):
        yield (
            f"{place}.event_shares: the event threshold of {name} is a quantile of the training "
            "series themselves; give it as a number"
        )
    count = len(shares) + 1 if shares else block.realisations
    if count > 1 and isinstance(case, Simulated):
        needed = count * case.training.series + case.test_series
        needed += config.probability.calibration_series
        if needed > case.ensemble.series:
            said = f"event_shares has {len(shares)}" if shares else f"realisations is {count}"
            yield (
                f"{place}.{said}; choices of training series that share none, the test series and "
                f"the calibration series are {needed} series of {name}, but ensemble.series is "
                f"{case.ensemble.series}"
            )


def _strategies(config: Configuration) -> Iterator[str]:
    used = config.case_names
    for index, block in enumerate(config.control.strategies):
        place, name = f"control.strategies[{index}]", block.strategy
        for case in block.cases:
            if case not in used:
                yield f"{place}.cases: the campaign has no case {case}; {suggestion(case, used)}"
        if strategy_class(name).forecasts and not block.kinds:
            yield f"{place}.forecasters names no kind, but {name} asks forecasters"
        if block.kinds and not strategy_class(name).forecasts:
            yield f"{place}.forecasters: {name} uses no forecaster; leave it out"
        yield from _observed(config, block, place)
        untold = [kind for kind in block.kinds if not kind_class(kind).aware]
        for values in plan_values(block):
            try:
                if ControlPlan(**values).strategy.informed and untold:
                    yield (
                        f"{place}: {name} passes the parameters in force to forecasters, which "
                        f"{', '.join(untold)} cannot use; take kinds that know them"
                    )
            except ValueError as error:
                yield f"{place}.settings: {error}"
        most = len(config.classification.prediction_times_lt)
        windows = block.settings.get("windows", [])
        if any(isinstance(count, float) and count > most for count in windows):
            yield f"{place}.settings.windows: classifiers have {most}, one for each prediction time"
        yield from _votes(block, place)


def _without_trajectories(config: Configuration) -> Iterator[str]:
    """Stages that need trajectories, chosen for kinds that forecast no states."""
    choices: dict[str, tuple[Iterable[str], bool]] = {
        "statistics.forecasters": (config.statistics.forecasters.kinds, False),
        "control.forecasters": (config.control.forecasters.kinds, False),
    }
    for index, block in enumerate(config.control.strategies):
        by_probability = strategy_class(block.strategy).by_probability
        choices[f"control.strategies[{index}].forecasters"] = block.kinds, by_probability
    for place, (kinds, by_probability) in choices.items():
        for kind in kinds:
            known = kind_class(kind)
            if known.has_trajectories and by_probability:
                classifiers = sorted({*available_kinds()} - {*trajectory_kinds()})
                yield (
                    f"{place} names {kind}, which forecasts states; a strategy that acts on "
                    f"probabilities takes classifiers: {', '.join(classifiers)}"
                )
            if not (known.has_trajectories or by_probability):
                yield (
                    f"{place} names {kind}, which gives probabilities of events and forecasts no "
                    "states; leave it out"
                )


def _observed(config: Configuration, block: StrategyBlock, place: str) -> Iterator[str]:
    """Mistakes in the parts of the state that a block of strategies observes."""
    used = config.case_names
    parts = {case: data for case in used if (data := config.data_of(case)) and data.case}
    for part in block.observed:
        if part not in parts:
            yield f"{place}.observed: {part} is no part of another case; {suggestion(part, parts)}"
            continue
        delays, source = parts[part].delays, str(parts[part].case)
        if delays and not is_encoded(config.entry_of(part)):
            yield f"{place}.observed: {part} has past values (data.delays), which control has not"
        whole = sound_case(config, source)
        if whole and (not whole.actuation or source not in (block.cases or [source])):
            yield (
                f"{place}.observed: {part} is a part of {source}, which this block does not "
                f"control: give {source} an actuation, and name it in cases or leave cases out"
            )
        there = {kind for one in config.blocks_of(part) for kind in one.forecasters.kinds}
        if block.kinds and there.isdisjoint(block.kinds):
            yield f"{place}.forecasters: the campaign has no {', '.join(block.kinds)} for {part}"


def _votes(block: StrategyBlock, place: str) -> Iterator[str]:
    """Mistakes in the voting settings of a block of control strategies."""
    shares = block.settings.get(VOTE_SHARE, [])
    if not block.committee:
        if shares:
            yield f"{place}.settings.{VOTE_SHARE} is for committees; say committee: true as well"
        return
    if True in block.settings.get("reversible", []):
        yield f"{place}.committee: a committee cannot vote about a direction; leave it out"
    if not votes(strategy_class(block.strategy)):
        yield f"{place}.committee: {block.strategy} has no votes; leave it out"
    for share in shares:
        if not isinstance(share, float):  # reported for the settings
            continue
        if not 0 < share <= 1:
            yield (
                f"{place}.settings.{VOTE_SHARE} has {share:g}, but a share of the votes is above "
                "0, and 1 at most"
            )
    if block.seeds is not None:
        yield f"{place}.seeds: all networks of a size and strategy are a committee; leave it out"
    for kind, axes in block.kinds.items():
        several = isinstance(axes, NetworkChoice)
        if not several and not kind_class(kind).provides_ensemble:
            yield f"{place}.forecasters names {kind}, which provides no ensemble that could vote"


def _figures(config: Configuration) -> Iterator[str]:
    figures = config.figures
    name = figures.example_case or ""
    example = parsed(figures.example_forecaster or "esn")
    if not figures.example_forecaster:
        if any(block.forecasters.esn for block in config.campaign):
            yield (
                f"figures.example_case is {name}, which is not part of the campaign, or has no "
                "network of the size figures.fixed_neurons"
            )
    else:
        there = [
            replace(example, neurons=neurons, validation=validation, seed=seed).identifier
            for networks in (block.forecasters.esn for block in config.blocks_of(name))
            if networks and not networks.variants
            for neurons in networks.neurons
            for validation in networks.validation
            for seed in range(networks.seeds)
        ]
        if replace(example, seed=example.seed or 0).identifier not in there:
            known = f"{name} has {there[0]}" if there else f"{name} has none"
            yield (
                f"the example network of the figures ({name}, {example.identifier}) is not part of "
                f"the campaign: change figures.example_case or figures.example_forecaster ({known})"
            )
    case, peak = sound_case(config, name), figures.flow_event.peak
    threshold = case.event_threshold if isinstance(case, Simulated) else None
    laminar = getattr(case, "laminarisation_threshold", None) or math.inf
    if isinstance(threshold, float) and peak <= threshold < laminar and case and case.is_flow:
        yield (
            f"figures.flow_event.peak is {peak:g}; it must be above the event_threshold of "
            f"{name}, {threshold:g}"
        )
