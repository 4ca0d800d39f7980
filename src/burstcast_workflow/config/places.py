"""Places in the configuration: what the model knows about the setting at each."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from burstcast_workflow.config.kinds import Words, is_section

_BOUNDS = {"ge": "not below", "gt": "above", "le": "not above", "lt": "below"}
_KINDS = {
    int: "a whole number",
    float: "a number",
    str: "text",
    bool: "true or false",
    NoneType: "null",
}


@dataclass(frozen=True)
class Place:
    """A place in the configuration, with its readable ``name``: ``campaign[0].neurons``.

    The others are its type, the bounds of its values, the arguments of `setting`, and the value
    that it has where a section is given without it (`PydanticUndefined` if it is required).
    """

    kind: Any
    name: str = ""
    bounds: tuple[Any, ...] = ()
    meaning: str = ""
    unit: str = ""
    default: Any = PydanticUndefined
    relations: Mapping[str, str] = field(default_factory=dict)

    @property
    def kinds(self) -> list[Any]:
        """Types that are allowed: of ``number | None`` both."""
        several = get_origin(self.kind) in (Union, UnionType)
        options = get_args(self.kind) if several else [self.kind]
        return [get_args(kind)[0] if get_origin(kind) is Annotated else kind for kind in options]

    @property
    def fields(self) -> dict[str, FieldInfo]:
        """Settings of the section that is here; empty if none is."""
        kind = self.kinds[0]
        return kind.model_fields if is_section(kind) else {}

    def below(self, part: str | int) -> "Place":
        """Find a setting of the section, an item of the list or an entry of the mapping here."""
        name = f"{self.name}.{part}".removeprefix(".")
        kind = self.kinds[0]
        if found := self.fields.get(str(part)):
            known: Any = {"unit": "", **(found.json_schema_extra or {})}  # type: ignore[dict-item]
            known["unit"] = "Lyapunov times" if str(part).endswith("_lt") else known["unit"]
            place = Place(found.annotation, name, tuple(found.metadata), **known)
            meaning = found.description or _said_of(place.kinds[0])
            return replace(place, meaning=meaning, default=found.default)
        if get_origin(kind) not in (list, dict):
            return Place(None, name)
        if get_origin(kind) is list:
            name = f"{self.name}[{part}]"
        return replace(_entry(get_args(kind)[-1]), name=name, meaning=self.meaning, unit=self.unit)

    @property
    def key(self) -> "Place":
        """Allowed keys of the mapping at this place."""
        return _entry(get_args(self.kinds[0])[0])

    def settings(self) -> Iterator["Place"]:
        """All settings below this place, in their order, settings of items of lists included."""
        for key in self.fields:
            yield (place := self.below(key))
            yield from place.settings()
        if get_origin(self.kinds[0]) is list:
            yield from self.below("").settings()

    def allowed(self) -> str:
        """Put into words what is allowed here, without the unit."""
        words = [bound for bound in self.bounds if isinstance(bound, Words)]
        return words[0] if words else " or ".join(map(self._in_words, self.kinds))

    def _in_words(self, kind: Any) -> str:
        if get_origin(kind) is Literal:
            *others, last = get_args(kind)
            return f"{', '.join(others)} or {last}"
        if get_origin(kind) is list:
            least, most = self._bound("min_length"), self._bound("max_length")
            count = f" of {'' if least == most else 'at least '}{least}" if least else ""
            return f"a list{count}, each {_entry(get_args(kind)[0]).allowed()}"
        limits = [f"{words} {self._bound(key)}" for key, words in _BOUNDS.items()]
        limits = [limit for limit in limits if not limit.endswith("None")]
        text = _KINDS.get(kind, "a mapping of settings")
        return f"{text} {' and '.join(limits)}" if limits and kind in (int, float) else text

    def _bound(self, name: str) -> Any:
        return next((getattr(item, name) for item in self.bounds if hasattr(item, name)), None)


def _entry(kind: Any) -> Place:
    """Place of an item of a list, or of an entry or a key of a mapping, from its type."""
    if get_origin(kind) is not Annotated:
        return Place(kind)
    entry, *more = get_args(kind)
    bounds = [item.metadata if isinstance(item, FieldInfo) else [item] for item in more]
    return Place(entry, bounds=tuple(bound for group in bounds for bound in group))


def _said_of(section: type) -> str:
    """Meaning of a section, from its docstring."""
    text = (section.__doc__ or "").rstrip(".")
    return text[:1].lower() + text[1:]
