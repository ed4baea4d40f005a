"""A simulation as a diagnosis has fitted it, as a file."""

from pathlib import Path

from dea.discrepancy.findings import Findings
from dea.discrepancy.fitting.fit import Fit
from dea.simulation import save_extended


def save_simulation(found: Findings, fit: Fit, path: str | Path) -> None:
    """Write a simulation as a diagnosis has fitted it, with the start of the first record.

    Raises
    ------
    InputError
        As :func:`dea.simulation.save_extended`.
    """
    values = fit.extended.layout.of_record(fit.values, 0)
    save_extended(fit.extended.alone, values, found.problem.recorded_interval, path)
