"""What a model knows of the signals that it is of: their rate, units and names."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike

from dea.arrays import Array
from dea.errors import InputError
from dea.given_numbers import is_positive
from dea.inputs import input_count
from dea.missing import stretches
from dea.narx.checks import as_pair
from dea.store import Record, Text, each_text, input_names, real_numbers

Signals = ArrayLike | Sequence[ArrayLike]

# Part by which the rate of a record may differ from the model's: a clock may be off by as much.
_RATES_APART = 1e-3


@dataclass(frozen=True)
class Labels:
    """Rate in Hz, None where it is not known, units and names of input and output.

    Those of several inputs are tuples, as in :class:`dea.Record`.
    """

    sampling_rate: float | None = None
    u_units: Text = "1"
    y_units: str = "1"
    u_name: Text = "input"
    y_name: str = "output"

    @property
    def inputs(self) -> list[tuple[str, str]]:
        """Name and units of each input."""
        return list(zip(each_text(self.u_name), each_text(self.u_units), strict=True))

    @classmethod
    def of(cls, record: Record) -> "Labels":
        """Return those of a record."""
        return cls(**{name: getattr(record, name) for name in cls.__dataclass_fields__})

    @classmethod
    def of_columns(cls, u: ArrayLike) -> "Labels":
        """Return the names of a frame's columns, nothing where they are no texts or one twice."""
        columns = list(getattr(u, "columns", ()))
        if not all(isinstance(name, str) for name in columns) or len(set(columns)) < len(columns):
            return cls()
        if len(columns) > 1:
            return cls(u_units=("1",) * len(columns), u_name=tuple(columns))
        return cls(u_name=columns[0]) if columns else cls()

    @classmethod
    def from_attributes(cls, attributes: Mapping[str, Any]) -> "Labels":
        """Return those that a dataset carries as attributes, defaults in place of others."""
        found: dict[str, Any] = {
            name: tuple(value) if np.ndim(value) else value
            for name, value in attributes.items()
            if name in cls.__dataclass_fields__
        }
        if found.get("sampling_rate") is not None:
            found["sampling_rate"] = float(found["sampling_rate"])
        return cls(**found)

    def refuse_other(self, record: "Labels") -> None:
        """Refuse a record of another rate, in other units or of inputs in another order.

        Nothing is known of signals without a rate.

        Raises
        ------
        InputError
            Naming the field and what it is of both.
        """
        own, other = self.sampling_rate, record.sampling_rate
        if own is None or other is None:
            return
        if not _same_rate(other, own):
            raise _unlike("sampling_rate", f"{other:g} Hz", f"{own:g} Hz")
        units, others = ((*each_text(of.u_units), of.y_units) for of in (self, record))
        if units != others:
            raise _unlike("units", ", ".join(others), ", ".join(units))
        names, called = (each_text(of.u_name) for of in (self, record))
        if names != called and sorted(names) == sorted(called):
            raise _unlike("names", ", ".join(called), ", ".join(names))

    def names_columns_of(self, u: Any) -> bool:
        """Return whether signals are frames whose columns have the names of these inputs."""
        if records_in(u) is not None:
            return False
        columns = getattr(listed(u)[0], "columns", ())
        return sorted(map(str, columns)) == sorted(each_text(self.u_name))

    def in_order(self, u: ArrayLike) -> ArrayLike:
        """Return signals, the columns of a frame in the order of the inputs that they name.

        Columns without names are taken as they come, and all others where the inputs have none.

        Raises
        ------
        InputError
            If as many columns name other inputs.
        """
        names, columns = list(each_text(self.u_name)), list(getattr(u, "columns", ()))
        named = all(isinstance(name, str) for name in columns)
        if not named or not len(names) == len(columns) > 1:
            return u
        if set(columns) != set(names):
            if names == input_names(len(names)):
                return u
            raise _unlike("names", ", ".join(columns), ", ".join(names))
        found: Array = real_numbers(u, "u")[:, [columns.index(name) for name in names]]
        return found


def rate_of(labels: Labels, given: float | None) -> float:
    """Return the sampling rate in Hz: the one given, or the model's own.

    Raises
    ------
    InputError
        If there is neither, or both and they differ, or the rate is not positive.
    """
    own = labels.sampling_rate
    rate = own if given is None else given
    if rate is not None:
        check_rate(rate)
    if own is not None and rate is not None and not _same_rate(rate, own):
        raise InputError(
            f"it is {rate:g} Hz, and the model is of {own:g} Hz",
            field="sampling_rate",
            remedy="Leave it out, or select a model from a record of that rate",
        )
    if rate is None:
        raise InputError(
            "the model does not know its sampling rate",
            field="sampling_rate",
            remedy="Give it in Hz, or select the model from a dea.Record, which carries it.",
        )
    return rate


def check_rate(sampling_rate: float) -> None:
    """Refuse a sampling rate that is not a positive number."""
    if not is_positive(sampling_rate):
        raise InputError(
            f"it is {sampling_rate!r}",
            field="sampling_rate",
            remedy="Give a positive number in Hz.",
        )


def _same_rate(one: float, other: float) -> bool:
    return abs(one / other - 1.0) <= _RATES_APART


def unpacked(
    u: Any, y: Any, lag: int, terms: int, model: Labels | None = None
) -> tuple[Any, Any, Labels]:
    """Return inputs, outputs and labels, whether ``u`` is signals or one or several records.

    The stretches between missing samples of records become records of their own. The columns of
    frames come in the order of the first one's, or in that of the ``model`` they are for.

    Raises
    ------
    InputError
        If records differ in rate or units, or from the model's, or hold no stretch long enough for
        the lags; if frames name other inputs.
    """
    records = records_in(u)
    if records is None:
        if y is None:
            raise InputError("there is no output", field="y", remedy="Give it, or a dea.Record")
        signals = listed(u)
        labels = Labels.of_columns(signals[0]) if model is None else model
        ordered = [labels.in_order(each) for each in signals]
        return (ordered if len(ordered) > 1 else ordered[0]), y, labels
    _refuse_second_output(y)
    labels = Labels.of(records[0])
    for each in records[1:]:
        if not _agree(Labels.of(each), labels):
            raise InputError(
                f"{Labels.of(each)} beside {labels}",
                field="u",
                remedy="Give records of one rate, in the same units, of the same signals",
            )
    if model is not None:
        model.refuse_other(labels)
    inputs: list[Array] = []
    outputs: list[Array] = []
    for each in records:
        for good in stretches(np.isfinite(each.y), slice(0, each.y.size), lag, terms):
            inputs.append(each.u[good])
            outputs.append(each.y[good])
    return inputs, outputs, labels


def _agree(one: Labels, other: Labels) -> bool:
    """Whether two records may share a model: their rates as far as clocks agree."""
    rate, wanted = one.sampling_rate, other.sampling_rate
    if rate is not None and wanted is not None and _same_rate(rate, wanted):
        one = replace(one, sampling_rate=wanted)
    return one == other


def pair(labels: Labels, u: Any, y: Any, given: int) -> tuple[Array, Array]:
    """Return input and output, whether as two signals or as one record; NaN where missing.

    They may be constant. ``given`` is how many samples a run begins with.

    Raises
    ------
    InputError
        If a record has another rate or other units than the model, whose ``labels`` are given, or
        its inputs in another order; if there are not more than ``given`` samples.
    """
    if isinstance(u, Record):
        _refuse_second_output(y)
        y = u.y
    if y is None:
        raise InputError("there is no output", field="y", remedy="Give it, or a dea.Record")
    return as_pair(input_of(labels, u), y, given, missing=True)


def input_of(labels: Labels, u: Any) -> ArrayLike:
    """Return the input of signals or of a record for a model with these ``labels``.

    Raises
    ------
    InputError
        If a record has another rate or other units than the model; if the inputs of a record are
        in another order, or a frame names others.
    """
    if isinstance(u, Record):
        labels.refuse_other(Labels.of(u))
        return u.u
    return labels.in_order(u)


def _refuse_second_output(y: Any) -> None:
    if y is not None:
        raise InputError(
            "it is given beside a dea.Record, which holds its own",
            field="y",
            remedy="Leave it out, or give input and output as arrays.",
        )


def _unlike(field: str, record: str, model: str) -> InputError:
    return InputError(
        f"the record has {record}, the model {model}",
        field=field,
        remedy="Convert the record, or select a model from one like it",
    )


def records_in(u: Any) -> list[Record] | None:
    """Return the records where ``u`` is one or several, None where it is signals.

    Raises
    ------
    InputError
        If some are records and others are not.
    """
    if isinstance(u, Record):
        return [u]
    kinds = [isinstance(each, Record) for each in u] if isinstance(u, Sequence) else []
    if not any(kinds):
        return None
    if not all(kinds):
        at = kinds.index(False)
        raise InputError(
            f"record {at + 1} is {type(u[at]).__name__}",
            field="u",
            remedy="Give a dea.Record of each, or lists of inputs and of outputs",
        )
    return list(u)


def listed(signals: Signals) -> list[ArrayLike]:
    """Return the signals of each record.

    Several records come as a list or tuple of arrays; one as an array or a list of numbers.
    """
    if isinstance(signals, list | tuple) and signals and np.ndim(signals[0]) > 0:
        return list(signals)
    return [signals]  # type: ignore[list-item]


def inputs_in(u: Signals | Record | Sequence[Record]) -> int:
    """Return how many inputs one or several records have, by the first."""
    records = records_in(u)
    return input_count(records[0].u if records else listed(cast(Signals, u))[0])
