"""What the sections of all files are made of: strict keys, numbers with ranges and units."""

from copy import copy
from typing import Annotated, Any, Protocol, runtime_checkable

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    create_model,
)
from pydantic.config import JsonDict
from pydantic_core import PydanticCustomError


@runtime_checkable
class SupportsItem(Protocol):
    """A number of NumPy, which this room does not import."""

    def item(self) -> int | float:
        """Return it as a number of Python."""


class Section(BaseModel):
    """Keys and values of a file: an unknown key or another type is refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


def key(description: str, *, unit: str = "", **constraints: Any) -> Any:
    """Declare a key of a section; ``constraints`` are those of :func:`pydantic.Field`."""
    extra: JsonDict | None = {"unit": unit} if unit else None
    return Field(description=description, json_schema_extra=extra, **constraints)


def refuse(place: str, problem: str, remedy: str) -> PydanticCustomError:
    """Return the error of a validator: ``place`` is the dotted key below the validated value."""
    context = {"place": place, "problem": problem, "remedy": remedy}
    return PydanticCustomError("relation", "{problem}", context)


def partial(section: Any) -> Any:
    """Return a model of any of the keys of ``section``, without what they must agree on."""
    fields: dict[str, Any] = {}
    for name, declared in section.model_fields.items():
        field = copy(declared)
        field.default = None
        fields[name] = (declared.annotation, field)
    return create_model(f"Some{section.__name__}", __base__=Section, **fields)


def _from_text(value: Any) -> Any:
    """Return the number that a text is, or a number of NumPy.

    Snakemake hands over nested numbers of its command line as text, and YAML reads 1e-5 as text.
    """
    if isinstance(value, SupportsItem):
        return value.item()
    if isinstance(value, str):
        for kind in (int, float):
            try:
                return kind(value)
            except ValueError:
                continue
    return value


def _as_written(value: Any, check: ValidatorFunctionWrapHandler) -> Any:
    """Keep a whole number whole: datasets hold the settings as they were written."""
    number = _from_text(value)
    check(number)
    return number


def _truth_from_text(value: Any) -> Any:
    return {"true": True, "false": False}.get(value, value) if isinstance(value, str) else value


def _ascending(interval: list[float]) -> list[float]:
    if not interval[0] < interval[1]:
        low, high = interval
        wrong = f"both ends are {low:g}" if low == high else f"{low:g} and {high:g} cross"
        raise refuse("", wrong, "Give the lower one first: [low, high].")
    return interval


def _different(values: list[Any]) -> list[Any]:
    if len(set(values)) < len(values):
        raise refuse("", f"{values} names one value twice", "Give each value once.")
    return values


# Validators stand behind the ranges, which then show in the JSON schema.
_WRITTEN, _TEXT = WrapValidator(_as_written), BeforeValidator(_from_text)
NumberOrInfinity = Annotated[float, _WRITTEN]
Number = Annotated[float, Field(allow_inf_nan=False), _WRITTEN]
Positive = Annotated[float, Field(allow_inf_nan=False, gt=0), _WRITTEN]
NotNegative = Annotated[float, Field(allow_inf_nan=False, ge=0), _WRITTEN]
Share = Annotated[float, Field(allow_inf_nan=False, gt=0, le=1), _WRITTEN]
Part = Annotated[float, Field(allow_inf_nan=False, ge=0, le=1), _WRITTEN]
Whole = Annotated[int, _TEXT]
WholeNotNegative = Annotated[int, Field(ge=0), _TEXT]
LONGEST = 2e6  # s, three weeks; at 50 Hz, as many samples as an excitation may have
Duration = Annotated[float, Field(allow_inf_nan=False, gt=0, le=LONGEST), _WRITTEN]
Count = Annotated[int, Field(ge=1), _TEXT]
Truth = Annotated[bool, BeforeValidator(_truth_from_text)]
NAME = "^[A-Za-z0-9_-]+$"
Name = Annotated[str, Field(pattern=NAME)]
Interval = Annotated[list[Number], Field(min_length=2, max_length=2), AfterValidator(_ascending)]
Different = AfterValidator(_different)
