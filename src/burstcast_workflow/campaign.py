"""The campaign: cases, forecasters, who controls what, and the settings that stages read."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import Any

from burstcast import durations
from burstcast.control.strategies.registry import strategy_class
from burstcast.forecaster_options import options_of_kind
from burstcast.forecasters.base import Forecaster
from burstcast.forecasters.registry import forecaster_class, linearises
from burstcast.statistics.profiles import flow_modes
from burstcast.systems.registry import make_system
from burstcast.tuning.strategies.registry import module_of
from burstcast_workflow.canonical import canonical, natural_order
from burstcast_workflow.config.cases import block_cases, case_records, realisation_of
from burstcast_workflow.config.measured_cases import is_measured, space_of
from burstcast_workflow.control_plans import CONDITIONS, ControlPlan, block_plans, paper_plan
from burstcast_workflow.identifiers import ForecasterName, parsed

Settings = dict[str, Any]

# Lists in which the order means nothing: everything that is made of them is the same in any order.
_UNORDERED = (
    ("classification", "prediction_times_lt"),
    ("control", "prediction_times_lt"),
    ("figures", "reynolds_prediction_times_lt"),
    ("probability", "cost_loss_ratios"),
    ("probability", "threshold_factors"),
    ("search", "tikhonov"),
)
NOISE = "case.training.noise"
SHARED_SCAN = ("RV", "SSV")
"""Strategies whose sums over the training data are computed in one scan of the grid."""


@dataclass(frozen=True)
class CaseForecaster:
    """A forecaster of a case."""

    case: str
    name: ForecasterName

    @property
    def directory(self) -> str:
        """Its directory below the results directory."""
        return f"{self.case}/{self.name.identifier}"

    @property
    def kind(self) -> type[Forecaster]:
        """Class of its kind."""
        return forecaster_class(self.name.kind)

    @property
    def identity(self) -> Settings:
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
    def identity(self) -> Settings:
        """Wildcards of its job, which its files say."""
        names = {"controller": self.controller.identifier, "strategy": self.plan.identifier}
        return {"case": self.case, **names}

    @property
    def prediction_time_lt(self) -> float | None:
        """Of the paper's strategy; None of others."""
        return dict(self.plan.settings).get("prediction_time_lt")


class Campaign:
    """A validated configuration, expanded.

    Everything is in one order, whatever the order in the config: cases as people sort their names,
    then forecasters by kind, size, strategy and seed.

    Parameters
    ----------
    config
        The whole configuration (`burstcast_workflow.config.loading.load`).
    """

    def __init__(self, config: Mapping[str, Any]) -> None:
        self.config: dict[str, Any] = {
            section: {
                key: _in_order(key, value) if (section, key) in _UNORDERED else value
                for key, value in values.items()
            }
            if isinstance(values, Mapping)
            else values
            for section, values in config.items()
        }
        self.cases = case_records(config)

    # -- who is in it ------------------------------------------------------------------------------

    @cached_property
    def forecasters(self) -> tuple[CaseForecaster, ...]:
        """All forecasters of all cases, each once."""
        return tuple(sorted(set(self._expand()), key=_order))

    def _expand(self) -> Iterator[CaseForecaster]:
        for block in self.config["campaign"]:
            for case in block_cases(block):
                for kind, axes in block["forecasters"].items():
                    for name in _names(kind, axes):
                        yield CaseForecaster(case, name)

    @cached_property
    def networks(self) -> tuple[CaseForecaster, ...]:
        """Those forecasters that are echo state networks."""
        return tuple(one for one in self.forecasters if one.name.kind == "esn")

    def select(self, **values: object) -> tuple[CaseForecaster, ...]:
        """Forecasters whose case, kind, neurons, validation or seed have the given values."""
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
        """The network whose forecasts the figures show."""
        figures = self.config["figures"]
        return CaseForecaster(figures["example_case"], parsed(figures["example_forecaster"]))

    @property
    def hyperparameters_file(self) -> str:
        """File in a network's directory with the hyperparameters that it is trained with."""
        by_survival = self.config["search"]["choice"] == "survival"
        return "survival_choice.json" if by_survival else "hyperparameters.json"

    @cached_property
    def long_term_forecasters(self) -> tuple[CaseForecaster, ...]:
        """Forecasters whose long-term statistics are computed."""
        return self._chosen(self.config["statistics"]["forecasters"])

    @cached_property
    def spectrum_forecasters(self) -> tuple[CaseForecaster, ...]:
        """Forecasters whose own flow's Lyapunov exponents are computed: of kinds that can."""
        if self.config["statistics"]["lyapunov_exponents"] == 0:
            return ()
        return tuple(one for one in self.long_term_forecasters if linearises(one.name.kind))

    def _chosen(self, choice: Mapping[str, Any]) -> tuple[CaseForecaster, ...]:
        """Forecasters of the kinds that a choice names, with values of axes that it allows."""
        return tuple(
            one
            for one in self.forecasters
            if choice.get(one.name.kind) is not None
            and all(
                not allowed or getattr(one.name, axis) in allowed
                for axis, allowed in choice[one.name.kind].items()
            )
        )

    @cached_property
    def control_runs(self) -> tuple[ControlRun, ...]:
        """The paper's control: who controls which case how far ahead; random alarms beside it."""
        control = self.config["control"]
        runs = [
            ControlRun(one.case, one.name, paper_plan(time, control["window_lt"]))
            for one in self._chosen(control["forecasters"])
            if self.cases[one.case]["actuation"] is not None
            for time in self._control_times(one)
        ]
        if control["random_alarms"]:
            runs += [
                replace(run, controller=replace(run.controller, role="random"))
                for run in runs
                if run.controller.kind == "esn"
            ]
        return tuple(runs)

    @cached_property
    def strategy_runs(self) -> tuple[ControlRun, ...]:
        """All control: the paper's, and that of the blocks of strategies, each run once."""
        blocks = self.config["control"]["strategies"]
        runs = [run for block in blocks for run in self._runs_of(block)]
        return tuple(dict.fromkeys([*self.control_runs, *runs]))

    def _runs_of(self, block: Mapping[str, Any]) -> Iterator[ControlRun]:
        controlled = [case for case in self.case_names if self.cases[case]["actuation"] is not None]
        wanted = block.get("cases") or controlled
        chosen = self._chosen(block.get("forecasters") or {})
        controllers = [
            (one.case, one.name)
            for one in chosen
            if block.get("seeds") is None or (one.name.seed or 0) < block["seeds"]
        ]
        if block.get("committee"):
            common = [(one.case, replace(one.name, seed=None, role="committee")) for one in chosen]
            controllers = list(dict.fromkeys(common))
        if not strategy_class(block["strategy"]).forecasts:
            controllers = [(case, ForecasterName("none")) for case in controlled]
        for case, controller in controllers:
            if case in wanted and case in controlled:
                for plan in block_plans(block):
                    yield ControlRun(case, controller, plan)

    def controlling(self, case: str, identifier: str) -> tuple[CaseForecaster, ...]:
        """Forecasters that a controller asks.

        Those of ``esn-N2000-RV-committee`` are all networks of that size and strategy. Where a
        committee is a single forecaster, the members of its ensemble vote.
        """
        name = parsed(identifier)
        if not name.asks_forecasters:
            return ()
        if name.role is None:
            return (CaseForecaster(case, name),)
        return self.select(
            case=case, kind=name.kind, neurons=name.neurons, validation=name.validation
        )

    @cached_property
    def _plans(self) -> dict[str, ControlPlan]:
        return {run.plan.identifier: run.plan for run in self.strategy_runs}

    def plan(self, identifier: str) -> ControlPlan:
        """The plan of control that is called so (a KeyError if there is none)."""
        return self._plans[identifier]

    def _control_times(self, one: CaseForecaster) -> list[float]:
        control, sweep = self.config["control"], self.config["control"]["sweep"]
        times = list(control["prediction_times_lt"])
        if one.case in sweep["cases"] and (one.name.seed or 0) < sweep["seeds"]:
            times += sweep["prediction_times_lt"]
        return sorted({float(time) for time in times})

    # -- what stages are given ---------------------------------------------------------------------

    def settings(
        self, paths: Iterable[str], wildcards: Mapping[str, str], values: Mapping[str, Any]
    ) -> Settings:
        """Settings of a job by their paths in the config, in canonical form.

        Parameters
        ----------
        paths
            ``case.`` stands for the job's case, ``forecaster.options`` for its kind's settings
            without ``forecaster.divergence_bound``, which only those read who judge long forecasts
            (None where the kind has none; left out for controllers that ask no forecaster),
            ``control.run`` for its plan of control. Kinds that see the truth are given no noise.
        wildcards
            Of the job.
        values
            Further settings by their names.

        Raises
        ------
        KeyError
            If the config has no such setting.
        """
        left_out = {NOISE} if _sees_truth(_name_of(wildcards)) else set()
        if "controller" in wildcards and not _name_of(wildcards).asks_forecasters:
            left_out.add("forecaster.options")
        found = {path: self._setting(path, wildcards) for path in paths if path not in left_out}
        result: Settings = canonical({**found, **values})
        return result

    def _setting(self, path: str, wildcards: Mapping[str, str]) -> Any:
        section, *rest = path.split(".")
        if path == "control.run":
            span_lt, noise = self.config["control"]["span_lt"], self.cases[wildcards["case"]]
            run = self.plan(wildcards["strategy"]).record(span_lt, noise["training"]["noise"])
            if _sees_truth(_name_of(wildcards)):
                del run["noise"]
            return run
        if section == "case":
            value: Any = self.cases[wildcards["case"]]
        elif section == "forecaster":
            options = options_of_kind(_name_of(wildcards).kind, self.config["forecasters"])
            bound = options.pop("divergence_bound", None)
            return options if rest == ["options"] else bound
        else:
            value = self.config[section]
        for key in rest:
            value = value[key]
        if path == NOISE and self.noise_of_data(wildcards["case"]) is not None:
            return 0.0  # what is imported has it already
        if path == "statistics.duration" and value is None:
            return self.cases[wildcards["case"]]["ensemble"]["duration"]
        if path == "case.event_threshold" and isinstance(value, Mapping):
            # a job finds it out (`burstcast_workflow.harness.thresholds`)
            return {**value, "case": wildcards["case"]}
        return value

    def modules(self, wildcards: Mapping[str, str]) -> dict[str, list[str]]:
        """Modules that a job reaches by a name, by the package whose registry finds them.

        They are those of all cases and forecasters where the job belongs to none of them. Only
        jobs of control have a strategy of control.
        """
        names = dict(wildcards.items())
        cases = [names["case"]] if "case" in names else list(self.case_names)
        if "forecaster" in names or "controller" in names:
            forecasters = [name for name in [_name_of(names)] if name.asks_forecasters]
        else:
            forecasters = [one.name for one in self.forecasters]
        strategy = [self.plan(names["strategy"]).strategy] if "strategy" in names else []
        controllers = [parsed(names["controller"]).role or "forecaster"] if strategy else []
        strategies = names.get("strategies")
        validations = (
            strategies.split("+") if strategies else {one.validation for one in forecasters}
        )
        return {
            "burstcast.systems": sorted({self.cases[case]["system"] for case in cases}),
            "burstcast.forecasters": sorted({one.kind for one in forecasters}),
            "burstcast.control.controllers": controllers,
            "burstcast.control.strategies": strategy,
            "burstcast.tuning.strategies": sorted(
                module_of(name).rpartition(".")[2] for name in validations if name
            ),
        }

    def keys(self, forecasters: Iterable[CaseForecaster]) -> list[Settings]:
        """Records for tables: whose file it is, and its key columns."""
        return [
            {
                "identity": one.identity,
                "keys": {**self.case_keys(one.case), **one.name.keys},
            }
            for one in forecasters
        ]

    def control_keys(self, runs: Iterable[ControlRun]) -> list[Settings]:
        """Records for tables of the paper's control, by prediction time.

        Random alarms have the keys of whom they stand in for.
        """
        return [
            {
                "identity": run.identity,
                "keys": {
                    **self.case_keys(run.case),
                    **run.controller.keys,
                    "prediction_time_lt": run.prediction_time_lt,
                },
            }
            for run in runs
        ]

    def strategy_keys(self, runs: Sequence[ControlRun]) -> list[Settings]:
        """Records for tables of all control, with strategy, settings and conditions.

        A setting that is none of a strategy's own is empty.
        """
        names = list(dict.fromkeys(name for run in runs for name, _ in run.plan.settings))
        records = []
        for run in runs:
            record = self.settings(
                ["control.run"], {"case": run.case, "strategy": run.plan.identifier}, {}
            )["control.run"]
            keys = {
                **self.case_keys(run.case),
                **run.controller.keys,
                "strategy": run.plan.strategy,
                **{name: record["settings"].get(name) for name in names},
                **{name: record[name] for name in CONDITIONS},
            }
            records.append({"identity": run.identity, "keys": keys})
        return records

    def case_keys(self, case: str) -> Settings:
        """Key columns of a case in tables."""
        return {"case": case, "reynolds": self.reynolds(case)}

    def of_each_case(self, *paths: str, cases: Iterable[str] | None = None) -> list[Settings]:
        """Settings of all cases, or of some, with whose they are and their key columns."""
        return [
            {
                "identity": {"case": case},
                "keys": self.case_keys(case),
                "settings": self.settings(paths, {"case": case}, {}),
            }
            for case in (self.case_names if cases is None else cases)
        ]

    # -- facts about cases -------------------------------------------------------------------------

    def reynolds(self, case: str) -> float | None:
        """Reynolds number of a case; None for a system that has none."""
        value = self.cases[case]["parameters"].get("reynolds")
        return None if value is None else float(value)

    def event_quantile(self, case: str) -> float | None:
        """Quantile that the event threshold of a case is given as; None where it is a number."""
        threshold = self.cases[case]["event_threshold"]
        return float(threshold["quantile"]) if isinstance(threshold, Mapping) else None

    def noise_of_data(self, case: str) -> Settings | None:
        """Observation noise that a case's series get when they are imported; None if later or none.

        Past values among the components have the noise of their own time, which must be there
        before they are taken.
        """
        record = self.cases[case]
        level = record["training"]["noise"]
        if not ((record.get("data") or {}).get("delays") and level):
            return None
        return {"level": level, "random_seed": self.config["random_seed"]}

    def steps_per_lyapunov_time(self, case: str) -> int | None:
        """Steps of a forecast in a Lyapunov time; None where the config does not know it."""
        record = self.cases[case]
        exponent = record["lyapunov"]["published_exponent"]
        if record["lyapunov"]["time_unit"] == "computed" or exponent is None:
            return None
        return durations.steps_per_lyapunov_time(exponent, self.sampling_interval(case))

    def estimates_time_unit(self, case: str) -> bool:
        """Whether a Lyapunov time is known only from how neighbouring states of the series part."""
        unknown = self.steps_per_lyapunov_time(case) is None
        return unknown and not self.has_equations(self.source_case(case))

    def time_unit(self, case: str) -> str | list[str]:
        """File of the computed Lyapunov exponents, where they set a case's unit of time."""
        known = self.steps_per_lyapunov_time(case) is not None
        return [] if known else f"{self.source_case(case)}/lyapunov.json"

    def sampling_interval(self, case: str) -> float:
        """Time between two steps of a forecast, in time units."""
        ensemble = self.cases[case]["ensemble"]
        return float(ensemble["time_step"] * ensemble["sampling_stride"])

    def dimension(self, case: str) -> int:
        """Components of a state."""
        space = space_of(self.cases[case])
        assert space is not None
        return space.dimension

    def has_equations(self, case: str) -> bool:
        """Whether a case is simulated, so that there is what needs equations."""
        return not is_measured(self.cases[case])

    @property
    def simulated_cases(self) -> tuple[str, ...]:
        """Cases that are simulated."""
        return tuple(case for case in self.case_names if self.has_equations(case))

    @property
    def measured_cases(self) -> tuple[str, ...]:
        """Cases of measured series."""
        return tuple(case for case in self.case_names if not self.has_equations(case))

    @property
    def realised_cases(self) -> tuple[str, ...]:
        """Cases that differ from others by their training series only."""
        return tuple(case for case in self.case_names if realisation_of(case)[1])

    def families(self) -> list[Settings]:
        """Cases with several choices of training series: key columns, and all that belong to it."""
        bases = dict.fromkeys(realisation_of(case)[0] for case in self.realised_cases)
        return [
            {
                "keys": {"case": base, "reynolds": self.reynolds(base)},
                "cases": [case for case in self.case_names if realisation_of(case)[0] == base],
            }
            for base in bases
        ]

    def source_case(self, case: str) -> str:
        """Case that a case is a part of, or itself: whose Lyapunov exponents and series it has."""
        return str((self.cases[case].get("data") or {}).get("case") or case)

    def has_flow(self, case: str) -> bool:
        """Whether a case is a flow: its state, the amplitudes of velocity modes."""
        record = self.cases[case]
        return (
            self.has_equations(case)
            and flow_modes(make_system(record["system"], record["parameters"])) is not None
        )

    def scan_of(self, identifier: str) -> tuple[str, str]:
        """Reservoir and strategies of the scan that a network's search goes on from."""
        name = parsed(identifier)
        reservoir = ForecasterName(name.kind, name.neurons, None, name.seed).identifier
        shared = name.validation in SHARED_SCAN
        return reservoir, "+".join(SHARED_SCAN) if shared else str(name.validation)


def _name_of(wildcards: Mapping[str, str]) -> ForecasterName:
    """Forecaster or controller of a job."""
    return parsed(wildcards.get("forecaster") or wildcards.get("controller") or "none")


@cache
def _sees_truth(name: ForecasterName) -> bool:
    return name.asks_forecasters and forecaster_class(name.kind).sees_truth


def _names(kind: str, axes: Mapping[str, Any] | None) -> Iterator[ForecasterName]:
    """Forecasters of one kind in a block: all combinations along its axes; none if it is null."""
    if axes is None:
        return
    if "seeds" not in axes:
        yield ForecasterName(kind)
        return
    for neurons in axes["neurons"]:
        for validation in axes["validation"]:
            for seed in range(axes["seeds"]):
                yield ForecasterName(kind, neurons, validation, seed)


def _in_order(name: str, values: Iterable[float]) -> list[float]:
    # Tikhonov parameters from the largest, as in the paper
    return sorted(set(values), reverse=name == "tikhonov")


def _order(one: CaseForecaster) -> tuple[Any, ...]:
    name = one.name
    return (
        natural_order(one.case),
        name.kind,
        name.neurons or 0,
        name.validation or "",
        name.seed or 0,
    )
