"""Several records of one device: what they share, and what each has its own."""

from dataclasses import replace

import numpy as np
import pytest

from dea.discrepancy.problem.problem import Samples
from dea.simulation import catalogue, load_simulation, measured_scales, prepared

INTERVAL = 0.02
U = np.repeat(np.random.default_rng(1).uniform(-1, 1, 40), 25)
LENGTHS = (600, 400)


def joint(*names):
    extended = prepared(load_simulation("mass_spring_damper"), U, INTERVAL, 1e-4, LENGTHS)
    values = extended.layout.prior_means
    scales = replace(measured_scales(extended, values, Samples(U, U, INTERVAL)), jumps=(4.0,))
    for name in names:
        extended = extended.attach(catalogue()[name], scales)
        law = catalogue()[name].starts(scales)[0]
        values = np.concatenate([values, extended.attached[-1].started(law)])
    return extended, values


def test_each_record_is_simulated_from_its_own_start():
    extended, values = joint()
    values[extended.layout.names.index("initial.position")] = 0.3
    values[extended.layout.names.index("record_2.initial.position")] = -0.2
    found = extended.simulate(values, U, INTERVAL)
    for record, part in enumerate((slice(0, 600), slice(600, 1000))):
        own = extended.layout.of_record(values, record)
        assert own[extended.alone.layout.names.index("initial.position")] == (0.3, -0.2)[record]
        alone = extended.alone.simulate(own, U[part], INTERVAL)
        np.testing.assert_array_equal(found[part], alone)


@pytest.mark.parametrize(
    ("name", "own"),
    [("sensor_lag", set()), ("viscoelastic_creep", {"start_position", "stretch", "age"}),
     ("step_fault", None)],
)  # fmt: skip
def test_a_law_is_shared_but_for_its_start_and_what_happens_once(name, own):
    extended, values = joint(name)
    copies = {
        p.split(f"{name}.record_2.")[1] for p in extended.layout.names if f"{name}.record_2" in p
    }
    law = catalogue()[name].parameters(extended.attached[0].scales)
    assert copies == ({p.name for p in law if p.spread > 0} if own is None else own)
    assert (
        extended.layout.coordinates(values).size
        == extended.layout.free.size
        == extended.layout.own_of_records.size
    )
    assert np.isfinite(extended.simulate(values, U, INTERVAL)).all()


def test_one_record_is_as_it_was():
    one = prepared(load_simulation("mass_spring_damper"), U, INTERVAL, 1e-4, (U.size,))
    assert one == prepared(load_simulation("mass_spring_damper"), U, INTERVAL, 1e-4)
