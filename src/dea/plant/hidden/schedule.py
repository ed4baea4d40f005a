"""What each trial of a campaign hides, and in which device: balanced, from the seed alone."""

from typing import NamedTuple

from numpy.random import Generator

from dea.plant.hidden.catalogue import EFFECTS
from dea.plant.hidden.devices import DEVICES, DeviceKind
from dea.plant.hidden.effect import EffectKind, Form, Port, Use
from dea.plant.hidden.noise import NoiseKind
from dea.seeds import generator

INSIDE = tuple(name for name, effect in EFFECTS.items() if effect.port is not Port.OUTSIDE)
# A round holds each effect of the catalogue once, and besides:
FOREIGN_SHARE, PAIR_SHARE, NULL_SHARE = 4, 4, 6
# Two effects of one group act alike, so that the stronger hides the other: no pair holds both.
_ALIKE = (
    {"input_saturation", "end_stop", "output_saturation", "strain_stiffening",
     "sensor_nonlinearity"},
    {"slew_limit", "transport_delay", "electrode_lag", "sensor_lag"},
    {"gain_drift", "baseline_drift", "stress_relaxation", "viscoelastic_creep",
     "cyclic_softening", "charge_leakage"},
    {"coulomb_friction", "rate_independent_hysteresis", "backlash"},
)  # fmt: skip
# What a device cannot have besides forces where nothing moves.
_IMPOSSIBLE = {"drive": {"charge_leakage"}, "chamber": {"charge_leakage"}}
# Trials in groups that a diagnosis may confuse, of which one or two effects are hidden.
AMBIGUOUS: tuple[tuple[tuple[str, ...], ...], ...] = (
    (("transport_delay",), ("electrode_lag",), ("sensor_lag",)),
    (("viscoelastic_creep",), ("baseline_drift",), ("charge_leakage",), ("stress_relaxation",)),
    (("rate_independent_hysteresis",), ("coulomb_friction",), ("backlash",)),
    (("cyclic_softening",), ("stress_relaxation",), ("gain_drift",)),
    (("viscoelastic_creep", "coulomb_friction"), ("transport_delay", "viscoelastic_creep"),
     ("cyclic_softening", "electrode_lag"), ("rate_independent_hysteresis", "baseline_drift")),
)  # fmt: skip


class Plan(NamedTuple):
    """What one trial hides: (effect, form) names, none, one or two; its device and its noise."""

    hidden: tuple[tuple[str, str], ...]
    device: str
    noise: NoiseKind


def forms_of(effect: EffectKind, device: DeviceKind, use: Use) -> list[Form]:
    """Return the forms of an effect that a device can have, of one use."""
    if effect.name in _IMPOSSIBLE.get(device.name, ()):
        return []
    if effect.port is Port.FORCE and not device.force:
        return []
    return [form for form in effect.forms if form.use is use and (device.force or not form.moving)]


def plans(seed: int, trials: int, use: Use) -> list[Plan]:
    """Return the plans of the first ``trials`` trials of a campaign of forms of one ``use``.

    Rounds in random order, so that any campaign is balanced over effects; within them forms,
    devices and kinds of noise are drawn. Half the trials have white noise; those without an effect
    have each kind in turn.
    """
    rng = generator(seed, "trials", "schedule", use)
    drawn: list[Plan] = []
    foreign = [name for name, effect in EFFECTS.items() if effect.port is Port.OUTSIDE]
    foreign = [name for name in foreign if EFFECTS[name].forms[0].use is use]
    kinds = list(NoiseKind)
    while len(drawn) < trials:
        pairs = [_pair(rng) for _ in range(PAIR_SHARE)]
        outside = rng.choice(foreign, FOREIGN_SHARE, replace=False)
        names = [(name,) for name in [*INSIDE, *outside.tolist()]] + pairs
        planned = [_plan(rng, hidden, use, _noise(rng)) for hidden in names]
        planned += [_plan(rng, (), use, kinds[k % len(kinds)]) for k in range(NULL_SHARE)]
        drawn += [planned[k] for k in rng.permutation(len(planned))]
    return drawn[:trials]


def ambiguous_plans(seed: int, trials: int, use: Use) -> list[Plan]:
    """Return the plans of trials drawn to be ambiguous, in the film and with white noise.

    The groups take turns; a group's members are drawn.
    """
    rng = generator(seed, "trials", "ambiguous", use)
    film = DEVICES["film"]
    planned = []
    for index in range(trials):
        group = AMBIGUOUS[index % len(AMBIGUOUS)]
        hidden = group[int(rng.integers(len(group)))]
        planned.append(Plan(_with_forms(rng, hidden, film, use), film.name, NoiseKind.WHITE))
    return planned


def _noise(rng: Generator) -> NoiseKind:
    others = [kind for kind in NoiseKind if kind is not NoiseKind.WHITE]
    return NoiseKind.WHITE if rng.random() < 0.5 else others[int(rng.integers(len(others)))]


def replanned(rng: Generator, plan: Plan, use: Use) -> Plan:
    """Return a plan that hides the same in forms and in a device drawn anew."""
    return _plan(rng, tuple(name for name, _ in plan.hidden), use, plan.noise)


def _plan(rng: Generator, names: tuple[str, ...], use: Use, noise: NoiseKind) -> Plan:
    able = [
        device
        for device in DEVICES.values()
        if all(forms_of(EFFECTS[name], device, use) for name in names)
    ]
    device = able[int(rng.integers(len(able)))]
    return Plan(_with_forms(rng, names, device, use), device.name, noise)


def _with_forms(
    rng: Generator, names: tuple[str, ...], device: DeviceKind, use: Use
) -> tuple[tuple[str, str], ...]:
    chosen = []
    for name in names:
        forms = forms_of(EFFECTS[name], device, use)
        chosen.append((name, forms[int(rng.integers(len(forms)))].name))
    return tuple(chosen)


def _pair(rng: Generator) -> tuple[str, ...]:
    while True:
        first, second = (str(name) for name in rng.choice(INSIDE, 2, replace=False))
        if not any(kind.issuperset({first, second}) for kind in _ALIKE):
            return first, second
