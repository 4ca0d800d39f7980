"""What settings are made of: kinds of values, and sections of settings."""

import math
import posixpath
from typing import Annotated, Any, TypeVar

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field
from pydantic_core import PydanticCustomError

from burstcast.control.strategies.registry import available_strategies as control_strategies
from burstcast.tuning.strategies.registry import available_strategies

T = TypeVar("T")


class Words(str):
    """What is allowed, in words, where they are clearer than those made from type and bounds."""


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
    number = value.get("quantile") if isinstance(value, dict) else value
    known = not isinstance(value, dict) or list(value) == ["quantile"]
    if not known or not isinstance(number, int | float) or isinstance(number, bool):
        shown = f"the text {value!r}" if isinstance(value, str) else f"{value}"
        raise PydanticCustomError("between", f"is {shown}; it must be {_THRESHOLD}")
    if not math.isfinite(number):
        raise PydanticCustomError("between", f"is {number}; it must be a finite number")
    if isinstance(value, dict) and not 0 < number < 1:
        text = f"is the quantile {number}; a quantile lies between 0 and 1"
        raise PydanticCustomError("between", text)
    return value


def _among(several: str, names: list[str]) -> AfterValidator:
    def check(name: str) -> str:
        if name not in names:
            text = f"is {name}; the {several} are {', '.join(names)}"
            raise PydanticCustomError("between", text)
        return name

    return AfterValidator(check)


def _named(path: str) -> str:
    if posixpath.basename(posixpath.normpath(path)) in ("", ".", ".."):
        text = f"is {path}: results need a directory of their own, such as results/mine"
        raise PydanticCustomError("between", text)
    return path


_THRESHOLD = "a number, or {quantile: <a number between 0 and 1>}"
_PAIR = Field(min_length=2, max_length=2)
_RESERVED = "nan|NaN|inf|Inf|infinity|Infinity|true|True|false|False|tables|figures|logs|benchmarks"

Whole = Annotated[int, BeforeValidator(_whole)]
Count = Annotated[Whole, Field(ge=1)]
Size = Annotated[Whole, Field(ge=2, le=100_000)]
Positive = Annotated[float, Field(gt=0)]
CountOrNull = Annotated[Count | None, Words("a whole number above 0, or null")]
PositiveOrNull = Annotated[Positive | None, Words("a number above 0, or null")]
Distinct = Annotated[list[T], AfterValidator(_distinct)]
Some = Annotated[list[T], Field(min_length=1), AfterValidator(_distinct)]
Range = Annotated[
    list[float], _PAIR, Words("[low, high], two rising numbers"), AfterValidator(_rising)
]
PositiveRange = Annotated[
    list[Positive], _PAIR, Words("[low, high], two rising numbers above 0"), AfterValidator(_rising)
]
Threshold = Annotated[Any, AfterValidator(_threshold), Words(_THRESHOLD)]
Strategy = Annotated[
    str,
    _among("validation strategies", available_strategies()),
    Words(f"a validation strategy: {', '.join(available_strategies())}"),
]
ControlStrategyName = Annotated[
    str,
    _among("strategies of control", control_strategies()),
    Words(f"a strategy of control: {', '.join(control_strategies())}"),
]
NetworkName = Annotated[
    str,
    Field(pattern=r"^esn-N\d+-[A-Z]+-seed\d+\Z"),
    Words("the name of a network, such as esn-N2000-RV-seed0"),
]
CaseName = Annotated[
    str,
    Field(pattern=rf"^(?!(?:{_RESERVED}|report)\Z)[A-Za-z][A-Za-z0-9_.-]*\Z"),
    Words(
        "a letter, then letters, digits, _, - and . (not tables, figures, logs, benchmarks or "
        "report, nor what reads as a number or truth value)"
    ),
]
ParameterName = Annotated[
    str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*\Z"), Words("the name of a parameter of the system")
]
SystemName = Annotated[
    str,
    Field(pattern=r"^(?:[a-z][a-z0-9_]*|[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*:[A-Za-z_]\w*)\Z"),
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


# what can be asked of a setting relative to another: names of arguments of `setting`, in words
RELATIONS = {
    "below": "must be below",
    "at_most": "must be at most",
    "not_beyond": "must not be beyond",
    "multiple_of": "must be a multiple of",
    "one_of": "must be one of",
}


def setting(meaning: str, unit: str = "", when: str = "", **bounds: Any) -> Any:
    """Describe a setting: its meaning, its unit, and bounds beyond those of its type.

    A bound of `RELATIONS` names another setting (or a product of them, ``a * b``): from the root of
    the configuration, and in a case from the root of the case. If ``when`` names one, too, these
    bounds only hold where it is not empty. Names that end in ``_lt`` tell their unit.
    """
    relations = {key: bounds.pop(key) for key in RELATIONS if key in bounds}
    extra: dict[str, Any] = {"unit": unit, "when": when, "relations": relations}
    return Field(description=meaning, json_schema_extra=extra, **bounds)


def is_section(kind: Any) -> bool:
    """Whether a type is a section of settings."""
    return isinstance(kind, type) and issubclass(kind, Section)
