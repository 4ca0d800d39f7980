"""Identifiers of forecasters and controllers in paths, tables, figures and messages.

An identifier of a forecaster is the kind, and then what tells forecasters of a kind apart:
``equations``, ``esn-N2000-RV-seed3``, ``esn-squares-N2000-RV-seed3``. Kinds are modules of
`burstcast.forecasters`. A controller is a forecaster, ``none``, random alarms beside a forecaster
(``esn-N2000-RV-seed3-random``) or a committee (``esn-N2000-RV-committee``).
"""

import re
from dataclasses import dataclass
from typing import Any

KEYS = ("case", "reynolds", "forecaster", "neurons", "validation", "seed")
"""Columns of tables that say what a row is about; a key that does not apply is empty."""

PERMANENT_ALARM = "permanent_alarm"
"""What tables call an alarm at every time, in the place of a forecaster."""

_PATTERN = re.compile(
    r"(?P<kind>[a-z][a-z0-9_]*)(-(?!(committee|random|seed\d+)(-|$))(?P<label>[a-z][a-z0-9]*))?(-N(?P<neurons>\d+))?(-(?P<validation>[A-Z]+))?(-seed(?P<seed>\d+))?"
    r"(-(?P<role>committee|random))?"
)


@dataclass(frozen=True)
class ForecasterName:
    """Name of a forecaster or controller, whatever its case: None for what does not apply to it."""

    kind: str  #: module of `burstcast.forecasters`
    #: neurons, validation, seed: size, validation strategy and seed of a network
    neurons: int | None = None
    validation: str | None = None
    seed: int | None = None
    #: role of a controller that is no single forecaster: "committee" or "random"
    role: str | None = None
    label: str | None = None  #: name that a user gives to a variant of networks

    @property
    def asks_forecasters(self) -> bool:
        """Whether the controller needs a forecaster."""
        return self.kind != "none" and self.role != "random"

    @property
    def identifier(self) -> str:
        """Name of the forecaster in paths, tables and messages."""
        parts = [
            f"{prefix}{value}"
            for prefix, value in (
                ("", self.kind),
                ("", self.label),
                ("N", self.neurons),
                ("", self.validation),
                ("seed", self.seed),
                ("", self.role),
            )
            if value is not None
        ]
        return "-".join(parts)

    @property
    def keys(self) -> dict[str, Any]:
        """Key columns of the forecaster in tables."""
        kind = f"{self.kind}_{self.label}" if self.label else self.kind
        return {
            "forecaster": {"committee": f"{kind}_committee", "random": "random"}.get(
                self.role or "", kind
            ),
            "neurons": self.neurons,
            "validation": self.validation,
            "seed": self.seed,
        }


def described(kind: Any, neurons: Any = None, validation: Any = None) -> str:
    """Description of a forecaster for people, such as "esn, 500 neurons, RV"."""
    if kind == PERMANENT_ALARM:
        return "permanent alarm"
    parts = [kind] if isinstance(kind, str) else []
    if isinstance(neurons, int | float) and neurons == neurons and neurons > 0:
        parts.append(f"{neurons:g} neurons")
    return ", ".join(
        [*parts, *([validation] if isinstance(validation, str) and validation else [])]
    )


def parsed(identifier: str) -> ForecasterName:
    """Read an identifier."""
    match = _PATTERN.fullmatch(identifier)
    if match is None:
        raise ValueError(f"{identifier!r} is no forecaster; one is esn-N2000-RV-seed3")
    neurons, seed = (
        None if match[name] is None else int(match[name]) for name in ("neurons", "seed")
    )
    names = match["kind"], neurons, match["validation"], seed, match["role"], match["label"]
    return ForecasterName(*names)
