"""The reference of all settings, made from the model and config.yaml.

``burstcast settings > docs/settings.md``
"""

import json
import re
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import yaml
from pydantic_core import PydanticUndefined

from burstcast.forecasters.registry import all_kinds
from burstcast_workflow.config.forecasters import KINDS
from burstcast_workflow.config.kinds import RELATIONS
from burstcast_workflow.config.model import Configuration
from burstcast_workflow.config.places import Place
from burstcast_workflow.project import project_root

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
# kinds of forecasters that are chosen as others are: those without axes, and networks beside esn
_ALIKE = re.compile(r"\.forecasters\.(?!esn\.)")
_COLUMNS = ("Setting", "Allowed", "Unit", "Default", "Meaning")


def text(config: Mapping[str, Any]) -> str:
    """Text of the reference, with the defaults of a configuration."""
    own = "and classes of your own, module:Class, with their options (extending.md)"
    kinds = textwrap.fill(f"The kinds are {', '.join(all_kinds())}, {own}.", 100)
    kinds = kinds.replace("extending.md", "[extending.md](extending.md#a-forecaster)")
    return _HEAD.replace("{kinds}", kinds) + "".join(f"{line}\n" for line in _lines(config))


def _lines(config: Mapping[str, Any]) -> Iterator[str]:
    for name in Configuration.model_fields:
        section = Place(Configuration).below(name)
        meaning = section.meaning[:1].upper() + section.meaning[1:]
        yield f"\n## {name}\n\n{meaning}.\n"
        yield from (_row(_COLUMNS), _row(["---"] * len(_COLUMNS)))
        for place in (section, *section.settings()):
            has_row = not place.fields or KINDS in place.bounds
            if has_row and not _ALIKE.search(place.name):
                others = [f"{RELATIONS[key]} `{other}`" for key, other in place.relations.items()]
                allowed = "; ".join([place.allowed(), *others])
                default = _default(config, place)
                yield _row([f"`{place.name}`", allowed, place.unit, default, place.meaning])


def _default(config: Any, place: Place) -> str:
    """Value in config.yaml, except of what is repeated there, or else the model's own."""
    if place.name in ("campaign", "cases"):
        return "see config.yaml"
    for part in place.name.split("."):
        if not isinstance(config, Mapping) or part not in config:
            required = place.default is PydanticUndefined
            return "required" if required else f"`{json.dumps(place.default)}`"
        config = config[part]
    return f"`{json.dumps(config)}`"


def _row(cells: Sequence[str]) -> str:
    # in code a < is itself; elsewhere it would begin an element
    texts = ["`".join(_outside_code(cell.split("`"))) for cell in cells]
    return f"| {' | '.join(texts)} |"


def _outside_code(parts: Sequence[str]) -> list[str]:
    return [part if number % 2 else part.replace("<", "&lt;") for number, part in enumerate(parts)]


def main() -> int:
    """Print the reference."""
    print(
        text(yaml.safe_load((project_root() / "config.yaml").read_text(encoding="utf-8"))), end=""
    )
    return 0
