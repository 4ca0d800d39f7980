"""Provenance of an archive: ``ro-crate-metadata.json``, made of the records of a campaign.

It keeps to the profile Provenance Run Crate 0.5 of RO-Crate 1.1
(https://www.researchobject.org/workflow-run-crate/profiles/provenance_run_crate): which jobs ran,
of which rule, with which code and when, what they read, and what they wrote.
"""

import json
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from typing import Any
from urllib.parse import quote

from burstcast_workflow.harness.environment import library_version
from burstcast_workflow.stages.canonical import canonical_json
from snaketrust.records import Record

METADATA = "ro-crate-metadata.json"
"""Name of the file, which makes a directory a crate."""
WORKFLOW = "Snakefile"

_RO_CRATE = "https://w3id.org/ro/crate/1.1"
_WORKFLOW_CRATE = "https://w3id.org/workflowhub/workflow-ro-crate/1.0"
_PROFILES = {
    "https://w3id.org/ro/wfrun/process/0.5": ("Process Run Crate", "0.5"),
    "https://w3id.org/ro/wfrun/workflow/0.5": ("Workflow Run Crate", "0.5"),
    "https://w3id.org/ro/wfrun/provenance/0.5": ("Provenance Run Crate", "0.5"),
    _WORKFLOW_CRATE: ("Workflow RO-Crate", "1.0"),
}
_SNAKEMAKE = "https://snakemake.github.io"
_LANGUAGE = "https://w3id.org/workflowhub/workflow-ro-crate#snakemake"
_MEDIA_TYPES = {
    "csv": "text/csv",
    "json": "application/json",
    "md": "text/markdown",
    "pdf": "application/pdf",
    "png": "image/png",
    "tex": "application/x-tex",
    "yaml": "application/yaml",
}

Entity = dict[str, Any]


def metadata(
    name: str,
    files: Iterable[str],
    records: Sequence[Record],
    *,
    revision: str,
    licence: str,
) -> bytes:
    """Metadata of a crate of files of a campaign, `WORKFLOW` among them.

    There are records of all results of the campaign, one at least. Revision and licence are those
    of the sources, the latter an SPDX name.
    """
    parts = sorted(files)
    inside = frozenset(parts)
    jobs: dict[str, list[Record]] = {}
    for record in sorted(records, key=lambda one: one.path):
        jobs.setdefault(canonical_json(record.identity), []).append(record)
    rules = sorted({record.identity["rule"] for record in records})
    ends = [_written(record) for record in records]
    begins = [end - record.seconds for end, record in zip(ends, records, strict=True)]
    outside = {one.path for one in records} | {path for one in records for path in one.inputs}
    outside -= inside
    results = [path for path in parts if path.startswith(("tables/", "figures/"))]
    digests = {path: value for one in records for path, value in one.inputs.items()}
    digests |= {one.path: one.digest for one in records}
    graph: list[Entity] = [
        {
            "@id": METADATA,
            "@type": "CreativeWork",
            "about": _to("./"),
            "conformsTo": _to_all([_RO_CRATE, _WORKFLOW_CRATE]),
        },
        _entity(
            "./",
            "Dataset",
            f"{name}: a campaign of burstcast",
            description="Tables and figures of a campaign of burstcast, and how they were made.",
            datePublished=_time(max(ends)),
            license=_to(f"https://spdx.org/licenses/{licence}"),
            conformsTo=_to_all(_PROFILES),
            hasPart=_to_all(map(quote, parts)),
            mainEntity=_to(WORKFLOW),
            mentions=_to_all(["#run", "#organise"]),
        ),
        *(
            _entity(profile, "CreativeWork", title, version=version)
            for profile, (title, version) in _PROFILES.items()
        ),
        _entity(f"https://spdx.org/licenses/{licence}", "CreativeWork", licence),
        _entity(
            _LANGUAGE,
            "ComputerLanguage",
            "Snakemake",
            identifier=_to("https://doi.org/10.1093/bioinformatics/bts480"),
            url=_to(_SNAKEMAKE),
        ),
        _entity(
            "#snakemake",
            "SoftwareApplication",
            "Snakemake",
            url=_SNAKEMAKE,
            softwareVersion=library_version("snakemake"),
        ),
        _entity(
            WORKFLOW,
            ["File", "SoftwareSourceCode", "ComputationalWorkflow", "HowTo"],
            "burstcast",
            encodingFormat="text/plain",
            programmingLanguage=_to(_LANGUAGE),
            license=_to(f"https://spdx.org/licenses/{licence}"),
            version=revision,
            hasPart=_to_all(f"#rule-{rule}" for rule in rules),
            step=_to_all(f"#step-{rule}" for rule in rules),
        ),
        *(_file(path) for path in parts if path != WORKFLOW),
        *(
            _entity(
                _id(path, inside),
                "CreativeWork",
                path,
                description="A file of the campaign that is not in the archive.",
                identifier=f"sha256:{digests[path]}",
            )
            for path in sorted(outside)
        ),
    ]
    for position, rule in enumerate(rules, 1):
        step = {"position": str(position), "workExample": _to(f"#rule-{rule}")}
        graph.append(_entity(f"#rule-{rule}", "SoftwareApplication", rule))
        graph.append({"@id": f"#step-{rule}", "@type": "HowToStep", **step})
    for number, outputs in enumerate(jobs.values(), 1):
        graph += _job(number, outputs, inside)
    whole = {"startTime": _time(min(begins)), "endTime": _time(max(ends))}
    graph += [
        _entity(
            "#run",
            "CreateAction",
            f"The campaign {name}",
            instrument=_to(WORKFLOW),
            object=_to_all(["config.yaml"]),
            result=_to_all(map(quote, results)),
            **whole,
        ),
        _entity(
            "#organise",
            "OrganizeAction",
            f"Snakemake runs the campaign {name}",
            instrument=_to("#snakemake"),
            object=_to_all(f"#control-{number}" for number in range(1, len(jobs) + 1)),
            result=_to("#run"),
            **whole,
        ),
    ]
    document = {"@context": f"{_RO_CRATE}/context", "@graph": graph}
    return f"{json.dumps(document, indent=1)}\n".encode()


def _job(number: int, outputs: Sequence[Record], inside: frozenset[str]) -> list[Entity]:
    """Actions of a job, which wrote several files."""
    first = outputs[0]
    rule = first.identity["rule"]
    wildcards = [f"{name} {value}" for name, value in first.identity.items() if name != "rule"]
    end = max(map(_written, outputs))
    return [
        _entity(
            f"#job-{number}",
            "CreateAction",
            ", ".join([rule, *wildcards]),
            description=f"Sources of revision {first.revision or 'unknown'}.",
            instrument=_to(f"#rule-{rule}"),
            object=_to_all(_id(path, inside) for path in sorted(first.inputs)),
            result=_to_all(_id(record.path, inside) for record in outputs),
            startTime=_time(end - first.seconds),
            endTime=_time(end),
        ),
        _entity(
            f"#control-{number}",
            "ControlAction",
            f"Run of {rule}",
            instrument=_to(f"#step-{rule}"),
            object=_to(f"#job-{number}"),
        ),
    ]


def _entity(id_: str, kind: str | list[str], name: str, /, **properties: Any) -> Entity:
    return {"@id": id_, "@type": kind, "name": name, **properties}


def _file(path: str) -> Entity:
    media_type = _MEDIA_TYPES.get(path.rpartition(".")[2], "text/plain")
    found = _entity(quote(path), "File", path, encodingFormat=media_type)
    return {**found, "about": _to("./")} if path == "README.md" else found


def _id(path: str, inside: frozenset[str]) -> str:
    return quote(path if path in inside else f"#file-{path}", safe="#/")


def _to(identifier: str) -> dict[str, str]:
    return {"@id": identifier}


def _to_all(identifiers: Iterable[str]) -> dict[str, str] | list[dict[str, str]]:
    found = [_to(one) for one in identifiers]
    return found[0] if len(found) == 1 else found


def _written(record: Record) -> float:
    """Second at which a file was written."""
    seconds: float = record.stamp[1] / 1e9
    return seconds


def _time(seconds: float) -> str:
    return datetime.fromtimestamp(int(seconds), UTC).isoformat()
