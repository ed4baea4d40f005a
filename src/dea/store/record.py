"""The arrays of a record of a system's input and output, and what they are called."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from dea.errors import InputError
from dea.given_numbers import is_positive
from dea.inputs import input_count

_ROUNDING = 1e-6  # of a sample, by which a time may miss it
# Factor that the sum of squares keeps below overflow, for models whose terms are multiples of it.
_ROOM = 1e6

Text = str | tuple[str, ...]


class Record(NamedTuple):
    """A record of a system: its signals, shape (samples,), their rate, units and names.

    Several inputs are the columns of ``u``, shape (samples, inputs); ``u_units`` and ``u_name``
    then hold one text for each. Where a sample is not good ``y`` is NaN; ``u`` is known throughout.
    Built from a file by :meth:`read`, from arrays by :meth:`of`.
    """

    time: np.ndarray
    u: np.ndarray
    y: np.ndarray
    sampling_rate: float
    u_units: Text
    y_units: str
    u_name: Text
    y_name: str

    @property
    def u_names(self) -> tuple[str, ...]:
        """The name of every input."""
        return each_text(self.u_name)

    @property
    def inputs(self) -> list[tuple[str, str]]:
        """Name and units of every input."""
        return list(zip(self.u_names, each_text(self.u_units), strict=True))

    def unit_of_one_input(self, purpose: str) -> str:
        """Return the units of the only input, for a ``purpose`` that knows no several.

        Raises
        ------
        InputError
            If the record has several inputs.
        """
        if not isinstance(self.u_units, str):
            raise InputError(
                f"{purpose} is of records with one input, and this one has {len(self.u_names)}",
                field="input",
                remedy="Take a record whose other inputs are constant, and name one input",
            )
        return self.u_units

    @classmethod
    def of(
        cls,
        u: Any,
        y: Any,
        sampling_rate: float,
        *,
        units: tuple[Text | Sequence[str], str] | None = None,
        names: tuple[Text | Sequence[str], str] | None = None,
    ) -> "Record":
        """Return the record of two signals.

        Parameters
        ----------
        u, y
            Input and output: arrays, columns of a pandas frame, or variables of xarray, whose
            ``units`` and names are taken over. A missing output is NaN. Several inputs are the
            columns of ``u``, an array of shape (samples, inputs) or a pandas frame.
        sampling_rate
            In Hz.
        units, names
            Of input and output, in place of what the signals carry; nothing is converted. Of
            several inputs one text for all or one for each.

        Raises
        ------
        InputError
            If the signals differ in length, the input has a missing value, an output is infinite, a
            value is too large to square, the rate is not positive, or units or names are no pair.
        """
        inputs, outputs = (real_numbers(each, name) for each, name in ((u, "u"), (y, "y")))
        if inputs.ndim == 2 and inputs.shape[1] == 1:
            inputs = inputs[:, 0]
        if (
            inputs.ndim not in (1, 2)
            or outputs.ndim != 1
            or len(inputs) != outputs.size
            or outputs.size < 2
        ):
            raise InputError(
                f"input and output have shapes {inputs.shape} and {outputs.shape}",
                field="u, y",
                remedy="Give two signals of one length, of two samples at least, each with one"
                " dimension; several inputs are the columns of u",
            )
        if not np.isfinite(inputs).all():
            raise InputError(
                "the input has missing values", field="u", remedy="Fill them: it is applied, known"
            )
        if np.isinf(outputs).any():
            raise InputError(
                f"sample {np.flatnonzero(np.isinf(outputs))[0]} is infinite",
                field="y",
                remedy="Give NaN where it stands for a missing value",
            )
        for signal, name in ((inputs, "u"), (outputs, "y")):
            require_squares(signal, name)
        if not is_positive(sampling_rate):
            raise InputError(
                f"it is {sampling_rate!r}", field="sampling_rate", remedy="Give a number in Hz"
            )
        carried = [getattr(each, "attrs", {}) for each in (u, y)]
        own = [getattr(each, "name", None) for each in (u, y)]
        of_inputs, y_units = _of_both(units, "units", "V", "mm") or [
            str(each.get("units", "1")) for each in carried
        ]
        called, y_name = _of_both(names, "names", "voltage", "displacement") or [
            str(attributes.get("long_name", name or role))
            for attributes, name, role in zip(carried, own, ("input", "output"), strict=True)
        ]
        number = input_count(inputs)
        if names is None and (number > 1 or hasattr(u, "columns")):
            called = list(map(str, getattr(u, "columns", input_names(number))))
        u_units, u_name = _for_each(of_inputs, number, "units"), _called(called, number)
        rate = float(sampling_rate)
        time = np.arange(outputs.size) / rate
        return cls(time, inputs, outputs, rate, u_units, y_units, u_name, y_name)

    @classmethod
    def read(cls, path: str | Path, **columns: Any) -> "Record":
        """Return the record of a file; parameters are those of :func:`dea.read_record`."""
        from dea.store.record_file import read_record
        from dea.store.records import signals

        return signals(read_record(path, **columns))

    def part(self, first: float, last: float = np.inf) -> "Record":
        """Return the samples from ``first`` to before ``last``, both in s, or to the end.

        A time that is that of a sample but for rounding, to a millionth of a sample, counts as it.

        Raises
        ------
        InputError
            If there are none, or the record ends before ``last``.
        """
        rounding = _ROUNDING / self.sampling_rate
        begin, end = np.searchsorted(self.time, [first - rounding, last - rounding])
        if end <= begin:
            raise InputError(
                f"no sample lies from {first:g} to before {last:g} s; the record goes from"
                f" {self.time[0]:g} to {self.time[-1]:g} s",
                field="first, last",
                remedy="Give two times inside the record, the earlier one first",
            )
        over = self.time[-1] + 1.5 / self.sampling_rate
        if over < last < np.inf:
            raise InputError(
                f"the record ends at {self.time[-1]:g} s, before {last:g} s",
                field="last",
                remedy="Give a time inside the record, or none for its end",
            )
        return self._replace(time=self.time[begin:end], u=self.u[begin:end], y=self.y[begin:end])

    @property
    def left_out(self) -> int:
        """Number of samples that are not good."""
        return int(np.count_nonzero(np.isnan(self.y)))


def each_text(text: Text) -> tuple[str, ...]:
    """Return the text of every input, whether of one or of several."""
    return (text,) if isinstance(text, str) else text


def input_names(count: int) -> list[str]:
    """Return what inputs without names of their own are called."""
    return [f"input {k}" for k in range(1, count + 1)]


def real_numbers(signal: Any, field: str) -> np.ndarray:
    """Return a signal as an array of real numbers, masked values as missing ones.

    Raises
    ------
    InputError
        Where it is complex, holds none or one too large, or is a whole record.
    """
    if isinstance(signal, Record):
        raise InputError(
            "it is a dea.Record",
            field=field,
            remedy="Give its signals, record.u and record.y",
        )
    values = np.ma.asarray(signal)
    if np.iscomplexobj(values):
        raise InputError("it is complex", field=field, remedy="Give its real part")
    try:
        return np.asarray(np.ma.filled(values.astype(float), np.nan))
    except OverflowError as error:
        raise InputError(
            "it holds an integer that is too large to compute with",
            field=field,
            remedy="Give it in larger units; where it stands for a missing value, give NaN",
        ) from error
    except (TypeError, ValueError) as error:
        raise InputError(
            f"it holds no numbers: {error}", field=field, remedy="Give an array of numbers"
        ) from error


def require_squares(values: np.ndarray, name: str, file: Path | None = None) -> None:
    """Refuse numbers whose squares have a sum that overflows; those not finite are no numbers.

    Raises
    ------
    InputError
        Naming the first sample at fault.
    """
    top = np.sqrt(np.finfo(float).max / max(values.size, 1)) / _ROOM
    large = np.argwhere(np.isfinite(values) & (np.abs(values) > top))
    if large.size:
        raise InputError(
            f"sample {large[0, 0]} is {values[tuple(large[0])]:.4g}, too large to compute with",
            file=file,
            field=name,
            remedy="Give it in larger units; where it stands for a missing value, leave it empty",
        )


def _of_both(given: Any, field: str, *example: str) -> Any:
    """Return texts of input and output where they are given, checked to be a pair."""
    if given is not None and (isinstance(given, str) or len(given) != 2):
        raise InputError(
            f"it is {given!r}", field=field, remedy=f"Give a pair, of input and output: {example}"
        )
    return given


def _for_each(text: Text | Sequence[str], count: int, field: str) -> Text:
    """Return a text for every one of so many inputs, of one input the text itself."""
    texts = (text,) * count if isinstance(text, str) else tuple(map(str, text))
    if len(texts) != count:
        raise InputError(
            f"there are {len(texts)} for {count} inputs", field=field, remedy="Give one for each"
        )
    return texts if count > 1 else texts[0]


def _called(names: Text | Sequence[str], count: int) -> Text:
    """Return the names of so many inputs, each its own."""
    called = _for_each(names, count, "names")
    if len(set(each_text(called))) < count:
        raise InputError(
            f"they are {called}", field="names", remedy="Give each input a name of its own"
        )
    return called
