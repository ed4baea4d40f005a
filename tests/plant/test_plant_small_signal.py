"""The exact responses of a film against simulated sines."""

import numpy as np
import pytest
from films import elastic, nominal

from dea.plant import film as dynamics
from dea.plant.forces import stack
from dea.plant.membrane import zones
from dea.plant.small_signal import hold, responses

BIAS = 1940.0


def harmonics(film, state, frequency, amplitude):
    """Return the first two complex harmonics of a simulated sine about the bias."""
    period = round(1.0 / frequency / dynamics.SUBSTEP)
    cycles = max(3, round(1.0 / frequency) + 2)
    phase = 2 * np.pi * (np.arange(cycles * period) + 0.0) / period
    # A sub-step holds its supply: half of one of delay.
    supply = BIAS + amplitude * np.sin(phase + np.pi / period)
    displacement, voltage = np.empty_like(supply), np.empty_like(supply)
    copy = dynamics.FilmState(*(array.copy() for array in state))
    dynamics.advance(film, copy, stack([]), supply, displacement, voltage)
    last = displacement[-period:] - np.linspace(
        0.0, displacement[-1] - displacement[-1 - period], period
    )
    return [2 / period * np.sum(last * np.exp(-1j * k * phase[-period:])) * 1j for k in (1, 2)]


@pytest.mark.parametrize("frequency", [0.5, 5.0])
@pytest.mark.parametrize("electrode_resistance", [1.0, 2e7])
def test_responses_are_those_of_a_simulated_sine(frequency, electrode_resistance):
    film = nominal(electrode_resistance=electrode_resistance)
    state = dynamics.rest(film, 600.0)
    assert hold(film, state, BIAS, 30.0)
    found = responses(film, state, BIAS, np.array([frequency]))
    amplitude = 40.0
    first, second = harmonics(film, state, frequency, amplitude)
    assert first == pytest.approx(amplitude * found.first[0], rel=0.01)
    # sin² = (1 − cos 2ωt)/2, so that the second harmonic of a sine is turned by a right angle.
    assert second == pytest.approx(-0.5j * amplitude**2 * found.second[0], rel=0.04)


def test_an_elastic_film_answers_slowly_as_its_equilibria_do():
    film = elastic(damping=0.16)
    state = dynamics.rest(film, 0.0)
    assert hold(film, state, BIAS, 1.0)
    found = responses(film, state, BIAS, np.array([1e-3]))
    table = zones(film)
    step = 20.0
    weight = film.mass * dynamics.GRAVITY

    def displacement(supply):
        x = state.scalars[dynamics.X]
        for _ in range(3):
            held = dynamics.held(supply)
            x, stiffness = dynamics.settle(film, table, state.branches, x, held, 1.0)
        return weight / stiffness

    low, here, high = (displacement(BIAS + d) for d in (-step, 0.0, step))
    assert found.first[0].real == pytest.approx((high - low) / (2 * step), rel=1e-3)
    assert found.second[0].real == pytest.approx((high - 2 * here + low) / (2 * step**2), rel=1e-3)


def test_a_film_that_pulls_in_is_not_held():
    film = nominal()
    assert not hold(film, dynamics.rest(film, 600.0), 6000.0, 1.0)
