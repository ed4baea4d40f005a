"""A device whose clock is not the described one is flagged."""

from dataclasses import replace

import numpy as np
import pytest

from dea.acquisition.device_clock import fitted_rate, flag_clock
from dea.acquisition.samples import DrivenSamples, Quality
from dea.modbus import read_device
from served_bench import DESCRIPTION

DEVICE = read_device(DESCRIPTION)


def played(rate, seconds=60.0, block=55):
    """Samples of a device with that rate, read in blocks with some delay."""
    index = np.arange(round(rate * seconds) // block * block)
    delay = np.random.default_rng(1).uniform(0.0, 0.05, index.size // block)
    read = np.repeat((index[block - 1 :: block] + 1) / rate + delay, block)
    zero = np.zeros(index.size, int)
    return DrivenSamples(
        index, index + 7, zero, zero, zero, zero, np.full(index.size, np.nan), read
    )


@pytest.mark.parametrize("rate", [50.0, 51.0, 47.3])
def test_the_rate_is_found_in_spite_of_blocks_and_delays(rate):
    assert fitted_rate(played(rate)) == pytest.approx(rate, rel=1e-3)


def test_a_short_record_says_nothing():
    assert fitted_rate(played(50.0, seconds=10.0)) is None


@pytest.mark.parametrize(("rate", "flagged"), [(50.2, False), (49.8, False), (51.0, True)])
def test_every_sample_is_flagged_beyond_the_tolerance(rate, flagged):
    quality = flag_clock(DEVICE, played(rate), 0.01).quality
    assert ((quality & Quality.CLOCK) > 0).all() == flagged
    assert ((quality & Quality.CLOCK) > 0).any() == flagged
    assert not flag_clock(replace(DEVICE, virtual=True), played(rate), 0.01).quality.any()


def test_what_the_host_paced_has_the_hosts_clock():
    samples = played(51.0)
    assert fitted_rate(samples._replace(write_time=samples.read_time - 0.001)) is None
