"""A carriage on a spring, with effects hidden in it, that can be driven as often as one likes."""

from dataclasses import dataclass, field

import numpy as np
import xarray as xr

from dea.discrepancy import Samples
from dea.resolution import Limits
from dea.simulation import catalogue, measured_scales, prepared
from made_carriage import CARRIAGE

INTERVAL, NOISE = 0.02, 4e-3
LIMITS = Limits(-1.0, 1.0, 20.0, -2.5, 2.5, 1.0 / INTERVAL)


def hidden(effect, law):
    """Return a device that has an effect of the catalogue with these parameter values."""

    def device(u, seed):
        extended = prepared(CARRIAGE, u, INTERVAL, 1e-5)
        values = extended.layout.prior_means
        record = Samples(u, u, INTERVAL)
        whole = extended.attach(catalogue()[effect], measured_scales(extended, values, record))
        rest = whole.layout.prior_means[values.size + len(law) :]
        y = whole.simulate(np.concatenate([values, law, rest]), u, INTERVAL)
        return as_record(u, y + NOISE * np.random.default_rng(seed).standard_normal(u.size))

    return device


def as_record(u, y):
    return xr.Dataset(
        {"input": ("time", u, {"units": "V"}), "output": ("time", y, {"units": "V"})},
        coords={"time": ("time", np.arange(u.size) * INTERVAL, {"units": "s"})},
        attrs={"contract": "imported_record"},
    )


@dataclass
class InMemory:
    """A source of records that drives a device as soon as it is asked, and keeps all in memory."""

    device: object
    designs: dict = field(default_factory=dict)
    records: dict = field(default_factory=dict)
    kept: list = field(default_factory=list)

    def design(self, number, records, make):
        if number not in self.designs:
            self.designs[number] = make()
        return self.designs[number]

    def record(self, number, u):
        if number not in self.records:
            self.records[number] = self.device(u, 100 + number)
        return self.records[number]

    def keep(self, found):
        self.kept.append(found)
