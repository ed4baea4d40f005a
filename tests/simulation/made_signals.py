"""Signals that laws are given, and the force that a law answers a motion with."""

import numpy as np
from law_values import DT

from dea.simulation import catalogue
from dea.simulation.signatures import MEMORY

T = np.arange(2000) * DT
U = 2.4 + np.sin(2 * np.pi * 0.31 * T) * np.cos(2 * np.pi * 0.05 * T)
Y = 0.8 + 0.4 * np.sin(2 * np.pi * 0.23 * T)
Z = 0.7 + 0.3 * np.sin(2 * np.pi * 0.4 * T) * np.cos(2 * np.pi * 0.03 * T)


def forces(name, q, z=Z, h=DT):
    """The force along a given motion."""
    effect = catalogue()[name]
    memory = effect.memory(q) if effect.memory else np.zeros(MEMORY)
    result = []
    for k in range(z.size - 1):
        result.append(effect.force(z[k], (z[k + 1] - z[k]) / h, memory, q))
        effect.update(z[k], z[k + 1], h, memory, q)
    return np.array(result)
