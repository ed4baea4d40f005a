"""A model with known responses, probed: measured lines are those of its own GFRFs."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from dea import store
from dea.errors import InputError
from dea.gfrf import frequency_response
from dea.narx import NarxModel
from dea.nonparametric import (
    Modelled,
    RelativeBand,
    best_linear,
    best_linear_approximation,
    compare_response,
    confirmation,
    estimates,
    intermodulation,
    periods_of,
)
from dea.probing import Probing

RATE = 10.0
PLANT = NarxModel.from_terms(
    {"y(t-1)": 0.7, "u(t-1)": 0.2, "u(t-2)": 0.1, "u(t-1)^2": 0.15, "y(t-1)u(t-2)": 0.1}
)
PROBING = Probing(
    times=[10.0, 130.0], bias=0.3, rms=0.02, lowest=0.1, highest=4.0, band=1.0, realisations=4,
    periods=2, settle=5.0,
)  # fmt: skip


def variable(values, units="1"):
    return "time", values, {"units": units, "long_name": "a quantity"}


def probed_record(probing):
    """A record of PLANT with stretches of multisines, whose period is 10 s."""
    rng = np.random.default_rng(0)
    probed = probing.place(0.3 + 0.1 * rng.standard_normal(2400), RATE, seed=5)
    y = PLANT.simulate(probed.voltage) + 1e-5 * rng.standard_normal(2400)
    return xr.Dataset(
        {
            "input": variable(probed.voltage, "V"),
            "output": variable(y, "mm"),
            "probing": variable(probed.probing),
            "realisation": variable(probed.realisation),
        },
        coords={"time": variable(np.arange(2400) / RATE, "s")},
        attrs={"probing_period": 10.0, "contract": "imported_record"},
    )


@pytest.fixture(scope="module")
def record():
    return probed_record(PROBING)


@pytest.fixture(scope="module")
def found(record):
    return [best_linear(stretch, 1) for stretch in periods_of(record, 10.0)]


def responses(lines, period=10.0):
    f = lines / period
    pairs = np.concatenate([-f[::-1], f])
    H1 = frequency_response(PLANT, 1, f, RATE, operating_point=0.3)
    return H1, frequency_response(
        PLANT, 2, (pairs[:, None], pairs[None, :]), RATE, operating_point=0.3
    )


def test_the_response_is_the_models_h1_and_even_lines_are_its_h2(found):
    for each in found:
        H1, H2 = responses(each.lines)
        # Odd orders above the first add a few parts in ten thousand, which noise does not hide.
        np.testing.assert_allclose(each.response, H1, rtol=2e-3)
        even = intermodulation(each, H2, 10)
        assert (even.lines % 2 == 0).all()
        strong = np.abs(even.predicted).max(axis=0) > 3e-5
        assert strong.sum() >= 5
        np.testing.assert_allclose(even.ratio[strong], 1.0, atol=0.1)
        # A response of twice the size is refused at the lines that stand out of the noise.
        wrong = intermodulation(each, 2 * H2, 10)
        np.testing.assert_allclose(wrong.ratio, 0.5 * even.ratio)
        assert (np.abs(wrong.ratio - 1) > wrong.radius)[strong].all()


def test_no_line_is_looked_for_beyond_half_the_sampling_rate(found):
    """Sums of two lines in a band up to half the harmonics reach beyond the last one."""
    each = found[0]
    last = each.output.shape[1] - 1
    short = each._replace(
        lines=each.lines[each.lines <= last // 2 + 2], output=each.output[:, : last // 2 + 3]
    )
    _, H2 = responses(short.lines)
    assert intermodulation(short, H2, last // 2 + 2).lines.max() <= last // 2 + 2


def pairs(found, H2, realisation, line, highest=10):
    """Return what all pairs of lines put at a line, and those of them beyond the band."""
    signed = [*-found.lines[::-1], *found.lines]
    of = {k: found.input[realisation, abs(k)] for k in signed}
    spectrum = {k: value.conjugate() if k < 0 else value for k, value in of.items()}
    total = outside = 0.0
    for i, first in enumerate(signed):
        for j, second in enumerate(signed):
            if first + second == line:
                part = H2[i, j] * spectrum[first] * spectrum[second]
                total += part
                outside += part * (max(abs(first), abs(second)) > highest)
    return total, outside


def test_a_response_without_a_second_order_predicts_no_even_line(found):
    _, H2 = responses(found[0].lines)
    even = intermodulation(found[0], 0.0 * H2, 10)
    assert np.isnan(even.ratio).all()
    assert np.isnan(even.in_band).all()


def test_predicted_even_lines_are_the_sums_over_all_pairs(found):
    each = found[0]
    _, H2 = responses(each.lines)
    even = intermodulation(each, H2, 10)
    for at, line in enumerate(even.lines):
        outside, whole = 0.0, np.sum(np.abs(even.predicted[:, at]) ** 2)
        for realisation in range(each.realisations):
            total, foreign = pairs(each, H2, realisation, line)
            assert even.predicted[realisation, at] == pytest.approx(total)
            outside += abs(foreign) ** 2
        assert even.in_band[at] == pytest.approx(1 - outside / whole)


def test_the_joint_region_holds_95_percent_of_agreeing_lines():
    rng = np.random.default_rng(2)
    lines = 20_000
    true = np.exp(1j * rng.uniform(0, 6, lines))
    deviation = 0.01 * (rng.standard_normal(lines) + 1j * rng.standard_normal(lines))
    modelled = true * (1 + 0.02 * rng.standard_normal(lines)) * np.exp(
        0.005j * rng.standard_normal(lines)
    )  # fmt: skip

    class Known:
        """An approximation whose variance is known and not estimated."""

        response = true + deviation

        def half_width(self):
            return np.full(lines, 1.96 * 0.01)

    band = RelativeBand(np.full(lines, 1.96 * 0.02), np.full(lines, 1.96 * 0.005))
    found = compare_response(Known(), modelled, band)
    assert found.inside.mean() == pytest.approx(0.95, abs=0.006)
    shifted = compare_response(Known(), 1.2 * modelled, band)
    assert shifted.inside.mean() < 0.01
    assert np.median(shifted.gain) == pytest.approx(1 / 1.2 - 1, abs=2e-3)


@pytest.mark.parametrize("drift", [-1, 1.5, "no"])
def test_a_drift_that_is_no_order_is_refused(record, drift):
    with pytest.raises(InputError, match=f"drift: it is {drift!r}. Give the order of a polynomial"):
        best_linear_approximation(record, drift=drift)


def test_the_dataset_holds_what_was_estimated(record, found, tmp_path):
    made = estimates(record, drift=1)
    measured = made.dataset
    xr.testing.assert_identical(measured, best_linear_approximation(record, drift=1))
    for each, same in zip(made.found, found, strict=True):
        np.testing.assert_array_equal(each.response, same.response)
    assert measured.sizes["stretch"] == 2
    np.testing.assert_allclose(measured["frequency"], found[0].lines / 10.0)
    response = measured["response"].values[..., 0] + 1j * measured["response"].values[..., 1]
    np.testing.assert_allclose(response[1], found[1].response)
    np.testing.assert_allclose(measured["response_std"][0], np.sqrt(found[0].total))
    linear = np.abs(found[0].response * found[0].input[:, found[0].lines])
    level = np.sqrt(np.mean(linear**2, axis=0))
    np.testing.assert_allclose(measured["excited_level"][0], level, rtol=1e-2)
    assert measured["excited_level"].attrs["units"] == "mm"
    width = measured["gain_high"] - measured["gain_low"]
    np.testing.assert_allclose(width[0], 2 * found[0].half_width())
    turn = measured["phase_high"] - measured["phase_low"]
    np.testing.assert_allclose(turn, np.degrees(width / np.abs(response)))
    assert measured["response"].attrs["units"] == "mm/V"
    H1, H2 = responses(found[0].lines)
    band = RelativeBand(np.full(H1.size, 0.01), np.full(H1.size, 0.01))
    wide = RelativeBand(np.full(H2.shape, 0.1), np.full(H2.shape, 0.1))
    whole = confirmation(measured, found, [Modelled(H1, band, H2, wide)] * 2, 1.0, 0.9)
    origin = {"tracker": "local", "estimator": "rls", "model_band_withheld": ""}
    path = tmp_path / "confirmation.nc"
    with pytest.raises(InputError, match="estimator: the attribute is missing"):
        store.write(whole.assign_attrs(tracker="local"), path, title="Confirmation")
    store.write(whole.assign_attrs(origin), path, title="Confirmation")
    back = store.read(tmp_path / "confirmation.nc")
    assert back["inside"].values.all()
    np.testing.assert_array_equal(back["in_band"], back["frequency"] <= 1.0)
    np.testing.assert_allclose(back["model_gain_high"][0], 1.01 * np.abs(H1))
    np.testing.assert_allclose(back["model_gain_low"][0], np.abs(H1) / 1.01)
    judged = back["even_judged"].values == 1
    np.testing.assert_array_equal(judged, back["even_in_band"] >= 0.9)
    assert 0 < judged.sum() < judged.size
    assert np.mean(back["even_inside"].values[judged]) > 0.9


@pytest.mark.parametrize("period", [10.0, 20.0])
def test_even_lines_have_their_frequencies_whatever_the_first_excited_harmonic(period):
    """A multisine repeats after two of its periods, too: its lowest line is then the second."""
    made = estimates(probed_record(replace(PROBING, times=[10.0], periods=4)), period=period)
    H1, H2 = responses(made.found[0].lines, period)
    band, wide = (RelativeBand(np.full(h.shape, 0.1), np.full(h.shape, 0.1)) for h in (H1, H2))
    whole = confirmation(made.dataset, made.found, [Modelled(H1, band, H2, wide)], 1.0, 0.9)
    np.testing.assert_allclose(whole["even_frequency"], 0.2 * np.arange(1, 11))


def test_a_band_around_a_response_has_its_half_widths():
    response = 2.0 * np.exp(1j * np.array([0.3, 3.0]))
    band = RelativeBand.around(response, np.array([2.2, 2.1]), np.degrees(np.array([0.35, 3.2])))
    np.testing.assert_allclose(band.gain, [0.1, 0.05])
    np.testing.assert_allclose(band.phase, [0.05, 0.2])
    # The disc of equal errors of gain and phase: 2.45 standard deviations, not 1.96.
    equal = RelativeBand(np.array([1.96]), np.array([1.96]))
    np.testing.assert_allclose(equal.radius(), 2.4477, rtol=1e-3)


@pytest.mark.parametrize("period", [np.nan, np.inf, 0.0, "x"])
def test_a_period_that_is_no_positive_number_is_refused(record, period):
    with pytest.raises(InputError, match=f"period: it is {period!r}"):
        best_linear_approximation(record, period=period)


def test_a_response_that_noise_hides_has_any_phase_and_no_negative_gain(record):
    noise = 10.0 * np.random.default_rng(1).standard_normal(2400)
    found = best_linear_approximation(record.assign(output=record.output + noise))
    hidden = found.gain_low.values == 0.0
    assert (found.gain_low >= 0.0).all()
    assert 0 < np.count_nonzero(hidden) < hidden.size
    turn = (found.phase_high - found.phase_low).values
    np.testing.assert_allclose(turn[hidden], 360.0)
    assert (turn[~hidden] < 180.0).all()


def test_samples_between_the_multisines_of_a_stretch_are_of_none(record):
    """They may belong to the stretch, as its settling does."""
    settling = record.assign(probing=record.probing.where(record.time >= 110.0, 1))
    assert np.count_nonzero(settling.probing == 1) > np.count_nonzero(record.probing == 1)
    first, wanted = (periods_of(each, 10.0)[0] for each in (settling, record))
    np.testing.assert_array_equal(first.u, wanted.u)
    assert first.time == wanted.time
    with pytest.raises(InputError, match="stretch 1 holds 0 realisations"):
        periods_of(record.assign(realisation=0 * record.realisation), 10.0)


def spoilt(record, name, value):
    """The record with one other value in its first stretch."""
    at = np.flatnonzero(record["probing"].values == 1)[5]
    return record.assign({name: record[name].where(np.arange(2400) != at, value)})


@pytest.mark.parametrize(
    ("change", "named"),
    [
        (lambda r: r.drop_vars("realisation"), "realisation: the variable is missing"),
        (lambda r: r.assign(probing=0 * r.probing), "probing: no sample"),
        (lambda r: r.assign(realisation=r.realisation.clip(max=1)), "interrupted"),
        (lambda r: r.assign(probing=r.probing.where(r.realisation == 1, 0)), "1 realisations"),
        (lambda r: r.drop_attrs(deep=False), "period: the period"),
        (lambda r: spoilt(r, "input", np.nan), "1 samples of stretch 1 are flagged or not finite"),
        (lambda r: spoilt(r, "output", np.inf), "1 samples of stretch 1 are flagged or not finite"),
        (lambda r: spoilt(r, "output", np.nan), "1 samples of stretch 1 are flagged or not finite"),
        (lambda r: r.assign(input=0.0 * r.input.assign_attrs(units="V")), "input: it is constant"),
        (lambda r: r.assign_attrs(probing_period=10.03), "not a whole number"),
        (lambda r: r.assign_attrs(probing_period=15.0), "1 whole periods"),
    ],
)
def test_a_record_that_cannot_be_analysed_is_refused(record, change, named):
    with pytest.raises(InputError, match=named):
        best_linear_approximation(change(record))
