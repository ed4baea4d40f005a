"""Labels and verdicts as a campaign makes them, with made-up content."""

import numpy as np

from dea.trials import Label, Said

FAMILY = {
    "dead_zone": "threshold",
    "sensor_lag": "lag",
    "electrode_lag": "lag",
    "end_stop": "limit",
}
KINDS = ["gaussian", "staircase", "triangle"]


def label(*effects, outside=False, strength=10.0, excitation="gaussian", **more):
    return Label(frozenset(effects), outside, strength, excitation, **more)


def said(
    status, *effects, rivals=(), ranking=None, before=0.02, after=0.0016, floor=0.0015, **more
):
    """Return a verdict; its ranking holds, by default, the names given and then all others."""
    if ranking is None:
        others = [name for name in FAMILY if name not in effects]
        sets = ([frozenset(effects)] if effects else []) + [frozenset({name}) for name in others]
        ranking = tuple((names, floor * (1 + 0.5 * i)) for i, names in enumerate(sets))
    return Said(
        status, frozenset(effects), tuple(map(frozenset, rivals)), ranking, before, after, floor,
        **more,
    )  # fmt: skip


def campaign(trials, seed=0):
    """Return labels and verdicts of so many trials: half right, the rest anything."""
    rng = np.random.default_rng(seed)
    labels, verdicts = {}, {}
    hidden = [(name,) for name in FAMILY] + [("dead_zone", "end_stop"), (), ("sticking_sensor",)]
    for index in range(trials):
        effects = hidden[index % len(hidden)]
        name = f"{index:04d}"
        labels[name] = label(
            *effects,
            outside=effects == ("sticking_sensor",),
            strength=float(np.exp(rng.uniform(np.log(3), np.log(30)))),
            excitation=str(rng.choice(KINDS)),
            noise=str(rng.choice(["white", "drifting"])),
            forms={name: f"{name}_form" for name in effects},
        )
        floor = 0.0015
        before = floor * labels[name].strength
        if rng.random() < 0.5 and effects != ("sticking_sensor",):
            given, status = effects, "named" if effects else "none"
        else:
            status = str(rng.choice(["named", "ambiguous", "unknown", "none"]))
            given = (str(rng.choice(list(FAMILY))),) if status in ("named", "ambiguous") else ()
        rivals = (("sensor_lag",),) if status == "ambiguous" else ()
        after = floor * rng.uniform(1, 1.5) if given else before
        verdicts[name] = said(status, *given, rivals=rivals, before=before, after=after)
    return labels, verdicts
