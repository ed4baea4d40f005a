"""Several force laws at a time; each law by itself is tested with the hidden effects."""

import numpy as np
import pytest
from made_conditions import CONDITIONS, built

from dea.plant.forces import stack, total_force, update_memory


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
