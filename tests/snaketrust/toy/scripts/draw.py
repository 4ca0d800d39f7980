from pathlib import Path

from toy.drawing import draw

from snaketrust.job import run_job


def compute():
    Path(snakemake.output[0]).write_text(draw(snakemake.params.settings["number"]))


run_job(snakemake, compute)
