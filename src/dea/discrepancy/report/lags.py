"""A lag that a record shows, and does not place: what all of its explanations have in common."""

from collections.abc import Mapping, Sequence

from dea.discrepancy.fitting.candidates import Candidate
from dea.discrepancy.report.verdict import Estimate, NamedEffect
from dea.simulation import Attached, ExtendedSimulation, Family, Parameter, Port

# The times of the laws, each of which is about the delay of a slow signal.
_TIME = "s"
# From this time (s) on it is told in seconds.
_LONG = 1.0


def common_lag(
    answer: Candidate, effects: Sequence[NamedEffect], rivals: Sequence[Candidate]
) -> str:
    """Return the lag that an answer and its rivals share, with the places that it may have.

    That is empty where they differ by anything but one lag each. ``effects`` are those of the
    answer, in its order.
    """
    shared = set(answer.names).intersection(*(rival.names for rival in rivals))
    lags = [_own_lag(each, shared) for each in (answer, *rivals)]
    if not rivals or None in lags:
        return ""
    own, *others = (index for index in lags if index is not None)
    parameters = effects[own].parameters
    extended = answer.fit.extended
    attached = extended.attached[own]
    if _unit_of(attached.effect.defining, parameters) != _TIME:
        return ""
    times = [parameters[attached.effect.defining].value]
    places = [_place(extended, attached)]
    for rival, index in zip(rivals, others, strict=True):
        extended = rival.fit.extended
        attached, part = extended.attached[index], extended.layout.effect_slices[index]
        law = {each.name: each for each in attached.parameters}
        if _unit_of(attached.effect.defining, law) != _TIME:
            return ""
        times.append(float(rival.fit.values[part][list(law).index(attached.effect.defining)]))
        places.append(_place(extended, attached))
    return f"a lag of {_told(times)}, of {' or of '.join(dict.fromkeys(places))}"


def _own_lag(candidate: Candidate, shared: set[str]) -> int | None:
    """Return which of the effects is the only one that is not shared, if that is a lag."""
    own = [index for index, name in enumerate(candidate.names) if name not in shared]
    if len(own) != 1 or candidate.fit.extended.attached[own[0]].effect.family is not Family.LAG:
        return None
    return own[0]


def _unit_of(name: str, parameters: Mapping[str, "Estimate | Parameter"]) -> str | None:
    return parameters[name].unit if name in parameters else None


def _place(extended: ExtendedSimulation, attached: Attached) -> str:
    """Return where an effect acts, in words; of several inputs at which one."""
    if attached.effect.port is Port.OUTPUT:
        return "the sensor"
    at = extended.places.input_of(attached)
    return f"the input {at.name.replace('_', ' ')}" if at else "the input"


def _told(times: Sequence[float]) -> str:
    """Return times (s) as one where they agree to two digits, else as a range."""
    factor, unit = (1.0, "s") if max(times) >= _LONG else (1e3, "ms")
    ends = dict.fromkeys(f"{factor * time:.2g}" for time in (min(times), max(times)))
    return f"{' to '.join(ends)} {unit}"
