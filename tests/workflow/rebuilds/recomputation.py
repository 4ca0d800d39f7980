"""Every table computed anew from the files of single networks, by name and by the plainest means.

Nothing here comes from the workflow's own gathering: files are found by their paths, counts and
scores are scikit-learn's, percentiles pandas'.
"""

import itertools
import json
import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import pandas as pd
from scipy.stats import chi2, t
from sklearn.metrics import confusion_matrix, precision_recall_fscore_support

from burstcast.base import random_streams
from burstcast_workflow.campaign.campaign import Campaign

KEYS = ["case", "reynolds", "forecaster", "neurons", "validation", "seed"]
_FORECASTER = re.compile(
    r"(?P<case>[^/]+)/(networks|models)/(?P<kind>[a-z_]+)"
    r"(-N(?P<neurons>\d+)-(?P<validation>[A-Z]+)-seed(?P<seed>\d+))?"
)
_AVERAGES = {"mean_horizon_lt": np.mean, "median_horizon_lt": np.median}
TABLES = (
    *("dataset", "hyperparameters", "classification", "classification_intervals"),
    *("horizon", "horizon_intervals", "horizon_differences", "statistics", "survival"),
    *("lyapunov_spectrum", "kaplan_yorke", "control"),
)
_SAMPLES = ("uncontrolled", "controlled")
_CONTROL = re.compile(r"prediction_triggered-prediction_time(?P<time>[\d.]+)-window[\d.]+")


def variables(path: Path) -> dict[str, Any]:
    """All variables of a NetCDF file."""
    with netCDF4.Dataset(path) as file:
        return {name: np.asarray(file[name][...]) for name in file.variables}


class Recomputation:
    """Tables of a finished campaign, computed anew.

    Parameters
    ----------
    results
        The campaign's results.
    config
        Its whole config.
    """

    def __init__(self, results: Path, config: dict) -> None:
        self.results, self.config = results, config
        campaign = Campaign(config)
        self.records = {name: campaign.cases[name].dump() for name in campaign.case_names}

    def keys(self, path: Path) -> dict[str, Any]:
        """Keys of the forecaster in whose directory a file lies."""
        name = _FORECASTER.fullmatch(str(path.parent.relative_to(self.results)))
        assert name, path
        neurons, seed = name["neurons"], name["seed"]
        return {
            "case": name["case"],
            "reynolds": self.records[name["case"]]["parameters"].get("reynolds"),
            "forecaster": name["kind"],
            "neurons": None if neurons is None else int(neurons),
            "validation": name["validation"],
            "seed": None if seed is None else int(seed),
        }

    def files(self, name: str) -> Iterator[tuple[dict[str, Any], Path]]:
        """Files of that name of all forecasters, with their keys."""
        for path in sorted(self.results.glob(f"*/[nm]*/*/{name}")):
            yield self.keys(path), path

    def drawn(self, count: int, *words: str) -> np.ndarray:
        """How often each of some things is in each bootstrap sample; without any, no samples."""
        settings = self.config["bootstrap"]
        generator = random_streams.stream(self.config["random_seed"], "bootstrap", *words)
        size, places = settings["resamples"] if count else 0, max(count, 1)
        return generator.multinomial(count, np.full(places, 1 / places), size=size)

    @property
    def ends(self) -> list[float]:
        """Quantiles at the ends of the confidence interval."""
        tail = (1 - self.config["bootstrap"]["confidence"]) / 2
        return [tail, 1 - tail]

    def interval(self, values: Any) -> dict[str, float]:
        low, high = np.quantile(values, self.ends) if len(values) else (np.nan, np.nan)
        return {"low": low, "high": high}

    def hyperparameters(self) -> pd.DataFrame:
        rows = []
        for keys, path in self.files("search.csv"):
            trace = pd.read_csv(path)
            rows.append({**keys, **trace.loc[trace["objective"].idxmin()].to_dict()})
        names = ["spectral_radius", "input_scaling", "tikhonov", "objective", "solver"]
        return pd.DataFrame(rows)[[*KEYS, *names]]

    def points(self) -> Iterator[tuple[dict[str, Any], np.ndarray, np.ndarray, np.ndarray]]:
        """Whether an event happens and is predicted at each scored point, and its series.

        With the keys of each forecast at each prediction time; then, for each case, of whoever
        raises an alarm always.
        """
        settings, files = self.config["classification"], [*self.files("forecast.nc")]
        always = {
            keys["case"]: (self.of_case(keys["case"], "permanent_alarm"), path)
            for keys, path in files
        }
        for keys, path in (*files, *always.values()):
            threshold = self.records[keys["case"]]["event_threshold"]
            truth = variables(self.results / keys["case"] / "evaluation_set.nc")
            scored, forecast = truth["washout_maximum"] < threshold, variables(path)
            for time in settings["prediction_times_lt"]:
                first = round(time / settings["resolution_lt"]) - 1
                last = first + round(settings["window_lt"] / settings["resolution_lt"])
                happened, predicted = (
                    (data["first"][:, first] < threshold)
                    & (data["largest"][:, first:last].max(axis=1) >= threshold)
                    for data in (truth, forecast)
                )
                predicted = predicted | (keys["forecaster"] == "permanent_alarm")
                of_time = {**keys, "prediction_time_lt": time}
                series = np.append(truth["series"][scored], truth["series"].max())
                yield of_time, happened[scored], predicted[scored], series

    def classification(self) -> pd.DataFrame:
        rows = []
        for keys, happened, predicted, _ in self.points():
            counts = confusion_matrix(happened, predicted, labels=[False, True]).ravel()
            names = ("true_negative", "false_positive", "false_negative", "true_positive")
            counted = dict(zip(names, counts.tolist(), strict=True))
            rows.append({**keys, **counted, **_scores(happened, predicted, None)})
        return pd.DataFrame(rows)

    def classification_intervals(self) -> pd.DataFrame:
        """Scores with every point weighted by how often a resample holds its series."""
        rows = []
        for keys, happened, predicted, (*series, last) in self.points():
            weights = self.drawn(last + 1, keys["case"], _text(keys["prediction_time_lt"]))
            resamples = pd.DataFrame(
                [_scores(happened, predicted, weight[series]) for weight in weights]
            )
            for metric in resamples:
                interval = self.interval(resamples[metric].dropna())
                rows.append({**keys, "metric": metric, **interval})
        return pd.DataFrame(rows)

    def horizons(self) -> Iterator[tuple[dict[str, Any], str, np.ndarray, np.ndarray]]:
        """Horizons of each forecaster, with its keys and name, and weights of resampled events."""
        for keys, path in self.files("horizon.nc"):
            values = variables(path)["prediction_horizon_lt"]
            events = variables(self.results / keys["case"] / "events.nc")
            assert len(values) == len(events["step"])
            yield keys, path.parent.name, values, self.drawn(len(values), keys["case"], "events")

    def horizon(self) -> pd.DataFrame:
        rows = []
        for keys, _, values, _ in self.horizons():
            averages = pd.Series(values, dtype=float).agg(["mean", "median"]).tolist()
            rows.append(
                {**keys, "events": len(values), **dict(zip(_AVERAGES, averages, strict=True))}
            )
        return pd.DataFrame(rows)

    def horizon_intervals(self) -> pd.DataFrame:
        """Averages of what each bootstrap sample of the events holds."""
        return pd.DataFrame(
            {
                **{**keys, "metric": metric},
                **self.interval([average(np.repeat(values, weight)) for weight in weights]),
            }
            for keys, _, values, weights in self.horizons()
            for metric, average in _AVERAGES.items()
        )

    def horizon_differences(self) -> pd.DataFrame:
        """Differences of averages of the same events, of networks the median over the seeds."""
        kinds: dict[tuple, list[tuple]] = {}
        for keys, *horizons in self.horizons():
            kind = tuple(keys[name] for name in ("case", "forecaster", "neurons", "validation"))
            kinds.setdefault(kind, []).append(horizons)
        rows = []
        for (kind, one), (other_kind, other) in itertools.combinations(kinds.items(), 2):
            for metric, average in _AVERAGES.items() if kind[0] == other_kind[0] else ():
                difference = _medians(one, average) - _medians(other, average)
                row = {"case": kind[0], "compared": _shared_name(one), "other": _shared_name(other)}
                interval = self.interval(difference[1:])
                rows.append({**row, "metric": metric, "value": difference[0], **interval})
        return pd.DataFrame(rows)

    def dataset(self) -> pd.DataFrame:
        rows = []
        for case, record in self.records.items():
            ensemble = variables(self.results / case / "ensemble.nc")
            energy = 0.5 * (ensemble["state"] ** 2).sum(axis=2)
            above = energy >= record["event_threshold"]
            lyapunov = json.loads((self.results / case / "lyapunov.json").read_text())
            exponents, growth = lyapunov["leading"], lyapunov["leading_by_growth"]
            published = record["lyapunov"]["given_exponent"]
            interval = record["ensemble"]["time_step"] * record["ensemble"]["sampling_stride"]
            series = record["ensemble"]["series"]
            rows.append(
                {
                    "case": case,
                    "reynolds": record["parameters"].get("reynolds"),
                    "series_generated": series,
                    "series_kept": len(energy),
                    "laminarised_fraction": 1 - len(energy) / series,
                    "mean_observable": energy.mean(),
                    "events_per_series": (~above[:, :-1] & above[:, 1:]).sum() / len(energy),
                    "event_share": above.mean(),
                    "training_event_share": above[: record["training"]["series"]].mean(),
                    "lyapunov_exponent": exponents["mean"],
                    "lyapunov_exponent_low": exponents["low"],
                    "lyapunov_exponent_high": exponents["high"],
                    "lyapunov_exponent_by_growth": growth["mean"],
                    "lyapunov_exponent_by_growth_low": growth["low"],
                    "lyapunov_exponent_by_growth_high": growth["high"],
                    "lyapunov_exponent_given": published,
                    "steps_per_lyapunov_time": int(
                        1 / ((published or exponents["mean"]) * interval)
                    ),
                }
            )
        return pd.DataFrame(rows)

    def of_case(self, case: str, forecaster: str = "data") -> dict[str, Any]:
        """Keys of the rows of a case that are of none of its forecasters."""
        reynolds = self.records[case]["parameters"].get("reynolds")
        return dict.fromkeys(KEYS) | {"case": case, "reynolds": reynolds, "forecaster": forecaster}

    def statistics(self) -> pd.DataFrame:
        """Kantorovich metric, logarithmic error and discarded share; profiles are tested apart."""
        rows = []
        for keys, path in self.files("long_term.nc"):
            true = variables(self.results / keys["case"] / "statistics_data.nc")
            run = variables(path)
            fates = run["fate"]
            names = ("laminarised", "fixed_point", "diverged")
            shares = {f"{name}_fraction": (fates == n).mean() for n, name in enumerate(names, 1)}
            shares["discarded_fraction"] = (fates != 0).mean()
            rows.append({**keys, **shares, **_distances(true, run)})
        for case in self.records:
            true, training, floor = (
                variables(self.results / case / f"statistics_{name}.nc")
                for name in ("data", "training", "floor")
            )
            rows.append({**self.of_case(case, "training"), **_distances(true, training)})
            for split in range(self.config["statistics"]["floor_splits"]):
                values = {name: floor[name][split] for name in ("kantorovich", "mean_log_error")}
                rows.append({**self.of_case(case, "floor"), "seed": split, **values})
        return pd.DataFrame(rows)

    def survival(self) -> pd.DataFrame:
        """Escapes counted run by run after the first quarter, with exact tails of counts."""
        lifetimes = []
        for case in self.records:
            keys, ensemble = self.of_case(case), variables(self.results / case / "ensemble.nc")
            kept = set(ensemble["series"].tolist())
            ends = [number not in kept for number in range(len(ensemble["lifetime"]))]
            length = len(ensemble["time"]) - 1
            lifetimes.append((keys, case, ensemble["lifetime"], ends, length))
        for keys, path in self.files("long_term.nc"):
            runs, ensemble = variables(path), self.records[keys["case"]]["ensemble"]
            interval = ensemble["time_step"] * ensemble["sampling_stride"]
            length = round(self.config["statistics"]["duration"] / interval)
            lifetimes.append((keys, keys["case"], runs["lifetime"], runs["fate"] != 0, length))
        rows = []
        for keys, case, steps, ends, length in lifetimes:
            ensemble, start = self.records[case]["ensemble"], length // 4
            interval = ensemble["time_step"] * ensemble["sampling_stride"]
            risk = interval * sum(max(0, int(step) - start) for step in steps)
            escapes = sum(end and step > start for step, end in zip(steps, ends, strict=True))
            low, high = chi2.ppf(self.ends, [2 * escapes, 2 * escapes + 2]) / 2
            rows.append(
                {
                    **keys,
                    "series": len(steps),
                    "survived_fraction": 1 - np.mean(ends),
                    "escapes": escapes,
                    "time_at_risk": risk,
                    "escape_rate": escapes / risk if risk else np.nan,
                    "escape_rate_low": np.nan_to_num(low) / risk if risk else np.nan,
                    "escape_rate_high": high / risk if risk else np.nan,
                }
            )
        return pd.DataFrame(rows)

    def spectra(self) -> Iterator[tuple[dict[str, Any], np.ndarray]]:
        """Exponents of each run, of the data and of the forecasters."""
        for case in self.records:
            yield (
                self.of_case(case),
                variables(self.results / case / "lyapunov_spectrum.nc")["exponents"],
            )
        for keys, path in self.files("lyapunov_spectrum.nc"):
            yield keys, variables(path)["exponents"]

    def lyapunov_spectrum(self) -> pd.DataFrame:
        rows = []
        for keys, exponents in self.spectra():
            for number, values in enumerate(exponents.T, 1):
                interval = (np.nan, np.nan)
                if len(values) > 1:
                    interval = t.interval(
                        self.config["bootstrap"]["confidence"],
                        len(values) - 1,
                        values.mean(),
                        values.std(ddof=1) / math.sqrt(len(values)),
                    )
                rows.append(
                    {
                        **keys,
                        "number": number,
                        "lyapunov_exponent": values.mean() if len(values) else np.nan,
                        "lyapunov_exponent_low": interval[0],
                        "lyapunov_exponent_high": interval[1],
                    }
                )
        return pd.DataFrame(rows)

    def kaplan_yorke(self) -> pd.DataFrame:
        """Number of the exponents where the interpolated sum of the leading ones is zero."""
        rows = []
        for keys, exponents in self.spectra():
            dimension = np.nan
            if len(exponents):
                sums = np.cumsum([0, *sorted(exponents.mean(axis=0))[::-1]])
                peak = int(sums.argmax())
                if sums[-1] < 0:
                    falling = -sums[peak:]
                    dimension = peak + float(np.interp(0, falling, range(len(falling))))
            rows.append({**keys, "runs": len(exponents), "kaplan_yorke_dimension": dimension})
        return pd.DataFrame(rows)

    def control(self) -> pd.DataFrame:
        """Shares of time recomputed from the counts of each run."""
        rows = []
        for path in sorted(self.results.glob("*/control/*/*/flows.nc")):
            name = _CONTROL.fullmatch(path.parent.name)
            if not name:  # beyond the paper's control
                continue
            case, _, controller = path.relative_to(self.results).parts[:3]
            forecaster = controller.removesuffix("-random")
            keys = self.keys(self.results / case / "models" / forecaster / path.name)
            if controller.endswith("-random"):
                keys["forecaster"] = "random"
            flows = variables(path)
            bins = self.records[keys["case"]]["controlled_density"]["bins"]
            assert len(flows["edge"]) == bins + 1
            calm = np.maximum(*(flows[f"laminar_step_{run}"] for run in _SAMPLES)) < 0
            with netCDF4.Dataset(path) as file:
                steps = calm.sum() * file.steps
            without, with_it = (flows[f"exceeding_{run}"][calm].sum() / steps for run in _SAMPLES)
            counted = ("alarms", "false_alarms", "missed_events", "unsuppressed_events")
            rows.append(
                {
                    **keys,
                    "prediction_time_lt": float(name["time"]),
                    "exceedance_uncontrolled": without,
                    "exceedance_controlled": with_it,
                    "reduction": 1 - with_it / without if without else np.nan,
                    **{name: flows[name][calm].sum() for name in counted},
                }
            )
        return pd.DataFrame(rows)


def _medians(members: list[tuple], average: Any) -> np.ndarray:
    """Medians over members of averages of their horizons: of all events, of each resample."""
    _, values, weights = members[0]
    if not len(values):
        return np.full(1, np.nan)
    samples = [np.ones(len(values), int), *weights]
    return np.array(
        [np.median([average(np.repeat(each[1], sample)) for each in members]) for sample in samples]
    )


def _shared_name(members: list[tuple]) -> str:
    name = str(members[0][0])
    return f"median of {name.rpartition('-seed')[0]}" if len(members) > 1 else name


def percentiles(table: pd.DataFrame, metrics: list[str], extra: list[str]) -> pd.DataFrame:
    """Quartiles over seeds, in long form."""
    keys = [*KEYS[:-1], *extra]
    long = table.melt(keys, metrics, "metric")
    grouped = long.groupby([*keys, "metric"], dropna=False)["value"]
    quantiles = grouped.quantile([0.25, 0.5, 0.75]).unstack().reset_index()
    quantiles.columns = [*keys, "metric", "p25", "p50", "p75"]
    return quantiles.merge(grouped.count().rename("networks").reset_index(), on=[*keys, "metric"])


def assert_same_rows(computed: pd.DataFrame, expected: pd.DataFrame) -> None:
    """The same rows, in any order, in the columns that the expected table has."""
    names = list(expected.columns)
    tables = []
    for table in (computed[names], expected):
        rows = [[_cell(cell) for cell in row] for row in table.itertuples(index=False)]
        others = ("compared", "other", "prediction_time_lt", "metric", "number")
        count = sum(name in (*KEYS, *others) for name in names)
        tables.append(sorted(rows, key=lambda row: [str(cell) for cell in row[:count]]))
    assert len(tables[0]) == len(tables[1])
    for row, other in zip(*tables, strict=True):
        for name, cell, wanted in zip(names, row, other, strict=True):
            same = cell == wanted
            if isinstance(cell, float) and isinstance(wanted, float):
                # the Kantorovich metric is integrated by quadrature here
                tolerance = 1e-4 if name == "kantorovich" else 1e-11
                same = math.isclose(cell, wanted, rel_tol=tolerance, abs_tol=1e-14)
            assert same, f"{name} is {cell}, and {wanted} here, in {row}"


def _cell(cell: Any) -> Any:
    """Numbers as floats, what is missing as None."""
    if pd.isna(cell):
        return None
    return float(cell) if isinstance(cell, int | float | np.number) else str(cell)


def _scores(
    happened: np.ndarray, predicted: np.ndarray, weights: np.ndarray | None
) -> dict[str, float]:
    # a resample without any scored point has no score
    if weights is not None and weights.sum() == 0:
        return dict.fromkeys(("precision", "recall", "f_score"), np.nan)
    scores = precision_recall_fscore_support(
        happened, predicted, average="binary", sample_weight=weights, zero_division=np.nan
    )
    names = ("precision", "recall", "f_score")
    return {name: float(score) for name, score in zip(names, scores[:3], strict=True)}


def _distances(true: dict[str, Any], other: dict[str, Any]) -> dict[str, float]:
    """Both distances of two histograms, the first by quadrature on a fine grid."""
    edges, width = true["edge"], np.diff(true["edge"])
    counts = [data["count"].astype(float) for data in (true, other)]
    if not all(count.sum() for count in counts):
        return {"kantorovich": np.nan, "mean_log_error": np.nan}
    shares = [count / count.sum() for count in counts]
    fine = np.linspace(edges[0], edges[-1], 200 * len(width) + 1)
    curves = [np.interp(fine, edges, np.append(0, share.cumsum())) for share in shares]
    density = [np.ma.masked_equal(share / width, 0) for share in shares]
    errors = np.abs(np.ma.log10(density[0]) - np.ma.log10(density[1])).filled(1.0)
    return {
        "kantorovich": float(np.trapezoid(np.abs(curves[0] - curves[1]), fine)),
        "mean_log_error": float(errors.mean()),
    }


def _text(time: float) -> str:
    """A prediction time as it names its random stream: whole numbers without a point."""
    return str(int(time)) if float(time).is_integer() else str(time)
