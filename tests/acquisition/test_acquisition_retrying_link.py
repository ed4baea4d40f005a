"""How often a request is sent when its reply does not come."""

import time
from dataclasses import replace

import numpy as np
import pytest
from memory_link import Clock
from pymodbus.exceptions import ModbusIOException
from pymodbus.pdu import ExceptionResponse
from pymodbus.pdu.register_message import ReadHoldingRegistersResponse

from dea.acquisition import DeviceRefusedError, Link, LinkError, LinkSettings, StoppedError
from dea.acquisition.link_log import LinkLog
from dea.acquisition.panel import Panel
from dea.acquisition.retrying_link import LONGEST_SLEEP
from dea.modbus import read_device
from served_bench import DESCRIPTION

RETRIES = 3
SETTINGS = LinkSettings(timeout=0.1, retries=RETRIES, reconnect_time=0.1)


@pytest.fixture
def clock(monkeypatch):
    made = Clock()
    monkeypatch.setattr("dea.acquisition.retrying_link.time", made)
    return made


class SilentClient:
    """Takes every request and never replies."""

    def __init__(self):
        self.requests = []

    def execute(self, no_response_expected, request):
        self.requests.append(request)
        raise ModbusIOException("No response received")

    def close(self):
        pass


@pytest.fixture
def silent(monkeypatch):
    client = SilentClient()
    monkeypatch.setattr("dea.acquisition.retrying_link.connect", lambda device, timeout: client)
    return client


@pytest.mark.parametrize(("retry", "sent"), [(False, 1), (True, RETRIES + 1)])
@pytest.mark.parametrize("read_write_multiple", [True, False])
@pytest.mark.parametrize(
    "ask",
    [
        lambda link, retry: link.write(35, [1], retry=retry),
        lambda link, retry: link.write(35, [1, 2], retry=retry),
        lambda link, retry: link.read_write(60, 2, 35, [1], retry=retry),
        lambda link, retry: Panel(link).set("output", 1, retry=retry),
    ],
    ids=["one register", "two registers", "write and read", "by name"],
)
def test_a_request_is_repeated_as_often_as_the_caller_allows(
    silent, ask, read_write_multiple, retry, sent
):
    device = replace(read_device(DESCRIPTION), read_write_multiple=read_write_multiple)
    with pytest.raises(LinkError, match=f"no valid reply after {sent} attempts"):
        ask(Link(device, SETTINGS), retry)
    assert len(silent.requests) == sent


class BusyClient:
    """Refuses with an exception code for a while, then answers."""

    def __init__(self, code, length):
        self.code, self.until, self.requests = code, time.monotonic() + length, 0

    def execute(self, no_response_expected, request):
        self.requests += 1
        if time.monotonic() < self.until:
            return ExceptionResponse(request.function_code, self.code)
        return ReadHoldingRegistersResponse(registers=[7] * request.count)

    def close(self):
        pass


def read_from(monkeypatch, client, reconnect_time):
    monkeypatch.setattr("dea.acquisition.retrying_link.connect", lambda device, timeout: client)
    link = Link(read_device(DESCRIPTION), replace(SETTINGS, reconnect_time=reconnect_time))
    return link.read(0, 2)


@pytest.mark.parametrize("code", [5, 6, 10, 11])
def test_a_busy_device_is_asked_again_for_as_long_as_a_lost_one(monkeypatch, code):
    client = BusyClient(code, length=0.6)
    assert read_from(monkeypatch, client, reconnect_time=30.0) == [7, 7]
    assert client.requests > RETRIES + 1


@pytest.mark.parametrize(("code", "asked"), [(4, RETRIES + 1), (2, RETRIES + 1)])
def test_any_other_refusal_ends_the_request_after_its_retries(monkeypatch, code, asked):
    client = BusyClient(code, length=30.0)
    with pytest.raises(DeviceRefusedError, match=f"exception {code}"):
        read_from(monkeypatch, client, reconnect_time=30.0)
    assert client.requests == asked


def test_a_device_that_stays_busy_is_given_up(monkeypatch):
    with pytest.raises(DeviceRefusedError, match="exception 6"):
        read_from(monkeypatch, BusyClient(6, length=30.0), reconnect_time=0.3)


class RefusingClient:
    """Refuses the first requests as busy; each reply takes a while of the clock."""

    def __init__(self, clock, refused, reply):
        self.clock, self.left, self.reply, self.sent = clock, refused, reply, []

    def execute(self, no_response_expected, request):
        self.sent.append(self.clock.now)
        self.clock.sleep(self.reply)
        self.left -= 1
        if self.left >= 0:
            return ExceptionResponse(request.function_code, 6)
        return ReadHoldingRegistersResponse(registers=[7] * request.count)

    def close(self):
        pass


def test_the_round_trip_is_that_of_the_attempt_that_was_answered(clock, monkeypatch):
    client = RefusingClient(clock, refused=2, reply=0.001)
    monkeypatch.setattr("dea.acquisition.retrying_link.connect", lambda device, timeout: client)
    link = Link(read_device(DESCRIPTION), SETTINGS, LinkLog(started=0.0))
    assert link.read(0, 2) == [7, 7]
    assert link.log.retries == [2]
    assert link.log.send_time == client.sent[-1:]
    assert link.log.receive_time == pytest.approx([client.sent[-1] + 0.001])


def test_a_rest_lasts_its_whole_time_and_checks_meanwhile(clock):
    checked = []
    link = Link(read_device(DESCRIPTION), SETTINGS)
    link.check = lambda: checked.append(clock.now)
    link.rest(1.0)
    assert clock.now == pytest.approx(1.0)
    assert checked[-1] == clock.now
    assert max(np.diff([0.0, *checked])) <= LONGEST_SLEEP + 1e-9


def test_a_check_ends_a_rest(clock):
    link = Link(read_device(DESCRIPTION), SETTINGS)

    def stop():
        raise StoppedError("somebody asked for zero")

    link.check = stop
    with pytest.raises(StoppedError):
        link.rest(1.0)
    assert clock.now <= LONGEST_SLEEP


@pytest.mark.parametrize("connecting", [0.0, 2.0], ids=["refused", "timed out"])
@pytest.mark.parametrize("reconnect_time", [0.0, 10.0])
def test_a_device_that_is_gone_is_given_up_after_the_time_to_reconnect(
    clock, monkeypatch, connecting, reconnect_time
):
    def unreachable(device, timeout):
        clock.sleep(connecting)
        raise OSError("nobody there")

    monkeypatch.setattr("dea.acquisition.retrying_link.connect", unreachable)
    settings = LinkSettings(timeout=2.0, retries=5, reconnect_time=reconnect_time)
    with pytest.raises(LinkError, match="nobody there"):
        Link(read_device(DESCRIPTION), settings).read(0, 2)
    assert 0.9 * reconnect_time <= clock.now <= reconnect_time + 2.0


@pytest.mark.parametrize("lost", [0, 1, 2])
def test_a_claim_without_a_reply_is_no_more_than_a_failed_attempt(monkeypatch, lost):
    """A connection was found, and the next attempt may find the device awake."""
    claims, asked = iter([True] * lost), []

    def claim():
        if next(claims, False):
            raise LinkError("no reply to the claim")

    class Client(SilentClient):
        def execute(self, no_response_expected, request):
            asked.append(request)
            if len(asked) == 1:
                raise ModbusIOException("No response received")
            return ReadHoldingRegistersResponse(registers=[7] * request.count)

    monkeypatch.setattr("dea.acquisition.retrying_link.connect", lambda *_, **__: Client())
    link = Link(read_device(DESCRIPTION), replace(SETTINGS, reconnect_time=0.0))
    link.open()
    link.on_connect = claim
    assert link.read(0, 2) == [7, 7]


class MuteClient:
    """Never replies; every request waits for the reply as long as it may."""

    def __init__(self, clock, timeout):
        self.clock, self.timeout, self.requests = clock, timeout, 0

    def execute(self, no_response_expected, request):
        self.requests += 1
        self.clock.sleep(self.timeout)
        raise ModbusIOException("No response received")

    def close(self):
        pass


@pytest.mark.parametrize(("longest", "asked"), [(np.inf, 6), (1.0, 3), (0.3, 1)])
def test_no_request_is_repeated_for_longer_than_is_allowed(clock, monkeypatch, longest, asked):
    client = MuteClient(clock, timeout=0.4)
    monkeypatch.setattr("dea.acquisition.retrying_link.connect", lambda device, timeout: client)
    link = Link(read_device(DESCRIPTION), LinkSettings(timeout=0.4, retries=5))
    link.longest_repetition = longest
    with pytest.raises(LinkError):
        link.read(0, 2)
    assert client.requests == asked
