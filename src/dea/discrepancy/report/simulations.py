"""A simulation as a diagnosis has fitted it, as a file."""

from pathlib import Path
from typing import TYPE_CHECKING

from dea.simulation import save_extended

if TYPE_CHECKING:
    from dea.discrepancy.diagnosis import Diagnosis
    from dea.discrepancy.fit import Fit


def save_simulation(found: "Diagnosis", fit: "Fit", path: str | Path) -> None:
    """Write a simulation as a diagnosis has fitted it, with the start of the first record.

    Raises
    ------
    InputError
        As :func:`dea.simulation.save_extended`.
    """
    values = fit.extended.of_record(fit.values, 0)
    save_extended(fit.extended.alone, values, found.problem.recorded_interval, path)
