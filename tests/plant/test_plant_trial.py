"""Drawing blind trials: balanced, reproducible, of the drawn strength, and sealed."""

from collections import Counter
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from made_conditions import CONDITIONS

from dea.configuration.trials import Seeds
from dea.errors import InputError
from dea.excitation import design
from dea.plant.drive import Drive
from dea.plant.hidden import EFFECTS, TRIAL_SETS, Use
from dea.plant.hidden.devices import DEVICES
from dea.plant.hidden.draw import FEWEST, MOST, _draw_noise, _sized, draw, draw_excitation
from dea.plant.hidden.effect import Port
from dea.plant.hidden.noise import Noise, NoiseKind
from dea.plant.hidden.schedule import (
    AMBIGUOUS,
    FOREIGN_SHARE,
    INSIDE,
    NULL_SHARE,
    PAIR_SHARE,
    ambiguous_plans,
    forms_of,
    plans,
)
from dea.plant.hidden.trial import HiddenEffect, Trial
from dea.stages.trial_score import begun
from dea.trials import Label

CONFIG = Path(__file__).parents[2] / "config" / "bench.yaml"
SEED = 41
ROUND = len(INSIDE) + FOREIGN_SHARE + PAIR_SHARE + NULL_SHARE


@pytest.mark.parametrize("use", Use)
def test_a_campaign_is_balanced_and_of_one_use(use):
    planned = plans(SEED, 6 * ROUND, use)
    single = Counter(plan.hidden[0][0] for plan in planned if len(plan.hidden) == 1)
    assert all(single[name] == 6 for name in INSIDE)
    assert sum(not plan.hidden for plan in planned) == 36
    assert sum(len(plan.hidden) == 2 for plan in planned) == 24
    nulls = Counter(plan.noise for plan in planned if not plan.hidden)
    assert nulls == dict.fromkeys(NoiseKind, 6)
    for plan in planned:
        for name, form in plan.hidden:
            assert EFFECTS[name].form(form).use is use
            assert EFFECTS[name].form(form) in forms_of(EFFECTS[name], DEVICES[plan.device], use)
    assert {plan.device for plan in planned} == set(DEVICES)
    assert {plan.noise for plan in planned} == set(NoiseKind)


def test_no_pair_holds_two_effects_that_act_alike():
    pairs = [
        {n for n, _ in p.hidden} for p in plans(SEED, 900, Use.REPORTING) if len(p.hidden) == 2
    ]
    assert all(len(pair) == 2 for pair in pairs)
    assert not any(pair <= {"end_stop", "output_saturation"} for pair in pairs)
    assert all(EFFECTS[n].port is not Port.OUTSIDE for pair in pairs for n in pair)


def test_the_plan_of_a_trial_does_not_depend_on_how_many_follow():
    assert plans(SEED, 7, Use.TUNING) == plans(SEED, 100, Use.TUNING)[:7]
    assert plans(SEED + 1, 100, Use.TUNING) != plans(SEED, 100, Use.TUNING)


def test_ambiguous_trials_take_their_groups_in_turn():
    planned = ambiguous_plans(SEED, 50, Use.REPORTING)
    for index, plan in enumerate(planned):
        assert tuple(name for name, _ in plan.hidden) in AMBIGUOUS[index % len(AMBIGUOUS)]
        assert plan.device == "film"
    assert {tuple(n for n, _ in p.hidden) for p in planned} >= {("transport_delay",)}


@pytest.fixture(scope="module")
def trials():
    return [draw(CONFIG, SEED, index, Use.REPORTING) for index in range(5)]


@pytest.mark.slow
def test_a_drawn_trial_hides_what_its_plan_says_at_a_strength_in_range(trials):
    for trial, plan in zip(trials, plans(SEED, 5, Use.REPORTING), strict=True):
        assert [effect.name for effect in trial.effects] == [name for name, _ in plan.hidden]
        assert trial.noise.kind is plan.noise
        for effect in trial.effects:
            known = EFFECTS[effect.name]
            assert 3.0 <= effect.strength <= 30.0
        if not trial.effects:
            assert trial.strength == 0.0
            assert known.smallest <= effect.size <= known.largest
        samples = design(**trial.excitation).size
        assert FEWEST <= samples <= MOST


@pytest.mark.parametrize(("strength", "taken"), [(2.9, 0), (3.1, 1), (29.0, 1), (31.0, 0)])
def test_an_effect_that_cannot_be_made_as_strong_as_it_may_be_is_not_taken(strength, taken):
    """Its strength is between 3 and 30 times the noise; here it has one, whatever its size."""
    effect = EFFECTS["modulated_gain"]
    yardstick = SimpleNamespace(linear_strength=lambda _: strength, strength=lambda _: strength)
    found = _sized(effect, effect.forms[0], yardstick, CONDITIONS, np.random.default_rng(1))
    assert (found is not None) == taken
    assert found is None or found.strength == strength


def test_drawing_again_gives_the_same(trials):
    assert draw(CONFIG, SEED, 2, Use.REPORTING) == trials[2]
    assert len({trial.excitation["seed"] for trial in trials}) == len(trials)


def test_a_trial_survives_its_file_and_reads_the_same(trials, tmp_path):
    for trial in trials[:2]:
        path = tmp_path / "sealed.json"
        trial.write(path)
        again = Trial.read(path)
        assert again == trial
        volts = design(**trial.excitation)[:400]
        for first, second in zip(
            trial.readings(CONFIG, volts), again.readings(CONFIG, volts), strict=True
        ):
            np.testing.assert_array_equal(first, second)


def test_a_record_of_the_drive_begins_where_the_first_command_holds_it():
    drive = Drive()
    trial = Trial(
        name="rest", device="drive", factors={}, excitation={"sampling_rate": 50.0},
        conditions=CONDITIONS, effects=(), strength=0.0, noise=Noise(NoiseKind.WHITE, 0.01), seed=1,
    )  # fmt: skip
    _, truth = trial.readings(CONFIG, np.full(50, 3.0))
    np.testing.assert_allclose(truth, drive.gain * 3.0 / drive.stiffness, rtol=1e-6)


def test_a_drive_s_fault_is_at_the_moment_of_its_record_that_the_scored_label_says(tmp_path):
    hidden = HiddenEffect("step_fault", "biased_sensor", 0.3, 7, 10.0)
    conditions = CONDITIONS._replace(duration=10.0)
    trial = Trial(
        name="fault", device="drive", factors={}, excitation={"sampling_rate": 50.0, "kind": "-"},
        conditions=conditions, effects=(hidden,), strength=10.0,
        noise=Noise(NoiseKind.WHITE, 0.01), seed=1,
    )  # fmt: skip
    _, truth = trial.readings(CONFIG, np.full(500, 3.0))
    first, start = begun(trial, tmp_path)
    said = Label.of(trial.label(), start).defining["step_fault", "time"]
    jump = int(np.argmax(np.abs(np.diff(truth))))
    assert first == 0
    # The jump takes up to a tenth of a second.
    assert said == pytest.approx(jump / 50.0, abs=0.12)


def test_a_served_trial_keeps_its_truth_whatever_the_cuts():
    trial = draw(CONFIG, SEED, 0, Use.TUNING, ambiguous=True)
    counts = np.rint(design(**trial.excitation)[:600] * 65535 / 15).astype(np.uint16)
    whole, pieces = trial.served(CONFIG), trial.served(CONFIG)
    applied, measured = whole.advance(counts)
    np.testing.assert_array_equal(applied, counts)
    parts = [pieces.advance(piece)[1] for piece in np.split(counts, [1, 13, 500])]
    np.testing.assert_array_equal(measured, np.concatenate(parts))
    np.testing.assert_array_equal(whole.truth, pieces.truth)
    wrong = measured * 10.0 / 65535 - whole.truth
    assert wrong.std() == pytest.approx(1e3 * trial.noise.rms, rel=0.15)


def test_the_label_tells_what_the_excitation_does_not(trials):
    for trial in trials:
        label = trial.label()
        assert [effect["name"] for effect in label["effects"]] == [e.name for e in trial.effects]
        assert all(effect["use"] is Use.REPORTING for effect in label["effects"])
        assert not any(name in repr(trial.excitation) for name in EFFECTS)


@pytest.mark.parametrize("seed", range(20))
def test_an_excitation_is_as_slow_as_its_device(seed):
    fast = replace(DEVICES["film"], time=0.5)
    found, slow = (
        draw_excitation(np.random.default_rng(seed), device)
        for device in (fast, replace(fast, time=2.0))
    )
    for name in ("active", "rest", "period", "hold", "rise", "slowest", "fastest"):
        if name in found:
            assert slow[name] == pytest.approx(4.0 * found[name])
    if "band" in found:
        assert slow["band"] == pytest.approx(found["band"] / 4.0)


def test_a_file_that_is_no_trial_is_refused(tmp_path):
    path = tmp_path / "sealed.json"
    with pytest.raises(InputError, match="not a trial"):
        Trial.read(path)
    path.write_text('{"name": "0001"}')
    with pytest.raises(InputError, match="Draw the trial again"):
        Trial.read(path)


def test_the_noise_of_each_kind_has_the_correlation_and_shift_of_that_kind():
    device, rate = DEVICES["film"], 50.0
    correlations = {NoiseKind.COLOURED: (2.0, 15.0), NoiseKind.DRIFTING: (200.0, 2000.0)}
    for kind in NoiseKind:
        drawn = [_draw_noise(np.random.default_rng(s), kind, device, rate) for s in range(20)]
        low, high = correlations.get(kind, (0.0, 0.0))
        assert all(each.kind is kind and low <= each.correlation <= high for each in drawn)
        # Less than the 20 ms between readings, in milliseconds.
        shifted = kind is NoiseKind.SHIFTED
        assert all((0 < abs(each.shift) < 20) == shifted for each in drawn)
        assert {np.sign(each.shift) for each in drawn} == ({-1, 1} if shifted else {0})


@pytest.mark.slow
def test_devices_vary_by_no_more_than_the_spread_of_each_parameter():
    for trial in (draw(CONFIG, SEED, index, Use.TUNING) for index in range(4)):
        spread = DEVICES[trial.device].spread
        assert set(trial.factors) == set(spread)
        assert all(abs(np.log(trial.factors[name])) <= most for name, most in spread.items())


@pytest.mark.parametrize(
    ("trials", "use"),
    [("tuning", Use.TUNING), ("ambiguous_tuning", Use.TUNING), ("reporting", Use.REPORTING),
     ("ambiguous", Use.REPORTING)],
)  # fmt: skip
def test_a_set_hides_forms_of_its_own_use(trials, use):
    assert TRIAL_SETS[trials].use == use


def test_every_set_that_the_configuration_knows_says_what_it_hides():
    assert set(TRIAL_SETS) == set(Seeds.model_fields)
    assert {name for name, each in TRIAL_SETS.items() if each.ambiguous} == {
        "ambiguous", "ambiguous_tuning",
    }  # fmt: skip
