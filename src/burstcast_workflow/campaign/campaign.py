"""The campaign: its members, its runs of control, and what settings of jobs are made of."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

from burstcast.base.names import ForecasterName, parsed
from burstcast.control.setting_names import is_option
from burstcast.forecasters.registry import options_of_kind
from burstcast.networks.validation_strategies.registry import scanned_with, strategy_module
from burstcast_workflow.campaign.control_runs import ControlRuns

MEASURED_INPUTS = {"input_bias": 1.0, "input_offset": "mean"}
"""Inputs of networks of measured series: centred inputs need a bias that breaks tanh's symmetry."""
SIMULATED_INPUTS = {"input_bias": 0.1, "input_offset": "none"}
"""Inputs of networks of simulated series, as in the paper."""


class Campaign(ControlRuns):
    """A configuration, expanded: members, runs of control, and settings that they share."""

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
        if case and (columns := self.cases[case].known_columns):
            of_columns = {"parameters": columns, "transform": "identity"}
            sections = {**sections, "aware": {**sections["aware"], **of_columns}}
        return sections

    def prediction_time(self, wanted: float) -> float:
        """The classified prediction time nearest to a wanted one."""
        time = nearest(self.config.classification.prediction_times_lt, wanted)
        assert time is not None
        return time

    @property
    def unused_columns(self) -> set[str]:
        """Columns of tables that the campaign has no value of: of control, and leak rates."""
        values = [value for run in self.strategy_runs for _, value in run.plan.settings]
        used = {"options"} if any(map(is_option, values)) else set()
        used |= {"observed"} if any(run.plan.observed for run in self.strategy_runs) else set()
        names = {(network.name.kind, network.name.label) for network in self.networks}
        leaking = any(self.options(kind, label=label)["leak_rate"] != [1] for kind, label in names)
        used |= {"leak_rate"} if leaking else set()
        return {"options", "observed", "leak_rate"} - used

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
        cases = [names["case"]] if "case" in names else list(self.case_names)
        if "strategy" in names and (part := self.plan(names["strategy"]).observed):
            cases.append(part)
        forecasters = [member.name for member in self.forecasters]
        if "forecaster" in names or "controller" in names:
            name = name_of(names)
            forecasters = [name] if name.asks_forecasters else []
        validations = {name.validation for name in forecasters if name.validation}
        if "strategies" in names:
            validations = set(names["strategies"].split("+"))
        validation_modules = [strategy_module(name).rpartition(".")[2] for name in validations]
        encoded = [self.cases[case] for case in cases if self.cases[case].is_encoded]
        # and the sources of encoded cases
        cases += [case.source.name for case in encoded]
        modules = {
            "burstcast.systems": sorted({self.cases[case].system for case in cases}),
            "burstcast.forecasters": sorted({name.kind for name in forecasters}),
            "burstcast.control.strategies": [],
            "burstcast.networks.validation_strategies": sorted(validation_modules),
        }
        if "strategy" in names:
            modules["burstcast.control.strategies"] = [self.plan(names["strategy"]).kind]
        if encoders := {case.encoder.kind for case in encoded if case.encoder}:
            modules["burstcast.data.encoders"] = sorted(encoders)
        return modules

    def all_modules(self) -> dict[str, list[str]]:
        """Modules that any job reaches by a name (`modules`)."""
        strategies = {run.plan.kind for run in self.strategy_runs}
        return {**self.modules({}), "burstcast.control.strategies": sorted(strategies)}

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
