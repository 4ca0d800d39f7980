"""Habits of scikit-learn's estimators, without scikit-learn.

The constructor stores its arguments under their names and does nothing else; ``fit`` leaves what it
finds under names that end in an underscore. `sklearn.base.clone` and whatever else only sets
parameters then works, and so does model selection, which takes series as samples
(`sklearn.model_selection.cross_val_score`, ``GridSearchCV``).
"""

import inspect
from typing import Any, Self

from burstcast.discovery import suggestion


class Estimator:
    """Parameters by name, and a short ``repr``."""

    @classmethod
    def _defaults(cls) -> dict[str, Any]:
        parameters = inspect.signature(cls.__init__).parameters
        return {name: one.default for name, one in parameters.items() if name != "self"}

    def get_params(self, deep: bool = True) -> dict[str, Any]:
        """Parameters as they were given, by name."""
        return {name: getattr(self, name) for name in self._defaults()}

    def set_params(self, **parameters: Any) -> Self:
        """Change parameters; the fitted state remains until the next ``fit``."""
        known = list(self._defaults())
        for name in parameters:
            if name not in known:
                raise ValueError(
                    f"{type(self).__name__} has no parameter {name!r}{suggestion(name, known)}; "
                    f"its parameters are {', '.join(known)}"
                )
        for name, value in parameters.items():
            setattr(self, name, value)
        return self

    def __sklearn_tags__(self) -> Any:
        """Tags for scikit-learn's model selection: samples are series, and there is no target."""
        from sklearn.utils import InputTags, Tags, TargetTags

        return Tags(
            estimator_type=None,
            target_tags=TargetTags(required=False),
            input_tags=InputTags(two_d_array=False, three_d_array=True),
        )

    def __sklearn_is_fitted__(self) -> bool:
        """Whether `fit` was called."""
        return hasattr(self, "members_")

    def __repr__(self) -> str:
        defaults = self._defaults()
        given = {
            name: value
            for name, value in self.get_params().items()
            if value is not defaults[name] and repr(value) != repr(defaults[name])
        }
        return f"{type(self).__name__}({', '.join(f'{k}={v!r}' for k, v in given.items())})"
