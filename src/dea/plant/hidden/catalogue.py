"""Every effect that a blind trial may hide, by name."""

from dea.plant.hidden.effect import EffectKind
from dea.plant.hidden.forms import (
    backlash,
    command_curves,
    delays,
    disturbances,
    drifts,
    faults,
    foreign,
    foreign_motion,
    foreign_states,
    friction,
    lags,
    leakage,
    mechanics,
    memory,
    reading_curves,
    slewing,
    stops,
)

# The reporting set draws by this order; tuning sets change when forms are added.
_MODULES = (
    command_curves, reading_curves, slewing, delays, lags, leakage, memory, friction, backlash,
    mechanics, stops, drifts, faults, disturbances, foreign_motion, foreign,
    foreign_states,
)  # fmt: skip

EFFECTS: dict[str, EffectKind] = {
    effect.name: effect for module in _MODULES for effect in module.EFFECTS
}
