"""Equations that compiled code would run without a word."""

from dataclasses import replace

import numpy as np
import pytest

from dea.errors import InputError
from dea.simulation import Parameter, Simulation, State, load_simulation

CARRIAGE = load_simulation("mass_spring_damper")


def in_a_branch_parameter(x, u, p, dx):
    dx[0] = x[1]
    dx[1] = u - x[0]
    if u > 0.5:
        dx[1] += p[9]


def in_a_branch_state(x, u, p, dx):
    dx[0] = x[1]
    dx[1] = u - x[0]
    if u > 0.5:
        dx[2] = x[-1]


def asserting(x, u, p, dx):
    assert abs(x[1]) < 6.0
    dx[0] = x[1]
    dx[1] = u - x[0]


def raising(x, u, p, dx):
    dx[0] = x[1]
    dx[1] = u - x[0]
    if x[0] > 5.0:
        raise ValueError("too far")


def returning(x, u, p, dx):
    return [x[1], u - x[0]]


@pytest.mark.parametrize(
    ("derivative", "problem"),
    [
        (returning, r"returns a value \(return \[x\[1\], u - x\[0\]\]\).*dx\[0\] to dx\[1\]"),
        (in_a_branch_parameter, r"not declared \(p\[9\]\)"),
        (in_a_branch_state, r"not declared \(dx\[2\]\)"),
        (asserting, r"raises an exception \(assert abs\(x\[1\]\) < 6.0\)"),
        (raising, r"raises an exception \(raise ValueError\('too far'\)\)"),
    ],
)
def test_what_compiled_code_does_not_check_is_read_in_the_source(derivative, problem):
    with pytest.raises(InputError, match=f"derivative: .*{problem}"):
        replace(CARRIAGE, derivative=derivative)


@pytest.mark.parametrize(
    ("part", "value"),
    [
        ("accuracy", -1.0),
        ("accuracy", "5%"),
        ("output_offset_spread", np.nan),
        ("lead_in", -1.0),
        ("lead_in", np.inf),
    ],
)
def test_a_number_that_cannot_be_one_is_refused_by_name(part, value):
    with pytest.raises(InputError, match=f"{part}: it is .*finite number that is not negative"):
        replace(CARRIAGE, **{part: value})


def test_deviations_and_nominal_values_are_checked():
    with pytest.raises(InputError, match=r"parameters.k.spread: it is nan"):
        Parameter("k", "1", 1.0, np.nan)
    first, *others = CARRIAGE.states
    with pytest.raises(InputError, match=rf"states.{first.name}.spread: it is -1.0"):
        replace(CARRIAGE, states=(State(first.name, first.unit, 0.0, spread=-1.0), *others))
    own, *rest = CARRIAGE.parameters
    beyond = replace(own, low=1.5 * own.nominal, high=2.0 * own.nominal)
    with pytest.raises(InputError, match=rf"parameters.{own.name}.nominal: .*its bounds are"):
        replace(CARRIAGE, parameters=(beyond, *rest))


def test_functions_within_an_equation_and_replaced_arguments_are_its_own_matter():
    def derivative(x, u, p, dx):
        def squared(x):
            return x[5] * x[5]

        p = (p[0], p[1], p[2], 1.0)
        dx[0] = x[1]
        dx[1] = p[3] * (u - x[0]) - p[1] * x[1] + 0.0 * squared((0.0, 0.0, 0.0, 0.0, 0.0, 1.0))

    assert isinstance(replace(CARRIAGE, derivative=derivative), Simulation)


def test_a_simulation_without_source_at_hand_is_taken():
    made = {}
    exec("def derivative(x, u, p, dx):\n    dx[0] = x[1]\n    dx[1] = u - x[0]", made)
    assert isinstance(replace(CARRIAGE, derivative=made["derivative"]), Simulation)
