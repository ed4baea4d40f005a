"""In which order the parameters of a named effect are told, and with which intervals."""

from dataclasses import asdict, replace
from types import MappingProxyType, SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.stats import norm

from dea.discrepancy.evidence.model_error import ModelError
from dea.discrepancy.evidence.steepness import shortened
from dea.discrepancy.evidence.uncertainty import uncertainty
from dea.discrepancy.fitting.fit import Fit
from dea.discrepancy.report.estimates import estimates, quantities, quoted
from dea.simulation import Attached, Parameter, catalogue
from dea.simulation.effects import Quantity
from dea.simulation.page import REFERENCE


def law_of(parameters, coordinates, defining="", units=MappingProxyType({}), high=10.0):
    """A fit of a law with these parameters, and the law as it is attached."""
    attached = SimpleNamespace(parameters=parameters, effect=SimpleNamespace(defining=defining))
    extended = SimpleNamespace(
        attached=[attached],
        layout=SimpleNamespace(
            effect_slices=[slice(0, len(parameters))],
            free=np.arange(len(parameters)),
            at_start=np.array([p.at_start for p in parameters]),
            bounds=(np.full(len(parameters), -10.0), np.full(len(parameters), high)),
        ),
        places=SimpleNamespace(
            own_unit=lambda attached, each: units.get(each.at_port, (0.0, 1.0, each.unit))
        ),
    )
    values = np.array([p.value(x) for p, x in zip(parameters, coordinates, strict=True)])
    return SimpleNamespace(extended=extended, coordinates=coordinates, values=values), attached


# Standard deviations from the middle of a normal law to the end of its 95 % interval.
END = float(norm.ppf(0.975))
PARAMETERS = (
    Parameter("even", "1", 0.0, 1.0),
    Parameter("cubic", "1", 0.0, 2.0),
    Parameter("ratio", "1", 1.0, 1.0, log=True, shape=True),
    Parameter("time", "s", 1.0, 1.0, log=True),
    Parameter("begun", "1", 1.0, 1.0, at_start=True),
)
COORDINATES = np.array([0.002, -0.15, 1.0, np.log(3.0), 4.0])
DEVIATION = np.array([0.013, 0.02, 0.05, 1.0, 1e-5])


def test_the_defining_parameter_comes_first_then_what_moved_furthest():
    """Whatever its unit, and whether it only shapes the law; a start comes last."""
    fit, attached = law_of(PARAMETERS, COORDINATES, "time")
    found = estimates(fit, 0, DEVIATION)
    assert list(found) == ["time", "ratio", "cubic", "even", "begun"]
    assert found["cubic"].value == pytest.approx(-0.3)
    assert found["cubic"].low == pytest.approx(-0.3 - END * 0.04)
    assert found["cubic"].moved == pytest.approx(7.5)
    assert found["ratio"].high == pytest.approx(np.exp(1.0 + END * 0.05))
    assert quoted(attached, found) == ("time", "ratio", "cubic")


def test_of_parameters_that_may_be_as_expected_one_is_quoted():
    fit, attached = law_of(PARAMETERS, 0.001 * COORDINATES)
    found = estimates(fit, 0, np.append(DEVIATION[:4], 1.0))
    assert quoted(attached, found) == ("ratio",)


def test_what_parameters_amount_to_has_an_interval_by_their_covariance():
    """A sum may be known better than either part; nothing lies beyond a bound."""
    fit, attached = law_of(
        (Parameter("even", "N", 0.0, 1.0, at_port="force"), Parameter("odd", "1", 0.0, 1.0)),
        np.array([2.0, 1.0]),
        units={"force": (0.0, 5.0, "mN")},
        high=2.0,
    )
    attached.scales = REFERENCE
    fit.extended.layout.values = lambda coordinates: coordinates
    attached.effect.quantities = (
        Quantity("sum", "even", lambda q, scales: q[0] + q[1] + scales.duration),
        Quantity("bounded", "odd", lambda q, _: q[0]),
    )
    covariance = np.array([[0.2501, -0.25], [-0.25, 0.2501]])
    wide = {"bounds": (np.full(2, -9), np.full(2, 9))}
    layout = SimpleNamespace(**{**vars(fit.extended.layout), **wide})
    unbounded = SimpleNamespace(**{**vars(fit.extended), "layout": layout})
    free = SimpleNamespace(extended=unbounded, coordinates=fit.coordinates, values=fit.values)
    found = quantities(free, 0, covariance)["sum"]
    assert (found.value, found.unit) == (5.0 * (3.0 + REFERENCE.duration), "mN")
    assert found.high - found.value == pytest.approx(5.0 * END * np.sqrt(2e-4), rel=0.15)
    assert found.value - found.low == pytest.approx(5.0 * END * np.sqrt(2e-4), rel=0.15)
    bounded = quantities(fit, 0, covariance)["bounded"]
    assert bounded.high == 2.0
    assert bounded.low == pytest.approx(2.0 - END * 0.5, rel=0.15)


def test_of_an_event_the_instant_is_quoted():
    fit, _ = law_of(
        catalogue()["step_fault"].parameters(REFERENCE),
        np.array([0.1, 4.0, 0, 0, 0.1, 0, 0, 0, 0, 0, 0, 0, 0]),
    )
    attached = Attached(catalogue()["step_fault"], REFERENCE)
    fit.extended.attached[0] = attached
    assert quoted(attached, estimates(fit, 0, np.ones(13))) == ("instant", "gain_step")


def test_what_a_port_normalises_is_in_the_unit_that_the_simulation_gives_it():
    parameters = (
        Parameter("stop", "1", 0.4, 0.1, at_port="place"),
        Parameter("radius", "1", 0.5, 1.0, log=True, at_port="length"),
        Parameter("stiffness", "1", 5.0, 1.0),
    )
    units = {"place": (10.0, -2.0, "mm"), "length": (0.0, -2.0, "mm")}
    fit, _ = law_of(parameters, np.array([2.0, -np.log(2.0), 1.0]), units=units, high=2.0)
    found = estimates(fit, 0, np.array([0.5, 0.1, 2.0]))
    assert asdict(found["stop"]) == pytest.approx(
        {
            "value": 8.8, "unit": "mm", "low": 8.604, "high": 8.996, "prior": 9.2, "origin": 10.0,
            "at_bound": True, "moved": 4.0,
        }
    )  # fmt: skip
    assert not found["radius"].at_bound
    assert found["radius"].value == pytest.approx(-0.5)
    assert found["radius"].low == pytest.approx(-0.5 * np.exp(0.1 * END))
    assert (found["radius"].unit, found["radius"].prior) == ("mm", -1.0)
    assert (found["stiffness"].unit, found["stiffness"].origin) == ("1", 0.0)


def as_problem(samples, residual):
    """A problem whose residual is a function of the coordinates (k,)."""

    def of(noise):
        return SimpleNamespace(
            seen=np.ones(samples, bool),
            residual=lambda extended, values: residual(values),
            noise=noise,
            with_noise=of,
        )

    return of(1.0)


def fit_of(residual, coordinates, low=-np.inf):
    """A problem and a fit whose residual is a function of the coordinates (k,)."""
    step = 1e-6 * np.eye(coordinates.size)
    columns = [(residual(coordinates + s) - residual(coordinates - s)) / 2e-6 for s in step]
    extended = SimpleNamespace(
        simulation=SimpleNamespace(accuracy=0.0),
        layout=SimpleNamespace(
            bounds=(low + np.zeros(coordinates.size), np.full(coordinates.size, np.inf)),
            values=lambda x: x,
        ),
    )
    found = residual(coordinates)
    problem = as_problem(found.size, residual)
    return problem, Fit(extended, coordinates, found, np.array(columns).T, 0.0)


@pytest.mark.parametrize("at_bound", [False, True])
def test_parameters_alike_at_first_order_are_as_sure_as_a_dense_grid_says(at_bound):
    """The second one does what the first one does, and something else by its square.

    Directions are shortened and not turned, so that the deviations are right to a quarter.
    """
    noise = np.random.default_rng(2).standard_normal(800)
    both, square = np.sin(np.arange(800.0)), np.cos(0.3 * np.arange(800.0))
    for regressor in (both, square):
        noise -= regressor * (regressor @ noise) / (regressor @ regressor)

    def residual(x):
        return noise - both * (x[0] + x[1]) - 8.0 * square * x[1] ** 2

    low = np.array([-np.inf, 0.0 if at_bound else -np.inf])
    problem, fitted = fit_of(residual, np.zeros(2), low)
    curved = fitted.covariance(problem.seen, 1.0)
    found = np.sqrt(np.diag(shortened(problem, fitted, curved, 1.0)))

    sum_of, second = np.meshgrid(np.linspace(-0.5, 0.5, 801), np.linspace(-0.6, 0.6, 801))
    first = sum_of - second
    rise = both @ both * sum_of**2 + 64.0 * square @ square * second**4
    weight = np.exp(-0.5 * (rise + first**2 + second**2))
    expected = [np.sqrt((weight * x**2).sum() / weight.sum()) for x in (first, second)]
    assert (np.sqrt(np.diag(curved)) > 5.0 * np.array(expected)).all()
    # About the fit, which is symmetric, the half that a bound leaves is as wide as both.
    assert found == pytest.approx(expected, rel=0.25)


@pytest.mark.parametrize("power", [2.0, 4.0, 12.0])
@pytest.mark.parametrize("end", [0.02, 0.3, 0.9])
def test_a_direction_ends_where_its_cost_has_risen(power, end):
    """A cost of any steepness along one coordinate, of which the curvature knows nothing."""

    def residual(x):
        return np.array([(abs(x[0]) / (END * end)) ** (power / 2) * END, 0.0])

    problem, fitted = fit_of(residual, np.zeros(1))
    [[variance]] = shortened(problem, fitted, np.eye(1), 1.0)
    expected = brentq(lambda part: (part / end) ** power + part**2 - 1.0, 0.0, 1.0)
    assert np.sqrt(variance) == pytest.approx(expected, rel=0.06)


def test_a_wall_ends_a_direction_and_a_closed_side_does_not_count():
    def residual(x):
        return np.array([np.inf if x[0] > 1.0 else 0.0])

    problem, fitted = fit_of(residual, np.zeros(1), low=-1e-3)
    fitted = replace(fitted, jacobian=np.zeros((1, 1)))
    [[variance]] = shortened(problem, fitted, np.eye(1), 1.0)
    assert END * np.sqrt(variance) == pytest.approx(1.0, rel=0.02)


@pytest.mark.parametrize("slope", [0.0, 1e-5, 1e-3])
def test_a_stop_that_is_not_reached_is_unsure_whatever_is_beside_it(slope):
    """Neither the second coordinate nor the fifth moves the output much at first order.

    The second does so beyond a wall on one side, the fifth on both.
    """
    J = 0.3 * np.random.default_rng(5).standard_normal((9, 7))
    J[:, [1, 4]] *= slope

    def residual(x):
        return np.concatenate([J @ x, [1e3 * max(x[1] - 0.5, 0.0), 1e3 * x[4] ** 2]])

    problem, fitted = fit_of(residual, np.zeros(7))
    fitted = replace(fitted, jacobian=np.vstack([J, np.zeros((2, 7))]))
    curved = fitted.covariance(problem.seen, 1.0)
    found = np.sqrt(np.diag(shortened(problem, fitted, curved, 1.0)))
    expected = np.sqrt(np.diag(curved))
    # The cost of the fifth, 1e6 x^4, has risen by END^2 at the end of its interval.
    expected[4] = np.sqrt(1e-3 * END) / END
    assert found == pytest.approx(expected, rel=0.05)


def test_a_linear_fit_is_as_sure_as_its_curvature_says():
    J = np.random.default_rng(4).standard_normal((300, 3)) * [0.02, 0.1, 1.0]
    problem, fitted = fit_of(lambda x: J @ x, np.array([0.3, -2.0, 0.0]))
    curved = fitted.covariance(problem.seen, 1.0)
    # Where the prior pulls, the cost may even fall: it is no steeper.
    assert shortened(problem, fitted, curved, 1.0) == pytest.approx(curved)


@pytest.mark.parametrize("samples", [500, 5000])
def test_an_interval_holds_a_law_of_another_form_however_long_the_record_is(samples):
    """The other law differs by a twentieth of the effect, all of which passes for its size."""
    rng = np.random.default_rng(3)
    effect = np.repeat(rng.standard_normal(samples // 50), 50)
    effect *= 4.0 / np.sqrt(np.mean(effect**2))
    noise = rng.standard_normal(samples)
    problem, fitted = fit_of(lambda x: noise - effect * (x[0] - 1.05), np.array([1.05]))
    error = ModelError(1.0, 0.0, 0.05 * 4.0, 30.0)
    [deviation] = uncertainty(problem, fitted, np.zeros(1), error).deviation
    assert deviation == pytest.approx(0.05, rel=0.05)
    spread = uncertainty(problem, fitted, np.array([0.2]), error)
    assert spread.deviation[0] == pytest.approx(0.2)
    assert spread.covariance[0, 0] == pytest.approx(0.04)


def test_coordinates_are_as_sure_as_the_worse_of_curvature_and_folds():
    rng = np.random.default_rng(4)
    J = rng.standard_normal((400, 3)) @ np.array([[1.0, 0.8, 0.0], [0, 1.0, 0], [0, 0, 1.0]])
    noise = rng.standard_normal(400)
    problem, fit = fit_of(lambda x: noise + J @ x, np.zeros(3))
    error = ModelError(1.0, 0.0, 0.0, 1.0)
    curved = uncertainty(problem, fit, np.zeros(3), error)
    np.testing.assert_allclose(np.diag(curved.covariance), curved.deviation**2)
    spread = np.array([10.0, 0.0, 1.0]) * curved.deviation
    found = uncertainty(problem, fit, spread, error)
    np.testing.assert_allclose(found.deviation, [10.0, 1.0, 1.0] * curved.deviation)

    def correlation(each):
        return each.covariance / np.outer(each.deviation, each.deviation)

    np.testing.assert_allclose(correlation(found), correlation(curved))
    assert abs(correlation(found)[0, 1]) > 0.3
