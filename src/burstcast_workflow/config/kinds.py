"""Building blocks of settings: kinds of values, and sections."""

import math
import os
import posixpath
import re
from collections.abc import Callable, Mapping
from copy import copy
from functools import cache, partial
from types import UnionType
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    create_model,
)
from pydantic_core import PydanticCustomError

from burstcast.control.strategies.registry import available_strategies as control_strategies
from burstcast.data.times import time_step_of
from burstcast.encoders.registry import available_encoders
from burstcast.forecasters._names import LABEL, NEURONS, ROLE, SEED, VALIDATION
from burstcast.tuning.strategies.registry import available_strategies
from burstcast_workflow.harness.canonical import canonical

T = TypeVar("T")
S = TypeVar("S", bound="Section")


class Words(str):
    """Allowed values in words, where these are clearer than type and bounds."""


def _whole(value: Any) -> Any:
    """Take 3.0 for the whole number that it is."""
    return int(value) if isinstance(value, float) and value.is_integer() else value


def _distinct(values: list[T]) -> list[T]:
    for index, value in enumerate(values):
        if value in values[:index]:
            raise PydanticCustomError("between", f"has {value} twice")
    return values


def _rising(ends: list[float]) -> list[float]:
    if not ends[0] < ends[1]:
        text = f"is {[_whole(end) for end in ends]}; the first number must be below the second"
        raise PydanticCustomError("between", text)
    return ends


def _threshold(value: Any) -> Any:
    if isinstance(value, Quantile):
        return value
    number = value.get("quantile") if isinstance(value, dict) else value
    known = not isinstance(value, dict) or list(value) == ["quantile"]
    if not known or not isinstance(number, int | float) or isinstance(number, bool):
        shown = f"the text {value!r}" if isinstance(value, str) else f"{value}"
        raise PydanticCustomError("between", f"is {shown}; it must be {_THRESHOLD}")
    if not abs(number) < math.inf:
        raise PydanticCustomError("between", f"is {number}; it must be a finite number")
    if isinstance(value, dict) and not 0 < number < 1:
        text = f"is the quantile {number}; a quantile lies between 0 and 1"
        raise PydanticCustomError("between", text)
    return Quantile(quantile=number) if isinstance(value, dict) else value


def _among(several: str, names: list[str], own: str = "") -> AfterValidator:
    """Check of a name: one of several, or of what has the pattern of one's own."""

    def check(name: str) -> str:
        if name not in names and not (own and re.search(own, name)):
            further = "; <module>:<class> of your own" if own else ""
            text = f"is {name}; the {several} are {', '.join(names)}{further}"
            raise PydanticCustomError("between", text)
        return name

    return AfterValidator(check)


def _named(path: str) -> str:
    if posixpath.basename(posixpath.normpath(path)) in ("", ".", ".."):
        text = f"is {path}: results need a directory of their own, such as results/mine"
        raise PydanticCustomError("between", text)
    if os.path.isfile(path):
        text = f"is {path}, which is a file: results need a directory"
        raise PydanticCustomError("between", text)
    # POSIX keeps two slashes at the beginning, which Snakemake does not
    return posixpath.normpath(re.sub("^//+", "/", path))


def _time_step(value: Any) -> Any:
    try:
        if isinstance(value, bool) or not 0 < time_step_of(value)[0] < math.inf:
            raise ValueError
    except (ValueError, TypeError):
        shown = f"the text {value!r}" if isinstance(value, str) else f"{value}"
        text = f"is {shown}; it must be {_TIME_STEP}"
        raise PydanticCustomError("between", text) from None
    return value


_TIME_STEP = "a number above 0, or, where times are dates, one with a unit: 5 minutes, 1 day"
_THRESHOLD = "a number, or {quantile: <a number between 0 and 1>}"
_PAIR = Field(min_length=2, max_length=2)
_OWN_CLASS = r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*:[A-Za-z_]\w*"
_RESERVED = "nan|NaN|inf|Inf|infinity|Infinity|true|True|false|False|tables|figures|logs|benchmarks"

Whole = Annotated[int, BeforeValidator(_whole)]
Count = Annotated[Whole, Field(ge=1)]
Size = Annotated[Whole, Field(ge=2, le=100_000)]
Positive = Annotated[float, Field(gt=0)]
TimeStep = Annotated[
    Positive | str | None,
    BeforeValidator(lambda value: value if value is None else _time_step(value)),
    Words(_TIME_STEP),
]
CountOrNull = Annotated[Count | None, Words("a whole number above 0, or null")]
PositiveOrNull = Annotated[Positive | None, Words("a number above 0, or null")]
EventShare = Annotated[
    Annotated[float, Field(gt=0, lt=1)] | Literal["all"], Words("a number between 0 and 1, or all")
]
Distinct = Annotated[list[T], AfterValidator(_distinct)]
Some = Annotated[list[T], Field(min_length=1), AfterValidator(_distinct)]
# lists in which the order means nothing: results do not depend on it
Rising = Annotated[Distinct[T], AfterValidator(sorted)]
SomeRising = Annotated[Some[T], AfterValidator(sorted)]
SomeFalling = Annotated[Some[T], AfterValidator(partial(sorted, reverse=True))]
Range = Annotated[
    list[float], _PAIR, Words("[low, high], two rising numbers"), AfterValidator(_rising)
]
PositiveRange = Annotated[
    list[Positive], _PAIR, Words("[low, high], two rising numbers above 0"), AfterValidator(_rising)
]
Strategy = Annotated[
    str,
    _among("validation strategies", available_strategies()),
    Words(f"a validation strategy: {', '.join(available_strategies())}"),
]
EncoderName = Annotated[
    str,
    _among("encoders", available_encoders(), rf"^{_OWN_CLASS}\Z"),
    Words(f"an encoder: {', '.join(available_encoders())}, or <module>:<class> of your own"),
]
ControlStrategyName = Annotated[
    str,
    _among("strategies of control", control_strategies()),
    Words(f"a strategy of control: {', '.join(control_strategies())}"),
]
NetworkOrNull = Annotated[
    Annotated[str, Field(pattern=rf"^esn-{NEURONS}-{VALIDATION}-{SEED}\Z")] | None,
    Words("the name of a network of kind esn, no variant, such as esn-N2000-RV-seed0, or null"),
]
StrategyValue = Annotated[
    float | bool | str | list[float],
    Words("a number, true or false, text, or a list of numbers"),
]
CaseName = Annotated[
    str,
    Field(pattern=rf"^(?!(?:{_RESERVED}|report)\Z)[A-Za-z][A-Za-z0-9_.-]*\Z"),
    Words(
        "a letter, then letters, digits, _, - and . (not tables, figures, logs, benchmarks or "
        "report, nor what reads as a number or truth value)"
    ),
]
Label = Annotated[
    str,
    Field(pattern=rf"^(?!(?:{ROLE}|{SEED})\Z){LABEL}\Z"),
    Words("a lower-case letter, then lower-case letters and digits (not committee, random, seed1)"),
]
ParameterName = Annotated[
    str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*\Z"), Words("the name of a parameter of the system")
]
OwnClass = Annotated[str, Field(pattern=rf"^{_OWN_CLASS}\Z"), Words("<module>:<class> of your own")]
SystemName = Annotated[
    str,
    Field(pattern=rf"^(?:[a-z][a-z0-9_]*|{_OWN_CLASS})\Z"),
    Words("mfe, another module of burstcast.systems, or <module>:<class> of your own"),
]
Directory = Annotated[
    str,
    Field(pattern=r"^(?!~)[^\s{}*?](?:[^{}*?]*[^\s{}*?])?\Z"),
    AfterValidator(_named),
    Words("the path of a directory, without braces, *, ?, a leading ~ or spaces around it"),
]


class Section(BaseModel):
    """Settings under one name; the docstring of a section describes it in messages."""

    model_config = ConfigDict(
        strict=True,
        extra="forbid",
        allow_inf_nan=False,
        regex_engine="python-re",
        defer_build=True,  # only the outermost one validates
    )

    def dump(self) -> dict[str, Any]:
        """All settings with their defaults, in canonical form."""
        plain: dict[str, Any] = canonical(self.model_dump())
        return plain


def with_defaults(values: Mapping[str, Any]) -> Callable[[type[S]], type[S]]:
    """A decorator of a section whose settings have these defaults, one for each."""

    def given(section: type[S]) -> type[S]:
        for name, field in section.model_fields.items():
            field.default = canonical(values[name])
        return section

    return given


class Quantile(Section):
    """An event threshold as the share of the training series' values that are below it."""

    quantile: float


Threshold = Annotated[float | Quantile, BeforeValidator(_threshold), Words(_THRESHOLD)]


class Part(Section):
    """A part of a section."""

    def dump(self) -> dict[str, Any]:
        """Explicitly given settings, in canonical form."""
        plain: dict[str, Any] = canonical(self.model_dump(exclude_unset=True))
        return plain


@cache
def part_of(section: type[S]) -> type[S]:
    """A section with the same settings, any of which may be left out: it is laid over another.

    Settings that are left out have their default, or are null.
    """
    fields: dict[str, Any] = {}
    for name, known in section.model_fields.items():
        field = copy(known)
        if field.is_required():
            field.default = None
        fields[name] = (_part_of(known.annotation), field)
    name, words = section.__name__, section.__doc__
    part: Any = create_model(name, __base__=(Part, section), __doc__=words, **fields)
    return part  # type: ignore[no-any-return]


def _part_of(kind: Any) -> Any:
    if get_origin(kind) is UnionType or get_origin(kind) is Union:
        return Union[tuple(map(_part_of, get_args(kind)))]  # noqa: UP007
    return part_of(kind) if is_section(kind) and kind is not Quantile else kind


# relations between settings: names of arguments of `setting`, in words
RELATIONS = {
    "below": "must be below",
    "at_most": "must be at most",
    "at_least": "must be at least",
    "not_beyond": "must not be beyond",
    "multiple_of": "must be a multiple of",
    "one_of": "must be one of",
    "within": "must be within",
}


def setting(meaning: str, unit: str = "", **bounds: Any) -> Any:
    """Describe a setting: its meaning, its unit, and bounds beyond the bounds of its type.

    A bound of `RELATIONS` names another setting (or a product of them, ``a * b``): from the root of
    the configuration, and in a case from the root of the case. Names that end in ``_lt``
    tell their unit.
    """
    relations = {key: bounds.pop(key) for key in RELATIONS if key in bounds}
    extra: dict[str, Any] = {"unit": unit, "relations": relations}
    return Field(description=meaning, json_schema_extra=extra, **bounds)


def optional(meaning: str, unit: str = "", **bounds: Any) -> Any:
    """Describe a setting (`setting`) that is null where it is left out."""
    return setting(meaning, unit, default=None, **bounds)


def is_section(kind: Any) -> bool:
    """Whether a type is a section of settings."""
    return isinstance(kind, type) and issubclass(kind, Section)
