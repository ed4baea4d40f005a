"""The plain devices of trials, against their physics and what their simulations know of them."""

import runpy
from pathlib import Path

import numpy as np
import pytest

from dea.plant.chamber import Chamber
from dea.plant.drive import Drive
from dea.plant.film import SUBSTEP
from dea.plant.force_laws import in_time
from dea.plant.force_laws.in_time import FORCE_COURSE, STIFFNESS_COURSE
from dea.plant.forces import ForceLaw
from dea.plant.hidden.devices import DEVICES, PlainChamber, PlainDrive

ROOT = Path(__file__).parents[2]
BENCH = ROOT / "config" / "bench.yaml"
SPRING, PUSH = STIFFNESS_COURSE, FORCE_COURSE


def settled(plain, command, seconds, laws=()):
    """Return the output after a command was held so long."""
    machine = plain.machine(list(laws))
    output = machine.advance(np.full(round(seconds / SUBSTEP), float(command)))
    assert not machine.broken
    return output[-1]


def test_a_drive_settles_where_torques_are_in_balance():
    drive = Drive()
    assert PlainDrive().rest_and_stiffness() == (0.0, drive.stiffness)
    expected = drive.gain * 3.0 / drive.stiffness
    assert settled(PlainDrive(), 3.0, 3.0) == pytest.approx(expected)
    half = ForceLaw(SPRING, [0.5 * drive.stiffness, in_time.RAMP, -1.0, 1.0])
    assert settled(PlainDrive(), 3.0, 3.0, [half]) == pytest.approx(expected / 1.5)
    push = ForceLaw(PUSH, [0.1 * drive.stiffness, in_time.RAMP, -1.0, 1.0])
    assert settled(PlainDrive(), 3.0, 3.0, [push]) == pytest.approx(expected - 0.1)
    both = settled(PlainDrive(), 3.0, 3.0, [push, half])
    assert both == pytest.approx((expected - 0.1) / 1.5)


def test_a_chamber_settles_where_heat_is_in_balance_and_takes_no_force():
    chamber = Chamber()
    assert PlainChamber().rest_and_stiffness() == (20.0, 0.0)
    # What the resistor heats goes through the air to the room.
    warm = chamber.heating * 9.0 / chamber.exchange * chamber.uptake / chamber.loss
    assert settled(PlainChamber(), 3.0, 900.0) == pytest.approx(20.0 + warm, rel=1e-4)
    with pytest.raises(AssertionError):
        PlainChamber().machine([ForceLaw(PUSH, [1.0])])


def test_a_film_at_rest_is_where_its_weight_holds_it_and_gives_way_by_its_stiffness():
    plain = DEVICES["film"].plain(BENCH, {})
    rest, stiffness = plain.rest_and_stiffness()
    assert settled(plain, 0.0, 0.1) == pytest.approx(rest, rel=1e-3)
    stiff = plain.changed({"yeoh_1": 1.2})
    assert stiff.rest_and_stiffness()[1] > 1.05 * stiffness
    # A small force, which comes at once: the film is stiffer until its branches have relaxed.
    force = 1e-3 * stiffness * rest
    push = ForceLaw(PUSH, [force, in_time.RAMP, -1.0, 1.0])
    moved = settled(plain, 0.0, 0.3) - settled(plain, 0.0, 0.3, [push])
    assert moved == pytest.approx(force / stiffness, rel=0.15)


def test_a_film_s_supply_is_the_amplified_command_within_its_limits():
    plain = DEVICES["film"].plain(BENCH, {})
    amplifier = plain.parameters.amplifier
    most = amplifier.output_limit / amplifier.gain
    below = plain.machine([]).advance(np.full(500, -3.0))
    np.testing.assert_array_equal(below, plain.machine([]).advance(np.zeros(500)))
    over, at = (plain.machine([]).advance(np.full(60, most * factor)) for factor in (1.3, 1.0))
    np.testing.assert_array_equal(over, at)
    assert settled(plain, 2.0, 0.5) > plain.rest_and_stiffness()[0]


def test_a_film_that_is_driven_too_far_is_broken():
    plain = DEVICES["film"].plain(BENCH, {"yeoh_1": 0.5})
    machine = plain.machine([])
    assert not machine.broken
    machine.advance(np.full(3000, 5.0))
    assert machine.broken


@pytest.mark.parametrize("name", DEVICES)
def test_parameters_are_multiplied_and_the_others_left(name):
    kind = DEVICES[name]
    factors = {each: 1.1 + 0.01 * i for i, each in enumerate(kind.spread)}
    nominal, changed = (
        getattr(plain, name) if name != "film" else plain.parameters.film
        for plain in (kind.plain(BENCH, {}), kind.plain(BENCH, factors))
    )
    for each in nominal._fields:
        expected = np.asarray(getattr(nominal, each)) * factors.get(each, 1.0)
        np.testing.assert_allclose(getattr(changed, each), expected)


@pytest.mark.parametrize("name", ["drive", "chamber"])
def test_the_output_is_a_power_of_the_command_in_proportion(name):
    kind = DEVICES[name]
    plain = kind.plain(BENCH, {})
    rest = plain.rest_and_stiffness()[0]
    once, twice = (settled(plain, command, 100.0) - rest for command in (2.0, 4.0))
    assert twice / once == pytest.approx(2.0**kind.power)
    assert kind.force is (plain.rest_and_stiffness()[1] > 0.0)


@pytest.mark.parametrize("name", ["drive", "chamber"])
def test_what_is_drawn_of_a_device_lies_within_what_its_simulation_does_not_know(name):
    kind = DEVICES[name]
    simulation = runpy.run_path(str(ROOT / kind.simulation))["simulation"]
    known = {parameter.name: parameter for parameter in simulation.parameters}
    assert set(kind.spread) == set(known)
    assert set(kind.free) < set(known)
    assert simulation.output_unit == kind.unit
    for each, spread in kind.spread.items():
        assert 0.0 < spread <= known[each].spread


@pytest.mark.parametrize("name", DEVICES)
def test_ranges_of_a_device_are_in_order_and_its_clock_fits(name):
    kind = DEVICES[name]
    assert 0.0 < kind.lows[0] < kind.lows[1] < kind.highs[0] < kind.highs[1] <= 5.0
    assert 0.0 < kind.noise[0] < kind.noise[1] <= 3.0001 * kind.noise[0]
    assert max(kind.spread.values()) <= 0.3
    assert kind.durations[0] < kind.durations[1]
    for rate in kind.rates:
        assert round(1.0 / SUBSTEP) % rate == 0
    assert kind.settling * min(kind.rates) == round(kind.settling * min(kind.rates))


def test_a_film_moves_and_is_read_in_millimetres():
    film = DEVICES["film"]
    assert film.unit == "mm"
    assert film.scale == 1000.0
    assert film.force
