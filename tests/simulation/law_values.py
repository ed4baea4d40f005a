"""The parameters of a law at its nominal values, but for those that a test changes."""

import numpy as np

from dea.simulation import Scales, catalogue

DT = 0.02
SCALES = Scales(
    u_unit="V", y_unit="mm", u_low=1.1, u_high=3.75, u_rate=4.0, y_low=0.4, y_high=1.2,
    z_low=0.4, z_high=1.0, interval=DT, duration=40.0, frequencies=(1.3,),
    foreign_frequencies=(1.3,), jumps=(11.0,), z_rate=0.9,
)  # fmt: skip


def values(name, **changed):
    parameters = catalogue()[name].parameters(SCALES)
    assert set(changed) <= {p.name for p in parameters}
    return np.array([float(changed.get(p.name, p.nominal)) for p in parameters])
