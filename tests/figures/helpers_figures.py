"""Inputs that resemble a campaign's, the figures drawn from them, and what a reader sees."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations, product
from typing import Any
from unittest import mock

import numpy as np
import pandas as pd
from matplotlib.backend_bases import RendererBase
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from burstcast.base.arrays import FloatArray
from burstcast.figures.parts.style import nothing_to_show
from burstcast.figures.registry import figure_of
from burstcast.statistics.densities import bin_edges, histogram
from kolmogorov_flow import KolmogorovFlow

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
    for size, validation, time, (metric, scale) in product(
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
    for first, second in combinations(texts, 2):
        frame, other = first.frame, second.frame
        width = min(frame.x1, other.x1) - max(frame.x0, other.x0)
        height = min(frame.y1, other.y1) - max(frame.y0, other.y0)
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


# -- arguments of every figure, and the figures drawn from them ------------------------------------

TIME = np.linspace(0.0, 8.0, 401)
SERIES: dict[str, Any] = {
    "observable": burst(TIME, 4.0)[np.newaxis],
    "threshold": THRESHOLD,
    "symbol": "k",
    # 50 samples in a Lyapunov time
    **{"exponents": None, "given_exponent": 0.02, "time_step": 0.5, "sampling_stride": 2},
}
NAMED = {"symbol": "k", "observable_name": "kinetic energy"}
FLOW: dict[str, Any] = {
    "system": "mfe",
    "parameters": {"reynolds": 400.0, "length_x": 4 * np.pi, "length_z": 2 * np.pi},
    "flow_points": [17, 9, 13],
}
PLANE_FLOW: dict[str, Any] = {
    "system": "kolmogorov_flow:KolmogorovFlow",
    "parameters": {"largest_wavenumber": 3, "forcing_wavenumber": 2},
    "training_series": 1,
}
SCORES = {"precision": 0.97, "recall": 1.0, "f_score": 0.98}
PREDICTION_TIMES = (1.0, 2.0, 3.0)
STATES = np.random.default_rng(5).normal(0.0, 0.1, (4, 9)) + np.eye(9)[0]
MARKS = np.array([50, 125, 200, 275])
EXAMPLES: dict[str, Any] = {
    "outcome": np.array([0, 1, 2]),
    "example_time_lt": TIME - 1.5,
    "example_truth": np.stack([burst(TIME, peak) for peak in (4.5, 7.5, 4.5)]),
    "example_forecast": np.where(
        TIME >= 1.5, np.stack([burst(TIME, peak) for peak in (4.6, 4.5, 7.5)]), np.nan
    ),
    "evaluation_time_lt": (late := np.linspace(-9, 2, 221)),
    "evaluation_truth": burst(late, 0.6),
    "evaluation_lead_time_lt": (leads := np.array([7.5, 7.0, 6.5, 6.0])),
    "evaluation_forecast": burst(late, 0.6)
    + 0.02 * (leads[:, np.newaxis] - 6) * np.exp(0.8 * late),
    "evaluation_horizon_lt": np.array([6.5, 6.0, 5.5, 6.0]),
    "allowed_error": 0.008,
}
EVENT: dict[str, Any] = {
    "time_lt": TIME,
    "true": burst(TIME, 4.0),
    "forecast": burst(TIME, 4.1),
    "mark": MARKS,
    "true_state": STATES,
    "forecast_state": 1.02 * STATES,
}
SUPPRESSED: dict[str, Any] = {
    "time_lt": TIME - 1.0,
    "uncontrolled": burst(TIME - 1.0, 5.0),
    "controlled": 0.3 * burst(TIME - 1.0, 5.0),
    "forecast": np.where((TIME >= 1) & (TIME <= 5), 0.9 * burst(TIME - 1.0, 5.0), np.nan),
    "actuation_lt": np.array([1.0, 2.5]),
    "mark": MARKS,
    "uncontrolled_state": STATES,
    "controlled_state": 0.3 * STATES,
}


def long_term_file(scale: float, **more: Any) -> dict[str, Any]:
    """Content of a file of long-term statistics."""
    counts = histogram(scale * burst(TIME, 4.0), bin_edges(0.0, 0.3, 30))
    moments = scale * (np.outer(STATES[0], STATES[0]) + 0.1 * np.eye(9))
    return {
        **{"edge": counts.edges, "count": counts.counts, "below": 0, "above": 0},
        **{"states": 401, "mean": scale * STATES[0], "mean_product": moments, **more},
    }


LONG_TERM: dict[str, Any] = {
    "data": long_term_file(1.0),
    "training": long_term_file(0.8),
    "long_term": [
        long_term_file(0.9, neurons=1000, seed=0),
        long_term_file(0.5, neurons=1000, seed=1),
    ],
}


def search_rows() -> pd.DataFrame:
    """A search whose objective is least near (0.3, 2), with two Tikhonov parameters a point."""
    grid = [("grid", *point) for point in product((0.1, 0.3, 1.0), (0.1, 1.0, 10.0))]
    rows = []
    for source, radius, scaling in [*grid, ("bayesian", 0.3, 2.0), ("bayesian", 0.5, 3.0)]:
        distance = np.log10(radius / 0.3) ** 2 + np.log10(scaling / 2.0) ** 2
        for tikhonov, worse in ((1e-6, 0.5), (1e-9, 0.0)):
            rows.append((source, radius, scaling, tikhonov, distance - 4.0 + worse))
    columns = ["source", "spectral_radius", "input_scaling", "tikhonov", "objective"]
    return pd.DataFrame(rows, columns=columns)


def growing_errors() -> dict[str, Any]:
    """Forecasts whose errors grow by e in a Lyapunov time, from less for larger networks."""
    generator = np.random.default_rng(1)
    truth, signs = generator.normal(0.0, 1.0, (200, 8)), generator.choice([-1.0, 1.0], (200, 8))
    time_lt = 0.5 * np.arange(1, 9)
    forecasts = []
    for size, seed in product((500, 1000, 1500, 2000, 4000), range(3)):
        errors = (1.0 + 0.1 * seed) * 10 / size * np.exp(time_lt)
        name = f"esn-N{size}-RV-seed{seed}"
        forecasts.append({"forecaster": name, "first": truth + signs * errors})
    others = [{"forecaster": "esn-N500-SSV-seed0", "first": truth}]
    return {
        "truth": truth,
        "forecasts": forecasts + others,
        "summary": {"mean_observable": 0.0},
        **{"threshold": 1.0, "tolerance": 0.2, "resolution_lt": 0.5, "validation": "RV"},
    }


def ranking_rows() -> pd.DataFrame:
    """Rows of the table ranking: made up, each forecaster a little worse than the one before."""
    sources = [
        ("flow", "equations", "equations", None, None),
        ("flow", "published_precursor", "published_precursor", None, None),
        ("sensors", "equations_filtered", "equations_filtered", None, None),
        ("sensors", "equations_filtered-committee", "equations_filtered_committee", None, None),
        *(("invariants", f"esn-N50-RV-seed{seed}", "esn", 50, seed) for seed in range(2)),
        ("invariants", "esn-N50-RV-committee", "esn_committee", 50, None),
        ("invariants", "esn-N90-RV-seed0", "esn", 90, 0),
        ("sensors_invariants", "esn-N90-RV-seed0", "esn", 90, 0),  # a little worse
        *((case, "observable_now", "observable_now", None, None) for case in ("flow", "sensors")),
    ]
    rows = []
    for (number, source), time, event in product(
        enumerate(sources), (0.5, 1.0, 2.0), ("onset", "any")
    ):
        value = 0.9 * np.exp(-0.3 * time - 0.2 * number) + (0.05 if event == "any" else 0.0)
        for scores in (("average_precision", *around(value)), ("base_rate", 0.05, None, None)):
            rows.append((*source, time, event, *scores))
    names = ["case", "alarm", "forecaster", "neurons", "seed", "prediction_time_lt", "event"]
    return pd.DataFrame(rows, columns=[*names, "metric", *ENDS])


ENDS = ["value", "low", "high"]


def around(value: float, below: float = 0.03, above: float = 0.02) -> tuple[float, float, float]:
    """A value and the ends of its interval."""
    return value, value - below, value + above


def statistics_rows() -> pd.DataFrame:
    metrics = {
        "nrmse_u": 0.02,
        "nrmse_uu": 0.06,
        "nrmse_uv": 0.005,
        "kantorovich": 0.006,
        "mean_log_error": 0.15,
    }
    table = percentile_rows(metrics, validations=("RV",))
    references = [
        percentile_rows(
            {metric: factor * scale for metric, scale in metrics.items()},
            sizes=(np.inf,),
            validations=("RV",),
            forecaster=name,
            neurons=np.nan,
            validation=np.nan,
        )
        for name, factor in (("training", 2.0), ("floor", 0.2))
    ]
    return pd.concat([table, *references], ignore_index=True)


def own_flow(rate: float = 1e-4, spectrum: bool = True) -> dict[str, Any]:
    """Tables of survival and of spectra."""
    time = np.linspace(0, 4000, 101)
    share = np.exp(-rate * time)
    curves = pd.concat(
        percentile_rows({"survival": value}, forecaster=name, time=now)
        for name, factor in (("esn", 1.0), ("equations", 0.98))
        for now, value in zip(time, factor * share, strict=True)
    )
    ends = {"survival_low": 0.97 * share, "survival_high": np.minimum(1, 1.03 * share)}
    flow = np.array([0.0155, 0.0045, 0.0, -0.006, -0.013, -0.02, -0.031, -0.036, -0.041])
    exponents = pd.concat(
        percentile_rows({"lyapunov_exponent": value}, validations=("RV",), number=number)
        for number, value in enumerate([*flow, -0.27], 1)
    )
    exponents[["p25", "p75"]] = np.sort(exponents[["p25", "p75"]], axis=1)
    number = {"number": np.arange(1, 10)}
    tables = {
        "exponents": of_data("lyapunov_exponent", flow, 0.0005, **number),
        "exponent_percentiles": exponents,
        "dimensions": of_data("kaplan_yorke_dimension", np.array([5.1]), 0.05),
        "dimension_percentiles": percentile_rows(
            {"kaplan_yorke_dimension": 5.5}, validations=("RV",)
        ),
    }
    return {
        "curves": pd.DataFrame({"forecaster": "data", "time": time, "survival": share, **ends}),
        "curve_percentiles": curves,
        "rates": of_data("escape_rate", np.array([rate]), 0.1 * rate),
        "rate_percentiles": percentile_rows({"escape_rate": 1.5 * rate}),
        **{name: [table] if spectrum else None for name, table in tables.items()},
        "neurons": 1000,
    }


def of_data(name: str, values: np.ndarray, width: float, **keys: Any) -> pd.DataFrame:
    """Rows of the data with the ends of their intervals."""
    ends = {f"{name}_low": values - width, f"{name}_high": values + width}
    return pd.DataFrame({"forecaster": "data", **keys, name: values, **ends})


def control_tables() -> dict[str, pd.DataFrame]:
    """Percentiles of the paper's control, and costs and gains of its runs over flows."""
    keys = {"sizes": (2000.0,), "validations": ("RV",), "prediction_times": PREDICTION_TIMES}
    percentiles = pd.concat(
        percentile_rows(
            {"reduction": value, "control_fraction": 0.2 + 0.05 * index, **more},
            **keys,  # type: ignore[arg-type]
            forecaster=name,
        )
        for index, (name, value, more) in enumerate(
            (
                ("esn", 0.9, {"exceedance_uncontrolled": 0.1}),
                ("equations", 0.8, {}),
                ("random", 0.3, {}),
            )
        )
    )
    papers = {"strategy": "prediction_triggered", "starts": "quiet"}
    papers |= {"delay_lt": 0.0, "quiet_lt": 0.0, "strength": 1.0}  # type: ignore[dict-item]
    strategies = percentiles[percentiles["metric"].isin(["reduction", "control_fraction"])]
    left = strategies["metric"] == "reduction"
    strategies = strategies.assign(
        **papers,
        metric=strategies["metric"].replace("reduction", "relative_exceedance"),
        low=strategies["p25"].where(~left, 1 - strategies["p75"]),
        high=strategies["p75"].where(~left, 1 - strategies["p25"]),
    )
    return {"percentiles": percentiles, "strategies": strategies}


def density_rows() -> pd.DataFrame:
    """Densities with and without control at four Reynolds numbers and two prediction times."""
    edges = np.linspace(0.015, 0.47, 41)
    without, rows = 40 * np.exp(-25 * edges[:-1]), []
    for reynolds, (time, factor) in product((400, 600, 800, 1000), ((1.0, 0.5), (2.0, 0.7))):
        keys = {"case": f"Re{reynolds}", "reynolds": float(reynolds), "forecaster": "esn", **SIZE}
        table = {**keys, "prediction_time_lt": time, "low": edges[:-1], "high": edges[1:]}
        for name, density in (("uncontrolled", without), ("controlled", factor * without)):
            for end, share in (("", 1.0), ("_low", 0.9), ("_high", 1.1)):
                table[f"density_{name}{end}"] = share * density
        rows.append(pd.DataFrame(table))
    return pd.concat(rows, ignore_index=True)


USUAL = {"span_lt": 20.0, "noise": 0.01}
SIZE: dict[str, Any] = {"neurons": 2000.0, "validation": "RV"}
NO_SIZE: dict[str, Any] = {"neurons": np.nan, "validation": np.nan}


PARAMETER = {
    "name": "reynolds",
    "values": {"Re400": 400.0, "Re500": 500.0, "Re600": 600.0, "Re800": 800.0},
    "trained": [400.0, 600.0, 1000.0],
    "kinds": ["esn_aware", "quadratic_aware_filtered"],
}


def parameter_rows() -> dict[str, list[pd.DataFrame]]:
    """Scores, their intervals and escape rates of three kinds at four Reynolds numbers."""
    best = {"esn": 0.7, "esn_aware": 0.72, "quadratic_aware_filtered": 0.9}
    scores, rates = [], []
    for case, value in PARAMETER["values"].items():
        for kind in ("data", *best):
            rate = (2e-5 if kind == "data" else 2.2e-5) * 1000 / value
            rates.append((case, kind, *around(rate, 0.3 * rate, 0.4 * rate)))
        for (kind, score), time in product(best.items(), (1.0, 2.0, 3.0)):
            f_score = score - 0.1 * (time - 1) - 1e-4 * (value - 400)
            scores.append((case, kind, time, "f_score", *around(f_score, 0.05, 0.04)))
    keys = ["case", "forecaster", "prediction_time_lt"]
    f_scores = pd.DataFrame(scores, columns=[*keys, "metric", "f_score", "low", "high"])
    escape = [f"escape_rate{end}" for end in ("", "_low", "_high")]
    tables = {
        "scores": f_scores[[*keys, "f_score"]],
        "intervals": f_scores.drop(columns="f_score"),
        "survivals": pd.DataFrame(rates, columns=[*keys[:2], *escape]),
    }
    return {name: [rows.assign(neurons=np.nan)] for name, rows in tables.items()}


def frontier_rows() -> pd.DataFrame:
    """Scores of control: the more a strategy acts, the less is left; nothing in one run."""
    rows = []
    settings = ("horizon_lt", "decision_interval_lt", "prediction_time_lt", "level", "vote_share")
    conditions = {"starts": "quiet", **USUAL, "quiet_lt": 3.0, "delay_lt": 0.0, "strength": 1.0}
    usual = {**dict.fromkeys(settings, np.nan), **conditions}

    def run(forecaster: str, strategy: str, left: float, acting: float, **changes: float) -> None:
        size = SIZE if forecaster.startswith("esn") else NO_SIZE
        keys = {"case": "Re400", "forecaster": forecaster, "strategy": strategy, **size}
        for metric, value in (("relative_exceedance", left), ("control_fraction", acting)):
            score = {"value": value, "low": 0.5 * value, "high": 1.5 * value if value else 0.005}
            rows.append({**keys, **usual, **changes, "metric": metric, **score})

    horizons = ((1.0, 2e-2, 0.1), (2.0, 1e-3, 0.05), (3.0, 0.0, 0.03))
    others = {"delay_lt": (0.25, 1.0), "strength": (0.25, 0.5), "noise": (0.03, 0.1)}
    for forecaster, factor in (("esn", 2.0), ("equations", 1.0)):
        receding = (forecaster, "receding_horizon")
        for (horizon, left, acting), interval in product(horizons, (0.1, 0.25)):
            often = {"horizon_lt": horizon, "decision_interval_lt": interval}
            run(*receding, factor * left, acting * (1 + interval), **often)
        usual_run = {"horizon_lt": 2.0, "decision_interval_lt": 0.25}
        for condition, values in others.items():
            for value in values:
                run(*receding, 2e-2 * factor, 0.06, **usual_run, **{condition: value})
        run(forecaster, "prediction_triggered", 0.2, 0.09, prediction_time_lt=1.0)
    for horizon, left, acting in ((2.0, 5e-4, 0.045), (3.0, 0.0, 0.025)):
        votes = {"horizon_lt": horizon, "decision_interval_lt": 0.25, "vote_share": 0.5}
        run("esn_committee", "receding_horizon", left, acting, **votes)
    for level, left, acting in ((0.04, 0.01, 0.5), (0.06, 0.06, 0.24)):
        run("none", "reactive", left, acting, level=level, decision_interval_lt=0.25)
    return pd.DataFrame(rows)


def reynolds_rows(metric: str, times: tuple[float, ...] | None) -> pd.DataFrame:
    return pd.concat(
        [
            percentile_rows(
                {metric: 0.9 - re / 5000},
                sizes=(2000.0,),
                prediction_times=times,
                case=f"Re{re}",
                reynolds=float(re),
            )
            for re in (400, 600, 800, 1000)
        ]
    )


ALARMS = {  # how good, between 0 and 1
    "esn_committee": 0.9,
    "esn": 0.8,
    "equations": 1.0,
    "equations_filtered": 0.97,
    "equations_noisy": 0.7,
    "quadratic": 0.65,
    "quadratic_filtered": 0.95,
    "linear_inverse": 0.05,
    "analogues": 0.3,
    "persistence": 0.1,
    "observable_now": 0.1,
    "climatology": 0.0,
}


def alarm_rows(x: str, positions: tuple[float, ...], **keys: object) -> pd.DataFrame:
    """Scores that fall with x, of three networks, their committee and everybody else."""
    rows: list[dict[str, object]] = []
    for kind, good in ALARMS.items():
        seeds = range(3) if kind == "esn" else (np.nan,)
        size = SIZE if kind.startswith("esn") else NO_SIZE
        for seed, position in product(seeds, positions):
            value = good * (1.0 - 0.1 * (1.0 - good + 0.1 * np.nan_to_num(seed)) * position)
            whose = {"case": "Re400", "forecaster": kind, **size, "seed": seed}
            scores = dict(zip(ENDS, around(value), strict=True))
            rows.append({**whose, "probability": "calibrated", x: position, **scores, **keys})
    return pd.DataFrame(rows)


def score_rows(*metrics: str, x: str = "prediction_time_lt") -> pd.DataFrame:
    return pd.concat([alarm_rows(x, (1.0, 2.0, 3.0, 4.0), metric=metric) for metric in metrics])


def reliability_rows() -> pd.DataFrame:
    """Committees tell many probabilities, who forecasts once tells two, climatology one."""
    rows = []
    for (kind, good), probability in product(ALARMS.items(), ("calibrated", "votes")):
        levels = {"esn_committee": 11, "esn": 0, "climatology": 1}.get(kind, 2)
        bins_used = np.linspace(0, 10, levels).astype(int)
        size = SIZE if kind == "esn_committee" else NO_SIZE
        keys = {"case": "Re400", "forecaster": kind, "probability": probability, **size}
        for number, mean in enumerate(np.linspace(0, 1, 11)):
            count = (7000 if number == 0 else 40) if number in bins_used else 0
            shown = {
                "mean_probability": mean,
                "observed_frequency": mean * (good if probability == "votes" else 0.95),
                "consistency_low": max(0.0, mean - 0.1),
                "consistency_high": min(1.0, mean + 0.1),
            }
            shown = shown if count else dict.fromkeys(shown, np.nan)
            where = {"prediction_time_lt": 3.0, "bin": number, "forecasts": count}
            rows.append({**keys, **where, **shown})
    return pd.DataFrame(rows)


def plane_states() -> dict[str, Any]:
    """Two series of a plane flow whose modes decay at rates of their own, but for one burst."""
    flow = KolmogorovFlow(**PLANE_FLOW["parameters"])
    generator = np.random.default_rng(3)
    waves = np.sin(np.arange(120) * generator.uniform(0.2, 0.9, (flow.dimension, 1)))
    size = 1.0 / np.arange(1, flow.dimension + 1)
    states = np.stack([waves.T * size, 0.7 * waves.T * size])
    states[1, 60] *= 4.0
    observable = flow.observable(states.reshape(-1, flow.dimension).T).reshape(2, -1)
    return {"states": states, "observable": observable}


def plane_event() -> dict[str, Any]:
    """An event whose channels are its states: the forecast has three quarters of them."""
    states = plane_states()["states"]
    marks = np.array([4, 8, 12, 16])
    channels = 0.75 * states[1, 50 + marks]
    time_lt = np.linspace(-0.5, 2.0, 26)
    observable = 0.1 + 0.2 * np.exp(-((time_lt - 1) ** 2))
    event = {
        **{"time_lt": time_lt, "true": observable, "forecast": 0.9 * observable, "mark": marks},
        "forecast_state": np.hstack([channels, np.zeros((4, 1))]),
        **{"series": 1, "first_step": 50},
    }
    size = states.shape[2]
    return {"event": event, "states": states, "gain": np.eye(size), "constant": np.zeros(size)}


ARGUMENTS: dict[str, Callable[[], dict[str, Any]]] = {
    "observable_and_density": lambda: {
        **SERIES,
        **NAMED,
        "density": {"bins": 40, "range": [0.015, 0.47]},
    },
    "validation_strategies": lambda: {
        **SERIES,
        "training_series": 1,
        "strategies": ["SSV", "RV"],
        "recycle": {"series": 1, "intervals_per_series": 2},
        **{"washout_lt": 0.5, "interval_lt": 2.0},
    },
    "network_schematic": lambda: {
        **{"inputs": 9, "neurons": 2000, "connectivity": 20, "input_bias": 0.1},
        "hyperparameters": {"spectral_radius": 0.29, "input_scaling": 0.33, "tikhonov": 1e-9},
    },
    "hyperparameter_search": lambda: {"trace": search_rows()},
    "error_growth": growing_errors,
    "prediction_schematic": lambda: {
        **{"examples": EXAMPLES, "threshold": THRESHOLD, "symbol": "k"},
        **{"prediction_time_lt": 2.0, "washout_lt": 0.5, "window_lt": 1.0},
    },
    "prediction_examples": lambda: {
        **{"examples": EXAMPLES, "threshold": THRESHOLD, "symbol": "k"},
        **{"prediction_time_lt": 2.0, "window_lt": 1.0},
    },
    "classification_scores": lambda: {
        "percentiles": percentile_rows(SCORES, prediction_times=PREDICTION_TIMES),
        **{"fixed_neurons": 1000, "fixed_prediction_time_lt": 3, "sizes_validation": "RV"},
    },
    "horizon_schematic": lambda: {
        **{"longest_lead_time_lt": 10, "lead_time_step_lt": 0.5, "tolerance": 0.2, "symbol": "k"}
    },
    "horizon_evaluations": lambda: {
        **{"examples": EXAMPLES, "threshold": THRESHOLD, "washout_lt": 0.5, "symbol": "k"}
    },
    "horizon_by_size": lambda: {
        "percentiles": percentile_rows({"mean_horizon_lt": 4.5}),
    },
    "by_reynolds": lambda: {
        "horizons": [reynolds_rows("mean_horizon_lt", None)],
        "scores": [reynolds_rows("f_score", PREDICTION_TIMES)],
        **{"neurons": 2000, "prediction_times_lt": [2.0, 3.0]},
    },
    "forecast_skill": lambda: {
        "scores": score_rows("f_score", "brier_skill"),
        **{"neurons": 2000, "validation": "RV"},
    },
    "reliability": lambda: {
        "bins": reliability_rows(),
        **{"prediction_times_lt": [3.0], "neurons": 2000, "validation": "RV"},
    },
    "midplane_planes": lambda: {**FLOW, "event": EVENT, "threshold": THRESHOLD},
    "vorticity_isosurfaces": lambda: {**FLOW, "event": EVENT},
    "midplane_mean_square": lambda: {**FLOW, **LONG_TERM},
    "profile_errors": lambda: {
        **LONG_TERM,
        **{name: FLOW[name] for name in ("system", "parameters")},
        "percentiles": statistics_rows(),
        "points": 21,
    },
    "long_term_density": lambda: {
        **LONG_TERM,
        "percentiles": statistics_rows(),
        "threshold": THRESHOLD,
        **NAMED,
    },
    "own_flow": own_flow,
    "control_schematic": lambda: {
        **{"event": SUPPRESSED, "threshold": THRESHOLD, "symbol": "k", "force": None},
        **{"prediction_time_lt": 2.0, "window_lt": 1.0, "parameters": {"reynolds": 2000.0}},
    },
    "suppressed_event": lambda: {**FLOW, "event": SUPPRESSED, "threshold": THRESHOLD},
    "control_density": lambda: {
        "densities": [density_rows()],
        "panels": [
            {"case": f"Re{re}", "event_threshold": 0.1, "neurons": 2000, "validation": "RV"}
            for re in (400, 600, 800, 1000)
        ],
        "prediction_times_lt": [1.0, 2.0],
        **NAMED,
    },
    "control_tradeoff": lambda: {
        **control_tables(),
        "networks": {"neurons": 2000.0, "validation": "RV"},
        "symbol": "k",
    },
    "control_frontier": lambda: {
        **{"scores": frontier_rows(), "network": {"forecaster": "esn", **SIZE}, "symbol": "k"},
        **USUAL,
    },
    "skill_by_parameter": lambda: {
        **parameter_rows(),
        **{"parameter": PARAMETER, "prediction_times_lt": [2, 3], "neurons": 500},
    },
    "lost_skill": lambda: {"tables": [ranking_rows()]},
    "burst_forecast": lambda: {
        **plane_event(),
        **{"symbol": "D", "observable_name": "dissipation", "threshold": 0.2},
        "source": {name: PLANE_FLOW[name] for name in ("system", "parameters")},
        "forecaster": "equations_filtered",
    },
    "burst_vorticity": lambda: {
        **{**SERIES, **PLANE_FLOW, **plane_states()},
        **{"given_exponent": 0.1, "symbol": "D", "observable_name": "dissipation"},
    },
    "encoder_loss": lambda: {**PLANE_FLOW, "states": plane_states()["states"], "symbol": "D"},
}


def drawn(name: str, **changes: Any) -> Figure:
    """Draw a figure from its arguments, some of them replaced."""
    figure: Figure = figure_of(name)(**{**ARGUMENTS[name](), **changes})
    return figure


GALLERY: dict[str, Callable[[], Figure]] = {
    **{name: lambda name=name: drawn(name) for name in ARGUMENTS},  # type: ignore[misc]
    "nothing_to_show": lambda: nothing_to_show("No event was predicted from any start."),
}
