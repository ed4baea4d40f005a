"""How much is spent on the search."""

from dataclasses import dataclass, replace

from dea.discrepancy.rules import at_least, require_numbers
from dea.errors import InputError
from dea.simulation import SLOTS


@dataclass(frozen=True)
class Budget:
    """How far the search goes, the same for every candidate of a round.

    Decisions 35 (``restarted``), 37 (what a long record gets), 41 (``decimated``) and 58
    (``exchange_misfit``) say what these rest on. Of the other values no measurement is recorded:
    they share out the time of a diagnosis.

    Parameters
    ----------
    starts
        Starts of the fit of the nominal simulation.
    finished
        Candidates of a round that are fitted to the end; the rest are only screened.
    beam
        Best candidates that the next round extends; of single effects also the best that acts at
        another port than these.
    effects
        Effects attached at most.
    room, long_room
        Part of the gap that the best set must leave for larger ones to be tried, if it is more than
        :attr:`Rules.further`; the same for a long record, where trying them takes minutes.
    offered
        Effects that are screened beside another one: those that promise most by a linear step.
    kept
        Fits of one effect that go on after the screening, at least; a short record affords more.
    screening
        Steps of each fit of the screening.
    first_steps, last_steps
        Steps that every finished candidate gets, and that those near the leader get in addition.
    tolerance
        Part of the cost by which a step of a finished candidate must lower it for another one.
    near
        A candidate is near the leader if its error is within this factor of the leader's.
    shakes
        Perturbed starts from which the best single effects are fitted again.
    shake_above, shake_size
        Residual, in noise floors, above which they are, and the deviation of the perturbation of
        the law's parameters, in prior spreads.
    exchanges
        Times that one effect of the best pair is exchanged for another. Without any, the
        partners of the best pair are not extended either.
    exchange_above, exchange_misfit
        A pair is exchanged if it leaves more than this many noise floors, but no more than this
        part of the best single effect's misfit: one of its effects may stand for another. The
        partners of the best pairs are extended whatever noise floors they leave.
    exchange_gain
        Part of the best pair's error that an exchange may leave at most for another one to follow.
    restarted
        Leading candidates that are fitted once more, with the simulation's parameters at their
        prior means, if they are near the leader and it leaves more than ``exchange_above`` floors.
    decimated
        A record of at least twice as many samples is decimated to no fewer, where it is sampled
        much faster than it moves, and than the simulation takes steps.
    long_record
        A record of more samples gets half of ``starts``, ``finished``, ``beam``, ``kept`` and
        ``restarted``, one shake, no exchange, and ``long_room``. If it is sampled much faster than
        it moves, it gets all of the finished candidates and twice the last steps, otherwise half of
        the screening and ten times the tolerance.
    """

    starts: int = at_least(1, 4)
    finished: int = at_least(1, 6)
    beam: int = at_least(1, 2)
    effects: int = 2
    room: float = 0.0
    long_room: float = 0.12
    offered: int = at_least(1, 8)
    kept: int = at_least(1, 2)
    screening: int = at_least(1, 4)
    first_steps: int = at_least(1, 6)
    last_steps: int = at_least(1, 20)
    tolerance: float = 1e-4
    near: float = at_least(1, 2.5)
    shakes: int = 4
    shake_above: float = 1.15
    shake_size: float = 0.5
    exchanges: int = 3
    exchange_above: float = 1.05
    exchange_misfit: float = 0.8
    exchange_gain: float = 0.9
    restarted: int = 8
    decimated: int = at_least(1, 5_000)
    long_record: int = at_least(1, 30_000)

    def __post_init__(self) -> None:
        require_numbers(self)
        if not 1 <= self.effects <= SLOTS:
            raise InputError(f"it is {self.effects}", field="effects", remedy=f"Give 1 to {SLOTS}")

    def of(self, samples: int, oversampled: bool) -> "Budget":
        """Return the budget for so many samples, which may be many more than the motion needs."""
        if samples <= self.long_record:
            return self

        def half(count: int) -> int:
            return max(1, count // 2)

        halved = replace(
            self,
            starts=half(self.starts),
            finished=half(self.finished),
            beam=half(self.beam),
            kept=half(self.kept),
            shakes=min(1, self.shakes),
            restarted=self.restarted // 2,
            exchanges=0,
            room=self.long_room,
        )
        if oversampled:
            return replace(halved, finished=self.finished, last_steps=2 * self.last_steps)
        return replace(halved, screening=half(self.screening), tolerance=10.0 * self.tolerance)
