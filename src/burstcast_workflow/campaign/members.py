"""The members of a campaign: its cases, and the forecasters of each."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from burstcast.base.names import ForecasterName, parsed
from burstcast.base.natural_order import natural_order
from burstcast.forecasters.base import Forecaster, ForecasterKind
from burstcast.forecasters.registry import kind_class
from burstcast_workflow.config.cases import cases_of
from burstcast_workflow.config.forecasters import Choice
from burstcast_workflow.config.model import Configuration


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


class Members:
    """Cases and forecasters of a campaign.

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
        return tuple(sorted(members, key=_order))

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
    def classifiers(self) -> tuple[CaseForecaster, ...]:
        """Forecasters that learn to give probabilities without a trajectory."""
        return self._of(lambda member: not member.kind.has_trajectories)

    @cached_property
    def searched_networks(self) -> tuple[CaseForecaster, ...]:
        """Networks that have a search of their own."""
        return tuple(network for network in self.networks if self.searched(network) == network)

    def searched(self, member: CaseForecaster) -> CaseForecaster:
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
        """Forecasters whose case, kind, neurons, validation or seed have the given values.

        Those of a kind have no label, unless one is given.
        """
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


def _order(member: CaseForecaster) -> tuple[Any, ...]:
    return natural_order(member.case), *order_of_name(member.name)


def order_of_name(name: ForecasterName) -> tuple[Any, ...]:
    """What forecasters of a case are sorted by."""
    return (
        name.kind,
        name.label or "",
        name.neurons or 0,
        name.validation or "",
        name.seed or 0,
        name.role or "",
    )
