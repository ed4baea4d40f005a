"""Kinds of force laws, and functions called by their addresses."""

import importlib
import pkgutil

import numpy as np
import pytest
from made_conditions import CONDITIONS
from numba import float64, njit

from dea.by_address import address, called
from dea.plant import force_laws
from dea.plant.force_laws.kind import Kind
from dea.plant.forces import ForceLaw, stack, total_force, update_memory
from dea.plant.hidden import EFFECTS

SIGNATURE = float64(float64)
function_at = called(SIGNATURE)
KINDS = {
    f"{module.name}.{name}": value
    for module in pkgutil.iter_modules(force_laws.__path__)
    for name, value in vars(importlib.import_module(f"dea.plant.force_laws.{module.name}")).items()
    if isinstance(value, Kind)
}


@njit
def doubled(x):
    return 2.0 * x


@njit
def squared(x):
    return x * x


@njit
def summed(addresses, x):
    total = 0.0
    for k in range(addresses.shape[0]):
        total += function_at(addresses[k])(x)
    return total


def test_a_caller_is_compiled_once_for_all_functions_that_it_calls():
    found = [
        summed(np.array([address(f, SIGNATURE) for f in functions], dtype=np.int64), 3.0)
        for functions in ((), (doubled,), (doubled, squared, squared))
    ]
    assert found == [0.0, 6.0, 24.0]
    assert len(summed.signatures) == 1


def test_each_kind_is_that_of_a_hidden_form():
    laws = [
        form.build(effect.largest, CONDITIONS, np.random.default_rng(seed))[0]
        for effect in EFFECTS.values()
        for form in effect.forms
        for seed in range(3)
    ]
    used = {law.kind for law in laws if isinstance(law, ForceLaw)}
    assert {name for name, kind in KINDS.items() if kind not in used} == set()
    assert len(set(KINDS.values())) == len(KINDS)


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_each_law_has_its_own_force_constants_and_memory(order):
    spring = Kind(njit(lambda c, m, y, v: c[0] * y))
    clock = Kind(njit(lambda c, m, y, v: c[0] * m[0]), njit(_later))
    laws = [ForceLaw(spring, [3.0]), ForceLaw(clock, [5.0], [0.25])]
    stacked = stack([laws[k] for k in order])
    assert total_force(stacked, 2.0, 0.0) == 3.0 * 2.0 + 5.0 * 0.25
    update_memory(stacked, 2.0, 0.0, 0.5)
    assert total_force(stacked, 2.0, 0.0) == 3.0 * 2.0 + 5.0 * 0.75
    assert spring.static([3.0], 2.0) == 6.0


def _later(c, m, y, v, dt):
    m[0] += dt
