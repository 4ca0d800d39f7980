from pathlib import Path

from snaketrust.job import run_job


def compute():
    total = sum(int(Path(path).read_text()) for path in snakemake.input)
    Path(snakemake.output[0]).write_text(f"{total}\n")


run_job(snakemake, compute)
