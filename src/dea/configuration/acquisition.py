"""How an actuator is driven and recorded: ``actuators``, ``acquisition`` and ``bench``."""

from typing import Literal

from dea.configuration.safety import Mode
from dea.configuration.section import Name, NotNegative, Number, Positive, Section, Whole, key


class Actuator(Section):
    """An actuator under study, driven over Modbus as its device description says."""

    name: Name = key("name of its folder of results")
    device: str = key("file of its device description")
    bench: str | None = key(
        "virtual actuator of config/bench.yaml that answers at a free local port; without it the"
        " endpoint of the device description does",
        default=None,
    )
    record: str | None = key(
        "folder below records/NAME of the record to study; the newest where it is not given",
        default=None,
    )
    second_record: str | None = key(
        "the same of the record with the second excitation", default=None
    )
    probed_record: str | None = key("the same of the record with multisines in it", default=None)


class Acquisition(Section):
    """How an actuator is driven and recorded (docs/acquisition.md)."""

    mode: Mode = key(
        "buffered: the device plays blocks from its FIFO; polled: the host sends every sample"
    )
    ramp_rate: Number = key("slope of the ramps to and from the bias", unit="V/s", ge=1e-3, le=1e3)
    on_break: Literal["stop", "restart"] = key(
        "what to do where samples are lost or the film was left undriven"
    )
    restarts: Whole = key("how often to start again, where on_break is restart", ge=0)
    timeout: Number = key("longest wait for a reply", unit="s", ge=1e-3)
    retries: Whole = key("repetitions of a request, each over a fresh connection", ge=0)
    reconnect_time: NotNegative = key(
        "how long to try to reach a device that has gone, or that says it is busy", unit="s"
    )
    late_after: Positive = key(
        "delay behind its deadline from which a polled sample is flagged late", unit="s"
    )
    clock_tolerance: Positive = key(
        "share by which the sampling rate of a buffered device may differ from the described one,"
        " by the host's clock; beyond it every sample is flagged",
        default=0.01,
    )
    armed_by: str = key(
        "who has armed the high voltage, kept in the record; needed where the device description"
        " has a `safety` section",
        default="",
    )
    stall_time: Positive = key(
        "how far the recorder or its disk may be behind, or the guardian held up, before the output"
        " is taken to zero",
        unit="s",
        default=5.0,
    )
    read_back_tolerance: Number = key(
        "difference of the applied output that is read from what is played, as a share of the span"
        " of the output's limits, up to which the register is trusted; what an amplifier's monitor"
        " may be off",
        default=0.05,
        gt=0,
        le=0.25,
    )


class Bench(Section):
    """Virtual actuators alone."""

    watchdog_time: Positive = key(
        "silence of the host after which the output goes to zero", unit="s"
    )
