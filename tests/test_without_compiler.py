"""A platform without llvmlite: slower, and it says so."""

import os
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

from burstcast.compiled.backends import usable_backend

ROOT = Path(__file__).parents[1]
# a module that is None in sys.modules cannot be imported
WITHOUT = "import sys; sys.modules.update(dict.fromkeys(['llvmlite', 'llvmlite.binding']))"


def test_with_a_compiler_nothing_is_said():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert usable_backend("compiled") == "compiled"
        assert usable_backend("scipy") == "scipy"


@pytest.mark.parametrize(
    ("code", "said"),
    [
        (
            "import yaml\n"
            "from burstcast_workflow.config.loading import load\n"
            "from burstcast_workflow.harness.environment import LIBRARIES, library_version\n"
            "config = load(yaml.safe_load(open('config.yaml')), defaults='config.yaml')\n"
            "print(config['forecasters']['esn']['backend'])\n"
            "print(*map(library_version, LIBRARIES))\n",
            "scipy",
        ),
        (
            "import numpy as np, burstcast\n"
            "from burstcast.systems.integration import integrate\n"
            "from burstcast.systems.lorenz63 import Lorenz63\n"
            "start = np.random.default_rng(1).uniform(1, 9, (3, 3))\n"
            "series = integrate(Lorenz63(), start, 0.02, 400).transpose(2, 0, 1)\n"
            "times = dict(washout=20, prediction_times=(20,), window=20, validation_interval=40,\n"
            "             calibration_spacing=20, sampling_interval=0.02)\n"
            "for kind in ('esn', 'equations_filtered'):\n"
            "    forecaster = burstcast.EventForecaster(Lorenz63(), {'quantile': 0.8}, kind=kind,\n"
            "        members=1, neurons=30, grid=2, bayesian_points=0, **times).fit(series)\n"
            "    print(kind, np.isfinite(forecaster.predict_proba(series)).all())\n",
            "esn True\nequations_filtered True",
        ),
    ],
    ids=["the workflow", "the library"],
)
def test_without_a_compiler_scipy_takes_over(code, said):
    result = subprocess.run(
        [sys.executable, "-c", f"{WITHOUT}\n{code}"],
        capture_output=True,
        text=True,
        check=False,
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT / "src")},
    )
    assert result.returncode == 0, result.stderr
    assert said in result.stdout
    assert "reservoirs are computed by scipy, which is several times slower" in result.stderr
