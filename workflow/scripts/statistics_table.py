"""Measure how far the statistics of networks and of the training set are from the data's."""

from typing import Any

from burstcast.statistics.long_term import Fate
from burstcast.statistics.measures import compare
from burstcast.statistics.profiles import equally_spaced_profiles
from burstcast.systems.registry import make_system
from burstcast_workflow.gather import CASE, NETWORK, by_key, gathered
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.statistics_files import read_statistics
from burstcast_workflow.storage import read_netcdf
from burstcast_workflow.table_files import keyed_table, write_table


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write one row for each network, and for each case its training set and sampling floor."""
    rows = []
    references, matrices = {}, {}
    training, floors = (
        by_key(settings["cases"], paths, CASE) for paths in (inputs.training, inputs.floor)
    )
    for case, data in gathered(settings["cases"], inputs.data, CASE):
        name = case["case"]
        system = make_system(case["system"], case["parameters"])
        references[name] = read_statistics(data)
        matrices[name] = equally_spaced_profiles(system, settings["profile_points"])
        keys = {"case": name, "reynolds": case["reynolds"], "neurons": None, "validation": None}
        measures = compare(references[name], read_statistics(training[name]), matrices[name])
        rows.append({**keys, "forecaster": "training", "seed": None, **vars(measures)})
        # one row for each split of the data
        floor = read_netcdf(floors[name])
        for split in range(floor["split"].size):
            row = {measure: float(floor[measure][split]) for measure in vars(measures)}
            rows.append({**keys, "forecaster": "floor", "seed": split, **row})
    for keys, path in gathered(settings["networks"], inputs.climates, NETWORK):
        measures = compare(references[keys["case"]], read_statistics(path), matrices[keys["case"]])
        discarded = float((read_netcdf(path, "fate")["fate"] != Fate.KEPT).mean())
        rows.append({**keys, "discarded_fraction": discarded, **vars(measures)})
    table = keyed_table(rows)
    table.insert(6, "discarded_fraction", table.pop("discarded_fraction"))
    write_table(outputs.table, table)


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
