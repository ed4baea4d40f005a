"""The judge of the bands, and a small campaign of it (``make coverage`` runs a large one)."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.coverage import judged
from benchmarks.coverage.campaign import Cell, Settings, run
from benchmarks.coverage.plants import monomial, plants, simulate
from benchmarks.coverage.records import (
    BAND,
    INPUTS,
    NOISE,
    NOISES,
    SETTLING,
    excitation,
    generators,
    records,
)
from benchmarks.coverage.report import rows, verdict
from benchmarks.coverage.statistics import Coverage, coverage
from benchmarks.coverage.truth import h1, h2

PAIRS = np.array([[0.005, 0.005], [0.005, 0.02], [0.02, -0.005]])


def delay(frequency, lag):
    return np.exp(-2j * np.pi * frequency * lag)


@pytest.mark.parametrize(
    ("name", "poles", "linear", "square"),
    [("piroddi_spinelli", (0.8, 0.0), 0.4, 0.4), ("two_poles", (1.6, -0.63), 0.03, 0.012)],
)
def test_probed_responses_of_a_hammerstein_system_are_its_poles_times_its_gains(
    name, poles, linear, square
):
    def through_poles(f):
        return delay(f, 1) / (1 - poles[0] * delay(f, 1) - poles[1] * delay(f, 2))

    f = np.array([0.001, 0.01, 0.2])
    assert h1(plants()[name], f) == pytest.approx(linear * through_poles(f), rel=1e-10)
    expected = square * through_poles(PAIRS.sum(axis=1))
    assert h2(plants()[name], PAIRS) == pytest.approx(expected, rel=1e-9)


def test_probed_responses_of_dea2_are_the_corrected_closed_forms():
    """Jacobs et al. 2015, (27) and (30), with the corrections of docs/method/frequency.md."""
    p = plants()["DEA2"].parameters
    y0 = p[0] / (1 - p[1] - p[2])
    f = np.array([0.002, 0.02])
    poles = 1 - p[1] * delay(f, 1) - p[2] * delay(f, 2)
    expected = (p[3] * delay(f, 1) + p[4] * delay(f, 2) + p[5] * delay(f, 3)) / poles
    assert h1(plants()["DEA2"], f) == pytest.approx(expected, rel=1e-6)
    f1, f2 = PAIRS.T
    s = f1 + f2
    mixed = delay(f1, 2) * delay(f2, 3) + delay(f1, 3) * delay(f2, 2)
    above = y0 * ((p[6] + p[9]) * delay(s, 1) + p[7] / 2 * mixed + p[8] * delay(s, 3))
    expected = above / (1 - p[1] * delay(s, 1) - p[2] * delay(s, 2))
    assert h2(plants()["DEA2"], PAIRS) == pytest.approx(expected, rel=1e-6)


def test_terms_are_read_and_written_alike():
    for text in ("1", "y(t-1)", "y(t-1)u(t-3)^2", "u(t-1)^3", "y(t-1)u(t-2)u(t-3)"):
        assert str(monomial(text)) == text


@pytest.mark.parametrize("kind", INPUTS)
@pytest.mark.parametrize("noise", NOISES)
def test_noise_is_its_share_of_the_output_and_a_record_does_not_depend_on_its_neighbours(
    kind, noise
):
    plant = plants()["two_poles"]
    both = records(plant, kind, noise, 1000, generators(1, "a", [0, 1]))
    alone = records(plant, kind, noise, 1000, generators(1, "a", [1]))
    assert np.array_equal(both.y[1], alone.y[0])
    (drawn,) = generators(1, "a", [1])
    clean = simulate(plant, excitation(kind, SETTLING + 1000, drawn)[None])[0, SETTLING:]
    assert np.std(alone.y[0] - clean) == pytest.approx(NOISE * clean.std(), rel=0.25)


def test_a_band_limited_input_holds_nothing_above_its_band():
    made = records(plants()["two_poles"], "band-limited", "output", 1000, generators(1, "a", [0]))
    spectrum = np.abs(np.fft.rfft(made.u[0] * np.hanning(1000)))
    above = np.fft.rfftfreq(1000) > 1.5 * BAND
    assert spectrum[above].max() < 1e-2 * spectrum.max()


def test_points_that_agree_within_each_record_count_once():
    rng = np.random.default_rng(0)
    alike = np.repeat((rng.random((200, 1)) < 0.9).astype(float), 10, axis=1)
    apart = (rng.random((200, 10)) < 0.9).astype(float)
    width = [found.high - found.low for found in (coverage(alike), coverage(apart))]
    assert width[0] == pytest.approx(width[1] * np.sqrt(10), rel=0.35)
    missing = apart.copy()
    missing[:100] = np.nan
    assert coverage(missing).records == 100


@pytest.mark.parametrize(("records", "points"), [(100, 32), (500, 4), (20, 8), (1, 8), (8, 1)])
def test_a_point_more_inside_lowers_no_end_of_the_interval(records, points):
    drawn = np.random.default_rng(0).permutation(records * points)
    outside = np.unique(np.geomspace(1, drawn.size, 60).astype(int))
    found = []
    for count in [0, *outside]:
        inside = np.ones(drawn.size)
        inside[drawn[:count]] = 0
        found.append(coverage(inside.reshape(records, points)))
    for end in ("low", "high"):
        assert np.diff([getattr(one, end) for one in found]).max() < 1e-3
    assert found[0].low == pytest.approx(records / (records + 1.96**2), abs=1e-3)
    assert found[1].low <= found[0].low


def test_records_that_are_alike_but_for_their_points_hold_as_many_trials_as_points():
    inside = np.tile([1.0] * 9 + [0.0], (40, 1))
    found, one = coverage(inside), coverage(inside.reshape(400, 1))
    assert (found.low, found.high) == pytest.approx((one.low, one.high), abs=1e-3)


@pytest.mark.parametrize(
    ("share", "low", "high", "said"),
    [
        (0.95, 0.94, 0.96, "within"),
        (0.95, 0.92, 0.98, "within"),
        (0.975, 0.20, 1.00, "undecided"),
        (0.93, 0.91, 0.94, "undecided"),
        (0.99, 0.97, 1.00, "undecided"),
        (0.90, 0.89, 0.91, "below"),
        (0.99, 0.985, 1.00, "above"),
    ],
)
def test_a_coverage_is_said_to_be_where_all_of_its_interval_is(share, low, high, said):
    assert verdict(Coverage(share, low, high, 100, 400), (0.92, 0.98)) == said


def test_a_coverage_of_no_record_is_withheld():
    assert verdict(coverage(np.full((3, 2), np.nan)), (0.92, 0.98)) == "withheld"


SMALL = Settings(count=8, samples=1500, plants=("two_poles",), drifting=())


def pooled(counted, quantity):
    return coverage(np.vstack([one.inside[quantity] for one in counted]))


@pytest.fixture
def only_refined(monkeypatch):
    monkeypatch.setattr("benchmarks.coverage.campaign.ESTIMATES", ("refined",))


@pytest.mark.usefixtures("only_refined")
def test_bands_of_refined_models_hold_in_every_noise():
    counted = run(SMALL)
    assert {one.cell for one in counted} == {
        Cell("two_poles", kind, noise, "refined") for kind in INPUTS for noise in NOISES
    }
    for row in rows(counted):
        assert row["verdict"] != "below", row
    for quantity in judged.QUANTITIES:
        found = pooled(counted, quantity)
        assert found.records == 48
        assert found.low < 0.98
        assert found.high > 0.92


@pytest.mark.usefixtures("only_refined")
def test_bands_half_as_wide_as_they_should_be_are_noticed(monkeypatch):
    honest = judged.refine

    def too_sure(model, u, y):
        refined = honest(model, u, y)
        return replace(refined, covariance=refined.covariance / 4)

    monkeypatch.setattr(judged, "refine", too_sure)
    counted = run(SMALL)
    for quantity in judged.QUANTITIES:
        assert pooled(counted, quantity).high < 0.92


DRIFTING = Settings(count=16, samples=2000, plants=(), drifting=("two_poles",))


@pytest.fixture
def one_drifting_cell(monkeypatch):
    for name, only in {"INPUTS": "white", "NOISES": "equation", "TRACKERS": "local",
                       "DRIFTS": "random walk"}.items():  # fmt: skip
        monkeypatch.setattr(f"benchmarks.coverage.campaign.{name}", (only,))


def verdicts(counted):
    return {row["quantity"]: row["verdict"] for row in rows(counted) if row["plant"] != "all"}


@pytest.mark.usefixtures("one_drifting_cell")
def test_bands_of_local_estimates_hold_while_parameters_drift():
    (counted,) = run(DRIFTING)
    assert counted.cell == Cell("two_poles", "white", "equation", "local", "random walk")
    assert counted.withheld == 0.0
    found = verdicts([counted])
    assert set(found) == set(judged.QUANTITIES)
    assert "below" not in found.values()


@pytest.mark.usefixtures("one_drifting_cell")
def test_tracked_bands_half_as_wide_as_they_should_be_are_noticed(monkeypatch):
    honest = judged.dea.track_parameters

    def too_sure(*arguments, **settings):
        track = honest(*arguments, **settings)
        middle = (track["band_low"] + track["band_high"]) / 2
        return track.assign(
            covariance=track["covariance"] / 4,
            band_low=(track["band_low"] + middle) / 2,
            band_high=(track["band_high"] + middle) / 2,
        )

    monkeypatch.setattr(judged.dea, "track_parameters", too_sure)
    assert set(verdicts(run(DRIFTING)).values()) == {"below"}
