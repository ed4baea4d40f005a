"""A name drawn from the catalogue, or none: what chance is worth."""

from benchmarks.naming.task import Answer, Method, Task
from dea.seeds import generator
from dea.simulation import catalogue


def answer(task: Task) -> Answer:
    """Draw one of the effects or none, each alike; predict with the simulation alone."""
    choices = ["", *catalogue()]
    drawn = generator(task.settings.seed, task.name, "random choice").choice(choices)
    ahead = task.ahead(task.nominal)
    return Answer("named", ahead, frozenset({str(drawn)})) if drawn else Answer("none", ahead)


METHOD = Method("random choice", "each effect, and none, with the same probability", answer)
