"""How a diagnosis is made."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from dea.discrepancy.budget import Budget
from dea.discrepancy.rules import Rules
from dea.errors import InputError
from dea.given_numbers import is_count, is_positive


@dataclass(frozen=True)
class Settings:
    """How a diagnosis is made.

    Parameters
    ----------
    effects
        Names of the effects offered; all of the catalogue if empty.
    slowest_time
        Slowest time constant (s), which sets the spacing of the blocks; the simulation's own if
        ``None``.
    warm_up
        Time (s) at the start of the record that no error counts; at most a fiftieth of it.
    blocks
        Blocks of the seen samples that are resampled, about. They are cut about as long as the
        spacing of the split where that is longer: blocks shorter than the device's memory are not
        independent.
    noise_margin
        Factor on the estimated noise that fits weigh the record with, since the residual of a
        simulation that misses an effect is larger than the noise.
    step_error, relative_step_error
        Error of integration that is small enough: this part of the noise's standard deviation, or
        this part of the output's if that is larger.
    budget
        How far the search goes.
    rules
        When an effect is named.
    seed, name
        The random draws follow from both.
    """

    effects: tuple[str, ...] = ()
    slowest_time: float | None = None
    warm_up: float = 1.0
    blocks: int = 48
    noise_margin: float = 1.5
    step_error: float = 0.5
    relative_step_error: float = 1e-3
    budget: Budget = field(default_factory=Budget)
    rules: Rules = field(default_factory=Rules)
    seed: int = 0
    name: str = "case"

    def __post_init__(self) -> None:
        names = self.effects
        listed = isinstance(names, tuple | list) and all(isinstance(n, str) for n in names)
        for field_name, holds, wanted in (
            ("effects", listed, "a list of names"),
            (
                "slowest_time",
                self.slowest_time is None or is_positive(self.slowest_time),
                "a positive time in s, or none",
            ),
            ("warm_up", self.warm_up == 0 or is_positive(self.warm_up), "a time in s, or zero"),
            ("blocks", is_count(self.blocks, 2), "a whole number, two at least"),
            ("noise_margin", is_positive(self.noise_margin), "a positive number"),
            ("step_error", is_positive(self.step_error), "a positive number"),
            ("relative_step_error", is_positive(self.relative_step_error), "a positive number"),
        ):
            if not holds:
                raise InputError(
                    f"it is {getattr(self, field_name)!r}",
                    field=field_name,
                    remedy=f"Give {wanted}",
                )

    @classmethod
    def of(cls, leaves: Mapping[str, Any]) -> "Settings":
        """Return the settings that the config's ``discrepancy`` and a case's ``split`` hold."""
        own, parts = leaves["discrepancy"], leaves.get("split", {})
        return cls(
            effects=tuple(own["effects"]),
            slowest_time=parts.get("slowest_time"),
            warm_up=parts.get("warm_up", own["warm_up"]),
            budget=Budget(**own["budget"]),
            rules=Rules(**own["rules"]),
            seed=leaves["seed"],
            name=leaves["system"],
        )
