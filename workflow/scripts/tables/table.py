"""Make tables of a case, whatever they are: a module of `burstcast.tables.makers` says of what."""

from typing import Any

from burstcast.base.declared import File, called
from burstcast.tables.makers.registry import maker
from burstcast_workflow.harness.job import job
from burstcast_workflow.jobs.inputs import content_of
from burstcast_workflow.jobs.tables import TablesOfCase


@job
def make_tables(*, tables: list[str], settings: TablesOfCase, **files: str | list[str]) -> None:
    """Read what the tables are made of, and write their rows."""

    def of_file(name: str, file: File) -> Any:
        if file.of_each:
            return settings.gathered(files[name], file.variables)
        return content_of(files[name], file)

    rows = called(maker(settings.rule), settings.value_of, of_file)
    settings.write(tables, **settings.with_keys(rows))
