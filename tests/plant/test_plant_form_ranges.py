"""Sizes of effects, and the ranges that a form's description states, at both of their ends."""

import numpy as np
import pytest
from made_conditions import CONDITIONS, built

from dea.plant.hidden import EFFECTS
from dea.plant.signal_law import SignalLaw

K, TRAVEL, SPAN, TIME = (
    CONDITIONS.stiffness, CONDITIONS.travel, CONDITIONS.span, CONDITIONS.time
)  # fmt: skip


class AtEnd:
    """A generator whose every draw is at the lower (0) or the upper (1) end of its range."""

    def __init__(self, end):
        self.end = end

    def uniform(self, low=0.0, high=1.0, size=None):
        return self._shaped(low + self.end * (high - low), size)

    def random(self):
        return self.end

    def integers(self, low, high):
        return high - 1 if self.end else low

    def choice(self, values, size=None):
        return self._shaped(values[-1 if self.end else 0], size)

    @staticmethod
    def _shaped(value, size):
        return value if size is None else np.full(size, value)


def constants(law):
    """Return the constants of a law of either kind."""
    return law._constants if isinstance(law, SignalLaw) else np.asarray(law.constants)


def times_quicker(c):
    """Return how many times quicker the second of two masses is than the first."""
    return np.sqrt(c[4] / c[3] / (c[1] / c[0]))


# What is drawn, from the constants and the frequency of a law, and its range as the form states it,
# or what its law takes it for (the place of a level, a power of time).
STATED = {
    ("strain_stiffening", "ogden_term"): (lambda c, f: c[1], 3.5, 6.0),
    ("strain_stiffening", "taut_cables"): (lambda c, f: c[1] / TRAVEL, 0.5, 1.2),
    ("strain_stiffening", "gent"): (lambda c, f: c[1] / TRAVEL, 1.15, 1.5),
    ("strain_stiffening", "langevin_chain"): (lambda c, f: c[1] / TRAVEL, 1.1, 1.4),
    ("cyclic_softening", "power_of_cycles"): (lambda c, f: c[3], 0.25, 0.6),
    ("cyclic_softening", "paris_crack"): (lambda c, f: c[[3, 6]], [3.0, 2.5], [8.0, 4.0]),
    ("second_mode", "hardening_absorber"): (lambda c, f: f * TIME, 0.6, 2.0),
    ("second_mode", "shared_damping"): (lambda c, f: f * TIME, 0.6, 2.0),
    ("second_mode", "grounded_damper"): (lambda c, f: f * TIME, 0.6, 2.0),
    ("second_mode", "sloshing_pendulum"): (lambda c, f: f * TIME, 0.6, 2.0),
    ("second_mode", "twin_masses"): (
        lambda c, f: [f * TIME, times_quicker(c)], [0.6, 1.3], [1.6, 1.8]
    ),
    ("cyclic_softening", "three_stages"): (lambda c, f: c[[3, 8]], [0.2, 4.0], [0.4, 8.0]),
    ("strain_stiffening", "tendon_toe"): (lambda c, f: c[3] / TRAVEL, 0.5, 0.8),
    ("second_mode", "masses_in_series"): (lambda c, f: c[3] / c[0], 0.1, 0.5),
    ("rate_independent_hysteresis", "ramberg_osgood"): (lambda c, f: c[4], 3.0, 7.0),
    ("end_stop", "sprung_contact"): (lambda c, f: c[0] / K, 8.0, 30.0),
    ("end_stop", "stepped_pad"): (lambda c, f: c[[0, 3]] / K, [2.0, 15.0], [6.0, 40.0]),
    ("rate_independent_hysteresis", "prandtl_sliders"): (
        lambda c, f: c[[2, 12]] / TRAVEL, [0.1, 0.3], [0.1, 0.5]
    ),
    ("coulomb_friction", "maxwell_slip"): (
        lambda c, f: c[[2, 8]] / TRAVEL, [0.003, 0.03], [0.003, 0.03]
    ),
    ("coulomb_friction", "makkar"): (lambda c, f: c[5], -0.2, 0.2),
    ("output_saturation", "overload_recovery"): (lambda c, f: c[2] / c[1] / TIME, 0.05, 0.25),
    ("slew_limit", "switched_motor"): (lambda c, f: c[1] / SPAN, 0.002, 0.008),
    ("periodic_disturbance", "hunting_machine"): (lambda c, f: c[3], 0.3, 0.9),
    ("periodic_disturbance", "chopped_supply"): (lambda c, f: c[3], 0.3, 0.7),
    ("slew_limit", "stepping_motor"): (lambda c, f: c[0] / SPAN, 0.0003, 0.001),
    ("periodic_disturbance", "oil_whirl"): (lambda c, f: c[4] / c[1], 0.42, 0.48),
    ("periodic_disturbance", "supply_ripple"): (lambda c, f: c[0] * TIME, 0.2, 6.3),
    ("periodic_disturbance", "beating_machines"): (
        lambda c, f: (c[2] - c[1]) * CONDITIONS.duration, 2.0, 6.0
    ),
    ("modulated_gain", "modulated_gain"): (lambda c, f: c[1] * TIME, 0.316, 5.01),
    ("coarse_commands", "coarse_commands"): (
        lambda c, f: (c[1] - CONDITIONS.low) / c[0], 0.0, 1.0
    ),
    ("drifting_clock", "drifting_clock"): (lambda c, f: c[2], 0.7, 2.0),
    ("pumped_stiffness", "pumped_stiffness"): (lambda c, f: c[2] * TIME, 0.316, 5.01),
}  # fmt: skip


@pytest.mark.parametrize(("effect", "form"), STATED)
def test_the_ends_of_a_range_are_those_stated(effect, form):
    drawn, *ends = STATED[effect, form]
    for end, stated in enumerate(ends):
        law, defining = EFFECTS[effect].form(form).build(0.2, CONDITIONS, AtEnd(float(end)))
        found = drawn(constants(law), defining.get("frequency"))
        np.testing.assert_allclose(found, stated, rtol=3e-3)


@pytest.mark.parametrize("effect", EFFECTS.values(), ids=EFFECTS)
def test_every_form_has_a_law_at_either_end_of_an_effect_s_sizes(effect):
    assert 0.0 < effect.smallest < effect.largest
    for form in effect.forms:
        for size in (effect.smallest, effect.largest):
            law = built(effect.name, form.name, size)[0]
            assert not np.isnan(constants(law)).any()
