"""Whether a wave adds to the reading, or changes with the motion."""

from dataclasses import replace

import numpy as np
import pytest
from made_resonator import DEVICE, INTERVAL, NOISE

from dea.discrepancy.decision.parts import certain_part
from dea.discrepancy.evidence.evidence import Evidence
from dea.discrepancy.evidence.held_out import HeldOut
from dea.discrepancy.evidence.modulation import ModulatedWave, modulated_wave, part_modulated
from dea.discrepancy.evidence.presence import Presence
from dea.discrepancy.fitting.candidates import judged
from dea.discrepancy.fitting.fit import fit
from dea.discrepancy.problem.problem import Problem
from dea.discrepancy.problem.split import split
from dea.discrepancy.rules import Rules
from dea.simulation import catalogue, measured_scales, prepared

FREQUENCY, SIZE = 1.3, 2400


def pumped(of_reading, of_stiffness, seed=3):
    """Return evidence on a resonator with a wave in its reading or its stiffness, and both fits.

    The motion is integrated here, by semi-implicit Euler at a hundredth of the interval.
    """
    rng = np.random.default_rng(seed)
    u = np.repeat(rng.uniform(1, 3, SIZE // 25), 25)
    extended = prepared(replace(DEVICE, input_interpolation="zero"), u, INTERVAL, 1e-4)
    time = INTERVAL * np.arange(SIZE)
    own = dict(zip(extended.layout.names, extended.layout.prior_means, strict=True))
    omega, step = 2 * np.pi * own["natural_frequency"], INTERVAL / 100
    x, v, path = 0.0, 0.0, np.empty(SIZE)
    for k in range(SIZE):
        path[k] = x
        for part in range(100):
            now = time[k] + part * step
            stiffness = omega**2 * (1.0 + of_stiffness * np.sin(2 * np.pi * FREQUENCY * now))
            force = omega**2 * own["static_gain"] * u[k] - stiffness * x
            v += step * (force - 2 * own["damping_ratio"] * omega * v)
            x += step * v
    y = path + of_reading * np.sin(2 * np.pi * FREQUENCY * time) + NOISE * rng.standard_normal(SIZE)
    parts = split(u, INTERVAL, 0.1)
    problem = Problem(
        u, y, INTERVAL, parts.fit, parts.select, parts.certify, NOISE, 1e-4, extended.substeps
    )
    nominal = fit(problem, extended, np.zeros(extended.layout.free.size))
    told = replace(
        measured_scales(extended, nominal.values, problem), foreign_frequencies=(FREQUENCY,)
    )
    law = extended.attach(catalogue()["periodic_disturbance"], told)
    starts = law.attached[0].effect.starts(told)
    begun = (
        fit(problem, law, law.layout.coordinates(np.concatenate([nominal.values, start])))
        for start in starts
    )
    waving = judged(problem, min(begun, key=lambda each: each.cost))
    evidence = Evidence(
        problem, nominal, HeldOut(problem), problem.blocks(100), NOISE, 0.0, Rules(),
        np.random.default_rng(8),
    )  # fmt: skip
    return evidence, waving


@pytest.mark.parametrize(
    ("of_reading", "of_stiffness", "modulated"), [(0.3, 0.0, False), (0.0, 0.15, True)]
)
def test_a_wave_of_the_stiffness_follows_the_motion_and_one_of_the_reading_does_not(
    of_reading, of_stiffness, modulated
):
    evidence, waving = pumped(of_reading, of_stiffness)
    assert part_modulated(evidence.problem, evidence.nominal) == 0.0
    part = part_modulated(evidence.problem, waving.fit)
    assert (part > 0.5) if modulated else (part < 0.05)
    found = modulated_wave(evidence.problem, [waving], Rules())
    wave = ModulatedWave(("periodic_disturbance",), pytest.approx(FREQUENCY, abs=0.02))
    assert found == (wave if modulated else None)


@pytest.mark.parametrize(("of_reading", "of_stiffness"), [(0.3, 0.0), (0.0, 0.15)])
def test_no_part_of_an_answer_is_a_disturbance_that_follows_the_motion(of_reading, of_stiffness):
    evidence, waving = pumped(of_reading, of_stiffness)
    # What a part leaves may be more than noise; here other tests of it are passed by any wave.
    evidence = replace(evidence, rules=Rules(part=0.3, law_error=0.0))
    part = certain_part(evidence, [waving], Presence((waving,), np.ones(1)))
    assert part is (waving if of_reading else None)
