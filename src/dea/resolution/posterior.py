"""How probable each hypothesis is, and when one may be rejected, whenever that is asked.

A hypothesis h has the prior probability π(h), and w(h) after some records, each of which it had
predicted with a density p(y | h, what came before). Under h the ratio π(h) / w(h), which is the
mean over all hypotheses of their densities' ratios to that of h, is a martingale with mean one.
It reaches 1/α at any time with a probability of α at most (Ville 1939; Howard, Ramdas, McAuliffe
and Sekhon 2020, Probability Surveys 17:257). Rejecting h when w(h) ≤ α π(h) therefore rejects the
right hypothesis with a probability of α at most, however many records are made, and however each
is designed from those before it.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dea.errors import InputError


@dataclass(frozen=True)
class Posterior:
    """Hypotheses by name: probabilities before any designed record, and logarithms of those now.

    Logarithms keep probabilities that would be rounded to zero.
    """

    prior: Mapping[str, float]
    log_now: Mapping[str, float]

    @classmethod
    def of(cls, prior: Mapping[str, float]) -> "Posterior":
        """Return the posterior before any designed record; ``prior`` is normalised."""
        total = sum(prior.values())
        shares = {name: value / total for name, value in prior.items()}
        return cls(shares, _logarithms(shares))

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
        return Posterior(self.prior, {name: value - total for name, value in logs.items()})

    def rejected(self, level: float) -> frozenset[str]:
        """Return the hypotheses that are rejected at this level."""
        bounds = _logarithms({name: level * self.prior[name] for name in self.log_now})
        return frozenset(name for name, value in self.log_now.items() if value <= bounds[name])

    def left(self, level: float) -> frozenset[str]:
        """Return the hypotheses that are not rejected at this level."""
        return frozenset(self.log_now) - self.rejected(level)

    def with_new(self, shares: Mapping[str, float], source: str) -> "Posterior":
        """Return it with new hypotheses, which get these shares of what ``source`` has."""
        parts = {**shares, source: 1.0 - sum(shares.values())}
        prior = {name: part * self.prior[source] for name, part in parts.items()}
        logs = {name: part + self.log_now[source] for name, part in _logarithms(parts).items()}
        return Posterior({**self.prior, **prior}, {**self.log_now, **logs})


def _logarithms(values: Mapping[str, float]) -> dict[str, float]:
    with np.errstate(divide="ignore"):
        return {name: float(np.log(value)) for name, value in values.items()}
