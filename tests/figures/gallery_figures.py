"""Every figure, drawn from small inputs."""

from collections.abc import Callable

import numpy as np
import pandas as pd
from helpers_figures import THRESHOLD, burst, interval_rows, percentile_rows
from matplotlib.figure import Figure

from burstcast.figures.burst_forecast import burst_forecast
from burstcast.figures.burst_vorticity import burst_vorticity
from burstcast.figures.by_reynolds import by_reynolds
from burstcast.figures.classification_scores import classification_scores
from burstcast.figures.control_conditions import control_conditions
from burstcast.figures.control_density import ControlledDensity, control_density
from burstcast.figures.control_frontier import control_frontier
from burstcast.figures.control_schematic import control_schematic
from burstcast.figures.control_tradeoff import control_tradeoff
from burstcast.figures.encoder_loss import encoder_loss
from burstcast.figures.forecast_skill import draw as forecast_skill
from burstcast.figures.horizon_by_size import horizon_by_size
from burstcast.figures.horizon_evaluations import HorizonEvaluation, horizon_evaluations
from burstcast.figures.horizon_schematic import draw as horizon_schematic
from burstcast.figures.long_term_density import long_term_density
from burstcast.figures.lost_skill import lost_skill
from burstcast.figures.lyapunov_spectrum import draw as lyapunov_spectrum
from burstcast.figures.midplane_mean_square import midplane_mean_square
from burstcast.figures.midplane_planes import midplane_planes
from burstcast.figures.network_schematic import draw as network_schematic
from burstcast.figures.observable_and_density import observable_and_density
from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast.figures.prediction_examples import PredictionExample, prediction_examples
from burstcast.figures.prediction_schematic import prediction_schematic
from burstcast.figures.profile_errors import profile_errors
from burstcast.figures.reliability import draw as reliability
from burstcast.figures.skill_by_parameter import skill_by_parameter
from burstcast.figures.suppressed_event import suppressed_event
from burstcast.figures.survival import draw as survival
from burstcast.figures.validation_strategies import ValidationLayout, validation_strategies
from burstcast.figures.vorticity_isosurfaces import FlowSnapshot, vorticity_isosurfaces

TIME = np.linspace(0.0, 8.0, 401)
EDGES = np.linspace(0.015, 0.47, 41)
DENSITY = 40 * np.exp(-25 * EDGES[:-1])
X, Y, Z = np.linspace(0, 4 * np.pi, 17), np.linspace(-1, 1, 9), np.linspace(0, 2 * np.pi, 13)
PLANES = np.array([np.outer(np.cos(0.5 * X + phase), np.sin(Z)) for phase in range(4)])
TIMES = np.array([1.0, 2.5, 4.0, 5.5])
SCORES = {"precision": 0.97, "recall": 1.0, "f_score": 0.98}
PREDICTION_TIMES = (1.0, 2.0, 3.0)


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
    for number, (case, alarm, kind, neurons, seed) in enumerate(sources):
        names = {"case": case, "alarm": alarm, "forecaster": kind, "neurons": neurons, "seed": seed}
        for time in (0.5, 1.0, 2.0):
            for event, more in (("onset", 0.0), ("any", 0.05)):
                value = 0.9 * np.exp(-0.3 * time - 0.2 * number) + more
                keys = {**names, "prediction_time_lt": time, "event": event}
                ends = {"low": value - 0.03, "high": value + 0.04}
                rows.append({**keys, "metric": "average_precision", "value": value, **ends})
                rows.append({**keys, "metric": "base_rate", "value": 0.05})
    return pd.DataFrame(rows)


def plane_burst() -> Figure:
    """A vortex that turns faster until the peak."""
    x, y = np.meshgrid(*[np.linspace(0, 2 * np.pi, 33)] * 2, indexing="ij")
    times = [-2.0, -1.0, 0.0, 1.0]
    fields = np.stack([np.exp(-abs(time)) * np.sin(x) * np.sin(2 * y + time) for time in times])
    time = np.linspace(-4, 4, 81)
    observable = 0.1 + 0.2 * np.exp(-(time**2))
    return burst_vorticity(
        time, observable, times, fields, (2 * np.pi, 2 * np.pi), 0.2, "Dissipation, $D$"
    )


def plane_forecast() -> Figure:
    """A vortex whose forecast turns too slowly."""
    x, y = np.meshgrid(*[np.linspace(0, 2 * np.pi, 33)] * 2, indexing="ij")
    times = [0.2, 0.6, 1.0, 1.4]
    fields = {
        name: np.stack([rate * time * np.sin(x) * np.sin(2 * y) for time in times])
        for name, rate in (("true", 2.0), ("forecast", 1.5))
    }
    time = np.linspace(-1, 3, 81)
    observable = {
        name: 0.1 + 0.2 * np.exp(-((time - 1) ** 2)) * field.max() for name, field in fields.items()
    }
    return burst_forecast(
        *(time, observable, times, fields, (2 * np.pi, 2 * np.pi), 0.2),
        *("Dissipation, $D$", "forecast: network"),
    )


def plane_modes() -> Figure:
    """Modes that hold energy before they hold the observable."""
    x, y = np.meshgrid(*[np.linspace(0, 2 * np.pi, 33)] * 2, indexing="ij")
    numbers = np.array([1, 2, 4, 8, 16, 32])
    kept = {
        "variance": 1 - 0.5 / numbers,
        "mean": 1 - 0.8 / np.sqrt(numbers),
        "correlation": np.array([-0.2, -0.8, -0.6, 0.5, 0.9, 1.0]),
    }
    modes = {1: np.sin(x), 3: np.sin(4 * y), 5: np.sin(2 * x) * np.cos(y)}
    return encoder_loss(numbers, kept, modes, (2 * np.pi, 2 * np.pi), "D")


def _evaluations() -> Figure:
    time = np.linspace(-9, 2, 221)
    evaluations = []
    for start in (7.5, 7.0, 6.5, 6.0):
        own = time[time >= -start]
        error = 0.02 * np.exp(0.8 * own) * (start - 6.0)
        horizon = start if start == 6.0 else start - 1.0
        evaluations.append(HorizonEvaluation(start, own, burst(own, 0.6) + error, horizon))
    return horizon_evaluations(time, burst(time, 0.6), evaluations, THRESHOLD, 0.008)


def _examples() -> Figure:
    return prediction_examples(
        [
            PredictionExample(name, TIME, burst(TIME, peak), burst(TIME, other))
            for name, peak, other in (
                ("true positive", 3.5, 3.5),
                ("false positive", 6.0, 3.5),
                ("false negative", 3.5, 6.0),
            )
        ],
        THRESHOLD,
        2.0,
    )


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


def survival_figure(rate: float = 1e-4) -> Figure:
    time = np.linspace(0, 4000, 101)
    share = np.exp(-rate * time)
    curves = pd.concat(
        percentile_rows({"survival": value}, forecaster=name, time=now)
        for name, factor in (("esn", 1.0), ("equations", 0.98))
        for now, value in zip(time, factor * share, strict=True)
    )
    data = pd.DataFrame(
        {
            "forecaster": "data",
            "time": time,
            "survival": share,
            "survival_low": 0.97 * share,
            "survival_high": np.minimum(1, 1.03 * share),
        }
    )
    rates = {"forecaster": "data", "escape_rate": [rate], "escape_rate_low": [0.9 * rate]}
    return survival(
        data,
        curves,
        pd.DataFrame({**rates, "escape_rate_high": [1.1 * rate]}),
        percentile_rows({"escape_rate": 1.5 * rate}),
        1000,
    )


EXPONENTS = np.array([0.0155, 0.0045, 0.0, -0.006, -0.013, -0.02, -0.031, -0.036, -0.041])


def lyapunov_figure() -> Figure:
    exponents = pd.concat(
        percentile_rows({"lyapunov_exponent": value}, validations=("RV",), number=number)
        for number, value in enumerate([*EXPONENTS, -0.27], 1)
    )
    exponents[["p25", "p75"]] = np.sort(exponents[["p25", "p75"]], axis=1)
    data = {"forecaster": "data", "number": np.arange(1, 10), "lyapunov_exponent": EXPONENTS}
    ends = {f"lyapunov_exponent_{end}": EXPONENTS + 0.0005 * sign for end, sign in ENDS.items()}
    dimension = {f"kaplan_yorke_dimension{end}": [value] for end, value in DIMENSION.items()}
    return lyapunov_spectrum(
        pd.DataFrame({**data, **ends}),
        exponents,
        pd.DataFrame({"forecaster": "data", **dimension}),
        percentile_rows({"kaplan_yorke_dimension": 5.5}, validations=("RV",)),
        1000,
    )


ENDS = {"low": -1, "high": 1}
DIMENSION = {"": 5.1, "_low": 5.05, "_high": 5.15}


def control_rows() -> pd.DataFrame:
    return pd.concat(
        [
            percentile_rows(
                {"reduction": value, "control_fraction": 0.2 + 0.05 * index},
                sizes=(2000.0,),
                validations=("RV",),
                prediction_times=PREDICTION_TIMES,
                forecaster=name,
            )
            for index, (name, value) in enumerate(
                (("esn", 0.9), ("equations", 0.8), ("random", 0.3))
            )
        ]
    )


USUAL = {"span_lt": 20.0, "noise": 0.01}


PARAMETER = {
    "name": "reynolds",
    "values": {"Re400": 400.0, "Re500": 500.0, "Re600": 600.0, "Re800": 800.0},
    "trained": [400.0, 600.0, 1000.0],
    "kinds": ["esn_aware", "quadratic_aware_filtered"],
}


def parameter_rows() -> tuple[pd.DataFrame, pd.DataFrame, pd.DataFrame]:
    """Scores, their intervals and escape rates of three kinds at four Reynolds numbers."""
    scores, intervals, survival = [], [], []
    for case, value in PARAMETER["values"].items():
        survival.append(_escape(case, "data", 2e-5 * (1000 / value)))
        for kind, best in (("esn", 0.7), ("esn_aware", 0.72), ("quadratic_aware_filtered", 0.9)):
            survival.append(_escape(case, kind, 2.2e-5 * (1000 / value)))
            for time in (1.0, 2.0, 3.0):
                keys = {"case": case, "forecaster": kind, "prediction_time_lt": time}
                f_score = best - 0.1 * (time - 1) - 1e-4 * (value - 400)
                scores.append({**keys, "f_score": f_score})
                ends = {"low": f_score - 0.05, "high": f_score + 0.04}
                intervals.append({**keys, "metric": "f_score", **ends})
    return pd.DataFrame(scores), pd.DataFrame(intervals), pd.DataFrame(survival)


def _escape(case: str, kind: str, rate: float) -> dict[str, object]:
    ends = {"escape_rate_low": 0.7 * rate, "escape_rate_high": 1.4 * rate}
    return {"case": case, "forecaster": kind, "escape_rate": rate, **ends}


def frontier_rows() -> pd.DataFrame:
    """Scores of control: the more a strategy acts, the less is left; nothing in one run."""
    rows = []

    def run(
        forecaster: str,
        strategy: str,
        left: float,
        acting: float,
        conditions: dict[str, float] | None = None,
        **settings: float,
    ) -> None:
        keys = {"horizon_lt": np.nan, "decision_interval_lt": np.nan, "prediction_time_lt": np.nan}
        usual = {**USUAL, "quiet_lt": 3.0, "delay_lt": 0.0, "strength": 1.0}
        for metric, value in (("relative_exceedance", left), ("control_fraction", acting)):
            rows.append(
                {
                    **{"case": "Re400", "forecaster": forecaster, "strategy": strategy},
                    **keys,
                    **{"level": np.nan, "vote_share": np.nan, **settings},
                    **{"starts": "quiet", **usual},
                    **(conditions or {}),
                    **{"metric": metric, "value": value},
                    **{"low": 0.5 * value, "high": 1.5 * value if value else 0.005},
                }
            )

    for forecaster, factor in (("esn", 2.0), ("equations", 1.0)):
        for horizon, left, acting in ((1.0, 2e-2, 0.1), (2.0, 1e-3, 0.05), (3.0, 0.0, 0.03)):
            for interval in (0.1, 0.25):
                run(
                    *(forecaster, "receding_horizon", factor * left, acting * (1 + interval)),
                    horizon_lt=horizon,
                    decision_interval_lt=interval,
                )
        for conditions in (
            *({"delay_lt": delay} for delay in (0.25, 1.0)),
            *({"strength": strength} for strength in (0.25, 0.5)),
            *({"noise": noise} for noise in (0.03, 0.1)),
        ):
            run(
                *(forecaster, "receding_horizon", 2e-2 * factor, 0.06, conditions),
                horizon_lt=2.0,
                decision_interval_lt=0.25,
            )
        run(forecaster, "prediction_triggered", 0.2, 0.09, prediction_time_lt=1.0)
    for horizon, left, acting in ((2.0, 5e-4, 0.045), (3.0, 0.0, 0.025)):
        run(
            *("esn_committee", "receding_horizon", left, acting),
            horizon_lt=horizon,
            decision_interval_lt=0.25,
            vote_share=0.5,
        )
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
        network = kind in ("esn", "esn_committee")
        for seed in range(3 if kind == "esn" else 1):
            for position in positions:
                value = good * (1.0 - 0.1 * (1.0 - good + 0.1 * seed) * position)
                rows.append(
                    {
                        "case": "Re400",
                        "forecaster": kind,
                        "neurons": 2000.0 if network else np.nan,
                        "validation": "RV" if network else np.nan,
                        "seed": seed if kind == "esn" else np.nan,
                        "probability": "calibrated",
                        x: position,
                        "value": value,
                        "low": value - 0.03,
                        "high": value + 0.02,
                        **keys,
                    }
                )
    return pd.DataFrame(rows)


def score_rows(*metrics: str, x: str = "prediction_time_lt") -> pd.DataFrame:
    return pd.concat([alarm_rows(x, (1.0, 2.0, 3.0, 4.0), metric=metric) for metric in metrics])


def reliability_rows() -> pd.DataFrame:
    """Committees tell many probabilities, who forecasts once tells two, climatology one."""
    rows = []
    for kind, good in ALARMS.items():
        levels = {"esn_committee": 11, "esn": 0, "climatology": 1}.get(kind, 2)
        network = kind == "esn_committee"
        for probability in ("calibrated", "votes"):
            for number, mean in enumerate(np.linspace(0, 1, 11)):
                told = number in np.linspace(0, 10, levels).astype(int)
                frequency = mean * (good if probability == "votes" else 0.95)
                rows.append(
                    {
                        "case": "Re400",
                        "forecaster": kind,
                        "neurons": 2000.0 if network else np.nan,
                        "validation": "RV" if network else np.nan,
                        "probability": probability,
                        "prediction_time_lt": 3.0,
                        "bin": number,
                        "forecasts": (7000 if number == 0 else 40) if told else 0,
                        "mean_probability": mean if told else np.nan,
                        "observed_frequency": frequency if told else np.nan,
                        "consistency_low": max(0.0, mean - 0.1) if told else np.nan,
                        "consistency_high": min(1.0, mean + 0.1) if told else np.nan,
                    }
                )
    return pd.DataFrame(rows)


def _vorticity() -> Figure:
    grid = np.meshgrid(X, Y, Z, indexing="ij")
    wave = np.cos(grid[0] / 2) * np.sin(grid[2]) * (1 - grid[1] ** 2)
    velocity = np.stack([grid[1], 0.2 * wave, 0.1 * wave])
    snapshots = [FlowSnapshot("before", velocity, wave), FlowSnapshot("after", velocity, -wave)]
    return vorticity_isosurfaces(X, Y, Z, snapshots, 0.4)


def _profiles() -> Figure:
    true = np.stack([np.sin(Y), Y**2, -1 + Y**2])
    rows = statistics_rows()
    return profile_errors(Y, true, 0.9 * true, 1.02 * true, rows, interval_rows(rows))


GALLERY: dict[str, Callable[[], Figure]] = {
    "observable_and_density": lambda: observable_and_density(
        TIME, burst(TIME, 4.0), EDGES, DENSITY, THRESHOLD
    ),
    "validation_strategies": lambda: validation_strategies(
        TIME,
        burst(TIME, 4.0),
        [
            ValidationLayout(
                "SSV", "Single Shot Validation", (0, 0.5), (0.5, 6.0), np.array([[6.0, 8.0]])
            ),
            ValidationLayout(
                "RV", "Recycle Validation", (0, 0.5), (0.5, 8.0), np.array([[0.5, 2.5], [2.5, 4.5]])
            ),
        ],
        THRESHOLD,
    ),
    "prediction_examples": _examples,
    "classification_scores": lambda: classification_scores(
        percentile_rows(SCORES, prediction_times=PREDICTION_TIMES), 1000, 3
    ),
    "horizon_evaluations": _evaluations,
    "horizon_by_size": lambda: horizon_by_size(
        percentile_rows({"mean_horizon_lt": 4.5}),
        interval_rows(percentile_rows({"mean_horizon_lt": 4.5})),
    ),
    "forecast_skill": lambda: forecast_skill(score_rows("f_score", "brier_skill"), 2000, "RV"),
    "reliability": lambda: reliability(reliability_rows(), [3.0], 2000, "RV"),
    "by_reynolds": lambda: by_reynolds(
        reynolds_rows("mean_horizon_lt", None),
        reynolds_rows("f_score", PREDICTION_TIMES),
        2000,
        [2.0, 3.0],
    ),
    "nothing_to_show": lambda: nothing_to_show("No event was predicted from any start."),
    "network_schematic": lambda: network_schematic(
        inputs=9,
        neurons=2000,
        connectivity=20,
        input_bias=0.1,
        hyperparameters={"spectral_radius": 0.29, "input_scaling": 0.33, "tikhonov": 1e-9},
    ),
    "prediction_schematic": lambda: prediction_schematic(
        TIME - 1.5,
        burst(TIME - 1.5, 3.0),
        np.where(TIME >= 1.5, burst(TIME - 1.5, 3.1), np.nan),
        THRESHOLD,
        2.0,
        washout_lt=0.5,
    ),
    "horizon_schematic": lambda: horizon_schematic(
        longest_lead_time_lt=10, lead_time_step_lt=0.5, tolerance=0.2, symbol="k"
    ),
    "midplane_planes": lambda: midplane_planes(
        TIME,
        burst(TIME, 4.0),
        burst(TIME, 4.1),
        TIMES,
        X,
        Z,
        PLANES,
        1.02 * PLANES,
        THRESHOLD,
    ),
    "midplane_mean_square": lambda: midplane_mean_square(
        X, Z, PLANES[0] ** 2, 1.1 * PLANES[0] ** 2, 1.4 * PLANES[0] ** 2
    ),
    "profile_errors": _profiles,
    "long_term_density": lambda: long_term_density(
        EDGES,
        DENSITY,
        0.8 * DENSITY,
        1.1 * DENSITY,
        statistics_rows(),
        interval_rows(statistics_rows()),
        THRESHOLD,
    ),
    "survival": survival_figure,
    "lyapunov_spectrum": lyapunov_figure,
    "vorticity_isosurfaces": _vorticity,
    "control_schematic": lambda: control_schematic(
        TIME - 1.0,
        burst(TIME, 5.0),
        0.3 * burst(TIME, 5.0),
        np.where((TIME >= 1) & (TIME <= 4), 0.9 * burst(TIME, 5.0), np.nan),
        THRESHOLD,
        2.0,
        (1.0, 2.5),
    ),
    "suppressed_event": lambda: suppressed_event(
        TIME,
        burst(TIME, 4.0),
        0.3 * burst(TIME, 4.0),
        (1.0, 2.5),
        TIMES,
        X,
        Z,
        PLANES,
        0.3 * PLANES,
        THRESHOLD,
    ),
    "control_density": lambda: control_density(
        [
            ControlledDensity(
                f"Re = {re}",
                EDGES,
                THRESHOLD,
                DENSITY,
                {1.0: 0.5 * DENSITY, 2.0: 0.7 * DENSITY},
                np.stack([0.9 * DENSITY, 1.1 * DENSITY]),
                {1.0: np.stack([0.4 * DENSITY, 0.6 * DENSITY])},
            )
            for re in (400, 600, 800, 1000)
        ],
    ),
    "control_tradeoff": lambda: control_tradeoff(control_rows()),
    "control_conditions": lambda: control_conditions(frontier_rows(), USUAL),
    "control_frontier": lambda: control_frontier(frontier_rows(), USUAL),
    "skill_by_parameter": lambda: skill_by_parameter(*parameter_rows(), PARAMETER, [2, 3]),
    "lost_skill": lambda: lost_skill(ranking_rows()),
    "burst_forecast": plane_forecast,
    "burst_vorticity": plane_burst,
    "encoder_loss": plane_modes,
}
