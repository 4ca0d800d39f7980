"""Channels that are arithmetic expressions of observed components."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.encoders.base import Encoder, EncodingCase
from burstcast.systems.expressions import Expression


@dataclass(frozen=True)
class ExpressionsEncoder(Encoder):
    """Values of expressions, the option ``expressions``: ``["a1", "a2**2 + a3**2"]``."""

    option_names: ClassVar[tuple[str, ...]] = ("expressions",)

    components: tuple[str, ...]  #: names of the observed components
    expressions: tuple[Expression, ...]  #: their expressions

    @classmethod
    def fit(cls, training: FloatArray, case: EncodingCase) -> Self:
        """Read the expressions, and check that they are finite on the training series."""
        encoder = cls(case.components, _expressions(case))
        values = encoder.encode_series(training)
        for number, one in enumerate(encoder.expressions):
            if not np.isfinite(values[..., number]).all():
                raise ValueError(
                    f"encoder.expressions: {one.text!r} is not finite for some states of the "
                    "training series; divide by nothing that may vanish, and take roots and "
                    "logarithms of positive numbers"
                )
        return encoder

    @classmethod
    def channel_names(cls, case: EncodingCase) -> tuple[str, ...]:
        """The expressions as they are written."""
        return tuple(one.text for one in _expressions(case))

    def encode(self, observed: FloatArray) -> FloatArray:
        """Values ``(expression, ...)`` of components ``(component, ...)``."""
        values = dict(zip(self.components, observed, strict=True))
        return np.stack([one(values) for one in self.expressions])


def _expressions(case: EncodingCase) -> tuple[Expression, ...]:
    """Expressions that the options say. Raises ValueError if they name no components."""
    components = case.components
    expressions = tuple(map(Expression, case.options.get("expressions", ())))
    if not expressions:
        raise ValueError("expressions must name one expression at least")
    for one in expressions:
        unknown = sorted(set(one.names) - set(components))
        if unknown:
            raise ValueError(
                f"{one.text!r} names {', '.join(unknown)}; observed are {', '.join(components)}"
            )
    return expressions
