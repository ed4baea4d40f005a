"""The catalogue: each module of this package that defines ``EFFECT`` adds one effect."""

from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from dea.simulation.effects._effect import Effect, Family, Port, Quantity
from dea.simulation.effects._laws import low_pass, low_pass_step

__all__ = ["Effect", "Family", "Port", "Quantity", "catalogue", "low_pass", "low_pass_step"]


@cache
def catalogue() -> dict[str, Effect]:
    """Return every effect by name, in the order of their names."""
    names = sorted(module.name for module in iter_modules(__path__) if module.name[0] != "_")
    effects = [import_module(f"{__name__}.{name}").EFFECT for name in names]
    return {effect.name: effect for effect in effects}
