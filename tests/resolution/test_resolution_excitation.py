"""Excitations without a fixed form obey what a device may be driven with."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dea.resolution.design import fixed_forms
from dea.resolution.excitation import Limits, express, genes


@st.composite
def limits(draw):
    low = draw(st.floats(-10.0, 10.0))
    return Limits(
        low,
        low + draw(st.floats(0.1, 20.0)),
        draw(st.floats(0.05, 200.0)),
        -1.0,
        1.0,
        draw(st.sampled_from([5.0, 50.0, 200.0])),
    )


def obeys(u, limits):
    rates = np.abs(np.diff(u)) * limits.sampling_rate
    assert u.min() >= limits.low
    assert u.max() <= limits.high
    assert rates.max(initial=0.0) <= limits.rate * (1 + 1e-9) + 1e-9


@given(limits(), st.integers(0, 2**32 - 1), st.floats(2.0, 60.0))
def test_range_rate_and_budget_are_obeyed(limits, seed, duration):
    values = np.random.default_rng(seed).random(genes())
    u = express(values, duration, limits)
    assert u.size == round(duration * limits.sampling_rate)
    obeys(u, limits)


@given(limits(), st.sampled_from([0.0, 1.0]))
def test_extreme_genes_obey_too(limits, value):
    obeys(express(np.full(genes(), value), 10.0, limits), limits)


@pytest.mark.parametrize("rate", [0.5, 500.0])
def test_fixed_forms_are_slowed_down_to_the_rate(rate):
    own = Limits(1.0, 3.0, rate, -1.0, 1.0, 50.0)
    kinds = [kind for kind, u in fixed_forms(30.0, own, 3) if obeys(u, own) is None]
    assert len(kinds) == 7


def test_a_segment_may_be_a_rest():
    own = Limits(1.0, 3.0, 500.0, -1.0, 1.0, 50.0)
    values = np.full(genes(), 0.5)
    values[3::4][:4] = 0.0
    u = express(values, 8.0, own)
    np.testing.assert_array_equal(u[:200], 1.0)
    assert np.ptp(u[200:]) > 0.9
