"""Inputs that resemble the campaign's, and a look at what a reader would see."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from unittest import mock

import numpy as np
import pandas as pd
from matplotlib.backend_bases import RendererBase
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from burstcast.arrays import FloatArray

THRESHOLD = 0.1
NUMBER_KEYS = {"case": "Re400", "reynolds": 400.0}


def burst(time_lt: FloatArray, peak_at: float, height: float = 0.2) -> FloatArray:
    """A quiet signal with one slow rise and quick collapse."""
    rise = np.exp(-np.square((time_lt - peak_at) / np.where(time_lt < peak_at, 1.5, 0.4)))
    return 0.03 + 0.01 * np.sin(3 * time_lt) + height * rise


def percentile_rows(
    metrics: dict[str, float],
    sizes: tuple[float, ...] = (500.0, 1000.0, 1500.0),
    validations: tuple[str, ...] = ("SSV", "RV"),
    prediction_times: tuple[float, ...] | None = None,
    **keys: object,
) -> pd.DataFrame:
    """A percentile table; medians fall with the prediction time and grow with the size."""
    rows = []
    times = prediction_times or (np.nan,)
    for size, validation, time, (metric, scale) in itertools.product(
        sizes, validations, times, metrics.items()
    ):
        median = scale * (1 - 100 / size - (0.05 if validation == "SSV" else 0.0))
        if prediction_times:
            median *= 1 - 0.12 * time
        rows.append(
            {
                **NUMBER_KEYS,
                "forecaster": "esn",
                "neurons": size,
                "validation": validation,
                "prediction_time_lt": time,
                "metric": metric,
                "p25": 0.95 * median,
                "p50": median,
                "p75": 1.04 * median,
                "networks": 10,
                **keys,
            }
        )
    return pd.DataFrame(rows)


@dataclass(frozen=True)
class DrawnText:
    """Words on a page, where they are and how big."""

    words: str
    frame: Bbox
    size: float


def drawn_texts(figure: Figure) -> list[DrawnText]:
    """Texts that a reader sees: those that are drawn, so no tick labels out of range."""
    drawn: list[DrawnText] = []
    draw = Text.draw

    def record(text: Text, renderer: RendererBase) -> None:
        if text.get_visible() and text.get_text().strip():
            # The words alone: an annotation's own extent includes its arrow and its point.
            frame = Text.get_window_extent(text, renderer)
            drawn.append(DrawnText(text.get_text(), frame, float(text.get_fontsize())))
        draw(text, renderer)

    with mock.patch.object(Text, "draw", record):
        figure.canvas.draw()
    return drawn


def overlapping_texts(texts: Sequence[DrawnText]) -> list[tuple[str, str]]:
    """Pairs of texts that lie on each other by more than a hair."""
    pairs = []
    for first, second in itertools.combinations(texts, 2):
        one, two = first.frame, second.frame
        width = min(one.x1, two.x1) - max(one.x0, two.x0)
        height = min(one.y1, two.y1) - max(one.y0, two.y0)
        if width > 1.5 and height > 1.5:
            pairs.append((first.words, second.words))
    return pairs


def texts_outside(figure: Figure, texts: Sequence[DrawnText]) -> list[str]:
    """Texts that the edge of the figure cuts."""
    return [
        text.words
        for text in texts
        if min(text.frame.min) < -1 or (text.frame.max > figure.bbox.max + 1).any()
    ]


def interval_rows(percentiles: pd.DataFrame) -> pd.DataFrame:
    """Intervals of three networks around the medians of a table of percentiles, and wider."""
    rest = percentiles.drop(columns=["p25", "p50", "p75", "networks"], errors="ignore")
    return pd.concat(
        [
            rest.assign(
                seed=seed,
                low=(0.7 + 0.02 * seed) * percentiles["p50"],
                high=(1.3 + 0.02 * seed) * percentiles["p50"],
            )
            for seed in range(3)
        ],
        ignore_index=True,
    )


def as_published(rows: pd.DataFrame, kind: str) -> pd.DataFrame:
    """Percentiles in the form of the published ones."""
    training = rows["forecaster"] == "training"
    names = {"mean_horizon_lt": "mean_prediction_horizon", "mean_log_error": "mle"}
    return pd.DataFrame(
        {
            "kind": kind,
            **{name: rows[name] for name in ("reynolds", "neurons", "p25", "p50", "p75")},
            "validation": rows["validation"].mask(training, "TRAIN"),
            "prediction_time": rows["prediction_time_lt"],
            "metric": rows["metric"].replace(names),
        }
    )
