import math
import subprocess
import sys

import numpy as np
import pytest

from burstcast_workflow.harness.storage import read_json, write_json


def test_json_round_trip(tmp_path):
    record = {"b": [1, 2.5, None, True], "a": {"ä": "k ≥ k_e", "tiny": 5e-324, "third": 1 / 3}}
    write_json(tmp_path / "record.json", record)
    assert read_json(tmp_path / "record.json") == record
    text = (tmp_path / "record.json").read_text()
    assert text.index('"a"') < text.index('"b"')
    assert text.endswith("}\n")


@pytest.mark.parametrize(
    ("value", "error"),
    [(math.nan, ValueError), (math.inf, ValueError), (np.int64(1), TypeError)],
)
def test_json_refuses_what_it_cannot_say(tmp_path, value, error):
    with pytest.raises(error, match=r"record\.json"):
        write_json(tmp_path / "record.json", {"a": [value]})
    assert list(tmp_path.iterdir()) == []


def test_the_harness_loads_nothing_that_is_slow():
    code = (
        "import sys, burstcast_workflow.harness.job\n"
        "slow = ('pandas', 'matplotlib', 'scipy', 'netCDF4')\n"
        "print([name for name in slow if name in sys.modules])"
    )
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert result.stdout.strip() == "[]"
