"""Draw a figure, whatever it is: its module of `burstcast.figures` declares what it is made of."""

from typing import Any

from burstcast.base.declared import File, called
from burstcast.base.files.tables import read_table
from burstcast_workflow.harness.job import JobSettings, atomic, job
from burstcast_workflow.jobs.inputs import content_of


@job
def figure(*, pdf: str, png: str, settings: JobSettings, **files: str | list[str]) -> None:
    """Read what the figure declares, draw it, and write it as PDF and PNG."""
    # a figure from the cache needs no Matplotlib, which takes half of its time to load
    from burstcast.figures.parts.style import render
    from burstcast.figures.registry import figure_of

    def of_file(name: str, file: File) -> Any:
        return content_of(files[name], file)

    published = {name: read_table(str(path)) for name, path in files.items() if name == "published"}
    drawn = called(figure_of(settings.figure).draw, settings.value_of, of_file, **published)
    # both in memory first: a figure that cannot be drawn leaves no file
    for path, content in ((pdf, render(drawn, "pdf")), (png, render(drawn, "png"))):
        with atomic(path) as partial:
            partial.write_bytes(content)
