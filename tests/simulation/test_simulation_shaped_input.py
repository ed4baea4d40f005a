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
    own = load_simulation(simulation)
    if len(own.inputs) > 1:
        u = np.column_stack([u, np.roll(u, 50)])
        own = replace(own, input_offset_spread=(0.1, 0.1))
    else:
        own = replace(own, input_offset_spread=0.1)
    bare = prepared(own, u, DT, 1e-4)
    values = bare.layout.prior_means
    record = SimpleNamespace(u=u, y=bare.simulate(values, u, DT), interval=DT)
    scales = measured_scales(bare, values, record)
    lengths = (len(u),) * records if records > 1 else ()
    extended = replace(bare, lengths=lengths)
    starts = np.tile([state.initial for state in own.states], records - 1)
    first = len(own.parameters) + len(own.states)
    values = np.concatenate([values[:first], starts, values[first:]])
    for name in effects:
        extended = extended.attach(catalogue()[name], scales)
        law = catalogue()[name].starts(scales)[0]
        values = np.concatenate([values, extended.attached[-1].started(law)])
    return extended, values, np.concatenate([u] * records)


@pytest.mark.parametrize("records", [1, 2])
@pytest.mark.parametrize(
    ("simulation", "effects"),
    [
        ("mass_spring_damper", ("viscoelastic_creep",)),
        ("mass_spring_damper", ("slew_limit", "gain_drift")),
        ("mass_spring_damper", ("coulomb_friction", "dead_zone")),
        ("two_heaters", ("transport_delay",)),
        ("dea_film", ("charge_leakage",)),
        ("dea_membrane", ("electrode_lag",)),
    ],
)
def test_a_shared_input_changes_no_run(simulation, effects, records):
    extended, values, u = extended_by(simulation, effects, records)
    coordinates = extended.layout.coordinates(values)
    shaped = extended.shaped(extended.layout.values(coordinates), u, DT)
    changed = []
    for i, index in enumerate(extended.layout.free):
        moved = coordinates.copy()
        moved[i] += 0.01
        there = extended.layout.values(moved)
        alone = extended.run(there, u, DT)
        np.testing.assert_array_equal(extended.run(there, u, DT, shaped), alone)
        known = extended.shaped(there, u, DT, shaped)
        if not any(a is b for a, b in zip(known, shaped, strict=True)):
            changed.append(extended.layout.names[index])
    assert any(name.startswith("input_offset") for name in changed)
    acts = load_simulation(simulation).action is not None
    own = {p.name for p in extended.simulation.parameters}
    assert acts == bool(own & set(changed))
    assert len(changed) < extended.layout.free.size


@pytest.mark.parametrize("simulation", ["dea_film", "mass_spring_damper"])
def test_a_run_does_not_change_the_input_that_it_shares(simulation):
    extended, values, u = extended_by(simulation, ("gain_drift",), 1)
    [shaped] = extended.shaped(values, u, DT)
    course, table = shaped.course, shaped.table
    assert (table is not None) == (simulation == "dea_film")
    own = [course.u, course.steps, course.drive_scale, shaped.decisive]
    own += [table] if table is not None else []
    before = [each.copy() for each in own]
    assert np.isfinite(extended.run(values, u, DT, [shaped])).all()
    for now, then in zip(own, before, strict=True):
        np.testing.assert_array_equal(now, then)


def test_the_parameters_given_are_not_changed():
    extended, values, u = extended_by("dea_film", ("gain_drift",), 2)
    before = values.copy()
    extended.run(values, u, DT)
    np.testing.assert_array_equal(values, before)
