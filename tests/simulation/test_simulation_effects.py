"""What holds for every effect of the catalogue."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_values import DT, SCALES
from made_signals import T, U, Y, Z, forces

from dea.simulation import Port, catalogue
from dea.simulation.signatures import MEMORY, SLOTS, no_force, no_update


def test_the_catalogue_holds_the_effects_of_four_ports():
    ports = {port: {e.name for e in catalogue().values() if e.port is port} for port in Port}
    assert ports[Port.INPUT] == {
        "dead_zone", "input_saturation", "slew_limit", "transport_delay", "electrode_lag",
        "charge_leakage",
    }  # fmt: skip
    assert ports[Port.FORCE] == {
        "viscoelastic_creep", "rate_independent_hysteresis", "coulomb_friction",
        "strain_stiffening", "cyclic_softening", "second_mode", "end_stop", "stress_relaxation",
    }  # fmt: skip
    assert ports[Port.TIME] == {"gain_drift", "baseline_drift", "step_fault"}
    assert ports[Port.OUTPUT] == {
        "sensor_lag", "output_saturation", "sensor_nonlinearity", "periodic_disturbance",
        "backlash",
    }  # fmt: skip


@pytest.mark.parametrize("effect", catalogue().values(), ids=lambda e: e.name)
def test_an_effect_is_complete(effect):
    parameters = effect.parameters(SCALES)
    assert effect.defining in {"", *(p.name for p in parameters if p.spread > 0)}
    assert len({p.name for p in parameters}) == len(parameters)
    assert any(p.spread > 0 for p in parameters)
    assert all(p.low <= p.nominal <= p.high for p in parameters)
    assert all(p.nominal > 0.0 for p in parameters if p.log)
    assert effect.symptom
    assert effect.citation
    assert effect.starts(SCALES)
    for start in effect.starts(SCALES):
        assert len(start) == len(parameters)
        assert all(p.low <= v <= p.high for p, v in zip(parameters, start, strict=True))
        known = [(p, v) for p, v in zip(parameters, start, strict=True) if p.spread == 0.0]
        assert all(v == p.nominal for p, v in known)


@given(st.sampled_from(sorted(catalogue())), st.integers(0, 2**32 - 1))
@settings(max_examples=60, deadline=None)
def test_no_law_leaves_the_numbers_within_its_bounds(name, seed):
    rng = np.random.default_rng(seed)
    effect = catalogue()[name]
    q = np.array([p.value(rng.normal()) for p in effect.parameters(SCALES)])
    if effect.shape_input:
        assert np.isfinite(effect.shape_input(U, q, DT)).all()
    if effect.shape_output:
        assert np.isfinite(effect.shape_output(Y, T, q, DT)).all()
    if effect.scale_drive:
        assert np.isfinite(effect.scale_drive(T, q)).all()
    if effect.force:
        assert np.isfinite(forces(name, q, Z[:200])).all()


def test_an_empty_slot_does_nothing():
    memory = np.arange(MEMORY, dtype=float)
    no_update(0.0, 1.0, 0.1, memory, np.zeros(3))
    assert no_force(1.0, 1.0, memory, np.zeros(3)) == 0.0
    assert (memory == np.arange(MEMORY)).all()
    assert SLOTS >= 2
