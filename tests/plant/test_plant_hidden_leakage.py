"""Hidden leakage, and rails with a memory, against a statement of each law, draw by draw."""

import numpy as np
import pytest
from made_conditions import through
from made_draws import SHARES, UNEVEN, command, drawn
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

from dea.plant.film import SUBSTEP

LOW, HIGH, SPAN, TIME = UNEVEN.low, UNEVEN.high, UNEVEN.span, UNEVEN.time
U = command()
U[0] += 0.01
T = np.arange(U.size) * SUBSTEP
WAVE = 2.3 + 1.7 * np.sin(2.0 * np.pi * 1.1 * T)

# The field over that at the ceiling is x, the steepness b.
CURRENTS = {
    "space_charge": (lambda x, b: x**2, 0.0, 0.0),
    "schottky_emission": (
        lambda x, b: (np.exp(b * x**0.5) - 1.0) / (np.exp(b) - 1.0), 3.0, 6.0
    ),
    "hopping": (
        lambda x, b: (np.exp(b * x) - np.exp(-b * x)) / (np.exp(b) - np.exp(-b)), 2.0, 5.0
    ),
    "tunnelling": (lambda x, b: x**2 * np.exp(b) / np.exp(b / np.maximum(x, 1e-3)), 0.7, 2.5),
    "poole_frenkel": (lambda x, b: x * np.exp(b * x**0.5) / np.exp(b), 1.5, 4.0),
}  # fmt: skip


@pytest.mark.parametrize("form", CURRENTS)
@pytest.mark.parametrize("share", SHARES)
def test_a_screening_charge_is_fed_by_its_law_of_conduction(form, share):
    made, defining, draws = drawn(form, 0.5, share)
    assert not defining
    assert not made.output
    current, *ends = CURRENTS[form]
    time, steep = TIME * draws.log(1.0, 8.0), draws.at(*ends)

    def charge(t, m):
        x = np.maximum(2.3 + 1.7 * np.sin(2.0 * np.pi * 1.1 * t) - m, 0.0) / HIGH
        return (0.5 * HIGH * current(x, steep) - m) / time

    solved = solve_ivp(charge, (0.0, T[-1]), [0.0], max_step=0.02, rtol=1e-8, dense_output=True)
    expected = np.maximum(WAVE - solved.sol(T)[0], 0.0)
    np.testing.assert_allclose(through(made, WAVE), expected, atol=2e-3 * HIGH)
    # Held at the ceiling, the field and its current are in balance.
    left = through(drawn(form, 0.5, share)[0], np.full(40_000, HIGH))[-1] / HIGH
    assert 1.0 - left == pytest.approx(0.5 * current(left, steep), rel=1e-2)


def polarised(signal, weights, times):
    """Return a signal less its lags, which begin at nothing; exact for held values."""
    left = signal.copy()
    for weight, time in zip(weights, times, strict=True):
        kept = np.exp(-SUBSTEP / time)
        left -= weight * lfilter([1.0 - kept], [1.0, -kept], signal)
    return left


@pytest.mark.parametrize("share", SHARES)
def test_two_polarisations_divide_what_is_lost(share):
    made, defining, draws = drawn("interfacial_polarisation", 0.4, share)
    assert not defining
    assert not made.output
    short, first = TIME * draws.at(0.4, 2.0), draws.at(0.3, 0.7)
    times = [short, short * draws.at(5.0, 25.0)]
    expected = polarised(U, [0.4 * first, 0.4 * (1.0 - first)], times)
    np.testing.assert_allclose(through(made, U), expected, atol=1e-9)


@pytest.mark.parametrize("share", SHARES)
def test_absorption_has_ten_times_over_three_decades(share):
    made, defining, draws = drawn("curie_von_schweidler", 0.4, share)
    assert not defining
    assert not made.output
    times = 0.3 * TIME * np.geomspace(1.0, 1000.0, 10)
    weights = times ** (1.0 - draws.at(0.6, 0.95))
    expected = polarised(U, 0.4 * weights / weights.sum(), times)
    np.testing.assert_allclose(through(made, U), expected, atol=1e-9)
    # Within the decades the current falls as the power of time.
    t = TIME * np.array([3.0, 9.0])
    current = np.exp(-np.outer(t, 1.0 / times)) @ (weights / times)
    power = -np.diff(np.log(current)) / np.log(3.0)
    assert power[0] == pytest.approx(draws.at(0.6, 0.95), abs=0.08)


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("size", [0.12, 0.44])
def test_a_rail_sags_with_the_mean_of_what_it_gives(share, size):
    made, defining, draws = drawn("sagging_rail", size, share)
    assert not defining
    assert not made.output
    limit, sag = HIGH - size * SPAN, draws.at(0.1, 0.4)
    kept = np.exp(-SUBSTEP / (draws.at(0.5, 4.0) * TIME))
    for signal in (U, U[::-1], np.full(3000, HIGH)):
        passed = through(drawn("sagging_rail", size, share)[0], signal)
        # It begins as after a long time at its first value.
        first = min(signal[0], limit)
        mean = lfilter([0.0, 1.0 - kept], [1.0, -kept], passed - first) + first
        rail = limit + sag * (limit - mean)
        np.testing.assert_allclose(passed, np.minimum(signal, rail), atol=1e-9)
    np.testing.assert_allclose(passed, limit, rtol=1e-9)


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("size", [0.2, 0.5])
def test_an_overload_s_integral_is_worked_off_at_a_rate_and_what_is_under(share, size):
    made, defining, draws = drawn("overload_recovery", size, share)
    bottom, top, travel = UNEVEN.bottom, UNEVEN.top, UNEVEN.travel
    limit, time = top - size * travel, draws.at(0.05, 0.25) * TIME
    assert made.output
    assert defining == {"limit": pytest.approx(limit)}
    rate = 0.1 * travel
    for over, under in ((0.004, 1e-6), (0.004, 0.3), (0.3, 1e-6), (0.3, 0.05), (0.3, 0.3)):
        steps = 70
        levels = [bottom, limit + over * travel, limit - under * travel]
        read = through(
            drawn("overload_recovery", size, share)[0], np.repeat(levels, [9, steps, 400])
        )
        np.testing.assert_array_equal(read[:9], bottom)
        np.testing.assert_array_equal(read[9 : 9 + steps], limit)
        # The integral grows to no more than what is worked off in its time.
        held = min(over * travel * steps * SUBSTEP, rate * time) / (rate + under * travel)
        late = np.count_nonzero(read[9 + steps :] == limit) * SUBSTEP
        assert late == pytest.approx(held, abs=1.01 * SUBSTEP)
        assert read[-1] == levels[-1]
