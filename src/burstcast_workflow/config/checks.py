"""Checks between settings of a config that are valid by themselves.

Bounds of one setting that are other settings stand in the model, what holds within a case in
`burstcast_workflow.config.case_checks`. Here are the others.
"""

import math
from collections.abc import Iterable, Iterator
from typing import Any

from pydantic import TypeAdapter, ValidationError

from burstcast.base.names import parsed
from burstcast.control.controllers import VOTE_SHARE, votes
from burstcast.control.strategies.registry import strategy_class
from burstcast.data.training_realisations import realisation_of
from burstcast.forecasters.registry import all_kinds, available_kinds, kind_class, trajectory_kinds
from burstcast.systems.registry import system_class
from burstcast_workflow.config.bounds import out_of_bounds
from burstcast_workflow.config.case import CaseEntry, Simulated
from burstcast_workflow.config.case_checks import problems_of_case
from burstcast_workflow.config.cases import class_defaults, valid_case
from burstcast_workflow.config.control_plans import block_plans
from burstcast_workflow.config.forecasters import NetworkChoice
from burstcast_workflow.config.kinds import Quantile
from burstcast_workflow.config.measured_cases import is_encoded
from burstcast_workflow.config.model import Block, Configuration, StrategyBlock, case_name
from burstcast_workflow.config.problems import of_cases, problems_of, unknown


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
        *_same_names(config),
        *_strategies(config),
        *_without_trajectories("statistics.forecasters", config.statistics.forecasters.kinds),
        *_without_trajectories("control.forecasters", config.control.forecasters.kinds),
        *_figures(config),
    ]
    cases = _cases(config)
    checked = [name for name in config.case_names if name in cases]
    problems += of_cases((name, problems_of_case(config, name)) for name in checked)
    return list(dict.fromkeys(problems))


def _cases(config: Configuration) -> list[str]:
    """Names with an entry in ``cases``, and names of Reynolds numbers, which need none."""
    numbers = [value for block in config.campaign for value in block.reynolds]
    return list(dict.fromkeys([*config.cases, *map(case_name, numbers)]))


def _class_defaults(config: Configuration) -> Iterator[str]:
    """Check what classes of systems say of their cases as if it stood in the config."""
    used = [config.cases[name] for name in config.case_names if name in config.cases]
    for system in dict.fromkeys(entry["system"] for entry in used if entry.get("system")):
        problems = []
        try:
            TypeAdapter(CaseEntry).validate_python(class_defaults(system))
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
    if config.forecasters.esn.readout != "linear":
        yield (
            "forecasters.esn.readout: networks with squares have a name of their own: say "
            "forecasters.variants: {quadratic: {readout: quadratic}}, and variants: [quadratic] in "
            "the campaign"
        )
    cases, variants = _cases(config), config.forecasters.variants
    for name in variants:
        if f"esn_{name}" in all_kinds():
            yield f"forecasters.variants.{name}: esn_{name} is another kind; take another name"
    for index, block in enumerate(config.campaign):
        place = f"campaign[{index}]"
        if not block.case_names:
            yield f"{place} names no case: give it reynolds: [...] or cases: [...]"
        yield from unknown(block.cases, cases, f"{place}.cases: there is no case {{}} in cases")
        for name in dict.fromkeys([*block.cases, *map(case_name, block.reynolds)]):
            if name in cases:
                yield from _realisations(config, place, block, name)
        if not block.forecasters.kinds:
            yield f"{place}.forecasters names no kind: give it esn, equations, ..."
        for axes in block.forecasters.networks:
            text = f"{place}.forecasters: there is no {{}} in forecasters.variants"
            yield from unknown(axes.variants, variants, text)
        yield from _connections(config, place, block)
    for name in config.cases:
        base, number = realisation_of(name)
        if number:
            yield (
                f"cases.{name}: names that end so belong to other training series of {base} "
                "(campaign.realisations); take another name"
            )
    text = "control.sweep.cases: the campaign has no case {}"
    yield from unknown(config.control.sweep.cases, config.case_names, text)


def _connections(config: Configuration, place: str, block: Block) -> Iterator[str]:
    """Whether the smallest reservoir has neurons enough for the connections of each."""
    settings = config.forecasters
    of_variants = [variant.dump().get("connectivity", 0) for variant in settings.variants.values()]
    connectivity = max([settings.esn.connectivity, *of_variants])
    sizes = [
        (min(axes.neurons), f"{place}.forecasters.esn.neurons")
        for axes in block.forecasters.networks
    ]
    if "esn_direct" in block.forecasters.kinds:
        sizes.append((settings.esn_direct.neurons, "forecasters.esn_direct.neurons"))
    smallest, where = min(sizes, default=(math.inf, ""))
    if connectivity > smallest - 1:
        yield (
            f"forecasters.esn.connectivity is {connectivity:g}, but a reservoir of {smallest} "
            f"neurons ({where}) has at most {smallest - 1} connections per neuron"
        )


def _same_names(config: Configuration) -> Iterator[str]:
    """Different classes of one's own, or options of a class, that tables would call the same."""
    named: dict[str, tuple[str, dict[str, Any]]] = {}
    for index, block in enumerate(config.campaign):
        for kind, forecaster in block.forecasters.own.items():
            name = "_".join(filter(None, [kind.rpartition(":")[2], forecaster.label]))
            if named.setdefault(name, (kind, forecaster.options)) != (kind, forecaster.options):
                yield (
                    f"campaign[{index}].forecasters: {kind} and another forecaster of the campaign "
                    f"are both called {name} in tables; give one of them a label: {{{kind}: "
                    f"{{label: other, ...}}}}"
                )


def _realisations(config: Configuration, place: str, block: Block, name: str) -> Iterator[str]:
    """Whether an ensemble may have as many choices of training series as are wanted."""
    case, shares = valid_case(config, name), block.event_shares
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
            setting = f"event_shares has {len(shares)}" if shares else f"realisations is {count}"
            yield (
                f"{place}.{setting}; choices of training series that share none, the test series "
                f"and the calibration series are {needed} series of {name}, but ensemble.series is "
                f"{case.ensemble.series}"
            )


def _strategies(config: Configuration) -> Iterator[str]:
    for place, block in config.control.blocks:
        name = block.strategy
        text = f"{place}.cases: the campaign has no case {{}}"
        yield from unknown(block.cases, config.case_names, text)
        strategy = strategy_class(name)
        if strategy.forecasts and not block.kinds:
            yield f"{place}.forecasters names no kind, but {name} asks forecasters"
        if block.kinds and not strategy.forecasts:
            yield f"{place}.forecasters: {name} uses no forecaster; leave it out"
        yield from _without_trajectories(
            f"{place}.forecasters", block.kinds, strategy.by_probability
        )
        yield from _observed(config, block, place)
        plain = [kind for kind in block.kinds if not kind_class(kind).aware]
        for plan in block_plans(block):
            try:
                if plan.strategy.informed and plain:
                    yield (
                        f"{place}: {name} passes the parameters in force to forecasters, which "
                        f"{', '.join(plain)} cannot use; take kinds that know them"
                    )
            except ValueError as error:
                yield f"{place}.settings: {error}"
        most = len(config.classification.prediction_times_lt)
        windows = block.settings.get("windows", [])
        if any(isinstance(count, float) and count > most for count in windows):
            yield f"{place}.settings.windows: classifiers have {most}, one for each prediction time"
        yield from _votes(block, place)


def _without_trajectories(
    place: str, kinds: Iterable[str], by_probability: bool = False
) -> Iterator[str]:
    """Kinds that forecast no states where trajectories are needed, or the reverse."""
    classifiers = sorted({*available_kinds()} - {*trajectory_kinds()})
    for kind in kinds:
        if kind_class(kind).has_trajectories != by_probability:
            continue
        if by_probability:
            yield (
                f"{place} names {kind}, which forecasts states; a strategy that acts on "
                f"probabilities takes classifiers: {', '.join(classifiers)}"
            )
        else:
            yield (
                f"{place} names {kind}, which gives probabilities of events and forecasts no "
                "states; leave it out"
            )


def _observed(config: Configuration, block: StrategyBlock, place: str) -> Iterator[str]:
    """Mistakes in the parts of the state that a block of strategies observes."""
    used = config.case_names
    parts = {case: data for case in used if (data := config.data_of(case)) and data.case}
    yield from unknown(block.observed, parts, f"{place}.observed: {{}} is no part of another case")
    for part in filter(parts.__contains__, block.observed):
        delays, source = parts[part].delays, str(parts[part].case)
        if delays and not is_encoded(config.entry_of(part)):
            yield f"{place}.observed: {part} has past values (data.delays), which control has not"
        whole = valid_case(config, source)
        if whole and (not whole.actuation or source not in (block.cases or [source])):
            yield (
                f"{place}.observed: {part} is a part of {source}, which this block does not "
                f"control: give {source} an actuation, and name it in cases or leave cases out"
            )
        if block.kinds and block.kinds.keys().isdisjoint(config.kinds_of(part)):
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
        if isinstance(share, float) and not 0 < share <= 1:  # others are reported elsewhere
            yield (
                f"{place}.settings.{VOTE_SHARE} has {share:g}, but a share of the votes is above "
                "0, and 1 at most"
            )
    if block.seeds is not None:
        yield f"{place}.seeds: all networks of a size and strategy are a committee; leave it out"
    for kind, axes in block.kinds.items():
        if not (isinstance(axes, NetworkChoice) or kind_class(kind).provides_ensemble):
            yield f"{place}.forecasters names {kind}, which provides no ensemble that could vote"


def _figures(config: Configuration) -> Iterator[str]:
    figures = config.figures
    name = figures.example_case or ""
    if figures.example_forecaster is not None:
        networks = [
            network
            for block in config.blocks_of(name)
            for network in block.forecasters.names("esn")
            if network.label is None
        ]
        if parsed(figures.example_forecaster) not in networks:
            has = networks[0].identifier if networks else "none"
            yield (
                f"the example network of the figures ({name}, {figures.example_forecaster}) is not "
                "part of the campaign: change figures.example_case or figures.example_forecaster "
                f"({name} has {has})"
            )
    elif any(block.forecasters.esn for block in config.campaign):
        yield (
            f"figures.example_case is {name}, which is not part of the campaign, or has no "
            "network of the size figures.fixed_neurons"
        )
    case, peak = valid_case(config, name), figures.flow_event.peak
    if isinstance(case, Simulated) and isinstance(threshold := case.event_threshold, float):
        laminar = case.laminarisation_threshold or math.inf
        if peak <= threshold < laminar and case.is_flow:
            yield (
                f"figures.flow_event.peak is {peak:g}; it must be above the event_threshold of "
                f"{name}, {threshold:g}"
            )
