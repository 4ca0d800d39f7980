"""Habits of scikit-learn's estimators, without scikit-learn.

An estimator is a dataclass: its fields are its parameters, stored under their names, and ``fit``
leaves what it finds under names that end in an underscore. `sklearn.base.clone` and whatever else
only sets parameters then works, and so does model selection, which takes series as samples
(`sklearn.model_selection.cross_val_score`, ``GridSearchCV``).
"""

import dataclasses
import warnings
from collections.abc import Sequence
from typing import Any, Self

from burstcast.base.discovery import suggestion

_TOLD: set[str] = set()
"""Estimators that have warned: a cross-validation fits equal ones again and again."""


class Estimator:
    """Parameters by name, a short ``repr``, and one warning."""

    @classmethod
    def _parameters(cls) -> list["dataclasses.Field[Any]"]:
        return [entry for entry in dataclasses.fields(cls) if entry.init]  # type: ignore[arg-type]

    def get_params(self, deep: bool = True) -> dict[str, Any]:
        """Parameters as they were given, by name."""
        return {entry.name: getattr(self, entry.name) for entry in self._parameters()}

    def set_params(self, **parameters: Any) -> Self:
        """Change parameters; the fitted state remains until the next ``fit``."""
        names = list(self.get_params())
        for name in parameters:
            if name not in names:
                raise ValueError(
                    f"{type(self).__name__} has no parameter {name!r}{suggestion(name, names)}; "
                    f"its parameters are {', '.join(names)}"
                )
        vars(self).update(parameters)
        return self

    def __sklearn_tags__(self) -> Any:
        """Tags for scikit-learn: a classifier whose samples are series, and needs no target."""
        from sklearn.utils import ClassifierTags, InputTags, Tags, TargetTags

        return Tags(
            estimator_type="classifier",
            classifier_tags=ClassifierTags(multi_class=False),
            target_tags=TargetTags(required=False),
            input_tags=InputTags(two_d_array=False, three_d_array=True),
        )

    def __sklearn_is_fitted__(self) -> bool:
        """Whether `fit` was called."""
        return hasattr(self, "members_")

    def _warn_once(self, findings: Sequence[str]) -> None:
        """One warning of all findings, to the caller of `fit`; none again with equal parameters."""
        if findings and repr(self) not in _TOLD:
            _TOLD.add(repr(self))
            warnings.warn(
                f"signs of a weak forecaster (warnings_): {'; '.join(findings)}", stacklevel=3
            )

    def __repr__(self) -> str:
        given = []
        for entry in self._parameters():
            factory, value = entry.default_factory, getattr(self, entry.name)
            default = entry.default if factory is dataclasses.MISSING else factory()
            if repr(value) != repr(default):
                given.append(f"{entry.name}={value!r}")
        return f"{type(self).__name__}({', '.join(given)})"
