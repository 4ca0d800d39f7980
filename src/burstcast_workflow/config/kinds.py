"""Building blocks of settings: kinds of values, and sections.

Pydantic finds what is wrong with a value. Where its message does not say what to do, `Must` has
another one.
"""

import math
import os
import posixpath
import re
from collections.abc import Callable, Mapping
from functools import partial
from typing import Annotated, Any, Literal, TypeVar

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, ValidationError
from pydantic_core import PydanticCustomError, core_schema

from burstcast.base.names import LABEL, NEURONS, ROLE, SEED, VALIDATION
from burstcast.control.strategies.registry import available_strategies as control_strategies
from burstcast.data.encoders.registry import available_encoders
from burstcast.data.times import time_step_of
from burstcast.networks.validation_strategies.registry import available_strategies
from burstcast_workflow.harness.canonical import canonical

T = TypeVar("T")
S = TypeVar("S", bound="Section")


class Must:
    """Allowed values in words, which replace all messages of pydantic about the value."""

    def __init__(self, words: str) -> None:
        self.words = words

    def _check(self, value: Any, validate: Callable[[Any], Any]) -> Any:
        try:
            return validate(value)
        except (ValidationError, ValueError, TypeError):
            raise wrong(f"must be {self.words}") from None

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        return core_schema.no_info_wrap_validator_function(self._check, handler(source))

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> Any:
        return {**handler(schema), "allowed": self.words}


def wrong(text: str) -> PydanticCustomError:
    """A mistake in a setting, with a message of its own."""
    return PydanticCustomError("wrong", text)


_LARGEST = 2**64
_LONGEST_PART, _LONGEST_PATH = 255, 3000  # bytes; the files below it have names, too
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")


def _number(value: Any) -> Any:
    """Read numbers that are given as text: 1e-6 is text in YAML 1.1."""
    if not isinstance(value, str) or not _NUMBER.fullmatch(value):
        return value
    return int(value) if value.lstrip("+-").isdigit() else float(value)


def _whole(value: Any) -> Any:
    """Take 3.0 for the whole number that it is."""
    value = _number(value)
    if isinstance(value, int | float) and abs(value) >= _LARGEST:
        raise wrong("no setting takes a number as large as this")
    return int(value) if isinstance(value, float) and value.is_integer() else value


def _distinct(values: list[T]) -> list[T]:
    for index, value in enumerate(values):
        if value in values[:index]:
            raise wrong(f"has {value} twice")
    return values


def _rising(ends: list[float]) -> list[float]:
    if not ends[0] < ends[1]:
        raise wrong("the first number must be below the second")
    return ends


def _name(what: str, names: list[str], pattern: str = "") -> Any:
    """Type of names in a list, or of names that match the pattern of a user's own classes."""

    def check(name: str) -> str:
        if name not in names and not (pattern and re.search(pattern, name)):
            raise ValueError
        return name

    further = ", or <module>:<class> of your own" if pattern else ""
    return Annotated[str, AfterValidator(check), Must(f"{what}: {', '.join(names)}{further}")]


def _named(path: str) -> str:
    if posixpath.basename(posixpath.normpath(path)) in ("", ".", ".."):
        raise wrong("results need a directory of their own, such as results/mine")
    if os.path.isfile(path):
        raise wrong("this is a file: results need a directory")
    whole = os.fsencode(path)
    if len(whole) > _LONGEST_PATH or max(map(len, whole.split(b"/"))) > _LONGEST_PART:
        raise wrong(f"a path has at most {_LONGEST_PATH} bytes, and {_LONGEST_PART} in each part")
    # POSIX keeps two slashes at the beginning, which Snakemake does not
    return posixpath.normpath(re.sub("^//+", "/", path))


def _time_step(value: Any) -> Any:
    if value is not None and (isinstance(value, bool) or not 0 < time_step_of(value)[0] < math.inf):
        raise ValueError
    return value


_OWN_CLASS = r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*:[A-Za-z_]\w*"
_PAIR = Field(min_length=2, max_length=2)
_RESERVED = "nan|NaN|inf|Inf|infinity|Infinity|true|True|false|False|tables|figures|logs|benchmarks"

Number = Annotated[float, BeforeValidator(_number)]
Whole = Annotated[int, BeforeValidator(_whole)]
Count = Annotated[Whole, Field(ge=1)]
Size = Annotated[Whole, Field(ge=2, le=100_000)]
Positive = Annotated[Number, Field(gt=0)]
TimeStep = Annotated[
    float | str | None,
    BeforeValidator(_time_step),
    Must("a number above 0, or, where times are dates, one with a unit: 5 minutes, 1 day"),
]
EventShare = Annotated[
    Annotated[Number, Field(gt=0, lt=1)] | Literal["all"], Must("a number between 0 and 1, or all")
]
Distinct = Annotated[list[T], AfterValidator(_distinct)]
Some = Annotated[list[T], Field(min_length=1), AfterValidator(_distinct)]
# lists in which the order means nothing: results do not depend on it
Rising = Annotated[Distinct[T], AfterValidator(sorted)]
SomeRising = Annotated[Some[T], AfterValidator(sorted)]
SomeFalling = Annotated[Some[T], AfterValidator(partial(sorted, reverse=True))]
Range = Annotated[
    list[Number], _PAIR, Must("[low, high], two rising numbers"), AfterValidator(_rising)
]
PositiveRange = Annotated[
    list[Positive], _PAIR, Must("[low, high], two rising numbers above 0"), AfterValidator(_rising)
]
Strategy = _name("a validation strategy", available_strategies())
EncoderName = _name("an encoder", available_encoders(), rf"^{_OWN_CLASS}\Z")
ControlStrategyName = _name("a strategy of control", control_strategies())
NetworkOrNull = Annotated[
    Annotated[str, Field(pattern=rf"^esn-{NEURONS}-{VALIDATION}-{SEED}\Z")] | None,
    Must("the name of a network of kind esn, no variant, such as esn-N2000-RV-seed0, or null"),
]
StrategyValue = Annotated[
    float | bool | str | list[Number],
    BeforeValidator(_number),
    Must("a number, true or false, text, or a list of numbers"),
]
CaseName = Annotated[
    str,
    Field(pattern=rf"^(?!(?:{_RESERVED}|report)\Z)[A-Za-z][A-Za-z0-9_.-]{{,99}}\Z"),
    Must(
        "a letter, then at most 99 letters, digits, _, - and . (not tables, figures, logs, "
        "benchmarks or report, nor what reads as a number or truth value)"
    ),
]
Label = Annotated[
    str,
    Field(pattern=rf"^(?!(?:{ROLE}|{SEED})\Z){LABEL}\Z", max_length=50),
    Must(
        "a lower-case letter, then lower-case letters and digits, at most 50 in all (not "
        "committee, random, seed1)"
    ),
]
ParameterName = Annotated[
    str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*\Z"), Must("the name of a parameter of the system")
]
OwnClass = Annotated[str, Field(pattern=rf"^{_OWN_CLASS}\Z"), Must("<module>:<class> of your own")]
SystemName = Annotated[
    str,
    Field(pattern=rf"^(?:[a-z][a-z0-9_]*|{_OWN_CLASS})\Z"),
    Must("mfe, another module of burstcast.systems, or <module>:<class> of your own"),
]
Directory = Annotated[
    str,
    Field(pattern=r"^(?!~)[^\s{}*?\x00-\x1f](?:[^{}*?\x00-\x1f]*[^\s{}*?\x00-\x1f])?\Z"),
    Must(
        "the path of a directory, without braces, *, ?, control characters, a leading ~ or spaces "
        "around it"
    ),
    AfterValidator(_named),
]


class Section(BaseModel):
    """Settings under one name; the docstring of a section describes it in docs/settings.md."""

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

    quantile: Annotated[float, Field(gt=0, lt=1)]


Threshold = Annotated[
    Number | Quantile, Must("a finite number, or {quantile: <a number between 0 and 1>}")
]


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


RELATIONS = {
    "below": "must be below",
    "at_most": "must be at most",
    "at_least": "must be at least",
    "not_beyond": "must not be beyond",
    "multiple_of": "must be a multiple of",
    "one_of": "must be one of",
    "within": "must be within",
}
"""Relations between settings: names of arguments of `setting`, in words."""
