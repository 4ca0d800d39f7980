"""What a campaign has jobs for: a forecaster of a case, and a run of control of a case."""

from dataclasses import dataclass
from typing import Any

from burstcast.base.names import ForecasterName
from burstcast.base.natural_order import natural_order
from burstcast.forecasters.base import ForecasterKind
from burstcast.forecasters.registry import kind_class
from burstcast_workflow.config.control_plans import ControlPlan


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

    @property
    def order(self) -> tuple[Any, ...]:
        """What forecasters are sorted by."""
        return natural_order(self.case), *_order(self.name)


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

    @property
    def order(self) -> tuple[Any, ...]:
        """What runs of control are sorted by."""
        plan = natural_order(self.plan.identifier)
        return natural_order(self.case), plan, *_order(self.controller)


def _order(name: ForecasterName) -> tuple[Any, ...]:
    """What forecasters of a case are sorted by."""
    return (
        name.kind,
        name.label or "",
        name.neurons or 0,
        name.validation or "",
        name.seed or 0,
        name.role or "",
    )
