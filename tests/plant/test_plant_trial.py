"""Drawing blind trials: balanced, reproducible, of the drawn strength, and sealed."""

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from dea.errors import InputError
from dea.excitation import design
from dea.plant.hidden import EFFECTS
from dea.plant.hidden.draw import ROUND, STRONGEST, WEAKEST, draw, schedule
from dea.plant.hidden.effect import Port
from dea.plant.hidden.trial import Trial

pytestmark = pytest.mark.slow

CONFIG = Path(__file__).parents[2] / "config" / "bench.yaml"
SEED = 41


def test_a_campaign_is_balanced():
    names = schedule(SEED, 10 * ROUND)
    single = Counter(drawn[0] for drawn in names if len(drawn) == 1)
    catalogue = [name for name, effect in EFFECTS.items() if effect.port is not Port.OUTSIDE]
    assert all(single[name] == 10 for name in catalogue)
    assert sum(single.values()) == 240
    assert sum(not drawn for drawn in names) == 30
    pairs = [drawn for drawn in names if len(drawn) == 2]
    assert len(pairs) == 30
    assert all(first != second for first, second in pairs)
    assert not any(pair <= {"end_stop", "output_saturation"} for pair in map(set, pairs))
    assert {name for pair in pairs for name in pair} <= set(catalogue)


def test_the_schedule_of_a_trial_does_not_depend_on_how_many_follow():
    assert schedule(SEED, 7) == schedule(SEED, 100)[:7]
    assert schedule(SEED + 1, 100) != schedule(SEED, 100)


@pytest.fixture(scope="module")
def trials():
    return [draw(CONFIG, SEED, index) for index in range(6)]


def test_a_drawn_trial_hides_what_the_schedule_says_at_a_strength_in_range(trials):
    for trial, names in zip(trials, schedule(SEED, 6), strict=True):
        assert tuple(effect.name for effect in trial.effects) == names
        for effect in trial.effects:
            known = EFFECTS[effect.name]
            assert WEAKEST <= effect.strength <= STRONGEST
            assert known.smallest <= effect.size <= known.largest


def test_drawing_again_gives_the_same(trials):
    assert draw(CONFIG, SEED, 2) == trials[2]
    assert len({trial.excitation["seed"] for trial in trials}) == len(trials)


def test_a_trial_survives_its_file_and_runs_the_same(trials, tmp_path):
    trial = trials[1]
    path = tmp_path / "sealed.json"
    trial.write(path)
    again = Trial.read(path)
    assert again == trial
    counts = np.rint(design(**trial.excitation) * 65536 / 15).astype(np.uint16)
    first, second = trial.rig(CONFIG), again.rig(CONFIG)
    np.testing.assert_array_equal(first.advance(counts)[1], second.advance(counts)[1])
    assert first.fault == 0


def test_the_label_tells_what_the_excitation_does_not(trials):
    for trial in trials:
        label = trial.label()
        assert [effect["name"] for effect in label["effects"]] == [e.name for e in trial.effects]
        assert not any(name in repr(trial.excitation) for name in EFFECTS)
        assert design(**trial.excitation).size == 50 * trial.excitation["duration"]


def test_a_file_that_is_no_trial_is_refused(tmp_path):
    path = tmp_path / "sealed.json"
    with pytest.raises(InputError, match="not a trial"):
        Trial.read(path)
    path.write_text('{"name": "0001"}')
    with pytest.raises(InputError, match="Draw the trial again"):
        Trial.read(path)
