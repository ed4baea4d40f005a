"""A link to registers in memory, and a clock that passes only while somebody sleeps."""

from dea.acquisition import zero
from dea.acquisition.link_log import LinkLog
from dea.modbus import encode


class MemoryLink:
    """Registers hold raw values by name, or what a function without arguments returns."""

    def __init__(self, device, **values):
        self.device, self.values = device, values
        self.written = []  # of (register, words)
        self.check = self.on_connect = None
        self.log = LinkLog()

    def _name(self, address, table):
        [name] = [
            n for n, r in self.device.registers.items() if (r.address, r.table) == (address, table)
        ]
        return name

    def rest(self, seconds):
        zero.time.sleep(seconds)  # of whatever clock stands in for it

    def read(self, address, count, table):
        name = self._name(address, table)
        value = self.values[name]
        return encode(self.device[name], value() if callable(value) else value)

    def write(self, address, words, table="holding", *, retry=True):
        self.written.append((self._name(address, table), words))

    def open(self):
        pass

    def close(self):
        pass


class Clock:
    """Stands in for the module :mod:`time`."""

    def __init__(self):
        self.now = self.suspended = 0.0

    def monotonic(self):
        return self.now

    def clock_gettime(self, _):
        """Return the time with what the computer was suspended for."""
        return self.now + self.suspended

    def sleep(self, seconds):
        self.now += seconds
