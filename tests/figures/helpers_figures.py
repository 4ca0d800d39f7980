"""Inputs that resemble a campaign's, the figures drawn from them, and what a reader sees."""

from dataclasses import dataclass
from itertools import combinations, product
from unittest import mock

import numpy as np
import pandas as pd
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from burstcast.figures.parts.style import nothing_to_show
from burstcast.figures.registry import figure_of
from burstcast.statistics.densities import bin_edges, histogram
from kolmogorov_flow import KolmogorovFlow

THRESHOLD = 0.1
NUMBER_KEYS = {"case": "Re400", "reynolds": 400.0}


def burst(time_lt, peak_at, height=0.2):
    """A quiet signal with one slow rise and quick collapse."""
    rise = np.exp(-np.square((time_lt - peak_at) / np.where(time_lt < peak_at, 1.5, 0.4)))
    return 0.03 + 0.01 * np.sin(3 * time_lt) + height * rise


def percentile_rows(
    metrics,
    sizes=(500.0, 1000.0, 1500.0),
    validations=("SSV", "RV"),
    prediction_times=(np.nan,),
    **keys,
):
    """A percentile table; medians fall with the prediction time and grow with the size."""
    rows = product(sizes, validations, prediction_times, metrics)
    names = ["neurons", "validation", "prediction_time_lt", "metric"]
    table = pd.DataFrame(rows, columns=names).assign(**NUMBER_KEYS, forecaster="esn", networks=10)
    size = 1 - 100 / table["neurons"] - 0.05 * (table["validation"] == "SSV")
    time = 1 - 0.12 * table["prediction_time_lt"].fillna(0.0)
    median = table["metric"].map(metrics) * size * time
    return table.assign(p25=0.95 * median, p50=median, p75=1.04 * median, **keys)


@dataclass(frozen=True)
class DrawnText:
    """Words on a page, where they are and how big."""

    words: str
    frame: Bbox
    size: float


def drawn_texts(figure):
    """Texts that a reader sees: those that are drawn, so no tick labels out of range."""
    drawn = []
    draw = Text.draw

    def record(text, renderer):
        if text.get_visible() and text.get_text().strip():
            # The words alone: an annotation's own extent includes its arrow and its point.
            frame = Text.get_window_extent(text, renderer)
            drawn.append(DrawnText(text.get_text(), frame, float(text.get_fontsize())))
        draw(text, renderer)

    with mock.patch.object(Text, "draw", record):
        figure.draw_without_rendering()  # but with the layout
    return drawn


def overlapping_texts(texts):
    """Pairs of texts that lie on each other by more than a hair."""
    pairs = []
    for first, second in combinations(texts, 2):
        frame, other = first.frame, second.frame
        width = min(frame.x1, other.x1) - max(frame.x0, other.x0)
        height = min(frame.y1, other.y1) - max(frame.y0, other.y0)
        if width > 1.5 and height > 1.5:
            pairs.append((first.words, second.words))
    return pairs


def as_published(rows, kind):
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


def intervals_of(rows):
    """Intervals of two networks around the medians of percentile rows."""
    ends = rows.assign(low=0.9 * rows["p50"], high=1.02 * rows["p50"])
    ends = ends.drop(columns=["p25", "p50", "p75", "networks"])
    return pd.concat([ends.assign(seed=0), ends.assign(seed=1)])


def published_scores():
    """Arguments of the figure of published scores: plain networks, and networks with squares."""
    plain = percentile_rows(SCORES, prediction_times=PREDICTION_TIMES)
    squares = plain[plain["neurons"] == 500].assign(forecaster="esn_quadratic", p50=0.99)
    horizons = percentile_rows({"mean_horizon_lt": 4.5})
    scores = pd.concat([plain, squares])
    theirs = [as_published(plain, "classification"), as_published(horizons, "horizon")]
    return {
        **{"scores": scores, "score_intervals": intervals_of(scores)},
        **{"horizons": horizons, "horizon_intervals": intervals_of(horizons)},
        **{"validation": "RV", "published": pd.concat(theirs).assign(p50=0.5)},
    }


# -- arguments of every figure, and the figures drawn from them ------------------------------------

TIME = np.linspace(0.0, 8.0, 401)
SERIES = {
    "observable": burst(TIME, 4.0)[np.newaxis],
    "threshold": THRESHOLD,
    "symbol": "k",
    "unit": 50,  # samples in a Lyapunov time
}
NAMED = {"symbol": "k", "observable_name": "kinetic energy"}
FLOW = {
    "system": "mfe",
    "parameters": {"reynolds": 400.0, "length_x": 4 * np.pi, "length_z": 2 * np.pi},
    "flow_points": [17, 9, 13],
}
PLANE_FLOW = {
    "system": "kolmogorov_flow:KolmogorovFlow",
    "parameters": {"largest_wavenumber": 3, "forcing_wavenumber": 2},
    "training_series": 1,
}
SCORES = {"precision": 0.97, "recall": 1.0, "f_score": 0.98}
PREDICTION_TIMES = (1.0, 2.0, 3.0)
STATES = np.random.default_rng(5).normal(0.0, 0.1, (4, 9)) + np.eye(9)[0]
MARKS = np.array([50, 125, 200, 275])
EXAMPLES = {
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
EVENT = {
    "time_lt": TIME,
    "true": burst(TIME, 4.0),
    "forecast": burst(TIME, 4.1),
    "mark": MARKS,
    "true_state": STATES,
    "forecast_state": 1.02 * STATES,
}
SUPPRESSED = {
    "time_lt": TIME - 1.0,
    "uncontrolled": burst(TIME - 1.0, 5.0),
    "controlled": 0.3 * burst(TIME - 1.0, 5.0),
    "forecast": np.where((TIME >= 1) & (TIME <= 5), 0.9 * burst(TIME - 1.0, 5.0), np.nan),
    "actuation_lt": np.array([1.0, 2.5]),
    "mark": MARKS,
    "uncontrolled_state": STATES,
    "controlled_state": 0.3 * STATES,
}


def long_term_file(scale, **more):
    """Content of a file of long-term statistics."""
    counts = histogram(scale * burst(TIME, 4.0), bin_edges(0.0, 0.3, 30))
    moments = scale * (np.outer(STATES[0], STATES[0]) + 0.1 * np.eye(9))
    return {
        **{"edge": counts.edges, "count": counts.counts, "below": 0, "above": 0},
        **{"states": 401, "mean": scale * STATES[0], "mean_product": moments, **more},
    }


LONG_TERM = {
    "data": long_term_file(1.0),
    "training": long_term_file(0.8),
    "long_term": [
        long_term_file(0.9, neurons=1000, seed=0),
        long_term_file(0.5, neurons=1000, seed=1),
    ],
}


def search_rows():
    """A search whose objective is least near (0.3, 2), with two Tikhonov parameters a point."""
    points = [("grid", *point) for point in product((0.1, 0.3, 1.0), (0.1, 1.0, 10.0))]
    points += [("bayesian", 0.3, 2.0), ("bayesian", 0.5, 3.0)]
    table = pd.DataFrame(points, columns=["source", "spectral_radius", "input_scaling"])
    table = table.merge(pd.DataFrame({"tikhonov": [1e-6, 1e-9], "worse": [0.5, 0.0]}), "cross")
    radius, scaling = table["spectral_radius"] / 0.3, table["input_scaling"] / 2.0
    distance = np.log10(radius) ** 2 + np.log10(scaling) ** 2
    return table.assign(objective=distance - 4.0 + table["worse"])


def growing_errors():
    """Forecasts whose errors grow by e in a Lyapunov time, from less for larger networks."""
    generator = np.random.default_rng(1)
    truth, signs = generator.normal(0.0, 1.0, (200, 8)), generator.choice([-1.0, 1.0], (200, 8))
    growth = signs * np.exp(0.5 * np.arange(1, 9))
    forecasts = [{"forecaster": "esn-N500-SSV-seed0", "first": truth}]
    for size, seed in product((500, 1000, 1500, 2000, 4000), range(3)):
        first = truth + (1.0 + 0.1 * seed) * 10 / size * growth
        forecasts.append({"forecaster": f"esn-N{size}-RV-seed{seed}", "first": first})
    return {
        **{"truth": truth, "forecasts": forecasts, "summary": {"mean_observable": 0.0}},
        **{"threshold": 1.0, "tolerance": 0.2, "resolution_lt": 0.5, "validation": "RV"},
    }


def ranking_rows():
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


def around(value, below=0.03, above=0.02):
    """A value and the ends of its interval."""
    return value, value - below, value + above


def statistics_rows():
    """Errors of networks, of the training set, and the floor of sampling."""
    metrics = {"nrmse_u": 0.02, "nrmse_uu": 0.06, "nrmse_uv": 0.005}
    metrics |= {"kantorovich": 0.006, "mean_log_error": 0.15}
    networks = percentile_rows(metrics, validations=("RV",))
    alone = percentile_rows(metrics, (np.inf,), ("RV",), **NO_SIZE)
    references = [
        alone.assign(forecaster=name, **{end: factor * alone[end] for end in ("p25", "p50", "p75")})
        for name, factor in (("training", 2.0), ("floor", 0.2))
    ]
    return pd.concat([networks, *references], ignore_index=True)


def of_data(name, values, width, **keys):
    """Rows of the data with the ends of their intervals."""
    ends = {f"{name}_low": values - width, f"{name}_high": values + width}
    return pd.DataFrame({"forecaster": "data", **keys, name: values, **ends})


def own_flow(rate=1e-4, spectrum=True):
    """Tables of survival and of spectra."""
    time = np.linspace(0, 4000, 21)
    share = np.exp(-rate * time)
    curves = pd.concat(
        percentile_rows({"survival": factor * value}, forecaster=name, time=now)
        for name, factor in (("esn", 1.0), ("equations", 0.98))
        for now, value in zip(time, share, strict=True)
    )
    ends = {"survival_low": 0.97 * share, "survival_high": np.minimum(1, 1.03 * share)}
    flow = np.array([0.0155, 0.0045, 0.0, -0.006, -0.013, -0.02, -0.031, -0.036, -0.041])
    exponents = pd.concat(
        percentile_rows({"lyapunov_exponent": value}, validations=("RV",), number=number)
        for number, value in enumerate([*flow, -0.27], 1)
    )
    exponents[["p25", "p75"]] = np.sort(exponents[["p25", "p75"]], axis=1)
    dimension = "kaplan_yorke_dimension"
    tables = {
        "exponents": of_data("lyapunov_exponent", flow, 0.0005, number=np.arange(1, 10)),
        "exponent_percentiles": exponents,
        "dimensions": of_data(dimension, np.array([5.1]), 0.05),
        "dimension_percentiles": percentile_rows({dimension: 5.5}, validations=("RV",)),
    }
    return {
        "curves": pd.DataFrame({"forecaster": "data", "time": time, "survival": share, **ends}),
        "curve_percentiles": curves,
        "rates": of_data("escape_rate", np.array([rate]), 0.1 * rate),
        "rate_percentiles": percentile_rows({"escape_rate": 1.5 * rate}),
        **{name: [table] if spectrum else None for name, table in tables.items()},
        "neurons": 1000,
    }


def control_tables():
    """Percentiles of the paper's control, and costs and gains of its runs over flows."""
    shares = {"esn": 0.9, "equations": 0.8, "random": 0.3}
    percentiles = pd.concat(
        percentile_rows(
            {"reduction": share, "control_fraction": 0.2 + 0.05 * number}
            | ({"exceedance_uncontrolled": 0.1} if name == "esn" else {}),
            *((2000.0,), ("RV",), PREDICTION_TIMES),
            forecaster=name,
        )
        for number, (name, share) in enumerate(shares.items())
    )
    papers = {"strategy": "prediction_triggered", "starts": "quiet"}
    papers |= {"delay_lt": 0.0, "quiet_lt": 0.0, "strength": 1.0}
    strategies = percentiles[percentiles["metric"] != "exceedance_uncontrolled"]
    left = strategies["metric"] == "reduction"
    strategies = strategies.assign(
        **papers,
        metric=strategies["metric"].replace("reduction", "relative_exceedance"),
        low=strategies["p25"].where(~left, 1 - strategies["p75"]),
        high=strategies["p75"].where(~left, 1 - strategies["p25"]),
    )
    return {"percentiles": percentiles, "strategies": strategies}


def density_rows():
    """Densities with and without control at four Reynolds numbers and two prediction times."""
    edges = np.linspace(0.015, 0.47, 41)
    without, rows = 40 * np.exp(-25 * edges[:-1]), []
    for reynolds, (time, factor) in product((400, 600, 800, 1000), ((1.0, 0.5), (2.0, 0.7))):
        keys = {"case": f"Re{reynolds}", "reynolds": float(reynolds), "forecaster": "esn", **SIZE}
        table = {**keys, "prediction_time_lt": time, "low": edges[:-1], "high": edges[1:]}
        for name, share in (("uncontrolled", 1.0), ("controlled", factor)):
            for end, of_end in (("", 1.0), ("_low", 0.9), ("_high", 1.1)):
                table[f"density_{name}{end}"] = of_end * share * without
        rows.append(pd.DataFrame(table))
    return pd.concat(rows, ignore_index=True)


USUAL = {"span_lt": 20.0, "noise": 0.01}
SIZE = {"neurons": 2000.0, "validation": "RV"}
NO_SIZE = {"neurons": np.nan, "validation": np.nan}


PARAMETER = {
    "name": "reynolds",
    "values": {"Re400": 400.0, "Re500": 500.0, "Re600": 600.0, "Re800": 800.0},
    "trained": [400.0, 600.0, 1000.0],
    "kinds": ["esn_aware", "quadratic_aware_filtered"],
}


def parameter_rows():
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


def frontier_rows():
    """Scores of control: the more a strategy acts, the less is left; nothing in one run."""
    rows = []
    settings = ("horizon_lt", "decision_interval_lt", "prediction_time_lt", "level", "vote_share")
    conditions = {"starts": "quiet", **USUAL, "quiet_lt": 3.0, "delay_lt": 0.0, "strength": 1.0}
    usual = {**dict.fromkeys(settings, np.nan), **conditions}

    def run(forecaster, strategy, left, acting, **changes):
        size = SIZE if forecaster.startswith("esn") else NO_SIZE
        keys = {"case": "Re400", "forecaster": forecaster, "strategy": strategy, **size}
        for metric, value in (("relative_exceedance", left), ("control_fraction", acting)):
            score = {"value": value, "low": 0.5 * value, "high": 1.5 * value if value else np.nan}
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


def return_rows():
    """Return times of long runs: each level is ten times as rare as the one 0.1 below it."""
    rows = []
    usual = {"delay_lt": 0.0, "strength": 1.0, "noise": 0.01, "quiet_lt": 20.0}

    def run(strategy, forecaster, base, time=1e5, **changes):
        for level in (0.1, 0.2, 0.3):
            return_time = base * 10 ** (10 * level - 1)
            events = int(time / return_time)
            ends = (0.8, 1.2) if events else (np.nan, np.nan)
            times = {
                "return_time": return_time if events else np.nan,
                "return_time_low": 0.8 * return_time if events else time / 3,
                "return_time_high": ends[1] * return_time,
            }
            keys = {"strategy": strategy, "forecaster": forecaster, **NO_SIZE, **usual, **changes}
            rows.append({**keys, "return_level": level, "events": events, **times})

    run("uncontrolled", "none", 20.0)
    for horizon in (1.0, 3.0):
        run("receding_horizon", "equations_noisy", 1e3 * horizon**2, horizon_lt=horizon)
    run("reactive", "none", 3e3, level=0.06)
    run("receding_horizon", "equations_noisy", 100.0, horizon_lt=3.0, delay_lt=1.0)
    return pd.DataFrame(rows)


def reynolds_rows(metric, times=(np.nan,)):
    return pd.concat(
        percentile_rows(
            *({metric: 0.9 - re / 5000}, (2000.0,), ("SSV", "RV"), times),
            **{"case": f"Re{re}", "reynolds": float(re)},
        )
        for re in (400, 600, 800, 1000)
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


def alarm_rows(x, positions, **keys):
    """Scores that fall with x, of three networks, their committee and everybody else."""
    rows = []
    for kind, good in ALARMS.items():
        seeds = range(3) if kind == "esn" else (np.nan,)
        size = SIZE if kind.startswith("esn") else NO_SIZE
        for seed, position in product(seeds, positions):
            value = good * (1.0 - 0.1 * (1.0 - good + 0.1 * np.nan_to_num(seed)) * position)
            whose = {"case": "Re400", "forecaster": kind, **size, "seed": seed}
            scores = dict(zip(ENDS, around(value), strict=True))
            rows.append({**whose, "probability": "calibrated", x: position, **scores, **keys})
    return pd.DataFrame(rows)


def score_rows(*metrics, x="prediction_time_lt"):
    return pd.concat([alarm_rows(x, (1.0, 2.0, 3.0, 4.0), metric=metric) for metric in metrics])


def reliability_rows():
    """Committees tell many probabilities, who forecasts once tells two, climatology one."""
    rows = []
    for (kind, good), probability in product(ALARMS.items(), ("calibrated", "votes")):
        levels = {"esn_committee": 11, "esn": 0, "climatology": 1}.get(kind, 2)
        used = np.isin(np.arange(11), np.linspace(0, 10, levels).astype(int))
        mean = np.where(used, np.linspace(0, 1, 11), np.nan)
        size = SIZE if kind == "esn_committee" else NO_SIZE
        keys = {"case": "Re400", "forecaster": kind, "probability": probability, **size}
        table = {"bin": np.arange(11), "forecasts": used * np.array([7000, *[40] * 10])}
        table |= {"mean_probability": mean, "consistency_low": np.maximum(0, mean - 0.1)}
        table |= {"consistency_high": np.minimum(1, mean + 0.1)}
        table["observed_frequency"] = mean * (good if probability == "votes" else 0.95)
        rows.append(pd.DataFrame({**keys, "prediction_time_lt": 3.0, **table}))
    return pd.concat(rows, ignore_index=True)


def plane_states():
    """Two series of a plane flow whose modes decay at rates of their own, but for one burst."""
    flow = KolmogorovFlow(**PLANE_FLOW["parameters"])
    generator = np.random.default_rng(3)
    waves = np.sin(np.arange(120) * generator.uniform(0.2, 0.9, (flow.dimension, 1)))
    size = 1.0 / np.arange(1, flow.dimension + 1)
    states = np.stack([waves.T * size, 0.7 * waves.T * size])
    states[1, 60] *= 4.0
    observable = flow.observable(states.reshape(-1, flow.dimension).T).reshape(2, -1)
    return {"states": states, "observable": observable}


def plane_event():
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


ARGUMENTS = {
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
    "published_scores": published_scores,
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
        "horizons": [reynolds_rows("mean_horizon_lt")],
        "scores": [reynolds_rows("f_score", PREDICTION_TIMES)],
        **{"neurons": 2000, "prediction_times_lt": [2.0, 3.0]},
    },
    "forecast_skill": lambda: {
        "scores": score_rows("alarm_f_score", "brier_skill"),
        **{"neurons": 2000, "validation": "RV"},
    },
    "reliability": lambda: {
        "bins": reliability_rows(),
        **{"prediction_times_lt": [3.0], "neurons": 2000, "validation": "RV"},
    },
    "precision_recall": lambda: {
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
            {"case": f"Re{re}", "neurons": 2000, "validation": "RV"} for re in (400, 600, 800, 1000)
        ],
        "thresholds": [0.1] * 4,
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
    "return_levels": lambda: {"times": return_rows(), "symbol": "k"},
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
        **{"unit": 10, "symbol": "D", "observable_name": "dissipation"},
    },
    "encoder_loss": lambda: {**PLANE_FLOW, "states": plane_states()["states"], "symbol": "D"},
}


def drawn(name, **changes):
    """Draw a figure from its arguments, some of them replaced."""
    return figure_of(name)(**{**ARGUMENTS[name](), **changes})


GALLERY = {
    **{name: lambda name=name: drawn(name) for name in ARGUMENTS},
    "nothing_to_show": lambda: nothing_to_show("No event was predicted from any start."),
}
