"""How often a request is sent when its reply does not come."""

from dataclasses import replace

import pytest
from pymodbus.exceptions import ModbusIOException

from dea.acquisition import Link, LinkError, LinkSettings
from dea.acquisition.panel import Panel
from dea.modbus import read_device
from served_bench import DESCRIPTION

RETRIES = 3
SETTINGS = LinkSettings(timeout=0.1, retries=RETRIES, reconnect_time=0.1)


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
