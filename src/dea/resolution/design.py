"""The excitation that best tells the explanations apart.

For two explanations of equal covariance at the squared distance d² the probability to take one for
the other is bounded by √(π₁ π₂) exp(-d²/8), with probabilities π (Bhattacharyya's bound: Kailath
1967, IEEE Transactions on Communication Technology 15:52). The sum of these over all pairs is the
criterion. It is no bound itself: each rival is refitted with a covariance of its own, and d² is the
smaller of both ways round. Its minimum is that of Atkinson and Fedorov (1975, Biometrika 62:57 and
289), who maximise the distance that refitting the closest rival leaves, for a set of explanations,
each as probable as it is: the closest probable pair dominates the sum.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from itertools import combinations

import numpy as np

from dea.excitation import design as fixed_design
from dea.resolution.distance import Expected, expected, nested, squared_distance
from dea.resolution.excitation import Limits, express, genes
from dea.resolution.explanation import Explanation
from dea.resolution.law_error import LawError

# How hard a design is sought. A limit of time: no measurement of these values is recorded.
# Explanations that are told apart: so many of the most probable ones.
_MOST = 6
# Excitations of a duration that are tried: as many as this many simulated samples allow, within
# bounds; and the part of them that is drawn at random, before the best one is changed.
_WORK, _FEWEST, _MOST_TRIED = 2.5e7, 32, 160
_DRAWN = 0.4
# Genes that a change alters at most, and the deviation of a small change.
_ALTERED, _SMALL = 3, 0.2
# Parts of the longest duration that are tried, the shortest first: time of the device is what the
# budget limits.
_PARTS = (0.25, 0.5, 1.0)
# Factors by which an excitation whose predicted output leaves its range is drawn to the middle.
_SHRINKS = (1.0, 0.8, 0.6, 0.4, 0.2)
# Lines that the band of a short excitation of fixed form holds at least.
_LEAST_LINES = 4.0
# Excitations of fixed form that compete, with times in parts of the duration and bands in parts of
# the sampling rate.
_FIXED: tuple[tuple[str, dict[str, float]], ...] = (
    ("gaussian", {"band": 0.02}),
    ("gaussian", {"band": 0.004}),
    ("bursts", {"band": 0.02, "active": 0.125, "rest": 0.125}),
    ("multisine", {"band": 0.02, "period": 0.25}),
    ("staircase", {"levels": 6, "hold": 0.06, "rest": 0.06}),
    ("binary", {"band": 0.02}),
    ("triangle", {"slowest": 0.16, "fastest": 0.03}),
)


class Forms(StrEnum):
    """Which excitations compete."""

    FREE = "free"
    FIXED = "fixed"
    RANDOM = "random"


@dataclass(frozen=True)
class Design:
    """An excitation (n,) and what is expected of it.

    Parameters
    ----------
    log_bound
        Logarithm of the criterion, which stands for the probability of a wrong answer; larger where
        separation is worse.
    closest
        Names of the two explanations that contribute most to it, and their distance in units of the
        error; none, at an infinite distance, where there is one explanation alone.
    form
        ``free``, or the kind of fixed excitation.
    """

    u: np.ndarray
    log_bound: float
    closest: tuple[str, ...]
    distance: float
    form: str


@dataclass(frozen=True)
class Question:
    """Which explanations are to be told apart, how probable they are, and what may be driven.

    The ``probabilities`` are relative to these explanations, so that they sum to one.
    ``alone`` is the simulation without effects, which says how large the effects are; ``middle``
    is the input to which an excitation is drawn. Where one explanation is left, its name is
    ``tested``: it is to be told apart from each of the others, and these not from each other.
    """

    explanations: Sequence[Explanation]
    probabilities: Sequence[float]
    alone: Explanation
    error: LawError
    limits: Limits
    middle: float
    tested: str = ""

    @cached_property
    def pairs(self) -> list[tuple[int, int]]:
        """Pairs that an excitation can tell apart, the larger explanation first.

        Of nested ones the larger can always imitate the smaller; they count where there are no
        others.
        """
        found = [
            (i, j) if len(a.labels) >= len(b.labels) else (j, i)
            for (i, a), (j, b) in combinations(enumerate(self.explanations), 2)
            if not self.tested or self.tested in (a.name, b.name)
        ]
        apart = [(i, j) for i, j in found if not self._nested(i, j)]
        return apart or found

    def _nested(self, i: int, j: int) -> bool:
        return nested(self.explanations[i], self.explanations[j])

    def affordable(self, duration: float) -> int:
        """Return the number of excitations of this duration to try."""
        simulations = sum(2 + each.mean.size for each in self.explanations)
        samples = simulations * duration * self.limits.sampling_rate
        return int(np.clip(_WORK / samples, _FEWEST, _MOST_TRIED))

    def judged(self, u: np.ndarray, form: str) -> Design | None:
        """Return how well an excitation tells apart; nothing where its output would run away."""
        drawn = self._within(u)
        return None if drawn is None else self._of(drawn, form)

    def _of(self, u: np.ndarray, form: str) -> Design:
        if not self.pairs:
            return Design(u, -np.inf, (), np.inf, form)
        interval = 1.0 / self.limits.sampling_rate
        found = [each.linearised(u, interval) for each in self.explanations]
        without = self.alone.simulated(u, interval)
        error = self.error.on([y for y, _ in found], self.probabilities, without).right
        views = [
            expected(y, J, each.root, error)
            for (y, J), each in zip(found, self.explanations, strict=True)
        ]
        squares = [self._square(views, i, j) for i, j in self.pairs]
        with np.errstate(divide="ignore"):  # an explanation without probability counts nothing
            logs = np.log(self.probabilities)
        terms = [
            0.5 * (logs[i] + logs[j]) - square / 8.0
            for (i, j), square in zip(self.pairs, squares, strict=True)
        ]
        worst = int(np.argmax(terms))
        i, j = self.pairs[worst]
        return Design(
            u,
            float(np.logaddexp.reduce(terms)),
            (self.explanations[i].name, self.explanations[j].name),
            float(np.sqrt(squares[worst])),
            form,
        )

    def _square(self, views: Sequence[Expected], i: int, j: int) -> float:
        forth = squared_distance(views[i], views[j])
        return forth if self._nested(i, j) else min(forth, squared_distance(views[j], views[i]))

    def _within(self, u: np.ndarray) -> np.ndarray | None:
        """Return the excitation, drawn to the middle until every predicted output is in range."""
        interval = 1.0 / self.limits.sampling_rate
        for shrink in _SHRINKS:
            tried = self.middle + shrink * (u - self.middle)
            # Rounding may have left the range.
            tried = np.clip(tried, self.limits.low, self.limits.high)
            if all(self.limits.holds(e.simulated(tried, interval)) for e in self.explanations):
                return tried
        return None


def likeliest(
    explanations: Sequence[Explanation], log_probability: Mapping[str, float]
) -> list[Explanation]:
    """Return the explanations that are worth telling apart, the most probable first."""
    return sorted(explanations, key=lambda e: -log_probability[e.name])[:_MOST]


def designed(
    question: Question,
    durations: tuple[float, float],
    needed: float,
    rng: np.random.Generator,
    forms: Forms = Forms.FREE,
) -> Design | None:
    """Return the shortest excitation that is expected to decide, or the best of all durations.

    Parameters
    ----------
    durations
        The shortest and the longest in s.
    needed
        Value of the criterion that is low enough.

    Returns
    -------
    Design or None
        None where no excitation keeps the predicted outputs in their range.
    """
    shortest, longest = durations
    best: Design | None = None
    for duration in sorted({max(shortest, part * longest) for part in _PARTS}):
        best = _better(best, _of_duration(question, duration, rng, forms))
        if best is not None and best.log_bound <= np.log(needed):
            break
    return best


def _better(first: Design | None, second: Design | None) -> Design | None:
    """Return the design that tells apart better, the first of equals."""
    if first is None or second is None:
        return first or second
    return second if second.log_bound < first.log_bound else first


def _of_duration(
    question: Question, duration: float, rng: np.random.Generator, forms: Forms
) -> Design | None:
    """Return the best of random excitations, of changes of the best one, and of fixed forms."""
    best, best_genes = None, np.empty(0)
    tries = {Forms.FREE: question.affordable(duration), Forms.FIXED: 0, Forms.RANDOM: 1}[forms]
    for number in range(tries):
        if number < _DRAWN * tries or best is None:
            values = rng.random(genes())
        else:
            values = _changed(best_genes, rng)
        tried = question.judged(express(values, duration, question.limits), "free")
        if tried is not None and (best is None or tried.log_bound < best.log_bound):
            best, best_genes = tried, values
    if forms is Forms.RANDOM:
        return best
    for kind, u in fixed_forms(duration, question.limits, int(rng.integers(2**31))):
        best = _better(best, question.judged(u, kind))
    return best


def _changed(values: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return genes of which a few are others, or a little different."""
    result = values.copy()
    chosen = rng.choice(values.size, rng.integers(1, _ALTERED + 1), replace=False)
    small = values[chosen] + _SMALL * rng.standard_normal(chosen.size)
    anew = rng.random(chosen.size)
    result[chosen] = np.clip(small, 0.0, 1.0) if rng.random() < 0.5 else anew
    return result


def _scaled(key: str, value: float, duration: float, limits: Limits) -> float:
    """Return a setting of a fixed form for this duration (s) and the limits' sampling rate."""
    rate = limits.sampling_rate
    if key == "levels":
        return value
    if key == "band":
        return max(value * rate, _LEAST_LINES / duration)
    if key == "period":
        # Whole samples, so that the first line is within the band.
        return float(np.ceil(value * duration * rate)) / rate
    return value * duration


def fixed_forms(duration: float, limits: Limits, seed: int) -> Iterator[tuple[str, np.ndarray]]:
    """Yield the excitations of fixed form, each slowed down to the largest rate."""
    for kind, settings in _FIXED:
        scaled = {key: _scaled(key, value, duration, limits) for key, value in settings.items()}
        u = fixed_design(
            kind, duration=duration, sampling_rate=limits.sampling_rate,
            low=limits.low, high=limits.high, seed=seed, **scaled,
        )  # fmt: skip
        yield kind, limits.obeyed(u)
