"""Control plans of a case: strategy, its settings, and the conditions.

The paper's protocol is one of them, and needs no block. A block of ``control.strategies`` stands
for all combinations of its lists. A plan's identifier names it in paths and tables: the strategy,
its settings, and those conditions that differ from the paper's.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import Any

from burstcast.control.setting_names import named
from burstcast.control.strategies.base import ControlStrategy
from burstcast.control.strategies.registry import make_strategy
from burstcast_workflow.config.model import StrategyBlock

WINDOWS = "prediction_triggered"
"""The paper's strategy."""

CONDITIONS = ("starts", "quiet_lt", "span_lt", "delay_lt", "strength", "noise")
"""What a strategy is tried under, whatever it is."""


@dataclass(frozen=True)
class ControlPlan:
    """A strategy with its settings, and conditions; None is what the campaign and the case say."""

    kind: str  #: kind of strategy: a module of `burstcast.control.strategies`
    settings: tuple[tuple[str, Any], ...]  #: its settings, names and values
    starts: str  #: ``quiet``, free of events, or ``unselected``
    quiet_lt: float  #: the least time before steps count
    span_lt: float | None  #: how long each flow counts; None: ``control.span_lt``
    #: delay_lt, strength: delay and strength of the actuator
    delay_lt: float
    strength: float
    noise: float | None  #: noise of the observations; None: the noise of the training series
    observed: str  #: case that is the observed part of the controlled one; empty: all is observed

    @cached_property
    def strategy(self) -> ControlStrategy:
        """The strategy; a ValueError if its settings are invalid."""
        return make_strategy(self.kind, dict(self.settings))

    @property
    def identifier(self) -> str:
        """Name of the plan in paths and tables."""
        parts = [self.kind]
        parts += [f"{name.removesuffix('_lt')}{named(value)}" for name, value in self.settings]
        if self.starts != _PAPER.starts:
            parts.append(self.starts)
        for name in CONDITIONS[1:]:
            value = getattr(self, name)
            if value != getattr(_PAPER, name):
                parts.append(f"{name.removesuffix('_lt')}{named(value)}")
        if self.observed:
            parts.append(f"observed{named(self.observed)}")
        return "-".join(parts)

    @property
    def is_of_the_paper(self) -> bool:
        """Whether it is the paper's protocol at some prediction time."""
        names = [name for name, _ in self.settings]
        papers = self == replace(_PAPER, settings=self.settings)
        return papers and names == ["prediction_time_lt", "window_lt"]

    def record(self, span_lt: float) -> dict[str, Any]:
        """Settings for a job, with the campaign's span by default."""
        conditions = {name: getattr(self, name) for name in CONDITIONS}
        conditions["span_lt"] = span_lt if self.span_lt is None else self.span_lt
        if self.observed:
            conditions["observed"] = self.observed
        return {"strategy": self.kind, "settings": dict(self.settings), **conditions}


def paper_plan(prediction_time_lt: float, window_lt: float) -> ControlPlan:
    """The paper's protocol at one prediction time."""
    values = (("prediction_time_lt", prediction_time_lt), ("window_lt", window_lt))
    return replace(_PAPER, settings=values)


def block_plans(block: StrategyBlock) -> Iterator[ControlPlan]:
    """Plans of a block of ``control.strategies``: all combinations of its lists."""
    names = sorted(block.settings)
    noises: list[float | None] = [*block.noise] or [None]
    conditions = product(block.delay_lt, block.strength, noises, block.observed or [""])
    several = product(*(block.settings[name] for name in names))
    for (delay_lt, strength, noise, observed), values in product(conditions, several):
        hashable = (tuple(value) if isinstance(value, list) else value for value in values)
        yield ControlPlan(
            kind=block.strategy,
            settings=tuple(zip(names, hashable, strict=True)),
            starts=block.starts,
            quiet_lt=block.quiet_lt,
            span_lt=block.span_lt,
            delay_lt=delay_lt,
            strength=strength,
            noise=noise,
            observed=observed,
        )


_PAPER = next(block_plans(StrategyBlock(strategy=WINDOWS)))
"""The paper's conditions: those of a block that gives none."""
