"""The loop: design an excitation, drive it, weigh the hypotheses, diagnose all records, stop."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Protocol

import numpy as np

from dea.discrepancy import (
    Certified,
    Settings,
    Status,
    certify_elsewhere,
    signals_of,
    transferable,
)
from dea.progress import part_of
from dea.resolution.design import Design
from dea.resolution.excitation import Limits
from dea.resolution.knowledge import Inquiry, Knowledge, Options, ResolutionOutcome
from dea.resolution.question import CERTIFICATE, fresh_design, next_design
from dea.resolution.weighing import begun, learnt
from dea.simulation import Simulation, load_simulation

if TYPE_CHECKING:
    import xarray as xr

    from dea.store import Record

_NOWHERE = (
    "no excitation was found for which all explanations predict an output within its range."
    " Raise `resolution.output_margin`, if the device allows a larger range."
)


@dataclass(frozen=True)
class ResolutionRound:
    """A designed record, what it changed, and what was known before and after."""

    number: int
    design: Design
    log_densities: Mapping[str, float]
    before: Knowledge
    after: Knowledge


@dataclass(frozen=True)
class Resolution:
    """How a question was resolved, or how far.

    ``pending`` is the number of the record that is to be made by hand next; the certificate is
    missing where nothing is named, or where it belongs to one record alone. ``halted`` says why a
    record that was still wanted could not be designed.
    """

    first: Knowledge
    rounds: tuple[ResolutionRound, ...]
    outcome: ResolutionOutcome
    certificate: Certified | None = None
    pending: int | None = None
    halted: str = ""

    @property
    def last(self) -> Knowledge:
        """What is known after all records."""
        return self.rounds[-1].after if self.rounds else self.first


class RecordSource(Protocol):
    """Where excitations are kept and records come from."""

    def design(
        self,
        number: int,
        records: "Sequence[Record | xr.Dataset]",
        make: Callable[[], Design | None],
    ) -> Design | None:
        """Return the design that follows from the records so far: the one kept, or a new one."""

    def record(self, number: int, u: np.ndarray) -> "Record | xr.Dataset | None":
        """Return the record of an excitation; nothing where it is still to be made by hand."""

    def keep(self, found: ResolutionRound) -> None:
        """Keep what a round has found."""


def resolve(
    records: "Sequence[Record | xr.Dataset]",
    simulation: Simulation | str,
    source: RecordSource,
    limits: Limits,
    *,
    settings: Settings | None = None,
    options: Options | None = None,
    workers: int = 1,
) -> Resolution:
    """Drive designed records until one explanation is left, or the budget is spent.

    Everything but the records follows from their order, the settings and the seed, so that a loop
    that was ended goes on where it was: the ``source`` returns the designs and records there are.

    Parameters
    ----------
    records
        Of one device, in the simulation's units, as for :func:`dea.diagnose`.
    simulation
        Of one input; its name, or a Python file, will do.
    source
        Keeps the designs, and gives the record of each.
    limits
        Of the input and of the predicted outputs, in the simulation's units.
    settings
        Of the diagnoses.
    options
        Budget and level of the loop.
    workers
        Threads that candidates are fitted on; the result does not depend on it.

    Returns
    -------
    Resolution
        What was known before, every round, and the outcome; ``pending`` where a record is still to
        be made by hand.

    Raises
    ------
    InputError
        If the simulation has several inputs, as well as for what :func:`dea.diagnose` refuses.
    """
    settings, options = settings or Settings(), options or Options()
    own = simulation if isinstance(simulation, Simulation) else load_simulation(simulation)
    inquiry = Inquiry(own, limits, settings, options, workers)
    known = first = begun(records, inquiry)
    rounds: list[ResolutionRound] = []
    halted = ""
    undecided = (ResolutionOutcome.OPEN, ResolutionOutcome.PART)
    while known.outcome(options.level) in undecided and len(rounds) < options.records:
        if not rounds and known.verdict.status == Status.NONE:
            halted = "Nothing is missing by the first records, so that none is designed"
            break
        number = len(rounds) + 1
        make = partial(next_design, known, inquiry, number)
        design = source.design(number, known.records, make)
        if design is None:
            halted = f"Record {number} is not driven: {_NOWHERE}"
            break
        record = source.record(number, design.u)
        if record is None:
            so_far = known.outcome(options.level)
            return Resolution(first, tuple(rounds), so_far, pending=number)
        with part_of(f"record {number}"):
            after, log_densities = learnt(known, record, inquiry)
        rounds.append(ResolutionRound(number, design, log_densities, known, after))
        source.keep(rounds[-1])
        known = after
    outcome = known.outcome(options.level)
    found = Resolution(first, tuple(rounds), outcome, halted=halted)
    if outcome not in (ResolutionOutcome.DECIDED, ResolutionOutcome.PART) or not rounds:
        return found
    return _certified(found, source, inquiry)


def _certified(found: Resolution, source: RecordSource, inquiry: Inquiry) -> Resolution:
    """Certify on a fresh record, whose excitation was chosen by chance; it can withdraw a name."""
    diagnosis = found.last.diagnosis
    if not transferable(diagnosis.final.extended):
        return found
    make = partial(fresh_design, found.last, inquiry)
    design = source.design(CERTIFICATE, found.last.records, make)
    if design is None:
        return replace(found, halted=f"The name is not certified: {_NOWHERE}")
    record = source.record(CERTIFICATE, design.u)
    if record is None:
        return replace(found, pending=CERTIFICATE)
    other = {"fresh": signals_of(record, inquiry.simulation)}
    certified = certify_elsewhere(other, diagnosis.nominal, diagnosis.final)["fresh"]
    if certified.worse(diagnosis.decision.noise(diagnosis.rules, diagnosis.floor)):
        last = found.rounds[-1]
        after = replace(last.after, withdrawn=ResolutionOutcome.CONTRADICTED)
        rounds = (*found.rounds[:-1], replace(last, after=after))
        source.keep(rounds[-1])
        found = replace(found, rounds=rounds, outcome=ResolutionOutcome.CONTRADICTED)
    return replace(found, certificate=certified)
