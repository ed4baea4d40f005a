"""A designed record for a device that no program drives: what to run, and how to hand it in."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from dea import store
from dea.configuration.case import FRESH, Case, designed, is_designed
from dea.configuration.record import RecordFile
from dea.discrepancy import SAME_INTERVAL
from dea.errors import InputError
from dea.resolution.design import Design
from dea.resolution.excitation import Limits
from dea.resolution.kept import Kept
from dea.resolution.question import CERTIFICATE
from dea.resolution.rounds import Resolution

if TYPE_CHECKING:
    import xarray as xr

# Part of a designed record that must be there, and by which part of its deviation the input may be
# off (root mean square), since it may be measured; and the samples by which it may be late.
_LEAST, _OFF = 0.95, 0.25
_LATE = 2


@dataclass
class ByHand(Kept):
    """A case, whose designed records are made by hand and handed in with the case."""

    further: Path
    case: Case
    case_file: Path

    def check_keys(self) -> None:
        """Check that each designed record of the case has those before it.

        Raises
        ------
        InputError
            For one that no round has asked for, since the rounds before it are missing.
        """
        given = set(filter(is_designed, self.case.records))
        number = 1
        while record_key(number) in given:
            given.remove(record_key(number))
            number += 1
        if number > 1:
            given.discard(record_key(CERTIFICATE))
        if given:
            early = min(given)
            raise InputError(
                f"there is no record {record_key(number)}, which comes before it",
                file=self.case_file,
                field=f"records.{early}",
                remedy=f"Name it {record_key(number)}, if it is the record that was asked for, or"
                " take it out",
            )

    def file(self, number: int) -> Path:
        """Return the file of a record as the workflow has imported it."""
        return self.further / f"{record_key(number)}.nc"

    def recorded(self, number: int) -> bool:
        """Return whether it was handed in."""
        return record_key(number) in self.case.records

    def record(self, number: int, u: np.ndarray) -> "xr.Dataset | None":
        """Return the record of an excitation that was handed in."""
        if not self.recorded(number):
            return None
        found = store.read_record(self.file(number))
        described = self.case.records[record_key(number)]
        if mistake := _mistake(store.signals(found), u, self.limits.sampling_rate, described):
            problem, remedy = mistake
            raise InputError(
                f"its input is not the excitation of {self.folder_of(number) / 'excitation.csv'}"
                + problem,
                file=self.case_file,
                field=f"records.{record_key(number)}",
                remedy=remedy,
            )
        return found

    def finish(self, found: Resolution) -> None:
        """Write what is to be made next, and how to hand it in."""
        pages = [self.folder / "next_excitation.csv", self.folder / "next_experiment.md"]
        if found.pending is None:
            for path in pages:
                path.unlink(missing_ok=True)
            return
        design = self.kept(found.pending)
        self.write_table(pages[0], design.u)
        with store.atomic(pages[1]) as partial:
            partial.write_text(
                experiment_page(
                    self.folder.name, record_key(found.pending), design, self.limits,
                    found.last.posterior.now, found.last.diagnosis.units,
                    others=bool(self.case.records),
                ),
                encoding="utf-8",
            )  # fmt: skip


def experiment_page(
    name: str,
    key: str,
    design: Design,
    limits: Limits,
    probabilities: Mapping[str, float],
    units: tuple[str, str],
    *,
    others: bool,
) -> str:
    """Return the page, in Markdown, that says how to make the record ``key`` of a case.

    ``others`` says whether the case has further records already.
    """
    place = f"`config/cases/{name}.yaml`"
    if others:
        place = f"the `records:` that is in {place}"
    seconds = design.u.size / limits.sampling_rate
    rate = float(np.abs(np.diff(design.u)).max()) * limits.sampling_rate
    told = "The record of `next_excitation.csv` shows how well the one that is left predicts."
    if design.closest:
        first, second = design.closest
        told = (
            "On the excitation in `next_excitation.csv` the two that are hardest to tell apart,"
            f" {first} and {second}, differ by {design.distance:.3g} standard deviations of the"
            " error."
        )
    left = sorted(probabilities.items(), key=lambda item: -item[1])
    lines = [
        f"# Next experiment: {name}, `{key}`",
        "",
        "How probable each explanation of the device is by the records so far:",
        "",
        "| explanation | probability |",
        "|---|---|",
        *(f"| {each} | {value:.3f} |" for each, value in left),
        "",
        told,
        "",
        "## Run it",
        f"* {seconds:g} s at {limits.sampling_rate:g} Hz, {design.u.size} samples, each held until"
        " the next.",
        f"* Input from {design.u.min():.4g} to {design.u.max():.4g} {units[0]}, changing by up to"
        f" {rate:.4g} {units[0]}/s. Before it, let the device rest at the first value.",
        f"* The output is expected between {limits.output_low:.4g} and {limits.output_high:.4g}"
        f" {units[1]}. Stop where it leaves this range.",
        "* Record input and output as in the first record, at the same rate. The rest before it is"
        " no part of the record: leave it out of the file, or name the rows after it (`rows`).",
        "",
        "## Hand it in",
        f"Add the record to {place} under this name, with columns as those of the first one, and"
        " run the same command again:",
        "",
        "```yaml",
        *([] if others else ["records:"]),
        f"  {key}:",
        "    file: data/my_new_record.csv",
        "    time: {column: t, units: s}",
        f"    input: {{column: u, units: {_quoted(units[0])}}}",
        f"    output: {{column: y, units: {_quoted(units[1])}}}",
        "```",
        "",
        "```",
        f"make resolve NAME={name}",
        "```",
    ]
    return "\n".join(lines) + "\n"


def _quoted(units: str) -> str:
    """Return units as text of YAML, which takes `%` for no text and `1` for a number."""
    return json.dumps(units, ensure_ascii=False)


def plays(played: np.ndarray, asked: np.ndarray) -> bool:
    """Return whether an input that was recorded is the one asked for, but for noise and ends."""
    allowed = _OFF * np.std(asked)
    return any(_off(played, asked, shift) <= allowed for shift in range(-_LATE, _LATE + 1))


def _mistake(
    found: store.Record, asked: np.ndarray, rate: float, described: RecordFile
) -> tuple[str, str] | None:
    """Return how the input of a record differs from what was asked for, and what to do.

    ``rate`` is that of the excitation, in Hz; the record is read as ``described``. Nothing where it
    plays the excitation.
    """
    if abs(found.sampling_rate - rate) > SAME_INTERVAL * rate:
        return (
            f": it is sampled at {found.sampling_rate:.8g} Hz, the excitation at {rate:.8g} Hz",
            "Play and record it at that rate; closer samples are averaged by"
            f" `resample: {1.0 / rate:.9g}`",
        )
    if plays(found.u, asked):
        return None
    size = asked.size
    if found.u.size < _LEAST * size:
        return f": it has {found.u.size} of {size} samples", "Play and record all of it"
    if plays(np.nan_to_num(found.y), asked):
        return ": its output is", "Exchange the columns of input and output"
    begin = _begin(found.u, asked)
    if plays(found.u[begin:], asked):
        end = begin + size
        first = described.rows[0] if described.rows else 0
        rows = f"`rows: [{first + begin}, {first + end}]`"
        if described.resample is not None or first < 0:
            rows = f"`rows`, the numbers of its rows from {begin / rate:g} to {end / rate:g} s"
        return (
            f": the excitation begins at its sample {begin}, at {begin / rate:g} s",
            f"Leave out what is before it, as by {rows}",
        )
    played, wanted = found.u[:size], asked[: found.u.size]
    factor, offset = np.polyfit(wanted, played, 1) if np.ptp(wanted) else (1.0, 0.0)
    allowed = _OFF * abs(factor) * np.std(asked)
    if _off(played, factor * wanted + offset, 0) <= allowed:
        plus = f", plus {offset:.3g} {found.u_units}" if abs(offset) > allowed else ""
        return (
            f": it is {factor:.4g} times the excitation{plus}",
            "Play it unscaled, and give the record in the units of the first one",
        )
    return "", "Play that excitation, or name the record otherwise to begin with it"


def _begin(played: np.ndarray, asked: np.ndarray) -> int:
    """Return the sample at which an excitation is likeliest to begin in a longer input."""
    if played.size <= asked.size:
        return 0
    squares = np.correlate(played**2, np.ones(asked.size), "valid")
    return int(np.argmin(squares - 2.0 * np.correlate(played, asked, "valid")))


def _off(played: np.ndarray, asked: np.ndarray, shift: int) -> float:
    """Return the root mean square by which an input is off, if it was played this much late."""
    late, early = played[max(shift, 0) :], asked[max(-shift, 0) :]
    common = min(late.size, early.size)
    if common < _LEAST * asked.size:
        return np.inf
    return float(np.sqrt(np.mean((late[:common] - early[:common]) ** 2)))


def record_key(number: int) -> str:
    """Return the key of a designed record in a case."""
    return designed(FRESH if number == CERTIFICATE else number)
