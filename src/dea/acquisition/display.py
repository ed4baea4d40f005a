"""The display while an acquisition runs: progress, state of the link, a live plot."""

import time
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import Self

import numpy as np
import plotext  # type: ignore[import-untyped]
from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn
from rich.text import Text

from dea.acquisition.link_log import LinkLog
from dea.acquisition.read_back import applied_register
from dea.acquisition.samples import DrivenSamples
from dea.modbus import Device, to_physical

REFRESH = 0.2  # s
SHOWN = 20.0  # s of signal in the live plot
POINTS = 400  # drawn at most, across the plot


class _Terminal(Console):
    def on_broken_pipe(self) -> None:
        """Leave it to the display: rich would end the program, and with it the record."""
        raise


class Display:
    """Shows progress on a terminal; pass it as ``watch`` to :func:`dea.acquisition.acquire`.

    Nothing is drawn before the first samples come: a device that is refused has no progress. Where
    nobody can see it any more, as on a terminal that was closed, it stops, and the record goes on.

    Parameters
    ----------
    device
        For units and scales.
    total
        Number of samples, ramps included.
    live
        Whether voltage and displacement are drawn too.
    console
        Where to draw; by default standard error.
    """

    def __init__(
        self, device: Device, total: int, *, live: bool = False, console: Console | None = None
    ) -> None:
        self.device, self.live = device, live
        self._console = console or _Terminal(stderr=True)
        self._bar = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.completed:.0f}/{task.total:.0f} samples"),
            TextColumn("{task.fields[health]}"),
            TimeRemainingColumn(),
            console=self._console,
        )
        self._task = self._bar.add_task(device.name, total=total, health="")
        self._signals: deque[tuple[np.ndarray, np.ndarray, np.ndarray]] = deque()
        self._done, self._drawn, self._begun = 0, 0.0, time.monotonic()
        self._screen = Live(
            console=self._console, get_renderable=self._render, auto_refresh=False
        )  # fmt: skip

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None
    ) -> None:
        if not self._screen.is_started:
            return
        with self._while_seen():
            self._bar.update(self._task, completed=self._done)
            self._screen.refresh()
        with self._while_seen():  # which gives standard error back
            self._screen.stop()
            if not self._console.is_terminal:  # where rich leaves the line open
                self._console.print()

    def __call__(self, samples: DrivenSamples, log: LinkLog) -> None:
        """Add a block of samples; redraw at most every REFRESH seconds."""
        with self._while_seen():
            self._screen.start()
        self._done += samples.position.size
        if self.live:
            self._keep(samples)
        now = time.monotonic()
        if now - self._drawn < REFRESH:
            return
        self._drawn = now
        rate = self._done / max(now - self._begun, 1e-9)
        with self._while_seen():
            self._bar.update(self._task, completed=self._done, health=health(rate, log))
            self._screen.refresh()

    @contextmanager
    def _while_seen(self) -> Iterator[None]:
        try:
            yield
        except (OSError, ValueError):  # a terminal that is gone, or has no such characters
            self._console.quiet = True

    def _keep(self, samples: DrivenSamples) -> None:
        device = self.device
        self._signals.append(
            (
                samples.device_index / device.sampling_rate,
                to_physical(applied_register(device), samples.applied),
                to_physical(device["displacement"], samples.displacement),
            )
        )
        while self._signals[-1][0][-1] - self._signals[0][0][-1] > SHOWN:
            self._signals.popleft()

    def _render(self) -> RenderableType:
        if not self._signals:
            return self._bar
        time_, voltage, displacement = (np.concatenate(c) for c in zip(*self._signals, strict=True))
        step = max(1, time_.size // POINTS)
        figure = plotext.figure
        figure.clear()
        figure.subplots(2, 1)
        figure.plot_size(self._console.width, max(16, self._console.height - 4))
        for row, name, values in ((1, "output", voltage), (2, "displacement", displacement)):
            panel = figure.subplot(row, 1)
            signal = panel.signal(
                time_[::step].tolist(), values[::step].tolist(), marker="braille"
            ).lines()
            panel.draw(signal)
            panel.title(f"{name} in {self.device[name].unit} against time in s")
        return Group(Text(figure.build().string(colorless=True)), self._bar)


def health(rate: float, log: LinkLog) -> str:
    """One line on the link: samples/s, latest and worst recent round trip, failures."""
    recent = np.subtract(log.receive_time[-100:], log.send_time[-100:])
    trip = (
        f"{1e3 * np.median(recent):.1f} ms, worst {1e3 * recent.max():.1f}" if recent.size else ""
    )
    failures = ", ".join(f"{count} {kind}" for kind, count in sorted(log.errors.items()))
    return f"{rate:.0f}/s  round trip {trip}  {failures or 'no errors'}"
