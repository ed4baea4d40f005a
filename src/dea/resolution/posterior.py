"""How probable each hypothesis is, and when one may be rejected, whenever that is asked.

A hypothesis h has the probability π(h) when it is offered, and w(h) after some records, each of
which it had predicted with a density p(y | h, what came before). Under h the ratio π(h) / w(h),
which is the mean over all hypotheses of their densities' ratios to that of h, is a martingale with
mean one. It reaches 1/α at any time with a probability of α at most (Ville 1939; Howard, Ramdas,
McAuliffe and Sekhon 2020, Probability Surveys 17:257). Rejecting h when w(h) ≤ α π(h) therefore
rejects the right hypothesis with a probability of α at most, however many records are made, and
however each is designed from those before it.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dea.errors import InputError


@dataclass(frozen=True)
class Posterior:
    """Hypotheses by name: logarithms of their probabilities when they were offered, and now.

    Logarithms keep probabilities that would be rounded to zero.
    """

    log_offered: Mapping[str, float]
    log_now: Mapping[str, float]

    @classmethod
    def of(cls, prior: Mapping[str, float]) -> "Posterior":
        """Return the posterior before any designed record; ``prior`` is normalised."""
        total = sum(prior.values())
        shares = _logarithms({name: value / total for name, value in prior.items()})
        return cls(shares, shares)

    @cached_property
    def now(self) -> dict[str, float]:
        """The probabilities now, which sum to one."""
        return {name: float(np.exp(value)) for name, value in self.log_now.items()}

    def after(self, log_densities: Mapping[str, float]) -> "Posterior":
        """Return the posterior after a record to which each hypothesis gave this density.

        Raises
        ------
        InputError
            If no hypothesis has one.
        """
        logs = {name: value + log_densities[name] for name, value in self.log_now.items()}
        total = float(np.logaddexp.reduce(list(logs.values())))
        if not np.isfinite(total):
            raise InputError(
                "no explanation gives the designed record a finite density",
                field="record",
                remedy="Look at its samples; where they are right, give the simulation narrower"
                " priors, so that it does not run away",
            )
        return Posterior(self.log_offered, {name: value - total for name, value in logs.items()})

    def rejected(self, level: float) -> frozenset[str]:
        """Return the hypotheses that are rejected at this level."""
        return frozenset(
            name
            for name, value in self.log_now.items()
            if value <= self.log_offered[name] + np.log(level)
        )

    def left(self, level: float) -> frozenset[str]:
        """Return the hypotheses that are not rejected at this level."""
        return frozenset(self.log_now) - self.rejected(level)

    def with_new(self, shares: Mapping[str, float], source: str) -> "Posterior":
        """Return it with new hypotheses, which get these shares of what ``source`` has.

        A new one is judged by later records alone: nothing has counted for it or against it yet.
        """
        left = float(np.log1p(-sum(shares.values())))
        new = {name: part + self.log_now[source] for name, part in _logarithms(shares).items()}
        offered = {source: self.log_offered[source] + left, **new}
        now = {source: self.log_now[source] + left, **new}
        return Posterior({**self.log_offered, **offered}, {**self.log_now, **now})


def _logarithms(values: Mapping[str, float]) -> dict[str, float]:
    with np.errstate(divide="ignore"):
        return {name: float(np.log(value)) for name, value in values.items()}
