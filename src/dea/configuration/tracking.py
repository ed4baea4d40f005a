"""Parameters that change with time: ``tracking`` of config/config.yaml."""

from typing import Self

from pydantic import model_validator

from dea.configuration.section import Count, NotNegative, Positive, Section, Share, key, refuse


class Rls(Section):
    """Recursive least squares, the paper's recursion (11)-(16)."""

    forgetting: Share = key("lambda: a memory of 1/(1 - lambda) samples; 1 is the paper's")
    leakage: NotNegative = key("alpha, per sample, towards the model's own parameters")
    delta: Positive = key("P_0 = I/delta: the model counts like so many samples", unit="samples")


class Smoother(Section):
    """Random-walk Kalman smoother."""

    delta: Positive = key("P_0 = I/delta: the model counts like so many samples", unit="samples")
    thinning: Count = key("samples over which one-step errors stay alike", unit="samples")


class Local(Section):
    """Local output-error estimates."""

    window: Count | None = key(
        "length of the windows in which parameters are constant; an eighth of the record, and no"
        " more than 4000, unless it is given",
        unit="samples",
        default=None,
    )


class Trackers(Section):
    """Which trackers run, each with its own settings; at least one."""

    rls: Rls | None = key("recursive least squares", default=None)
    kalman: Smoother | None = key("smoother of the one-step prediction", default=None)
    output_error: Smoother | None = key("smoother of the free run", default=None)
    local: Local | None = key("output-error estimates of windows", default=None)

    @model_validator(mode="after")
    def _some(self) -> Self:
        if not self.names:
            raise refuse("", "it names no tracker", "Give one of rls, kalman, output_error, local.")
        return self

    @property
    def names(self) -> tuple[str, ...]:
        """The trackers chosen."""
        return tuple(name for name in Trackers.model_fields if getattr(self, name) is not None)


class Tracking(Section):
    """Parameters that change with time (docs/method/tracking.md)."""

    trackers: Trackers = key("the trackers to run")
    instants: Count = key("number of times at which the covariance and the bands are kept")
    frozen_window: Count = key(
        "length of the stretches simulated with constant parameters", unit="samples"
    )
