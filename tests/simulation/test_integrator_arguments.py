"""What the integrator takes: functions of its own signatures alone."""

import pytest
from numba import typeof

from dea.simulation.arguments import EQUATIONS, Equations, ForceLaw
from dea.simulation.devices.mass_spring_damper import derivative, output
from dea.simulation.signatures import first_class, no_force, no_update


def equations(derivative=derivative, output=output, force=no_force, update=no_update):
    empty = ForceLaw(first_class(no_force), first_class(no_update))
    last = ForceLaw(first_class(force), first_class(update))
    return Equations(first_class(derivative), first_class(output), empty, empty, last)


def test_functions_of_the_integrators_signatures_have_its_type():
    assert typeof(equations()) is EQUATIONS


@pytest.mark.parametrize(
    "wrong", [{"derivative": output}, {"output": no_force}, {"force": output}, {"update": no_force}]
)
def test_a_function_of_another_signature_is_refused(wrong):
    with pytest.raises(ValueError, match="Cannot determine Numba type"):
        typeof(equations(**wrong))
