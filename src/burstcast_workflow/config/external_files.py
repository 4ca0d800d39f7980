"""Files of forecasts that other programs have made for cases of the campaign."""

import os
from collections.abc import Iterator
from pathlib import Path

from burstcast.benchmark.forecast_files import ForecastFileError, facts_of
from burstcast_workflow.config.cases import blocks_of
from burstcast_workflow.config.model import Configuration, ExternalFiles


def external_forecasts(config: Configuration, case: str) -> dict[str, ExternalFiles]:
    """Forecasts of a case from files, by their names."""
    blocks = blocks_of(config, case)
    return {
        name: said for block in blocks for name, said in (block.forecasters.external or {}).items()
    }


def paths_of(said: ExternalFiles, case: str) -> list[str]:
    """Files of one forecaster for a case."""
    return [os.path.relpath(path.replace("{case}", case)) for path in said.files]


def problems_of_external(config: Configuration, case: str) -> Iterator[str]:
    """Mistakes in the files of a case that their first lines show."""
    known = external_forecasts(config, case)
    for block in blocks_of(config, case):
        for name, said in (block.forecasters.external or {}).items():
            if known[name] != said:
                yield f"campaign.forecasters.external.{name} is said twice, with other files"
    for name, said in known.items():
        place = f"campaign.forecasters.external.{name}.files"
        for path in paths_of(said, case):
            if path.startswith(os.path.join(os.path.relpath(config.results), "")):
                yield f"{place}: {path} lies among the results; keep it in another directory"
                continue
            try:
                facts = facts_of(Path(path))
            except ForecastFileError as error:
                exported = f"{config.results}/{case}/forecast_task.nc"
                yield (
                    f"{place}: {error}; without this forecaster in the config, snakemake "
                    f"{exported} exports the washouts that forecasts start from"
                )
                continue
            for fact, found, expected in (
                ("case", facts.case, case),
                ("seed", facts.seed, config.random_seed),
            ):
                if found != expected:
                    yield f"{place}: {path} is of the {fact} {found}; expected is {expected}"
