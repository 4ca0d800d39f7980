"""Encoders by name: the module ``burstcast.encoders.<kind>`` holds the kind ``<kind>``."""

import burstcast.encoders
from burstcast.discovery import concrete_classes, module_names, suggestion
from burstcast.encoders.base import Encoder

_OTHERS = ("base", "channels", "registry", "state_maps")


def available_encoders() -> list[str]:
    """Names of all kinds of encoders, sorted."""
    return [name for name in module_names(burstcast.encoders) if name not in _OTHERS]


def encoder_class(kind: str) -> type[Encoder]:
    """Class of the encoders of a kind: "identity", "pod", ..."""
    available = available_encoders()
    if kind not in available:
        raise ValueError(
            f"unknown kind of encoder {kind!r}{suggestion(kind, available)}; "
            f"the available kinds are {', '.join(available)}"
        )
    (found,) = concrete_classes(burstcast.encoders, kind, Encoder)  # type: ignore[type-abstract]
    return found
