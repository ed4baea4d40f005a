import numpy as np
import pytest

from dea.errors import InputError
from dea.probing import Probing

RATE = 50.0
PROBING = Probing(
    times=[20.0, 60.0], bias=2.4, rms=0.1, lowest=0.2, highest=10.0, band=1.0, realisations=2,
    periods=3, settle=2.0,
)  # fmt: skip


@pytest.fixture(scope="module")
def probed():
    random = np.random.default_rng(0).uniform(1.1, 3.75, 6000)
    return random, PROBING.place(random, RATE, seed=1)


def spectra(probed):
    """Spectra of every period, shape (stretches * realisations * periods, harmonics)."""
    inside = probed.realisation > 0
    return np.fft.rfft(probed.voltage[inside].reshape(-1, 250)) / 250


def test_lines_are_odd_and_one_of_four_is_left_out():
    lines = Probing(times=[0.0], bias=0.0, rms=1.0).lines(3)
    assert (lines % 2 == 1).all()
    assert lines[0] == 1
    assert lines[-1] <= 400
    # Ten odd lines up to 1 Hz, of which one in each whole group of four is not excited.
    assert (lines < 20).sum() in (7, 8)
    assert (np.diff(lines[lines > 40]) >= 0.07 * lines[lines > 40][:-1]).all()
    assert not np.array_equal(lines, Probing(times=[0.0], bias=0.0, rms=1.0).lines(4))


def test_whole_periods_hold_the_lines_and_nothing_else(probed):
    _, found = probed
    lines = PROBING.lines(1)
    amplitude = 2 * np.abs(spectra(found))
    np.testing.assert_allclose(amplitude[:, 0], 2 * 2.4)
    others = np.setdiff1d(np.arange(1, 126), lines)
    assert amplitude[:, others].max() < 1e-12
    inside = lines <= 5
    np.testing.assert_allclose(amplitude[:, lines[inside]], amplitude[0, 1])
    np.testing.assert_allclose(amplitude[:, lines[~inside]], amplitude[0, 1] / 3)
    np.testing.assert_allclose(0.5 * (amplitude[:, 1:] ** 2).sum(axis=1), 0.1**2)


def test_periods_repeat_and_realisations_differ_in_phase(probed):
    found = spectra(probed[1])[:, PROBING.lines(1)].reshape(4, 3, -1)
    assert np.abs(found - found[:, :1]).max() < 1e-12
    phases = np.angle(found[:, 0])
    for first in range(4):
        for other in range(first):
            assert np.abs(phases[first] - phases[other]).max() > 0.5


def test_stretches_stand_where_they_are_asked_for_and_nothing_else_is_touched(probed):
    random, found = probed
    length = round(2 * (2 + 15) * RATE)
    passage = 50
    changed = found.voltage != random
    for number, time in ((1, 20.0), (2, 60.0)):
        begin = round(time * RATE)
        stretch = slice(begin, begin + length + passage)
        assert changed[stretch].all()
        changed[stretch] = False
        np.testing.assert_array_equal(
            np.flatnonzero(found.probing == number)[[0, -1]], [begin + 100, begin + length - 1]
        )
    assert not changed.any()
    assert ((found.probing > 0) == (found.realisation > 0)).all()


def test_each_realisation_has_settled_before_its_periods(probed):
    _, found = probed
    first = int(np.flatnonzero(found.realisation == 2)[0])
    np.testing.assert_allclose(
        found.voltage[first - 100 : first], found.voltage[first + 150 : first + 250]
    )


def test_the_passage_stays_between_excitation_and_multisine():
    found = PROBING.place(np.full(6000, 1.1), RATE, seed=1)
    jumps = np.abs(np.diff(found.voltage))
    assert jumps.max() < 0.2
    assert found.voltage.min() >= 1.1


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"times": [20.0, 40.0]}, "times"),
        ({"times": [110.0]}, "times"),
        ({"lowest": 0.3}, "lowest"),
        ({"settle": 0.9}, "settle"),
        ({"highest": 25.0}, "highest"),
    ],
)
def test_what_does_not_fit_is_named(change, field):
    probing = Probing(**{**vars(PROBING), **change})
    with pytest.raises(InputError, match=field):
        probing.place(np.zeros(6000), RATE, seed=1)


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"realisations": 0}, "realisations"),
        ({"periods": 1.5}, "periods"),
        ({"lowest": 0.0}, "lowest"),
        ({"lowest": 5.0, "highest": 4.0}, "lowest"),
        ({"highest": np.inf}, "lowest"),
    ],
)
def test_stretches_without_a_multisine_are_refused(change, field):
    with pytest.raises(InputError) as caught:
        Probing(**{**vars(PROBING), **change})
    assert caught.value.field == f"excitation.probing.{field}"
