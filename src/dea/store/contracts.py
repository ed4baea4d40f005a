"""What each dataset of the study must hold: variables, dimensions and units."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import xarray as xr

from dea.errors import InputError
from dea.units import SECONDS

MINUTE = SECONDS["min"]  # s of a `minute` of a dataset


@dataclass(frozen=True)
class Variable:
    """Dimensions of a variable and, where they are fixed, its units.

    ``of_inputs`` are the dimensions where the record has several inputs, if they differ.
    """

    dims: tuple[str, ...]
    units: str | None = None
    of_inputs: tuple[str, ...] | None = None


@dataclass(frozen=True)
class Contract:
    """The variables a dataset must have, those it may have, and attributes it must have."""

    required: Mapping[str, Variable]
    optional: Mapping[str, Variable] = field(default_factory=dict)
    attributes: tuple[str, ...] = ()

    def check(self, dataset: xr.Dataset, file: Path) -> None:
        """Raise :class:`InputError` where ``dataset`` breaks the contract."""
        for name in self.attributes:
            if name not in dataset.attrs:
                raise InputError(
                    "the attribute is missing",
                    file=file,
                    field=name,
                    remedy=f"It holds {', '.join(sorted(map(str, dataset.attrs))) or 'none'}",
                )
        for name, variable in {**self.required, **self.optional}.items():
            if name not in dataset.variables:
                if name in self.required:
                    raise InputError(
                        "the variable is missing",
                        file=file,
                        field=name,
                        remedy=f"It holds {', '.join(sorted(map(str, dataset.variables)))}",
                    )
                continue
            found = dataset[name]
            if found.dims not in (variable.dims, variable.of_inputs):
                raise InputError(
                    f"its dimensions are {found.dims}",
                    file=file,
                    field=name,
                    remedy=f"They must be {variable.dims}",
                )
            units = found.attrs.get("units")
            if units is None or (variable.units is not None and units != variable.units):
                raise InputError(
                    f"its units are {units!r}",
                    file=file,
                    field=name,
                    remedy=f"They must be {variable.units!r}"
                    if variable.units
                    else "Every variable names its units; '1' where it has none",
                )


def check_units(dataset: xr.Dataset, file: Path) -> None:
    """Raise :class:`InputError` where a variable, of the contract or beside it, has no units."""
    for name, variable in dataset.data_vars.items():
        if "units" not in variable.attrs:
            raise InputError(
                "the variable has no units",
                file=file,
                field=str(name),
                remedy="Every variable names its units; '1' where it has none",
            )


def _plain(*dims: str, units: str | None = None) -> Variable:
    return Variable(dims, units)


def _for_each(dimension: str, *dims: str, units: str | None = None) -> Variable:
    """Return a variable that has this dimension in front where there are several inputs."""
    return Variable(dims, units, (dimension, *dims))


def _of_inputs(*dims: str, units: str | None = None) -> Variable:
    """Return a variable that has the dimension ``input`` too where there are several."""
    return Variable(dims, units, (*dims, "input"))


_METRIC = ("model", "approach", "window")
_ENDS = [(part, end) for part in ("gain", "phase") for end in ("low", "high")]
_RECOVERY = ("plant", "excitation", "search")
_RECOVERY_SCORES = ("nmse", "h1_error", "h2_error", "terms_common", "terms_foreign")
_TRIAL_TEXTS = (
    "hidden", "forms", "kind", "excitation", "device", "noise", "status", "said", "rivals",
    "outcome",
)  # fmt: skip

CONTRACTS: Mapping[str, Contract] = {
    "record": Contract(
        required={
            "time": _plain("time", units="s"),
            "voltage": _plain("time", units="V"),
            "displacement": _plain("time", units="mm"),
            "device_index": _plain("time", units="1"),
            "quality": _plain("time", units="1"),
        },
        optional={
            "voltage_requested": _plain("time", units="V"),
            "voltage_counts": _plain("time", units="count"),
            "displacement_counts": _plain("time", units="count"),
            "probing": _plain("time", units="1"),
            "realisation": _plain("time", units="1"),
        },
    ),
    "imported_record": Contract(
        required={
            "time": _plain("time", units="s"),
            "output": _plain("time"),
        },
        # A record has one input or several, input_1 and so on, which reading it checks.
        optional={"input": _plain("time"), "quality": _plain("time", units="1")},
    ),
    "link": Contract(
        required={
            "send_time": _plain("exchange", units="s"),
            "receive_time": _plain("exchange", units="s"),
            "samples": _plain("exchange", units="1"),
            "retries": _plain("exchange", units="1"),
        }
    ),
    "orders": Contract(
        required={
            f"{order}_{criterion}": _plain(f"{order}_order")
            for order in ("dynamic", "polynomial")
            for criterion in ("nmse", "fpe", "terms")
        }
    ),
    "model": Contract(
        required={
            "parameter": _plain("term", units="1"),
            "u_offset": _of_inputs(),
            "u_scale": _of_inputs(),
            "y_offset": _plain(),
            "y_scale": _plain(),
        },
        optional={
            "standard_error": _plain("term", units="1"),
            "covariance": _plain("term", "term_2", units="1"),
            "inclusion_frequency": _plain("term", units="1"),
            "rest_input": _of_inputs("level"),
            "rest_output": _plain("level"),
            "rest_pole": _plain("level", units="1"),
            "holds": _plain("count", units="1"),
            "runs": _plain("count", units="1"),
            "surrogates": _plain("count", units="1"),
            "record_samples": _plain(units="1"),
            "threshold": _plain(units="1"),
            "trial_phase": _plain("trial"),
            "trial_step": _plain("trial"),
            "trial_term": _plain("trial"),
            "trial_msse": _plain("trial"),
            "trial_serr": _plain("trial"),
            "trial_status": _plain("trial"),
        },
    ),
    "common_model": Contract(
        required={
            "parameter": _plain("system", "term", units="1"),
            "standard_error": _plain("system", "term", units="1"),
            "withheld": _plain("system", units="1"),
            "nmse": _plain("structure", "system", units="1"),
            "terms": _plain("structure", "system", units="1"),
            "stability": _plain("structure", "system", units="1"),
        }
    ),
    "validation": Contract(
        required={
            "time": _plain("window", "sample", units="s"),
            "input": Variable(("window", "sample"), of_inputs=("window", "sample", "signal")),
            "measured": _plain("window", "sample"),
            "simulated": _plain("model", "approach", "window", "sample"),
            "nmse": _plain(*_METRIC, units="1"),
            "fit": _plain(*_METRIC, units="1"),
            "fpe": _plain(*_METRIC),
            "rmse": _plain(*_METRIC),
            "correlation": _plain(*_METRIC, "test", "lag", units="1"),
            "tested_correlation": _plain(*_METRIC, "test", "lag", units="1"),
            "p_value": _plain(*_METRIC, "test", units="1"),
            "explained": _plain(*_METRIC, "test", units="1"),
            "verdict": _plain("model", units="1"),
        }
    ),
    "test_scores": Contract(
        required={
            "nmse": _plain("part", units="1"),
            "rmse": _plain("part"),
            "samples": _plain("part", units="1"),
            "stability": _plain(units="1"),
            "terms": _plain(units="1"),
            "initial_outputs": _plain(units="1"),
            "baseline_nmse": _plain("part", "baseline", units="1"),
            "baseline_rmse": _plain("part", "baseline"),
        }
    ),
    "recovery": Contract(
        required={
            **{name: _plain(*_RECOVERY, units="1") for name in _RECOVERY_SCORES},
            "stability": _plain(*_RECOVERY, units="1"),
            "plant_terms": _plain("plant", units="1"),
        }
    ),
    "track": Contract(
        required={
            "parameter": _plain("tracker", "time", "term", units="1"),
            "parameter_std": _plain("tracker", "time", "term", units="1"),
            "covariance": _plain("tracker", "instant", "term", "term_2", units="1"),
            "band_low": _plain("tracker", "instant", "term", units="1"),
            "band_high": _plain("tracker", "instant", "term", units="1"),
            "estimator": _plain("tracker", units="1"),
            "withheld": _plain("tracker", units="1"),
            "innovation": _plain("tracker", "time"),
            "simulated": _plain("simulation", "time"),
            "simulated_low": _plain("simulation", "time"),
            "simulated_high": _plain("simulation", "time"),
            "nmse": _plain("simulation", units="1"),
            "rmse": _plain("simulation"),
        },
        optional={
            "nmse_frozen": _plain("simulation", units="1"),
            "noise_ratio": _plain("tracker", "term", units="1"),
        },
    ),
    "gfrf": Contract(
        required={
            "H1": _for_each("input", "time", "frequency", "part"),
            "H2": _for_each("pair", "time_h2", "frequency_1", "frequency_2", "part"),
            **{f"{part}_{end}": _for_each("input", "time", "frequency") for part, end in _ENDS},
            **{
                f"H2_{part}_{end}": _for_each("pair", "time_h2", "frequency_1", "frequency_2")
                for part, end in _ENDS
            },
            "model_error_gain": _for_each("input", "frequency", units="1"),
            "model_error_phase": _for_each("input", "frequency", units="degree"),
            "H2_model_error_gain": _for_each("pair", "frequency", units="1"),
            "H2_model_error_phase": _for_each("pair", "frequency", units="degree"),
            "y0": _plain("time"),
            "y0_low": _plain("time"),
            "y0_high": _plain("time"),
            "input_spectrum": _for_each("input", "frequency"),
            "excited": _for_each("input", "frequency", units="1"),
            "excited_h2": _for_each("pair", "frequency_1", "frequency_2", units="1"),
        },
        optional={
            "H3": _for_each("input", "time_h2", "frequency_1", "frequency_2", "part"),
            "frequency_3": _plain(units="Hz"),
        },
    ),
    "control": Contract(
        required={
            "reference": _plain("time"),
            "measured": _plain("controller", "time"),
            "voltage": _plain("controller", "time"),
            "quality": _plain("controller", "time", units="1"),
            "rms_error": _plain("controller", "minute"),
            "stroke": _plain(),
            "outcome": _plain("controller", units="1"),
            "fallbacks": _plain("controller", units="1"),
            "proportional": _plain("controller"),
            "integral_time": _plain("controller", units="s"),
            "inverse_error": _plain("controller"),
            "effects": _plain("controller", units="1"),
        }
    ),
    "forecast": Contract(
        required={
            "error": _plain("forecaster", "horizon", "origin"),
            "rmse": _plain("forecaster", "horizon"),
        }
    ),
    "resolution": Contract(
        required={
            "probability": _plain("round", "hypothesis", units="1"),
            "rejected": _plain("round", "hypothesis", units="1"),
            "driven": _plain("round", units="s"),
            "status": _plain("round", units="1"),
            "names": _plain("round", units="1"),
            "error_before": _plain("round"),
            "error_after": _plain("round"),
            "form": _plain("round", units="1"),
            "closest": _plain("round", units="1"),
            "distance": _plain("round", units="1"),
        },
    ),
    "confirmation": Contract(
        required={
            "time": _plain("stretch", units="s"),
            "response": _plain("stretch", "frequency", "part"),
            "model": _plain("stretch", "frequency", "part"),
            "in_band": _plain("frequency", units="1"),
            "excited_level": _plain("stretch", "frequency"),
            "output_level": _plain("stretch", "detection_frequency"),
            "output_noise": _plain("stretch", "detection_frequency"),
            "odd": _plain("detection_frequency", units="1"),
            **{
                name: _plain("stretch", "frequency")
                for name in (
                    "gain_low",
                    "gain_high",
                    "phase_low",
                    "phase_high",
                    "response_noise",
                    "response_std",
                    "distortion",
                    "model_gain_low",
                    "model_gain_high",
                    "model_phase_low",
                    "model_phase_high",
                    "gain_difference",
                    "phase_difference",
                    "gain_band",
                    "phase_band",
                    "inside",
                )
            },
            "ratio": _plain("stretch", "even_frequency", "part", units="1"),
            **{
                name: _plain("stretch", "even_frequency")
                for name in (
                    "even_measured",
                    "even_predicted",
                    "even_noise",
                    "even_in_band",
                    "even_judged",
                    "even_inside",
                    "ratio_radius",
                )
            },
        },
        attributes=("tracker", "estimator", "model_band_withheld"),
    ),
    "scores": Contract(
        required={
            **{name: _plain("trial", units="1") for name in _TRIAL_TEXTS},
            "strength": _plain("trial", units="1"),
            "confidence": _plain("trial", units="1"),
            "truth_error": _plain("trial", units="1"),
            "error_before": _plain("trial"),
            "error_after": _plain("trial"),
            "noise_floor": _plain("trial"),
            "confusion": _plain("hidden_effect", "said_effect", units="1"),
            "effect_outcomes": _plain("hidden_effect", "possible_outcome", units="1"),
            "strength_bin_outcomes": _plain("strength_bin", "possible_outcome", units="1"),
            "excitation_kind_outcomes": _plain("excitation_kind", "possible_outcome", units="1"),
            "form_outcomes": _plain("form", "possible_outcome", units="1"),
            "device_kind_outcomes": _plain("device_kind", "possible_outcome", units="1"),
            "noise_kind_outcomes": _plain("noise_kind", "possible_outcome", units="1"),
            "rate": _plain("measure", units="1"),
            "rate_at_most": _plain("measure", units="1"),
            "coverage": _plain("rank", units="1"),
            "risk": _plain("rank", units="1"),
        }
    ),
    "localisation": Contract(
        required={
            "rms_before": _plain(),
            "rms_after": _plain(),
            **{
                f"{along}_{part}_{when}": _plain(f"{along}_{when}")
                for along in ("time", "output", "direction", "reversal")
                for part in ("low", "high", "rms", "null")
                for when in ("before", "after")
            },
        },
        # Each of several inputs has its own: input_1 and so on.
        optional={
            f"input_{part}_{when}": _plain(f"input_{when}")
            for part in ("low", "high", "rms", "null")
            for when in ("before", "after")
        },
    ),
    "candidates": Contract(
        required={
            "gain": _plain("candidate", units="1"),
            "gain_low": _plain("candidate", units="1"),
            "gain_high": _plain("candidate", units="1"),
            "share": _plain("candidate", units="1"),
            "error": _plain("candidate"),
            "visible": _plain("candidate", units="1"),
            "null_gain": _plain(units="1"),
            "set_error": _plain("set"),
            "confusion": _plain("present", "called", units="1"),
        }
    ),
    "certificate": Contract(
        required={
            "time": _plain("time", units="s"),
            "input": Variable(("time",), of_inputs=("time", "signal")),
            "measured": _plain("time"),
            "nominal": _plain("time"),
            "extended": _plain("time"),
            "role": _plain("time", units="1"),
            "noise_floor": _plain(),
            "coloured_level": _plain(),
            "record_rmse_before": _plain("record"),
            "record_rmse_after": _plain("record"),
        },
        optional={
            f"law_{number}_{part}": _plain("time")
            for number in (1, 2, 3)
            for part in ("along", "value", "low", "high", "idle")
        },
    ),
}
