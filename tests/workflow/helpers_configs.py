"""Configs as Snakemake merges them, with single settings changed, and their campaigns."""

import copy
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml
from snakemake.utils import update_config

from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.campaign.loading import load

ROOT = Path(__file__).parents[2]
PRESETS = sorted((ROOT / "workflow" / "presets").glob("*.yaml"))
TINY = ROOT / "workflow" / "presets" / "tiny.yaml"
FLOW = ROOT / "examples" / "kolmogorov"


DATA = {"files": ["lab/run_*.csv"], "components": ["u", "v"], "observable": "u", "time_step": 0.5}
LAB = {
    **{"data": DATA, "event_threshold": -1.5, "density": {"range": [-4, 0]}, "test_series": 3},
    **{"training": {"series": 2}, "recycle_validation": {"series": 1}},
}
PART = {"data": {"case": "Re400", "components": ["a1", "s = a2**2 + a3**2"]}}
NETWORKS = {"neurons": [2000], "validation": ["RV"], "seeds": 1}
# One simulated case, one of files, one that is a part of the simulated one.
MEASURED = {
    "cases": {"lab": LAB, "part": PART},
    "campaign": [
        {"reynolds": [400], "forecasters": {"esn": NETWORKS, "equations": {}}},
        {
            "cases": ["lab", "part"],
            "forecasters": {"esn": NETWORKS, "quadratic_filtered": {}, "persistence": {}},
        },
    ],
    "statistics": {"duration": 100, "fixed_point_interval_lt": 1},
}


def read(path: Path) -> dict[str, Any]:
    return dict(yaml.safe_load(path.read_text(encoding="utf-8")))


def paper_with(*overlays: Mapping[str, Any], blocks: list | None = None) -> dict[str, Any]:
    """The campaign of the paper with overlays; ``blocks`` in the place of all its blocks."""
    config = read(ROOT / "config.yaml")
    for overlay in overlays:
        update_config(config, copy.deepcopy(overlay))
    return config | ({"campaign": copy.deepcopy(blocks)} if blocks else {})


def tiny_with(*overlays: Mapping[str, Any]) -> dict[str, Any]:
    """The tiny preset with overlays."""
    return paper_with(read(TINY), *overlays)


def tiny_campaign(name: str, *overlays: Mapping[str, Any]) -> dict[str, Any]:
    """The config of a small campaign: aware or precursor of these tests, or the encoded example."""
    path = FLOW / "tiny.yaml" if name == "encoded" else ROOT / f"tests/workflow/tiny_{name}.yaml"
    return tiny_with(read(path), *overlays)


def miniature_with_other_names() -> dict[str, Any]:
    """The miniature with three cases for its four.

    One case sorts before another by one rule and after it by another, and parameters are not in the
    order of the names; unequal numbers of series, so that another case's data do not fit.
    """
    config = read(ROOT / "workflow" / "presets" / "miniature.yaml")
    equations: dict[str, Any] = {"equations": {}, "equations_noisy": {}}
    lyapunov = {"given_exponent": 0.0145}
    rare, often = {"event_threshold": 0.35}, {"event_threshold": 0.06}
    cases = {
        "alpha": {"parameters": {"reynolds": 500}, "lyapunov": lyapunov, "test_series": 9, **rare},
        "Zeta": {"parameters": {"reynolds": 450}, "lyapunov": lyapunov, **often},
    }
    blocks = [
        {"cases": ["alpha"], "forecasters": {**networks([40], ("RV",), 2), **equations}},
        {"cases": ["Zeta"], "forecasters": {**networks([40, 30], ("RV", "SSV"), 2), **equations}},
        {"reynolds": [400], "forecasters": {**networks([40], ("RV",)), "equations": {}}},
    ]
    overlay = {"cases": cases, "figures": {"example_case": "Zeta"}, "control": {"flows": 6}}
    overlay["bootstrap"] = {"resamples": 10}
    update_config(config, overlay)
    return config | {"campaign": blocks}


def campaign(*overlays: Mapping[str, Any], blocks: list | None = None) -> Campaign:
    """Campaign of the paper with overlays."""
    return Campaign(load(paper_with(*overlays, blocks=blocks)))


def put(config: Any, name: str, value: Any) -> None:
    """Change one setting, ``campaign.0.reynolds``, or take it away, ``...``."""
    *parents, last = (int(part) if part.isdigit() else part for part in name.split("."))
    for parent in parents:
        inside = config[parent] if isinstance(config, list) else config.get(parent)
        if inside is None:
            inside = config[parent] = {}
        config = inside
    if value == "...":
        del config[last]
    elif isinstance(config, list) and last == len(config):
        config.append(value)
    else:
        config[last] = value


def networks(neurons: list[int], validation: tuple[str, ...] = ("RV",), seeds: int = 1) -> dict:
    """Forecasters of a block: networks."""
    return {"esn": {"neurons": [*neurons], "validation": [*validation], "seeds": seeds}}


def records_of(loaded: Any) -> dict[str, dict[str, Any]]:
    """All settings of each case, as plain data."""
    return {name: case.dump() for name, case in Campaign(loaded).cases.items()}


def computed_files(directory: Path, **values: Any) -> dict[str, str]:
    """Files of values that other jobs compute, by the names of the inputs, for `JobSettings`."""
    of_time = {"sampling_interval": 1.0, "steps_per_lyapunov_time": 20}
    records = {"time_unit": of_time, "event_threshold": {"event_threshold": 0.1}}
    files = {}
    for name, record in records.items():
        path = directory / f"{name}.json"
        given = {key: value for key, value in values.items() if key in record}
        path.write_text(json.dumps({**record, **given}))
        files[name] = str(path)
    return files
