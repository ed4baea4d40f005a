"""A lag that a record shows, and does not place: what all of its explanations have in common."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from dea.simulation import Effect, Family, Port, catalogue

if TYPE_CHECKING:
    from dea.discrepancy.report.verdict import NamedEffect
    from dea.discrepancy.search.candidates import Candidate

# The times of the laws, each of which is about the delay of a slow signal.
_TIME = "s"
# From this time (s) on it is told in seconds.
_LONG = 1.0


def common_lag(
    answer: "Candidate", effects: Sequence["NamedEffect"], rivals: Sequence["Candidate"]
) -> str:
    """Return the lag that an answer and its rivals share, with the places that it may have.

    That is empty where they differ by anything but one lag each. ``effects`` are those of the
    answer, in its order.
    """
    shared = set(answer.names).intersection(*(rival.names for rival in rivals))
    lags = [_own_lag(each.names, shared) for each in (answer, *rivals)]
    if not rivals or None in lags:
        return ""
    own, *others = (index for index in lags if index is not None)
    parameters = effects[own].parameters
    defining = _effect_of(answer.names[own]).defining
    if defining not in parameters or parameters[defining].unit != _TIME:
        return ""
    times = [parameters[defining].value]
    places = [_place(answer.names[own])]
    for rival, index in zip(rivals, others, strict=True):
        extended = rival.fit.extended
        attached, part = extended.attached[index], extended.effect_slices[index]
        units = {each.name: each.unit for each in attached.parameters}
        if units.get(attached.effect.defining) != _TIME:
            return ""
        times.append(float(rival.fit.values[part][list(units).index(attached.effect.defining)]))
        places.append(_place(rival.names[index]))
    return f"a lag of {_told(times)}, of {' or of '.join(dict.fromkeys(places))}"


def _own_lag(names: Sequence[str], shared: set[str]) -> int | None:
    """Return which of the effects is the only one that is not shared, if that is a lag."""
    own = [index for index, name in enumerate(names) if name not in shared]
    if len(own) != 1 or _effect_of(names[own[0]]).family is not Family.LAG:
        return None
    return own[0]


def _effect_of(name: str) -> Effect:
    return catalogue()[name.partition("@")[0]]


def _place(name: str) -> str:
    """Return where an effect acts, in words; of several inputs at which one."""
    if _effect_of(name).port is Port.OUTPUT:
        return "the sensor"
    at = name.partition("@")[2]
    return f"the input {at.replace('_', ' ')}" if at else "the input"


def _told(times: Sequence[float]) -> str:
    """Return times (s) as one where they agree to two digits, else as a range."""
    factor, unit = (1.0, "s") if max(times) >= _LONG else (1e3, "ms")
    ends = dict.fromkeys(f"{factor * time:.2g}" for time in (min(times), max(times)))
    return f"{' to '.join(ends)} {unit}"
