"""Models from a record: ``identification``, ``orders``, ``validation``."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from dea.configuration.section import (
    Count,
    Different,
    Interval,
    NotNegative,
    Part,
    Positive,
    Section,
    Truth,
    WholeNotNegative,
    key,
    refuse,
)

# Times and lengths that differ by less, in s, do so by the rounding of what they are made of alone.
ROUNDING = 1e-6
OutputLags = Count | Annotated[list[Count], Different]
LagList = Annotated[list[WholeNotNegative], Field(min_length=1), Different]
InputLags = Count | LagList | Annotated[list[LagList], Field(min_length=2)]


class Identification(Section):
    """Linear and NARX models of one system (docs/method/identification.md)."""

    start: NotNegative = key("where the segment to identify from begins", unit="s")
    length: Positive = key("length of that segment", unit="s")
    y_lags: OutputLags = key("largest lag of the output, or a list of lags", unit="samples")
    u_lags: InputLags = key(
        "largest lag of the input, from 1 on, or a list of lags, which may hold 0; of several"
        " inputs, such a list for each may be given",
        unit="samples",
    )
    degree: Count = key("polynomial order")
    even_in_input: Truth = key("true where the system answers the input's negative alike")
    search: Literal["refined", "forward", "orthogonal"] = key(
        "refined: terms added, dropped and exchanged under parameters that minimise the simulated"
        " error; forward: the paper's forward selection and pruning; orthogonal: FROLS"
    )
    threshold: Part | None = key(
        "share of the output's energy that a term explains; where it is null, the refined search"
        " takes it from the record, the forward one 1e-5; the orthogonal one does without; a case"
        " without it has the study's",
        default=None,
    )
    rounds: WholeNotNegative = key("largest number of steps of the refined search")
    resamples: WholeNotNegative = key(
        "block bootstrap selections behind the inclusion frequency; 0 for none"
    )


class Orders(Section):
    """The comparison of dynamic and polynomial orders on independent data."""

    dynamic: Count = key("largest dynamic order compared")
    polynomial: Count = key("largest polynomial order compared")
    lags: Count = key("dynamic order while polynomial orders are compared")
    threshold: Part = key(
        "SERR of the paper's forward selection below which no term is added or kept"
    )
    start: NotNegative | None = key(
        "where the independent data begin; after the segment where it is not given",
        unit="s",
        default=None,
    )
    length: Positive = key("length of the independent data", unit="s")


class Forecast(Section):
    """Forecasts of the model and of simpler structures, with parameters from the past alone."""

    start: Positive = key("beginning of the first forecast", unit="s")
    every: Positive = key("time from the beginning of one to that of the next", unit="s")
    window: Positive = key("length of the past from which parameters are estimated", unit="s")
    horizons: Annotated[list[Positive], Field(min_length=1), Different] = key(
        "lengths over which errors are taken, ascending", unit="s"
    )

    @model_validator(mode="after")
    def _past(self) -> Self:
        if self.start < self.window:
            raise refuse(
                "start",
                f"{self.start:g} s leaves no window of {self.window:g} s before",
                "Begin later, or shorten the window.",
            )
        if self.horizons != sorted(self.horizons):
            raise refuse("horizons", f"{self.horizons} do not ascend", "Give the shortest first.")
        return self


class Validation(Section):
    """The windows on which the linear and the NARX model are compared."""

    windows: Annotated[list[Interval], Field(min_length=1)] = key(
        "first and last second of each window", unit="s"
    )
    before: Positive = key(
        "time before each window from which models that do not see the window are estimated",
        unit="s",
    )
    max_lag: Count = key("largest lag of the residual correlations", unit="samples")

    @model_validator(mode="after")
    def _room_before(self) -> Self:
        for index, (first, _) in enumerate(self.windows):
            if first < self.before:
                raise refuse(
                    f"windows[{index}]",
                    f"it begins at {first:g} s, with less than `before`, {self.before:g} s, of the"
                    " record before it",
                    "Begin it later, or shorten `before`.",
                )
        return self

    @model_validator(mode="after")
    def _one_length(self) -> Self:
        lengths = [last - first for first, last in self.windows]
        for index, length in enumerate(lengths):
            if abs(length - lengths[0]) > ROUNDING:
                raise refuse(
                    f"windows[{index}]",
                    f"it is {length:g} s long, the first {lengths[0]:g} s",
                    "Give windows of one length.",
                )
        return self
