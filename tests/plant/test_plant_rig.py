"""The whole rig: determinism, instruments, and bad configurations."""

import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import signal

from changed_content import REMOVED, changed
from dea.errors import InputError
from dea.excitation import design
from dea.modbus import read_device, to_counts, to_physical
from dea.plant import Rig
from dea.plant.amplifier import Amplifier, amplify
from dea.plant.converter import Converter
from dea.plant.parameters import read_parameters, read_plain
from dea.plant.sensor import AntiAliasFilter

CONFIG = Path(__file__).parents[2] / "config" / "bench.yaml"
ACTUATORS = list(yaml.safe_load(CONFIG.read_text())["actuators"])
VOLT = 65535 / 15.0  # output counts


def excitation(seconds, seed=0):
    volts = design("gaussian", duration=seconds, sampling_rate=50.0, low=1.1, high=3.75, seed=seed)
    return np.rint(volts * VOLT).astype(np.uint16)


@pytest.mark.slow
@settings(deadline=None, max_examples=25)
@given(cuts=st.lists(st.integers(0, 300), max_size=12), actuator=st.sampled_from(ACTUATORS))
def test_what_is_measured_does_not_depend_on_how_the_samples_are_cut(cuts, actuator):
    counts = excitation(6.0)
    whole = Rig.from_config(CONFIG, actuator, seed=5)
    applied, measured = whole.advance(counts)
    pieces = Rig.from_config(CONFIG, actuator, seed=5)
    answers = [pieces.advance(piece) for piece in np.split(counts, sorted(cuts))]
    np.testing.assert_array_equal(applied, np.concatenate([answer[0] for answer in answers]))
    np.testing.assert_array_equal(measured, np.concatenate([answer[1] for answer in answers]))
    whole, pieces = (Rig.from_config(CONFIG, actuator, seed=5) for _ in range(2))
    truths = [pieces.drive(piece) for piece in np.split(counts, sorted(cuts))]
    for each, parts in zip(whole.drive(counts), zip(*truths, strict=True), strict=True):
        np.testing.assert_array_equal(each, np.concatenate(parts))


def test_one_sample_at_a_time_is_the_same_and_cheap():
    counts = excitation(40.0)
    whole = Rig.from_config(CONFIG, "dea1", seed=5)
    _, measured = whole.advance(counts)
    single = Rig.from_config(CONFIG, "dea1", seed=5)
    answers, ratios = [], []
    few = np.arange(8.0)
    for count in counts:
        start = time.process_time()
        answers.append(single.advance(np.array([count]))[1])
        ended = time.process_time()
        for _ in range(100):
            few + few
        ratios.append((ended - start) / (time.process_time() - ended))
    # In additions of eight numbers beside each sample: whatever slows the processor slows both.
    assert np.median(ratios) < 4.0
    np.testing.assert_array_equal(measured, np.concatenate(answers))


def test_a_displacement_answers_to_the_outputs_before_it_and_never_to_its_own():
    counts = excitation(4.0)
    changed = counts.copy()
    changed[100:] += 3000
    first, second = (Rig.from_config(CONFIG, "dea1", 5).advance(c)[1] for c in (counts, changed))
    np.testing.assert_array_equal(first[:101], second[:101])
    assert abs(int(first[104]) - int(second[104])) > 50


@pytest.mark.slow
@pytest.mark.parametrize("actuator", ACTUATORS)
def test_half_an_hour_stays_whole_and_in_range(actuator):
    rig = Rig.from_config(CONFIG, actuator, seed=1)
    _, measured = rig.advance(excitation(1800.0))
    assert rig.fault == 0
    assert measured.min() > 0
    assert measured.max() < 65535
    displacement = measured * (10 / 65535)
    assert 0.03 < displacement[:5000].std() < 0.5


@pytest.mark.slow
def test_the_second_actuator_sinks_and_the_sixth_rises():
    """As the measured ones of these numbers did, under the same excitation over and over."""
    counts = np.tile(excitation(200.0), 9)
    drifts = {}
    for actuator in ("dea2", "dea6"):
        rig = Rig.from_config(CONFIG, actuator, seed=1)
        means = rig.advance(counts)[1].reshape(9, -1).mean(axis=1)
        drifts[actuator] = means[-1] / means[0] - 1.0
    assert drifts["dea2"] < -0.05
    assert drifts["dea6"] > 0.05


def test_seeds_change_the_noise_alone():
    counts = excitation(20.0)
    first, second = Rig.from_config(CONFIG, "dea1", 1), Rig.from_config(CONFIG, "dea1", 2)
    difference = first.advance(counts)[1].astype(int) - second.advance(counts)[1].astype(int)
    first, second = Rig.from_config(CONFIG, "dea1", 1), Rig.from_config(CONFIG, "dea1", 2)
    np.testing.assert_array_equal(first.respond(counts), second.respond(counts))
    noise = read_parameters(CONFIG, "dea1").sensor.noise
    assert difference.std() * 10e-3 / 65535 == pytest.approx(np.sqrt(2) * noise, rel=0.06)


def test_after_the_voltage_the_film_returns():
    rig = Rig.from_config(CONFIG, "dea1", seed=1)
    before = rig.advance(np.zeros(50, np.uint16))[1].mean()
    rig.advance(np.full(50, 3.0 * VOLT, np.uint16))
    assert rig.applied_count == int(3.0 * VOLT)
    after = rig.advance(np.zeros(500, np.uint16))[1][-50:].mean()
    assert rig.applied_count == rig.zero_count == 0
    assert after == pytest.approx(before, rel=0.02)


def test_a_film_pulled_in_is_a_fault_and_still_measured(tmp_path):
    """It sinks until it is shorted, and springs back: the film holds the ball without voltage."""
    rig = Rig.from_config(
        bench_changed(tmp_path, ["actuators", "dea1", "prestretch"], 3.4), "dea1", 1
    )
    _, measured = rig.advance(np.full(500, 8.0 * VOLT, np.uint16))
    assert rig.fault == 1
    assert measured.max() > 1.05 * measured[0]
    assert measured[-50:].mean() == pytest.approx(measured[0], rel=0.01)


def test_the_converter_rounds_and_clips():
    converter = Converter(0.0, 10.0)
    np.testing.assert_array_equal(
        converter.to_counts(np.array([-1.0, 0.0, 2.0, 9.9999, 12.0])), [0, 0, 13107, 65534, 65535]
    )
    counts = np.arange(65536).astype(np.uint16)
    np.testing.assert_array_equal(converter.to_counts(converter.to_values(counts)), counts)


@pytest.mark.parametrize("name", ["output", "displacement"])
def test_every_count_means_the_same_to_the_bench_and_to_its_description(name):
    """To the last bit: a count is read from, and written to, the two by different code."""
    converter = getattr(read_parameters(CONFIG, "dea1"), f"{name}_converter")
    register = read_device(CONFIG.parent / "devices" / "virtual_bench.yaml")[name]
    counts = np.arange(65536).astype(np.uint16)
    np.testing.assert_array_equal(converter.to_values(counts), to_physical(register, counts))
    np.testing.assert_array_equal(
        converter.to_counts(converter.to_values(counts)),
        to_counts(register, converter.to_values(counts)),
    )


def test_the_amplifier_keeps_its_limits():
    amplifier = Amplifier(800.0, 12e3, 1e6, 1e-3, 0.5e-9, 1e5)
    supply = np.empty(60)
    output = np.zeros(1)
    amplify(amplifier, output, 1.5e-9, np.repeat([20.0, -3.0], 30), supply)
    rate = np.diff(np.concatenate([[0.0], supply])) / 1e-3
    assert rate[:24] == pytest.approx(1e-3 / 2e-9)  # the current limit, 500 V/ms
    assert supply[24:30] == pytest.approx(12e3)
    assert supply.min() >= 0.0
    assert output[0] == supply[-1]
    amplify(
        amplifier._replace(current_limit=1.0), np.zeros(1), 1.5e-9, np.full(3, 20.0), supply[:3]
    )
    assert supply[0] == pytest.approx(1000.0)  # the slew rate


def test_the_amplifier_follows_with_a_lag_of_its_bandwidth():
    slow = Amplifier(800.0, 12e3, 1e9, 1.0, 0.5e-9, 10.0)
    supply, output = np.empty(80), np.zeros(1)
    amplify(slow, output, 1.5e-9, np.full(80, 2.0), supply)
    t = np.arange(1, 81) * 1e-3
    np.testing.assert_allclose(supply, 1600.0 * (1.0 - np.exp(-2 * np.pi * 10.0 * t)))
    amplify(slow, output, 1.5e-9, np.zeros(80), supply)
    np.testing.assert_allclose(supply, output[0] * np.exp(2 * np.pi * 10.0 * (t[-1] - t)))


def test_the_amplifier_falls_no_faster_than_it_rises():
    amplifier = Amplifier(800.0, 12e3, 2e5, 1.0, 0.0, 1e5)
    supply, output = np.empty(30), np.full(1, 3000.0)
    amplify(amplifier, output, 1e-9, np.zeros(30), supply)
    np.testing.assert_allclose(supply, np.maximum(2800.0 - 200.0 * np.arange(30), 0.0), atol=1e-9)


def test_the_sensor_reads_the_ends_of_its_range_beyond_it():
    plain = read_plain(CONFIG)
    counts = np.full(300, 3.5 * VOLT, np.uint16)
    free = Rig(plain, seed=1).respond(counts)
    low, high = np.quantile(free, [0.01, 0.4])
    sensor = plain.sensor._replace(range_low=low, range_high=high)
    read = Rig(replace(plain, sensor=sensor), seed=1).respond(counts)
    np.testing.assert_array_equal(read, np.clip(free, low, high))
    assert (read == low).any()
    assert (read == high).any()


def test_the_anti_alias_filter_is_a_butterworth():
    constant = AntiAliasFilter(15.0, 0.7)
    np.testing.assert_allclose(constant.advance(np.full(50, 0.7)), 0.7, rtol=1e-12)
    noise = np.random.default_rng(0).standard_normal(400)
    b, a = signal.butter(2, 15.0, fs=1000.0)
    pieces = AntiAliasFilter(15.0, 0.0)
    filtered = [pieces.advance(piece) for piece in np.split(noise, [0, 1, 100])]
    np.testing.assert_allclose(np.concatenate(filtered), signal.lfilter(b, a, noise), atol=1e-12)
    _, response = signal.freqz(b, a, [15.0], fs=1000.0)
    assert np.abs(response[0]) == pytest.approx(np.sqrt(0.5))


def bench_changed(folder, keys, value):
    path = folder / "bench.yaml"
    path.write_text(yaml.safe_dump(changed(yaml.safe_load(CONFIG.read_text()), keys, value)))
    return path


@pytest.mark.parametrize(
    ("keys", "value", "field"),
    [
        (["film", "mas"], {"value": 1.0, "unit": "kg", "source": ""}, "film.mas"),
        (["film", "mass"], REMOVED, "film.mass"),
        (["film", "mass", "unit"], "g", "film.mass.unit"),
        (["film", "mass", "value"], "heavy", "film.mass.value"),
        (["film", "mass", "value"], -3.0, "film.mass.value"),
        (["film", "mass", "value"], True, "film.mass.value"),
        (["film", "mass", "value"], float("nan"), "film.mass.value"),
        (["film", "mass", "value"], [3e-3], "film.mass.value"),
        (["film", "branch_time", "value"], [1.0, 2.0], "film.branch_time"),
        (["film", "branch_time", "value"], 4.0, "film.branch_time.value"),
        (["film", "frame_radius", "value"], 2e-3, "film"),
        (["film", "electrode_radius", "value"], 1e-3, "film"),
        (["actuators", "dea1", "contact_radius"], 30e-3, "actuators.dea1"),
        (["actuators", "dea1", "prestrech"], 2.5, "actuators.dea1.prestrech"),
        (["actuators", "dea1", "prestretch"], 9.0, "actuators.dea1.prestretch"),
        (["actuators", "dea1"], REMOVED, "actuators"),
        (["actuators", "dea1"], [1.0], "actuators.dea1"),
        (["amplifier"], 3.0, "amplifier"),
        (["lasers"], {}, "lasers"),
        (["output_converter", "high", "value"], -1.0, "output_converter"),
    ],
)
def test_a_wrong_configuration_is_named(tmp_path, keys, value, field):
    path = bench_changed(tmp_path, keys, value)
    with pytest.raises(InputError) as error:
        Rig.from_config(path, "dea1", 1)
    assert error.value.field == field
    assert error.value.file == path
    assert error.value.remedy


@pytest.mark.parametrize(
    ("keys", "value", "field"),
    [
        (["plain", "film", "dampin"], 3.0, "plain.film.dampin"),
        (["plain", "film", "damping"], -3.0, "plain.film.damping"),
        (["plain", "lens"], {}, "plain.lens"),
        (["plain", "sensor"], 3.0, "plain.sensor"),
        (["plain"], REMOVED, "plain"),
    ],
)
def test_a_wrong_plain_actuator_is_named(tmp_path, keys, value, field):
    with pytest.raises(InputError) as error:
        read_plain(bench_changed(tmp_path, keys, value))
    assert error.value.field == field


def test_the_plain_actuator_has_ideal_instruments():
    plain = Rig(read_plain(CONFIG), seed=1)
    displacement = plain.respond(np.full(500, 3.0 * VOLT, np.uint16))
    truth, film_voltage, _ = plain.drive(np.full(500, 3.0 * VOLT, np.uint16))
    assert displacement[-1] == pytest.approx(truth[-truth.size // 500], rel=1e-6)
    np.testing.assert_allclose(film_voltage, 800.0 * int(3.0 * VOLT) / VOLT, rtol=1e-9)


def test_an_unreadable_configuration_is_named(tmp_path):
    path = tmp_path / "bench.yaml"
    with pytest.raises(InputError, match=r"bench\.yaml: the bench configuration cannot be read"):
        Rig.from_config(path, "dea1", 1)
    path.write_text("film: [unclosed")
    with pytest.raises(InputError, match="not valid YAML"):
        Rig.from_config(path, "dea1", 1)
    path.write_text("just words")
    with pytest.raises(InputError, match="Give a mapping with the keys film, amplifier"):
        Rig.from_config(path, "dea1", 1)


def test_a_film_that_cannot_carry_the_mass_is_refused(tmp_path):
    with pytest.raises(InputError, match="does not carry the mass"):
        Rig.from_config(bench_changed(tmp_path, ["film", "mass", "value"], 0.9), "dea1", 1)
