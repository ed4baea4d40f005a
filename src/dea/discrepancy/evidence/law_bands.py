"""How sure a named law is, at every sample of the record."""

from typing import NamedTuple, cast

import numpy as np

from dea.confidence import DEVIATIONS
from dea.discrepancy.fitting.fit import Fit
from dea.discrepancy.problem.problem import Samples
from dea.simulation import Attached, ExtendedSimulation, LawCourse, law_courses


class BandedLaw(NamedTuple):
    """The course of a law over the record, and the ends of its 95 % band, each (n,)."""

    course: LawCourse
    low: np.ndarray
    high: np.ndarray


def banded_laws(samples: Samples, fit: Fit, covariance: np.ndarray) -> list[BandedLaw | None]:
    """Return each attached law with its band, ``None`` where it has no course.

    What the law acts on is that of the fit. Its parameters are moved by 1.96 standard deviations
    along each principal axis of their part of the ``covariance`` (k, k) of the fit's coordinates,
    both ways and within their bounds; the changes upwards and downwards that the law makes are
    summed as squares, each on its side. For a law that is linear in its parameters this is exact.
    """
    extended = fit.extended
    motions = extended.motions(fit.values, samples.u, samples.interval)
    low, high = extended.layout.bounds

    def courses(
        coordinates: np.ndarray, like: list[LawCourse | None] | None = None
    ) -> list[LawCourse | None]:
        values = extended.layout.values(np.clip(coordinates, low, high))
        return law_courses(extended, values, samples.u, samples.interval, motions, like)

    fitted = courses(fit.coordinates)

    def made(coordinates: np.ndarray, index: int) -> np.ndarray:
        return cast(LawCourse, courses(coordinates, fitted)[index]).value.values

    banded: list[BandedLaw | None] = []
    for index, course in enumerate(fitted):
        if course is None:
            banded.append(None)
            continue
        value = course.value.values
        where = extended.layout.effect_slices[index]
        own = np.flatnonzero(
            (extended.layout.free >= where.start) & (extended.layout.free < where.stop)
        )
        variances, axes = np.linalg.eigh(covariance[np.ix_(own, own)])
        above, below = np.zeros(samples.size), np.zeros(samples.size)
        for step in (DEVIATIONS * np.sqrt(np.maximum(variances, 0.0)) * axes).T:
            moved = np.zeros(fit.coordinates.size)
            moved[own] = step
            changes = np.array(
                [made(fit.coordinates + side * moved, index) - value for side in (-1, 1)]
            )
            above += np.maximum(changes.max(axis=0), 0.0) ** 2
            below += np.minimum(changes.min(axis=0), 0.0) ** 2
        banded.append(BandedLaw(course, value - np.sqrt(below), value + np.sqrt(above)))
    return banded


def in_port_unit(law: BandedLaw, extended: ExtendedSimulation, attached: Attached) -> BandedLaw:
    """Return a law whose force is in the unit of its port, as the verdict gives its parameters.

    So is the stiffness that a force has lost. Another law stays as it is, and so does a force where
    the port has no unit.
    """
    size, unit, name = 1.0, "1", law.course.quantity
    if name == "force":
        size, unit = extended.places.force_unit(attached)
    elif name == "stiffness":
        [like] = (each for each in attached.parameters if each.name == name)
        _, size, unit = extended.places.own_unit(attached, like)
        name = "relaxed stiffness"
    if unit == "1":
        return law
    made = law.course.value
    course = law.course._replace(
        value=made._replace(values=size * made.values, name=name, unit=unit),
        idle=size * law.course.idle,
    )
    return BandedLaw(course, size * law.low, size * law.high)
