"""What an input does between its samples."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import map_coordinates
from scipy.signal import lsim

from dea.errors import InputError
from dea.simulation import ExtendedSimulation, load_simulation
from dea.simulation.interpolation import at_steps, spline_points

U = np.random.default_rng(5).standard_normal(50)


def test_zero_holds_each_sample():
    found = at_steps(U, 3, "zero")
    assert found.size == 151
    assert np.array_equal(found[:-1], np.repeat(U, 3))
    assert found[-1] == U[-1]


def test_linear_joins_samples_and_stays_after_the_last():
    found = at_steps(U, 2, "linear")
    assert np.array_equal(found[::2][:-1], U)
    assert np.allclose(found[1:-2:2], 0.5 * (U[1:] + U[:-1]))
    assert np.array_equal(found[-2:], U[[-1, -1]])


@pytest.mark.parametrize("substeps", [2, 3, 8])
@pytest.mark.parametrize("size", [1, 2, 7, 50])
def test_points_between_smooth_samples_are_those_of_a_spline(size, substeps):
    """Compared with scipy's interpolation of images, which finds each point by itself."""
    places = np.minimum(np.arange(size * substeps + 1) / substeps, size - 1)
    expected = map_coordinates(U[:size], places[None], order=5, mode="nearest")
    np.testing.assert_allclose(spline_points(U[:size], substeps), expected, rtol=0, atol=1e-9)


@pytest.mark.parametrize("share", [0.02, 0.1, 0.2, 0.25])
def test_a_system_feels_a_smooth_input_as_the_sine_it_was_sampled_from(share):
    """A low pass driven by the joined points moves as under the sine itself, which lines do not."""
    samples, substeps, slow = 400, 8, 3.0
    omega = 2 * np.pi * share

    # Long after its start, the low pass follows the sine with its frequency response.
    shown = np.arange(100, 300)
    expected = np.imag(np.exp(1j * omega * shown) / (1.0 + 1j * omega * slow))
    times = np.arange(samples * substeps + 1) / substeps
    sampled = np.sin(omega * np.arange(samples))
    errors = {}
    for interpolation in ("linear", "smooth"):
        u = at_steps(sampled, substeps, interpolation)
        _, moved, _ = lsim(([1.0], [slow, 1.0]), u, times)  # exact between joined points
        errors[interpolation] = np.std(moved[shown * substeps] - expected) / np.std(expected)
    lost = 1.0 - np.sinc(share) ** 2
    assert errors["linear"] == pytest.approx(lost, rel=0.3)
    assert errors["smooth"] < 0.2 * errors["linear"] + 1e-6


@pytest.mark.parametrize("substeps", [1, 3])
def test_a_simulation_moves_as_its_device_under_the_band_limited_input(substeps):
    own = replace(load_simulation("mass_spring_damper"), input_interpolation="smooth", lead_in=0.5)
    dt, fine, n = 1.0 / 600.0, 20, 600
    extended = ExtendedSimulation(own, substeps=substeps)
    values = extended.layout.prior_means
    values[:3] = 40.0, 0.3, 1.0
    t = np.arange(n * fine) * dt / fine
    u = sum(np.sin(2 * np.pi * f * t + f) for f in (7.0, 31.0, 60.0, 90.0))
    omega = 2 * np.pi * 40.0
    system = [omega**2], [1.0, 2 * 0.3 * omega, omega**2]
    _, y, _ = lsim(system, u, t)
    found = extended.simulate(values, u[::fine], dt)
    # What the device remembers of its start has gone after a third.
    assert np.std((found - y[::fine])[n // 3 :]) < 0.01 * np.std(y)


def test_another_behaviour_between_samples_is_refused():
    with pytest.raises(InputError, match="Choose from zero, linear, smooth"):
        replace(load_simulation("mass_spring_damper"), input_interpolation="cubic")
