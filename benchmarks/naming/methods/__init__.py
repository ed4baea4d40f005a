"""The methods: each module of this package that defines ``METHOD`` adds one."""

from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from benchmarks.naming.task import Method

# The method whose error the others' are divided by.
REFERENCE = "simulation_alone"


@cache
def methods() -> dict[str, Method]:
    """Return every method by the name of its module."""
    names = sorted(module.name for module in iter_modules(__path__) if module.name[0] != "_")
    return {name: import_module(f"{__name__}.{name}").METHOD for name in names}
