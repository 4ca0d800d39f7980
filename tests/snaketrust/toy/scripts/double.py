import os
from pathlib import Path

from toy.doubling import double

from snaketrust.cache import Cache
from snaketrust.job import run_job


def compute():
    text = Path(snakemake.input[0]).read_text()
    Path(snakemake.output[0]).write_text(double(text, snakemake.params.settings["factor"]))


def cache():
    directory = os.environ.get("TOY_CACHE")
    return Cache(Path(directory), {"python": 3}) if directory else None


run_job(snakemake, compute, cache=cache)
