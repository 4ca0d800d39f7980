"""What a finished campaign says at the end of a run."""

import pandas as pd

from burstcast_workflow.campaign.summary import (
    MOST_ROWS,
    MOST_WARNINGS,
    campaign_summary,
    warnings_summary,
    where_results_lie,
)


def percentiles(metric, medians, **more):
    """Rows of a percentile table: by case, kind, neurons, validation."""
    names = ["case", "forecaster", "neurons", "validation"]
    rows = [
        {**dict(zip(names, key, strict=True)), **more, "metric": metric, "p50": median}
        for key, median in medians.items()
    ]
    return pd.DataFrame(rows)


ESN = ("Re400", "esn", 500, "RV")
EQUATIONS = ("Re400", "equations", None, None)


def test_each_forecaster_is_one_row_best_first(tmp_path):
    pd.concat(
        [
            percentiles("f_score", {ESN: 0.7, EQUATIONS: 1.0}, prediction_time_lt=time)
            for time in (0.5, 2.5)
        ]
    ).assign(p50=lambda table: table["p50"] - (table["prediction_time_lt"] < 1) * 0.2).to_csv(
        tmp_path / "classification_percentiles.csv", index=False
    )
    percentiles("mean_horizon_lt", {ESN: 3.25}).to_csv(
        tmp_path / "horizon_percentiles.csv", index=False
    )
    lines = campaign_summary(tmp_path).splitlines()
    assert "F-score 2.5 LT ahead" in lines[0]  # the nearest to 2 LT
    assert [line.split()[1] for line in lines[1:]] == ["equations", "esn,"]
    assert lines[1].split()[-1] == "1"
    assert lines[2].split()[-2:] == ["0.7", "3.25"]


def test_cases_are_in_the_order_of_their_numbers(tmp_path):
    scores = {(case, "esn", 500, "RV"): 0.5 for case in ("Re1000", "Re400", "Re600")}
    percentiles("f_score", scores, prediction_time_lt=2.0).to_csv(
        tmp_path / "classification_percentiles.csv", index=False
    )
    rows = campaign_summary(tmp_path).splitlines()[1:]
    assert [row.split()[0] for row in rows] == ["Re400", "Re600", "Re1000"]


def test_a_large_campaign_is_cut_and_says_so(tmp_path):
    scores = {("Re400", "esn", neurons, "RV"): neurons / 1000 for neurons in range(100, 120)}
    percentiles("f_score", scores, prediction_time_lt=2.0).to_csv(
        tmp_path / "classification_percentiles.csv", index=False
    )
    lines = campaign_summary(tmp_path).splitlines()
    assert len(lines) == MOST_ROWS + 2
    assert "and 4 more" in lines[-1]


def test_exceedances_are_of_one_prediction_time(tmp_path):
    """Not the least of each, which would pair two experiments."""
    at_times = {1: (0.12, 0.02), 2: (0.11, 0.05)}
    pd.concat(
        percentiles(f"exceedance_{flows}", {ESN: values[number]}, prediction_time_lt=time)
        for time, values in at_times.items()
        for number, flows in enumerate(("uncontrolled", "controlled"))
    ).to_csv(tmp_path / "control_percentiles.csv", index=False)
    heads, row = campaign_summary(tmp_path).splitlines()
    assert heads.endswith("exceedance  under control  PT [LT]")
    assert row.split()[-3:] == ["0.12", "0.02", "1"]


def test_tables_of_no_byte_are_none(tmp_path):
    for name in ("classification_percentiles", "horizon_percentiles", "warnings"):
        (tmp_path / f"{name}.csv").touch()
    assert campaign_summary(tmp_path) == warnings_summary(tmp_path) == ""


def test_no_tables_no_summary(tmp_path):
    assert campaign_summary(tmp_path) == ""


def warnings(*rows):
    names = ["case", "reynolds", "forecaster", "neurons", "validation"]
    names += ["warning", "finding", "advice"]
    return pd.DataFrame(rows, columns=names)


def test_warnings_that_say_the_same_share_a_line(tmp_path):
    edge = ("optimum_on_edge", "beta at its lower bound", "widen the search")
    warnings(
        ("Re400", 400, "esn", 500, "RV", *edge),
        ("Re400", 400, "esn", 500, "SSV", *edge),
        ("Re400", 400, None, None, None, "few_events", "3 events", "lower the threshold"),
    ).to_csv(tmp_path / "warnings.csv", index=False)
    assert warnings_summary(tmp_path).splitlines()[1:] == [
        "  Re400, esn, 500 neurons, RV; esn, 500 neurons, SSV: beta at its lower bound. "
        "Try: widen the search.",
        "  Re400: 3 events. Try: lower the threshold.",
    ]


def test_many_warnings_are_cut_and_none_are_nothing(tmp_path):
    assert warnings_summary(tmp_path) == ""
    warnings().to_csv(tmp_path / "warnings.csv", index=False)
    assert warnings_summary(tmp_path) == ""
    rows = [
        (f"c{n}", None, None, None, None, "few_events", f"{n} events", "x")
        for n in range(MOST_WARNINGS + 3)
    ]
    warnings(*rows).to_csv(tmp_path / "warnings.csv", index=False)
    lines = warnings_summary(tmp_path).splitlines()
    assert len(lines) == MOST_WARNINGS + 2
    assert lines[-1].strip() == "... and 3 more"


def test_the_first_warning_of_each_kind_is_shown(tmp_path):
    often = [
        (f"c{n}", None, None, None, None, "few_events", f"{n} events", "x")
        for n in range(MOST_WARNINGS + 3)
    ]
    rare = ("c99", None, None, None, None, "nothing_to_calibrate_with", "no point counts", "y")
    warnings(*often, rare).to_csv(tmp_path / "warnings.csv", index=False)
    lines = warnings_summary(tmp_path).splitlines()[1:]
    assert lines[:3] == [
        "  c0: 0 events. Try: x.",
        "  c99: no point counts. Try: y.",
        "  c1: 1 events. Try: x.",
    ]


def test_the_end_names_only_what_there_is(tmp_path):
    assert where_results_lie(tmp_path) == f"Results: {tmp_path}"
    (tmp_path / "tables").mkdir()
    (tmp_path / "tables" / "dataset.csv").write_text("")
    assert where_results_lie(tmp_path) == f"Tables: {tmp_path}/tables/*.csv and *.tex."
    (tmp_path / "figures").mkdir()
    (tmp_path / "figures" / "own_flow.png").write_text("")
    assert "look first" not in where_results_lie(tmp_path)
    (tmp_path / "figures" / "forecast_skill.png").write_text("")
    assert where_results_lie(tmp_path).endswith("; look first at forecast_skill.")
