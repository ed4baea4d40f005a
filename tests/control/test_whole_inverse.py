"""The inverse of a simulation along a whole reference: against dense least squares and itself."""

import numpy as np
import pytest
from scipy.optimize import minimize

from dea.control import InputLimits, whole_inverse
from dea.errors import InputError

FREE = {"memory": 12, "change": 1e-3, "limits": InputLimits(-1e3, 1e3, 1e3)}


def linear(u):
    """Two poles and a delay of a sample, at rest before."""
    y = np.zeros(u.size)
    for t in range(1, u.size):
        y[t] = 0.5 * y[t - 1] + 0.8 * u[t - 1] - (0.06 * y[t - 2] if t > 1 else 0.0)
    return y


def film(u):
    """A lag with a gain that rises with the input, and a slow relaxation behind it."""
    y, slow = np.zeros(u.size), 0.0
    for t in range(1, u.size):
        slow += 0.002 * (u[t - 1] ** 2 - slow)
        y[t] = 0.6 * y[t - 1] + 0.4 * (u[t - 1] ** 2 + 0.2 * slow)
    return y


def test_of_a_linear_simulation_it_is_the_solution_of_dense_least_squares():
    samples, first, weight = 60, 5, 0.03
    reference = np.sin(0.2 * np.arange(samples))
    reference[:first] = np.nan
    begun = np.full(samples, 0.3)
    found = whole_inverse(linear, reference, begun, weight=weight, **FREE | {"memory": 40})
    jacobian = np.array([linear(row) for row in np.eye(samples)[first:]]).T
    curves = np.diff(np.eye(samples), 2, axis=0)
    rows = np.vstack([jacobian[first:], np.sqrt(weight) * curves[:, first:]])
    offset = np.concatenate(
        [
            (reference - linear(np.where(np.arange(samples) < first, begun, 0.0)))[first:],
            -np.sqrt(weight) * curves[:, :first] @ begun[:first],
        ]
    )
    expected = np.linalg.lstsq(rows, offset, rcond=None)[0]
    np.testing.assert_allclose(found.inputs[first:], expected, atol=1e-7)
    np.testing.assert_array_equal(found.inputs[:first], begun[:first])
    error = (reference - linear(found.inputs))[first:]
    assert found.error == pytest.approx(np.sqrt(np.mean(error**2)), rel=1e-12)


def test_of_a_nonlinear_one_with_a_long_memory_no_general_optimiser_finds_better():
    samples, weight = 50, 1e-3
    reference = 1.0 + 0.4 * np.sin(0.3 * np.arange(samples))
    reference[:4] = np.nan
    found = whole_inverse(film, reference, np.ones(samples), weight=weight, **FREE)

    def cost(inputs):
        u = np.concatenate([np.ones(4), inputs])
        return np.nansum((reference - film(u)) ** 2) + weight * np.sum(np.diff(u, 2) ** 2)

    other = minimize(cost, found.inputs[4:], method="BFGS", options={"gtol": 1e-9})
    assert cost(found.inputs[4:]) < 1.01 * other.fun


def test_limits_and_rate_are_kept():
    reference = np.where(np.arange(80) < 40, 0.5, 4.0)
    reference[:2] = np.nan
    found = whole_inverse(
        film, reference, np.full(80, 0.7), weight=1e-6,
        **FREE | {"limits": InputLimits(0.6, 1.8, 0.1)},
    )  # fmt: skip
    assert found.inputs.min() >= 0.6
    assert found.inputs.max() == 1.8
    assert np.abs(np.diff(found.inputs)).max() <= 0.1 + 1e-12


def test_inputs_to_begin_with_that_leave_the_limits_are_brought_within_them():
    """They give the reference without an error, so that no step would change them."""
    begun = np.concatenate([[1.0, 1.0], np.full(38, 5.0)])
    reference = linear(begun)
    reference[:2] = np.nan
    limits = InputLimits(-2.0, 2.0, 0.25)
    found = whole_inverse(linear, reference, begun, weight=1e-3, **FREE | {"limits": limits})
    assert found.inputs.max() == 2.0
    assert np.abs(np.diff(found.inputs)).max() <= 0.25 + 1e-12
    assert np.array_equal(found.inputs[:2], begun[:2])
    assert begun[2] == 5.0
    with pytest.raises(InputError, match="begun"):
        whole_inverse(linear, reference, begun + 1.5, weight=1e-3, **FREE | {"limits": limits})


@pytest.mark.parametrize(
    ("change", "field"),
    [({"limits": InputLimits(1.0, -1.0, 0.1)}, "limits"),
     ({"limits": InputLimits(-np.inf, 1.0, 0.1)}, "limits"),
     ({"limits": InputLimits(-1.0, 1.0, np.nan)}, "limits"), ({"memory": 0}, "memory"),
     ({"weight": 0.0}, "weight"), ({"weight": np.inf}, "weight"), ({"change": 0.0}, "change"),
     ({"change": np.nan}, "change")],
)  # fmt: skip
def test_settings_out_of_range_are_refused(change, field):
    reference = np.concatenate([[np.nan, np.nan], np.ones(28)])
    with pytest.raises(InputError) as refused:
        whole_inverse(linear, reference, np.zeros(30), **{"weight": 1.0} | FREE | change)
    assert refused.value.field == field


@pytest.mark.parametrize("wanted", [[np.nan] * 30, [np.nan, np.nan, 1.0], []])
def test_a_reference_that_wants_less_than_two_outputs_is_refused(wanted):
    begun = np.zeros(len(wanted))
    with pytest.raises(InputError, match="fewer than two outputs are wanted") as refused:
        whole_inverse(linear, np.array(wanted), begun, weight=1.0, **FREE)
    assert refused.value.field == "reference"
    whole_inverse(linear, np.array([np.nan, np.nan, 1.0, 1.0]), np.zeros(4), weight=1.0, **FREE)


def test_inputs_to_begin_with_of_another_length_are_refused():
    reference = np.concatenate([[np.nan, np.nan], np.ones(28)])
    with pytest.raises(InputError, match="29 samples, and the reference 30") as refused:
        whole_inverse(linear, reference, np.zeros(29), weight=1.0, **FREE)
    assert refused.value.field == "begun"


def test_a_step_that_is_too_long_is_shortened():
    """Gauss-Newton on arctan from far off would jump further off."""

    def flat(u):
        return np.arctan(np.concatenate([[0.0], u[:-1]]))

    reference = np.concatenate([[np.nan, np.nan], np.zeros(28)])
    found = whole_inverse(flat, reference, np.full(30, 2.0), weight=1e-6, **FREE)
    np.testing.assert_allclose(found.inputs[2:-1], 0.0, atol=0.01)


def test_a_simulation_that_diverges_is_said():
    def diverging(u):
        return np.where(np.arange(u.size) < 30, 1.0, np.nan)

    with pytest.raises(InputError, match="diverges at sample 30"):
        whole_inverse(
            diverging, np.where(np.arange(50) < 2, np.nan, 1.0), np.ones(50), weight=1.0, **FREE
        )


def test_a_reference_without_a_beginning_is_refused():
    with pytest.raises(InputError, match="from sample 0 on"):
        whole_inverse(linear, np.ones(50), np.ones(50), weight=1.0, **FREE)
