"""Opening a connection with the framing of a device description."""

import socket
import ssl
import time
from dataclasses import replace
from pathlib import Path

from pymodbus.client import ModbusSerialClient, ModbusTcpClient, ModbusTlsClient
from pymodbus.framer import FramerType

from dea.acquisition.address import address_of
from dea.errors import InputError
from dea.modbus import Device, ReadWriteResponse, RegistersResponse

Client = ModbusTcpClient | ModbusTlsClient | ModbusSerialClient


def connect(device: Device, timeout: float) -> Client:
    """One attempt to connect; the client never retries by itself.

    Raises
    ------
    OSError
        Where the device does not answer.
    InputError
        Where a TLS certificate does not match, or a certificate file cannot be read.
    """
    if device.framing == "tls":
        client: Client = _TlsClient(device, timeout)
    elif device.framing == "serial":
        assert device.serial is not None
        line = device.serial
        client = _SerialClient(
            line.port, baudrate=line.baudrate, parity=line.parity, stopbits=line.stopbits,
            timeout=timeout, retries=0,
        )  # fmt: skip
    else:
        framer = FramerType.RTU if device.framing == "rtu_over_tcp" else FramerType.SOCKET
        client = ModbusTcpClient(
            device.host, port=device.port, framer=framer, timeout=timeout, retries=0
        )
    for response in (RegistersResponse, ReadWriteResponse):
        client.register(response)
    if not client.connect():
        raise OSError(_why_not(device))
    return client


def known(device: Device) -> Device:
    """Return a device with the address of its host, so that no name is looked up again.

    Files are named by it, which say who drives the device and what has tripped. One on a serial
    line is itself.

    Raises
    ------
    InputError
        Where the host has none.
    """
    if device.serial is not None:
        return device
    address = address_of(device.host)
    if address is None:
        raise InputError(
            f"the host {device.host!r} is not known now, nor who drives it or what has tripped",
            file=device.source,
            field="endpoint.host",
            remedy="Give its address: --host 192.0.2.7",
        )
    tls = replace(device.tls, server_name=device.tls.server_name or device.host)
    return replace(device, host=address, tls=tls)


def _why_not(device: Device) -> str:
    """Return why a device cannot be connected to, as far as it can be known."""
    if device.serial is not None:
        port = Path(device.serial.port)
        if port.is_absolute() and not port.exists():
            return "there is no such port"
        return "another program has it open, or this account may not open it"
    try:
        socket.getaddrinfo(device.host, device.port)
    except OSError:
        return f"unknown host {device.host!r}"
    return "connection refused or timed out"


def place(device: Device) -> str:
    """Where the device is, for messages."""
    where = device.serial.port if device.serial else f"{device.host}:{device.port}"
    return f"{device.name} at {where}"


class _SerialClient(ModbusSerialClient):
    """pymodbus's serial client, whose timeout goes by a clock that nobody sets.

    By the clock of the wall a step back would hold the guardian up for as long as the step.
    """

    def _wait_for_data(self) -> int:
        """Return how many bytes there are once no more come, or the timeout has passed."""
        assert self.socket is not None
        end = time.monotonic() + (self.comm_params.timeout_connect or 0.0)
        size = 0
        while time.monotonic() <= end:
            available = int(self.socket.in_waiting)
            if size and available in (0, size):
                break
            size = available
            time.sleep(self._recv_interval)
        return size


class _TlsClient(ModbusTlsClient):
    """pymodbus's TLS client, with the server's name checked and failures reported."""

    def __init__(self, device: Device, timeout: float) -> None:
        self.device = device
        super().__init__(
            device.host, port=device.port, sslctx=_context(device), timeout=timeout, retries=0
        )

    def connect(self) -> bool:
        if self.socket:
            return True
        device, timeout = self.device, self.comm_params.timeout_connect
        plain = socket.create_connection((device.host, device.port), timeout=timeout)
        try:
            self.socket = _context(device).wrap_socket(
                plain, server_hostname=device.tls.server_name or device.host
            )
        except ssl.SSLCertVerificationError as error:
            plain.close()
            raise InputError(
                f"the certificate of {place(device)} does not match: {error.verify_message}",
                file=device.source,
                field="tls",
                remedy="Name its signing authority in ca_file and its own name in server_name.",
            ) from error
        except OSError:
            plain.close()
            raise
        return True


def _context(device: Device) -> ssl.SSLContext:
    tls = device.tls
    try:
        context = ssl.create_default_context(cafile=tls.ca_file)
        if tls.certificate_file:
            context.load_cert_chain(tls.certificate_file, tls.key_file)
    except OSError as error:
        raise InputError(
            f"a certificate file cannot be read: {error}",
            file=device.source,
            field="tls",
            remedy="Check ca_file, certificate_file and key_file.",
        ) from error
    return context
