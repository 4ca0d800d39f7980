"""The campaign: its cases and forecasters, its runs of control, and the settings of jobs."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import product
from typing import Any

from burstcast.base.names import ForecasterName, parsed
from burstcast.control.setting_names import is_option
from burstcast.control.strategies.registry import strategy_class
from burstcast.forecasters.base import Forecaster
from burstcast.forecasters.registry import options_of_kind
from burstcast.networks.validation_strategies.registry import scanned_with, strategy_module
from burstcast_workflow.campaign.members import CaseForecaster, ControlRun
from burstcast_workflow.config.cases import cases_of
from burstcast_workflow.config.control_plans import ControlPlan, block_plans, paper_plan
from burstcast_workflow.config.forecasters import Choice
from burstcast_workflow.config.model import Configuration, StrategyBlock

MEASURED_INPUTS = {"input_bias": 1.0, "input_offset": "mean"}
"""Inputs of networks of measured series: centred inputs need a bias that breaks tanh's symmetry."""
SIMULATED_INPUTS = {"input_bias": 0.1, "input_offset": "none"}
"""Inputs of networks of simulated series, as in the paper."""


class Campaign:
    """A configuration, expanded: cases, forecasters, runs of control, and settings.

    Everything is in one order, whatever the order in the config: cases as people sort their names,
    then forecasters by kind, size, strategy and seed.

    ``config``: The whole configuration (`burstcast_workflow.campaign.loading.load`).
    ``skip_invalid``: Leave out cases with invalid settings, and their forecasters.
    """

    def __init__(
        self, config: Mapping[str, Any] | Configuration, *, skip_invalid: bool = False
    ) -> None:
        self.config = Configuration.model_validate(config)
        self.cases = cases_of(self.config, skip_invalid=skip_invalid)

    # -- forecasters -------------------------------------------------------------------------------

    @cached_property
    def forecasters(self) -> tuple[CaseForecaster, ...]:
        """All forecasters of all cases, each once."""
        members = {
            CaseForecaster(case, name)
            for block in self.config.campaign
            for kind in block.forecasters.kinds
            for name in block.forecasters.names(kind)
            for case in block.case_names
            if case in self.cases
        }
        return tuple(sorted(members, key=lambda member: member.order))

    def _of(self, is_so: Callable[[CaseForecaster], object]) -> tuple[CaseForecaster, ...]:
        """Forecasters of which something is true."""
        return tuple(filter(is_so, self.forecasters))

    @cached_property
    def networks(self) -> tuple[CaseForecaster, ...]:
        """Forecasters that are echo state networks."""
        return self._of(lambda member: member.name.neurons is not None)

    @cached_property
    def trajectory_forecasters(self) -> tuple[CaseForecaster, ...]:
        """Forecasters that forecast states, and not only the probability of an event."""
        return self._of(lambda member: member.kind.has_trajectories)

    @cached_property
    def consistency_forecasters(self) -> tuple[CaseForecaster, ...]:
        """Forecasters whose washouts are tested for consistency: none that knows more than them."""
        return tuple(
            member
            for member in self.trajectory_forecasters
            if self.config.probability.consistency
            and not (member.kind.learns_parameters or member.kind.sees_truth)
        )

    @cached_property
    def classifiers(self) -> tuple[CaseForecaster, ...]:
        """Forecasters that learn to give probabilities without a trajectory."""
        return self._of(lambda member: not member.kind.has_trajectories)

    @cached_property
    def searched_networks(self) -> tuple[CaseForecaster, ...]:
        """Networks that have a search of their own."""
        return tuple(network for network in self.networks if self.search_source(network) == network)

    def search_source(self, member: CaseForecaster) -> CaseForecaster:
        """Network whose search finds the hyperparameters of a network: itself, or a shared one.

        Networks that know the parameters and are trained on the same series share the search of the
        first case, and networks with true washouts the searches of networks with noisy ones.
        """
        case = self.sources(member.case)[0] if member.kind.learns_parameters else member.case
        kind = member.kind.searched_as or member.name.kind
        return CaseForecaster(case, replace(member.name, kind=kind))

    def sources(self, case: str) -> list[str]:
        """Cases whose series the kinds that know the parameters are trained on, for a case."""
        return self.cases[case].training.trained_on or [case]

    def select(self, **values: object) -> tuple[CaseForecaster, ...]:
        """Forecasters with the given case, kind, ...; of a kind, without a label by default."""
        if "kind" in values:
            values.setdefault("label", None)
        return self._of(
            lambda member: all(
                (member.case if name == "case" else getattr(member.name, name)) == value
                for name, value in values.items()
            )
        )

    def chosen(self, choice: Choice) -> tuple[CaseForecaster, ...]:
        """Forecasters of the kinds that a choice names, with values of axes that it allows."""
        kinds = choice.kinds
        return self._of(
            lambda member: (
                member.name.kind in kinds
                and all(
                    not allowed or getattr(member.name, axis) in allowed
                    for axis, allowed in kinds[member.name.kind]
                )
            )
        )

    @property
    def example(self) -> CaseForecaster:
        """The network whose forecasts the figures show; none in a campaign without networks."""
        figures = self.config.figures
        case = figures.example_case or self.forecasters[0].case
        return CaseForecaster(case, parsed(figures.example_forecaster or "none"))

    @cached_property
    def long_term_forecasters(self) -> tuple[CaseForecaster, ...]:
        """Forecasters whose long-term statistics are computed: none that needs known values."""
        return tuple(
            member
            for member in self.chosen(self.config.statistics.forecasters)
            if not (self.cases[member.case].known_columns and member.kind.learns_parameters)
        )

    @cached_property
    def spectrum_forecasters(self) -> tuple[CaseForecaster, ...]:
        """Forecasters whose own flow's Lyapunov exponents are computed: of kinds that can."""
        computed = self.config.statistics.lyapunov_exponents > 0
        return tuple(
            member
            for member in self.long_term_forecasters
            if computed and issubclass(member.kind, Forecaster) and member.kind.linearises()
        )

    # -- cases -------------------------------------------------------------------------------------

    @cached_property
    def case_names(self) -> tuple[str, ...]:
        """Cases that some forecaster of the campaign is made for."""
        return tuple(dict.fromkeys(member.case for member in self.forecasters))

    def where(self, **values: bool) -> tuple[str, ...]:
        """Names of the cases that have the given properties: ``where(is_encoded=True)``."""
        return tuple(
            name
            for name in self.case_names
            if all(bool(getattr(self.cases[name], key)) == value for key, value in values.items())
        )

    @property
    def simulated_cases(self) -> tuple[str, ...]:
        """Cases that are simulated."""
        return self.where(has_equations=True)

    @property
    def realised_cases(self) -> tuple[str, ...]:
        """Cases that differ from others by their training series only."""
        return self.where(realisation=True)

    @property
    def ranked_cases(self) -> tuple[str, ...]:
        """Encoded cases and their sources."""
        encoded = self.where(is_encoded=True)
        sources = {self.cases[case].source.name for case in encoded}
        return tuple(case for case in self.case_names if case in encoded or case in sources)

    @cached_property
    def aware_cases(self) -> tuple[str, ...]:
        """Cases of equations with forecasters that know their parameters."""
        aware = {member.case for member in self.forecasters if member.kind.learns_parameters}
        return tuple(case for case in self.simulated_cases if case in aware)

    # -- control -----------------------------------------------------------------------------------

    @cached_property
    def control_runs(self) -> tuple[ControlRun, ...]:
        """The paper's control: controllers, cases, prediction times; random alarms beside."""
        control = self.config.control
        runs = [
            ControlRun(member.case, member.name, paper_plan(time, control.window_lt))
            for member in self.chosen(control.forecasters)
            if self.cases[member.case].actuation
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
        return (*self.control_runs, *sorted(runs - {*self.control_runs}, key=lambda run: run.order))

    @cached_property
    def long_runs(self) -> tuple[ControlRun, ...]:
        """Long runs of control, whose events are counted for return times, each once."""
        runs = {run for block in self.config.control.long_runs for run in self._runs_of(block)}
        return tuple(sorted(runs, key=lambda run: run.order))

    @property
    def chosen_runs(self) -> tuple[ControlRun, ...]:
        """Runs of control whose settings are chosen on half of the flows; none by default."""
        chooses = self.config.control.tolerated_exceedance is not None
        return self.strategy_runs if chooses else ()

    def _runs_of(self, block: StrategyBlock) -> Iterator[ControlRun]:
        """Runs of a block, whose controllers observe all of the state or a part."""
        controlled = self.where(actuation=True)
        forecasters = self.chosen(block.forecasters) if block.forecasters else ()
        members = [
            (member.case, replace(member.name, seed=None, role="committee"))
            if block.committee
            else (member.case, member.name)
            for member in forecasters
            if block.seeds is None or (member.name.seed or 0) < block.seeds
        ]
        if not strategy_class(block.strategy).forecasts:
            members = [(case, ForecasterName("none")) for case in self.case_names]
        for plan, (seen, controller) in product(block_plans(block), dict.fromkeys(members)):
            case = self.cases[seen].source.name
            observes = seen == plan.observed if plan.observed else seen in controlled
            if observes and case in controlled and case in (block.cases or controlled):
                yield ControlRun(case, controller, plan)

    def controlling(
        self, case: str, identifier: str, strategy: str = ""
    ) -> tuple[CaseForecaster, ...]:
        """Forecasters that a controller asks under a plan of control.

        ``esn-N2000-RV-committee`` asks all networks of that size and strategy. Where a committee is
        a single forecaster, the members of its ensemble vote.
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
        return {run.plan.identifier: run.plan for run in (*self.strategy_runs, *self.long_runs)}

    def plan(self, identifier: str) -> ControlPlan:
        """The plan of control that is called so (a KeyError if there is none)."""
        return self._plans[identifier]

    def _control_times(self, member: CaseForecaster) -> list[float]:
        times, sweep = set(self.config.control.prediction_times_lt), self.config.control.sweep
        if member.case in sweep.cases and (member.name.seed or 0) < sweep.seeds:
            times.update(sweep.prediction_times_lt)
        return sorted(times)

    # -- settings of jobs --------------------------------------------------------------------------

    def sections(self, case: str, label: str | None = None) -> dict[str, Any]:
        """Settings of kinds of forecasters in a case; records have known columns as parameters.

        Networks with the label of a variant have its settings. The offset and the bias of their
        inputs follow from the case where the config leaves them open.
        """
        sections: dict[str, Any] = self.plain["forecasters"]
        if differing := sections["variants"].get(label):
            sections = dict(sections)
            for name in ("esn", "esn_filtered"):
                own = {key: value for key, value in differing.items() if key in sections[name]}
                sections[name] = {**sections[name], **own}
        measured = bool(case and self.cases[case].data)
        inputs = MEASURED_INPUTS if measured else SIMULATED_INPUTS
        left_open = {name: value for name, value in inputs.items() if sections["esn"][name] is None}
        sections = {**sections, "esn": {**sections["esn"], **left_open}}
        if case and (columns := self.cases[case].known_columns):
            of_columns = {"parameters": columns, "transform": "identity"}
            sections = {**sections, "aware": {**sections["aware"], **of_columns}}
        return sections

    @property
    def unused_columns(self) -> set[str]:
        """Columns of tables that the campaign has no value of: of control, and leak rates."""
        plans = [run.plan for run in (*self.strategy_runs, *self.long_runs)]
        names = {(network.name.kind, network.name.label) for network in self.networks}
        leak_rates = [self.options(kind, label=label)["leak_rate"] for kind, label in names]
        used = {
            "options": any(is_option(value) for plan in plans for _, value in plan.settings),
            "observed": any(plan.observed for plan in plans),
            "leak_rate": any(leak_rate != [1] for leak_rate in leak_rates),
        }
        return {column for column, is_used in used.items() if not is_used}

    def own_values(self, case: str) -> list[float]:
        """Values of parameters that forecasters are given, without actuation; none for records."""
        return self.cases[case].values_of(self.config.forecasters.aware.parameters)

    @cached_property
    def plain(self) -> dict[str, Any]:
        """The whole configuration as plain data."""
        return self.config.dump()

    @cached_property
    def plain_cases(self) -> dict[str, dict[str, Any]]:
        """Settings of each case as its jobs are given them."""
        return {name: case.of_jobs() for name, case in self.cases.items()}

    def options(self, kind: str, case: str = "", label: str | None = None) -> dict[str, Any]:
        """Options of a kind, from all its sections in a case; of a user's class, from its block."""
        if kind == "none":  # of controllers that ask no forecaster
            return {}
        if ":" in kind:
            return self._own_options[kind, label]
        return options_of_kind(kind, self.sections(case, label))

    @cached_property
    def _own_options(self) -> dict[tuple[str, str | None], dict[str, Any]]:
        """Options of classes of one's own, by kind and label."""
        return {
            (kind, forecaster.label): forecaster.options
            for block in self.config.campaign
            for kind, forecaster in block.forecasters.own.items()
        }

    def modules(self, wildcards: Mapping[str, str]) -> dict[str, list[str]]:
        """Modules that a job reaches by a name, by the package whose registry finds them.

        All cases and forecasters count where the job belongs to none of them. Only jobs of control
        have a strategy of control.
        """
        names = dict(wildcards.items())
        cases = [names["case"]] if "case" in names else [*self.case_names]
        strategies = []
        if "strategy" in names:
            plan = self.plan(names["strategy"])
            strategies = [plan.kind]
            cases += [plan.observed] if plan.observed else []
        forecasters = [member.name for member in self.forecasters]
        if "forecaster" in names or "controller" in names:
            name = name_of(names)
            forecasters = [name] if name.asks_forecasters else []
        validations = {name.validation for name in forecasters if name.validation}
        if "strategies" in names:
            validations = set(names["strategies"].split("+"))
        encoded = [self.cases[case] for case in cases if self.cases[case].is_encoded]
        # and the sources of encoded cases
        cases += [case.source.name for case in encoded]
        modules = {
            "burstcast.systems": {self.cases[case].system for case in cases},
            "burstcast.forecasters": {name.kind for name in forecasters},
            "burstcast.control.strategies": strategies,
            "burstcast.networks.validation_strategies": {
                strategy_module(name).rpartition(".")[2] for name in validations
            },
            "burstcast.data.encoders": {case.encoder.kind for case in encoded if case.encoder},
        }
        return {package: sorted(names) for package, names in modules.items()}

    def all_modules(self) -> dict[str, list[str]]:
        """Modules that any job reaches by a name (`modules`)."""
        jobs: list[dict[str, str]] = [{}]
        # a scan may be validated by more strategies than there are networks of
        scans = {scanned_with(str(network.name.validation)) for network in self.networks}
        jobs += [{"strategies": "+".join(strategies)} for strategies in scans]
        jobs += [
            {"strategy": run.plan.identifier} for run in (*self.strategy_runs, *self.long_runs)
        ]
        every: dict[str, set[str]] = {}
        for job in jobs:
            for package, names in self.modules(job).items():
                every.setdefault(package, set()).update(names)
        return {package: sorted(names) for package, names in every.items()}

    def scan_of(self, identifier: str) -> tuple[str, str]:
        """Reservoir and strategies of the scan that a network's search goes on from."""
        name = parsed(identifier)
        reservoir = replace(name, validation=None).identifier
        return reservoir, "+".join(scanned_with(str(name.validation)))


def nearest(values: Sequence[float], wanted: float) -> float | None:
    """The value nearest to the wanted one, the smaller of two; None without any."""
    return min(values, key=lambda value: (abs(value - wanted), value), default=None)


def name_of(wildcards: Mapping[str, str]) -> ForecasterName:
    """Forecaster or controller of a job, or the network that its reservoir is for."""
    for wildcard in ("forecaster", "controller", "reservoir"):
        if wildcard in wildcards:
            return parsed(wildcards[wildcard])
    return parsed("none")
