"""Designed records that are made by hand."""

from dataclasses import replace

import numpy as np
import pytest
from made_devices import LIMITS

from dea.resolution.by_hand import plays
from dea.resolution.excitation import express, genes


@pytest.mark.parametrize(
    ("change", "taken"),
    [
        (lambda u: np.roll(u, 1), True),
        (lambda u: u + 0.02 * np.random.default_rng(0).standard_normal(u.size), True),
        (lambda u: u[:290], True),
        (lambda u: u[:200], False),
        (lambda u: -u, False),
        (lambda u: u + 0.5, False),
    ],
)
def test_an_input_played_by_hand_may_be_a_little_off(change, taken):
    u = np.sin(np.arange(300) / 10)
    assert plays(change(u), u) is taken


@pytest.mark.parametrize("shift", [-2, -1, 1, 2])
def test_an_input_may_be_a_sample_late_however_fast_it_moves(shift):
    """The sines of a design reach an eighth of the sampling rate."""
    rng = np.random.default_rng(0)
    wide = replace(LIMITS, rate=1e9)
    for _ in range(20):
        u = express(rng.random(genes()), 20.0, wide)
        played = np.roll(u, shift)
        assert plays(played, u)
        assert not plays(express(rng.random(genes()), 20.0, wide), u)
