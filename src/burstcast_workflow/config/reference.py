"""The JSON Schema of configurations, and the reference of all settings that is made from it.

``burstcast settings > docs/settings.md`` prints the reference, running this module the schema, by
which editors complete settings. A configuration may be an overlay of config.yaml, so that the
schema requires no setting.
"""

import json
import re
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from typing import Any

import yaml

from burstcast.forecasters.registry import all_kinds
from burstcast_workflow.config.kinds import RELATIONS, Section
from burstcast_workflow.config.model import Configuration
from burstcast_workflow.project import project_root

Node = dict[str, Any]

_NAMES = {
    "ge": "minimum",
    "gt": "exclusiveMinimum",
    "le": "maximum",
    "lt": "exclusiveMaximum",
    "multiple_of": "multipleOf",
}
"""Bounds that pydantic leaves under its own names where a type has checks beside them."""
_SIGNS = {
    "minimum": ">=",
    "exclusiveMinimum": ">",
    "maximum": "<=",
    "exclusiveMaximum": "<",
    "multipleOf": "a multiple of",
}
_TYPES = {"integer": "whole number", "string": "text", "boolean": "true, false"}


@cache
def schema_of(model: type[Section]) -> Node:
    """JSON Schema of a section, with units, relations and allowed values in words beside it."""
    made: Node = _plain(model.model_json_schema(), "")
    if "cases" in made["properties"]:
        made["properties"]["cases"]["additionalProperties"] = {"$ref": "#/$defs/Simulated"}
    for name, section in made["$defs"].items():
        if "equations" in section.get("properties", {}):
            kinds = {"anyOf": [{"enum": [*section["properties"]]}, {"$ref": f"#/$defs/{name}"}]}
            several = [section, {"type": "array", "items": kinds}]
            made["$defs"][name] = {"anyOf": several, "allowed": "list or mapping of kinds"}
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **made}


def _plain(node: Any, name: str) -> Any:
    """A node of pydantic's schema that is called so, with bounds as JSON Schema names them."""
    if isinstance(node, list):
        return [_plain(item, "") for item in node]
    if not isinstance(node, dict) or name == "relations":
        return node
    if name in ("properties", "$defs"):
        return {key: _plain(value, key) for key, value in node.items()}
    plain = {_NAMES.get(key, key): _plain(value, key) for key, value in node.items()}
    unit = "Lyapunov times" if name.endswith("_lt") else plain.get("unit")
    if unit and "description" in plain:
        plain |= {"unit": unit, "description": f"{plain['description']} [{unit}]"}
    return {
        key: value for key, value in plain.items() if value and key not in ("required", "title")
    } | {key: plain[key] for key in ("default", "additionalProperties", *_SIGNS) if key in plain}


def below(whole: Node, node: Node, part: str | int) -> Node:
    """Node of a setting of a section, of an item of a list or of an entry of a mapping."""
    node = section_of(whole, node)
    if part in node.get("properties", {}):
        return dict(node["properties"][part])
    inside = node.get("items" if isinstance(part, int) else "additionalProperties")
    return inside if isinstance(inside, dict) else {}


def section_of(whole: Node, node: Node) -> Node:
    """The section, list or value of a node that refers to it or may be null."""
    options = [option for option in node.get("anyOf", []) if option.get("type") != "null"]
    if "$ref" in node:
        return section_of(whole, whole["$defs"][node["$ref"].rpartition("/")[2]])
    return section_of(whole, options[0]) if options else node


def settings(whole: Node, node: Node | None = None, name: str = "") -> Iterator[tuple[str, Node]]:
    """All settings with their places, ``campaign[].reynolds``, those of items of lists included."""
    section = section_of(whole, whole if node is None else node)
    for key, inside in section.get("properties", {}).items():
        place = f"{name}.{key}".removeprefix(".")
        yield place, inside
        yield from settings(whole, inside, place)
    if isinstance(items := section.get("items"), dict):
        yield from settings(whole, items, f"{name}[]")


# -- the page --------------------------------------------------------------------------------------

_HEAD = """\
# Settings

Every setting of a configuration with its default, from [config.yaml](../config.yaml) or from the
model of the section. `campaign` is a list of blocks. An entry of `cases` may have any setting of
`case_defaults`, which it overrides. A case of another system than the shear flow starts from the
defaults of its class, and takes only settings without units from `case_defaults`
([tutorial.md](tutorial.md)). Mappings of an overlay are merged with config.yaml, and all other
values, lists included, replace its values.

Kinds of forecasters ([method.md](method.md)) are given as a list,
`[equations, esn: {neurons: [500], validation: [RV], seeds: 3}]`, or as a mapping,
`{equations: {}, esn: ...}`. In a mapping, null removes a kind that config.yaml has. The networks
`esn_true_washout` and `esn_aware` have the axes of `esn`.
{kinds}

Editors complete settings and show their meaning by the JSON Schema
`workflow/schemas/config.schema.json`, named in the first line of config.yaml. `make pages`
generates the schema and this page.
"""
_COLUMNS = ("Setting", "Allowed", "Unit", "Default", "Meaning")


def text(config: Mapping[str, Any]) -> str:
    """Text of the reference, with the defaults of a configuration."""
    classes = "and classes of your own, module:Class, with their options (extending.md)"
    kinds = textwrap.fill(f"The kinds are {', '.join(all_kinds())}, {classes}.", 100)
    kinds = kinds.replace("extending.md", "[extending.md](extending.md#a-forecaster)")
    whole, lines = schema_of(Configuration), [_HEAD.replace("{kinds}", kinds)]
    for place, node in settings(whole):
        unit, section = node.get("unit", ""), section_of(whole, node)
        words = section.get("description", "").rstrip(".")
        meaning = node.get("description", words[:1].lower() + words[1:])
        meaning = meaning.removesuffix(f" [{unit}]")
        if "." not in place:
            lines += [f"\n## {place}\n", f"{meaning[:1].upper()}{meaning[1:]}.\n"]
            lines += [_row(_COLUMNS), _row(["---"] * len(_COLUMNS))]
        # kinds without axes, and networks beside esn, are chosen as others are
        of_kinds, _, axis = place.rpartition(".forecasters.")
        if ("properties" not in section or "equations" in section["properties"]) and (
            not of_kinds or axis.startswith("esn.")
        ):
            others = [
                f"{RELATIONS[key]} `{other}`" for key, other in node.get("relations", {}).items()
            ]
            cells = "; ".join([allowed(whole, node), *others]), unit, _default(config, place, node)
            lines.append(_row([f"`{place}`", *cells, meaning]))
    return "\n".join(lines) + "\n"


def allowed(whole: Node, node: Node) -> str:
    """Allowed values of a setting in words: its type and bounds."""
    if "allowed" in node:
        return str(node["allowed"])
    if "anyOf" in node:
        return " or ".join(allowed(whole, option) for option in node["anyOf"])
    if "$ref" in node:
        return allowed(whole, whole["$defs"][node["$ref"].rpartition("/")[2]])
    if "enum" in node or "const" in node:
        return ", ".join(node.get("enum") or [node["const"]])
    if node.get("type") != "array":
        kind = str(node.get("type", "mapping")).replace("object", "mapping")
        limits = [f"{sign} {node[key]}" for key, sign in _SIGNS.items() if key in node]
        return f"{_TYPES.get(kind, kind)} {' and '.join(limits)}".strip()
    least, most = node.get("minItems"), node.get("maxItems")
    count = f" of {least}{'' if least == most else ' or more'}" if least else ""
    return f"list{count}, each {allowed(whole, node['items'])}"


def _default(config: Any, place: str, node: Node) -> str:
    """Value in config.yaml, except of what is repeated there, or else the model's own."""
    if place in ("campaign", "cases"):
        return "see config.yaml"
    for part in place.split("."):
        if not isinstance(config, Mapping) or part not in config:
            return f"`{json.dumps(node['default'])}`" if "default" in node else "required"
        config = config[part]
    return f"`{json.dumps(config)}`"


def _row(cells: Sequence[str]) -> str:
    # in code a < is itself; elsewhere it would begin an element
    row = f"| {' | '.join(cells)} |"
    return re.sub("(`[^`]*`)|<", lambda match: match[1] or "&lt;", row)


def main() -> int:
    """Print the reference."""
    config = yaml.safe_load((project_root() / "config.yaml").read_text(encoding="utf-8"))
    print(text(config), end="")
    return 0


if __name__ == "__main__":
    print(json.dumps(schema_of(Configuration), indent=1, sort_keys=True))
