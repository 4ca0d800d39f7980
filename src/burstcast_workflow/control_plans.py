"""How a case is controlled: strategy, its settings, and the conditions that it is tried under.

The paper's protocol is one of them, and needs no block. A block of ``control.strategies`` stands
for all combinations of its lists. A plan's identifier names it in paths and tables: the strategy,
its settings, and those conditions that differ from the paper's.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any

from burstcast_workflow.canonical import canonical

Settings = dict[str, Any]
WINDOWS = "prediction_triggered"
"""The paper's strategy."""

CONDITIONS = ("starts", "quiet_lt", "span_lt", "delay_lt", "strength", "noise")
"""What a strategy is tried under, whatever it is."""


@dataclass(frozen=True)
class ControlPlan:
    """A strategy with its settings, and conditions; None is what the campaign and the case say.

    Attributes
    ----------
    strategy
        Module of `burstcast.control.strategies`.
    settings
        Its settings, names and values.
    starts
        ``quiet``, free of events, or ``unselected``.
    quiet_lt
        The least time before steps count.
    span_lt
        How long each flow counts; None: ``control.span_lt``.
    delay_lt, strength
        Of the actuator.
    noise
        Of the observations; None: that of the training series.
    """

    strategy: str
    settings: tuple[tuple[str, float], ...]
    starts: str = "quiet"
    quiet_lt: float = 0.0
    span_lt: float | None = None
    delay_lt: float = 0.0
    strength: float = 1.0
    noise: float | None = None

    @property
    def identifier(self) -> str:
        """Its name in paths and tables."""
        parts = [self.strategy]
        parts += [f"{name.removesuffix('_lt')}{_number(value)}" for name, value in self.settings]
        if self.starts != "quiet":
            parts.append(self.starts)
        usual = ControlPlan(self.strategy, ())
        for name in CONDITIONS[1:]:
            value = getattr(self, name)
            if value != getattr(usual, name):
                parts.append(f"{name.removesuffix('_lt')}{_number(value)}")
        return "-".join(parts)

    def record(self, span_lt: float, noise: float) -> Settings:
        """All of it, as a job is given it: with the campaign's span and the case's noise."""
        usual = {"span_lt": span_lt, "noise": noise}
        conditions = {name: getattr(self, name) for name in CONDITIONS}
        return {
            "strategy": self.strategy,
            "settings": dict(self.settings),
            **{name: usual[name] if value is None else value for name, value in conditions.items()},
        }


def paper_plan(prediction_time_lt: float, window_lt: float) -> ControlPlan:
    """The paper's protocol at one prediction time."""
    values = {"prediction_time_lt": prediction_time_lt, "window_lt": window_lt}
    return ControlPlan(WINDOWS, tuple((name, float(value)) for name, value in values.items()))


def block_plans(block: Mapping[str, Any]) -> Iterator[ControlPlan]:
    """Plans of a block of ``control.strategies``: all combinations of its lists."""
    axes: dict[str, Any] = block.get("settings", {})
    given = {name: block[name] for name in CONDITIONS if block.get(name) not in (None, [])}
    variants = product(
        *(values if isinstance(values, list) else [values] for values in given.values())
    )
    for conditions, values in product(variants, product(*(axes[name] for name in sorted(axes)))):
        settings = zip(sorted(axes), map(float, values), strict=True)
        named: dict[str, Any] = dict(zip(given, conditions, strict=True))
        named = {name: value if name == "starts" else float(value) for name, value in named.items()}
        yield ControlPlan(block["strategy"], tuple(settings), **named)


def _number(value: float) -> str:
    return str(canonical(value))
