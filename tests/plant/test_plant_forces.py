"""Each force law at points where its value is known without its formula."""

import numpy as np
import pytest

from dea.plant import forces
from dea.plant.forces import ForceLaw, stack, total_force, update_memory


def law(kind, constants, memory=(0.0, 0.0)):
    return stack([ForceLaw(kind, np.array(constants, float), np.array(memory, float))])


@pytest.mark.parametrize(
    ("v", "steady"),
    [(1e-9, 0.5), (1e-3, 0.3 + 0.2 / np.e), (-1e-3, -0.3 - 0.2 / np.e), (1.0, 0.3), (-1.0, -0.3)],
)
def test_sliding_friction_is_stribecks_curve(v, steady):
    """Coulomb friction 0.3 N, stiction 0.5 N, Stribeck velocity 1 mm/s; bristles 1e5 N/m."""
    sliding = law(forces.LUGRE_FRICTION, [1e5, 10.0, 0.3, 0.5, 1e-3])
    for _ in range(400):
        update_memory(sliding, 0.0, v, 1e-3 if abs(v) > 1e-6 else 1e3)
    assert total_force(sliding, 0.0, v) == pytest.approx(steady, rel=1e-6)


def test_bristles_are_a_spring_and_a_dashpot_before_they_slip():
    still = law(forces.LUGRE_FRICTION, [1e5, 10.0, 0.3, 0.5, 1e-3])
    v, dt = 1e-6, 1e-3
    update_memory(still, 0.0, v, dt)
    assert total_force(still, 0.0, v) == pytest.approx(1e5 * v * dt + 10.0 * v, rel=1e-3)
    assert total_force(still, 0.0, -v) == pytest.approx(1e5 * v * dt - 10.0 * v, rel=1e-3)


def test_a_stop_pushes_as_two_spheres_and_never_pulls():
    """Hertz: force goes with depth to 3/2. Impact costs energy: in, it is larger than out."""
    stop = law(forces.HERTZ_STOP, [1e6, 2e-3, 0.5])
    shallow, deep = (total_force(stop, 2e-3 + depth, 0.0) for depth in (1e-4, 4e-4))
    assert shallow == pytest.approx(1.0)
    assert deep == pytest.approx(8.0)
    assert total_force(stop, 2e-3 - 1e-4, 1.0) == 0.0
    assert total_force(stop, 2e-3 + 1e-4, 1.0) == pytest.approx(1.5)
    assert total_force(stop, 2e-3 + 1e-4, -1.0) == pytest.approx(0.5)
    assert total_force(stop, 2e-3 + 1e-4, -3.0) == 0.0


def test_an_attached_mass_pulls_through_a_spring_that_hardens_and_a_dashpot():
    """5 g on 2 N/m, 0.1 N s/m, twice as stiff at 1 mm."""
    at_rest = law(forces.ATTACHED_MASS, [5e-3, 2.0, 0.1, 1e-3])
    assert total_force(at_rest, 0.0, 0.0) == 0.0
    assert total_force(at_rest, 1e-5, 0.0) == pytest.approx(2e-5, rel=1e-3)
    assert total_force(at_rest, -1e-3, 0.0) == pytest.approx(-4e-3)
    assert total_force(at_rest, 0.0, 0.02) == pytest.approx(2e-3)


def test_an_attached_mass_gains_the_impulse_it_takes():
    pulled = law(forces.ATTACHED_MASS, [5e-3, 2.0, 0.1, 1e-3])
    impulse, dt = 0.0, 1e-4
    for k in range(3000):
        y, v = 1e-3 * np.sin(10 * k * dt), 1e-2 * np.cos(10 * k * dt)
        impulse += total_force(pulled, y, v) * dt
        update_memory(pulled, y, v, dt)
    assert 5e-3 * pulled.memory[0, 1] == pytest.approx(impulse, rel=1e-9)
    assert np.abs(pulled.memory[0, 1]) > 1e-3


def test_an_attached_mass_at_the_devices_speed_feels_no_dashpot():
    moving = law(forces.ATTACHED_MASS, [5e-3, 2.0, 0.1, 1e-3], [4e-4, 0.03])
    assert total_force(moving, 4e-4, 0.03) == 0.0
    assert total_force(moving, 4e-4, 0.01) == pytest.approx(-2e-3)


def test_stiffening_begins_with_the_square_and_grows_exponentially():
    """0.2 N; a length of 1 mm; from 3 mm on."""
    stiff = law(forces.FUNG_STIFFENING, [0.2, 1e-3, 3e-3])
    assert total_force(stiff, 3e-3, 1.0) == 0.0
    assert total_force(stiff, 3e-3 + 1e-6, 0.0) == pytest.approx(0.2 * 0.5e-6, rel=1e-3)
    assert total_force(stiff, 4e-3, 0.0) == pytest.approx(0.2 * (np.e - 2.0))


def test_softening_takes_a_share_of_the_spring_that_grows_with_the_path():
    """40 % of 50 N/m in the long run; 63 % of that after a path of 20 mm, either way round."""
    soft = law(forces.PATH_SOFTENING, [50.0, 0.4, 0.02, 0.5])
    for v in (0.1, -0.1):
        for _ in range(100):
            update_memory(soft, 3e-3, v, 1e-3)
    assert total_force(soft, 3e-3, 0.0) == pytest.approx(-0.4 * 50.0 * 3e-3 * (1 - 1 / np.e))
    soft.memory[0, 0] = 0.005  # a quarter of the path: the root, by the exponent
    expected = -0.4 * 50.0 * 3e-3 * (1 - np.exp(-0.5))
    assert total_force(soft, 3e-3, 0.0) == pytest.approx(expected)


def test_a_stiffness_steps_at_its_instant_within_its_rise():
    step = law(forces.STIFFNESS_STEP, [8.0, 0.5, 0.01])
    shares = {}
    for k in range(1, 1001):
        update_memory(step, 2e-3, 0.0, 1e-3)
        shares[k] = total_force(step, 2e-3, 0.0) / (8.0 * 2e-3)
    assert shares[400] < 1e-4
    assert shares[500] == pytest.approx(0.5)
    assert shares[510] == pytest.approx(1.0 / (1.0 + 1.0 / np.e))
    assert shares[600] > 1.0 - 1e-4


def test_a_snap_through_pushes_both_ways_around_its_place():
    """0.3 N within 1 mm of 2 mm; a wave under a bell."""
    snap = law(forces.SNAP_THROUGH, [0.3, 2e-3, 1e-3])
    assert total_force(snap, 2e-3, 0.0) == 0.0
    bell = np.exp(-1.0 / 16.0)
    assert total_force(snap, 2.25e-3, 0.0) == pytest.approx(0.3 * bell)
    assert total_force(snap, 1.75e-3, 0.0) == pytest.approx(-0.3 * bell)
    assert total_force(snap, 2.5e-3, 0.0) == pytest.approx(0.0, abs=1e-12)
    assert total_force(snap, 5.25e-3, 0.0) == pytest.approx(0.0, abs=1e-4)


def test_the_forces_of_several_laws_add():
    laws = [
        ForceLaw(forces.HERTZ_STOP, np.array([1e6, 2e-3, 0.0]), np.zeros(1)),
        ForceLaw(forces.FUNG_STIFFENING, np.array([0.2, 1e-3, 1.1e-3]), np.zeros(1)),
    ]
    y = 2.1e-3
    assert total_force(stack(laws), y, 0.0) == pytest.approx(1.0 + 0.2 * (np.e - 2.0))
