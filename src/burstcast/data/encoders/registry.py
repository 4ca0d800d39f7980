"""Encoders by name, of this package and of modules of the user.

The module ``burstcast.data.encoders.<kind>`` holds the kind ``<kind>``. An encoder of one's own is
named by its module and class, ``my_flows.encoders:Moduli``: any module that Python finds.
"""

import burstcast.data.encoders
from burstcast.base.discovery import (
    concrete_classes,
    module_names,
    module_of,
    own_class,
    suggestion,
)
from burstcast.data.encoders.base import Encoder

_OTHERS = ("base", "channels", "registry", "state_maps")


def available_encoders() -> list[str]:
    """Names of all kinds of encoders of this package, sorted."""
    return [name for name in module_names(burstcast.data.encoders) if name not in _OTHERS]


def encoder_class(kind: str) -> type[Encoder]:
    """Class of the encoders of a kind: "identity", "pod", ..., "my_flows.encoders:Moduli"."""
    if ":" in kind:
        return own_class(kind, Encoder, "encoder")  # type: ignore[type-abstract]
    available = available_encoders()
    if kind not in available:
        raise ValueError(
            f"unknown kind of encoder {kind!r}{suggestion(kind, available)}; "
            f"the available kinds are {', '.join(available)}; "
            "a class in a module of yours is named <module>:<class>"
        )
    (encoder,) = concrete_classes(burstcast.data.encoders, kind, Encoder)  # type: ignore[type-abstract]
    return encoder


def encoder_module(kind: str) -> str:
    """Full name of the module of the encoders of a kind."""
    return module_of(kind, burstcast.data.encoders)
