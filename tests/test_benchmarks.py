"""The benchmark runs to its end, with the library and the config as they are."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


@pytest.mark.long  # a minute
def test_a_short_benchmark_measures_and_predicts():
    command = [sys.executable, str(ROOT / "benchmarks" / "bench.py"), "--quick"]
    text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    rows = re.findall(
        r"^\| ([a-z -]+) \|.*\| 1000 \| ([\d.]+) \|", text, re.MULTILINE | re.IGNORECASE
    )
    assert len(rows) == 8
    assert all(float(seconds) > 0 for _, seconds in rows)
    assert "Beside ReservoirPy" in text
    (times,) = re.findall(r"\*\*([\d.]+) times\*\* the machine's limit", text)
    # faster than the machine's own matrix products would be a mistake
    assert float(times) > 1
