"""What can be wrong with the actuator and its instruments: the effects of the blind trials."""

from dea.bench.hidden import force_balance, in_time, input_path, output_path, outside
from dea.bench.hidden.effect import Conditions, Effect, Law, Stage

EFFECTS: dict[str, Effect] = {
    effect.name: effect
    for module in (input_path, force_balance, in_time, output_path, outside)
    for effect in module.EFFECTS
}

__all__ = ["EFFECTS", "Conditions", "Effect", "Law", "Stage"]
