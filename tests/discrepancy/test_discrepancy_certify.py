"""What a fitted simulation is worth on a record it has not seen."""

from dataclasses import replace

import numpy as np
import pytest

from dea.discrepancy import diagnose
from dea.discrepancy.evidence.certificate import (
    Certified,
    certify_elsewhere,
    contradicting,
    transferable,
)
from dea.discrepancy.fitting.fit import at
from dea.discrepancy.problem.problem import Problem, Samples
from dea.errors import InputError
from dea.simulation import (
    ExtendedSimulation,
    Parameter,
    Simulation,
    State,
    catalogue,
    load_simulation,
    measured_scales,
    prepared,
)
from dea.store import Record

INTERVAL, NOISE = 0.02, 0.01
U = np.repeat(np.random.default_rng(1).uniform(-1, 1, 60), 25)


def slow_carriage() -> tuple[Problem, ExtendedSimulation, np.ndarray]:
    """Return a carriage of 0.5 Hz, hardly damped, that was at rest, and its parameter values."""
    own = load_simulation("mass_spring_damper")
    frequency, damping, gain = own.parameters
    parameters = (replace(frequency, nominal=0.5), replace(damping, nominal=0.01), gain)
    extended = prepared(replace(own, parameters=parameters), U, INTERVAL, 1e-3)
    values = extended.layout.prior_means
    everything = np.ones(U.size, bool)
    y = extended.simulate(values, U, INTERVAL)
    y += NOISE * np.random.default_rng(3).standard_normal(U.size)
    return Problem(U, y, INTERVAL, everything, everything, everything, NOISE), extended, values


def recorded(extended, values, **changed):
    values = values.copy()
    for name, value in changed.items():
        values[extended.layout.names.index(name.replace("__", "."))] = value
    y = extended.simulate(values, -U, INTERVAL)
    return Samples(-U, y + NOISE * np.random.default_rng(2).standard_normal(U.size), INTERVAL)


def test_elsewhere_only_the_state_at_the_start_is_fitted():
    problem, extended, values = slow_carriage()
    fitted = at(problem, extended, extended.layout.coordinates(values))
    others = {
        "moving": recorded(extended, values, initial__position=0.2, initial__velocity=5.0),
        "stiffer": recorded(extended, values, natural_frequency=0.7),
    }
    found = certify_elsewhere(others, fitted, fitted)
    assert found["moving"].after == pytest.approx(NOISE, rel=0.1)
    assert found["moving"].samples == U.size
    assert found["stiffer"].after > 10 * NOISE
    assert np.std(others["moving"].y - problem.y[: U.size]) > 10 * NOISE


@pytest.mark.parametrize(
    ("name", "moves_on"),
    [("dead_zone", True), ("step_fault", False), ("baseline_drift", False),
     ("periodic_disturbance", False)],
)  # fmt: skip
def test_what_happened_at_a_time_says_nothing_of_another_record(name, moves_on):
    problem, extended, values = slow_carriage()
    told = measured_scales(extended, values, problem)
    assert transferable(extended.attach(catalogue()[name], told)) is moves_on


def settling(x, u, p, dx):
    """Two states that settle slowly, the second one more so."""
    dx[0] = -x[0] / 8.0
    dx[1] = -x[1] / 12.0


def both(x, u, p):
    return p[0] * u + x[0] + x[1]


def settling_device():
    """Return a fit that knows how the device begins, and what it does then."""
    own = Simulation(
        name="settling",
        input_unit="V",
        output_unit="V",
        states=(State("fast", "V", 0.0, 3.0), State("slow", "V", 0.0, 3.0)),
        parameters=(Parameter("gain", "1", 1.0, 0.3, 0.1, 10.0, log=True),),
        derivative=settling,
        output=both,
        drive="gain",
        force_ports=(),
    )
    extended = prepared(own, U, INTERVAL, 1e-3)
    values = extended.layout.prior_means
    values[[extended.layout.names.index(f"initial.{name}") for name in ("fast", "slow")]] = (
        3.0,
        -3.0,
    )
    everything = np.ones(U.size, bool)
    y = extended.simulate(values, U, INTERVAL)
    y += NOISE * np.random.default_rng(3).standard_normal(U.size)
    problem = Problem(U, y, INTERVAL, everything, everything, everything, NOISE)
    return at(problem, extended, extended.layout.coordinates(values)), extended, values


def test_a_start_that_is_known_is_not_given_up_for_an_error_of_the_law():
    """In the first tenth the law errs slowly, as two states that settle might do."""
    fitted, extended, values = settling_device()
    erring = recorded(extended, values)
    slow = 3 * NOISE * np.sin(2 * np.pi * np.arange(U.size) * INTERVAL / 8.0)
    found = certify_elsewhere({"erring": replace(erring, y=erring.y + slow)}, fitted, fitted)
    assert found["erring"].after == pytest.approx(np.hypot(np.std(slow), NOISE), rel=0.1)


def test_a_start_unlike_those_that_are_known_is_fitted():
    fitted, extended, values = settling_device()
    other = recorded(extended, values, initial__fast=-2.0, initial__slow=1.0)
    found = certify_elsewhere({"other": other}, fitted, fitted)
    assert found["other"].after < 0.2


@pytest.mark.parametrize("known", [slice(2, 4), slice(300, 1400)])
def test_a_start_is_told_by_the_first_outputs_that_are_known(known):
    fitted, extended, values = settling_device()
    other = recorded(extended, values)
    y = np.full(U.size, np.nan)
    y[known] = other.y[known]
    found = certify_elsewhere({"other": replace(other, y=y)}, fitted, fitted)
    assert found["other"].after == pytest.approx(NOISE, rel=0.6)


def test_a_record_that_is_met_exactly_leaves_no_error():
    fitted, extended, values = settling_device()
    other = Samples(-U, extended.simulate(values, -U, INTERVAL), INTERVAL)
    assert certify_elsewhere({"other": other}, fitted, fitted)["other"].after < 1e-9


DECAYS = np.exp(-np.arange(U.size)[:, None] * INTERVAL / [0.1, 0.2])
STARTS = np.array([[0.0, 0.0], [0.4, -0.8]])


def quickly_settling(x, u, p, dx):
    """Two states whose courses are ``DECAYS``."""
    dx[0] = -x[0] / 0.1
    dx[1] = -x[1] / 0.2


def quick_device():
    """Return a fit to two records that begin at ``STARTS``."""
    own = Simulation(
        name="quickly_settling", input_unit="V", output_unit="V",
        states=(State("fast", "V", 0.0, 3.0), State("slow", "V", 0.0, 3.0)),
        parameters=(Parameter("gain", "1", 1.0, 0.3, 0.1, 10.0, log=True),),
        derivative=quickly_settling, output=both, drive="gain", force_ports=(),
    )  # fmt: skip
    half = U.size // 2
    extended = prepared(own, U, INTERVAL, 1e-3, (half, half))
    values = extended.layout.prior_means
    for record, start in zip(("", "record_2."), STARTS, strict=True):
        for name, value in zip(("fast", "slow"), start, strict=True):
            values[extended.layout.names.index(f"{record}initial.{name}")] = value
    y = extended.simulate(values, U, INTERVAL)
    y += NOISE * np.random.default_rng(3).standard_normal(U.size)
    everything = np.ones(U.size, bool)
    problem = Problem(U, y, INTERVAL, everything, everything, everything, NOISE)
    return at(problem, extended, extended.layout.coordinates(values))


def memory(residual):
    """Return the sum of the autocorrelation about zero up to where it first is not positive."""
    products = np.correlate(residual, residual, "full")[residual.size - 1 :] / (residual @ residual)
    return 1.0 + 2.0 * products[1 : np.argmax(products <= 0.0)].sum()


def errors_from_the_best_start(y):
    """Return the errors from a start that is known or fitted, and whether it is the latter.

    A start of two states gains its samples, in units of their memory, times the fall of the
    logarithm of the error, and costs half a logarithm of their number for each state.
    """
    head = slice(y.size // 10)
    own = np.linalg.lstsq(DECAYS[head], (y + U)[head])[0]
    known = min(STARTS, key=lambda start: np.std((y + U - DECAYS @ start)[head]))
    before, after = (y + U - DECAYS @ start for start in (known, own))
    number = y[head].size
    fall = 0.5 * np.log(np.mean(before[head] ** 2) / np.mean(after[head] ** 2))
    fitted = number / memory(before[head]) * fall > 0.5 * 2 * np.log(number)
    return (after if fitted else before), fitted


@pytest.mark.parametrize("beside", [0, 1])
def test_a_start_is_fitted_where_the_bayesian_information_criterion_takes_it(beside):
    device = quick_device()
    rng = np.random.default_rng(4)
    others, expected, fitted = {}, {}, []
    for away in (0.0, 0.01, 0.02, 0.04, 0.06, 0.1, 0.15):
        start = STARTS[beside] + [away, 0.5 * away]
        y = -U + DECAYS @ start + NOISE * rng.standard_normal(U.size)
        others[str(away)] = Samples(-U, y, INTERVAL)
        errors, own = errors_from_the_best_start(y)
        expected[str(away)] = np.sqrt(np.mean(errors**2))
        fitted.append(own)
    found = certify_elsewhere(others, device, device)
    assert {name: each.after for name, each in found.items()} == pytest.approx(expected, rel=1e-5)
    assert fitted[0] is not fitted[-1]


@pytest.mark.parametrize(
    ("after", "against"),
    [
        ([], []),
        ([0.9], []),
        ([1.1], [0]),
        ([0.9, 1.1], []),
        ([0.9, 1.1, 1.1], [1, 2]),
        ([0.9, np.nan, 1.0], [1]),
        ([0.9, np.inf], [1]),
    ],
)
def test_an_extension_is_contradicted_by_most_other_records_or_where_it_runs_away(after, against):
    found = {n: Certified(1.0, error, 100) for n, error in enumerate(after)}
    assert list(contradicting(found, noise=0.0)) == against
    left = [n for n in against if not np.isfinite(after[n])]
    assert list(contradicting(found, noise=1.1)) == left


def test_where_both_run_away_nothing_is_contradicted_by_one_of_two():
    found = {"away": Certified(np.inf, np.inf, 100), "near": Certified(1.0, 0.9, 100)}
    assert not contradicting(found, noise=0.0)


def test_a_test_record_without_outputs_is_refused_by_its_name_before_anything_is_fitted():
    whole, empty = (
        Record.of(U, y, sampling_rate=1 / INTERVAL, units=("V", "V"))
        for y in (U, np.full(U.size, np.nan))
    )
    with pytest.raises(InputError, match=r"test_records\.empty\.output: no output .* is known"):
        diagnose(whole, "mass_spring_damper", test_records={"empty": empty})
