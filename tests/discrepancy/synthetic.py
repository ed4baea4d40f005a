"""A membrane written down independently of the package, with effects whose laws are others.

The film, the mass and the dashpot obey the same textbook equations as ``dea_membrane``, solved from
the energy on a fine grid and integrated by another method with a step of 1 ms; every effect has a
form the catalogue does not use.
"""

import numpy as np
import xarray as xr
from numba import njit
from scipy.optimize import brentq

DT = 1e-3
RATE = 50.0


VOLTS = np.sqrt(np.linspace(0.0, 4.3**2, 300))


def stiffnesses(p):
    """Return the vertical stiffness in N/m at VOLTS, from the free energy of the whole film.

    NaN from where the film pulls in.
    """
    c10, c20, c30, lp, er = p[2:7]
    a, b, contact, thick, gain = 0.0175, 0.04, 0.002, 5e-4, 800.0
    edges = np.geomspace(a, b, 301)
    radius = np.sqrt(edges[:-1] * edges[1:])
    volume = np.pi * np.diff(edges**2) * thick / lp**2
    disc = np.pi * a**2 * thick / lp**2

    def stretches(x):
        give = (x - 1.0) * a * a / (b * b - a * a)
        return lp * (1.0 - give * (1.0 + (b / radius) ** 2)), lp * (
            1.0 + give * ((b / radius) ** 2 - 1.0)
        )

    def density(s, t):
        strain = s**2 + t**2 + (s * t) ** -2.0 - 3.0
        return c10 * strain + c20 * strain**2 + c30 * strain**3

    def energy(x, volt):
        charged = 0.5 * 8.8541878128e-12 * er * (gain * volt / thick) ** 2 * (lp * x) ** 4
        return disc * (density(lp * x, lp * x) - charged) + volume @ density(*stretches(x))

    def slope(x, volt):
        return (energy(x + 1e-5, volt) - energy(x - 1e-5, volt)) / 2e-5

    found, x = np.full(VOLTS.size, np.nan), 1.0
    for k, volt in enumerate(VOLTS):
        if slope(x - 1e-3, volt) * slope(x + 0.05, volt) > 0.0:
            break
        x = brentq(slope, x - 1e-3, x + 0.05, args=(volt,), xtol=1e-10)
        s, t = stretches(x)
        force = (density(s + 1e-6, t) - density(s - 1e-6, t)) / 2e-6
        within = (density(lp * x + 1e-6, lp * x) - density(lp * x - 1e-6, lp * x)) / 2e-6
        field = 8.8541878128e-12 * er * (gain * volt * lp * x) ** 2 / thick
        compliance = np.log(a * x / contact) / (thick * within / (lp * x) - field)
        compliance += np.sum(np.diff(np.log(edges)) * s / lp / (t / lp * thick * force / t))
        found[k] = 2.0 * np.pi / compliance
    return found


@njit(cache=True)
def _membrane(
    volt, table, p, size, lag, stop, lugre, bouc, gent, wear, creep, weights, scale, force
):
    """Semi-implicit Euler; returns position (m) at each sub-step."""
    m, c = p[0], p[1]
    k0 = table[0]
    spacing = 4.3**2 / (table.size - 1)
    y, v, lag_v, bristle, z, travel = 6e-4, 0.0, volt[0], 0.0, 0.0, 0.0
    xi = np.full(weights.size, 6e-4)
    out = np.empty(volt.size)
    for i in range(volt.size):
        rc = lag * (1.0 + 150.0 * (y - 6e-4))
        if lag > 0:
            lag_v += (volt[i] - lag_v) * (1.0 - np.exp(-DT / rc))
        else:
            lag_v = volt[i]
        at = scale[i] * lag_v**2 / spacing
        node = min(int(at), table.size - 2)
        k = table[node] + (at - node) * (table[node + 1] - table[node])
        extra = force[i] * k0 * 3e-4
        if stop > 0:
            d = y - stop
            if d > 0:
                extra -= size * k0 * d**1.5 / 1e-2 + 0.1 * c * v
        if lugre > 0:
            g = 1.0 + 0.3 * np.exp(-((v / 2e-4) ** 2))
            sigma0 = 10.0 * k0
            fc = lugre * k0 * 3e-4
            bristle = (bristle + DT * v) / (1.0 + DT * sigma0 * abs(v) / (fc * g))
            extra -= sigma0 * bristle
        if bouc > 0:
            xm = 1.2e-4
            z += v * DT * (1.0 - (0.7 * np.sign(v) * z + 0.3 * abs(z)) / xm)
            extra -= bouc * k0 * z
        if gent != 0:
            extra -= k0 * y * gent * (np.exp((y / 8e-4) ** 2) - 1.0) * 0.2
        if wear > 0:
            travel += abs(v) * DT
            extra += k0 * y * wear * np.log(1.0 + travel / 4e-3) * 0.1
        for j in range(weights.size):
            extra -= creep * k0 * weights[j] * (y - xi[j])
            xi[j] += (y - xi[j]) * DT / (0.03 * 2.2**j)
        h = DT / 8
        for _ in range(8):
            v = (v + h * (9.81 + (extra - k * (y + 0.5 * h * v)) / m)) / (1.0 + h * c / m)
            y += h * v
        out[i] = y
    return out


def smooth_walk(rng, n, duration, cutoff):
    """A random walk without what is faster than ``cutoff`` (Hz), from zero to about one."""
    f = np.fft.rfftfreq(2 * n, duration / n)
    spectrum = np.zeros(f.size, complex)
    low = (f > 0) & (f < cutoff)
    spectrum[low] = (rng.normal(size=low.sum()) + 1j * rng.normal(size=low.sum())) / f[low]
    w = np.fft.irfft(spectrum)[:n]
    w -= w[0]
    return w / np.abs(w).max()


def excitation(kind, duration, rng):
    n = round(duration * RATE)
    t = np.arange(n) / RATE
    if kind == "noise":
        f = np.fft.rfftfreq(n, 1 / RATE)
        s = np.where((f > 0) & (f <= 1.0), 1.0, 0.0) * np.exp(2j * np.pi * rng.random(f.size))
        x = np.fft.irfft(s, n)
        return np.clip(2.42 + x / np.abs(x).max() * 1.6, 1.1, 3.75)
    if kind == "multisine":
        x = sum(
            np.sin(2 * np.pi * f * t + rng.random() * 6.28)
            for f in rng.choice(np.arange(1, 40), 12, replace=False) * 0.025
        )
        return 2.42 + x / np.abs(x).max() * 1.3
    if kind == "staircase":
        levels = rng.uniform(1.1, 3.75, n)
        return levels[(t // 4.0).astype(int)]
    levels = rng.choice([1.4, 3.4], n)
    return levels[(t // 1.0).astype(int)]


def record(effects=(), kind="noise", duration=160.0, seed=0, noise=1.5e-3):
    """Make a record; ``effects`` is a list of (name, size), size about one for a visible gap."""
    rng = np.random.default_rng(seed)
    sizes = dict(effects)
    deviation = np.exp(rng.normal(0, 1, 7) * np.array([0.05, 0.3, 0.04, 0.0, 0.0, 0.005, 0.03]))
    p = np.array([3.0e-3, 0.05, 3.5e4, -376.0, 3.28, 3.3, 3.5]) * deviation
    u = excitation(kind, duration, rng)
    n, sub = u.size, round(1 / (RATE * DT))
    lead = round(2.0 / DT)
    v = np.concatenate([np.full(lead, u[0]), np.repeat(u, sub)])
    t = (np.arange(v.size) - lead) * DT
    scale, force = np.ones(v.size), np.zeros(v.size)
    late = np.clip(t, 0, None)
    r = rng.random(4)
    if s := sizes.get("dead_zone"):
        u0 = 1.2 + 0.5 * s
        v = (
            v * (1 - np.exp(-((v / u0) ** 6)))
            if r[0] < 0.5
            else np.where(v > u0, v - 0.9 * u0 * (1 - (v - u0) / 4), 0.0)
        )
    if s := sizes.get("input_saturation"):
        top = 3.75 - 0.6 * s
        v = v / (1 + (v / top) ** 16) ** (1 / 16)
    if s := sizes.get("slew_limit"):
        limit = 1.5 / s
        w, now = v.copy(), v[0]
        for i in range(w.size):
            now += min(max(w[i] - now, -limit * DT), limit * DT)
            w[i] = now
        v = w
    if s := sizes.get("transport_delay"):
        shift = round(0.06 * s / DT)
        v = np.concatenate([np.full(shift, v[0]), v[: v.size - shift]])
    if s := sizes.get("charge_leakage"):
        q, w = 0.0, np.empty_like(v)
        for i in range(v.size):
            q += DT * (0.05 * s * np.sinh(v[i] / 2.0) / 3.2 * v[i] - q) / 6.0
            w[i] = v[i] - q
        v = w
    if s := sizes.get("gain_drift"):
        scale = 1 + 0.05 * s * (np.log1p(late / 20) if r[1] < 0.5 else -(1 - np.exp(-late / 60)))
    if s := sizes.get("step_fault"):
        scale = np.where(t > (0.1 + 0.75 * r[2]) * duration, 1 - 0.05 * s, 1.0)
    if s := sizes.get("warmth"):
        q = 0.0
        for i in range(v.size):
            q += DT * (v[i] ** 2 / 6.0 - q) / 12.0
            scale[i] = 1 + 0.15 * s * (q - 1.0) * v[i] / 3.0
    if s := sizes.get("drag"):
        force = np.zeros(v.size)
    weights = 2.2 ** (-0.25 * np.arange(13.0))
    x = _membrane(
        v, stiffnesses(p), p, 3.0, 0.05 * sizes.get("electrode_lag", 0.0),
        0.95e-3 - 0.05e-3 * sizes["end_stop"] if "end_stop" in sizes else 0.0,
        0.04 * sizes.get("coulomb_friction", 0.0),
        0.15 * sizes.get("rate_independent_hysteresis", 0.0),
        0.2 * sizes.get("strain_stiffening", 0.0), 0.1 * sizes.get("cyclic_softening", 0.0),
        0.03 * sizes.get("viscoelastic_creep", 0.0), weights, scale, force,
    ) * 1e3  # fmt: skip
    if s := sizes.get("second_mode"):
        a = b = 0.0
        w0 = 2 * np.pi * (1.0 + 4.0 * r[0])
        pull = (v**2 - v[0] ** 2) / 10.0
        extra = np.empty_like(x)
        for i in range(x.size):
            b += DT * (w0 * w0 * (pull[i] - a) - 2 * 0.04 * w0 * b)
            a += DT * b
            extra[i] = a
        x = x + 0.03 * s * extra
    if s := sizes.get("sensor_lag"):
        a1 = a2 = x[0]
        w = np.empty_like(x)
        for i in range(x.size):
            a1 += DT * (x[i] - a1) / (0.03 * s)
            a2 += DT * (a1 - a2) / (0.015 * s)
            w[i] = a2
        x = w
    if s := sizes.get("feedthrough"):
        x = x + 0.02 * s * np.gradient(np.convolve(v, np.ones(200) / 200, "same"), DT)
    y = x[lead::sub][:n].copy()
    tk = np.arange(n) / RATE
    low, high = y.min(), y.max()
    if s := sizes.get("output_saturation"):
        y = np.minimum(y, high - 0.12 * s * (high - low))
    if s := sizes.get("sensor_nonlinearity"):
        mid = (y - low) / (high - low)
        y = y + 0.02 * s * (np.sin(2 * np.pi * mid) + np.exp(mid)) * (high - low)
    if s := sizes.get("periodic_disturbance"):
        f = 0.3 + 6 * r[1]
        y = y + 0.006 * s * (np.sin(6.2832 * f * tk) + 0.4 * np.abs(np.sin(3.1416 * f * tk)))
    if s := sizes.get("baseline_drift"):
        y = y + 0.02 * s * (
            np.sqrt(tk / duration) if r[3] < 0.5 else smooth_walk(rng, n, duration, 3 / duration)
        )
    if s := sizes.get("backlash"):
        w, now = y.copy(), y[0]
        for i in range(n):
            now = min(max(now, y[i] - 0.03 * s), y[i] + 0.03 * s)
            w[i] = now + 0.02 * s * np.sin(40 * now)
        y = w
    if s := sizes.get("frozen"):
        for at in rng.integers(0, n - 60, 25):
            y[at : at + 40] = y[at]
    if s := sizes.get("burst"):
        for at in rng.integers(0, n - 60, 30):
            y[at : at + 30] += 0.02 * s * rng.normal() * np.hanning(30)
    if s := sizes.get("drag"):
        y = y + 0.01 * s * np.sign(np.gradient(y)) * (np.gradient(y) * 50) ** 2 * (
            2 * (y - low) / (high - low) - 1
        )
    y = y + rng.normal(0, noise, n)
    assert np.isfinite(y).all(), "the film pulls in within this record"
    return xr.Dataset(
        {
            "voltage": ("time", u, {"units": "V"}),
            "displacement": ("time", y, {"units": "mm"}),
        },
        coords={"time": ("time", tk, {"units": "s"})},
    )
