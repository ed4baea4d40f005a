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

import numpy as np


@dataclass(frozen=True)
class Posterior:
    """Hypotheses by name: probabilities before any designed record, and now; both sum to one."""

    prior: Mapping[str, float]
    now: Mapping[str, float]

    @classmethod
    def of(cls, prior: Mapping[str, float]) -> "Posterior":
        """Return the posterior before any designed record; ``prior`` is normalised."""
        total = sum(prior.values())
        shares = {name: value / total for name, value in prior.items()}
        return cls(shares, shares)

    def after(self, log_densities: Mapping[str, float]) -> "Posterior":
        """Return the posterior after a record to which each hypothesis gave this density."""
        logs = {
            name: np.log(max(value, np.finfo(float).tiny)) + log_densities[name]
            for name, value in self.now.items()
        }
        largest = max(logs.values())
        weights = {name: float(np.exp(value - largest)) for name, value in logs.items()}
        total = sum(weights.values())
        return Posterior(self.prior, {name: value / total for name, value in weights.items()})

    def rejected(self, level: float) -> frozenset[str]:
        """Return the hypotheses that are rejected at this level."""
        return frozenset(name for name in self.now if self.now[name] <= level * self.prior[name])

    def with_new(self, shares: Mapping[str, float], source: str) -> "Posterior":
        """Return it with new hypotheses, which get these shares of what ``source`` has."""
        prior, now = dict(self.prior), dict(self.now)
        for held in (prior, now):
            whole = held[source]
            held |= {name: whole * share for name, share in shares.items()}
            held[source] = whole * (1.0 - sum(shares.values()))
        return Posterior(prior, now)
