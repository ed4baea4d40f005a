"""Every effect that a blind trial may hide, by name."""

from dea.plant.hidden.effect import EffectKind
from dea.plant.hidden.forms import curves, foreign, in_time, lags, leakage, mechanics, memory

EFFECTS: dict[str, EffectKind] = {
    effect.name: effect
    for module in (curves, lags, leakage, memory, mechanics, in_time, foreign)
    for effect in module.EFFECTS
}
