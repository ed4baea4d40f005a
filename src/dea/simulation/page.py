"""The page of the documentation that lists the parameters of every law, and its starts."""

from collections.abc import Iterator
from dataclasses import asdict
from math import isfinite

from dea.number_format import DASH, written_out
from dea.simulation.effects import Effect, catalogue
from dea.simulation.parameter import Parameter
from dea.simulation.scales import Scales

# No two of its quantities coincide, so that the page shows which one a value is made of.
REFERENCE = Scales(
    u_unit="V",
    y_unit="um",
    u_low=1.0,
    u_high=3.0,
    u_rate=7.0,
    y_low=10.0,
    y_high=31.0,
    z_low=0.17,
    z_high=0.9,
    interval=0.02,
    duration=110.0,
    frequencies=(0.83, 1.3),
    foreign_frequencies=(1.9, 4.7),
    jumps=(37.0, 59.0),
    z_rate=0.41,
)
_HEAD = """# Parameters of the laws

Every effect that a diagnosis can name ([discrepancy.md](discrepancy.md)), with the parameters of
its law: what is assumed of each before a record is seen, within which bounds it is fitted, and from
which points. `make laws` writes this page anew from `src/dea/simulation/effects`.

The values follow from the record. Here they are those of one with

* an input from {u_low:g} to {u_high:g} {u_unit}, hardly ever faster than {u_rate:g} {u_unit}/s,
* an output from {y_low:g} to {y_high:g} {y_unit},
* a normalised position, 0 at rest and 1 at the largest excursion, from {z_low:g} to {z_high:g},
  hardly ever faster than {z_rate:g} per s,
* a sample every {interval:g} s for {duration:g} s,
* a residual with lines at {lines} Hz, and at {foreign} Hz, which the input does not have, and
* jumps of the residual at {instants} s.

The spread is the standard deviation of the prior; after a × it is that of the natural logarithm of
a positive parameter. The last column tells what a fit does with the parameter:

* free: it is fitted from the beginning;
* shape: it only shapes the law, and is held until place and size of the effect are found;
* start: it belongs to the state at the start of a record, and is fitted anew to another;
* event: it says when something happened, or how long that took, and is not estimated again where
  the samples around it are left out;
* known: no fit changes it, except that a ratio of one side to the other is fitted where the input
  has both signs, and that of falling to rising where it has one.

The *defining* parameter of a law is the one that a verdict tells first. A law whose *essential*
parameter is at its lower or, where that is said, upper bound is no longer the effect; where it fits
as well there, the effect is not named.

The second table of each law is of the points from which it is fitted. A parameter that is not in it
starts from its prior.
"""


def page() -> str:
    """Return ``docs/laws.md``."""
    head = _HEAD.format(
        **asdict(REFERENCE),
        lines=_all(REFERENCE.frequencies),
        foreign=_all(REFERENCE.foreign_frequencies),
        instants=_all(REFERENCE.jumps),
    )
    return "\n".join([head, *(line for each in catalogue().values() for line in _section(each))])


def _section(effect: Effect) -> Iterator[str]:
    parameters, starts = effect.parameters(REFERENCE), effect.starts(REFERENCE)
    yield f"## {effect.name}\n"
    yield f"Symptom: {effect.symptom}.\n"
    yield f"Port: {effect.port}. Family: {effect.family}.\n"
    yield f"Law: {effect.citation}.\n"
    if effect.defining:
        yield f"Defining: `{effect.defining}`.\n"
    if effect.essential:
        at = ", at its upper bound" if effect.vanishes_at == "high" else ""
        yield f"Essential: `{effect.essential}`{at}.\n"
    yield "| parameter | unit | prior | spread | low | high | fit |"
    yield "| --- | --- | --- | --- | --- | --- | --- |"
    for each in parameters:
        spread = ("× " if each.log and each.spread else "") + _short(each.spread)
        values = f"{_short(each.nominal)} | {spread} | {_short(each.low)} | {_short(each.high)}"
        yield f"| `{each.name}` | {each.unit} | {values} | {_fit(each)} |"
    yield f"\n| start | {' | '.join(str(k + 1) for k in range(len(starts)))} |"
    yield f"|{' --- |' * (1 + len(starts))}"
    for k, each in enumerate(parameters):
        begins = [start[k] for start in starts]
        if any(value != each.nominal for value in begins):
            yield f"| `{each.name}` | {' | '.join(map(_short, begins))} |"
    yield ""


def _fit(parameter: Parameter) -> str:
    if parameter.spread == 0.0:
        return "known"
    kinds = {"shape": parameter.shape, "start": parameter.at_start, "event": parameter.event}
    return ", ".join(kind for kind, applies in kinds.items() if applies) or "free"


def _short(value: float) -> str:
    return written_out(f"{value + 0.0:.4g}") if isfinite(value) else DASH


def _all(values: tuple[float, ...]) -> str:
    return " and ".join(f"{value:g}" for value in values)
