"""Drawing blind trials: sizes and strengths of effects, the device, its excitation and noise."""

from collections.abc import Callable
from functools import cache
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
from numpy.random import Generator

from dea.excitation import design
from dea.plant.film import SUBSTEP
from dea.plant.hidden.catalogue import EFFECTS
from dea.plant.hidden.devices import DEVICES, DeviceKind
from dea.plant.hidden.effect import Conditions, EffectKind, Form, Law, Use
from dea.plant.hidden.noise import Noise, NoiseKind
from dea.plant.hidden.refit import Yardstick
from dea.plant.hidden.schedule import Plan, ambiguous_plans, plans, replanned
from dea.plant.hidden.trial import HiddenEffect, Trial
from dea.seeds import generator

WEAKEST, STRONGEST = 3.0, 30.0  # RMS residual of the refitted plain device over RMS noise
FEWEST, MOST = 1_000, 18_000  # samples of a record
_SEARCHES, _TOLERANCE = 9, 1.15
_CORRECTIONS = 3
_PATIENCE = 4  # attempts until form and device are drawn anew


@cache
def _plan(seed: int, index: int, use: Use, ambiguous: bool) -> Plan:
    planned = ambiguous_plans if ambiguous else plans
    return planned(seed, index + 1, use)[index]


def draw(bench: Path, seed: int, index: int, use: Use, *, ambiguous: bool = False) -> Trial:
    """Draw trial ``index`` of the campaign with ``seed`` for the bench configuration ``bench``.

    Each effect by itself is sized for a strength drawn between 3 and 30 on a logarithmic scale.
    Where an effect does not reach its strength on the drawn device under the drawn excitation, or
    one of two hides the other, device and excitation are drawn again, and after four times the
    form and the kind of device too. ``ambiguous`` trials hide
    what a single record may leave open.
    """
    plan = _plan(seed, index, use, ambiguous)
    rng = generator(seed, "trials", use, "ambiguous" if ambiguous else "plain", str(index))
    for attempt in count(1):
        trial = _attempt(bench, f"{index:04d}", plan, rng, ambiguous)
        if trial is not None:
            return trial
        if attempt % _PATIENCE == 0 and not ambiguous:
            plan = replanned(rng, plan, use)
    raise AssertionError("unreachable")


def _attempt(bench: Path, name: str, plan: Plan, rng: Generator, ambiguous: bool) -> Trial | None:
    kind = DEVICES[plan.device]
    factors = {
        key: float(np.exp(spread * rng.uniform(-1.0, 1.0))) for key, spread in kind.spread.items()
    }
    plain = kind.plain(bench, factors)
    excitation = _served(rng, kind) if ambiguous else draw_excitation(rng, kind)
    commands = design(**excitation)
    noise = _draw_noise(rng, plan.noise, kind, excitation["sampling_rate"])
    yardstick = Yardstick(kind, plain, commands, excitation["sampling_rate"], noise.rms)
    conditions = yardstick.conditions()
    effects: list[HiddenEffect] = []
    for effect, form in plan.hidden:
        found = _sized(EFFECTS[effect], EFFECTS[effect].form(form), yardstick, conditions, rng)
        if found is None:
            return None
        effects.append(found)
    if len(effects) > 1 and _masked(effects, yardstick, conditions):
        return None
    together = yardstick.strength(_laws(effects, conditions)) if effects else 0.0
    if not np.isfinite(together):
        return None
    return Trial(
        name=name,
        device=kind.name,
        factors=factors,
        excitation=excitation,
        conditions=conditions,
        effects=tuple(effects),
        strength=together,
        noise=noise,
        seed=int(rng.integers(2**31)),
    )


def _masked(effects: list[HiddenEffect], yardstick: Yardstick, conditions: Conditions) -> bool:
    """Return whether one of two effects is too weak in the presence of the other."""
    return any(
        yardstick.linear_strength(_laws(effects, conditions), _laws([other], conditions)) < WEAKEST
        for other in effects
    )


def _laws(effects: list[HiddenEffect], conditions: Conditions) -> list[Law]:
    return [effect.build(conditions).law for effect in effects]


def _sized(
    effect: EffectKind, form: Form, yardstick: Yardstick, conditions: Conditions, rng: Generator
) -> HiddenEffect | None:
    """Return the effect at a size of the drawn strength, or None if no size is within limits."""
    target = float(np.exp(rng.uniform(np.log(WEAKEST), np.log(STRONGEST))))
    seed = int(rng.integers(2**31))

    def laws(size: float) -> list[Law]:
        return [form.build(size, conditions, np.random.default_rng(seed)).law]

    aim = target
    for _ in range(_CORRECTIONS):
        size = _search(lambda size: yardstick.linear_strength(laws(size)), effect, aim)
        strength = yardstick.strength(laws(size))
        if WEAKEST <= strength <= STRONGEST:
            return HiddenEffect(effect.name, form.name, size, seed, strength)
        if not 0.0 < strength < np.inf:
            return None
        # The full refit explains more than the linear step: aim higher.
        aim *= target / strength
    return None


def _search(strength: Callable[[float], float], effect: EffectKind, aim: float) -> float:
    """Return the size in the effect's range whose strength is nearest to ``aim``.

    The strength is nearly a power of the size: secants of the logarithms, kept in the bracket.
    """
    low, high = float(np.log(effect.smallest)), float(np.log(effect.largest))
    size, last = 0.5 * (low + high), None
    for _ in range(_SEARCHES):
        found = strength(float(np.exp(size)))
        error = np.log(found / aim) if 0.0 < found < np.inf else np.inf
        if abs(error) < np.log(_TOLERANCE) or high - low < 0.02:
            break
        low, high = (size, high) if error < 0.0 else (low, size)
        slope = 1.0
        if last is not None and np.isfinite([error, last[1]]).all() and size != last[0]:
            slope = min(max((error - last[1]) / (size - last[0]), 0.3), 4.0)
        last = size, error
        ahead = size - error / slope
        inside = low + 0.05 * (high - low) < ahead < high - 0.05 * (high - low)
        size = float(ahead) if inside else 0.5 * (low + high)
    return float(np.exp(size))


def _draw_noise(rng: Generator, kind: NoiseKind, device: DeviceKind, rate: float) -> Noise:
    rms = float(np.exp(rng.uniform(*np.log(device.noise))))
    period = round(1.0 / (rate * SUBSTEP))
    correlation, shift = 0.0, 0
    if kind is NoiseKind.COLOURED:
        correlation = float(np.exp(rng.uniform(np.log(2.0), np.log(15.0))))
    elif kind is NoiseKind.DRIFTING:
        correlation = float(np.exp(rng.uniform(np.log(200.0), np.log(2000.0))))
    elif kind is NoiseKind.SHIFTED:
        # From a third of a sample to nearly a whole one, early or late.
        shift = round(period * rng.uniform(0.3, 1.0))
        shift = min(max(shift, 1), period - 1) * int(rng.choice([-1, 1]))
    return Noise(kind, rms, correlation, shift)


def _served(rng: Generator, device: DeviceKind) -> dict[str, Any]:
    """Draw an excitation that leaves rivals open: one amplitude and no rests, a minute or two."""
    return {
        "kind": "gaussian",
        "band": rng.uniform(0.5, 1.0) / device.time,
        "duration": float(rng.integers(60, 121)),
        "sampling_rate": 50.0,
        "low": rng.uniform(*device.lows),
        "high": rng.uniform(*device.highs),
        "seed": int(rng.integers(2**31)),
    }


def draw_excitation(rng: Generator, device: DeviceKind) -> dict[str, Any]:
    """Draw the arguments of an excitation's design, its band in proportion to the device's."""
    unit = device.time
    settings: dict[str, dict[str, float]] = {
        "gaussian": {"band": rng.uniform(0.5, 1.0) / unit},
        "bursts": {
            "band": rng.uniform(0.5, 1.0) / unit,
            "active": rng.uniform(6.0, 20.0) * unit,
            "rest": rng.uniform(3.0, 10.0) * unit,
        },
        "multisine": {
            "band": rng.uniform(0.5, 1.0) / unit,
            "period": float(rng.integers(5, 16)) * unit,
        },
        "staircase": {
            "hold": rng.uniform(2.0, 5.0) * unit,
            "rest": rng.uniform(2.0, 5.0) * unit,
            "rise": rng.uniform(0.2, 0.8) * unit,
        },
        "binary": {"band": rng.uniform(0.4, 1.0) / unit},
        "triangle": {
            "slowest": rng.uniform(8.0, 18.0) * unit,
            "fastest": rng.uniform(2.0, 5.0) * unit,
        },
    }
    kind = str(rng.choice(list(settings)))
    rate, duration = _draw_length(rng, device)
    return {
        "kind": kind,
        "duration": duration,
        "sampling_rate": rate,
        "low": rng.uniform(*device.lows),
        "high": rng.uniform(*device.highs),
        "seed": int(rng.integers(2**31)),
        **settings[kind],
    }


def _draw_length(rng: Generator, device: DeviceKind) -> tuple[float, float]:
    """Return rate and duration, log-uniform among those that give a usual number of samples."""
    while True:
        rate = float(rng.choice(device.rates))
        duration = float(round(np.exp(rng.uniform(*np.log(device.durations)))))
        if FEWEST <= rate * duration <= MOST and duration >= 20.0 * device.time:
            return rate, duration
