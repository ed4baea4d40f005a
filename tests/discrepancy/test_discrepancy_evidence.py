"""The numbers that a verdict rests on, where they are known in closed form."""

import re
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.stats import norm

from dea.autoregression import fit_autoregression
from dea.discrepancy import Settings
from dea.discrepancy.budget import Budget
from dea.discrepancy.evidence.bootstrap import Gains, beaten, energies, gains
from dea.discrepancy.evidence.confusion import confusion
from dea.discrepancy.evidence.contributions import Contribution, Rung, contributions, ladder
from dea.discrepancy.evidence.identifiability import visibility
from dea.discrepancy.evidence.localisation import localise
from dea.discrepancy.evidence.null import long_parts, null_gain
from dea.discrepancy.evidence.residual_model import dictionary, residual_model
from dea.discrepancy.problem.noise import white_level
from dea.discrepancy.problem.problem import Problem
from dea.discrepancy.problem.split import split
from dea.discrepancy.rules import Rules, misfit
from dea.errors import InputError
from dea.missing import runs
from dea.simulation import Input

INTERVAL = 0.02
INPUT = (Input("input", "V"),)


def problem_of(u, y, noise=1.0, fit=None, select=None):
    everything = np.ones(len(u), bool)
    fit = everything if fit is None else fit
    select = everything if select is None else select
    return Problem(u, y, INTERVAL, fit, select, ~everything, noise)


# Thresholds of the verdict


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Rules(margin=0.6), "margin: it is 0.6. Give less than 0.5"),
        (lambda: Rules(clean=-1.0), "clean: it is -1.0. Give a number of 0 or more"),
        (lambda: Rules(part="half"), "part: it is 'half'. Give a number of 0 or more"),
        (lambda: Rules(near=np.nan), "near: it is nan. Give a number"),
        (lambda: Settings(blocks=np.nan), "blocks: it is nan. Give a whole number, two at least"),
        (lambda: Settings(blocks=np.inf), "blocks: it is inf. Give a whole number"),
        (lambda: Settings(slowest_time="3"), "slowest_time: it is '3'. Give a positive time in s"),
        (lambda: Settings(warm_up=np.inf), "warm_up: it is inf. Give a time in s, or zero"),
        (lambda: Settings(step_error=0.0), "step_error: it is 0.0. Give a positive number"),
        (lambda: Settings(effects="backlash"), "effects: it is 'backlash'. Give a list of names"),
        (lambda: Budget(effects=4), "effects: it is 4. Give 1 to 3"),
        (lambda: Budget(beam=1.5), "beam: it is 1.5. Give a whole number of 1 or more"),
        (lambda: Budget(decimated=0), "decimated: it is 0. Give a whole number of 1 or more"),
        (lambda: Budget(shakes=-1), "shakes: it is -1. Give a whole number of 0 or more"),
    ],
)
def test_a_threshold_that_makes_no_sense_is_refused(make, message):
    with pytest.raises(InputError) as found:
        make()
    assert message in str(found.value)


def test_the_misfit_is_the_leg_of_a_right_triangle():
    assert misfit(5.0, 3.0) == 4.0
    assert misfit(3.0, 3.0) == misfit(2.0, 3.0) == 0.0


def test_the_gain_needed_removes_the_margin_of_the_error():
    assert np.exp(-Rules(margin=0.1).needed_gain) == pytest.approx(0.9)


@pytest.mark.parametrize(
    ("error", "nominal", "room"),
    [
        (1.14, 1.2, False),  # explained, whatever the share that is left
        (1.15, 1.15, False),
        (1.16, 1.17, True),  # nearly all of the misfit is left
        (1.24, 9.0, False),  # a small share of it is
        (1.26, 9.0, True),  # but the residual is large
        (1.2, np.hypot(1.0, np.sqrt(0.44) / 0.26), True),  # more than a quarter of it is left
        (1.2, np.hypot(1.0, np.sqrt(0.44) / 0.24), False),
    ],
)
def test_room_for_a_further_effect(error, nominal, room):
    rules = Rules(clean=1.15, grow=1.25, misfit=0.25, room=0.06)
    assert rules.leaves_room(2.0 * error, 2.0 * nominal, 2.0) is room


@pytest.mark.parametrize(("share", "good"), [(0.5, True), (1.0499, True), (1.0501, False)])
def test_as_good_is_a_misfit_up_to_the_margin_of_a_rival(share, good):
    rules = Rules(rival_margin=1.05, negligible=0.05)
    assert rules.as_good(np.hypot(3.0, 4.0 * share), 5.0, 3.0) is good
    # Misfits below a twentieth of the floor are not told apart.
    assert rules.as_good(np.hypot(3.0, 0.15 * share), 3.0, 3.0) is good


# Resampled blocks


BLOCKS = [slice(k, k + 50) for k in range(10, 10_010, 50)]


def test_energies_are_those_of_the_blocks():
    residual = np.arange(6.0)
    assert energies(residual, [slice(1, 3), slice(4, 6)]).tolist() == [5.0, 41.0]


def test_a_residual_that_shrinks_alike_everywhere_has_a_sure_gain():
    rng = np.random.default_rng(1)
    before = rng.standard_normal(10_100) * np.linspace(0.1, 3.0, 10_100)
    found = gains([before] * 3, [before / np.e, before, 2.0 * before], BLOCKS, 0.3, rng)
    for bound in (found.gain, found.low, found.high):
        np.testing.assert_allclose(bound, [1.0, 0.0, -np.log(2.0)], atol=1e-12)
    assert found.null == 0.3
    inside = np.concatenate([before[block] for block in BLOCKS])
    np.testing.assert_allclose(found.before, np.sqrt(np.mean(inside**2)))
    assert beaten(before, 3.0 * before, BLOCKS, rng) == pytest.approx((np.log(3.0), np.log(3.0)))


def test_a_gains_interval_is_that_of_its_sampling():
    """The log of a mean of n squares has a variance of 2/n; a gain is half a difference of two."""
    rng = np.random.default_rng(2)
    before, after = rng.standard_normal((2, 10_100))
    found = gains([before], [after], BLOCKS, 0.0, rng)
    deviation = np.sqrt(1.0 / 10_000)
    assert found.high[0] - found.gain[0] == pytest.approx(1.96 * deviation, rel=0.15)
    assert found.gain[0] - found.low[0] == pytest.approx(1.96 * deviation, rel=0.15)
    drawn = [beaten(before, after, BLOCKS, rng) for _ in range(20)]
    worse, low = np.mean(drawn, axis=0)
    assert worse == pytest.approx(-found.gain[0])
    assert worse - low == pytest.approx(1.645 * deviation, rel=0.12)


def test_several_gains_are_bounded_together():
    """Of k independent gains each needs a level of 1 - 0.95^(1/k)."""
    rng = np.random.default_rng(3)
    before = 1e-6 + np.zeros(10_100)
    before[10:10_010] = 1.0  # whose energy is the same in every draw
    after = [rng.standard_normal(10_100) for _ in range(8)]
    found = gains([before] * len(after), after, BLOCKS, 0.0, rng)
    wide = norm.ppf(1.0 - 0.5 * (1.0 - 0.95 ** (1 / 8))) * np.sqrt(0.5 / 10_000)
    np.testing.assert_allclose(np.mean(found.high - found.gain), wide, rtol=0.12)
    np.testing.assert_allclose(np.mean(found.gain - found.low), wide, rtol=0.12)


# Noise


def test_the_parts_that_show_a_colour_are_long_and_without_their_means():
    noise = np.random.default_rng(4).standard_normal(200) + 7.0
    first, second = long_parts(noise, [slice(0, 20), slice(20, 41), slice(50, 90)])
    np.testing.assert_allclose(first, noise[20:41] - noise[20:41].mean())
    np.testing.assert_allclose(second, noise[50:90] - noise[50:90].mean())


@pytest.mark.parametrize("band", [(0.27, 0.36), (0.39, 0.49)])
def test_what_rings_in_a_quarter_of_the_band_is_no_noise(band):
    rng = np.random.default_rng(6)
    spectrum = np.fft.rfft(rng.standard_normal(6000))
    frequency = np.fft.rfftfreq(6000)
    spectrum[(frequency < band[0]) | (frequency > band[1])] = 0.0
    ringing = np.fft.irfft(spectrum, 6000)
    noise = 0.3 * rng.standard_normal(6000)
    found = white_level(noise + 2.0 * ringing / ringing.std(), [slice(0, 6000)])
    assert found == pytest.approx(0.3, rel=0.15)


def test_blocks_too_short_for_a_spectrum_do_not_count():
    rng = np.random.default_rng(7)
    residual = np.concatenate([rng.standard_normal(600), 100.0 * rng.standard_normal(23)])
    blocks = [slice(0, 600), slice(600, 623)]
    assert white_level(residual, blocks) == white_level(residual, blocks[:1])
    assert white_level(residual, blocks[1:]) == np.std(residual)


def simulated(residual, jacobian):
    return SimpleNamespace(
        residual=residual, jacobian=jacobian, coordinates=np.zeros(jacobian.shape[1])
    )


def test_the_gain_of_chance_is_that_of_refits_to_drawn_records():
    rng = np.random.default_rng(8)
    n = 400
    half = np.arange(n) % 100 < 50
    problem = problem_of(np.zeros(n), np.zeros(n), 0.5, half, ~half)
    J = np.column_stack([np.sin(np.arange(n) / k) for k in (20.0, 3.0, 11.0)])
    noise = lfilter([1.0], [1.0, -0.95], rng.standard_normal(n))
    whole = [slice(0, n)]
    before, after = simulated(noise, J[:, :1]), [simulated(noise, J[:, :2]), simulated(noise, J)]
    found = null_gain(problem, before, after, noise, whole, np.random.default_rng(9))

    colour = fit_autoregression([noise - noise.mean()])
    past_weights = -colour.coefficients[1:]
    innovations = np.sqrt(colour.variance) * np.random.default_rng(9).standard_normal((60, n))
    best = []
    for e in innovations:
        drawn = np.zeros(n)
        for t in range(n):
            past = drawn[max(t - colour.order, 0) : t][::-1]
            drawn[t] = e[t] + past_weights[: past.size] @ past
        left = []
        for fit in (before, *after):
            k = fit.jacobian.shape[1]
            rows = np.vstack([fit.jacobian[half], 0.5 * np.eye(k)])
            step = np.linalg.lstsq(rows, np.append(drawn[half], np.zeros(k)), rcond=None)[0]
            left.append(np.linalg.norm((drawn - fit.jacobian @ step)[~half]))
        best.append(max(0.0, np.log(left[0] / min(left))))
    assert found == pytest.approx(np.quantile(best, 0.95))
    assert found > 0.0


# Splits


def test_runs_are_where_a_mask_holds():
    mask = np.array([1, 1, 0, 1, 0, 0, 1], bool)
    assert runs(mask) == [slice(0, 2), slice(3, 4), slice(6, 7)]
    assert runs(~mask) == [slice(2, 3), slice(4, 6)]


def test_a_long_record_has_nineteen_blocks_three_time_constants_apart():
    u = np.sin(np.arange(9000) * 0.05)
    parts = split(u, INTERVAL, 0.09, warm_up=2.0)
    assert parts.spacing == 14  # three time constants are 13.5 samples
    kept = {name: runs(getattr(parts, name)) for name in ("fit", "select", "certify")}
    assert [len(kept[name]) for name in ("fit", "select", "certify")] == [9, 9, 1]
    blocks = sorted((run.start, run.stop) for found in kept.values() for run in found)
    assert blocks[0][0] == 100
    assert blocks[-1][1] == 9000
    between = [b[0] - a[1] for a, b in pairwise(blocks)]
    assert set(between) <= {13, 14, 15}
    [certified] = kept["certify"]
    length = (9000 - 100 - 18 * 14) / 21
    assert certified.stop - certified.start == pytest.approx(3 * length, abs=1)
    assert blocks.index((certified.start, certified.stop)) == 9
    for run in kept["fit"] + kept["select"]:
        assert run.stop - run.start == pytest.approx(length, abs=1)


@pytest.mark.parametrize("slowest", [0.05, 0.5, 3.0])
@pytest.mark.parametrize("warm_up", [0.0, 4.0])
def test_a_record_as_long_as_asked_for_can_be_split(slowest, warm_up):
    with pytest.raises(InputError, match="the split needs") as caught:
        split(np.zeros(20), INTERVAL, slowest, warm_up)
    needed = float(str(caught.value).split("the split needs ")[1].split(" s")[0])
    samples = int(np.ceil(needed / INTERVAL * 1.00001))
    split(np.sin(np.arange(samples)), INTERVAL, slowest, warm_up)
    with pytest.raises(InputError, match="the split needs"):
        split(np.sin(np.arange(round(0.97 * samples))), INTERVAL, slowest, warm_up)


@pytest.mark.parametrize("samples", [53, 56, 60, 101, 613])
@pytest.mark.parametrize("interval", [0.01, 0.02, 0.3])
@pytest.mark.parametrize("slowest", [2.0, 5.0])
def test_a_record_that_is_too_short_can_be_split_with_the_time_it_is_said_to_allow(
    samples, interval, slowest
):
    u = np.sin(np.arange(samples))
    with pytest.raises(InputError, match=r"if the device is faster .* allows a time") as caught:
        split(u, interval, slowest * samples * interval)
    allowed = float(str(caught.value).split("a time of at most ")[1].split(" s (")[0])
    assert split(u, interval, allowed).close
    assert not split(u, interval, 0.99 * allowed / 3.0).close or allowed < 3.0 * interval
    with pytest.raises(InputError, match="the split needs"):
        split(u, interval, 1.01 * allowed + 0.01 * interval)


def test_a_record_of_too_few_samples_is_said_to_allow_no_time():
    with pytest.raises(
        InputError, match=r"Record longer: whatever .* it needs 53 samples"
    ) as caught:
        split(np.zeros(52), INTERVAL, 5.0)
    assert "at most" not in str(caught.value)
    split(np.sin(np.arange(53)), INTERVAL, 0.1 * INTERVAL)
    with pytest.raises(InputError, match=r"it needs 73 samples"):
        split(np.zeros(72), INTERVAL, 5.0, 20 * INTERVAL)


@pytest.mark.parametrize(("samples", "apart"), [(620, 3.0), (500, 2.5), (300, 1.5), (201, 1.0)])
def test_a_short_record_has_blocks_as_far_apart_as_it_allows(samples, apart):
    """Of three blocks, each longer than the time constants (25 samples) between them, one quarter
    shorter than the others: a record of eight such spacings."""
    parts = split(np.sin(np.arange(samples) * 0.05), INTERVAL, 25 * INTERVAL)
    assert parts.spacing == pytest.approx(25 * apart, abs=1)
    assert parts.time_constants == pytest.approx(apart, abs=0.04)
    assert parts.close == (apart < 3.0)
    blocks = sorted(
        (run.start, run.stop)
        for mask in (parts.fit, parts.select, parts.certify)
        for run in runs(mask)
    )
    assert len(blocks) == 4
    for a, b in pairwise(blocks):
        assert b[0] - a[1] == pytest.approx(parts.spacing, abs=1)
    assert min(stop - start for start, stop in blocks) >= parts.spacing - 1


# What the record shows


def test_an_effect_is_as_visible_as_what_the_parameters_leave_of_it():
    """A column a of norm A absorbs all but noise^2 / (noise^2 + A^2) of what is along it."""
    noise = 0.5
    a, b = np.array([3.0, 0.0, 0.0, 0.0]), np.array([0.0, 4.0, 0.0, 0.0])
    problem = problem_of(np.zeros(4), np.zeros(4), noise)
    before = simulated(a, a[:, None])
    along, across, both = (
        visibility(problem, before, simulated(a, np.column_stack([a, law])))
        for law in (2.0 * a, b, 2.0 * a + b)
    )
    left = 6.0 * np.sqrt(0.25 / 9.25)
    assert across.size == pytest.approx(np.sqrt(16.0 / 4) / noise)
    assert across.independent == pytest.approx(1.0)
    assert along.size == pytest.approx(left / 2.0 / noise)
    assert along.independent == pytest.approx(left / 6.0)
    assert both.independent == pytest.approx(np.sqrt((left**2 + 16.0) / 52.0))
    weak = visibility(problem, before, simulated(a, np.column_stack([a, 0.01 * b])))
    assert (weak.size, weak.independent) == pytest.approx((0.01 * across.size, 1.0))
    # Of two parameters of a law the one that is seen tells its own independence.
    both = visibility(problem, before, simulated(a, np.column_stack([a, 7.0 * a, b])))
    assert both.independent == pytest.approx(1.0)
    nothing = visibility(problem, before, before)
    assert (nothing.size, nothing.independent) == (0.0, 0.0)


def test_candidates_are_confused_as_their_outputs_are_close():
    """Two outputs d noise deviations apart: the odds of the other are 2 Φ(-d/2)."""
    n, noise = 50, 0.2
    problem = problem_of(np.zeros(n), np.zeros(n), noise)
    shift = np.full(n, 2.0 * noise / np.sqrt(n))
    fixed = [
        SimpleNamespace(fit=simulated(residual, np.zeros((n, 0))))
        for residual in (np.zeros(n), shift)
    ]
    found = confusion(problem, tuple(fixed)).probability
    odds = 2.0 * norm.cdf(-1.0)
    np.testing.assert_allclose(found, np.array([[1.0, odds], [odds, 1.0]]) / (1.0 + odds))
    # A second candidate whose parameter can stand for the first one is taken for it.
    flexible = SimpleNamespace(fit=simulated(shift, np.full((n, 1), 1e3)))
    found = confusion(problem, (fixed[0], flexible)).probability
    np.testing.assert_allclose(found[0], [0.5, 0.5], atol=1e-4)
    np.testing.assert_allclose(found[1], np.array([odds, 1.0]) / (1.0 + odds))


# Where the residual is


T = np.arange(3000) * INTERVAL
TRIANGLE = np.abs((T / 6.0) % 2.0 - 1.0)  # falls for 6 s, rises for 6 s
# It stands still around each turning point, and jumps once, which is faster by far.
TRAPEZOID = np.clip(2.0 * TRIANGLE - 0.5, 0.0, 1.0) + 5.0 * (T >= 59.0)
FALLING = (T % 12.0 >= 1.5) & (T % 12.0 < 4.5)
RISING = (T % 12.0 >= 7.5) & (T % 12.0 < 10.5)


@pytest.mark.parametrize(
    ("along", "large", "number", "low", "high"),
    [
        ("time", (T >= 25.0) & (T < 27.5), 10, 25.0, 27.5),
        ("direction", FALLING, 0, -0.5, 0.5),
        ("direction", ~(FALLING | RISING), 1, 0.5, 1.5),
        ("direction", RISING, 2, 1.5, 2.5),
        ("reversal", (T % 6.0) < 0.5, 0, 0.0, 0.5),
    ],
)
def test_a_residual_is_found_along_what_it_depends_on(along, large, number, low, high):
    rng = np.random.default_rng(10)
    u = lfilter([0.05], [1.0, -0.95], rng.standard_normal(3000))
    residual = 0.01 * rng.standard_normal(3000) * np.where(large, 5.0, 1.0)
    output = TRAPEZOID if along == "direction" else TRIANGLE
    problem = problem_of(u, output + residual)
    localised = localise(problem, residual, INPUT, "mm", np.ones(3000, bool), rng)
    found = localised.dataset
    edges = float(found[f"{along}_low"][number]), float(found[f"{along}_high"][number])
    assert edges == pytest.approx((low, high), abs=0.05)
    rms = found[f"{along}_rms"].values
    assert rms[number] == pytest.approx(0.05, rel=0.1)
    others = [n for n in range(rms.size) if n != number]
    np.testing.assert_allclose(rms[others], 0.01, rtol=0.35)
    assert found[f"{along}_probability"] == pytest.approx(1 / 201)
    # Chance would spread the energy: its bound lies near the root mean square of all.
    bound = found[f"{along}_null"].values[[number, *others]]
    assert ((bound > localised.rms) & (bound < 2.5 * localised.rms)).all()
    assert localised.rms == pytest.approx(np.sqrt(np.mean(residual**2)))
    # Twice as many in time, where nothing is as rare as at the ends of a range.
    assert {name: found.sizes[name] for name in ("time", "input")} == {"time": 24, "input": 12}


def test_a_concentration_compares_a_bin_with_the_others():
    rng = np.random.default_rng(10)
    large = (T >= 25.0) & (T < 27.5)
    residual = 0.01 * rng.standard_normal(3000) * np.where(large, 5.0, 1.0)
    problem = problem_of(rng.standard_normal(3000), TRIANGLE + residual)
    found = localise(problem, residual, INPUT, "mm", np.ones(3000, bool), rng).concentration
    assert (found.along, found.number, found.unit) == ("time", 10, "s")
    assert (found.low, found.high) == pytest.approx((25.0, 27.5), abs=0.05)
    assert found.inside == pytest.approx(0.05, rel=0.1)
    assert found.elsewhere == pytest.approx(0.01, rel=0.05)


# The first is the lowest frequency of the record.
@pytest.mark.parametrize("frequency", [np.fft.rfftfreq(3000, INTERVAL)[1], 0.4, 3.0, 11.0])
def test_the_band_is_the_octave_of_a_line(frequency):
    rng = np.random.default_rng(11)
    residual = 3.0 + np.sin(2 * np.pi * frequency * T) + 0.1 * rng.standard_normal(3000)
    problem = problem_of(rng.standard_normal(3000), residual)
    band = localise(problem, residual, INPUT, "mm", np.ones(3000, bool), rng).band
    assert band.low <= frequency < band.high
    assert band.high == pytest.approx(2.0 * band.low)
    # A sine of amplitude 1 beside noise of which an octave holds at most half.
    assert 0.5 / 0.51 - 1e-3 < band.part <= 1.0


# A flexible model of the residual


def halves(n):
    fit = np.arange(n) % 500 < 250
    return fit, ~fit


def test_the_residual_model_finds_a_term_of_its_dictionary():
    rng = np.random.default_rng(12)
    u = lfilter([0.1], [1.0, -0.9], rng.standard_normal(3000))
    simulation = lfilter([0.05], [1.0, -0.95], u)
    standard = (u - u.mean()) / u.std()
    residual = 0.4 * standard**2 + 0.004 * rng.standard_normal(3000)
    problem = problem_of(u, simulation + residual, 1.0, *halves(3000))
    found = residual_model(problem, residual)
    assert found.ratio < 0.05
    assert found.explained > 0.99
    assert found.equation.startswith("+0.4 [u^2]")


def test_an_equation_of_the_residual_holds_in_the_units_of_the_record():
    """What it says is computed anew from its text, with the mean and deviation of its signal."""
    rng = np.random.default_rng(12)
    u = np.repeat(rng.uniform(0.0, 3.0, 300), 10)
    residual = 0.05 * (u - 1.5) ** 2 + 0.1 + 0.001 * rng.standard_normal(3000)
    problem = problem_of(u, 10.0 + lfilter([0.05], [1.0, -0.95], u) + residual, 1.0, *halves(3000))
    equation, standards = residual_model(problem, residual).equation.split(", standardised ")
    [(symbol, mean, deviation)] = re.findall(r"(\S+) by (\S+) ± ([^\s,]+)", standards)
    assert symbol == "u"
    code = re.sub(r" ([+-]\S+) \[", r"\1 * [", f" {equation}").replace("^", "**")
    code = code.replace("[", "(").replace("]", ")").replace("max", "np.maximum")
    told = eval(code, {"np": np, "u": (u - float(mean)) / float(deviation)})
    np.testing.assert_allclose(told, residual, atol=0.01)


def test_an_equation_names_what_standardises_each_signal_in_it():
    rng = np.random.default_rng(14)
    u = lfilter([0.1], [1.0, -0.9], rng.standard_normal((2, 3000)))
    y = lfilter([0.05], [1.0, -0.95], u[0])
    rate = np.gradient(y, INTERVAL)
    residual = 0.3 * (u[1] - u[1].mean()) / u[1].std() + 0.01 * rng.standard_normal(3000)
    residual -= 0.2 * np.abs(rate - rate.mean()) / rate.std()
    problem = problem_of(u.T, y + residual, 1.0, *halves(3000))
    equation = residual_model(problem, residual).equation
    assert "[u2]" in equation
    assert "[|y'|]" in equation
    assert f"u2 by {u[1].mean():.3g} ± {u[1].std():.3g}" in equation
    assert f"y' by {rate.mean():.3g} ± {rate.std():.3g}" in equation
    assert "u1 by" not in equation


@pytest.mark.parametrize("beyond", [0.0, 1e-5])
def test_a_term_that_hardly_moves_where_it_is_fitted_does_not_hide_the_others(beyond):
    """The input passes its 90 % quantile in the blocks that judge alone, but for one sample."""
    rng = np.random.default_rng(15)
    fit, select = halves(3000)
    u = rng.uniform(-1.0, 1.0, 3000)
    knee = np.quantile(u, 0.9)
    u[fit] = np.minimum(u[fit], knee)
    u[np.flatnonzero(fit)[0]] = knee + beyond
    residual = 0.3 * u + 0.02 * rng.standard_normal(3000)
    problem = problem_of(u, lfilter([0.05], [1.0, -0.95], u) + residual, 1.0, fit, select)
    assert residual_model(problem, residual).ratio < 0.2


@pytest.mark.parametrize("constant", [0.0, 0.75])
def test_a_constant_counts_as_predicted(constant):
    rng = np.random.default_rng(13)
    u = lfilter([0.1], [1.0, -0.9], rng.standard_normal(3000))
    residual = constant + rng.standard_normal(3000)
    found = residual_model(problem_of(u, u + residual, 1.0, *halves(3000)), residual)
    assert found.ratio == pytest.approx(1.0 / np.hypot(1.0, constant), abs=0.02)


def test_the_residual_model_finds_nothing_in_noise():
    rng = np.random.default_rng(13)
    u = lfilter([0.1], [1.0, -0.9], rng.standard_normal(3000))
    residual = rng.standard_normal(3000)
    found = residual_model(problem_of(u, u + residual, 1.0, *halves(3000)), residual)
    assert 0.98 < found.ratio <= 1.0
    assert found.explained < 0.05
    assert found.explained > 0.0 or found.equation == "0"


# The dictionary of a residual


def test_the_dictionary_holds_what_its_names_say():
    rng = np.random.default_rng(11)
    u, simulated = rng.uniform(-1.0, 1.0, 400), rng.uniform(1.0, 5.0, 400)
    problem = problem_of(u, simulated)
    names, columns = dictionary(problem, simulated)
    told = dict(zip(names, columns.T, strict=True))
    own = {"u": (u - u.mean()) / u.std(), "y": (simulated - simulated.mean()) / simulated.std()}
    hinges = [name for name in names if name.startswith("max(")]
    assert len(hinges) == 8
    for name in hinges:
        symbol, beside = name[len("max(") : -len(", 0)")].split(" ", 1)
        # A name gives two digits of its level.
        expected = np.maximum(own[symbol] + float(beside), 0.0)
        np.testing.assert_allclose(told[name], expected, atol=0.06)
    for symbol, signal in own.items():
        np.testing.assert_allclose(told[f"{symbol}^2"], signal**2)
        np.testing.assert_allclose(told[f"{symbol}^3"], signal**3)
    np.testing.assert_allclose(told["u y"], own["u"] * own["y"])
    rate = told["y'"]
    moving = np.abs(rate) > 0.2
    np.testing.assert_allclose(told["sign(y')"][moving], np.sign(rate[moving]), atol=2e-3)
    np.testing.assert_allclose(told["|y'|"], np.abs(rate))
    np.testing.assert_allclose(told["y'|y'|"], rate * np.abs(rate))
    delayed = [name for name in names if name.startswith("lag(")]
    lagging = {"u": own["u"], "u^2": own["u"] ** 2, "y^2": own["y"] ** 2}
    assert {name[len("lag(") :].split(",")[0] for name in delayed} == lagging.keys()
    for name in delayed:
        symbol, time = name[len("lag(") : -len(" s)")].split(", ")
        fine = np.interp(np.arange(8000) / 20, np.arange(400), lagging[symbol])
        share = problem.interval / (20.0 * float(time))
        follower = lfilter([share], [1.0, share - 1.0], fine - fine[0])
        assert np.corrcoef(told[name][100:], follower[2000::20])[0, 1] > 0.98


# What each effect contributes


def attached(*labels):
    """A fit whose extension holds effects of these labels."""
    places = SimpleNamespace(label=lambda name: name)
    return SimpleNamespace(extended=SimpleNamespace(attached=labels, places=places))


def evidence_of(samples):
    problem = SimpleNamespace(seen=np.ones(samples, bool))
    blocks = [slice(k, k + 50) for k in range(0, samples, 50)]
    return SimpleNamespace(problem=problem, blocks=blocks, rng=np.random.default_rng(0))


def test_a_single_effect_contributes_what_it_gained_among_the_catalogue():
    rungs = [Rung(None, np.full(1000, 4.0)), Rung("b", np.full(1000, 2.0))]
    singles = [SimpleNamespace(labels=(label,), finished=True, error=1.0) for label in "abc"]
    gain, low, high = np.array([1.0, 2.0, 3.0]), np.array([0.0, 1.5, 2.0]), np.full(3, 9.0)
    gained = Gains(gain, low, high, 0.1, np.ones(3))
    [found] = contributions(evidence_of(1000), rungs, attached("b"), singles, gained)
    assert found == Contribution(4.0, 2.0, 2.0, 1.5, 9.0)


def test_of_two_effects_the_first_contributes_what_it_did_alone():
    singles = [
        SimpleNamespace(labels=(label,), fit=size, finished=True)
        for label, size in (("a", 2.0), ("b", 3.0))
    ]
    final = attached("a", "b")
    held_out = SimpleNamespace(
        residual=lambda fitted, _: np.full(1000, 0.5 if fitted is final else fitted)
    )
    evidence = SimpleNamespace(**vars(evidence_of(1000)), held_out=held_out)
    rungs = ladder(evidence, 4.0, final, singles)
    assert [rung.label for rung in rungs] == [None, "a", "b"]
    first, second = contributions(evidence, rungs, final, singles, None)
    assert (first.before, first.after, second.before, second.after) == (4.0, 2.0, 2.0, 0.5)
    gained = Gains(np.array([2.0, 3.0]), np.zeros(2), np.full(2, 9.0), 0.1, np.ones(2))
    [alone] = contributions(evidence, rungs[:2], attached("a"), singles, gained)
    assert alone.gain == 2.0


@pytest.mark.parametrize(
    ("there", "steps"),
    [
        ("a ab", [(4.0, 2.0), (2.0, 1.0), (1.0, 0.5)]),
        ("a", [(4.0, 2.0), (2.0, 0.5), (2.0, 0.5)]),  # b and c make one step
        ("ab", [(4.0, 1.0), (4.0, 1.0), (1.0, 0.5)]),
        ("", [(4.0, 0.5)] * 3),
    ],
)
def test_of_three_effects_each_contributes_its_step_where_the_part_before_was_fitted(there, steps):
    pool = [
        SimpleNamespace(labels=tuple(part), fit={"a": 2.0, "ab": 1.0}[part], finished=True)
        for part in there.split()
    ]
    final = attached("a", "b", "c")
    held_out = SimpleNamespace(
        residual=lambda fitted, _: np.full(1000, 0.5 if fitted is final else fitted)
    )
    evidence = SimpleNamespace(**vars(evidence_of(1000)), held_out=held_out)
    rungs = ladder(evidence, 4.0, final, pool)
    found = contributions(evidence, rungs, final, pool, None)
    assert [(each.before, each.after) for each in found] == steps


def test_of_two_effects_each_contributes_the_step_that_it_makes():
    """Beside residuals that shrink alike in every block, the interval is the step itself."""
    rungs = [
        Rung(label, np.full(1000, size)) for label, size in ((None, 4.0), ("a", 2.0), ("b", 0.5))
    ]
    first, second = contributions(evidence_of(1000), rungs, attached("a", "b"), (), None)
    assert (first.before, first.after, second.before, second.after) == (4.0, 2.0, 2.0, 0.5)
    for found, ratio in ((first, 2.0), (second, 4.0)):
        np.testing.assert_allclose([found.low, found.gain, found.high], np.log(ratio), atol=1e-9)
