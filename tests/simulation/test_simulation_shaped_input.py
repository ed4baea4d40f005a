"""Runs that share the shaped input of another one are the same as those that shape their own."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dea.simulation import catalogue, load_simulation, measured_scales, prepared

DT = 0.02
U = 1.0 + np.sin(2 * np.pi * 0.4 * np.arange(400) * DT)
LEVELS = {"dea_film": (2.0, 3.4), "dea_membrane": (2.0, 3.4)}


def extended_by(simulation, effects, records):
    """Return a simulation with effects and an offset of its input, values, and its input."""
    low, high = LEVELS.get(simulation, (-1.0, 1.0))
    u = low + 0.5 * (high - low) * U
    own = replace(load_simulation(simulation), input_offset_spread=0.1)
    bare = prepared(own, u, DT, 1e-4)
    values = bare.values(np.zeros(bare.free.size))
    record = SimpleNamespace(u=u, y=bare.simulate(values, u, DT), interval=DT)
    scales = measured_scales(bare, values, record)
    lengths = (u.size,) * records if records > 1 else ()
    extended = replace(bare, lengths=lengths)
    starts = np.tile([state.initial for state in own.states], records - 1)
    first = len(own.parameters) + len(own.states)
    values = np.concatenate([values[:first], starts, values[first:]])
    for name in effects:
        extended = extended.attach(catalogue()[name], scales)
        law = catalogue()[name].starts(scales)[0]
        values = np.concatenate([values, extended.attached[-1].started(law)])
    return extended, values, np.tile(u, records)


@pytest.mark.parametrize("records", [1, 2])
@pytest.mark.parametrize(
    ("simulation", "effects"),
    [
        ("mass_spring_damper", ("viscoelastic_creep",)),
        ("mass_spring_damper", ("slew_limit", "gain_drift")),
        ("dea_film", ("charge_leakage",)),
        ("dea_membrane", ("electrode_lag",)),
    ],
)
def test_a_shared_input_changes_no_run(simulation, effects, records):
    extended, values, u = extended_by(simulation, effects, records)
    shaped = extended.shaped(values, u, DT)
    coordinates = extended.coordinates(values)
    changed = []
    for i, index in enumerate(extended.free):
        moved = coordinates.copy()
        moved[i] += 0.01
        there = extended.values(moved)
        alone = extended.run(there, u, DT)
        np.testing.assert_array_equal(extended.run(there, u, DT, shaped), alone)
        known = extended.shaped(there, u, DT, shaped)
        if not any(a is b for a, b in zip(known, shaped, strict=True)):
            changed.append(extended.names[index])
    assert "input_offset" in changed
    acts = load_simulation(simulation).action is not None
    own = {p.name for p in extended.simulation.parameters}
    assert acts == bool(own & set(changed))


def test_a_shared_input_is_not_overwritten():
    extended, values, u = extended_by("mass_spring_damper", ("gain_drift",), 1)
    shaped = extended.shaped(values, u, DT)
    before = extended.run(values, u, DT, shaped)
    np.testing.assert_array_equal(extended.run(values, u, DT, shaped), before)
    assert np.isfinite(before).all()
    assert np.ptp(before[0]) > 0.0
