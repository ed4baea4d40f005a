"""Hidden laws do not depend on units: what is larger in all its lengths answers in proportion."""

import numpy as np
import pytest
from made_conditions import CONDITIONS as MINUTE
from made_conditions import built, resist, through

from dea.plant.hidden import EFFECTS
from dea.plant.signal_law import SignalLaw

CONDITIONS = MINUTE._replace(duration=4.0)  # so that faults come within a short signal
FORMS = [(kind.name, form.name) for kind in EFFECTS.values() for form in kind.forms]
LENGTHS = "rest", "bottom", "median", "top", "path"
# Powers of time in what defines a law.
IN_TIME = {"lag": 1, "delay": 1, "time": 1, "rate": -1, "frequency": -1}


def larger(factor, *names):
    """Return conditions in which these are ``factor`` times as large."""
    return CONDITIONS._replace(**{name: factor * getattr(CONDITIONS, name) for name in names})


def wander(low, high, samples):
    """Return a signal that moves in straight lines between random levels, every 0.2 s."""
    levels = np.random.default_rng(4).uniform(low, high, samples // 200 + 2)
    return np.interp(np.arange(samples), 200 * np.arange(levels.size), levels)


@pytest.mark.parametrize(("effect", "form"), FORMS)
@pytest.mark.parametrize("seed", [0, 1])
def test_answers_are_in_proportion(effect, form, seed):
    kind = EFFECTS[effect]
    size = np.sqrt(kind.smallest * kind.largest)
    law, _ = built(effect, form, size, seed, CONDITIONS)
    motion = wander(CONDITIONS.bottom, CONDITIONS.top, 4000)
    if isinstance(law, SignalLaw):
        command = wander(CONDITIONS.low, CONDITIONS.high, 4000)
        names, signal = (LENGTHS, motion) if law.output else (("low", "high"), command)
        scaled, _ = built(effect, form, size, seed, larger(7.0, *names))
        found, expected = through(scaled, 7.0 * signal), 7.0 * through(law, signal)
    else:
        scaled, _ = built(effect, form, size, seed, larger(7.0, *LENGTHS))
        stiffer, _ = built(effect, form, size, seed, larger(3.0, "stiffness"))
        found = np.append(resist(scaled, 7.0 * motion), resist(stiffer, motion))
        expected = np.append(7.0 * resist(law, motion), 3.0 * resist(law, motion))
    assert np.abs(expected).max() > 0.0
    np.testing.assert_allclose(found, expected, atol=1e-6 * np.abs(expected).max())


@pytest.mark.parametrize(("effect", "form"), FORMS)
def test_what_defines_a_law_in_time_follows_the_band_and_the_record(effect, form):
    kind = EFFECTS[effect]
    size = np.sqrt(kind.smallest * kind.largest)
    _, short = built(effect, form, size, conditions=CONDITIONS)
    _, long = built(effect, form, size, conditions=larger(5.0, "time", "duration"))
    for name, power in IN_TIME.items():
        if name in short:
            assert long[name] == pytest.approx(5.0**power * short[name], rel=0.02, abs=2e-3)
