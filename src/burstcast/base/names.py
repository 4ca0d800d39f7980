"""Identifiers of forecasters and controllers in paths, tables, figures and messages.

An identifier of a forecaster is the kind, and then what tells forecasters of a kind apart:
``equations``, ``esn-N2000-RV-seed3``. Kinds are modules of `burstcast.forecasters`, or classes of
users' modules: ``my_models.NVAR``. A controller is a forecaster, ``none``, random alarms beside a
forecaster (``esn-N2000-RV-seed3-random``) or a committee (``esn-N2000-RV-committee``).
"""

import re
from dataclasses import dataclass
from functools import cache
from typing import Any

KEYS = ("case", "reynolds", "forecaster", "neurons", "validation", "seed")
"""Columns of tables that say what a row is about; a key that does not apply is empty."""

PERMANENT_ALARM = "permanent_alarm"
"""What tables call an alarm at every time, in the place of a forecaster."""

KIND = r"(?:[a-z][a-z0-9_]*|[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)+)"
LABEL, NEURONS, VALIDATION, SEED = "[a-z][a-z0-9]*", r"N\d+", "[A-Z]+", r"seed\d+"
ROLE = "committee|random"
"""Parts of identifiers, as regular expressions: the only place where they are spelt."""

MODEL = f"{KIND}(?:-{LABEL})?"
NETWORK = f"{MODEL}-{NEURONS}-{VALIDATION}-{SEED}"
"""Identifiers of forecasters that are fitted at once, and of networks."""

# what is a role or a seed is no label
_PARTS = {"neurons": NEURONS, "validation": VALIDATION, "seed": SEED, "role": ROLE, "label": LABEL}


@dataclass(frozen=True)
class ForecasterName:
    """Name of a forecaster or controller, whatever its case: None for what does not apply to it."""

    #: module of `burstcast.forecasters`, or module and class of one's own, "my_models:NVAR"
    kind: str
    #: neurons, validation, seed: size, validation strategy and seed of a network
    neurons: int | None = None
    validation: str | None = None
    seed: int | None = None
    #: role of a controller that is no single forecaster: "committee" or "random"
    role: str | None = None
    #: name that a user gives to a variant of networks, or to a class of one's own with some options
    label: str | None = None

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
                ("", self.kind.replace(":", ".")),
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
        kind = self.kind.rpartition(":")[2]
        kind = f"{kind}_{self.label}" if self.label else kind
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


@cache
def parsed(identifier: str) -> ForecasterName:
    """Read an identifier."""
    module_and_class, *parts = identifier.split("-")
    fields: dict[str, Any] = {}
    for part in parts:
        names = (name for name, pattern in _PARTS.items() if re.fullmatch(pattern, part))
        fields[next(names, "")] = part
    for name, prefix in (("neurons", "N"), ("seed", "seed")):
        if name in fields:
            fields[name] = int(fields[name].removeprefix(prefix))
    if re.fullmatch(KIND, module_and_class) and "" not in fields:
        forecaster = ForecasterName(":".join(module_and_class.rsplit(".", 1)), **fields)
        if forecaster.identifier == identifier:  # each part once, in their order
            return forecaster
    raise ValueError(f"{identifier!r} is no forecaster; one is esn-N2000-RV-seed3")
