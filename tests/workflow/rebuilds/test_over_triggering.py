"""What an edit must not set off: for each of a list, written by hand, the jobs that may run at all.

The list has what people edit every day: words, a colour, one more kind of forecaster. Nothing runs
here but the tiny preset, once; the rest is planned.
"""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path

import pytest
from edits import tiny_config
from helpers_rebuilds import Project

LIBRARY, WORKFLOW = "src/burstcast", "src/burstcast_workflow"
DECLARATIONS = "workflow/tables.yaml"


@dataclass(frozen=True)
class Edit:
    """Another text in one place of a file, or a file that is new.

    Attributes
    ----------
    what
        In words.
    path
        Of the file.
    old
        What stands there; empty for a new file.
    new
        What stands there then.
    """

    what: str
    path: str
    old: str
    new: str


@pytest.fixture(scope="module")
def project(tmp_path_factory, finished) -> Project:
    """Finished results of the tiny preset, figures included."""
    made = finished.project.copy(tmp_path_factory.mktemp("whole") / "project")
    outcome = made.snakemake()
    assert outcome.status == 0, outcome.text[-3000:]
    assert made.planned() == set()
    return made


@contextmanager
def edited(project: Project, *edits: Edit) -> Iterator[None]:
    """Make edits, and take them back."""
    with project.restored(*(edit.path for edit in edits)):
        for edit in edits:
            if edit.old:
                project.edit(edit.path, edit.old, edit.new)
            else:
                (project.directory / edit.path).write_text(edit.new)
        yield


def beyond(planned: set[str], allowed: str) -> set[str]:
    """Jobs that no pattern allows."""
    return {
        job for job in planned if not any(fnmatchcase(job, pattern) for pattern in allowed.split())
    }


# -- nothing runs ----------------------------------------------------------------------------------

PERSISTENCE = '''"""Persistence: the last state that was observed, for ever."""

from typing import Self

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.forecasters.base import Forecaster, ForecasterRecord, ForecastingCase


class Persistence(Forecaster):
    """Repeats the last state of the washout."""

    @classmethod
    def fit(cls, training: FloatArray, case: ForecastingCase) -> Self:
        return cls()

    def record(self) -> ForecasterRecord:
        return ForecasterRecord()

    @classmethod
    def restore(cls, record: ForecasterRecord, case: ForecastingCase) -> Self:
        return cls()

    def start(self, washout: FloatArray) -> FloatArray:
        return np.ascontiguousarray(washout[-1])

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        return np.repeat(memory[np.newaxis], steps, axis=0), memory
'''
ALWAYS = '''"""Always on."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from burstcast.control.experiment import ControlExperiment
from burstcast.control.policy import Policy
from burstcast.control.strategies.base import SampledStrategy


@dataclass(frozen=True)
class Always(SampledStrategy):
    """Acts all the time."""

    def policy(self, experiment: ControlExperiment, forecaster: Any) -> Policy:
        return lambda look: np.ones(len(look.rows), dtype=bool)
'''
LAST_SERIES = '''"""Validation on the end of the last series."""

from burstcast.tuning.strategies.base import Block, Fold, ValidationPlan, ValidationStrategy


class LastSeriesValidation(ValidationStrategy):
    """Validates on the last interval of the last series."""

    name = "LSV"
    title = "Last Series Validation"

    def folds(self, plan: ValidationPlan, series: int, length: int) -> list[Fold]:
        cut = length - plan.interval
        last = range(series - 1, series)
        return [Fold(trained=(Block(range(series), cut),), series=last, starts=(cut,))]
'''
DECAY = '''"""Exponential decay."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.systems.base import DynamicalSystem


@dataclass(frozen=True)
class Decay(DynamicalSystem):
    """dx/dt = -rate x."""

    rate: float = 1.0

    dimension: ClassVar[int] = 1
    observable_name: ClassVar[str] = "x"
    observable_symbol: ClassVar[str] = "x"

    def right_hand_side(self, state: FloatArray) -> FloatArray:
        return -self.rate * state

    def jacobian(self, state: FloatArray) -> FloatArray:
        return np.full((1, *state.shape), -self.rate)

    def observable(self, state: FloatArray) -> FloatArray:
        return np.array(state[0])
'''

WITHOUT_EFFECT = [
    Edit(
        "help of the command line",
        f"{WORKFLOW}/commands/command_line.py",
        'help="the zip; <results>.zip if left out"',
        'help="the archive"',
    ),
    Edit(
        "another message of the harness",
        f"{WORKFLOW}/harness/job.py",
        '"%s starts with settings %s"',
        '"%s begins; its settings: %s"',
    ),
    Edit(
        "the log in a module of the library that had none",
        f"{LIBRARY}/durations.py",
        "import math\n",
        "import logging\nimport math\n\nlogger = logging.getLogger(__name__)\n",
    ),
    Edit(
        "a message in it, and other words of an error",
        f"{LIBRARY}/durations.py",
        'raise ValueError(f"the leading Lyapunov exponent must be positive, not {exponent}")\n',
        'logger.warning("exponent %s", exponent)\n'
        '        raise ValueError(f"a leading Lyapunov exponent is positive, not {exponent}")\n',
    ),
    Edit(
        "words of an error of the library",
        f"{LIBRARY}/systems/integration.py",
        '"an initial state is not finite"',
        '"all initial states must be finite"',
    ),
    Edit(
        "words of an error of the jobs",
        f"{WORKFLOW}/jobs/gather.py",
        "remove it, and run again",
        "remove it and run the workflow again",
    ),
    Edit(
        "a check of lengths",
        f"{WORKFLOW}/config/lengths.py",
        "    if steps is None or steps:\n",
        "    if _samples(ensemble) < 3:\n"
        '        problems.append("ensemble.duration is too short")\n'
        "    if steps is None or steps:\n",
    ),
    Edit(
        "caption of a figure",
        f"{LIBRARY}/figures/observable_and_density.py",
        "Typical evolution of the observable",
        "How the observable evolves",
    ),
    Edit(
        "meaning of a column",
        DECLARATIONS,
        "harmonic mean of precision and recall",
        "2 TP / (2 TP + FP + FN)",
    ),
    Edit(
        "caption of a table in the report",
        DECLARATIONS,
        "Counts and scores of the forecasts of each forecaster",
        "Scores of each forecaster",
    ),
    Edit("a new forecaster", f"{LIBRARY}/forecasters/persistence.py", "", PERSISTENCE),
    Edit("a new strategy of control", f"{LIBRARY}/control/strategies/always.py", "", ALWAYS),
    Edit(
        "a strategy of control that nobody uses",
        f"{LIBRARY}/control/strategies/random_decisions.py",
        '"random decisions"',
        '"decisions at random"',
    ),
    Edit("a new strategy", f"{LIBRARY}/tuning/strategies/last_series.py", "", LAST_SERIES),
    Edit("a new system", f"{LIBRARY}/systems/decay.py", "", DECAY),
    Edit(
        "a system that nobody uses",
        f"{LIBRARY}/systems/lorenz63.py",
        "rho: float = 28.0",
        "rho: float = 29.0",
    ),
]


def test_edits_that_run_nothing(project):
    with edited(project, *WITHOUT_EFFECT):
        planned = project.planned()
    if planned:
        for count, edit in enumerate(WITHOUT_EFFECT, 1):  # which of them it was
            with edited(project, *WITHOUT_EFFECT[:count]):
                assert project.planned() == set(), edit.what
    assert planned == set()


# -- some run --------------------------------------------------------------------------------------

# What has rows of every forecaster, and of those that control.
GATHERED = """classification_table/* horizon_table/* warnings_table/*
    calibrate/* probability_scores/* probability_diagrams/* lead_times/*
    all_classification_table all_horizon_table all_warnings_table all_probability_scores
    all_probability_diagrams all_lead_times
    figure/classification_scores figure/horizon_by_size
    figure/forecast_skill figure/reliability"""
GATHERED_CONTROL = """control_table/* control_density_table/* control_strategies_table/*
    all_control_table all_control_density_table all_control_strategies_table
    figure/control_tradeoff figure/control_density figure/control_frontier"""
GATHERED_LONG_RUNS = """statistics_table/* survival_table/* lyapunov_spectrum_table/*
    all_statistics_table all_survival_table all_lyapunov_spectrum_table
    figure/own_flow warnings_table/* all_warnings_table"""
GATHERED_NETWORKS = f"""{GATHERED} {GATHERED_CONTROL}
    hyperparameters_table/* all_hyperparameters_table
    {GATHERED_LONG_RUNS}
    figure/long_term_density figure/profile_errors figure/midplane_mean_square"""
OF_NETWORKS = """scan/* search/* train/* */esn-*
    figure/network_schematic figure/prediction_* figure/horizon_evaluations
    figure/midplane_planes figure/vorticity_isosurfaces figure/control_schematic
    figure/suppressed_event"""

WITH_EFFECT = [
    (
        Edit(
            "a strategy of control",
            f"{LIBRARY}/control/strategies/receding_horizon.py",
            "(ahead >= level)",
            "(ahead >= 2.0 * level)",
        ),
        "control/*/receding_horizon-* control_strategies_table/* "
        "all_control_strategies_table figure/control_frontier "
        "figure/control_tradeoff",
    ),
    (
        Edit(
            "head of a column",
            DECLARATIONS,
            "head: exceedance}",
            "head: without control}",
        ),
        "all_control_table",
    ),
    (
        Edit(
            "format of a column",
            DECLARATIONS,
            "empty without events, format: .3f",
            "empty without events, format: .2f",
        ),
        "all_classification_table",
    ),
    (
        Edit(
            "caption of a LaTeX table",
            DECLARATIONS,
            "caption: Hyperparameters that the search chose.",
            "caption: The hyperparameters that were found.",
        ),
        "all_hyperparameters_table",
    ),
    (
        Edit(
            "order of the columns of a table",
            DECLARATIONS,
            "[series, survived_fraction, escapes,",
            "[series, escapes, survived_fraction,",
        ),
        "survival_table/* all_survival_table figure/own_flow",
    ),
    (
        Edit(
            "columns side by side in tables for papers",
            f"{LIBRARY}/tables/latex.py",
            "_COLUMNS = 4",
            "_COLUMNS = 5",
        ),
        """data_generation_parameters network_hyperparameters all_dataset_table
        all_hyperparameters_table all_classification_table all_probability_scores
        all_horizon_table all_statistics_table all_survival_table all_lyapunov_spectrum_table
        all_control_table all_control_strategies_table""",
    ),
    (
        Edit(
            "a colour of one figure",
            f"{LIBRARY}/figures/control_tradeoff.py",
            "panel.axhline(0, color=style.GREY",
            "panel.axhline(0, color=style.PURPLE",
        ),
        "figure/control_tradeoff",
    ),
    (
        Edit(
            "the equations as a forecaster",
            f"{LIBRARY}/forecasters/equations_noisy.py",
            "return cls(case.system, *steps, case.parameters)",
            "return cls(case.system, 1.0 * steps[0], steps[1], case.parameters)",
        ),
        f"*/equations */equations/* */equations_noisy {GATHERED} {GATHERED_CONTROL}",
    ),
    (
        Edit(
            "networks as a forecaster",
            f"{LIBRARY}/forecasters/esn.py",
            "return self.network.forecast(memory, steps)",
            "return self.network.forecast(memory.copy(), steps)",
        ),
        # neither data nor the search, though it is a search for networks
        f"""train/* forecast/*/esn-* calibration_forecast/*/esn-* horizon/*/esn-* long_term/*/esn-*
        lyapunov_spectrum/*/esn-* control/*/esn-*
        examples/* flow_event/* suppressed_event/*
        {GATHERED} {GATHERED_CONTROL} {GATHERED_LONG_RUNS}
        figure/long_term_density figure/profile_errors figure/midplane_* figure/prediction_*
        figure/horizon_evaluations figure/vorticity_isosurfaces figure/control_schematic
        figure/suppressed_event""",
    ),
    (
        Edit(
            "the readouts of networks",
            f"{LIBRARY}/esn/readout.py",
            "def _symmetric_norm(lower: FloatArray, rows_per_block: int = 256)",
            "def _symmetric_norm(lower: FloatArray, rows_per_block: int = 128)",
        ),
        f"{OF_NETWORKS} {GATHERED_NETWORKS}",
    ),
    (
        Edit(
            "the velocity profiles",
            f"{LIBRARY}/statistics/profiles.py",
            "np.linspace(-1.0, 1.0, points)",
            "np.linspace(-1, 1, points)",
        ),
        """reference_statistics/* statistics_table/* all_statistics_table
        warnings_table/* all_warnings_table
        figure/long_term_density figure/profile_errors figure/midplane_* figure/suppressed_event
        figure/vorticity_isosurfaces""",
    ),
]


@pytest.mark.parametrize(
    ("edit", "allowed"), WITH_EFFECT, ids=[edit.what for edit, _ in WITH_EFFECT]
)
def test_edits_that_run_little(project, edit, allowed):
    with edited(project, edit):
        planned = project.planned()
    assert planned
    assert beyond(planned, allowed) == set()


def test_one_more_seed_in_a_block_of_its_own(project):
    networks = {"neurons": [40], "validation": ["RV"], "seeds": 2}
    block = {"reynolds": [400], "forecasters": {"esn": networks}}
    planned = project.planned(overlay={"campaign": [*tiny_config()["campaign"], block]})
    assert "Re400/esn-N40-RV-seed1/forecaster.nc" in planned
    new = "Re400/*esn-N40-RV-seed1* Re400/scan/esn-N40-seed1-* control/*/esn-N40-RV-committee/*"
    assert beyond(planned, f"{new} {GATHERED_NETWORKS}") == set()


# -- no job depends on a setting that it does not read ---------------------------------------------


def unread_settings(log: Path) -> set[str]:
    """Settings that a job says it did not read."""
    found = re.findall(r"settings not read: (.*)$", log.read_text(), re.M)
    return {name for line in found for name in line.split(", ")}


def test_every_setting_is_read_by_some_job_of_its_rule(project):
    logs = project.results / "logs"
    unread: dict[str, set[str]] = {}
    for log in logs.rglob("*.log"):
        rule = log.relative_to(logs).with_suffix("").parts[0]
        if rule == "figure":
            rule = f"figure {log.stem}"
        found = unread_settings(log)
        unread[rule] = unread.get(rule, found) & found
    assert {"simulate", "search", "control", "figure long_term_density"} <= unread.keys()
    assert {rule: names for rule, names in unread.items() if names} == {}
