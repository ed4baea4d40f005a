"""The kind of a hidden effect: a port, a range of sizes, and the forms its law can take."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple

from numpy.random import Generator

from dea.plant.forces import ForceLaw
from dea.plant.signal_law import SignalLaw

Law = SignalLaw | ForceLaw


class Port(StrEnum):
    """Where a hidden effect acts."""

    INPUT = "input path"
    FORCE = "force balance"
    TIME = "parameter in time"
    OUTPUT = "output path"
    OUTSIDE = "outside"  # anywhere; an effect that a catalogue of common effects does not hold


class Use(StrEnum):
    """Which trials a form may be drawn for."""

    TUNING = "tuning"  # the diagnosis may be improved on it
    REPORTING = "reporting"  # the diagnosis is judged by it, and has never been tuned on it


class TrialSet(NamedTuple):
    """What the forms that a set of trials hides are for, and whether rivals stay open on them."""

    use: Use
    ambiguous: bool


TRIAL_SETS = {
    "tuning": TrialSet(Use.TUNING, ambiguous=False),
    "reporting": TrialSet(Use.REPORTING, ambiguous=False),
    "ambiguous": TrialSet(Use.REPORTING, ambiguous=True),
    "ambiguous_tuning": TrialSet(Use.TUNING, ambiguous=True),
}


class Conditions(NamedTuple):
    """The plain device under the trial's excitation, from which laws take their sizes.

    ``low`` and ``high`` bound the command (V); ``rest``, ``bottom``, ``median`` and ``top`` are
    outputs of the plain device without command and its least, median and largest under the
    excitation, ``stiffness`` is its restoring force over displacement (0 where nothing moves),
    ``duration`` and ``time`` (one over the band of the excitation) in s, ``cycles`` the number of
    swings of at least a tenth of the travel, ``full_cycles`` the same with each as its share of the
    travel, as damage counts them, ``path`` the way travelled, ``rate`` that of the readings in Hz,
    ``power`` the exponent of the command in what drives the device, and ``force`` whether forces
    can act on it.
    """

    low: float
    high: float
    rest: float
    bottom: float
    median: float
    top: float
    stiffness: float
    duration: float
    time: float
    cycles: float
    full_cycles: float
    path: float
    rate: float
    power: float
    force: bool

    @property
    def travel(self) -> float:
        """The range of the output."""
        return self.top - self.bottom

    @property
    def span(self) -> float:
        """The range of the command in V."""
        return self.high - self.low

    @property
    def speed(self) -> float:
        """The mean speed of the motion."""
        return self.path / self.duration

    def device_forces(self, size: float) -> float:
        """Return ``size`` device forces; one is the stiffness times the travel."""
        return size * self.stiffness * self.travel


class Built(NamedTuple):
    """A law, and the values that define it and that a diagnosis may give, in V, s, Hz or output."""

    law: Law
    defining: dict[str, float]


Builder = Callable[[float, Conditions, Generator], Built]


@dataclass(frozen=True)
class Form:
    """One law of an effect.

    Attributes
    ----------
    name, source
        A short name and the publication of the law.
    use
        Which trials it is for.
    build
        Returns the law from size, conditions and a generator that draws the law's shape.
    moving
        Whether it needs a force balance.
    """

    name: str
    source: str
    use: Use
    build: Builder
    moving: bool


@dataclass(frozen=True)
class EffectKind:
    """A kind of effect on a device or its instruments.

    Attributes
    ----------
    name, port
        The engineer's name of the effect, and where it acts.
    smallest, largest
        Range of sizes, searched on a logarithmic scale.
    unit
        Of the size.
    forms
        Its laws.
    """

    name: str
    port: Port
    smallest: float
    largest: float
    unit: str
    forms: tuple[Form, ...]

    def form(self, name: str) -> Form:
        """Return the form of that name."""
        return next(form for form in self.forms if form.name == name)


def tuning(source: str, *, moving: bool = False) -> Callable[[Builder], Form]:
    """Make a builder a form for tuning; its function's name is the form's."""
    return lambda build: Form(build.__name__, source, Use.TUNING, build, moving)


def reporting(source: str, *, moving: bool = False) -> Callable[[Builder], Form]:
    """Make a builder a form for reporting; its function's name is the form's."""
    return lambda build: Form(build.__name__, source, Use.REPORTING, build, moving)


def foreign(form: Form, smallest: float, largest: float, unit: str = "1") -> EffectKind:
    """Return the effect, not of the catalogue, that has this form alone and its name."""
    return EffectKind(form.name, Port.OUTSIDE, smallest, largest, unit, (form,))
