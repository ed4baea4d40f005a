"""Typical sizes in a record, which the priors and starting values of effects refer to."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Scales:
    """Typical sizes in a record, to which the priors and starting values of effects refer.

    Input in ``u_unit``, output in ``y_unit``, times in s. ``z`` is the normalised position of the
    force balance (zero at rest, one at the largest excursion of the nominal simulation), which is
    hardly ever faster than ``z_rate`` (1/s), as the input than ``u_rate``. Of a residual,
    ``frequencies`` are those of its lines (Hz), ``foreign_frequencies`` those that an input which
    repeats does not have, and ``jumps`` the instants at which it changes (s). An input is
    ``smooth`` if it is band-limited, and not held, between samples. A force balance is ``placed``
    if a state is its position, and not a rate alone. Its ``inertia`` (s^2) is the unit of force
    over the acceleration of ``z`` that this causes, and zero where an elastic force holds
    the place.
    """

    u_unit: str
    y_unit: str
    u_low: float
    u_high: float
    u_rate: float
    y_low: float
    y_high: float
    z_low: float
    z_high: float
    interval: float
    duration: float
    frequencies: tuple[float, ...] = ()
    foreign_frequencies: tuple[float, ...] = ()
    jumps: tuple[float, ...] = ()
    smooth: bool = False
    placed: bool = True
    inertia: float = 0.0
    z_rate: float = 0.0

    @property
    def u_span(self) -> float:
        """Range of the input."""
        return self.u_high - self.u_low

    @property
    def y_span(self) -> float:
        """Range of the output."""
        return self.y_high - self.y_low

    @property
    def z_span(self) -> float:
        """Range of the normalised position."""
        return self.z_high - self.z_low

    @property
    def u_middle(self) -> float:
        """Middle of the range of the input."""
        return 0.5 * (self.u_low + self.u_high)

    @property
    def y_middle(self) -> float:
        """Middle of the range of the output."""
        return 0.5 * (self.y_low + self.y_high)

    @property
    def z_middle(self) -> float:
        """Middle of the range of the normalised position."""
        return 0.5 * (self.z_low + self.z_high)

    @property
    def crossing(self) -> float:
        """Time (s) in which a fast motion crosses its range, at most a tenth of the record."""
        longest = 0.1 * self.duration
        return min(self.z_span / self.z_rate, longest) if self.z_rate else longest

    @property
    def slow(self) -> float:
        """Time constant (s) far above the interval, of which the record holds many."""
        return min(100.0 * self.interval, 0.05 * self.duration)

    @property
    def lags(self) -> tuple[float, ...]:
        """Time constants (s) of three short lags, and in a long record of a longer one."""
        short = tuple(samples * self.interval for samples in (2.0, 8.0, 30.0))
        return (*short, self.slow) if self.slow > short[-1] else short

    @property
    def u_peak(self) -> float:
        """Largest magnitude of the input."""
        return max(abs(self.u_low), abs(self.u_high))

    @property
    def bipolar(self) -> bool:
        """Whether the input goes to both signs."""
        return self.u_low < -0.05 * self.u_span < 0.05 * self.u_span < self.u_high
