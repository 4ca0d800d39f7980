"""JSON Schema of configurations, from the model: editors complete settings and show their meaning.

``make pages`` writes it to ``workflow/schemas/config.schema.json``. A configuration may be an
overlay of config.yaml, so that no setting is required. Settings that exclude each other are checked
by the workflow alone.
"""

import json
from typing import Any

from burstcast_workflow.config.forecasters import BlockForecasters, Choice
from burstcast_workflow.config.model import Configuration

_OF_MESSAGES = ("multiple_of", "relations", "required", "title", "unit")
"""What the model says about a setting for messages and the reference."""
_BOUNDS = {"ge": "minimum", "le": "maximum", "gt": "exclusiveMinimum", "lt": "exclusiveMaximum"}
"""Bounds that pydantic leaves under its own names where a type has checks beside them."""


def schema() -> dict[str, Any]:
    """The schema, with units in the descriptions."""
    made: dict[str, Any] = _plain(Configuration.model_json_schema(), "")
    for name in (BlockForecasters.__name__, Choice.__name__):
        mapping = made["$defs"][name]
        kinds = {"anyOf": [{"enum": [*mapping["properties"]]}, {"$ref": f"#/$defs/{name}"}]}
        made["$defs"][name] = {"anyOf": [mapping, {"type": "array", "items": kinds}]}
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **made}


def _plain(node: Any, name: str) -> Any:
    """An entry of the schema that is called so."""
    if isinstance(node, list):
        return [_plain(item, "") for item in node]
    if not isinstance(node, dict):
        return node
    if name in ("properties", "$defs"):
        return {key: _plain(value, key) for key, value in node.items()}
    said = {_BOUNDS.get(key, key): _plain(value, key) for key, value in node.items()}
    unit = "Lyapunov times" if name.endswith("_lt") else said.get("unit")
    if unit and "description" in said:
        said["description"] += f" [{unit}]"
    return {key: value for key, value in said.items() if key not in _OF_MESSAGES}


if __name__ == "__main__":
    print(json.dumps(schema(), indent=1, sort_keys=True))
