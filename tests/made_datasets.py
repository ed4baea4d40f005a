"""Datasets shaped as docs/architecture.md says, with made-up content, to draw and print."""

from pathlib import Path

import numpy as np
import xarray as xr

from dea.narx.residuals import TESTS
from dea.store import CONTRACTS

TERMS = ["1", "y(t-1)", "y(t-2)", "u(t-1)", "u(t-2)", "u(t-1)^2", "y(t-1)u(t-3)^2"]
WINDOWS = ["100-130 s", "900-930 s", "1700-1730 s"]
MODELS, APPROACHES = (
    ["linear", "narx"],
    ["forecast", "fitted", "forecast, one-step", "fitted, one-step"],
)
TRACKERS = ["rls", "kalman", "output_error"]
RATE = 10.0


def checked(dataset: xr.Dataset, contract: str) -> xr.Dataset:
    CONTRACTS[contract].check(dataset, Path(f"{contract}.nc"))
    return dataset


def over(dims, values, units="1", name="a quantity"):
    return dims, np.asarray(values), {"units": units, "long_name": name}


def record(seed: int, duration: float = 1800.0) -> xr.Dataset:
    rng = np.random.default_rng(seed)
    t = np.arange(int(duration * RATE)) / RATE
    white = rng.standard_normal(t.size)
    slow = np.convolve(white, np.hanning(12), "same")
    u = 2.425 + 1.325 * np.tanh(slow / slow.std() / 1.5)
    y = 0.6 + 0.05 * u**2 * (1 + 0.2 * seed * t / 1800) + 0.2 * (-1) ** seed * t / 1800
    return record_of(u, y, RATE)


def record_of(u: np.ndarray, y: np.ndarray, rate: float) -> xr.Dataset:
    """Return a record of voltages (V) and displacements (mm), every sample of which is good."""
    t = np.arange(u.size) / rate
    return checked(
        xr.Dataset(
            {
                "voltage": over("time", u, "V", "voltage"),
                "displacement": over("time", y, "mm", "displacement"),
                "device_index": over("time", np.arange(t.size)),
                "quality": over("time", np.zeros(t.size, np.uint8)),
            },
            coords={"time": over("time", t, "s", "time")},
        ),
        "record",
    )


def orders(seed: int) -> xr.Dataset:
    n = np.arange(1, 6)
    kinds = {
        f"{order}_{criterion}": over(
            f"{order}_order", scale * (1 + seed) / n ** (1 + 0.3 * k), units, criterion
        )
        for k, order in enumerate(("dynamic", "polynomial"))
        for criterion, scale, units in (
            ("nmse", 0.3, "1"),
            ("fpe", 0.004, "mm^2"),
            ("terms", 60, "1"),
        )
    }
    coords = {f"{order}_order": over(f"{order}_order", n) for order in ("dynamic", "polynomial")}
    return checked(xr.Dataset(kinds, coords=coords), "orders")


def model(seed: int) -> xr.Dataset:
    rng = np.random.default_rng(seed)
    terms = [term for i, term in enumerate(TERMS) if i != 1 + seed % 6]
    theta = rng.standard_normal(len(terms))
    scalars = {
        name: over((), value, units)
        for name, value, units in (
            ("u_offset", 2.4, "V"), ("u_scale", 1.3, "V"),
            ("y_offset", 1.0, "mm"), ("y_scale", 0.2, "mm"),
        )
    }  # fmt: skip
    return checked(
        xr.Dataset(
            {
                "parameter": over("term", theta),
                "standard_error": over("term", np.abs(theta) * 0.013),
                "inclusion_frequency": over("term", rng.uniform(size=len(terms))),
                **scalars,
            },
            coords={"term": over("term", np.array(terms, dtype=object))},
            attrs={"stability": ["stable", "slow"][seed % 2]},
        ),
        "model",
    )


def common_model(names) -> xr.Dataset:
    rng = np.random.default_rng(0)
    per_term, per_model = ("system", "term"), ("structure", "system")
    size, pair = (len(names), len(TERMS)), (2, len(names))
    return checked(
        xr.Dataset(
            {
                "parameter": over(per_term, rng.standard_normal(size)),
                "standard_error": over(per_term, rng.uniform(0.001, 0.1, size)),
                "withheld": over("system", np.full(len(names), "")),
                "nmse": over(per_model, rng.uniform(1e-4, 1e-2, pair)),
                "terms": over(per_model, np.full(pair, len(TERMS))),
                "stability": over(per_model, np.full(pair, "stable")),
            },
            coords={
                "system": over("system", np.array(names)),
                "term": over("term", np.array(TERMS)),
                "structure": over("structure", np.array(["own", "common"])),
            },
        ),
        "common_model",
    )


def validation(seed: int) -> xr.Dataset:
    rng = np.random.default_rng(seed)
    n, lags = int(30 * RATE), np.arange(-25, 26)
    t = np.array([100.0, 900.0, 1700.0])[:, None] + np.arange(n) / RATE
    u = 2.4 + np.sin(2 * np.pi * 0.3 * t) + 0.3 * np.sin(2 * np.pi * 0.71 * t)
    y = 1 + 0.08 * u**2
    shape = (len(MODELS), len(APPROACHES), len(WINDOWS))
    error = np.array([[0.12, 0.08, 0.13, 0.09], [0.04, 0.01, 0.05, 0.02]])[:, :, None, None]
    simulated = y + error * np.sin(2 * np.pi * 0.9 * t)
    sse = ((simulated - y) ** 2).sum(-1)
    nmse = sse / ((y - y.mean(-1, keepdims=True)) ** 2).sum(-1)
    return checked(
        xr.Dataset(
            {
                "time": over(("window", "sample"), t, "s", "time"),
                "input": over(("window", "sample"), u, "V", "voltage"),
                "measured": over(("window", "sample"), y, "mm", "displacement"),
                "simulated": over(("model", "approach", "window", "sample"), simulated, "mm"),
                "nmse": over(("model", "approach", "window"), nmse),
                "fit": over(("model", "approach", "window"), 1 - nmse),
                "fpe": over(("model", "approach", "window"), sse / n * 1.01, "mm^2"),
                "rmse": over(("model", "approach", "window"), np.sqrt(sse / n), "mm"),
                "correlation": over(
                    ("model", "approach", "window", "test", "lag"),
                    0.05 * rng.standard_normal((*shape, len(TESTS), lags.size)),
                ),
                "tested_correlation": over(
                    ("model", "approach", "window", "test", "lag"),
                    0.05 * rng.standard_normal((*shape, len(TESTS), lags.size)),
                ),
                "band": over("test", np.full(len(TESTS), 1.96 / np.sqrt(n))),
                "p_value": over(
                    ("model", "approach", "window", "test"), rng.random((*shape, len(TESTS)))
                ),
                "explained": over(
                    ("model", "approach", "window", "test"), 0.1 * rng.random((*shape, len(TESTS)))
                ),
                "verdict": over("model", [f"The residual is {seed} mm." for _ in MODELS]),
            },
            coords={
                "model": MODELS, "approach": APPROACHES, "window": WINDOWS, "test": list(TESTS),
                "lag": over("lag", lags, "sample"),
            },
        ),
        "validation",
    )  # fmt: skip


def track(seed: int) -> xr.Dataset:
    rng = np.random.default_rng(seed)
    found, whole = model(seed), record(seed)
    t = whole["time"].values[::5]
    y = whole["displacement"].values[::5]
    drift = 1 + 0.1 * np.sin(t / 300 + np.array([0.0, 0.1, 0.2])[:, None])[:, :, None]
    theta = found["parameter"].values * drift
    spread = np.array([0.3, 0.02, 0.03, 0.01])[:, None]
    return checked(
        xr.Dataset(
            {
                "parameter": over(("tracker", "time", "term"), theta),
                "parameter_std": over(("tracker", "time", "term"), np.full_like(theta, 0.03)),
                "covariance": over(
                    ("tracker", "instant", "term", "term_2"),
                    np.broadcast_to(9e-4 * np.eye(found["term"].size),
                                    (3, t[::40].size, found["term"].size, found["term"].size)),
                ),
                "band_low": over(("tracker", "instant", "term"), theta[:, ::40] - 0.06),
                "band_high": over(("tracker", "instant", "term"), theta[:, ::40] + 0.06),
                "estimator": over("tracker", np.array(TRACKERS, dtype=object)),
                "withheld": over("tracker", np.array(["", "", ""], dtype=object)),
                "innovation": over(("tracker", "time"), rng.standard_normal((3, t.size)), "mm"),
                "simulated": over(("simulation", "time"), y + spread * np.sin(t), "mm"),
                "simulated_low": over(("simulation", "time"), y + spread * np.sin(t) - 0.01, "mm"),
                "simulated_high": over(("simulation", "time"), y + spread * np.sin(t) + 0.01, "mm"),
                "nmse": over("simulation", [0.4, 0.02, 0.01, 0.005]),
                "rmse": over("simulation", [0.2, 0.02, 0.01, 0.007], "mm"),
            },
            coords={
                "time": over("time", t, "s"), "term": found["term"],
                "instant": over("instant", t[::40], "s"),
                "tracker": TRACKERS, "simulation": ["fixed", *TRACKERS],
            },
        ),
        "track",
    )  # fmt: skip


def gfrf(seed: int) -> xr.Dataset:
    t, f = np.linspace(0, 1800, 181), np.geomspace(0.02, 10, 60)
    t2, f2 = np.array([300.0, 900.0, 1500.0]), np.linspace(0.05, 2.0, 40)
    gain = 0.1 * (1 + 0.3 * seed * t / 1800)
    h1 = gain[:, None] / (1 + 1j * f / 0.8)
    low_pass = 1 / (1 + 1j * f2 / 0.8)
    h2 = (1 + t2 / 1800)[:, None, None] * 0.02 * low_pass[:, None] * low_pass
    h3 = 0.1 * h2 / (1 + 0.5j / 0.8)
    spectrum = 1e-2 / (1 + (f / 1.0) ** 12)

    def parts(values):
        return np.stack([values.real, values.imag], axis=-1)

    def ends(prefix, dims, response, units):
        """Bands of 3 % and 2 degrees."""
        gain, phase = np.abs(response), np.degrees(np.angle(response))
        return {
            f"{prefix}gain_low": over(dims, 0.97 * gain, units),
            f"{prefix}gain_high": over(dims, 1.03 * gain, units),
            f"{prefix}phase_low": over(dims, phase - 2.0, "degree"),
            f"{prefix}phase_high": over(dims, phase + 2.0, "degree"),
        }

    return checked(
        xr.Dataset(
            {
                "H1": over(("time", "frequency", "part"), parts(h1), "mm/V"),
                "H2": over(("time_h2", "frequency_1", "frequency_2", "part"), parts(h2), "mm/V^2"),
                "H3": over(("time_h2", "frequency_1", "frequency_2", "part"), parts(h3), "mm/V^3"),
                **ends("", ("time", "frequency"), h1, "mm/V"),
                "model_error_gain": over("frequency", np.full(f.size, 0.002)),
                "model_error_phase": over("frequency", np.full(f.size, 0.1), "degree"),
                "H2_model_error_gain": over("frequency", np.full(f.size, 0.01)),
                "H2_model_error_phase": over("frequency", np.full(f.size, 0.5), "degree"),
                **ends("H2_", ("time_h2", "frequency_1", "frequency_2"), h2, "mm/V^2"),
                "y0": over("time", 1 + 0.1 * t / 1800, "mm"),
                "y0_low": over("time", 0.99 + 0.1 * t / 1800, "mm"),
                "y0_high": over("time", 1.01 + 0.1 * t / 1800, "mm"),
                "input_spectrum": over("frequency", spectrum, "V^2/Hz"),
                "excited": over("frequency", (f <= 1.0).astype(np.int8)),
                "excited_h2": over(
                    ("frequency_1", "frequency_2"),
                    ((f2[:, None] <= 1.0) & (f2 <= 1.0)).astype(np.int8),
                ),
            },
            coords={
                "time": over("time", t, "s"), "frequency": over("frequency", f, "Hz"),
                "time_h2": over("time_h2", t2, "s"),
                "frequency_1": over("frequency_1", f2, "Hz"),
                "frequency_2": over("frequency_2", f2, "Hz"),
                "frequency_3": over((), 0.5, "Hz"),
                "part": ["real", "imag"],
            },
            attrs={"tracker": "output_error", "estimator": "output_error", "withheld": ""},
        ),
        "gfrf",
    )  # fmt: skip


def gfrf_of_inputs(names=("left", "right")) -> xr.Dataset:
    """Responses of a system with inputs in V and %, those of each input and pair as of a seed."""
    pairs = [f"{a} × {b}" for k, a in enumerate(names) for b in names[k:]]
    each = [gfrf(seed) for seed in range(1, len(pairs) + 1)]
    of_pairs = [n for n in each[0].data_vars if n.startswith("H2") or n == "excited_h2"]
    at_rest = ["y0", "y0_low", "y0_high"]
    of_inputs = [n for n in each[0].data_vars if n not in (*of_pairs, *at_rest)]
    parts = [
        xr.concat([one[of_inputs] for one in each[: len(names)]], "input", data_vars="all"),
        xr.concat([one[of_pairs] for one in each], "pair", data_vars="all"),
        each[0][at_rest],
    ]
    found = xr.merge(parts, compat="override").assign_coords(input=list(names), pair=pairs)
    for name in ("H1", "gain_low", "gain_high"):
        found[name].attrs["units"] = "mm/V, mm/%"
    for name in ("H2", "H2_gain_low", "H2_gain_high"):
        found[name].attrs["units"] = "mm/V^2, mm/(V %), mm/%^2"
    found["input_spectrum"].attrs["units"] = "V^2/Hz, %^2/Hz"
    return checked(found.assign_attrs(each[0].attrs), "gfrf")


def link(seed: int, *, polled: bool = False) -> xr.Dataset:
    rng = np.random.default_rng(seed)
    n = 900
    trip = 1e-3 * rng.lognormal(0.1 * seed, 0.4, n)
    send = np.cumsum(trip + 1e-3)
    edges = np.geomspace(1e-5, 10.0, 61)
    return checked(
        xr.Dataset(
            {
                "send_time": over("exchange", send, "s"),
                "receive_time": over("exchange", send + trip, "s"),
                "samples": over("exchange", np.full(n, 100)),
                "retries": over("exchange", rng.random(n) < 0.01),
                "round_trip_count": over("round_trip_bin", np.histogram(trip, edges)[0]),
                "round_trip_low": over("round_trip_bin", edges[:-1], "s"),
                "round_trip_high": over("round_trip_bin", edges[1:], "s"),
                "jitter": over(
                    "polled_sample", rng.exponential(6e-4, 3000) if polled else np.empty(0), "s"
                ),
                "errors": over("kind", [seed, 2]),
                "error_kind": over("kind", np.array(["no reply", "short reply"], dtype=object)),
                "reconnects": over((), seed),
            }
        ),
        "link",
    )


NAMES = [f"dea{i}" for i in range(1, 7)]


def recovery(seed: int) -> xr.Dataset:
    rng = np.random.default_rng(seed)
    dims, shape = ("plant", "excitation", "search"), (6, 2, 2)
    errors = {name: over(dims, 10 ** rng.uniform(-7, 0, shape)) for name in
              ("nmse", "h1_error", "h2_error")}  # fmt: skip
    errors["h2_error"][1][0, 0, 0] = np.inf
    return xr.Dataset(
        {
            **errors,
            "terms_common": over(dims, rng.integers(0, 10, shape)),
            "terms_foreign": over(dims, rng.integers(0, 4, shape)),
            "stability": over(dims, np.full(shape, "stable")),
        },
        coords={
            "plant": [f"DEA{i}" for i in range(1, 7)],
            "excitation": ["coloured", "white"],
            "search": ["forward", "refined"],
            "plant_terms": over("plant", np.full(6, 10)),
        },
    )


def forecast(seed: int) -> xr.Dataset:
    rng = np.random.default_rng(seed)
    error = 0.01 * rng.random((5, 3, 4)) * np.arange(1, 6)[:, None, None]
    return checked(
        xr.Dataset(
            {
                "error": over(("forecaster", "horizon", "origin"), error, "mm"),
                "rmse": over(("forecaster", "horizon"), np.sqrt((error**2).mean(-1)), "mm"),
            },
            coords={
                "forecaster": ["narx", "linear", "hammerstein", "cubic", "last value"],
                "horizon": over("horizon", [1.0, 10.0, 60.0], "s"),
                "origin": over("origin", [120.0, 180.0, 240.0, 300.0], "s"),
            },
        ),
        "forecast",
    )


def confirmation(seed: int) -> xr.Dataset:
    """Three stretches, five lines of which three are in the band, three even lines."""
    f = np.array([0.05, 0.5, 1.0, 5.0, 20.0])
    gain = 0.1 * (1 + 0.1 * seed) / (1 + 1j * f / 2) * np.ones((3, 1))
    difference = np.tile([0.01, -0.1, 0.02, -0.5, -0.8], (3, 1))
    inside = np.tile([1, 0, 1, 0, 0], (3, 1)).astype(np.int8)
    measured = gain * (1 + difference)
    at_lines, at_even = ("stretch", "frequency"), ("stretch", "even_frequency")
    size, turn = np.abs(measured), np.degrees(np.angle(measured))
    modelled, angle = np.abs(gain), np.degrees(np.angle(gain))

    detection = ("stretch", "detection_frequency")

    def parts(values):
        return np.stack([values.real, values.imag], axis=-1)

    plain = {
        "gain_low": (0.98 * size, "mm/V"), "gain_high": (1.02 * size, "mm/V"),
        "phase_low": (turn - 1, "degree"), "phase_high": (turn + 1, "degree"),
        "response_noise": (0.005 * size, "mm/V"), "response_std": (0.01 * size, "mm/V"),
        "distortion": (0.01 * size, "mm/V"), "model_gain_low": (0.99 * modelled, "mm/V"),
        "model_gain_high": (1.01 * modelled, "mm/V"), "model_phase_low": (angle - 1, "degree"),
        "model_phase_high": (angle + 1, "degree"), "gain_difference": (difference, "1"),
        "phase_difference": (turn - angle, "degree"), "gain_band": (0.03 + 0 * size, "1"),
        "phase_band": (1.5 + 0 * size, "degree"), "inside": (inside, "1"),
        "excited_level": (0.01 + 0 * size, "mm"),
    }  # fmt: skip
    return checked(
        xr.Dataset(
            {
                "response": over((*at_lines, "part"), parts(measured), "mm/V"),
                "model": over((*at_lines, "part"), parts(gain), "mm/V"),
                "in_band": over("frequency", (f <= 1.0).astype(np.int8)),
                "output_level": over(detection, np.full((3, 4), 1e-4), "mm"),
                "output_noise": over(detection, np.full((3, 4), 3e-5), "mm"),
                "odd": over("detection_frequency", [0, 1, 0, 0]),
                **{name: over(at_lines, *values) for name, values in plain.items()},
                "ratio": over((*at_even, "part"), parts(np.full((3, 3), 1.05 + 0.1j))),
                "even_measured": over(at_even, np.full((3, 3), 1.05e-4), "mm"),
                "even_predicted": over(at_even, np.full((3, 3), 1e-4), "mm"),
                "even_noise": over(at_even, np.full((3, 3), 3e-5), "mm"),
                "even_in_band": over(at_even, np.tile([0.99, 0.95, 0.5], (3, 1))),
                "even_judged": over(at_even, np.tile([1, 1, 0], (3, 1)).astype(np.int8)),
                "even_inside": over(at_even, np.tile([1, 0, 0], (3, 1)).astype(np.int8)),
                "ratio_radius": over(at_even, np.full((3, 3), 0.2)),
            },
            coords={
                "time": over("stretch", [300.0, 1000.0, 1700.0], "s"),
                "frequency": over("frequency", f, "Hz"),
                "detection_frequency": over("detection_frequency", [0.1, 0.15, 0.2, 0.3], "Hz"),
                "even_frequency": over("even_frequency", [0.1, 0.2, 0.3], "Hz"),
                "part": ["real", "imag"],
            },
            attrs={"tracker": "local", "estimator": "local", "model_band_withheld": ""},
        ),
        "confirmation",
    )  # fmt: skip


def control(seed: int) -> xr.Dataset:
    """Two controllers that followed a sine for two minutes; the second was stopped."""
    rng = np.random.default_rng(seed)
    time = np.arange(6000) / 50.0
    reference = 1.0 + 0.2 * np.sin(np.pi * time)
    measured = reference + np.array([[0.002], [np.nan]]) * rng.standard_normal((2, time.size))
    pieces = (measured - reference).reshape(2, 2, 3000)
    each = ("controller", "time")
    return checked(
        xr.Dataset(
            {
                "reference": over("time", reference, "mm"),
                "measured": over(each, measured, "mm"),
                "voltage": over(each, 2.5 + 0.5 * (measured - 1.0), "V"),
                "quality": over(each, np.zeros((2, time.size), np.uint8)),
                "rms_error": over(
                    ("controller", "minute"), np.sqrt(np.mean(pieces**2, axis=2)), "mm"
                ),
                "stroke": over((), 0.4, "mm"),
                "outcome": over("controller", np.array(["to the end", "it hung"], dtype=object)),
                "fallbacks": over("controller", np.array([1, 0])),
                "proportional": over("controller", np.array([0.5, np.nan])),
                "integral_time": over("controller", np.array([0.1, np.nan]), "s"),
                "inverse_error": over("controller", np.full(2, np.nan), "mm"),
                "effects": over("controller", np.array(["", "dead_time"], dtype=object)),
            },
            coords={
                "controller": ("controller", np.array(["adaptive inverse", "PI"], dtype=object)),
                "minute": over("minute", np.array([1, 2])),
                "time": over("time", time, "s", "time"),
            },
            attrs={"sampling_rate": 50.0},
        ),
        "control",
    )
