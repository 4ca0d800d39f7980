"""Look for signs that the results of a case are less than they seem."""

from collections.abc import Iterator, Mapping
from typing import Any

import pandas as pd

from burstcast.files.netcdf import read_netcdf, read_rows
from burstcast.statistics import warning_signs
from burstcast.statistics.warning_signs import Finding
from burstcast_workflow.harness.job import job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_json
from burstcast_workflow.harness.tables import read_table
from burstcast_workflow.jobs.gather import case_keys
from burstcast_workflow.jobs.statistics import read_statistics
from burstcast_workflow.jobs.tables import write_tables

ENSEMBLE = ["forecaster", "neurons", "validation"]
ADVICE = {
    "optimum_on_edge": "search beyond it: its entry in the section search",
    "few_events": "lower event_threshold, or raise ensemble.series or ensemble.duration",
    "few_positives": "raise test_series (and ensemble.series); read F with its interval "
    "in classification_intervals.csv",
    "lost_long_runs": "try other seeds, more neurons or more noise (training.noise); read the "
    "statistics beside survival.csv",
    "ill_conditioned_readout": "leave out the smallest values of search.tikhonov",
    "exponents_differ": "raise lyapunov.series, check lyapunov.saturation and perturbation; set "
    "lyapunov.time_unit to computed where the published exponent is of something else",
    "own_exponents_differ": "if the statistics of these forecasters are those of the data "
    "(statistics.csv), count in their Lyapunov time: their exponent as lyapunov.published_exponent",
    "outside_bins": "widen density.range",
    "noise_drowns_components": "lower training.noise, or raise ensemble.sampling_stride",
}
"""Settings to change where a sign of `burstcast.statistics.warning_signs` was found."""


def _of_data(
    ensemble: str, data: str, events_summary: str, settings: Settings
) -> Iterator[Finding]:
    events, histogram = read_json(events_summary), read_statistics(data).histogram
    yield from warning_signs.few_events(
        events["usable_events"],
        settings["horizon.events"],
        settings["case.event_threshold"],
        events["largest_observable"],
    )
    yield from warning_signs.outside_bins(
        histogram.below, histogram.above, int(histogram.counts.sum())
    )
    states = read_rows(ensemble, "state", 0, settings["case.training.series"])
    yield from warning_signs.noise_drowns_components(states, settings["case.training.noise"])


def _of_numbers(dataset: str, classification: str) -> Iterator[Finding]:
    (row,) = read_table(dataset).to_dict("records")
    leading, growth = (
        _leading(dataset, name) for name in ("lyapunov_exponent", "lyapunov_exponent_by_growth")
    )
    # left out of tables where nobody has one
    published = row.get("lyapunov_exponent_paper")
    yield from warning_signs.exponents_differ(
        leading, growth, None if pd.isna(published) else published
    )
    # what follows the starting points is the same for all forecasters
    scores = read_table(classification).drop_duplicates("prediction_time_lt")
    yield from warning_signs.few_positives(
        scores["prediction_time_lt"].tolist(),
        (scores["true_positive"] + scores["false_negative"]).tolist(),
    )


def _leading(dataset: str, name: str) -> tuple[float, float, float]:
    """Leading Lyapunov exponent of the case with the ends of its interval, by its column."""
    (row,) = read_table(dataset).to_dict("records")
    return row[name], row[f"{name}_low"], row[f"{name}_high"]


def _ensembles(table: pd.DataFrame) -> Iterator[tuple[Mapping[str, Any], pd.DataFrame]]:
    for keys, rows in table.groupby(ENSEMBLE, dropna=False, sort=False):
        yield dict(zip(ENSEMBLE, keys, strict=True)), rows


def _of_search(rows: pd.DataFrame, settings: Settings, samples: int) -> Iterator[Finding]:
    ranges = {
        "spectral_radius": settings["search.spectral_radius"],
        "input_scaling": settings["search.input_scaling"],
        "tikhonov": settings["search.tikhonov"],
    }
    # smaller Tikhonov parameters than this give the same readouts
    least = warning_signs.negligible_ridge(int(rows["neurons"].iloc[0]), samples)
    for name, searched in ranges.items():
        lost = least if name == "tikhonov" else 0.0
        yield from warning_signs.optimum_on_edge(
            name, rows[name].tolist(), min(searched), max(searched), lost
        )
    yield from warning_signs.ill_conditioned_readout(rows["solver"].tolist())


def _of_long_runs(rows: pd.DataFrame) -> Iterator[Finding]:
    shares = rows.dropna(subset=["discarded_fraction"])
    if len(shares):  # the training set and the sampling floor have no runs
        yield from warning_signs.lost_long_runs(
            shares["discarded_fraction"].tolist(), shares["diverged_fraction"].tolist()
        )


@job
def warnings_table(
    *,
    ensemble: str,
    data: str,
    events_summary: str,
    dataset: str,
    classification: str,
    hyperparameters: str | list[str],
    statistics: str | list[str],
    lyapunov_spectrum: str | list[str],
    tables: list[str],
    settings: Settings,
) -> None:
    """Write a row for each sign; of networks, one for those of a size and strategy."""
    of_case = [*_of_data(ensemble, data, events_summary, settings)]
    of_case += _of_numbers(dataset, classification)
    found: list[tuple[Mapping[str, Any], Finding]] = [({}, finding) for finding in of_case]
    if isinstance(hyperparameters, str):
        samples = settings["case.training.series"] * len(read_netcdf(ensemble, "time")["time"])
        for keys, members in _ensembles(read_table(hyperparameters)):
            found += [(keys, finding) for finding in _of_search(members, settings, samples)]
    if isinstance(statistics, str):
        for keys, members in _ensembles(read_table(statistics)):
            found += [(keys, finding) for finding in _of_long_runs(members)]
    if isinstance(lyapunov_spectrum, str):  # where the unit of time is an estimate
        leading = _leading(dataset, "lyapunov_exponent")
        for keys, members in _ensembles(read_table(lyapunov_spectrum)):
            own = members.loc[members["number"] == 1, "lyapunov_exponent"].tolist()
            found += [(keys, one) for one in warning_signs.own_exponents_differ(leading, own)]
    rows = [
        {
            **case_keys(settings),
            **dict.fromkeys(ENSEMBLE),
            **keys,
            "warning": finding.warning,
            "finding": finding.text,
            "advice": ADVICE[finding.warning],
        }
        for keys, finding in found
    ]
    write_tables(tables, settings, warnings=rows)
