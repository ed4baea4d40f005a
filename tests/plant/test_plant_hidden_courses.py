"""Hidden faults, drifts and disturbances against a statement of each law, draw by draw."""

import numpy as np
import pytest
from made_conditions import held, resist, through
from made_draws import SHARES, UNEVEN, command, drawn
from scipy.signal import lfilter

from dea.plant.film import SUBSTEP

K, TRAVEL, SPAN = UNEVEN.stiffness, UNEVEN.travel, UNEVEN.span
DURATION, TIME, POWER = UNEVEN.duration, UNEVEN.time, UNEVEN.power
U = command()
T = np.arange(U.size) * SUBSTEP
WITHIN = np.minimum(T, DURATION)


def gain(change):
    """Return the command where what it drives changes by a share."""
    return U * np.maximum(1.0 + change, 0.0) ** (1.0 / POWER)


def moment(d):
    return d.at(0.3, 0.7) * DURATION


def abrupt_gain(size, d):
    width = d.at(0.02, 0.15) * TIME
    return gain(size * d.sign(size) * (0.5 + 0.5 * np.tanh(0.5 * (T - moment(d)) / width)))


def settling_gain(size, d):
    since = np.maximum(T - moment(d), 0.0) / (d.at(0.3, 1.0) * TIME)
    return gain(size * d.sign(size) * (1.0 - np.exp(-since)))


def ramp(d):
    return np.clip((T - moment(d)) / (d.at(0.01, 0.1) * TIME), 0.0, 1.0)


def biased_sensor(size, d):
    return U + size * TRAVEL * d.side() * ramp(d)


def biased_command(size, d):
    return np.clip(U + 0.5 * size * SPAN * d.side() * ramp(d), UNEVEN.low, UNEVEN.high)


def clearing_electrode(size, d):
    since, kept = (T - moment(d)) / (d.at(0.3, 1.0) * TIME), d.at(0.35, 0.7)
    lost = min(size, 0.9) * (kept + (1.0 - kept) * np.exp(-since))
    at_the_jump = np.abs(T - moment(d)) < 2 * SUBSTEP
    return np.where(at_the_jump, np.nan, gain(np.where(since > 0, -lost, 0)))


def lost_effectiveness(size, d):
    stuck = d.side(UNEVEN.low, UNEVEN.high)
    return stuck + (U - stuck) * (1.0 - min(size, 0.9) * ramp(d))


def exponential(d):
    return 1.0 - np.exp(-WITHIN / (d.at(0.2, 0.6) * DURATION))


def logistic(d):
    middle, width = d.at(0.35, 0.65) * DURATION, d.at(0.06, 0.12) * DURATION
    rise = 0.5 * np.tanh(0.5 * (WITHIN - middle) / width)
    return rise - rise[0]


def passing(d):
    come, go = d.at(0.05, 0.15) * DURATION, d.at(0.3, 0.7) * DURATION
    course = np.exp(-WITHIN / go) - np.exp(-WITHIN / come)
    return course / course.max()


def cubic(d):
    t, share = WITHIN / DURATION, d.at(0.3, 0.8)
    return share * t ** (1.0 / 3.0) + (1.0 - share) * t


def two_parts(d):
    quick, slow = d.at(0.03, 0.1) * DURATION, d.at(0.3, 0.6) * DURATION
    return 1.0 - np.exp(-WITHIN / quick) - d.at(0.7, 1.5) * (1.0 - np.exp(-WITHIN / slow))


def logarithm(d):
    first = d.at(0.01, 0.1) * DURATION
    return np.log(1.0 + WITHIN / first) / np.log(1.0 + DURATION / first)


def wandering(d):
    points = 4001
    kept = 1.0 - 1.0 / (d.at(0.1, 0.3) * points)
    steps = d.standard_normal(points)
    path = np.cumsum(lfilter([1.0 - kept], [1.0, -kept], np.append(0.0, steps[1:])))
    return np.interp(WITHIN, np.linspace(0.0, DURATION, points), path / np.abs(path).max())


def walk(d):
    """A sum of independent steps, the farthest of which is 1 away."""
    path = lfilter([1.0], [1.0, -1.0], np.append(0.0, d.standard_normal(4000)))
    return np.interp(WITHIN, np.linspace(0.0, DURATION, 4001), path / np.abs(path).max())


def discharge(d):
    """A part that is exponential, and one in which what is left of the charge divides."""
    whole, time, share = d.at(1.05, 1.3) * DURATION, d.at(0.03, 0.1) * DURATION, d.at(0.2, 0.5)
    left = 1.0 / (1.0 - WITHIN / whole) - 1.0
    return share * (1.0 - np.exp(-WITHIN / time)) + (1.0 - share) * left / left.max()


def heat(d):
    """The integral of the flow of heat by which a thick wall answers a step."""
    fine = np.linspace(0.0, DURATION, 100_001)[1:]
    late = d.at(0.1, 0.6) * DURATION
    flow = np.sqrt(late / np.pi) * fine**-1.5 * np.exp(-late / fine)
    risen = np.cumsum(flow)
    return np.interp(WITHIN, fine, risen / risen[-1])


def tide(d):
    angle, phase = 2.0 * np.pi * WITHIN / (d.at(1.2, 3.0) * DURATION), d.at(0.0, 2.0 * np.pi)
    return 0.5 * (np.sin(angle + phase) - np.sin(phase))


COURSES = {
    "ageing_gain": exponential,
    "diffusing_gain": lambda d: np.sqrt(WITHIN / DURATION),
    "linear_gain": lambda d: WITHIN / DURATION,
    "autocatalytic_gain": logistic,
    "passing_gain": passing,
    "discharging_gain": discharge,
    "logarithmic_gain": logarithm,
    "wandering_gain": wandering,
    "warming_mount": exponential,
    "swelling_mount": lambda d: np.sqrt(WITHIN / DURATION),
    "steady_zero": lambda d: WITHIN / DURATION,
    "creeping_mount": cubic,
    "differential_expansion": two_parts,
    "heated_wall": heat,
    "walking_bias": walk,
    "wandering_baseline": wandering,
    "daily_swing": tide,
}


@pytest.mark.parametrize("form", COURSES)
@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("size", [0.2, 0.6])
def test_a_drift_follows_its_course_and_stays_at_its_end(form, share, size):
    law, defining, draws = drawn(form, size, share)
    height, course = size * draws.sign(size), COURSES[form](draws)
    of_gain = form.endswith("_gain")
    expected = gain(height * course) if of_gain else U + size * TRAVEL * draws.side() * course
    np.testing.assert_allclose(through(law, U), expected, atol=1e-4 * np.ptp(expected))
    assert law.output is not of_gain
    assert not defining


def frequency(d):
    """Return a frequency from a fifth of the band to six times it."""
    return 10.0 ** d.at(-0.7, 0.8) / TIME


def waves(d, heights, frequencies, phases):
    """Return a sum of sines."""
    angles = 2.0 * np.pi * np.outer(T, frequencies) + phases
    return U + np.sin(angles) @ np.asarray(heights)


def phase(d):
    return d.at(0.0, 2.0 * np.pi)


def machine_harmonics(size, d):
    heights = size * TRAVEL * np.array([1.0, d.at(0.0, 0.5), d.at(0.0, 0.3)])
    return waves(d, heights, frequency(d) * np.array([1, 2, 3]), phase(d))


def supply_ripple(size, d):
    heights = size * SPAN * np.array([1.0, d.at(0.0, 0.5)])
    return waves(d, heights, frequency(d) * np.array([1, 2]), phase(d))


def capacitor_ripple(size, d):
    place = (frequency(d) * T + d.share) % 1.0
    jump = np.minimum(place, 1.0 - place) < 1e-6
    return np.where(jump, np.nan, U + size * SPAN * (1.0 - 2.0 * place))


def chopped_supply(size, d):
    duty, place = d.at(0.3, 0.7), (frequency(d) * T + d.share) % 1.0
    jump = np.minimum(np.minimum(place, 1.0 - place), np.abs(place - duty)) < 1e-6
    # On a mean of nothing: above by what is off, below by what is on.
    pulses = 2.0 * size * SPAN * np.where(place < duty, 1.0 - duty, -duty)
    return np.where(jump, np.nan, U + pulses)


def gear_meshing(size, d):
    turning = np.sin(2.0 * np.pi * frequency(d) * d.at(0.05, 0.2) * T + phase(d))
    return U + size * TRAVEL * (1.0 + d.at(0.4, 1.0) * turning) * np.sin(
        2.0 * np.pi * frequency(d) * T + phase(d)
    )


def oil_whirl(size, d):
    heights = size * TRAVEL * np.array([1.0, d.at(0.4, 0.8)])
    return waves(d, heights, frequency(d) * np.array([1.0, d.at(0.42, 0.48)]), phase(d))


def beating_machines(size, d):
    heights = size * TRAVEL * np.array([1.0, d.at(0.2, 0.6)])
    second = frequency(d) + d.at(2.0, 6.0) / DURATION
    return waves(d, heights, [frequency(d), second], np.array([phase(d), 0.0]))


def rectified_sine(size, d):
    angle = 2.0 * np.pi * np.arange(4096) / 4096
    lines = np.fft.rfft(np.maximum(np.sin(angle), 0.0))[1:7] / 2048
    turned = np.outer(2.0 * np.pi * frequency(d) * T + phase(d), np.arange(1, 7))
    return U + 2.0 * size * TRAVEL * np.real(np.exp(1j * turned) @ lines)


@pytest.mark.parametrize(
    "law",
    [
        abrupt_gain, settling_gain, biased_sensor, biased_command, clearing_electrode,
        lost_effectiveness, machine_harmonics, supply_ripple, capacitor_ripple,
        chopped_supply, gear_meshing, oil_whirl, beating_machines, rectified_sine,
    ],
    ids=lambda law: law.__name__,
)  # fmt: skip
@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("size", [0.3, 0.95])
def test_a_fault_or_a_wave_is_as_the_law_says(law, share, size):
    made, defining, draws = drawn(law.__name__, size, share)
    expected = law(size, draws)
    known = np.isfinite(expected)
    assert known.mean() > 0.98
    wrong = np.abs(through(made, U) - expected)[known]
    assert wrong.max() < 1e-5 * TRAVEL
    key, value = ("time", moment) if "time" in defining else ("frequency", frequency)
    assert defining == {key: pytest.approx(value(draws))}
    unread = {"abrupt_gain", "settling_gain", "biased_command", "clearing_electrode",
              "lost_effectiveness", "supply_ripple", "capacitor_ripple",
              "chopped_supply"}  # fmt: skip
    assert made.output is (law.__name__ not in unread)


def cracked_spring(size, d, t):
    rise = 0.5 + 0.5 * np.tanh(0.5 * (t - moment(d)) / (d.at(0.02, 0.15) * TIME))
    return 0.5 * size * d.sign(size) * K * 5.0 * rise


def settling_load(size, d, t):
    first = d.at(0.01, 0.1) * DURATION
    share = np.log(1.0 + t / first) / np.log(1.0 + DURATION / first)
    return size * K * TRAVEL * d.side() * share


def cogging(size, d, t):
    rate, narrow = 10.0 ** d.at(-0.7, 0.2) / TIME, d.at(2.0, 6.0)

    def bell(angle):
        return np.exp(narrow * (np.cos(angle) - 1.0))

    mean = bell(np.linspace(0.0, 2.0 * np.pi, 200, endpoint=False)).mean()
    return size * K * TRAVEL * (bell(2.0 * np.pi * rate * t + phase(d)) - mean)


def pumped_stiffness(size, d, t):
    angle = 2.0 * np.pi * 10.0 ** d.at(-0.5, 0.7) / TIME * t + phase(d)
    return size * K * (5.0 - UNEVEN.rest) * np.sin(angle)


@pytest.mark.parametrize(
    "law",
    [cracked_spring, settling_load, cogging, pumped_stiffness],
    ids=lambda law: law.__name__,
)
@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("size", [0.3, 0.8])
def test_a_force_comes_with_time_as_the_law_says(law, share, size):
    made, defining, draws = drawn(law.__name__, size, share)
    expected = law(size, draws, np.arange(1, 4001) * SUBSTEP)
    known = np.isfinite(expected)
    np.testing.assert_allclose(held(made, 5.0, 4.0)[known], expected[known], atol=1e-6)
    if "time" in defining:
        assert defining["time"] == pytest.approx(moment(draws))
    if "frequency" in defining:
        assert defining["frequency"] == pytest.approx(10.0 ** draws.at(-0.7, 0.2) / TIME)


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("size", [0.3, 0.8])
def test_a_joint_gives_way_from_its_moment_on_where_it_is_stretched(share, size):
    """What a joint no longer takes: its stiffness times the play (Krasnosel'skii) of the path."""
    law, defining, d = drawn("slipping_joint", size, share)
    assert defining == {"time": pytest.approx(moment(d))}
    reach = d.at(0.05, 0.3) * TRAVEL
    steps = np.arange(1, 4001)
    path = UNEVEN.rest + 2.0 * reach * np.sin(0.013 * steps) * np.sin(0.0011 * steps)
    dragged, place = [], 0.0
    for t, x in zip(steps * SUBSTEP, path - UNEVEN.rest, strict=True):
        if t > moment(d) and abs(x - place) > reach:
            place = x - np.copysign(reach, x - place)
        dragged.append(place)
    assert np.ptp(dragged) > 0.1 * reach
    assert not np.any(np.array(dragged)[steps * SUBSTEP <= moment(d)])
    lost = -0.5 * size * K * np.array(dragged)
    np.testing.assert_allclose(resist(law, path), lost, atol=1e-6)
