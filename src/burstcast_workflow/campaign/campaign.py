"""The campaign: its cases, forecasters and control runs."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import Any

from burstcast.control.setting_names import is_option
from burstcast.control.strategies.registry import strategy_class
from burstcast.data.training_realisations import realisation_of
from burstcast.forecasters._names import ForecasterName, parsed
from burstcast.forecasters.base import Forecaster, ForecasterKind
from burstcast.forecasters.registry import kind_class, options_of_kind
from burstcast.natural_order import natural_order
from burstcast.tuning.strategies.registry import scanned_with, strategy_module
from burstcast_workflow.config.case import Case
from burstcast_workflow.config.cases import cases_of
from burstcast_workflow.config.control_plans import ControlPlan, block_plans, paper_plan
from burstcast_workflow.config.forecasters import Choice, NetworkAxes, OwnForecaster
from burstcast_workflow.config.kinds import Section
from burstcast_workflow.config.model import Configuration, StrategyBlock

MEASURED_INPUTS = {"input_bias": 1.0, "input_offset": "mean"}
"""Inputs of networks of measured series: centred inputs need a bias that breaks tanh's symmetry."""
SIMULATED_INPUTS = {"input_bias": 0.1, "input_offset": "none"}
"""Inputs of networks of simulated series, as in the paper."""


@dataclass(frozen=True)
class CaseForecaster:
    """A forecaster of a case."""

    case: str
    name: ForecasterName

    @property
    def family(self) -> str:
        """Directory of its like in its case, which says what rules make its files.

        Networks have a search before they are trained; other kinds are fitted at once, and kinds
        that give probabilities without a trajectory have one rule for all that.
        """
        if self.name.neurons is not None:
            return "networks"
        return "models" if self.kind.has_trajectories else "classifiers"

    @property
    def directory(self) -> str:
        """Directory below the results directory."""
        return f"{self.case}/{self.family}/{self.name.identifier}"

    @property
    def kind(self) -> type[ForecasterKind]:
        """Class of its kind."""
        return kind_class(self.name.kind)

    @property
    def identity(self) -> dict[str, Any]:
        """Wildcards of its jobs, which its files say."""
        return {"case": self.case, "forecaster": self.name.identifier}


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


class Campaign:
    """A configuration, expanded.

    Everything is in one order, whatever the order in the config: cases as people sort their names,
    then forecasters by kind, size, strategy and seed.

    ``config``: The whole configuration (`burstcast_workflow.config.loading.load`).
    """

    def __init__(self, config: Mapping[str, Any]) -> None:
        self.config = Configuration.model_validate(config)
        self.cases = cases_of(self.config)

    # -- members -----------------------------------------------------------------------------------

    @cached_property
    def forecasters(self) -> tuple[CaseForecaster, ...]:
        """All forecasters of all cases, each once."""
        return tuple(sorted(set(self._expand()), key=_order))

    def _expand(self) -> Iterator[CaseForecaster]:
        for block in self.config.campaign:
            for case in block.case_names:
                for kind, axes in block.forecasters.kinds.items():
                    for name in _names(kind, axes):
                        yield CaseForecaster(case, name)

    @cached_property
    def networks(self) -> tuple[CaseForecaster, ...]:
        """Forecasters that are echo state networks."""
        return tuple(one for one in self.forecasters if one.name.neurons is not None)

    @cached_property
    def trajectory_forecasters(self) -> tuple[CaseForecaster, ...]:
        """Forecasters that forecast states, and not only the probability of an event."""
        return tuple(one for one in self.forecasters if one.kind.has_trajectories)

    @cached_property
    def classifiers(self) -> tuple[CaseForecaster, ...]:
        """Forecasters that learn to give probabilities without a trajectory."""
        return tuple(one for one in self.forecasters if not one.kind.has_trajectories)

    @cached_property
    def searched_networks(self) -> tuple[CaseForecaster, ...]:
        """Networks that have a search of their own."""
        return tuple(one for one in self.networks if self.searched(one) == one)

    def searched(self, one: CaseForecaster) -> CaseForecaster:
        """Network whose search finds the hyperparameters of a network: itself, or a shared one.

        Networks that know the parameters and are trained on the same series share the search of the
        first case, and networks with true washouts the searches of networks with noisy ones.
        """
        case = self.sources(one.case)[0] if one.kind.learns_parameters else one.case
        kind = one.kind.searched_as or one.name.kind
        return CaseForecaster(case, replace(one.name, kind=kind))

    def sources(self, case: str) -> list[str]:
        """Cases whose series the kinds that know the parameters are trained on, for a case."""
        return self.cases[case].training.trained_on or [case]

    def select(self, **values: object) -> tuple[CaseForecaster, ...]:
        """Forecasters whose case, kind, neurons, validation or seed have the given values.

        Those of a kind have no label, unless one is given.
        """
        if "kind" in values:
            values.setdefault("label", None)
        return tuple(
            one
            for one in self.forecasters
            if all(
                (one.case if name == "case" else getattr(one.name, name)) == value
                for name, value in values.items()
            )
        )

    @cached_property
    def case_names(self) -> tuple[str, ...]:
        """Cases that some forecaster of the campaign is made for."""
        return tuple(dict.fromkeys(one.case for one in self.forecasters))

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
            one
            for one in self._chosen(self.config.statistics.forecasters)
            if not (self.cases[one.case].known and one.kind.learns_parameters)
        )

    @cached_property
    def spectrum_forecasters(self) -> tuple[CaseForecaster, ...]:
        """Forecasters whose own flow's Lyapunov exponents are computed: of kinds that can."""
        if self.config.statistics.lyapunov_exponents == 0:
            return ()
        return tuple(
            one
            for one in self.long_term_forecasters
            if issubclass(one.kind, Forecaster) and one.kind.linearises()
        )

    def _chosen(self, choice: Choice) -> tuple[CaseForecaster, ...]:
        """Forecasters of the kinds that a choice names, with values of axes that it allows."""
        kinds = choice.kinds
        return tuple(
            one
            for one in self.forecasters
            if one.name.kind in kinds
            and all(
                not allowed or getattr(one.name, axis) in allowed
                for axis, allowed in kinds[one.name.kind]
            )
        )

    @cached_property
    def control_runs(self) -> tuple[ControlRun, ...]:
        """The paper's control: controllers, cases, prediction times; random alarms beside."""
        control = self.config.control
        runs = [
            ControlRun(one.case, one.name, paper_plan(time, control.window_lt))
            for one in self._chosen(control.forecasters)
            if self.cases[one.case].actuation is not None
            for time in self._control_times(one)
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
            (self.cases[one.case].source.name, one.name)
            for one in (self._chosen(block.forecasters) if block.forecasters else ())
            if (one.case == part if part else one.case in controlled)
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

    @property
    def unused_columns(self) -> set[str]:
        """Columns of tables that the campaign has no value of: of control, and leak rates."""
        values = [value for run in self.strategy_runs for _, value in run.plan.settings]
        used = {"options"} if any(map(is_option, values)) else set()
        used |= {"observed"} if any(run.plan.observed for run in self.strategy_runs) else set()
        names = {(one.name.kind, one.name.label) for one in self.networks}
        leaking = any(self.options(kind, label=label)["leak_rate"] != [1] for kind, label in names)
        used |= {"leak_rate"} if leaking else set()
        return {"options", "observed", "leak_rate"} - used

    def where(self, is_so: Callable[[Case], object]) -> tuple[str, ...]:
        """Names of the cases of which something is true."""
        return tuple(name for name in self.case_names if is_so(self.cases[name]))

    @property
    def simulated_cases(self) -> tuple[str, ...]:
        """Cases that are simulated."""
        return self.where(lambda case: case.has_equations)

    @property
    def measured_cases(self) -> tuple[str, ...]:
        """Cases of measured series."""
        return self.where(lambda case: not case.has_equations)

    @property
    def integrated_cases(self) -> tuple[str, ...]:
        """Cases whose series are integrated: simulated ones that take none of another case."""
        return self.where(lambda case: case.has_equations and not _takes_series(case))

    @property
    def imported_cases(self) -> tuple[str, ...]:
        """Cases whose series are imported: measured ones that take none of another case."""
        return self.where(lambda case: not case.has_equations and not _takes_series(case))

    @property
    def encoded_cases(self) -> tuple[str, ...]:
        """Cases whose forecasters receive readings of sensors, or what an encoder makes."""
        return self.where(lambda case: case.is_encoded)

    @property
    def ranked_cases(self) -> tuple[str, ...]:
        """Encoded cases and their sources."""
        sources = {self.cases[case].source.name for case in self.encoded_cases}
        return self.where(lambda case: case.is_encoded or case.name in sources)

    @property
    def realised_cases(self) -> tuple[str, ...]:
        """Cases that differ from others by their training series only."""
        return self.where(lambda case: case.realisation)

    @cached_property
    def aware_cases(self) -> tuple[str, ...]:
        """Cases of equations with forecasters that know their parameters."""
        known = {one.case for one in self.forecasters if one.kind.learns_parameters}
        return self.where(lambda case: case.has_equations and case.name in known)

    @cached_property
    def switched_cases(self) -> tuple[str, ...]:
        """Cases whose test series are under an actuator that switches at random."""
        return self.where(lambda case: case.training.actuation and case.training.actuation.tested)

    @cached_property
    def _plans(self) -> dict[str, ControlPlan]:
        return {run.plan.identifier: run.plan for run in self.strategy_runs}

    def plan(self, identifier: str) -> ControlPlan:
        """The plan of control that is called so (a KeyError if there is none)."""
        return self._plans[identifier]

    def prediction_time(self, wanted: float) -> float:
        """The classified prediction time nearest to a wanted one."""
        time = nearest(self.config.classification.prediction_times_lt, wanted)
        assert time is not None
        return time

    def _control_times(self, one: CaseForecaster) -> list[float]:
        times, sweep = set(self.config.control.prediction_times_lt), self.config.control.sweep
        if one.case in sweep.cases and (one.name.seed or 0) < sweep.seeds:
            times.update(sweep.prediction_times_lt)
        return sorted(times)

    # -- what settings of jobs are made of ---------------------------------------------------------

    def sections(self, case: str, label: str | None = None) -> dict[str, Any]:
        """Settings of kinds of forecasters in a case; records have known columns as parameters.

        Networks with the label of a variant have its settings. The offset and the bias of their
        inputs follow from the case where the config leaves them open.
        """
        sections: dict[str, Any] = self.plain["forecasters"]
        if label in sections["variants"]:
            sections = {**sections, "esn": {**sections["esn"], **sections["variants"][label]}}
        measured = bool(case and self.cases[case].data)
        inputs = MEASURED_INPUTS if measured else SIMULATED_INPUTS
        left_open = {name: value for name, value in inputs.items() if sections["esn"][name] is None}
        sections = {**sections, "esn": {**sections["esn"], **left_open}}
        known = self.cases[case].known if case else []
        if known:
            told = {**sections["aware"], "parameters": known, "transform": "identity"}
            sections = {**sections, "aware": told}
        return sections

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
        return {name: case.given() for name, case in self.cases.items()}

    def options(self, kind: str, case: str = "", label: str | None = None) -> dict[str, Any]:
        """Options of a kind of forecasters: from all of its sections in a case.

        Options of a class of one's own are those of its block.
        """
        if kind == "none":  # of controllers that ask no forecaster
            return {}
        if ":" in kind:
            return self._own_options[kind, label]
        return options_of_kind(kind, self.sections(case, label))

    @cached_property
    def _own_options(self) -> dict[tuple[str, str | None], dict[str, Any]]:
        """Options of classes of one's own, by kind and label."""
        return {
            (kind, own.label): own.options
            for block in self.config.campaign
            for kind, own in block.forecasters.own.items()
        }

    def modules(self, wildcards: Mapping[str, str]) -> dict[str, list[str]]:
        """Modules that a job reaches by a name, by the package whose registry finds them.

        All cases and forecasters count where the job belongs to none of them. Only jobs of control
        have a strategy of control.
        """
        names = dict(wildcards.items())
        cases = [names["case"]] if "case" in names else list(self.case_names)
        if "strategy" in names and (part := self.plan(names["strategy"]).observed):
            cases.append(part)
        if "forecaster" in names or "controller" in names:
            forecasters = [name for name in [name_of(names)] if name.asks_forecasters]
        else:
            forecasters = [one.name for one in self.forecasters]
        strategy = [self.plan(names["strategy"]).strategy] if "strategy" in names else []
        strategies = names.get("strategies")
        validations = (
            strategies.split("+") if strategies else {one.validation for one in forecasters}
        )
        encoded = [self.cases[case] for case in cases if self.cases[case].is_encoded]
        # and the sources of encoded cases
        cases += [one.source.name for one in encoded]
        encoders = {one.encoder.kind for one in encoded if one.encoder}
        return {
            **({"burstcast.encoders": sorted(encoders)} if encoders else {}),
            "burstcast.systems": sorted({self.cases[case].system for case in cases}),
            "burstcast.forecasters": sorted({one.kind for one in forecasters}),
            "burstcast.control.strategies": strategy,
            "burstcast.tuning.strategies": sorted(
                strategy_module(name).rpartition(".")[2] for name in validations if name
            ),
        }

    def all_modules(self) -> dict[str, list[str]]:
        """Modules that any job reaches by a name (`modules`)."""
        strategies = {run.plan.strategy for run in self.strategy_runs}
        return {**self.modules({}), "burstcast.control.strategies": sorted(strategies)}

    def asked_of_series(self, case: str) -> dict[str, Any]:
        """Kinds, validation strategies and long runs of a case, for which series must be long."""
        names = [one.name for one in self.forecasters if one.case == case]
        return {
            "kinds": sorted({name.kind for name in names}),
            "validations": sorted({name.validation for name in names if name.validation}),
            "long_runs": any(one.case == case for one in self.long_term_forecasters),
        }

    def noise_of_data(self, case: str) -> dict[str, Any] | None:
        """Observation noise that series of a case get when they are imported; None if none."""
        level = self.cases[case].imported_noise
        return {"level": level, "random_seed": self.config.random_seed} if level else None

    def drawn_shares(self, case: str) -> dict[str, Any] | None:
        """Shares of events that the choices up to a case's are drawn for; None: blocks of series.

        Each choice leaves the later ones other series.
        """
        one = self.cases[case]
        shares = self.config.event_shares_of(realisation_of(case)[0])[: one.realisation]
        return {"shares": shares, "threshold": one.event_threshold} if shares else None

    def scan_of(self, identifier: str) -> tuple[str, str]:
        """Reservoir and strategies of the scan that a network's search goes on from."""
        name = parsed(identifier)
        reservoir = replace(name, validation=None).identifier
        return reservoir, "+".join(scanned_with(str(name.validation)))


def _takes_series(case: Case) -> bool:
    """Whether a case has the series of another one: encoded, or other ones to train on."""
    return bool(case.is_encoded or case.realisation)


def nearest(values: Sequence[float], wanted: float) -> float | None:
    """The value nearest to the wanted one, the smaller of two; None without any."""
    return min(values, key=lambda value: (abs(value - wanted), value), default=None)


WHOSE = ("forecaster", "controller", "reservoir")
"""Wildcards that name a forecaster or a controller of a job, or the network of a reservoir."""


def name_of(wildcards: Mapping[str, str]) -> ForecasterName:
    """Forecaster or controller of a job, or the network that its reservoir is for."""
    return parsed(next(filter(None, map(wildcards.get, WHOSE)), "none"))


def _names(kind: str, axes: Section | dict[str, Section]) -> Iterator[ForecasterName]:
    """Forecasters of one kind in a block: all combinations along its axes."""
    if isinstance(axes, dict):
        yield from (ForecasterName(kind, label=label) for label in axes)
        return
    if not isinstance(axes, NetworkAxes):
        yield ForecasterName(kind, label=axes.label if isinstance(axes, OwnForecaster) else None)
        return
    labels: list[str | None] = [*axes.variants] or [None]
    for label, neurons, validation in product(labels, axes.neurons, axes.validation):
        for seed in range(axes.seeds):
            yield ForecasterName(kind, neurons, validation, seed, label=label)


def _order(one: CaseForecaster) -> tuple[Any, ...]:
    return natural_order(one.case), *_order_of_name(one.name)


def _order_of_run(run: ControlRun) -> tuple[Any, ...]:
    plan = natural_order(run.plan.identifier)
    return natural_order(run.case), plan, *_order_of_name(run.controller)


def _order_of_name(name: ForecasterName) -> tuple[Any, ...]:
    return (
        name.kind,
        name.label or "",
        name.neurons or 0,
        name.validation or "",
        name.seed or 0,
        name.role or "",
    )
