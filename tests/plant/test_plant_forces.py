"""Several force laws at a time; each law by itself is tested with the hidden effects."""

import numpy as np
import pytest
from made_conditions import CONDITIONS, built

from dea.plant.force_laws.friction import bristle_force, carry_bristle
from dea.plant.forces import EYRING, ForceLaw, stack, total_force, update_memory


def test_the_forces_of_several_laws_add():
    laws = [
        built("strain_stiffening", "fung", 0.3)[0],
        built("viscoelastic_creep", "spring_pot", 0.3)[0],
    ]
    y = 1.1 * CONDITIONS.top
    together, alone = stack(laws), [stack([law]) for law in laws]
    for forces in (together, *alone):
        update_memory(forces, y, 0.0, 1e-3)
    single = [total_force(forces, y, 0.0) for forces in alone]
    assert np.count_nonzero(single) == len(laws)
    assert total_force(together, y, 0.0) == pytest.approx(sum(single), rel=1e-12)


def test_the_force_of_a_flowing_dashpot_is_that_of_the_spring_before_it():
    law = ForceLaw(EYRING, np.array([300.0]), np.array([2e-4]))
    assert total_force(stack([law]), 5e-4, 0.0) == pytest.approx(300.0 * 3e-4)


@pytest.mark.parametrize("v", [0.02, -0.5])
def test_bristles_are_springs_at_first_and_slide_with_stribecks_force(v):
    """Canudas de Wit et al. (1995): s0 z for small motions, F_c + (F_s - F_c) exp(-(v/v_s)^2)."""
    stiffness, damping, coulomb, stiction, speed = constants = np.array([1e4, 30.0, 2.0, 3.5, 0.1])
    memory = np.zeros(1)
    assert bristle_force(constants, memory, v) == pytest.approx(damping * v)
    carry_bristle(constants, memory, v, 1e-7)
    assert memory[0] == pytest.approx(1e-7 * v, rel=1e-3)
    for _ in range(2000):
        carry_bristle(constants, memory, v, 1e-3)
    sliding = coulomb + (stiction - coulomb) * np.exp(-((v / speed) ** 2))
    assert bristle_force(constants, memory, v) == pytest.approx(np.sign(v) * sliding)
    assert memory[0] == pytest.approx(np.sign(v) * sliding / stiffness)
