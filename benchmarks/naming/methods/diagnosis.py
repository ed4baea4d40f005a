"""The diagnosis of this project."""

from benchmarks.naming.task import Answer, Method, Task
from dea.discrepancy import diagnose
from dea.store import Record


def answer(task: Task) -> Answer:
    """Diagnose the seen part, of which the diagnosis keeps back another part for itself.

    Without an answer the prediction is that of the simulation alone, fitted to all of the seen
    part as the other methods have it: the diagnosis' own fit leaves out what it keeps back.
    """
    own = task.simulation
    units = own.input_unit, own.output_unit
    record = Record.of(task.seen.u, task.seen.y, 1.0 / task.interval, units=units)
    found = diagnose(record, own, settings=task.settings)
    verdict = found.verdict
    return Answer(
        verdict.status,
        task.ahead(found.final if found.decision.answer else task.nominal),
        frozenset(verdict.names),
        tuple(frozenset(rival) for rival in verdict.rivals),
    )


METHOD = Method("`dea.diagnose`", "docs/discrepancy.md", answer)
