"""Time and memory that Snakemake takes to plan large campaigns.

::

    python benchmarks/planning.py [--seeds 1,10,50] [targets and options of snakemake]
    python benchmarks/planning.py --paper 5       # the paper's campaign, five times

A campaign of Reynolds numbers x sizes x seeds is generated, and ``snakemake -n`` plans it in an
empty directory, twice, in turn with a Snakefile of as many trivial jobs. Nothing is computed. The
first plan in a directory reads all code and loads Matplotlib for what figures declare; what it has
found is remembered. With 50 seeds a campaign has 50,000 jobs.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

import yaml

ROOT = Path(__file__).resolve().parents[1]
SIZES = [300 * (index + 1) for index in range(10)]


def campaign(reynolds_numbers: int, sizes: int, seeds: int) -> dict[str, object]:
    """Overlay on config.yaml: one strategy, so that a network is five jobs (scan to horizon)."""
    reynolds = [400 + 30 * index for index in range(reynolds_numbers)]
    neurons = SIZES[:sizes]
    return {
        "results": "results/planning",
        "campaign": [
            {
                "reynolds": reynolds,
                "forecasters": {"esn": {"neurons": neurons, "validation": ["SSV"], "seeds": seeds}},
            }
        ],
        # without given exponents the Lyapunov time would be computed, which is also planned
        "case_defaults": {"lyapunov": {"given_exponent": 0.0135}},
        "statistics": {"forecasters": {"esn": None}},
        "control": {"forecasters": {"esn": None, "equations": None}},
        "figures": {
            "example_case": f"Re{reynolds[0]}",
            "example_forecaster": f"esn-N{neurons[0]}-SSV-seed0",
            "fixed_neurons": neurons[0],
        },
    }


def bare(jobs: int) -> str:
    """A Snakefile of chains of five trivial jobs each."""
    rules = "".join(
        f"rule r{number}:\n    input: '{number - 1}/{{n}}'\n    output: '{number}/{{n}}'\n"
        "    params: seed=1\n    script: 'a.py'\n"
        for number in range(1, 6)
    )
    first = f"rule all:\n    input: expand('5/{{n}}', n=range({-(-jobs // 5)}))\n"
    return first + rules


class Plan(NamedTuple):
    """What planning a campaign takes."""

    jobs: int
    seconds: float  #: of the clock, in the first plan
    first: float  #: of the processor, in the first plan
    again: float  #: of the processor, in the second plan
    mebibytes: float


def plan(arguments: list[str], overlay: dict[str, object] | str) -> Plan:
    """What planning a campaign, or a bare Snakefile, takes in an empty directory, and again."""
    with tempfile.TemporaryDirectory() as directory:
        command = [sys.executable, "-m", "snakemake", "--dry-run", "--quiet", "rules"]
        if isinstance(overlay, str):
            Path(directory, "0").mkdir()
            Path(directory, "Snakefile").write_text(overlay)
            Path(directory, "a.py").touch()
            for number in range(int(overlay.split("range(")[1].split(")")[0])):
                Path(directory, "0", str(number)).touch()
        else:
            config = Path(directory) / "campaign.yaml"
            config.write_text(yaml.safe_dump(overlay))
            command += [*arguments, "--snakefile", str(ROOT / "Snakefile")]
            command += ["--configfile", str(ROOT / "config.yaml"), str(config)]
        output = Path(directory) / "plan.txt"
        seconds, processor = [], []
        for _ in range(2):
            start = time.perf_counter()
            with output.open("w") as stream:
                process = subprocess.Popen(
                    command, cwd=directory, stdout=stream, stderr=subprocess.STDOUT
                )
                _, status, usage = os.wait4(process.pid, 0)
            seconds.append(time.perf_counter() - start)
            processor.append(usage.ru_utime + usage.ru_stime)
            process.returncode = os.waitstatus_to_exitcode(status)
            text = output.read_text()
            if process.returncode:
                sys.exit(text[-4000:])
    totals = [line for line in text.splitlines() if line.startswith("total")]
    return Plan(int(totals[0].split()[1]), seconds[0], *processor, usage.ru_maxrss / 1024)


def main() -> None:
    """Plan campaigns of growing size and print what that takes."""
    parser = argparse.ArgumentParser(
        description="Time and memory of planning; further arguments go to snakemake."
    )
    parser.add_argument("--seeds", default="1,10,50", help="of each size: 50 make 50,000 jobs")
    parser.add_argument("--reynolds", type=int, default=20, help="Reynolds numbers")
    parser.add_argument("--sizes", type=int, default=10, help="reservoir sizes")
    parser.add_argument("--paper", type=int, default=0, help="times to plan the paper's campaign")
    options, others = parser.parse_known_args()
    seeds = list(map(int, options.seeds.split(",")))
    overlays = [campaign(options.reynolds, options.sizes, number) for number in seeds]
    # on a machine that is busy otherwise, the processor's time is what planning takes
    print(
        f"{'jobs':>8} {'seconds':>8} {'processor':>10} {'again':>6} {'MiB':>6} {'times bare':>11}"
    )
    for overlay in [{"results": "results/planning"}] * options.paper or overlays:
        jobs, seconds, first, again, memory = plan(others, overlay)
        ratio = again / plan([], bare(jobs)).again
        cells = f"{jobs:8d} {seconds:8.1f} {first:10.1f} {again:6.1f} {memory:6.0f} {ratio:11.2f}"
        print(cells, flush=True)


if __name__ == "__main__":
    main()
