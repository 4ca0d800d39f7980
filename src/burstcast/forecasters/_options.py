"""Options of the kinds of forecasters: shared sections and their defaults.

The workflow's config has the same sections, ``forecasters``, with the same values.
"""

from collections.abc import Mapping
from typing import Any

DEFAULTS: Mapping[str, Mapping[str, Any]] = {
    "esn": {
        **{"connectivity": 20, "input_bias": 0.1, "input_range": "all"},
        **{"readout": "linear", "leak_rate": [1]},
        **{"divergence_bound": 10, "backend": "compiled"},
    },
    "observation": {"noise": None},
    "filter": {"members": 40, "inflation": 1},
    "quadratic": {"degree": 2, "window_lt": 0.2},
    "analogues": {"neighbours": 10},
    "classifiers": {"start_spacing_lt": 0.1, "folds": 10},
    "precursor": {"classifier": "boosting", "lags_lt": [0.1, 0.2, 0.3, 0.4]},
    "esn_direct": {
        **{"neurons": 1000, "spectral_radius": [0.9], "input_scaling": [1, 10]},
        "penalty": [1, 30],
    },
    "aware": {"parameters": ["reynolds"], "transform": "inverse", "parameter_degree": 1},
}
"""Options by section. Those of ``aware`` set which parameters a forecaster knows, and the functions
of them that it learns (`burstcast.data.parameter_factors`). Those of ``classifiers`` set the points
that these learn from, and the folds of the training series that calibrate their probabilities."""

_SECTIONS: Mapping[str, tuple[str, ...]] = {
    "equations_filtered": ("observation", "filter"),
    "quadratic": ("observation", "quadratic"),
    "quadratic_filtered": ("observation", "quadratic", "filter"),
    "quadratic_aware": ("observation", "quadratic", "aware"),
    "esn_aware": ("esn", "aware"),
    "esn_direct": ("esn", "esn_direct"),
    "esn_true_washout": ("esn",),
    "quadratic_aware_filtered": ("observation", "quadratic", "aware", "filter"),
}
"""Sections by kind; all other kinds have one section, of their own name."""


def sections_of_kind(kind: str) -> tuple[str, ...]:
    """Sections with the options of a kind of forecaster."""
    return _SECTIONS.get(kind, (kind,))


def options_of_kind(
    kind: str, sections: Mapping[str, Mapping[str, Any]] = DEFAULTS
) -> dict[str, Any]:
    """Options of a kind of forecaster, from all of its sections; empty if it has none."""
    return {
        name: value
        for section in sections_of_kind(kind)
        for name, value in sections.get(section, {}).items()
    }
