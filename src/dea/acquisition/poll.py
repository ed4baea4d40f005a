"""One sample of a polled device: which requests it takes, and what they bring."""

from dea.acquisition.panel import Panel
from dea.acquisition.read_back import read_back_register
from dea.acquisition.retrying_link import DeviceRefusedError
from dea.modbus import Window, adjoining, encode

NEIGHBOURS = 32  # registers that one request spans at most


class Poll:
    """One sample: write the output, read back what the device applied and measured."""

    def __init__(self, panel: Panel) -> None:
        self.panel, self.link, device = panel, panel.link, panel.device
        self._next: int | None = None
        self.output = device["output"]
        self.echo = read_back_register(device)
        sampled = [device["displacement"], self.echo, device.registers.get("device_index")]
        windows = adjoining((each for each in sampled if each), NEIGHBOURS)
        # The write shares a request with the first.
        self.windows = sorted(
            windows, key=lambda each: device["displacement"] not in each.registers
        )
        self._wrap = 1 << 16 * device["device_index"].size if "device_index" in device else 0

    def learn(self) -> None:
        """Find out which registers the device answers together; applies no voltage."""
        self.windows = [part for window in self.windows for part in self._answered(window)]

    def _answered(self, window: Window) -> list[Window]:
        """Split a window where the device refuses the undescribed addresses in it."""
        if sum(register.size for register in window.registers) == window.size:
            return [window]
        try:
            self.link.read(window.address, window.size, window.table)
        except DeviceRefusedError:
            return [Window([register]) for register in window.registers]
        return [window]

    def __call__(self, count: int, number: int) -> tuple[int, float, float]:
        """Drive one ``count``; return device index, applied and displacement counts.

        Without a device index, the ``number`` of the sample is its index; without a read-back, the
        applied output is the requested one.
        """
        self.panel.last_output = count
        words, first = encode(self.output, count), self.windows[0]
        if self.panel.device.read_write_multiple and first.table == "holding":
            reply = self.link.read_write(
                first.address, first.size, self.output.address, words, retry=False
            )
        else:
            self.link.write(self.output.address, words, retry=False)
            reply = self.link.read(first.address, first.size, first.table)
        values = first.decode(reply)
        for window in self.windows[1:]:
            values |= window.decode(self.link.read(window.address, window.size, window.table))
        applied = values[self.echo.name] if self.echo else count
        self.link.log.samples[-1] = 1
        index = values.get("device_index", number)
        if self._wrap and self._next is not None:  # a short index begins again at zero
            half = self._wrap // 2
            index = self._next + (index - self._next + half) % self._wrap - half
        self._next = index + 1
        return index, applied, values["displacement"]
