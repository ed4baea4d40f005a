"""Drawing blind trials: effects, their strength, the actuator and the excitation."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.random import Generator

from dea.excitation import design
from dea.plant.hidden.catalogue import EFFECTS
from dea.plant.hidden.effect import Conditions, EffectKind, Port
from dea.plant.hidden.refit import Yardstick
from dea.plant.hidden.trial import HiddenEffect, Trial
from dea.plant.parameters import read_plain
from dea.plant.rig import SAMPLE_PERIOD, Law
from dea.seeds import generator

WEAKEST, STRONGEST = 3.0, 30.0  # RMS residual of the refitted plain actuator over RMS noise
_INSIDE = [name for name, effect in EFFECTS.items() if effect.port is not Port.OUTSIDE]
_OUTSIDE = [name for name, effect in EFFECTS.items() if effect.port is Port.OUTSIDE]
# Thirty trials hold each effect of the catalogue once, and besides:
_OUTSIDE_SHARE, _PAIR_SHARE, _NULL_SHARE = 4, 3, 3
ROUND = len(_INSIDE) + _OUTSIDE_SHARE + _PAIR_SHARE + _NULL_SHARE
# Two effects of one group act alike, so that the stronger hides the other: no pair holds both.
_ALIKE = (
    {"input_saturation", "end_stop", "output_saturation", "strain_stiffening"},
    {"slew_limit", "transport_delay", "electrode_lag", "sensor_lag"},
)
_SPREAD = {"prestretch": 0.015, "yeoh_1": 0.05, "damping": 0.3, "contact_radius": 0.05}
_SEARCHES, _TOLERANCE = 9, 1.08
_CORRECTIONS = 3


def schedule(seed: int, trials: int) -> list[tuple[str, ...]]:
    """Return the names hidden in each of ``trials`` trials: none, one or two.

    Rounds of thirty in random order, so that any campaign is balanced.
    """
    rng = generator(seed, "trials", "schedule")
    names: list[tuple[str, ...]] = []
    while len(names) < trials:
        pairs = [_draw_pair(rng) for _ in range(_PAIR_SHARE)]
        outside = rng.choice(_OUTSIDE, _OUTSIDE_SHARE, replace=False)
        drawn = [(name,) for name in [*_INSIDE, *outside]] + pairs + [()] * _NULL_SHARE
        names += [drawn[k] for k in rng.permutation(len(drawn))]
    return [tuple(str(name) for name in drawn) for drawn in names[:trials]]


def _draw_pair(rng: Generator) -> tuple[str, ...]:
    while True:
        pair = tuple(str(name) for name in rng.choice(_INSIDE, 2, replace=False))
        if not any(kind.issuperset(pair) for kind in _ALIKE):
            return pair


def draw(config: Path, seed: int, index: int) -> Trial:
    """Draw trial ``index`` of the campaign with ``seed`` for the configuration at ``config``.

    Each effect by itself is sized for a strength drawn between 3 and 30 on a logarithmic scale.
    Where an effect does not reach its strength on the drawn actuator under the drawn excitation, or
    one of two hides the other, all are drawn again.
    """
    rng = generator(seed, "trials", str(index))
    names = schedule(seed, index + 1)[index]
    trial = None
    while trial is None:
        trial = _attempt(config, f"{index:04d}", names, rng)
    return trial


def _attempt(config: Path, name: str, names: tuple[str, ...], rng: Generator) -> Trial | None:
    plain = read_plain(config).film
    film = {
        key: getattr(plain, key) * np.exp(spread * rng.uniform(-1.0, 1.0))
        for key, spread in _SPREAD.items()
    }
    parameters = read_plain(config, film)
    excitation = _draw_excitation(rng)
    voltage = design(**excitation)
    yardstick = Yardstick(parameters, parameters.output_converter.to_counts(voltage))
    conditions = yardstick.conditions()
    effects: list[HiddenEffect] = []
    for effect in names:
        hidden = _sized(EFFECTS[effect], yardstick, rng)
        if hidden is None:
            return None
        effects.append(hidden)
    if _masked(effects, yardstick):
        return None
    together = yardstick.strength(_laws(effects, conditions))
    if not np.isfinite(together):
        return None
    return Trial(
        name=name,
        film=film,
        excitation=excitation,
        conditions=conditions,
        effects=tuple(effects),
        strength=together,
        seed=int(rng.integers(2**31)),
    )


def _masked(effects: list[HiddenEffect], yardstick: Yardstick) -> bool:
    """Return whether one of two effects is too weak in the presence of the other."""
    conditions = yardstick.conditions()
    return any(
        yardstick.linear_strength(_laws(effects, conditions), _laws([other], conditions)) < WEAKEST
        for other in effects
        if len(effects) > 1
    )


def _laws(effects: list[HiddenEffect], conditions: Conditions) -> list[Law]:
    return [effect.law(conditions) for effect in effects]


def _sized(effect: EffectKind, yardstick: Yardstick, rng: Generator) -> HiddenEffect | None:
    """Return the effect at a size of the drawn strength, or None if no size is within limits."""
    target = float(np.exp(rng.uniform(np.log(WEAKEST), np.log(STRONGEST))))
    seed = int(rng.integers(2**31))
    conditions = yardstick.conditions()

    def laws(size: float) -> list[Any]:
        return [effect.build(size, conditions, np.random.default_rng(seed))]

    aim = target
    for _ in range(_CORRECTIONS):
        size = _search(lambda size: yardstick.linear_strength(laws(size)), effect, aim)
        strength = yardstick.strength(laws(size))
        if WEAKEST <= strength <= STRONGEST:
            return HiddenEffect(effect.name, size, seed, strength)
        if not 0.0 < strength < np.inf:
            return None
        # The full refit explains more than the linear step: aim higher.
        aim *= target / strength
    return None


def _search(strength: Any, effect: EffectKind, aim: float) -> float:
    """Return the size in the effect's range whose strength is nearest to ``aim``, by bisection."""
    low, high = np.log(effect.smallest), np.log(effect.largest)
    size = 0.5 * (low + high)
    for _ in range(_SEARCHES):
        size = 0.5 * (low + high)
        ratio = strength(np.exp(size)) / aim
        if 1.0 / _TOLERANCE < ratio < _TOLERANCE:
            break
        low, high = (size, high) if ratio < 1.0 else (low, size)
    return float(np.exp(size))


def _draw_excitation(rng: Generator) -> dict[str, Any]:
    """Draw the arguments of an excitation's design."""
    settings: dict[str, dict[str, float]] = {
        "gaussian": {"band": rng.uniform(0.5, 1.0)},
        "bursts": {
            "band": rng.uniform(0.5, 1.0),
            "active": rng.uniform(10.0, 25.0),
            "rest": rng.uniform(5.0, 12.0),
        },
        "multisine": {"band": rng.uniform(0.5, 1.0), "period": 2.0 * int(rng.integers(10, 21))},
        "staircase": {
            "hold": rng.uniform(2.0, 6.0),
            "rest": rng.uniform(2.0, 6.0),
            "rise": rng.uniform(0.2, 0.8),
        },
        "binary": {"band": rng.uniform(0.4, 1.0)},
        "triangle": {"slowest": rng.uniform(15.0, 25.0), "fastest": rng.uniform(2.0, 5.0)},
    }
    kind = str(rng.choice(list(settings)))
    return {
        "kind": kind,
        "duration": float(rng.integers(120, 241)),
        "sampling_rate": 1.0 / SAMPLE_PERIOD,
        "low": rng.uniform(0.2, 1.1),
        "high": rng.uniform(3.4, 3.75),
        "seed": int(rng.integers(2**31)),
        **settings[kind],
    }
