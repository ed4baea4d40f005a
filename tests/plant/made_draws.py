"""A generator whose every draw is known, and the uneven conditions that forms are built for."""

import numpy as np
from made_conditions import CONDITIONS

from dea.plant.film import SUBSTEP
from dea.plant.hidden import EFFECTS

# No two lengths, times or forces are equal, and none is 1.
UNEVEN = CONDITIONS._replace(
    low=0.7, high=3.9, rest=0.4, bottom=1.3, median=5.1, top=9.8, stiffness=2.3, duration=4.0,
    time=0.35, cycles=24.0, full_cycles=15.0, path=400.0, power=2.0,
)  # fmt: skip
SHARES = (0.0, 0.3, 1.0)


class Draws:
    """Draws at one share of their range: numbers in between, and the first or the last of a choice.

    Tables of random numbers are random; those of one kind do not depend on those of another.
    """

    def __init__(self, share, seed=0):
        self.share, self._seed = share, seed
        self._tables = {
            kind: np.random.default_rng([seed, k]) for k, kind in enumerate(("e", "n", "t"))
        }

    def anew(self):
        """Return a generator of the same draws."""
        return Draws(self.share, self._seed)

    def at(self, low, high):
        """Return what is drawn between two ends."""
        return low + self.share * (high - low)

    def log(self, low, high):
        """Return what is drawn between two ends on a logarithmic scale."""
        return low * (high / low) ** self.share

    def side(self, first=-1.0, last=1.0):
        """Return what is drawn of two."""
        return first if self.share < 0.5 else last

    def sign(self, size):
        """Return down or up; a large change always goes up."""
        return self.side() if size < 0.5 else 1.0

    def uniform(self, low=0.0, high=1.0, size=None):
        return _shaped(self.at(low, high), size)

    def random(self):
        return self.share

    def integers(self, low, high):
        return min(low + int(self.share * (high - low)), high - 1)

    def choice(self, values, size=None):
        return _shaped(self.side(values[0], values[-1]), size)

    def exponential(self, mean, size):
        return self._tables["e"].exponential(mean, size)

    def standard_normal(self, size):
        return self._tables["n"].standard_normal(size)

    def standard_t(self, freedom, size):
        return self._tables["t"].standard_t(freedom, size)


def _shaped(value, size):
    return value if size is None else np.full(size, value)


def drawn(form, size, share, conditions=UNEVEN, seed=0):
    """Return law and defining values of a form that draws at a share, and the draws anew."""
    draws = Draws(share, seed)
    kind = next(k for effect in EFFECTS.values() for k in effect.forms if k.name == form)
    law, defining = kind.build(size, conditions, draws)
    return law, defining, draws.anew()


def form(name, size, share, conditions=UNEVEN):
    """Return the law of a form that reports no defining value, and the draws anew."""
    law, defining, draws = drawn(name, size, share, conditions)
    assert not defining
    return law, draws


def command(samples=5000, conditions=UNEVEN, seed=5):
    """Return a smooth command within its range, and now and then held for a while."""
    t = np.arange(samples) * SUBSTEP
    waves = np.sin(2 * np.pi * 0.9 * t + seed) + 0.7 * np.sin(2 * np.pi * 2.3 * t + 2 * seed)
    u = conditions.low + conditions.span * (0.5 + waves / 3.4)
    return np.repeat(u[::10], 10)
