"""Tables of the page on the turbulent flow: what is best follows from the rows."""

import pandas as pd

from burstcast_report import ranking_tables
from burstcast_report.results_tables import Tables


def run(forecaster, left, acting, **keys):
    """Rows of one run of control."""
    same = {"case": "turbulence", "forecaster": forecaster, "strategy": "reactive", **keys}
    same |= {"neurons": None, "validation": None, "noise": 0.01, "strength": 1, "delay_lt": 0}
    values = {"relative_exceedance": left, "control_fraction": acting}
    return [
        {**same, "metric": metric, "value": value, "low": 0.5 * value, "high": 2 * value}
        for metric, value in values.items()
    ]


def write_cases(directory):
    """Two flows, and what sensors see of each."""
    means = {"turbulence": 0.12, "sensors": 0.12, "viscous": 0.1, "viscous_sensors": 0.1}
    cases = [
        {"case": case, "series_kept": 9, "mean_observable": mean} for case, mean in means.items()
    ]
    pd.DataFrame(cases).to_csv(directory / "dataset.csv", index=False)


def test_only_cases_with_the_same_series_are_ranked_beside_each_other(tmp_path):
    write_cases(tmp_path)
    same = {"forecaster": "equations_filtered", "event": "onset", "metric": "average_precision"}
    same |= {"neurons": None, "validation": None, "seed": None, "prediction_time_lt": 1.0}
    rows = [
        {**same, "case": case, "alarm": "equations_filtered", "value": value, "low": 0.1, "high": 1}
        for case, value in (("sensors", 0.7), ("viscous_sensors", 0.8))
    ]
    pd.DataFrame(rows).to_csv(tmp_path / "ranking.csv", index=False)
    for source, shown, left_out in (
        ("turbulence", "`sensors` |", "viscous"),
        ("viscous", "`viscous_sensors` |", "`sensors`"),
    ):
        table = ranking_tables.average_precision(Tables(tmp_path), "onset", source)
        assert shown in table
        assert left_out not in table


def test_the_least_that_control_leaves_at_a_tenth_of_the_time(tmp_path):
    rows = [
        *run("equations", 0.005, 0.04, observed=None),
        *run("equations", 0.3, 0.04, observed=None, case="viscous"),
        *run("precursor", 0.02, 0.2, observed="sensors"),
        *run("equations_filtered", 0.1, 0.05, observed="sensors"),
        *run("none", 0.2, 0.05, observed="sensors"),
    ]
    pd.DataFrame(rows).to_csv(tmp_path / "control_choices.csv", index=False)
    ranks = [
        {
            "case": "sensors",
            "alarm": "equations_filtered",
            "forecaster": "equations_filtered",
            "event": "onset",
            "metric": "average_precision",
            **{"neurons": None, "validation": None, "seed": None, "value": 0.5},
            **{"low": 0.4, "high": 0.6, "prediction_time_lt": time},
        }
        for time in (0.5, 1.0, 2.0)
    ]
    ranks += [{**row, "alarm": "equations_noisy", "value": 0.52} for row in ranks]
    ranks += [{**row, "alarm": "esn_direct", "forecaster": "esn_direct"} for row in ranks[:3]]
    pd.DataFrame(ranks).to_csv(tmp_path / "ranking.csv", index=False)
    write_cases(tmp_path)
    found = ranking_tables.targets(Tables(tmp_path), "turbulence")
    by_truth, by_sensors = found.splitlines()[-2:]
    assert by_truth.endswith(
        "reactive, by equations, from the true state, in `turbulence` | reached |"
    )
    assert "0.5 (0.25 to 1) % at 4 (2 to 8) % of the time" in by_truth.replace("**", "")
    assert by_sensors.endswith(
        "reactive, observed sensors, by equations, filtered, in `turbulence` | not reached |"
    )
