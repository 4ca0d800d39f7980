"""The runs of control of a campaign: cases, their controllers and plans of control."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from burstcast.base.names import ForecasterName, parsed
from burstcast.base.natural_order import natural_order
from burstcast.control.strategies.registry import strategy_class
from burstcast_workflow.campaign.members import CaseForecaster, Members, order_of_name
from burstcast_workflow.config.control_plans import ControlPlan, block_plans, paper_plan
from burstcast_workflow.config.model import StrategyBlock


@dataclass(frozen=True)
class ControlRun:
    """One run of control: a case, its controller, and the plan of control."""

    case: str
    controller: ForecasterName
    plan: ControlPlan

    @property
    def directory(self) -> str:
        """Directory of its files below the results directory."""
        return f"{self.case}/control/{self.controller.identifier}/{self.plan.identifier}"

    @property
    def identity(self) -> dict[str, Any]:
        """Wildcards of its job, which its files say."""
        names = {"controller": self.controller.identifier, "strategy": self.plan.identifier}
        return {"case": self.case, **names}

    @property
    def prediction_time_lt(self) -> float | None:
        """Prediction time of the paper's strategy; None for others."""
        return dict(self.plan.settings).get("prediction_time_lt")


class ControlRuns(Members):
    """Runs of control by the members of a campaign, the paper's and those of its strategies."""

    @cached_property
    def control_runs(self) -> tuple[ControlRun, ...]:
        """The paper's control: controllers, cases, prediction times; random alarms beside."""
        control = self.config.control
        runs = [
            ControlRun(member.case, member.name, paper_plan(time, control.window_lt))
            for member in self.chosen(control.forecasters)
            if self.cases[member.case].actuation is not None
            for time in self._control_times(member)
        ]
        if control.random_alarms:
            runs += [
                replace(run, controller=replace(run.controller, role="random"))
                for run in runs
                if (run.controller.kind, run.controller.label) == ("esn", None)
            ]
        return tuple(runs)

    @cached_property
    def strategy_runs(self) -> tuple[ControlRun, ...]:
        """All control: the paper's, and by the blocks of strategies, each run once."""
        runs = {run for block in self.config.control.strategies for run in self._runs_of(block)}
        return (*self.control_runs, *sorted(runs - {*self.control_runs}, key=_order_of_run))

    @property
    def chosen_runs(self) -> tuple[ControlRun, ...]:
        """Runs of control whose settings are chosen on half of the flows; none by default."""
        chooses = self.config.control.tolerated_exceedance is not None
        return self.strategy_runs if chooses else ()

    def _runs_of(self, block: StrategyBlock) -> Iterator[ControlRun]:
        controlled = [case for case in self.case_names if self.cases[case].actuation is not None]
        wanted = block.cases or controlled
        for part in block.observed or [""]:
            plans = [plan for plan in block_plans(block) if plan.observed == part]
            for case, controller in self._controllers(block, part, controlled):
                if case in wanted and case in controlled:
                    yield from (ControlRun(case, controller, plan) for plan in plans)

    def _controllers(
        self, block: StrategyBlock, part: str, controlled: Sequence[str]
    ) -> list[tuple[str, ForecasterName]]:
        """Controlled cases with their controllers, which observe all of the state or a part."""
        if not strategy_class(block.strategy).forecasts:
            cases = [self.cases[part].source.name] if part else controlled
            return [(case, ForecasterName("none")) for case in cases]
        chosen = [
            (self.cases[member.case].source.name, member.name)
            for member in (self.chosen(block.forecasters) if block.forecasters else ())
            if (member.case == part if part else member.case in controlled)
        ]
        if block.committee:
            common = [(case, replace(name, seed=None, role="committee")) for case, name in chosen]
            return list(dict.fromkeys(common))
        return [
            (case, name)
            for case, name in chosen
            if block.seeds is None or (name.seed or 0) < block.seeds
        ]

    def controlling(
        self, case: str, identifier: str, strategy: str = ""
    ) -> tuple[CaseForecaster, ...]:
        """Forecasters that a controller asks under a plan of control.

        Those of ``esn-N2000-RV-committee`` are all networks of that size and strategy. Where a
        committee is a single forecaster, the members of its ensemble vote.
        """
        name = parsed(identifier)
        if not name.asks_forecasters:
            return ()
        if strategy:
            case = self.plan(strategy).observed or case
        if name.role is None:
            return (CaseForecaster(case, name),)
        return self.select(
            case=case,
            kind=name.kind,
            label=name.label,
            neurons=name.neurons,
            validation=name.validation,
        )

    @cached_property
    def _plans(self) -> dict[str, ControlPlan]:
        return {run.plan.identifier: run.plan for run in self.strategy_runs}

    def plan(self, identifier: str) -> ControlPlan:
        """The plan of control that is called so (a KeyError if there is none)."""
        return self._plans[identifier]

    def _control_times(self, member: CaseForecaster) -> list[float]:
        times, sweep = set(self.config.control.prediction_times_lt), self.config.control.sweep
        if member.case in sweep.cases and (member.name.seed or 0) < sweep.seeds:
            times.update(sweep.prediction_times_lt)
        return sorted(times)


def _order_of_run(run: ControlRun) -> tuple[Any, ...]:
    plan = natural_order(run.plan.identifier)
    return natural_order(run.case), plan, *order_of_name(run.controller)
