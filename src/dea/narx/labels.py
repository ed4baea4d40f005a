"""What a model knows of the signals that it is of: their rate, units and names."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dea.errors import InputError
from dea.missing import stretches
from dea.narx.checks import Array, as_record
from dea.store import Record


@dataclass(frozen=True)
class Labels:
    """Rate in Hz, None where it is not known, units and names of input and output."""

    sampling_rate: float | None = None
    u_units: str = "1"
    y_units: str = "1"
    u_name: str = "input"
    y_name: str = "output"

    @classmethod
    def of(cls, record: Record) -> "Labels":
        """Return those of a record."""
        return cls(**{name: getattr(record, name) for name in cls.__dataclass_fields__})

    @classmethod
    def from_attributes(cls, attributes: Mapping[str, Any]) -> "Labels":
        """Return those that a dataset carries as attributes, defaults in place of others."""
        return cls(**{k: attributes[k] for k in cls.__dataclass_fields__ if k in attributes})


def rate_of(labels: Labels, given: float | None) -> float:
    """Return the sampling rate in Hz: the one given, or the model's own.

    Raises
    ------
    InputError
        If there is neither.
    """
    rate = labels.sampling_rate if given is None else given
    if rate is None:
        raise InputError(
            "the model does not know its sampling rate",
            field="sampling_rate",
            remedy="Give it in Hz, or select the model from a dea.Record, which carries it.",
        )
    return rate


def unpacked(u: Any, y: Any, lag: int, terms: int) -> tuple[Any, Any, Labels]:
    """Return inputs, outputs and labels, whether ``u`` is signals or one or several records.

    The stretches between missing samples of records become records of their own.

    Raises
    ------
    InputError
        If records differ in rate or units, or hold no stretch long enough for the lags.
    """
    records = [u] if isinstance(u, Record) else u if _are_records(u) else None
    if records is None:
        if y is None:
            raise InputError("there is no output", field="y", remedy="Give it, or a dea.Record")
        return u, y, Labels()
    labels = Labels.of(records[0])
    for each in records[1:]:
        if Labels.of(each) != labels:
            raise InputError(
                f"{Labels.of(each)} beside {labels}",
                field="u",
                remedy="Give records of one rate, in the same units, of the same signals",
            )
    inputs: list[Array] = []
    outputs: list[Array] = []
    for each in records:
        for good in stretches(np.isfinite(each.y), slice(0, each.y.size), lag, terms):
            inputs.append(each.u[good])
            outputs.append(each.y[good])
    return inputs, outputs, labels


def pair(u: Any, y: Any, samples: int) -> tuple[Array, Array]:
    """Return input and output, whether as two signals or as one record; NaN where missing."""
    if isinstance(u, Record):
        u, y = u.u, u.y
    if y is None:
        raise InputError("there is no output", field="y", remedy="Give it, or a dea.Record")
    inputs, outputs = as_record(u, y, samples, missing=True)
    return inputs, outputs


def _are_records(u: Any) -> bool:
    return isinstance(u, Sequence) and bool(u) and all(isinstance(each, Record) for each in u)
