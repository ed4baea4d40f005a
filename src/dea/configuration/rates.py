"""What the study asks of a device's sampling rate."""

from collections.abc import Iterator
from pathlib import Path

from dea.configuration.excitation import is_whole
from dea.configuration.lags import largest_lag
from dea.configuration.study import FILE, Study
from dea.errors import InputError

_PER_LAG = 3  # samples of a stretch for each lag, as in dea.missing.stretches


def check_rate(study: Study, rate: float, device: str | Path) -> None:
    """Check that the study's excitations, stretches of its record and references suit a rate in Hz.

    Raises
    ------
    InputError
        Naming the key, and the device whose rate it is.
    """
    for field, highest in _frequencies(study):
        if highest >= 0.5 * rate:
            raise InputError(
                f"{highest:g} Hz is not below half of the {rate:g} Hz of {device}",
                file=FILE,
                field=field,
                remedy="Lower it, or sample faster.",
            )
    if (probing := study.excitation.probing) is not None:
        period = rate / probing.lowest
        if not is_whole(period):
            raise InputError(
                f"its period holds {period:g} samples at the {rate:g} Hz of {device}, not a whole"
                " number",
                file=FILE,
                field="excitation.probing.lowest",
                remedy=f"Take {rate / round(period):.6g} Hz, or another rate over a whole number.",
            )
    for field, length, lag in _stretches(study):
        samples = round(length * rate)
        if samples <= _PER_LAG * lag:
            raise InputError(
                f"{length:g} s hold {samples} samples at the {rate:g} Hz of {device}, and lags of"
                f" {lag} take more than {_PER_LAG * lag}",
                file=FILE,
                field=field,
                remedy="Lengthen it, or take smaller lags.",
            )
    for field, length, least in _drives(study):
        samples = round(length * rate)
        if samples < least:
            raise InputError(
                f"{length:g} s hold {samples} samples at the {rate:g} Hz of {device}, and it takes"
                f" at least {least}",
                file=FILE,
                field=field,
                remedy="Lengthen it.",
            )
    for first, last in study.validation.windows:
        samples = round((last - first) * rate)
        if samples <= 2 * study.validation.max_lag:
            raise InputError(
                f"{study.validation.max_lag} samples, and the window [{first:g}, {last:g}] s holds"
                f" {samples} at the {rate:g} Hz of {device}",
                file=FILE,
                field="validation.max_lag",
                remedy="Take less than half of a window, or longer windows.",
            )


def _frequencies(study: Study) -> Iterator[tuple[str, float]]:
    for name in ("record", "second"):
        band = getattr(getattr(study.excitation, name), "band", None)
        if band is not None:
            yield f"excitation.{name}.band", band
    if study.excitation.probing is not None:
        yield "excitation.probing.highest", study.excitation.probing.highest
    yield "control.reference.frequency", study.control.reference.frequency


def _drives(study: Study) -> Iterator[tuple[str, float, int]]:
    """Yield field, length in s and fewest samples of what a controller does one after the other."""
    reference = study.control.reference
    yield "control.hold", study.control.hold, 2  # which the inverse of a simulation needs before
    yield "control.approach", study.control.approach, 1
    yield "control.reference.rise", reference.rise, 1  # the shortest of a reference


def _stretches(study: Study) -> Iterator[tuple[str, float, int]]:
    """Yield field, length in s and largest lag of what models are estimated or scored on."""
    lag = largest_lag(study.identification.y_lags, study.identification.u_lags)
    compared = max(study.orders.dynamic, study.orders.lags)
    yield "identification.length", study.identification.length, max(lag, compared)
    yield "orders.length", study.orders.length, compared
    yield "validation.before", study.validation.before, lag
    yield "forecast.window", study.forecast.window, lag
