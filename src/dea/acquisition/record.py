"""The datasets ``record.nc`` and ``link.nc``, from samples and the link's log."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from dea.acquisition.device_clock import fitted_rate, flag_clock
from dea.acquisition.link_log import LinkLog
from dea.acquisition.read_back import read_back_register
from dea.acquisition.samples import DrivenSamples, Quality
from dea.acquisition.sensor_flags import flag_sensor
from dea.modbus import Device, Register, to_physical

if TYPE_CHECKING:
    import xarray as xr

_EDGES = np.geomspace(1e-5, 10.0, 61)  # s, ten bins per decade
Variable = tuple[str, np.ndarray, dict[str, str]]


def kept_record(
    device: Device,
    samples: DrivenSamples,
    lead: int,
    length: int,
    *,
    clock_tolerance: float,
    armed_by: str,
) -> "xr.Dataset":
    """Return :func:`record_dataset` of samples that are flagged where the device's clock is off.

    It says who has armed the device, if anybody has, and holds the description of the device as it
    was driven: the file may have been edited since.
    """
    flagged = flag_clock(device, samples, clock_tolerance)
    record = record_dataset(device, flagged, lead, length)
    armed = {"armed_by": armed_by} if armed_by else {}
    return record.assign_attrs(armed | {"device_description": device.described})


def record_dataset(device: Device, samples: DrivenSamples, lead: int, length: int) -> "xr.Dataset":
    """Return what was measured during the excitation, in physical units.

    Parameters
    ----------
    samples
        Everything measured, ramps included.
    lead, length
        Number of samples of the ramp before the excitation, and of the excitation.

    Returns
    -------
    Dataset over ``time`` (s, 0 at the excitation's first sample). Lost samples hold NaN.
    """
    # Here, since a guardian imports this room too, and has no dataset.
    import xarray as xr

    inside = (samples.position >= lead) & (samples.position < lead + length)
    driven = flag_sensor(device, DrivenSamples(*(column[inside] for column in samples)))
    time = (driven.device_index - driven.device_index[:1]) / device.sampling_rate
    have = (driven.quality & Quality.LOST) == 0
    output, displacement = device["output"], device["displacement"]
    read_back = read_back_register(device)
    echo = read_back or output  # where nothing is read back, what was written stands for it
    shown, raw = "as the device echoed it", "raw applied output"
    if read_back is None and "reply_samples" not in device:
        shown, raw = "as written: the device echoes none", "raw output as written"
    meanings = " ".join(flag.name.lower() for flag in Quality if flag.name)

    def variable(values: np.ndarray, units: str, long_name: str) -> Variable:
        return "time", values, {"units": units, "long_name": long_name}

    dataset = xr.Dataset(
        {
            "voltage": variable(
                np.where(have, to_physical(echo, driven.applied), np.nan), echo.unit,
                f"applied output before the amplifier, {shown}",
            ),
            "displacement": variable(
                np.where(have, to_physical(displacement, driven.displacement), np.nan),
                displacement.unit, "displacement",
            ),
            "voltage_requested": variable(
                to_physical(output, driven.requested), output.unit, "output asked for"
            ),
            "voltage_counts": variable(_raw(echo, driven.applied), "count", raw),
            "displacement_counts": variable(
                _raw(displacement, driven.displacement), "count", "raw displacement"
            ),
            "device_index": variable(driven.device_index, "1", "sample index of the device"),
            "quality": variable(driven.quality.astype(np.uint8), "1", "quality flags, 0 is good"),
        },
        coords={"time": variable(np.asarray(time, float), "s", "time")},
    )  # fmt: skip
    dataset["quality"].attrs |= {
        "flag_masks": np.array([flag.value for flag in Quality if flag], np.uint8),
        "flag_meanings": meanings,
    }
    dataset.attrs["sampling_rate"] = device.sampling_rate
    return dataset


def _raw(register: Register, values: np.ndarray) -> np.ndarray:
    """Return raw values as the device has them."""
    return np.asarray(values, float if "float" in register.type else np.int64)


def link_dataset(log: LinkLog, samples: DrivenSamples) -> "xr.Dataset":
    """Return the times of every exchange and sample, retries, errors, round trips and jitter."""
    import xarray as xr

    send, receive = np.asarray(log.send_time), np.asarray(log.receive_time)
    counts, _ = np.histogram(receive - send, _EDGES)

    def over(dim: str, values: ArrayLike, units: str, long_name: str) -> Variable:
        return dim, np.asarray(values), {"units": units, "long_name": long_name}

    kinds = sorted(log.errors)
    return xr.Dataset(
        {
            "send_time": over("exchange", send, "s", "request sent, since the start"),
            "receive_time": over("exchange", receive, "s", "reply received, since the start"),
            "samples": over("exchange", log.samples, "1", "samples the reply carried"),
            "retries": over("exchange", log.retries, "1", "repetitions before the reply"),
            "round_trip_count": over("round_trip_bin", counts, "1", "exchanges in the bin"),
            "round_trip_low": over("round_trip_bin", _EDGES[:-1], "s", "lower edge of the bin"),
            "round_trip_high": over("round_trip_bin", _EDGES[1:], "s", "upper edge of the bin"),
            "device_index": over("sample", samples.device_index, "1", "sample index of the device"),
            "write_time": over("sample", samples.write_time, "s", "written, since the start"),
            "read_time": over("sample", samples.read_time, "s", "had been read, since the start"),
            "jitter": over("polled_sample", log.jitter, "s", "lateness behind the deadline"),
            "errors": over("kind", [log.errors[k] for k in kinds], "1", "failures of this kind"),
            "error_kind": over("kind", np.array(kinds, dtype=object), "1", "kind of failure"),
            "reconnects": ((), log.reconnects, {"units": "1", "long_name": "reconnections"}),
            "fitted_rate": (
                (),
                np.nan if (rate := fitted_rate(samples)) is None else rate,
                {"units": "Hz", "long_name": "the device's sampling rate by the host's clock"},
            ),
        }
    )
