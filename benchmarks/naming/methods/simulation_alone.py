"""The simulation with its parameters fitted, and nothing attached: what the others must beat."""

from benchmarks.naming.task import Answer, Method, Task


def answer(task: Task) -> Answer:
    """Say that nothing is missing."""
    return Answer("none", task.ahead(task.nominal))


METHOD = Method("simulation alone", "a fit of its parameters by Levenberg–Marquardt", answer)
