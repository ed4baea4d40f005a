"""Grey-box selection by AIC: the best effect, and a second one where that lowers the criterion."""

from benchmarks.naming.methods._grey_box import selected
from benchmarks.naming.task import Answer, Method, Task


def answer(task: Task) -> Answer:
    """Select up to two effects."""
    return selected(task, most=2)


METHOD = Method(
    "grey box, AIC",
    "Akaike, IEEE Trans. Autom. Control 19 (1974) 716; Kristensen, Madsen and Jørgensen, "
    "Automatica 40 (2004) 225",
    answer,
)
