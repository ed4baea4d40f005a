"""The plain devices of trials, their readings and the noise of each kind."""

from pathlib import Path

import numpy as np
import pytest
from made_conditions import CONDITIONS, built, resist
from scipy.linalg import expm

from dea.excitation import design
from dea.plant.chamber import Chamber
from dea.plant.drive import Drive
from dea.plant.hidden.devices import DEVICES, PlainChamber, PlainDrive
from dea.plant.hidden.noise import Noise, NoiseKind, NoiseSource
from dea.plant.hidden.refit import Yardstick
from dea.plant.hidden.rig import TrialRig

BENCH = Path(__file__).parents[2] / "config" / "bench.yaml"


def commands(samples=600, seed=0):
    return np.repeat(np.random.default_rng(seed).uniform(1.0, 4.0, samples // 20), 20)


def held(matrix, pushes, interval):
    """The states of ẋ = A x + b at each sample, from rest, with b held in between."""
    step = expm(interval * matrix)
    states = [np.zeros(len(matrix))]
    for push in pushes:
        settled = -np.linalg.solve(matrix, push)
        states.append(settled + step @ (states[-1] - settled))
    return np.array(states[:-1])


def test_the_drive_solves_its_equation_of_motion():
    drive, u = Drive(), commands()
    matrix = np.array([[0.0, 1.0], [-drive.stiffness, -drive.damping]])
    angle = held(matrix, [[0.0, drive.gain * each] for each in u], 1 / 50)[:, 0]
    read = TrialRig(PlainDrive(), [], 50.0).respond(u)
    # Steps of a millisecond by a method of the fourth order.
    np.testing.assert_allclose(read, angle, atol=1e-6 * np.ptp(angle))


def test_the_chamber_settles_where_heat_balances_and_follows_its_matrix():
    c, u = Chamber(), np.repeat([3.0, 1.0, 4.0], 2000)
    read = TrialRig(PlainChamber(), [], 10.0).respond(u)
    matrix = np.array([[-c.exchange, c.exchange], [c.uptake, -c.uptake - c.loss]])
    air = held(matrix, [[c.heating * each**2, 0.0] for each in u], 1 / 10)[:, 1]
    np.testing.assert_allclose(read, 20.0 + air, atol=1e-6 * np.ptp(air))


@pytest.mark.parametrize("rate", [10.0, 50.0, 200.0])
def test_readings_do_not_depend_on_cuts_or_shifts_in_time_alone(rate):
    u = commands(800)
    laws = [built("electrode_lag", "two_stages", 0.1)[0] for _ in range(4)]
    whole = TrialRig(PlainDrive(), laws[:1], rate, 0).respond(u)
    rig = TrialRig(PlainDrive(), laws[1:2], rate, -3)
    pieces = np.concatenate([rig.respond(piece) for piece in np.split(u, [1, 7, 300])])
    early = TrialRig(PlainDrive(), laws[2:3], rate, -3).respond(u)
    np.testing.assert_array_equal(pieces, early)
    fine = TrialRig(PlainDrive(), laws[3:], 1000.0, 0).respond(np.repeat(u, round(1000 / rate)))
    substeps = round(1000 / rate)
    np.testing.assert_array_equal(whole, fine[::substeps])
    np.testing.assert_array_equal(early[1:], fine[substeps - 3 :: substeps][: u.size - 1])
    late = TrialRig(PlainDrive(), [built("electrode_lag", "two_stages", 0.1)[0]], rate, 3)
    np.testing.assert_array_equal(late.respond(u), fine[3::substeps])


@pytest.mark.parametrize("kind", NoiseKind)
def test_every_noise_has_its_rms_and_does_not_depend_on_cuts(kind):
    noise = Noise(kind, 2.0, correlation=8.0)
    truth = 40.0 * np.sin(np.arange(200_000) / 7.0)
    wrong = NoiseSource(noise, 5).read(truth) - truth
    assert np.sqrt(np.mean(wrong**2)) == pytest.approx(2.0, rel=0.08)
    source = NoiseSource(noise, 5)
    pieces = [source.read(piece) for piece in np.split(truth[:5000], [1, 2, 900])]
    np.testing.assert_array_equal(np.concatenate(pieces), (wrong + truth)[:5000])


def spectrum(kind, **settings):
    wrong = NoiseSource(Noise(kind, 1.0, **settings), 3).next(2**17)
    power = np.abs(np.fft.rfft(wrong.reshape(64, -1))) ** 2
    return np.fft.rfftfreq(2048), power.mean(axis=0)


def test_noise_has_the_colour_of_its_kind():
    _, white = spectrum(NoiseKind.WHITE)
    assert white[5:200].mean() == pytest.approx(white[-200:].mean(), rel=0.1)
    _, coloured = spectrum(NoiseKind.COLOURED, correlation=8.0)
    assert coloured[5:20].mean() > 50.0 * coloured[-200:].mean()
    frequency, flicker = spectrum(NoiseKind.FLICKER)
    inside = (frequency > 0.004) & (frequency < 0.1)
    order = np.polyfit(np.log(frequency[inside]), np.log(flicker[inside]), 1)[0]
    assert order == pytest.approx(-1.0, abs=0.25)


def test_quantised_readings_are_few_values():
    noise = Noise(NoiseKind.QUANTISED, 1.0)
    read = NoiseSource(noise, 0).read(np.linspace(0.0, 30.0, 1000))
    np.testing.assert_allclose(read / noise.step, np.rint(read / noise.step), atol=1e-9)
    assert np.unique(read).size < 15


def settled(rig, u):
    """The readings of a device that has rested at the first command for two seconds."""
    return rig.respond(np.concatenate([np.full(100, u[0]), u]))[100:]


def test_the_refit_absorbs_what_its_parameters_can_and_nothing_else():
    kind = DEVICES["drive"]
    plain = kind.plain(BENCH, {})
    u = commands(2000, seed=4)
    yardstick = Yardstick(kind, plain, u, 50.0, 0.05)
    changed = plain.changed({"damping": 1.2, "stiffness": 0.9})
    reading = 1.1 * settled(TrialRig(changed, [], 50.0), u) + 3.0
    assert yardstick.unexplained(reading) / 0.05 < 0.5
    assert yardstick.strength([]) < 1e-6
    assert yardstick.strength([built("transport_delay", "pure_delay", 0.1)[0]]) > 20.0


def test_the_strength_agrees_with_an_independent_refit():
    from scipy.optimize import least_squares

    kind = DEVICES["drive"]
    plain = kind.plain(BENCH, {})
    u = commands(1000, seed=4)
    conditions = Yardstick(kind, plain, u, 50.0, 0.05).conditions()

    def laws():
        return [built("end_stop", "rubber_bumper", 0.2, 0, conditions)[0]]

    reading = settled(TrialRig(plain, laws(), 50.0), u)

    def left(parameters):
        factors = dict(zip(kind.free, np.exp(parameters), strict=True))
        model = settled(TrialRig(plain.changed(factors), [], 50.0), u)
        slope, offset = np.polyfit(model, reading, 1)
        return reading - slope * model - offset

    fit = least_squares(left, np.zeros(2), x_scale=0.1, max_nfev=25)
    expected = np.sqrt(2.0 * fit.cost / reading.size) / 0.05
    assert Yardstick(kind, plain, u, 50.0, 0.05).strength(laws()) == pytest.approx(
        expected, rel=0.1
    )


def test_conditions_say_what_the_excitation_does():
    kind = DEVICES["drive"]
    u = np.tile(np.repeat([1.0, 4.0], 100), 5)
    found = Yardstick(kind, kind.plain(BENCH, {}), u, 50.0, 0.05).conditions()
    assert (found.low, found.high) == (1.0, 4.0)
    assert found.duration == pytest.approx(20.0)
    assert found.cycles == pytest.approx(5.0, abs=4.0)
    assert found.stiffness == Drive().stiffness
    assert type(found) is type(CONDITIONS)


def test_swings_count_as_their_share_of_the_travel():
    kind, ends = DEVICES["drive"], [1.0, 4.0, 2.0, 3.0, 1.0, 2.5, 1.6]
    # So slow that the angle follows the command; the last swing has not ended.
    u = np.interp(np.arange(60 * 50) / 50.0, np.arange(7) * 10.0, ends)
    found = Yardstick(kind, kind.plain(BENCH, {}), u, 50.0, 0.05).conditions()
    assert found.cycles == 2.5
    assert found.full_cycles == pytest.approx(0.5 * (3.0 + 2.0 + 1.0 + 2.0 + 1.5) / 3.0, rel=0.02)


@pytest.mark.parametrize("form", ["three_stages", "power_of_cycles", "saturating_cycles"])
def test_softening_by_cycles_reaches_its_size_within_a_record(form):
    kind = DEVICES["drive"]
    u = design("gaussian", duration=60.0, sampling_rate=50.0, low=1.0, high=4.0, band=1.5, seed=3)
    yardstick = Yardstick(kind, kind.plain(BENCH, {}), u, 50.0, 0.05)
    conditions = yardstick.conditions()
    law, _ = built("cyclic_softening", form, 0.2, 0, conditions)
    lost = -resist(law, yardstick.response)[-1] / (law.constants[0] * yardstick.response[-1])
    assert lost == pytest.approx(0.2, rel=0.05)
