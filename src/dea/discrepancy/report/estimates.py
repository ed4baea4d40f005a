"""Estimates of an effect's parameters, with intervals."""

from collections.abc import Mapping

import numpy as np

from dea.confidence import DEVIATIONS, LEVEL
from dea.discrepancy.findings import Findings
from dea.discrepancy.fitting.fit import Fit, at_bounds, outside_priors
from dea.discrepancy.report.verdict import Estimate
from dea.simulation import Attached, Parameter

_DRAWS = 400  # of the coordinates, for the interval of a quantity


def estimates(fit: Fit, index: int, deviation: np.ndarray) -> dict[str, Estimate]:
    """Return the free parameters of the attached effect ``index`` with 95 % intervals.

    The one that defines the effect comes first, then those that moved furthest from their prior
    means, in their own standard errors; those that say in which state a record finds it come last.
    What a force law's port normalises is in the unit that the simulation gives it
    (:meth:`dea.simulation.ExtendedSimulation.own_unit`). ``deviation`` (k,) is the standard
    deviation of all coordinates.
    """
    extended = fit.extended
    where = extended.layout.effect_slices[index]
    parameters = extended.attached[index].parameters
    defining = extended.attached[index].effect.defining
    values = fit.values
    own = [k for k, i in enumerate(extended.layout.free) if where.start <= i < where.stop]
    bound = at_bounds(extended, fit.coordinates)
    found = []
    for position in own:
        i = extended.layout.free[position]
        parameter = parameters[i - where.start]
        origin, unit, units = extended.places.own_unit(extended.attached[index], parameter)
        at, error = float(fit.coordinates[position]), float(deviation[position])
        value, prior, *ends = (
            origin + unit * each
            for each in (float(values[i]), *_prior_and_ends(parameter, at, error))
        )
        estimate = Estimate(
            value,
            units,
            min(ends),
            max(ends),
            prior,
            origin,
            at_bound=bool(bound[position]),
            moved=abs(at) / error,
        )
        turn = (
            parameter.name != defining,
            bool(extended.layout.at_start[position]),
            -estimate.moved,
        )
        found.append((turn, parameter.name, estimate))
    return {name: estimate for _, name, estimate in sorted(found, key=lambda each: each[0])}


def quantities(fit: Fit, index: int, covariance: np.ndarray) -> dict[str, Estimate]:
    """Return what parameters of the attached effect ``index`` amount to, with 95 % intervals.

    The ends are quantiles over draws from the coordinates' normal law of this ``covariance``
    (k, k), within their bounds.
    """
    extended = fit.extended
    attached, where = extended.attached[index], extended.layout.effect_slices[index]
    parameters = {each.name: each for each in attached.parameters}
    variances, axes = np.linalg.eigh(covariance)
    root = axes * np.sqrt(np.maximum(variances, 0.0))
    normal = np.random.default_rng(0).standard_normal((_DRAWS, variances.size))
    drawn = np.clip(fit.coordinates + normal @ root.T, *extended.layout.bounds)

    def values(coordinates: np.ndarray) -> np.ndarray:
        found: np.ndarray = extended.layout.values(coordinates)[where]
        return found

    result = {}
    for quantity in attached.effect.quantities:
        origin, unit, units = extended.places.own_unit(attached, parameters[quantity.like])
        value, prior, *others = (
            origin + unit * quantity.of(values(each), attached.scales)
            for each in (fit.coordinates, np.zeros_like(fit.coordinates), *drawn)
        )
        low, high = np.quantile(others, (0.5 * (1.0 - LEVEL), 0.5 * (1.0 + LEVEL)))
        result[quantity.name] = Estimate(value, units, float(low), float(high), prior, origin)
    return result


def estimates_beyond_priors(found: Findings) -> dict[str, Estimate]:
    """Return the simulation's own parameters where they explain the record beyond their priors.

    There are none unless the decision has freed the simulation.
    """
    freed, declared = found.decision.freed, found.nominal.extended
    if freed is None:
        return {}
    result = {}
    bound = at_bounds(freed.extended, freed.coordinates)
    for position in np.flatnonzero(outside_priors(freed, declared)):
        i = declared.layout.free[position]
        parameter = freed.extended.layout.parameters[i]
        at, error = float(freed.coordinates[position]), float(found.freed_deviation[position])
        prior, *ends = _prior_and_ends(parameter, at, error)
        result[parameter.name] = Estimate(
            float(freed.values[i]),
            parameter.unit,
            min(ends),
            max(ends),
            prior,
            at_bound=bool(bound[position]),
            moved=abs(at) / error,
        )
    return result


def _prior_and_ends(parameter: Parameter, at: float, error: float) -> tuple[float, float, float]:
    """Return a parameter's prior mean, and its 95 % interval about a coordinate."""
    return (
        parameter.value(0.0),
        parameter.value(at - DEVIATIONS * error),
        parameter.value(at + DEVIATIONS * error),
    )


def quoted(attached: Attached, found: Mapping[str, Estimate]) -> tuple[str, ...]:
    """Return the parameters that tell what an effect is, in the order of the estimates ``found``.

    These are the one that defines it and those whose intervals exclude the prior mean; if there is
    none, the first of all. Parameters of the state at the start of a record are left out.
    """
    states = {each.name for each in attached.parameters if each.at_start}
    defining = attached.effect.defining
    told = (
        name
        for name, each in found.items()
        if name == defining or (each.moved > DEVIATIONS and name not in states)
    )
    return tuple(told) or tuple(found)[:1]
