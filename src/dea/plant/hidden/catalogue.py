"""Every effect that a blind trial may hide, by name."""

from dea.plant.hidden import force_port, input_path, output_path, outside, parameter_in_time
from dea.plant.hidden.effect import EffectKind

EFFECTS: dict[str, EffectKind] = {
    effect.name: effect
    for module in (input_path, force_port, parameter_in_time, output_path, outside)
    for effect in module.EFFECTS
}
