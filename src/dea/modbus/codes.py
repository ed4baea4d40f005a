"""What numbers mean in the registers of a device that commands and plays blocks."""

from enum import IntEnum


class DeviceState(IntEnum):
    """What the device is doing: ``state`` and ``reply_state``."""

    IDLE = 0
    RAMPING = 1  # to zero
    RUNNING = 2
    TRIPPED = 3


class Command(IntEnum):
    """What a master asks for: ``command``."""

    START = 1
    STOP = 2
    RESET = 3  # the latch of the watchdog
    CLEAR = 4  # the FIFO


class Origin(IntEnum):
    """Why a sample was applied: ``reply_origin``."""

    PLAYED = 1
    HELD = 2  # the FIFO was empty, and the output not at zero
    REST = 3
    RAMP = 4
    TRIPPED = 5
    POLLED = 6


class Refusal(IntEnum):
    """Modbus exception codes with which the device refuses a request."""

    ILLEGAL_ADDRESS = 2
    ILLEGAL_VALUE = 3
    NOT_ALLOWED = 7  # to this master, or in this state
