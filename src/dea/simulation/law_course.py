"""What each attached law does along a record: its shape where the record reaches."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numba import float64, njit, types

from dea.simulation.attached import Attached
from dea.simulation.effects import Effect, Family, Port
from dea.simulation.extended import ExtendedSimulation as Extended
from dea.simulation.parameter import OUTPUT_GAIN, OUTPUT_OFFSET, TIMING_OFFSET
from dea.simulation.signatures import FORCE, MEMORY, UPDATE, VECTOR, first_class
from dea.simulation.timing import shifted
from dea.units import product

_ARGUMENTS = VECTOR, float64, VECTOR, VECTOR


class Axis(NamedTuple):
    """A quantity along the record, shape (samples,), with its name and unit."""

    values: np.ndarray
    name: str
    unit: str


class LawCourse(NamedTuple):
    """What a law acts on, what it makes of it, and the same where it had no effect.

    An event changes several quantities. ``quantity`` is the one shown: the input, the drive, the
    reading, a force or a stiffness.
    """

    along: Axis
    value: Axis
    idle: np.ndarray
    quantity: str


class _Change(NamedTuple):
    """One of the courses of a law, and by which part of its range it changes the quantity."""

    part: float
    course: LawCourse


def law_courses(
    extended: Extended,
    values: np.ndarray,
    u: np.ndarray,
    interval: float,
    motions: Sequence[np.ndarray] | None = None,
    like: Sequence[LawCourse | None] | None = None,
) -> list[LawCourse | None]:
    """Return the course of each effect attached, in their order.

    A force is shown along the position, so that a loop is seen as one, or along the velocity if it
    opposes that, or its port knows no position; of one that relaxes the stiffness that it has lost
    is shown, over the time after a step. There is none where its port is not the simulation's
    first. Of an event the quantity is shown that it changes most, in any record.

    Parameters
    ----------
    values
        All parameters of ``extended``.
    u
        Input, shape (samples,), of all records one after the other; several are columns.
    motions
        Output and position of each record with its lead-in that the laws are evaluated on; of a
        run at ``values`` if ``None``.
    like
        Courses whose quantities are shown, rather than those that change most.
    """
    motions = motions or extended.motions(values, u, interval)
    records = [
        _changes(extended.alone, own, u[part], interval, motion)
        for (part, own), motion in zip(extended.of_each_record(values), motions, strict=True)
    ]
    wanted = like or [None] * len(extended.attached)
    return [
        _of_records(each, before)
        for each, before in zip(zip(*records, strict=True), wanted, strict=True)
    ]


def _of_records(records: Sequence[Sequence[_Change]], like: LawCourse | None) -> LawCourse | None:
    """Return the course of one law over all records, of the quantity that it changes most."""
    if not all(records):
        return None
    most = max((change for changes in records for change in changes), key=lambda each: each.part)
    quantity = (like or most.course).quantity
    shown = [
        change.course
        for changes in records
        for change in changes
        if change.course.quantity == quantity
    ]
    first = shown[0]
    return first._replace(
        along=first.along._replace(values=np.concatenate([c.along.values for c in shown])),
        value=first.value._replace(values=np.concatenate([c.value.values for c in shown])),
        idle=np.concatenate([c.idle for c in shown]),
    )


def _changes(
    extended: Extended, values: np.ndarray, u: np.ndarray, interval: float, motion: np.ndarray
) -> list[list[_Change]]:
    """Return, for each effect attached, all that it changes in one record."""
    own = extended.simulation
    known = dict(zip(extended.layout.names, values.tolist(), strict=True))
    output, position = motion
    output = output[extended.lead(interval) :]
    time = np.arange(output.size) * interval
    acting = extended.offset(values, u)
    y = known[OUTPUT_GAIN] * shifted(output, known[TIMING_OFFSET] / interval)
    y = y + known[OUTPUT_OFFSET]
    changes: list[list[_Change]] = [[] for _ in extended.attached]
    for index in extended.order:
        each, found = extended.attached[index], changes[index]
        effect, place, q = each.effect, each.place, values[extended.layout.effect_slices[index]]
        if effect.shape_input is not None:
            before = acting[place]
            acting[place] = effect.shape_input(before, q, interval)
            name, unit = own.inputs[place].name, own.inputs[place].unit
            axes = Axis(before, name, unit), Axis(acting[place], f"{name} that acts", unit)
            found.append(_changed(effect, time, *axes, "input"))
        if effect.scale_drive is not None:
            factor = effect.scale_drive(time, q)
            drive = own.drives[own.drive_of(place)]
            found.append(_Change(float(np.ptp(factor)), _scaled(drive, time, factor)))
        if effect.shape_output is not None:
            before, y = y, effect.shape_output(y, time, q, interval)
            axes = Axis(before, "output", own.output_unit), Axis(y, "reading", own.output_unit)
            found.append(_changed(effect, time, *axes, "reading"))
        pushed = _pushed(extended, each, q, position, interval)
        if pushed is not None:
            found.append(_Change(1.0, pushed))
    return changes


def _changed(effect: Effect, time: np.ndarray, before: Axis, after: Axis, quantity: str) -> _Change:
    """Return by which part of its range a law changes the input or the reading, and the course.

    A course in time is the change, shown over time.
    """
    signal = before.name if quantity == "input" else quantity
    change = after.values - before.values
    part = float(np.ptp(change)) / (float(np.ptp(before.values)) or 1.0)
    if effect.port is Port.TIME or effect.family is Family.OSCILLATION:
        changed = Axis(change, f"change of the {signal}", after.unit)
        along = Axis(time, "time", "s")
        return _Change(part, LawCourse(along, changed, np.zeros(time.size), quantity))
    return _Change(part, LawCourse(before, after, before.values, quantity))


def _scaled(drive: str, time: np.ndarray, factor: np.ndarray) -> LawCourse:
    """Return the course of a factor (n,) on a drive."""
    acting = Axis(factor, f"factor on {drive.replace('_', ' ')}", "1")
    return LawCourse(Axis(time, "time", "s"), acting, np.ones(time.size), "drive")


def _pushed(
    extended: Extended, attached: Attached, q: np.ndarray, z: np.ndarray, interval: float
) -> LawCourse | None:
    """Return a force along the motion ``z`` at the first port, which the lead-in begins.

    Or what it loses after a step, if it is shown so.
    """
    effect = attached.effect
    if attached.place or effect.force is None:
        return None
    if effect.relaxed is not None:
        scales = attached.scales
        count = z.size - extended.lead(interval)
        after = np.geomspace(scales.crossing, scales.duration, count)
        lost = effect.relaxed(q, after, scales)
        axes = Axis(after, "time after a step", "s"), Axis(lost, "relaxed / elastic stiffness", "1")
        return LawCourse(*axes, np.zeros(after.size), "stiffness")
    port = extended.simulation.force_ports[attached.place]
    (frame, unit), lead = extended.places.frame_of(attached), extended.lead(interval)
    # What remembers the motion alone begins with the record, as in the integrator.
    begin = lead if effect.remembers_motion else 0
    law = np.zeros(MEMORY)
    law[: q.size] = q
    memory = np.zeros(MEMORY) if effect.memory is None else effect.memory(q)
    laws = first_class(effect.force), first_class(effect.update)
    push = _push(*laws, z[begin:], interval, effect.refine, memory, law)[lead - begin :]
    if effect.opposes_motion or port.position is None:
        w = np.gradient(z)[lead:] / interval
        along = Axis(w * frame.scale, port.rate, product(unit, below="s"))
    else:
        along = Axis(z[lead:] * frame.scale + frame.rest, port.position, unit)
    value = Axis(push, "force / elastic force", "1")
    return LawCourse(along, value, np.zeros(push.size), "force")


def _push(
    force: Any,
    update: Any,
    z: np.ndarray,
    interval: float,
    refine: int,
    memory: np.ndarray,
    q: np.ndarray,
) -> np.ndarray:
    """Return a force at each sample of a motion ``z`` (n,); its memory moves on.

    As in the integrator, the force is that in the middle of a step, of which an interval has
    ``refine``. A sample has the mean of the steps beside it.
    """
    fine = z
    for _ in range(1 + int(np.log2(refine))):
        fine = _halved(fine)
    push: np.ndarray = _in_steps(force, update, fine, interval / refine, memory, q)
    before, after = push[refine - 1 :: refine], push[::refine]
    return np.concatenate([after[:1], 0.5 * (before[:-1] + after[1:]), before[-1:]])


def _halved(z: np.ndarray) -> np.ndarray:
    """Return a motion (n,) at twice the rate, shape (2 n - 1,), by cubics through four samples.

    It goes on at its ends as within, where an input between samples stands still.
    """
    fine = np.empty(2 * z.size - 1)
    fine[::2] = z
    fine[3:-3:2] = (9.0 * (z[1:-2] + z[2:-1]) - z[:-3] - z[3:]) / 16.0
    for end, (first, second, third, fourth) in ((1, z[:4]), (-2, z[-1:-5:-1])):
        fine[end] = (5.0 * first + 15.0 * second - 5.0 * third + fourth) / 16.0
    return fine


@njit(
    VECTOR(types.FunctionType(FORCE), types.FunctionType(UPDATE), *_ARGUMENTS),
    cache=True,
    nogil=True,
)
def _in_steps(
    force: Any, update: Any, z: np.ndarray, h: float, memory: np.ndarray, q: np.ndarray
) -> np.ndarray:
    """Return the force in the middle of each step ``h`` (s) of a motion in half steps."""
    push = np.zeros(z.size // 2)
    update(z[0], z[0], 0.5 * h, memory, q)
    for k in range(push.size):
        start, middle, end = z[2 * k], z[2 * k + 1], z[2 * k + 2]
        push[k] = force(middle, (end - start) / h, memory, q)
        update(start, end, h, memory, q)
    return push
