"""The order in which forward regression with orthogonal least squares (FROLS) takes terms.

Billings (2013), Nonlinear System Identification, section 3.2: each step takes the term whose part
orthogonal to the terms taken explains most of the one-step output, its error reduction ratio.
"""

import numpy as np
from numba import njit

from dea.arrays import Array, Indices

_DEPENDENT = 1e-12  # share of a regressor's energy below which the rest is rounding


@njit(cache=True)
def orthogonal_order(triangles: Array, most: int) -> tuple[Indices, Array]:
    """Return the terms in the order in which FROLS takes them, and their error reduction ratios.

    Of several systems that share a structure, the ratios are averaged (Wei, Lang and Billings
    2008, International Journal of Modelling, Identification and Control 5:93).

    Parameters
    ----------
    triangles
        Of each system, each row a regressor and the last one the output, compressed by QR;
        (systems, terms + 1, rows).
    most
        Largest number of terms.

    Returns
    -------
    order, ratios
        Both of shape (taken,); fewer than ``most`` where all others depend on those taken.
    """
    systems, count = triangles.shape[0], triangles.shape[1] - 1
    left = triangles.copy()
    energy = np.empty((systems, count + 1))
    for s in range(systems):
        for j in range(count + 1):
            energy[s, j] = np.dot(left[s, j], left[s, j])
    first = energy.copy()
    order = np.empty(min(most, count), dtype=np.int64)
    ratios = np.empty(order.size)
    free = np.ones(count, dtype=np.bool_)
    for step in range(order.size):
        best, most_explained = -1, 0.0
        for j in range(count):
            if not free[j]:
                continue
            explained = 0.0
            for s in range(systems):
                if energy[s, j] > _DEPENDENT * first[s, j]:
                    projection = np.dot(left[s, j], left[s, count])
                    explained += projection**2 / (energy[s, j] * first[s, count])
            if explained > most_explained:
                best, most_explained = j, explained
        if best < 0:
            return order[:step], ratios[:step]
        free[best] = False
        order[step], ratios[step] = best, most_explained / systems
        for s in range(systems):
            if energy[s, best] <= _DEPENDENT * first[s, best]:
                continue
            taken = left[s, best] / np.sqrt(energy[s, best])
            for j in range(count + 1):
                if j == count or free[j]:
                    row = left[s, j]
                    share = np.dot(taken, row)
                    remaining = 0.0
                    for i in range(row.size):
                        row[i] -= share * taken[i]
                        remaining += row[i] ** 2
                    energy[s, j] = remaining
    return order, ratios
