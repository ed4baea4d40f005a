"""The records of a diagnosis, joined: their signals, the roles of their samples, their noise."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dea.discrepancy.problem.decimation import decimated, decimation_of, interpolation_of
from dea.discrepancy.problem.noise import quantisation, white_level
from dea.discrepancy.problem.problem import Problem, Samples
from dea.discrepancy.problem.split import Split, split
from dea.discrepancy.settings import Settings
from dea.errors import InputError
from dea.inputs import by_input
from dea.missing import filled
from dea.simulation import ExtendedSimulation, Simulation, prepared, samples_of_each, slowest_time
from dea.units import plain_units
from dea.warm_up import LONGEST_WARM_UP

if TYPE_CHECKING:
    import xarray as xr

    from dea.store import Record

# Factor by which the integration steps of the simulation alone may be shortened for an effect; a
# law with corners would be shortened without end.
_SHORTER = 4
# Part of the output's deviation that noise is taken for at least: a fit needs some.
_LEAST = 1e-6
# Ranges of the measured output beyond which a simulated one is unstable, and no poor estimate.
_FAR = 1e6
# Factor on a parameter that scales the input, which must change the output.
_SCALED = 1.01
_DIAGNOSE_A_PART = "Diagnose a part of the record in which it is known"
# Part by which the sampling intervals of two records may differ.
SAME_INTERVAL = 1e-6


def signals_of(record: "Record | xr.Dataset", simulation: Simulation) -> Samples:
    """Return the signals of a record, whose inputs and units must be the simulation's.

    Raises
    ------
    InputError
        If they are not, if several inputs are those of the simulation in another order, or if no
        output is known.
    """
    from dea.store import Record, signals

    found = record if isinstance(record, Record) else signals(record)
    inputs, given = simulation.inputs, found.inputs
    if len(given) != len(inputs):
        raise InputError(
            f"the record has {_counted(given)}, the simulation {simulation.name} "
            f"has {_counted(inputs)}",
            field="input",
            remedy="Name the inputs of the simulation, in its order",
        )
    known = [each.name for each in inputs]
    called = [name for name, _ in given]
    if called != known and sorted(called) == sorted(known):
        raise InputError(
            f"the record's inputs are {', '.join(called)}, those of the simulation "
            f"{simulation.name} {', '.join(known)}",
            field="input",
            remedy="List them in the order of the simulation",
        )
    several = len(inputs) > 1
    for role, unit, expected in (
        *(
            (f"input {name}" if several else "input", unit, each.unit)
            for (name, unit), each in zip(given, inputs, strict=True)
        ),
        ("output", found.y_units, simulation.output_unit),
    ):
        if plain_units(unit) != plain_units(expected):
            raise InputError(
                f"the record's {role} is in {unit!r}, the simulation {simulation.name} "
                f"expects {expected!r}",
                field=role,
                remedy="Convert the record, or use a simulation in its units"
                if unit != "1"
                else f"If it is in {expected}, say so: dea.Record.of(…, units=…)",
            )
    if np.isnan(found.y).all():
        raise InputError(
            "no output of the record is known",
            field="output",
            remedy="Leave the record out, or check which column its output is",
        )
    return Samples(found.u, found.y, 1.0 / found.sampling_rate)


def _counted(inputs: Sequence[object]) -> str:
    return f"{len(inputs)} input{'s' * (len(inputs) > 1)}"


def prepare(
    records: Sequence[Samples], simulation: Simulation, settings: Settings
) -> tuple[Problem, Split, ExtendedSimulation]:
    """Join and split records, estimate their noise, and choose the integration step to match.

    Records that are sampled much faster than they move are decimated, to no fewer samples than the
    budget says, and no further than the steps of the simulation reach.

    Missing outputs have no role in the split: nothing is fitted to them or certified on them. Where
    a whole signal is needed, as in a spectrum, they are interpolated.

    Raises
    ------
    InputError
        If there is no record, input or output is constant, a record is too short for the split or
        lacks its outputs there, or one is sampled otherwise than the others.
    """
    for role, signals in (("input", [r.u for r in records]), ("output", [r.y for r in records])):
        if records and all((np.nanmax(x, axis=0) == np.nanmin(x, axis=0)).all() for x in signals):
            raise InputError(
                f"the {role} is constant",
                field=role,
                remedy="Give a record in which the device is driven and moves",
            )
    factor = decimation_of(records, settings.budget.decimated)
    oversampled = factor > 1
    made = _at_every(factor, records, simulation, settings)
    while factor > 1 and made.extended.substeps > 1:
        # The number of integration steps stays the same, so that more samples cost little, and they
        # keep the corners of the input.
        factor = max(factor // made.extended.substeps, 1)
        made = _at_every(factor, records, simulation, settings)
    records, joined, seen, noise, tolerance, extended = made
    u, interval = joined.u, joined.interval
    _require_driven(extended, joined)
    slowest = settings.slowest_time
    if slowest is None:
        slowest = slowest_time(extended, u)
    splits = _split_each(records, slowest, settings.warm_up)
    parts = Split(
        np.concatenate([each.fit for each in splits]) & seen,
        np.concatenate([each.select for each in splits]) & seen,
        np.concatenate([each.certify for each in splits]) & seen,
        max(each.spacing for each in splits),
        min(each.time_constants for each in splits),
        splits[0].slowest,
        1 + int(np.argmin([each.time_constants for each in splits])),
    )
    _require_outputs(parts, records)
    problem = Problem(
        u,
        joined.y,
        interval,
        parts.fit,
        parts.select,
        parts.certify,
        noise=settings.noise_margin * noise,
        tolerance=tolerance,
        most_steps=_SHORTER * extended.substeps,
        measured=seen,
        decimation=factor,
        oversampled=oversampled,
        lengths=extended.lengths,
    )
    return problem, parts, extended


def _split_each(records: Sequence[Samples], slowest: float, warm_up: float) -> list[Split]:
    """Split each record; an error names the one of several that is too short."""
    interval, splits = records[0].interval, []
    for number, each in enumerate(records, 1):
        skipped = min(warm_up, LONGEST_WARM_UP * each.size * interval)
        try:
            splits.append(split(each.u, interval, slowest, skipped, ~np.isnan(each.y)))
        except InputError as error:
            field = f"record {number}" if len(records) > 1 else error.field
            raise error.at(field=field) from None
    return splits


def _require_driven(extended: ExtendedSimulation, record: Samples) -> None:
    """Refuse a simulation whose output grows far beyond what was measured, or ignores a drive."""
    nominal = extended.layout.prior_means
    y = extended.simulate(nominal, record.u, record.interval)
    reached, measured = np.abs(y - y[0]), float(np.ptp(record.y))
    if reached.max() > _FAR * measured:
        own, after = extended.simulation, record.interval * int(np.argmax(reached))
        raise own.error(
            f"at its nominal parameters its output moves by {reached.max():.1g} {own.output_unit} "
            f"within {after:g} s, where the record's moves by {measured:.3g}",
            "parameters",
            "Correct the nominal values, or the sign of the term that grows",
        )
    if not np.ptp(y):  # at rest, as behind a threshold that the nominal values put too high
        return
    own = extended.simulation
    moving = [k for k, u in enumerate(by_input(record.u)) if np.ptp(u)]
    driven = [own.drives[own.drive_of(k)] for k in moving]
    for name in dict.fromkeys(driven):
        scaled, at = nominal.copy(), extended.layout.names.index(name)
        scaled[at] *= _SCALED
        alike = np.array_equal(extended.simulate(scaled, record.u, record.interval), y)
        if alike and nominal[at]:
            raise extended.simulation.error(
                f"the output does not depend on {name!r}, which is to scale the input",
                "drive",
                "Multiply the input by it in the equations, or name the parameter that does",
            )


def _require_outputs(parts: Split, records: Sequence[Samples]) -> None:
    """Refuse outputs that are missing in all of the blocks of one use, or of one record."""
    for number, own in enumerate(samples_of_each([each.size for each in records]), 1):
        if not (parts.fit | parts.select)[own].any():
            several = len(records) > 1
            of_record = f" of record {number}" if several else ""
            raise InputError(
                f"it is missing in every block{of_record} that could be used to fit to",
                field="output",
                remedy="Leave that record out" if several else _DIAGNOSE_A_PART,
            )
    for use, samples in (
        ("certify on", parts.certify),
        ("fit to", parts.fit),
        ("choose by", parts.select),
    ):
        if not samples.any():
            raise InputError(
                f"it is missing in every block that could be used to {use}",
                field="output",
                remedy=_DIAGNOSE_A_PART,
            )


class _Prepared(NamedTuple):
    """Records at one rate, joined with missing outputs filled, and a simulation to match."""

    records: Sequence[Samples]
    joined: Samples
    seen: np.ndarray
    noise: float
    tolerance: float
    extended: ExtendedSimulation


def _at_every(
    factor: int, records: Sequence[Samples], simulation: Simulation, settings: Settings
) -> _Prepared:
    """Return records with every ``factor``-th sample, and a simulation with fine enough steps."""
    joined, interpolation = _joined(records), None
    if factor > 1:
        recorded = simulation.input_interpolation
        interpolation = interpolation_of(records, factor, recorded)
        records = [decimated(each, factor, recorded, interpolation) for each in records]
        joined = _joined(records)
    y, seen = filled(joined.y)
    lengths = tuple(each.size for each in records)
    white = white_level(y, samples_of_each(lengths), seen)
    noise = max(white, quantisation(y[seen]), _LEAST * float(np.std(y)))
    tolerance = max(settings.step_error * noise, settings.relative_step_error * float(np.std(y)))
    extended = prepared(simulation, joined.u, joined.interval, tolerance, lengths, interpolation)
    # The time offset is as certain as at the recorded rate: fewer samples do not add to it.
    extended = replace(extended, timing_spread=extended.timing_spread / factor)
    return _Prepared(records, replace(joined, y=y), seen, noise, tolerance, extended)


def _joined(records: Sequence[Samples]) -> Samples:
    if not records:
        raise InputError("there is no record", field="record", remedy="Give at least one")
    interval = records[0].interval
    for number, each in enumerate(records[1:], 2):
        if abs(each.interval - interval) > SAME_INTERVAL * interval:
            raise InputError(
                f"record {number} is sampled every {each.interval:g} s, the first one every "
                f"{interval:g} s",
                field="record",
                remedy="Resample them to one interval",
            )
    return Samples(
        np.concatenate([each.u for each in records]),
        np.concatenate([each.y for each in records]),
        interval,
    )
