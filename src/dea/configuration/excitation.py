"""The voltages an actuator is driven with: ``excitation`` of config/config.yaml."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self, get_args

from pydantic import Field, model_validator

from dea.configuration.problems import validated
from dea.configuration.section import (
    LONGEST,
    Duration,
    NotNegative,
    Number,
    Positive,
    Section,
    Whole,
    key,
    refuse,
)
from dea.errors import InputError

RECORD, PROBED = "record", "probed"  # names of excitations; the second is the first with probing
PASSAGE = 1.0  # s, from an excitation to a probing stretch and back


def is_whole(period: float) -> bool:
    """Tell whether a period, in samples, is a whole number of them."""
    return abs(period - round(period)) <= 1e-6 * period


class Sequence(Section):
    """What every kind of excitation has."""

    duration: Duration = key("length of the record", unit="s")
    low: Number = key("lowest voltage, before the amplifier", unit="V")
    high: Number = key("highest voltage, before the amplifier", unit="V")

    @model_validator(mode="after")
    def _range(self) -> Self:
        if not self.low < self.high:
            raise refuse(
                "low", f"{self.low:g} is not below high, {self.high:g}", "Make low the smaller one."
            )
        return self


def _refuse_without_period(band: float, duration: float) -> None:
    if band * duration < 1.0:
        raise refuse(
            "band",
            f"{band:g} Hz has no period in the {duration:g} s of the record",
            "Raise it, or record longer.",
        )


class Gaussian(Sequence):
    """Gaussian noise with a flat spectrum up to ``band``."""

    kind: Literal["gaussian"] = key("Gaussian noise")
    band: Positive = key("highest frequency", unit="Hz", default=1.0)

    @model_validator(mode="after")
    def _period(self) -> Self:
        _refuse_without_period(self.band, self.duration)
        return self


class Bursts(Sequence):
    """Gaussian noise in bursts with rests at ``low`` between them."""

    kind: Literal["bursts"] = key("bursts of Gaussian noise")
    band: Positive = key("highest frequency of the noise", unit="Hz", default=1.0)
    active: Duration = key("length of a burst", unit="s", default=20.0)
    rest: NotNegative = key("length of a rest", unit="s", default=10.0, le=LONGEST)

    @model_validator(mode="after")
    def _period(self) -> Self:
        _refuse_without_period(self.band, self.duration)
        return self


class Multisine(Sequence):
    """Equal sines at the multiples of 1/``period`` up to ``band``, with random phases."""

    kind: Literal["multisine"] = key("sum of sines")
    band: Positive = key("highest frequency", unit="Hz", default=1.0)
    period: Duration = key("time after which it repeats", unit="s", default=30.0)

    @model_validator(mode="after")
    def _period(self) -> Self:
        if self.period > self.duration:
            raise refuse(
                "period",
                f"{self.period:g} s is longer than the duration of {self.duration:g} s",
                "Shorten the period, or record longer.",
            )
        if self.band * self.period < 1.0 - 1e-9:
            raise refuse(
                "band",
                f"{self.band:g} Hz is below the first line, {1.0 / self.period:g} Hz",
                "Raise the band, or lengthen the period.",
            )
        return self


class Staircase(Sequence):
    """Equally spaced levels in random order, each held, with a rest at ``low`` between them."""

    kind: Literal["staircase"] = key("levels in random order")
    levels: Whole = key("number of levels", default=6, ge=2)
    hold: Duration = key("time at each level", unit="s", default=10.0)
    rest: NotNegative = key("time at rest between levels", unit="s", default=10.0, le=LONGEST)
    rise: Duration = key("length of a step's edge", unit="s", default=0.5)

    @model_validator(mode="after")
    def _edges(self) -> Self:
        for name, time in (("hold", self.hold), ("rest", self.rest)):
            if 0.0 < time < self.rise:
                raise refuse(
                    "rise",
                    f"{self.rise:g} s is longer than {name}, {time:g} s, so that no level is"
                    " reached",
                    f"Shorten it, or lengthen {name}.",
                )
        return self


class Binary(Sequence):
    """A filtered random binary sequence."""

    kind: Literal["binary"] = key("random switching between low and high")
    band: Positive = key("twice the highest rate of switching", unit="Hz", default=1.0)

    @model_validator(mode="after")
    def _period(self) -> Self:
        _refuse_without_period(self.band, self.duration)
        return self


class Triangle(Sequence):
    """Triangles between ``low`` and random peaks, at three rates."""

    kind: Literal["triangle"] = key("triangles of random height and rate")
    slowest: Duration = key("longest full-range period", unit="s", default=20.0)
    fastest: Duration = key("shortest full-range period", unit="s", default=4.0)

    @model_validator(mode="after")
    def _periods(self) -> Self:
        if self.fastest > self.slowest:
            raise refuse(
                "fastest",
                f"{self.fastest:g} s is longer than slowest, {self.slowest:g} s",
                "Make fastest the shorter one.",
            )
        return self


_Kinds = Gaussian | Bursts | Multisine | Staircase | Binary | Triangle
Kind = Annotated[_Kinds, Field(discriminator="kind")]


class Probing(Section):
    """Odd random-phase multisines at chosen times, which measure the response without a model."""

    times: Annotated[list[NotNegative], Field(min_length=1)] = key(
        "where the stretches of multisines begin", unit="s"
    )
    bias: Number = key("mean of the multisines, before the amplifier", unit="V")
    rms: Positive = key("root mean square of the multisines about it", unit="V")
    lowest: Positive = key("first line; its inverse is the period", unit="Hz")
    highest: Positive = key("last line", unit="Hz")
    band: Positive = key("frequency above which lines have a third of the amplitude", unit="Hz")
    realisations: Whole = key("multisines of other phases in a stretch", ge=2)
    periods: Whole = key("whole periods of each", ge=2)
    settle: Number = key("time that each plays before its whole periods", unit="s", ge=PASSAGE)

    @property
    def duration(self) -> float:
        """Length of a stretch in s, with the passage back to the excitation."""
        return self.realisations * (self.settle + self.periods / self.lowest) + PASSAGE

    @model_validator(mode="after")
    def _lines(self) -> Self:
        if not self.lowest <= self.band <= self.highest:
            raise refuse(
                "band",
                f"{self.band:g} Hz is not between {self.lowest:g} and {self.highest:g} Hz",
                "Give lowest, band and highest in ascending order.",
            )
        return self


class Excitation(Section):
    """The voltages played, before the amplifier; ``kind`` says which further keys there are."""

    record: Kind = key("of the study's record")
    second: Kind = key("of a second record, on which conclusions from the first are certified")
    probing: Probing | None = key(
        "put into the record's excitation in a further run, which confirms frequency responses",
        default=None,
    )


def checked_excitation(content: Mapping[str, Any]) -> dict[str, Any]:
    """Return one excitation, whose ``kind`` is known, its numbers no longer text.

    Raises
    ------
    InputError
        Naming the key and the remedy.
    """
    kinds: dict[str, type[Sequence]] = {
        get_args(kind.model_fields["kind"].annotation)[0]: kind for kind in get_args(_Kinds)
    }
    return validated(kinds[content["kind"]], content).model_dump(exclude_unset=True)


def sections(excitations: Mapping[str, Any], name: str) -> dict[str, Any]:
    """Return the sections that shape the excitation ``name``, from those of the config.

    Raises
    ------
    InputError
        If it is the probed one and the config does not say how.
    """
    if name == PROBED:
        if "probing" not in excitations:
            raise InputError(
                "it is not given",
                file="config/config.yaml",
                field="excitation.probing",
                remedy="Say there which multisines are to be played, and when.",
            )
        return {"excitation": excitations[RECORD], "probing": excitations["probing"]}
    return {"excitation": excitations[name]}
