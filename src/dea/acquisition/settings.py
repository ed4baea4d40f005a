"""How an acquisition drives, waits and repeats."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, Self

from dea.acquisition.retrying_link import LinkSettings
from dea.configuration.acquisition import Acquisition
from dea.configuration.problems import validated
from dea.configuration.section import partial

# A caller names the settings that differ from the defaults.
_SOME = partial(Acquisition)


@dataclass(frozen=True)
class AcquisitionSettings(LinkSettings):
    """How to drive: see ``acquisition`` in config/config.yaml for the meaning and units."""

    mode: Literal["buffered", "polled"] = "buffered"
    ramp_rate: float = 1.0  # V/s
    on_break: Literal["stop", "restart"] = "stop"
    restarts: int = 2
    late_after: float = 5e-3  # s
    clock_tolerance: float = 0.01  # of the sampling rate
    armed_by: str = ""
    stall_time: float = 5.0  # s
    read_back_tolerance: float = 0.05  # of the span of the output's limits
    paced: bool = True

    @property
    def patience(self) -> float:
        """Seconds without a message after which a guardian counts as hung.

        It gives one before each request, which may connect first, with TLS too, and pause.
        """
        return self.stall_time + 4 * self.timeout + 2.0

    @classmethod
    def from_mapping(cls, values: Mapping[str, Any]) -> Self:
        """Check settings read from a file; raises InputError for a misspelt key or bad value."""
        given = validated(_SOME, values, place="acquisition")
        return cls(**given.model_dump(exclude_unset=True))
