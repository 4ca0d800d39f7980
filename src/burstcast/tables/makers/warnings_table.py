"""Look for signs that the results of a case are less than they seem."""

from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.declared import at, declaring, read
from burstcast.base.files.netcdf import read_netcdf, read_rows, variable_names
from burstcast.base.names import PERMANENT_ALARM
from burstcast.base.series_lengths import samples_of
from burstcast.data.ensemble_files import START
from burstcast.networks.negligible_ridge import negligible_ridge
from burstcast.statistics import warning_signs as signs
from burstcast.statistics.reductions import LongTermStatistics
from burstcast.systems.base import DynamicalSystem, has_own
from burstcast.systems.registry import make_space
from burstcast.systems.state_space import StateSpace, component_names
from burstcast.tables.makers.registry import Rows

if TYPE_CHECKING:
    import pandas as pd

Finding = tuple[str, str]
"""Name of a sign of `burstcast.statistics.warning_signs`, and what was found, in words."""
ENSEMBLE = ["forecaster", "neurons", "validation"]
ADVICE = {
    "optimum_on_edge": "search beyond it: its entry in the section search",
    "few_events": "lower event_threshold, or raise ensemble.series or ensemble.duration",
    "few_positives": "raise test_series (and ensemble.series); read F with its interval "
    "in classification_intervals.csv",
    "nothing_to_calibrate_with": "raise training.series, ensemble.duration or event_threshold, or "
    "shorten washout_lt; calibrated probabilities and their scores are empty until then",
    "lost_long_runs": "more noise (training.noise); read the statistics beside survival.csv",
    "ill_conditioned_readout": "leave out the smallest values of search.tikhonov",
    "exponents_differ": "raise lyapunov.series, check lyapunov.saturation and perturbation; set "
    "lyapunov.time_unit to computed where the given exponent is of something else",
    "own_exponents_differ": "if these forecasters reproduce the statistics of the data "
    "(statistics.csv), count in their Lyapunov time: their exponent as lyapunov.given_exponent",
    "no_exponent": "read no_estimate in lyapunov.json; longer series, or more components of the "
    "state; check lyapunov.given_exponent by other means",
    "no_chaos_learnt": "longer series, or another sampling of them; their exponent is no unit of "
    "time",
    "outside_bins": "widen density.range",
    "no_better_than_permanent_alarm": "longer series, shorter prediction times, or rarer events "
    "(event_threshold)",
    "invalid_forecasts": "sample more finely (ensemble.sampling_stride), learn from longer "
    "series, or take another kind; an invalid forecast predicts no event",
    "fallback_decisions": "another forecaster, or a strategy without forecasts; "
    "its scores are in part those of the fallback",
    "escaped_flows": "a weaker actuation, or a shorter ensemble.time_step; scores are of the other "
    "flows alone",
    "unresolved_flow": "raise parameters.largest_wavenumber, or lower the Reynolds number",
    "slow_trend": "train on later series, or remove the trend from the file; a cycle longer than "
    "the record looks like a trend, too",
    "noise_drowns_components": "lower training.noise, or raise ensemble.sampling_stride",
}
"""Settings to change where a sign of `burstcast.statistics.warning_signs` was found."""
OF_NETWORKS = {
    "lost_long_runs": "other seeds, more neurons, ",
    "no_chaos_learnt": "more neurons, ",
    "no_better_than_permanent_alarm": "more neurons, ",
}
"""Further advice where the forecaster is a network."""


@declaring
def make(
    *,
    ensemble: str = read("case/ensemble.nc:path"),
    data: Mapping[str, Any] = read("case/statistics_data.nc"),
    calibration_set: Mapping[str, Any] = read("case/calibration_set.nc", "washout_maximum"),
    events_summary: Mapping[str, Any] = read("case/events.json"),
    dataset: "pd.DataFrame" = read("case/tables/dataset.csv"),
    classification: "pd.DataFrame" = read("case/tables/classification.csv"),
    hyperparameters: "pd.DataFrame | None" = read("case/tables/hyperparameters.csv"),
    statistics: "pd.DataFrame | None" = read("case/tables/statistics.csv"),
    control: "pd.DataFrame | None" = read("controlled_case/tables/control_strategies.csv"),
    lyapunov_spectrum: "pd.DataFrame | None" = read(
        "contradicted_case/tables/lyapunov_spectrum.csv"
    ),
    event_threshold: float = read("case/event_threshold.json:event_threshold"),
    training_series: int = at("case.training.series"),
    noise: float = at("case.training.noise"),
    wanted_events: int = at("horizon.events"),
    system: str = at("case.system"),
    parameters: Mapping[str, Any] = at("case.parameters"),
    spectral_radius: list[float] = at("search.spectral_radius"),
    input_scaling: list[float] = at("search.input_scaling"),
    tikhonov: list[float] = at("search.tikhonov"),
) -> dict[str, Rows]:
    """A row for each sign; networks of a size and strategy share a row."""
    import pandas as pd  # planning reads what is declared alone

    states = read_rows(ensemble, "state", 0, training_series)
    searched = {
        "spectral_radius": spectral_radius,
        "input_scaling": input_scaling,
        "tikhonov": tikhonov,
    }
    samples, space = len(samples_of(states)), make_space(system, parameters)
    histogram = LongTermStatistics.from_arrays(data).histogram
    of_case = [
        *_findings(
            signs.few_events,
            events_summary["usable_events"],
            wanted_events,
            event_threshold,
            events_summary["largest_observable"],
        ),
        *_findings(
            signs.nothing_to_calibrate_with, calibration_set["washout_maximum"], event_threshold
        ),
        *_findings(
            signs.outside_bins, histogram.below, histogram.above, int(histogram.counts.sum())
        ),
        *_findings(signs.noise_drowns_components, states, noise),
        *_of_truncation(space, states),
        *_of_trend(ensemble, space, training_series),
        *_of_numbers(dataset, classification),
    ]
    findings: list[tuple[Mapping[str, Any], Finding]] = [({}, finding) for finding in of_case]
    findings += _of_scores(classification)
    for keys, members in _ensembles(hyperparameters):
        findings += [(keys, finding) for finding in _of_search(members, searched, samples)]
    for keys, members in _ensembles(statistics):
        findings += [(keys, finding) for finding in _of_long_runs(members)]
    for keys, members in _ensembles(control):
        for sign, metric in (
            (signs.fallback_decisions, "fallback_fraction"),
            (signs.escaped_flows, "escaped_fraction"),
        ):
            shares = members.loc[members["metric"] == metric, "value"].dropna().tolist()
            findings += [(keys, finding) for finding in _findings(sign, shares)]
    # where the unit of time is an estimate
    for keys, members in _ensembles(lyapunov_spectrum):
        exponents = members.loc[members["number"] == 1, "lyapunov_exponent"].tolist()
        leading = _leading(dataset, "lyapunov_exponent")
        contradictions = [
            *_findings(signs.own_exponents_differ, leading, exponents),
            *_findings(signs.no_chaos_learnt, leading[0], exponents),
        ]
        findings += [(keys, finding) for finding in contradictions]
    rows = []
    for keys, (warning, text) in findings:
        is_network = pd.notna(keys.get("neurons"))
        advice = (OF_NETWORKS.get(warning, "") if is_network else "") + ADVICE[warning]
        words = {"warning": warning, "finding": text, "advice": advice}
        rows.append({**dict.fromkeys(ENSEMBLE), **keys, **words})
    return {"warnings": rows}


def _findings(sign: Callable[..., Iterator[str]], *arguments: Any) -> list[Finding]:
    """Findings of a test for a sign."""
    return [(sign.__name__, text) for text in sign(*arguments)]


def _of_truncation(space: StateSpace, states: FloatArray) -> list[Finding]:
    if not (isinstance(space, DynamicalSystem) and has_own(space, "energy_of_last_shell")):
        return []
    energy = space.energy_of_last_shell(np.moveaxis(states, -1, 0))
    return _findings(signs.unresolved_flow, energy)


def _of_trend(ensemble: str, space: StateSpace, training: int) -> list[Finding]:
    """Warn of a trend in a record whose series have times."""
    if START not in variable_names(ensemble):
        return []
    data = read_netcdf(ensemble, START, "state")
    names = component_names(space)
    return _findings(signs.slow_trend, data[START], data["state"], names, training)


def _of_numbers(dataset: "pd.DataFrame", classification: "pd.DataFrame") -> Iterator[Finding]:
    import pandas as pd

    # left out of tables without any value
    (row,) = dataset.to_dict("records")
    given = row.get("lyapunov_exponent_given")
    yield from _findings(signs.no_exponent, _leading(dataset, "lyapunov_exponent")[0])
    yield from _findings(
        signs.exponents_differ,
        _leading(dataset, "lyapunov_exponent"),
        _leading(dataset, "lyapunov_exponent_by_growth"),
        None if pd.isna(given) else given,
    )
    # what follows the starting points is the same for all forecasters
    scores = classification.drop_duplicates("prediction_time_lt")
    yield from _findings(
        signs.few_positives,
        scores["prediction_time_lt"].tolist(),
        (scores["true_positive"] + scores["false_negative"]).tolist(),
    )


def _of_scores(table: "pd.DataFrame") -> Iterator[tuple[Mapping[str, Any], Finding]]:
    """Ensembles that are no better than a permanent alarm, or whose forecasts are invalid."""
    is_permanent = table["forecaster"] == PERMANENT_ALARM
    permanent = table[is_permanent].set_index("prediction_time_lt")["f_score"]
    for keys, rows in _ensembles(table[~is_permanent]):
        medians = rows.groupby("prediction_time_lt")["f_score"].median()
        times = medians.index.tolist()
        scores = times, medians.tolist(), permanent.loc[times].tolist()
        for finding in _findings(signs.no_better_than_permanent_alarm, *scores):
            yield keys, finding
        # left out of tables without any value
        if "invalid_fraction" in rows:
            invalid = rows.groupby("prediction_time_lt")["invalid_fraction"].mean().tolist()
            for finding in _findings(signs.invalid_forecasts, times, invalid):
                yield keys, finding


def _leading(dataset: "pd.DataFrame", name: str) -> tuple[float, float, float]:
    """Leading Lyapunov exponent of the case with the ends of its interval, by its column."""
    (row,) = dataset.to_dict("records")
    return row[name], row[f"{name}_low"], row[f"{name}_high"]


def _ensembles(table: "pd.DataFrame | None") -> Iterator[tuple[Mapping[str, Any], "pd.DataFrame"]]:
    if table is not None:
        for keys, rows in table.groupby(ENSEMBLE, dropna=False, sort=False):
            yield dict(zip(ENSEMBLE, keys, strict=True)), rows


def _of_search(
    rows: "pd.DataFrame", searched: Mapping[str, list[float]], samples: int
) -> Iterator[Finding]:
    # smaller Tikhonov parameters than this give the same readouts
    least = negligible_ridge(int(rows["neurons"].iloc[0]), samples)
    for name, values in searched.items():
        lost = least if name == "tikhonov" else 0.0
        box = min(values), max(values), lost
        yield from _findings(signs.optimum_on_edge, name, rows[name].tolist(), *box)
    yield from _findings(signs.ill_conditioned_readout, rows["solver"].tolist())


def _of_long_runs(rows: "pd.DataFrame") -> Iterator[Finding]:
    shares = rows.dropna(subset=["discarded_fraction"])
    if len(shares):  # the training set and the sampling floor have no runs
        lost, diverged = (shares[f"{name}_fraction"].tolist() for name in ("discarded", "diverged"))
        yield from _findings(signs.lost_long_runs, lost, diverged)
