"""Diagnoses of a made device with two inputs, which is integrated by Euler's method."""

import re
from dataclasses import replace

import numpy as np
import pytest
from small_search import SEARCH

import two_inputs
from dea import Record
from dea.discrepancy import (
    Settings,
    candidates_dataset,
    certificate_dataset,
    diagnose,
    localisation_dataset,
)
from dea.discrepancy.diagnose import _count
from dea.discrepancy.evidence.localisation import localise
from dea.discrepancy.evidence.residual_model import dictionary
from dea.discrepancy.problem.period import period_of
from dea.discrepancy.problem.problem import Problem
from dea.discrepancy.problem.records import prepare, signals_of
from dea.discrepancy.problem.split import split
from dea.errors import InputError
from dea.resolution import Limits, Options
from dea.resolution.knowledge import Inquiry
from dea.resolution.weighing import begun
from dea.simulation import (
    ExtendedSimulation,
    ForcePort,
    Parameter,
    Simulation,
    State,
    catalogue,
    load_extended,
    load_simulation,
    save_extended,
)
from dea.store import CONTRACTS
from two_inputs import INTERVAL, NAMES, excitation, simulation

NOISE, PARTS = 4e-3, 40
OFFERED = (
    "transport_delay", "electrode_lag", "slew_limit", "sensor_lag", "dead_zone", "gain_drift",
)  # fmt: skip
UNITS = (("V", "A"), "K")


def recorded(delay=0.0, lag=0.0, samples=900, seed=1, start=0.2):
    """A record in which the right input comes late (s), or the left one through a lag (s).

    The delay is one of whole samples: between them the law joins the samples of the input, and this
    device takes the square of it.
    """
    rng = np.random.default_rng(seed)
    u = excitation(samples, seed)
    h, late = INTERVAL / PARTS, round(delay / INTERVAL * PARTS)
    fine = np.repeat(u, PARTS, axis=0)
    right = np.concatenate([np.full(late, u[0, 1]), fine[: len(fine) - late, 1]])
    wall, body, left = start, 0.1, u[0, 0]
    y = np.empty(samples)
    for k, (command, now) in enumerate(zip(fine[:, 0].tolist(), right.tolist(), strict=True)):
        left = left + h * (command - left) / lag if lag else command
        if k % PARTS == 0:
            y[k // PARTS] = body + 0.05 * now
        heated = 0.55 * left + 0.37 * now**2
        body += h * (0.7 * (wall - body) + 0.055 * left)
        wall += h * (heated - 0.28 * wall - 0.045 * wall * abs(wall))
    y += NOISE * rng.standard_normal(samples)
    return Record.of(u, y, 1.0 / INTERVAL, units=UNITS, names=(NAMES, "warmth"))


def found(*records, **options):
    settings = Settings(effects=OFFERED, warm_up=0.0, budget=SEARCH, **options)
    return diagnose(list(records), simulation, settings=settings)


@pytest.fixture(scope="module")
def late():
    return found(recorded(delay=2.0))


@pytest.mark.slow
def test_nothing_is_named_where_nothing_is_missing():
    verdict = found(recorded()).verdict
    assert verdict.status == "none", verdict.sentence


@pytest.mark.slow
def test_a_delay_is_named_at_its_input(late):
    verdict = late.verdict
    assert (verdict.status, verdict.names) == ("named", ("transport_delay",)), verdict.sentence
    (effect,) = verdict.effects
    assert (effect.place, effect.port) == ("right", "input path")
    assert effect.parameters["delay"].low <= 2.0 <= effect.parameters["delay"].high
    assert "`transport_delay` at right (delay 2 ±" in verdict.sentence
    assert verdict.presence["effects"]["transport_delay@right"] > 0.9
    assert verdict.certified["rmse_after"] < 1.3 * NOISE < verdict.certified["rmse_before"]
    labels = {label for c in late.singles.candidates for label in c.labels}
    assert {"transport_delay@left", "gain_drift@right", "sensor_lag"} <= labels


@pytest.mark.slow
def test_a_lag_is_named_at_its_input():
    verdict = found(recorded(lag=1.5)).verdict
    (effect,) = verdict.effects
    assert verdict.status == "named", verdict.sentence
    assert (effect.family, effect.place) == ("lag", "left"), verdict.sentence


@pytest.mark.slow
def test_the_datasets_hold_every_input(late, tmp_path):
    certificate, localisation = certificate_dataset(late), localisation_dataset(late)
    for dataset, name in (
        (certificate, "certificate"),
        (localisation, "localisation"),
        (candidates_dataset(late), "candidates"),
    ):
        CONTRACTS[name].check(dataset, tmp_path)
    assert certificate["input"].dims == ("time", "signal")
    assert tuple(certificate["signal"].values) == NAMES
    assert certificate["law_1_along"].attrs["long_name"] == "right"
    assert np.array_equal(certificate["law_1_along"], certificate["input"].sel(signal="right"))
    assert localisation["input_2_low_before"].attrs["units"] == "A"
    assert localisation["coherence_1_after"].attrs["long_name"] == "coherence of left and residual"


@pytest.mark.slow
def test_a_saved_extension_simulates_the_same(late, tmp_path):
    final = late.final
    own = replace(final.extended, simulation=load_simulation(two_inputs.__file__))
    save_extended(own, final.values, INTERVAL, tmp_path / "extended.yaml")
    again, values, interval = load_extended(tmp_path / "extended.yaml")
    u = late.problem.u
    assert np.array_equal(
        again.simulate(values, u, interval), final.extended.simulate(final.values, u, INTERVAL)
    )


@pytest.mark.slow
def test_several_records_are_diagnosed_together():
    verdict = found(recorded(delay=2.0, samples=500), recorded(2.0, 0.0, 500, 2, 0.5)).verdict
    assert (verdict.status, verdict.names) == ("named", ("transport_delay",)), verdict.sentence
    assert verdict.effects[0].place == "right"


def problem_of(u):
    every = np.ones(len(u), bool)
    return Problem(u, np.sin(np.arange(len(u))), INTERVAL, every, every, ~every)


def test_every_input_has_its_terms():
    names, X = dictionary(problem_of(excitation(200)), np.cos(np.arange(200)))
    assert {"u1", "u2^2", "u1 y", "u1 u2", "u2'", "time^1 u2", "max(u2 - 1.2, 0)"} & set(names) >= {
        "u1", "u2^2", "u1 y", "u1 u2", "u2'", "time^1 u2"
    }  # fmt: skip
    assert not any(re.search(r"\bu\b", name) for name in names)
    assert X.shape == (200, len(names))


def test_an_effect_is_offered_once_at_each_input_that_moves():
    offered = [catalogue()[name] for name in ("transport_delay", "gain_drift", "sensor_lag")]
    extended, u = ExtendedSimulation(simulation), excitation(200)
    assert _count(problem_of(u), extended, offered) == 5
    u[:, 1] = 1.0
    assert _count(problem_of(u), extended, offered) == 3


@pytest.mark.parametrize("level", [0.1, 1.0])
def test_an_input_that_rests_has_no_coherence_with_the_residual(level):
    u, rng = excitation(600), np.random.default_rng(0)
    u[:, 1] = level
    problem, gap = problem_of(u), rng.standard_normal(600)
    found = localise(problem, gap, simulation.inputs, "K", problem.fit, rng).dataset
    assert np.isfinite(found["coherence_1"]).all()
    assert np.isnan(found["coherence_2"]).all()


def test_inputs_repeat_where_all_that_move_do():
    k = np.arange(400)
    fast, slow = np.sin(2 * np.pi * k / 20), np.sin(2 * np.pi * k / 50)
    assert period_of(np.column_stack([fast, slow])) == 100
    assert period_of(np.column_stack([fast, np.ones(400)])) == period_of(fast) == 20
    noise = np.random.default_rng(0).standard_normal(400)
    assert period_of(np.column_stack([fast, noise])) == 0


def test_the_certified_block_stays_in_the_range_of_every_input():
    k = np.arange(900)
    high = abs(k - 450) < 30
    wide = np.column_stack([np.sin(k / 5.0), np.where(high, 3.0, np.sin(k / 7.0))])
    found = split(wide, 1.0, 2.0)
    assert wide[found.certify, 1].max() < 3.0
    assert split(wide[:, 0], 1.0, 2.0).certify[450]


@pytest.mark.parametrize(
    ("record", "said"),
    [
        (Record.of(excitation(99)[:, 0], np.ones(99), 2.0, units=("V", "K")), "has 1 input, the"),
        (
            Record.of(excitation(99), np.ones(99), 2.0, units=UNITS, names=(NAMES[::-1], "y")),
            "inputs are right, left",
        ),
        (Record.of(excitation(99), np.ones(99), 2.0, units=(("V", "V"), "K")), "in 'V', the"),
    ],
)
def test_a_record_of_other_inputs_is_refused(record, said):
    with pytest.raises(InputError, match=said) as refused:
        signals_of(record, simulation)
    assert "\n" not in str(refused.value)


def test_the_design_of_further_records_is_of_one_input():
    limits = Limits(-1.0, 1.0, np.inf, -1.0, 1.0, 1.0 / INTERVAL)
    inquiry = Inquiry(simulation, limits, Settings(), Options())
    with pytest.raises(InputError, match="further records can be designed for one input only"):
        begun([recorded(samples=40)], inquiry)


def test_a_record_in_which_one_input_is_off_can_be_diagnosed():
    """Its parameter changes nothing then, though the equations hold it."""
    made = recorded(samples=400)
    u = np.asarray(made.u).copy()
    u[:, 1] = 0.0
    off = Record.of(u, made.y, 1.0 / INTERVAL, units=UNITS, names=(NAMES, "warmth"))
    problem, _, _ = prepare([signals_of(off, simulation)], simulation, Settings())
    assert problem.size == 400


def test_a_simulation_that_rests_at_its_nominal_values_can_be_diagnosed():
    """A threshold that is put too high leaves the output at rest, and can be fitted."""

    def derivative(x, u, p, dx):
        dx[0] = 5.0 * (max(p[0] * u - p[1], 0.0) - x[0])

    behind = Simulation(
        name="behind_a_threshold", input_unit="V", output_unit="mm",
        states=(State("level", "mm", 0.0),),
        parameters=(
            Parameter("gain", "mm/V", 1.0, 0.2), Parameter("threshold", "mm", 1.2, 0.5)
        ),
        derivative=derivative, output=lambda x, u, p: x[0], drive="gain",
        force_ports=(ForcePort("level", "level", None),),
    )  # fmt: skip
    u = np.repeat(np.random.default_rng(2).uniform(0.0, 1.0, 40), 20)
    made = Record.of(u, np.maximum(u - 0.7, 0.0), 50.0, units=("V", "mm"))
    problem, _, _ = prepare([signals_of(made, behind)], behind, Settings())
    assert problem.size == 800
