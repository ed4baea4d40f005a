"""Polynomial NARX models: build, simulate, predict, print, save and load."""

from collections.abc import Mapping
from dataclasses import asdict, astuple, dataclass, field, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from dea import store
from dea.arrays import Array
from dea.equation import equation_html, equation_latex
from dea.errors import InputError
from dea.given_numbers import is_count
from dea.missing import filled
from dea.narx.checks import as_input, as_signal
from dea.narx.labels import Labels, input_of, pair
from dea.narx.metrics import nmse
from dea.narx.model_dataset import model_dataset
from dea.narx.model_text import model_text
from dea.narx.prediction import predicted
from dea.narx.scaling import OneInput, Scaling, require_scaling
from dea.narx.simulation import simulate
from dea.narx.stability import Stability, StabilityTest, assess
from dea.store import Record, Text, input_names
from dea.terms import Term, as_terms, max_lag, numbered_inputs

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, eq=False)
class NarxModel:
    """A polynomial NARX model (2): y(t) = sum_j parameters[j] * terms[j], on scaled signals.

    Parameters
    ----------
    terms, parameters
        Monomials, or text such as ``y(t-1)u(t-3)^2``, each once, and their coefficients, shape
        (terms,).
    scaling
        From physical units to those of the equation and back.
    covariance
        Of the parameters, shape (terms, terms), where they were estimated.
    withheld
        Why intervals from the covariance cannot hold; empty where they can.
    trace
        Where the terms were selected, every candidate model tried; dimension ``trial``:
        ``trial_phase`` (basis, forward, pruning; orthogonal, exchange, final), ``trial_step``,
        ``trial_term``, ``trial_msse``, ``trial_serr`` and ``trial_status`` (added, pruned,
        exchanged, rejected, unstable, selected). Where the record set it, ``threshold``.
    checked
        Where the terms were selected, the stability of the final parameters.
    labels
        Rate, units and names of the signals, where the model comes from a :class:`dea.Record`.
    """

    terms: tuple[Term, ...]
    parameters: Array
    scaling: Scaling = field(default_factory=Scaling)
    covariance: Array | None = None
    trace: xr.Dataset | None = None
    withheld: str = ""
    checked: Stability | None = None
    labels: Labels = field(default_factory=Labels)

    def __post_init__(self) -> None:
        object.__setattr__(self, "terms", as_terms(self.terms))
        object.__setattr__(self, "parameters", as_signal(self.parameters, "parameters"))
        if not self.terms or len(set(self.terms)) < len(self.terms):
            raise InputError(
                "there is no term, or one occurs twice",
                field="terms",
                remedy="Name each monomial once; y(t-1)u(t-2) and u(t-2)y(t-1) are the same.",
            )
        require_scaling(self.scaling)
        named, scaled = numbered_inputs(self.terms), self.scaling.inputs
        if named is not None and scaled is not None and not 0 < named <= scaled:
            raise InputError(
                f"the terms name {f'inputs up to u{named}' if named else 'one input, u,'} and the"
                f" scaling is of {scaled}",
                field="scaling",
                remedy="Give one offset and one scale for every input of the terms.",
            )
        if self.parameters.size != len(self.terms):
            raise InputError(
                f"{self.parameters.size} parameters for {len(self.terms)} terms",
                field="parameters",
                remedy="Give one per term.",
            )

    @classmethod
    def from_terms(
        cls, terms: Mapping[str, float], *, scaling: Scaling | None = None
    ) -> "NarxModel":
        """Build a model from terms as people write them: ``{"y(t-1)": 0.9, "u(t-1)^2": 0.1}``.

        Raises
        ------
        InputError
            For text that is no term, a monomial that occurs twice, or terms without parameters.
        """
        if not isinstance(terms, Mapping):
            raise InputError(
                f"it is {type(terms).__name__}",
                field="terms",
                remedy='Give each its parameter, as {"y(t-1)": 0.9, "u(t-1)": 0.1}',
            )
        return NarxModel(
            as_terms(terms),
            as_signal(list(terms.values()), "parameters"),
            scaling or Scaling(),
        )

    @property
    def max_lag(self) -> int:
        """Samples at the start of a record that the model cannot compute."""
        return max_lag(self.terms)

    @property
    def inputs(self) -> int:
        """The number of inputs: 1, or as many as scaling, labels and terms tell."""
        named = numbered_inputs(self.terms)
        return self.scaling.inputs or max(len(self.labels.inputs), named or 1)

    @property
    def named_inputs(self) -> list[tuple[str, str]]:
        """Name and units of each input, whether or not the labels have them."""
        known = self.labels.inputs
        if len(known) == self.inputs:
            return known
        return [(name, known[0][1]) for name in input_names(self.inputs)]

    def of_one_input(self, purpose: str) -> OneInput:
        """Return the scaling of a model with a single input, all that ``purpose`` knows.

        Raises
        ------
        InputError
            If the model has several inputs.
        """
        if self.inputs > 1:
            raise InputError(
                f"{purpose} takes models with one input, and this one has {self.inputs}",
                field="model",
                remedy="Select a model of one input, the others held constant.",
            )
        return OneInput(*astuple(self.scaling))

    @property
    def standard_errors(self) -> Array | None:
        """Standard deviation of each parameter, or None where none was estimated."""
        return None if self.covariance is None else np.sqrt(np.diag(self.covariance))

    def simulate(self, u: ArrayLike | Record, y_initial: ArrayLike | None = None) -> Array:
        """Free-run simulation: the model is fed its own past outputs.

        Parameters
        ----------
        u
            Input in physical units, shape (samples,), or a :class:`dea.Record`, whose input is
            taken; several are columns, (samples, inputs). The columns of a pandas frame are found
            by the names that the model knows.
        y_initial
            The first ``max_lag`` outputs in physical units; more may be given, so that a measured
            output can be passed whole. By default input and output are at their offsets before
            the first sample, and what then settles is part of the run.

        Returns
        -------
        ndarray
            Output in physical units, shape (samples,). Its first ``max_lag`` samples are
            ``y_initial`` where that is given; from the sample on where the run diverges, beyond
            1e10 in the units of the equation, it is ``inf``.
        """
        inputs, initial, before = self.run_from(u, y_initial)
        run = simulate(self.terms, self.parameters, inputs, initial)
        return self.scaling.restore_output(run[before:])

    def run_from(
        self, u: ArrayLike | Record, y_initial: ArrayLike | None
    ) -> tuple[Array, Array, int]:
        """Return what a run of :meth:`simulate` starts from, in the units of the equation.

        Returns
        -------
        inputs, initial, before
            Inputs, first outputs, and how many samples of rest precede the first one of ``u``.
        """
        inputs = self.scaling.normalise_input(as_input(input_of(self.labels, u)))
        if y_initial is not None:
            given = self.scaling.normalise_output(as_signal(y_initial, "y_initial", missing=True))
            return inputs, as_signal(given[: self.max_lag], "y_initial"), 0
        rest = np.zeros((self.max_lag, *inputs.shape[1:]))
        return np.concatenate([rest, inputs]), np.zeros(self.max_lag), self.max_lag

    def predict(
        self, u: ArrayLike | Record, y: ArrayLike | None = None, *, steps: int = 1
    ) -> Array:
        """Prediction from measured outputs up to ``steps`` samples ago.

        Parameters
        ----------
        u, y
            Measured input and output in physical units, shape (samples,), or a record alone;
            several inputs are the columns of ``u``. The
            prediction is NaN where a missing output (NaN) enters it.
        steps
            How many samples ahead; from the outputs measured until then the model runs freely.

        Returns
        -------
        ndarray
            Predicted output in physical units, shape (samples,); its first ``max_lag + steps - 1``
            samples, whose past is unknown, are the measured ones.
        """
        if not is_count(steps):
            raise InputError(
                f"it is {steps!r}", field="steps", remedy="Predict a whole number of samples ahead"
            )
        inputs, outputs = pair(self.labels, u, y, self.max_lag + steps - 1)
        return predicted(self.terms, self.parameters, self.scaling, inputs, outputs, steps)

    def score(self, u: ArrayLike | Record, y: ArrayLike | None = None) -> float:
        """Return the share of the output's variance that the free run explains, 1 - nmse.

        The run starts from the first measured outputs, which are not scored; missing ones are not
        either. A run that diverges scores minus infinity.

        Raises
        ------
        InputError
            If the record is not usable, or its output does not vary.
        """
        inputs, recorded = pair(self.labels, u, y, self.max_lag)
        outputs, seen = filled(recorded)
        seen[: self.max_lag] = False
        scored = outputs[seen]
        if not scored.size or not np.ptp(scored):
            raise InputError(
                "it has no variance that a run could explain",
                field="y",
                remedy="Compare it with simulate() in its own units.",
            )
        return 1.0 - nmse(scored, self.simulate(inputs, outputs)[seen])

    def plot(
        self, u: ArrayLike | Record, y: ArrayLike | None = None, *, axes: "Axes | None" = None
    ) -> "Axes":
        """Draw measured output and free run over time into matplotlib's ``axes``, or new ones."""
        from dea.narx.plot import plot_run

        inputs, outputs = pair(self.labels, u, y, self.max_lag)
        return plot_run(self.labels, outputs, self.simulate(inputs, filled(outputs)[0]), axes)

    def with_parameters(
        self, parameters: ArrayLike, covariance: Array | None = None, withheld: str = ""
    ) -> Self:
        """Return the same structure with other parameters."""
        values = as_signal(parameters, "parameters")
        return replace(
            self, parameters=values, covariance=covariance, withheld=withheld, checked=None
        )

    def stability(
        self, u: ArrayLike | Record | None = None, y: ArrayLike | None = None
    ) -> Stability:
        """Try the model on inputs like those of a record.

        Poles at rest over the whole input range, holds at twenty levels, a hundred long random
        inputs with the values and the spectrum of the record's, and twenty phase-randomised ones.

        Parameters
        ----------
        u, y
            The record in physical units, or a :class:`dea.Record` alone. By default that of the
            selection, whose report the model holds.

        Raises
        ------
        InputError
            Without a record, if the model does not come from a selection; if the output does not
            vary.
        """
        if u is None:
            if self.checked is None:
                raise InputError(
                    "the model was not selected from a record",
                    field="u, y",
                    remedy="Give the input and output of a record that it is meant for.",
                )
            return self.checked
        inputs, recorded = pair(self.labels, u, y, self.max_lag)
        outputs, _ = filled(recorded)
        if not np.ptp(outputs):
            raise InputError(
                "it is constant, and runs are compared with its range",
                field="y",
                remedy="Give a record in which the output moves.",
            )
        segment = self.scaling.normalise_input(inputs), self.scaling.normalise_output(outputs)
        return assess(self.terms, self.parameters, self.scaling, StabilityTest([segment]))

    @property
    def status(self) -> str:
        """``stable``, ``slow`` or ``unstable`` in its selection; ``not tested`` without one."""
        return "not tested" if self.checked is None else self.checked.status

    def to_dataset(self, u_units: Text | None = None, y_units: str | None = None) -> xr.Dataset:
        """Return the model and its trace as labelled data, as ``model.nc`` holds them.

        Units are by default those of the model's labels. Offsets and scales of several inputs have
        the dimension ``input``; their units are listed where they differ.
        """
        return model_dataset(self, u_units, y_units)

    @classmethod
    def from_dataset(cls, dataset: xr.Dataset) -> "NarxModel":
        """Return the model that :meth:`to_dataset` described."""
        trace = [name for name, variable in dataset.items() if variable.dims == ("trial",)]
        trace += ["threshold"] if "threshold" in dataset else []
        return NarxModel(
            tuple(map(Term.parse, dataset["term"].values.tolist())),
            dataset["parameter"].values,
            Scaling(**{item.name: dataset[item.name].values.tolist() for item in fields(Scaling)}),
            dataset["covariance"].values if "covariance" in dataset else None,
            dataset[trace].drop_attrs(deep=False) if trace else None,
            dataset.attrs.get("withheld", ""),
            Stability.from_dataset(dataset) if "rest_pole" in dataset else None,
            Labels.from_attributes(dataset.attrs),
        )

    def to_dict(self) -> dict[str, Any]:
        """Return terms, parameters, scaling and labels as plain values, for JSON or YAML."""
        return {
            "terms": dict(zip(map(str, self.terms), self.parameters.tolist(), strict=True)),
            "scaling": _lists(asdict(self.scaling)),
            "labels": _lists(asdict(self.labels)),
        }

    @classmethod
    def from_dict(cls, content: Mapping[str, Any]) -> "NarxModel":
        """Return the model that :meth:`to_dict` described.

        Raises
        ------
        InputError
            If there are no terms, or one is none; if the scaling holds something unknown.
        """
        if "terms" not in content:
            raise InputError("there is none", field="terms", remedy="Give what to_dict returned.")
        scaling, known = content.get("scaling", {}), [item.name for item in fields(Scaling)]
        if unknown := set(scaling) - set(known):
            raise InputError(
                f"it holds {', '.join(sorted(map(str, unknown)))}",
                field="scaling",
                remedy=f"It has {', '.join(known)}",
            )
        model = cls.from_terms(content["terms"], scaling=Scaling(**scaling))
        return replace(model, labels=Labels.from_attributes(content.get("labels", {})))

    def save(
        self, path: str | Path, *, u_units: Text | None = None, y_units: str | None = None
    ) -> None:
        """Write the model, and its selection trace where it has one, as NetCDF."""
        store.write(self.to_dataset(u_units, y_units), path, title="Polynomial NARX model")

    @classmethod
    def load(cls, path: str | Path) -> "NarxModel":
        """Read a model that :meth:`save` or the study wrote."""
        return NarxModel.from_dataset(store.read(path, "model"))

    def _repr_latex_(self) -> str:
        """Return the equation with four digits, as a notebook sets it."""
        return f"$\\displaystyle {equation_latex(self.terms, self.parameters)}$"

    def _repr_html_(self) -> str:
        """Return the equation with four digits and the scaling of its signals, for a notebook."""
        units = self.labels.y_units
        return equation_html(
            self.terms, self.parameters, asdict(self.scaling), self.named_inputs, units
        )

    def __str__(self) -> str:
        """Return the equation that is simulated, every digit of its parameters included."""
        return model_text(self)


def _lists(values: Mapping[str, Any]) -> dict[str, Any]:
    return {name: list(v) if isinstance(v, tuple) else v for name, v in values.items()}
