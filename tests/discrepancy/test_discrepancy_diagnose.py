"""Diagnoses of a membrane whose hidden effects obey other laws than the catalogue's."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import TransferFunction, lfilter, lsim
from small_search import SEARCH
from synthetic import record

from dea.discrepancy import (
    Settings,
    candidates_dataset,
    certificate_dataset,
    diagnose,
    localisation_dataset,
    read_verdict,
)
from dea.discrepancy.evidence.residual_model import residual_model
from dea.discrepancy.problem.problem import rmse
from dea.errors import InputError
from dea.simulation import load_extended, load_simulation, prepared, save_extended
from dea.store import CONTRACTS, Record
from made_carriage import CARRIAGE
from user_simulation import write_simulation

NOISE = 1.5e-3
# Effects that act on the input, the film, the sensor and over time. The tutorial and the worked
# example of the documentation offer the whole catalogue.
OFFERED = (
    "coulomb_friction", "gain_drift", "periodic_disturbance", "sensor_lag", "transport_delay",
    "viscoelastic_creep",
)  # fmt: skip


def diagnosed(*effects, seed=3, offered=OFFERED, workers=1):
    made = record(effects, duration=20.0, seed=seed)
    settings = Settings(effects=offered, budget=SEARCH)
    return diagnose(made, "dea_membrane", settings=settings, workers=workers)


@pytest.fixture(scope="module")
def creeping():
    return diagnosed(("viscoelastic_creep", 3.0))


def test_a_device_of_which_no_mode_decays_gets_a_verdict(tmp_path):
    """A tank without an outlet: its level is the integral of what flows in."""
    tank = load_simulation(write_simulation(tmp_path / "tank.py", slope="p[0] * p[1] * u"))
    rng = np.random.default_rng(1)
    inflow = np.repeat(rng.uniform(-1.0, 1.0, 60), 10)
    level = 0.02 * 2.0 * (np.cumsum(inflow) - inflow) + 1e-3 * rng.standard_normal(inflow.size)
    made = Record.of(inflow, level, 50.0, units=("V", "mm"))
    settings = Settings(effects=("sensor_lag", "gain_drift"), budget=SEARCH)
    assert diagnose(made, tank, settings=settings).verdict.status == "none"


def test_an_effect_is_named_whose_gap_is_half_of_coloured_noise():
    """A dead zone of 0.2 V before a resonator; of the white level the gap leaves more than half."""
    spring = load_simulation("mass_spring_damper")
    natural, damping, _ = (each.nominal for each in spring.parameters)
    rng = np.random.default_rng(4)
    wandering = [lfilter([1.0], [1.0, -0.95], rng.standard_normal(2000)) for _ in range(2)]
    u, slow = (each / each.std() for each in wandering)
    driven = np.sign(u) * np.maximum(np.abs(u) - 0.2, 0.0)
    rate = 2.0 * np.pi * natural
    resonator = TransferFunction([rate**2], [1.0, 2.0 * damping * rate, rate**2])
    fine = np.repeat(driven, 8)
    _, y, _ = lsim(resonator, fine, np.arange(fine.size) / 400.0, interp=False)
    noise = 0.03 * (rng.standard_normal(u.size) + 2.5 * slow)
    made = Record.of(u, y[::8] + noise, 50.0, units=("V", "V"))
    settings = Settings(effects=("dead_zone", "sensor_lag"), budget=SEARCH)
    found = diagnose(made, spring, settings=settings)
    assert (found.verdict.status, found.verdict.names) == ("named", ("dead_zone",))
    assert found.verdict.coloured_level == pytest.approx(2.5 * 0.03, rel=0.1)
    assert float(certificate_dataset(found)["coloured_level"]) == found.verdict.coloured_level
    assert found.floor == pytest.approx(np.hypot(found.noise_floor, found.coloured_level))
    assert found.stated_floor == pytest.approx(np.hypot(found.noise_floor, spring.accuracy))
    assert "which counts as noise" in found.verdict.sentence


@pytest.mark.slow
def test_nothing_is_named_where_nothing_is_missing():
    found = diagnosed(seed=5)
    assert found.verdict.status == "none", found.verdict.sentence
    assert found.noise_floor == pytest.approx(NOISE, rel=0.12)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "size"),
    [
        ("gain_drift", 1.5),
        ("periodic_disturbance", 1.0),
    ],
)
def test_an_effect_of_another_form_is_named(name, size):
    found = diagnosed((name, size))
    assert found.verdict.status == "named", found.verdict.sentence
    assert found.verdict.names == (name,)
    assert found.verdict.certified["rmse_after"] < 1.3 * found.noise_floor


@pytest.mark.slow
def test_a_delay_is_named_on_most_records_of_it():
    """Three samples on a film of a lag of its own: a few records leave a short lag possible."""
    found = [diagnosed(("transport_delay", 1.0), seed=seed) for seed in range(1, 7)]
    assert all(each.verdict.names == ("transport_delay",) for each in found)
    assert all(each.verdict.certified["rmse_after"] < 1.3 * each.noise_floor for each in found)
    status = [each.verdict.status for each in found]
    assert status.count("named") >= 5, status
    assert set(status) <= {"named", "ambiguous"}


@pytest.mark.slow
def test_an_effect_that_is_not_offered_is_not_named_as_another():
    """Backlash before a sensor, with the other effects that come nearest to it."""
    nearest = (
        "coulomb_friction", "rate_independent_hysteresis", "sensor_lag", "sensor_nonlinearity",
        "transport_delay",
    )  # fmt: skip
    found = diagnosed(("backlash", 3.0), offered=nearest)
    assert found.verdict.status == "unknown", found.verdict.sentence
    # What is described is what the simulation alone leaves, and not what a rejected candidate does.
    assert found.decision.chosen is not None
    assert found.unexplained == residual_model(found.problem, found.nominal.residual)


@pytest.mark.slow
def test_creep_is_named_and_proven(creeping):
    verdict = creeping.verdict
    assert verdict.status == "named", verdict.sentence
    assert verdict.names == ("viscoelastic_creep",)
    assert verdict.certified["rmse_after"] < 1.3 * creeping.noise_floor
    assert verdict.certified["rmse_before"] > 1.5 * creeping.noise_floor
    gain, low, high = verdict.effects[0].gain
    assert 0.1 < low < gain < high
    for estimate in verdict.effects[0].parameters.values():
        assert estimate.low <= estimate.value <= estimate.high


@pytest.mark.slow
def test_the_verdict_can_be_written_and_read(creeping, tmp_path):
    path = tmp_path / "verdict.json"
    creeping.verdict.write(path)
    assert read_verdict(path).effects == creeping.verdict.effects
    assert json.loads(path.read_text())["status"] == "named"
    assert read_verdict(path).names == creeping.verdict.names
    path.write_text("{}")
    with pytest.raises(InputError, match="no verdict"):
        read_verdict(path)


def test_how_far_a_reading_bends_is_that_of_what_bent_it():
    """A parabola over the motion of a linear device, less the line fitted to it."""
    rng = np.random.default_rng(4)
    u = np.repeat(rng.uniform(-2.0, 2.0, 60), 25)
    extended = prepared(CARRIAGE, u, 0.02, 1e-4)
    y = extended.simulate(extended.layout.prior_means, u, 0.02)
    low, high = y.min(), y.max()
    bent = y - 0.3 * (y - low) * (high - y) / (high - low)
    line = np.polynomial.Polynomial.fit(y, bent, 1)
    straight = line(y)
    largest = (bent - straight)[np.argmax(np.abs(bent - straight))]
    made = Record.of(u, bent + 2e-3 * rng.standard_normal(u.size), 50.0, units=("V", "V"))
    settings = Settings(effects=("sensor_nonlinearity",), budget=SEARCH)
    [effect] = diagnose(made, CARRIAGE, settings=settings).verdict.effects
    assert effect.bend.largest == pytest.approx(largest, rel=0.1)
    assert effect.bend.slope == pytest.approx(line.convert().coef[1], rel=0.1)
    assert (effect.bend.unit, effect.bend.name, effect.bend.along) == ("V", "reading", "output")
    assert low - 0.05 < effect.bend.at < high + 0.05


@pytest.mark.slow
def test_the_saved_simulation_is_that_of_the_whole_record(creeping, tmp_path):
    path = tmp_path / "extended_simulation.yaml"
    problem, final = creeping.problem, creeping.final
    save_extended(final.extended, final.values, problem.interval, path)
    extended, values, interval = load_extended(path)
    gap = problem.y - extended.simulate(values, problem.u, interval)
    np.testing.assert_array_equal(gap, final.residual)
    everything = np.ones(gap.size, bool)
    assert rmse(gap, everything) < 1.05 * rmse(creeping.extended.residual, everything)


@pytest.mark.slow
def test_the_datasets_keep_their_contracts(creeping, tmp_path):
    for name, dataset in (
        ("localisation", localisation_dataset(creeping)),
        ("candidates", candidates_dataset(creeping)),
        ("certificate", certificate_dataset(creeping)),
    ):
        CONTRACTS[name].check(dataset, tmp_path / name)
    assert np.allclose(candidates_dataset(creeping)["confusion"].sum("called"), 1.0)


@pytest.mark.slow
def test_a_share_is_counted_from_what_is_held_out_of_each_candidate(creeping):
    """A course in time is compared on other blocks than the other candidates."""
    singles, floor = creeping.singles, creeping.floor
    before = floor * np.linspace(2.0, 3.0, len(singles.candidates))
    gains = replace(singles.gains, before=before, gain=np.log(before / (1.5 * floor)))
    made = replace(creeping, singles=replace(singles, gains=gains))
    share = candidates_dataset(made)["share"].values
    finished = np.array([c.finished for c in singles.candidates])
    expected = 1.0 - np.sqrt(1.5**2 - 1.0) / np.sqrt((before / floor) ** 2 - 1.0)
    np.testing.assert_allclose(share[finished], expected[finished])
    assert np.isnan(share[~finished]).all()


@pytest.mark.slow
def test_a_diagnosis_does_not_depend_on_the_number_of_threads(creeping):
    assert diagnosed(("viscoelastic_creep", 3.0), workers=2).verdict == creeping.verdict


def test_effects_that_find_no_port_are_refused():
    simulation = replace(load_simulation("dea_membrane"), force_ports=())
    with pytest.raises(InputError, match="none of the effects offered can attach"):
        diagnose(record(duration=20.0), simulation, settings=Settings(effects=("end_stop",)))


@pytest.mark.parametrize(
    "wrong", [{"blocks": 0}, {"blocks": 2.5}, {"warm_up": -1.0}, {"slowest_time": 0.0}]
)
def test_a_setting_outside_its_range_is_named(wrong):
    with pytest.raises(InputError) as caught:
        Settings(**wrong)
    assert caught.value.field == next(iter(wrong))


def test_what_is_no_simulation_is_refused():
    with pytest.raises(InputError, match="it is a int"):
        diagnose(record(duration=20.0), 5)


def test_an_unknown_effect_is_refused():
    with pytest.raises(InputError, match="no effect 'magic'"):
        diagnose(record(duration=20.0), "dea_membrane", settings=Settings(effects=("magic",)))
