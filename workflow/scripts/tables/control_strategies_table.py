"""Score all control by what it costs and gains, with intervals over flows."""

from dataclasses import fields

from burstcast import random_streams
from burstcast.control.records import FlowRecords, Span, score_flows
from burstcast_workflow.harness.job import run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_attributes, read_netcdf
from burstcast_workflow.harness.tables import write_rows
from burstcast_workflow.jobs.gather import gathered


def control_strategies_table(*, flows: list[str], table: str, settings: Settings) -> None:
    """Write a row for each run of control and score."""
    rows = []
    for record, path in gathered(settings["rows"], flows):
        found, attributes = read_netcdf(path), read_attributes(path)
        records = FlowRecords(**{field.name: found[field.name] for field in fields(FlowRecords)})
        span = Span(**{field.name: int(attributes[field.name]) for field in fields(Span)})
        # what it is first; the rest is in the order of the alphabet
        keys = {"strategy": record["keys"]["strategy"], **record["keys"]}
        # all runs of a case are resampled alike: their flows are the same
        generator = random_streams.stream(settings["random_seed"], "control", keys["case"])
        scores = score_flows(
            records,
            span,
            settings["bootstrap.resamples"],
            settings["bootstrap.confidence"],
            generator,
        )
        rows += [
            {**keys, "metric": name, "value": score.value, "low": score.low, "high": score.high}
            for name, score in scores.items()
        ]
    write_rows(table, rows)


if __name__ == "__main__":
    run_job(snakemake, control_strategies_table)  # noqa: F821 - Snakemake puts it there
