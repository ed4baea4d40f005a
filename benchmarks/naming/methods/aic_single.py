"""Grey-box selection by AIC among single effects: told that no more than one is missing."""

from benchmarks.naming.methods._grey_box import selected
from benchmarks.naming.task import Answer, Method, Task


def answer(task: Task) -> Answer:
    """Select one effect at most."""
    return selected(task, most=1)


METHOD = Method("grey box, AIC, one effect at most", "as above", answer)
