"""Delays of the command."""

import numpy as np
from numba import njit
from numpy.random import Generator

from dea.arrays import Array
from dea.plant.film import SUBSTEP
from dea.plant.hidden.effect import Built, Conditions, EffectKind, Port, reporting, tuning
from dea.plant.hidden.forms.kernels import cascade, note, noted
from dea.plant.signal_law import SignalLaw


@njit(cache=True)
def _delayed(c: Array, m: Array, u: Array) -> None:
    """Come c[0] sub-steps later; m: count and a ring of past values."""
    for k in range(u.shape[0]):
        note(m, u[k])
        u[k] = noted(m, int(c[0]))


@tuning("Smith, Chem. Eng. Prog. 53 (1957) 217: a pure delay")
def pure_delay(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A delay of ``size`` periods of the band, to a millisecond."""
    steps = max(round(size * conditions.time / SUBSTEP), 1)
    return Built(SignalLaw(_delayed, [steps], np.zeros(2 + steps)), {"delay": steps * SUBSTEP})


@njit(cache=True)
def _sampled(c: Array, m: Array, u: Array) -> None:
    """Sample every c[0] sub-steps and hold one period later; m: count, held and next value."""
    if m[0] == 0.0:
        m[1] = m[2] = u[0]
    for k in range(u.shape[0]):
        if m[0] % c[0] == 0.0:
            m[1], m[2] = m[2], u[k]
        u[k] = m[1]
        m[0] += 1.0


@tuning("Åström and Wittenmark, Computer-Controlled Systems (1997): sampled, computed and held")
def sampled_and_held(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Commands that are sampled, leave one period later and are held for a period."""
    period = max(round(size * conditions.time / 1.5 / SUBSTEP), 1)
    law = SignalLaw(_sampled, [period], np.zeros(3))
    return Built(law, {"delay": 0.5 * (3 * period - 1) * SUBSTEP})


@njit(cache=True)
def _arrivals(c: Array, m: Array, u: Array) -> None:
    """c: (weight, sub-steps of delay) of every path; m: count and a ring of past values."""
    for k in range(u.shape[0]):
        note(m, u[k])
        arrived = 0.0
        for i in range(c.shape[0] // 2):
            arrived += c[2 * i] * noted(m, int(c[2 * i + 1]))
        u[k] = arrived


def _spread(weights: Array, times: Array) -> tuple[SignalLaw, float]:
    """Return paths of delays ``times`` (s), side by side, and their mean delay."""
    steps = np.maximum(np.rint(times / SUBSTEP), 1.0)
    weights = weights / weights.sum()
    constants = np.column_stack([weights, steps]).ravel()
    law = SignalLaw(_arrivals, constants, np.zeros(2 + int(steps.max())))
    return law, float(weights @ steps) * SUBSTEP


@tuning("Danckwerts, Chem. Eng. Sci. 2 (1953) 1: laminar flow, whose middle arrives first")
def laminar_tube(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Twenty-four equal streams; a share 1 - (T/2t)² of a flow of mean time T arrives by t."""
    late = 0.5 / np.sqrt(1.0 - (np.arange(24) + 0.5) / 24.0)
    law, _ = _spread(np.ones(24), size * conditions.time * late / late.mean())
    return Built(law, {})


@tuning("Wylie and Streeter, Fluid Transients (1978): a line that reflects at both ends")
def reflecting_line(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A wave that arrives at T, and up to a tenth of it after each two reflections more."""
    kept = rng.uniform(0.03, 0.1) * rng.choice([-1.0, 1.0])
    order = np.arange(5, dtype=np.float64)
    law, mean = _spread(kept**order, (2.0 * order + 1.0) * size * conditions.time)
    return Built(law, {"delay": mean})


@njit(cache=True)
def _buckets(c: Array, m: Array, u: Array) -> None:
    """Pass charges on every c[0] sub-steps, all but a share c[1]; m: count and the buckets."""
    if m[0] == 0.0:
        m[1:] = u[0]
    for k in range(u.shape[0]):
        if m[0] % c[0] == 0.0:
            for i in range(m.shape[0] - 1, 0, -1):
                before = m[i - 1] if i > 1 else u[k]
                m[i] = before + c[1] * (m[i] - before)
        u[k] = m[m.shape[0] - 1]
        m[0] += 1.0


@tuning("Sangster and Teer, IEEE J. Solid-State Circuits 4 (1969) 131: a bucket brigade")
def bucket_brigade(size: float, conditions: Conditions, rng: Generator) -> Built:
    """About sixteen to forty-eight buckets, each of which leaves a hundredth or so behind."""
    mean = size * conditions.time / SUBSTEP
    period = max(round(mean / int(rng.integers(16, 49))), 1)
    buckets, left = max(round(mean / period), 1), rng.uniform(0.002, 0.015)
    law = SignalLaw(_buckets, [period, left], np.zeros(1 + buckets))
    return Built(law, {"delay": ((buckets / (1.0 - left) - 0.5) * period - 0.5) * SUBSTEP})


@njit(cache=True)
def _joined(c: Array, m: Array, u: Array) -> None:
    """Join samples by lines, each while the next is awaited; m: count, two samples."""
    if m[0] == 0.0:
        m[1] = m[2] = u[0]
    for k in range(u.shape[0]):
        within = m[0] % c[0]
        if within == 0.0:
            m[1], m[2] = m[2], u[k]
        u[k] = m[1] + within / c[0] * (m[2] - m[1])
        m[0] += 1.0


@tuning("Franklin et al., Digital Control of Dynamic Systems (1998): samples joined by lines")
def joined_samples(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Samples ``size`` band periods apart, each reached along a line one period late."""
    period = max(round(size * conditions.time / SUBSTEP), 1)
    return Built(SignalLaw(_joined, [period], np.zeros(3)), {"delay": period * SUBSTEP})


@njit(cache=True)
def _loaded(c: Array, m: Array, u: Array) -> None:
    """Pass waves along coils and capacitors in c[1] steps of c[0] section delays each.

    m: whether started, then current and voltage of every section; the end is matched.
    """
    sections = m.shape[0] // 2
    if m[0] == 0.0:
        m[0] = 1.0
        m[1:] = u[0]
    for k in range(u.shape[0]):
        for _ in range(int(c[1])):
            before = u[k]
            for i in range(sections):
                m[1 + 2 * i] += c[0] * (before - m[2 + 2 * i])
                before = m[2 + 2 * i]
            for i in range(sections):
                after = m[3 + 2 * i] if i < sections - 1 else m[2 + 2 * i]
                m[2 + 2 * i] += c[0] * (m[1 + 2 * i] - after)
        u[k] = before


@tuning("Pupin, Trans. AIEE 17 (1900) 445: a line that is loaded with coils")
def loaded_line(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Ten to thirty coils with capacitors: quick waves come later, so that an edge rings."""
    sections, mean = int(rng.integers(10, 31)), size * conditions.time
    rate = SUBSTEP * sections / mean
    steps = max(int(np.ceil(rate / 0.25)), 1)
    law = SignalLaw(_loaded, [rate / steps, steps], np.zeros(1 + 2 * sections))
    return Built(law, {"delay": mean})


@tuning("Wigington and Nahman, Proc. IRE 45 (1957) 166: a coaxial cable with the skin effect")
def coaxial_cable(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Twenty-four equal parts of an edge; erfc(a/√(t - T)) is there at t, after its front at T.

    Half of it is there by ``size`` band periods, of which 0.002 to 0.015 are after the front.
    """
    from scipy.special import erfcinv

    half, late = size * conditions.time, rng.uniform(0.002, 0.015)
    after = (erfcinv(0.5) / erfcinv((np.arange(24) + 0.5) / 24.0)) ** 2
    law, _ = _spread(np.ones(24), half * (1.0 - late + late * after))
    return Built(law, {})


@njit(cache=True)
def _jittered(c: Array, m: Array, u: Array) -> None:
    """c: mean, depth (s), (frequency, phase) of every sine of the delay.

    m: delay in sub-steps, which is updated every tenth one; count and a ring of past values.
    """
    ring, sines = m[1:], (c.shape[0] - 2) // 2
    for k in range(u.shape[0]):
        if ring[0] % 10.0 == 0.0:
            wander = 0.0
            for i in range(sines):
                wander += np.sin(2.0 * np.pi * c[2 + 2 * i] * ring[0] * SUBSTEP + c[3 + 2 * i])
            m[0] = (c[0] + c[1] * wander / sines) / SUBSTEP
        note(ring, u[k])
        whole = int(m[0])
        near, far = noted(ring, whole), noted(ring, whole + 1)
        u[k] = near + (m[0] - whole) * (far - near)


@tuning("Nilsson, Real-Time Control Systems with Delays (1998): a network's varying delay")
def jittered_delay(size: float, conditions: Conditions, rng: Generator) -> Built:
    """A delay that wanders by up to a fifth around its mean, faster than the band and slower."""
    mean = size * conditions.time
    depth = rng.uniform(0.05, 0.2) * mean
    frequencies = np.exp(rng.uniform(np.log(0.05), np.log(3.0), 6)) / conditions.time
    sines = np.column_stack([frequencies, rng.uniform(0.0, 2.0 * np.pi, 6)]).ravel()
    memory = np.zeros(5 + int(np.ceil((mean + depth) / SUBSTEP)))
    law = SignalLaw(_jittered, np.concatenate([[mean, depth], sines]), memory)
    return Built(law, {"delay": mean})


@tuning("Levenspiel, Chemical Reaction Engineering (1999): plug flow as many tanks in series")
def dispersed_plug_flow(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Twenty-five to sixty equal lags in series: a delay whose edge is slightly blurred."""
    tanks = int(rng.integers(25, 61))
    mean = size * conditions.time
    return Built(cascade(np.full(tanks, mean / tanks)), {"delay": mean})


@reporting("Schlichting, Boundary-Layer Theory (1979): turbulent flow in a pipe, a power of 1/7")
def turbulent_pipe(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Twenty-four equal streams; their speed is a power 1/6 to 1/9 of the way from the wall."""
    power = 1.0 / rng.uniform(6.0, 9.0)
    wall = np.linspace(1.0, 0.0, 20_001)
    # The integral of the flow x^p (1 - x) dx between wall and axis, by parts.
    beyond = wall ** (1.0 + power) / (1.0 + power) - wall ** (2.0 + power) / (2.0 + power)
    carried = 1.0 - beyond / beyond[0]
    speeds = np.interp((np.arange(24) + 0.5) / 24.0, carried, wall) ** power
    times = size * conditions.time / speeds / np.mean(1.0 / speeds)
    law, mean = _spread(np.ones(24), times)
    return Built(law, {"delay": mean})


@njit(cache=True)
def _queued(c: Array, m: Array, u: Array) -> None:
    """Hold the latest sample that has been served; one is taken every c[0] sub-steps.

    c: besides, the sub-steps from taken to served, in turn; m: count, how many are served, the
    value held and a ring of samples.
    """
    period, ring = int(c[0]), m.shape[0] - 3
    for k in range(u.shape[0]):
        count, served = int(m[0]), int(m[1])
        if count == 0:
            m[2] = u[0]
        if count % period == 0:
            m[3 + count // period % ring] = u[k]
        while served * period <= count:
            if served * period + c[1 + served % (c.shape[0] - 1)] > count:
                break
            m[2] = m[3 + served % ring]
            served += 1
        u[k] = m[2]
        m[0], m[1] = count + 1, served


def _age(period: int, late: Array) -> float:
    """Return the mean age, in sub-steps, of what is held until the next sample is served."""
    held = np.maximum(period + np.diff(late), 0.0)
    age: float = held @ (late[:-1] + 0.5 * (held - 1.0)) / held.sum()
    return age


@tuning("Lindley, Proc. Camb. Philos. Soc. 48 (1952) 277: a queue with a single server")
def queued_packets(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Samples that are held, and that wait for one another's service of random length.

    The server is busy for 0.5 to 0.8 of the time; a delay of all makes up the mean.
    """
    mean = size * conditions.time / SUBSTEP
    period = max(round(mean / rng.uniform(5.0, 10.0)), 1)
    served = rng.exponential(period * rng.uniform(0.5, 0.8), 2000)
    late = np.zeros(2000)
    wait = 0.0
    for k in range(late.size):
        late[k] = wait + served[k]
        wait = max(late[k] - period, 0.0)
    late = np.maximum(np.rint(late + max(mean - _age(period, late), 0.0)), 1.0)
    ring = 2 + int(late.max()) // period
    law = SignalLaw(_queued, np.append(period, late), np.zeros(3 + ring))
    return Built(law, {})


@reporting("Kallmann, Proc. IRE 28 (1940) 302: a transversal filter, here with a linear phase")
def transversal_filter(size: float, conditions: Conditions, rng: Generator) -> Built:
    """Thirty-three taps, the middle one ``size`` band periods late, on which an edge rises.

    Their weights are a sinc under Hamming's bell, which is zero every 3 to 6 taps.
    """
    apart = np.arange(33.0) - 16.0
    weights = np.sinc(apart / rng.uniform(3.0, 6.0)) * np.hamming(33)
    law, mean = _spread(weights, size * conditions.time * (1.0 + apart / 16.0))
    return Built(law, {"delay": mean})


EFFECTS = (
    EffectKind(
        "transport_delay", Port.INPUT, 0.004, 0.6, "band periods",
        (pure_delay, sampled_and_held, laminar_tube, reflecting_line, bucket_brigade,
         joined_samples, loaded_line, coaxial_cable, jittered_delay, dispersed_plug_flow,
         turbulent_pipe, queued_packets, transversal_filter),
    ),
)  # fmt: skip
