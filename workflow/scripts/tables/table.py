"""Make tables of a case, whatever they are: a module of `burstcast.tables.makers` says of what."""

from typing import Any

from burstcast.tables.makers.registry import PATH, maker
from burstcast_workflow.harness.job import job
from burstcast_workflow.jobs.tables import TablesOfCase, content


def _content(file: str | list[str], variables: str) -> Any:
    """Content of a file, or its path; None if the case has none."""
    if not isinstance(file, str):
        return None
    return file if variables == PATH else content(file, variables)


@job
def make_tables(*, tables: list[str], settings: TablesOfCase, **files: str | list[str]) -> None:
    """Read what the tables are made of, and write their rows."""
    module = maker(settings.rule)
    made_of = module.TABLES
    inputs = {name: _content(files[name], names) for name, names in made_of.inputs.items()}
    of_each = {
        name: settings.gathered(files[name], names) for name, names in made_of.gathered.items()
    }
    values = {name: settings.value_of(path) for name, path in made_of.paths.items()}
    settings.write(tables, **settings.with_keys(module.make(**inputs, **of_each, **values)))
