"""C99 code of a model, for controllers that have no Python.

The code allocates nothing, does not recurse and calls no library; each call takes the same time.
It follows the rules of MISRA C:2012 that a generator can see to: fixed sizes, braces, one return,
no implicit conversion.
"""

import re
from pathlib import Path
from textwrap import wrap
from typing import NamedTuple

from dea.atomic_file import atomic
from dea.control.c_templates import HEADER, SOURCE
from dea.errors import InputError
from dea.narx import BOUND, NarxModel, rate_of
from dea.terms import Term, max_lag

_IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,30}")

_KEPT_BLANK = "\N{NO-BREAK SPACE}"


class CCode(NamedTuple):
    """The two files of a model: ``header`` is model.h and ``source`` model.c."""

    header: str
    source: str

    def write(self, header: str | Path, source: str | Path) -> None:
        """Write both files, which lie in one folder; the header is called ``model.h``."""
        for path, text in ((header, self.header), (source, self.source)):
            with atomic(path) as partial:
                partial.write_text(text, encoding="utf-8")


def to_c(model: NarxModel, sampling_rate: float | None = None, *, name: str = "model") -> CCode:
    """Return C99 code that computes the free run of ``model`` sample by sample.

    Parameters
    ----------
    sampling_rate
        In Hz; only stated in the code. By default that of the model's own record.
    name
        Begins every name that the code exports, so that several models fit one program.

    Raises
    ------
    InputError
        If ``name`` is no C identifier of up to 31 characters, the rate is not positive, not known
        or not the model's own, or the model has several inputs.
    """
    if not _IDENTIFIER.fullmatch(name):
        raise InputError(
            f"{name!r} is no name in C",
            field="name",
            remedy="Use letters, digits and underscores, a letter first, 31 at most.",
        )
    rate = rate_of(model.labels, sampling_rate)
    of_input = model.of_one_input("C code")
    scaling = {key: number(value) for key, value in of_input._asdict().items()}
    words = {
        "name": name,
        "guard": name.upper(),
        "rate": rate,
        "status": model.status,
        "period": number(1.0 / rate),
        "inputs": f"{input_lags(model)}U",
        "outputs": f"{output_lags(model)}U",
    }
    equation = "\n".join(f" *     {line}" for line in _wrapped(str(model)))
    return CCode(
        HEADER.format(equation=equation, **words),
        SOURCE.format(
            **words,
            **scaling,
            bound=number(BOUND),
            count=len(model.terms),
            parameters="\n".join(
                f"    {number(value)}, /* {term} */"
                for term, value in zip(model.terms, model.parameters.tolist(), strict=True)
            ),
            lags=_lags(model.terms),
            sum="\n".join([*_unused(model.terms), *_sum(model.terms)]),
        ),
    )


def c_identifier(name: str) -> str:
    """Return the name in C of a system: what C does not allow becomes an underscore."""
    allowed = re.sub(r"[^A-Za-z0-9_]", "_", name)
    return (allowed if allowed[:1].isalpha() else f"model_{allowed}")[:31]


def input_lags(model: NarxModel) -> int:
    """Return how many past inputs the code keeps; an array in C has one entry at least."""
    return max((lag for term in model.terms for lag in term.u_lags), default=0) or 1


def output_lags(model: NarxModel) -> int:
    """Return how many past outputs the code keeps, one at least."""
    return max((lag for term in model.terms for lag in term.y_lags), default=0) or 1


def has_feedthrough(model: NarxModel) -> bool:
    """Whether an input reaches the output of the same sample."""
    return any(0 in term.u_lags for term in model.terms)


def number(value: float) -> str:
    """Return a number as a C constant of type double, with the 17 digits that determine it."""
    text = f"{value:.17g}"
    return text if re.search(r"[.e]", text) else f"{text}.0"


def _lags(terms: tuple[Term, ...]) -> str:
    """Return the declarations of the lagged signals that the terms use."""
    lines = [
        f"    const double y{lag} = state->y[{lag - 1}];"
        for lag in sorted({lag for term in terms for lag in term.y_lags})
    ]
    for lag in sorted({lag for term in terms for lag in term.u_lags}):
        past = f"state->u[{lag - 1}]" if lag else "(input - U_OFFSET) / U_SCALE"
        lines.append(f"    const double u{lag} = {past};")
    return "\n".join(lines)


def _unused(terms: tuple[Term, ...]) -> list[str]:
    """Return statements for the arguments that no term uses, which compilers warn of otherwise."""
    lines = [] if any(0 in term.u_lags for term in terms) else ["    (void)input;"]
    return lines if max_lag(terms) else [*lines, "    (void)state;"]


def _sum(terms: tuple[Term, ...]) -> list[str]:
    """Return a statement for each term."""
    return [
        f"    y0 += {' * '.join([f'theta[{j}]', *_factors(term)])};" for j, term in enumerate(terms)
    ]


def _wrapped(equation: str) -> list[str]:
    """Return the lines of an equation, those that are long broken before a sign."""
    kept = re.sub(r"(?<=[+-]) | (?=[yu]\()", _KEPT_BLANK, equation)
    lines = [
        part for line in kept.splitlines() for part in wrap(line, 88, subsequent_indent=" " * 7)
    ]
    return [line.replace(_KEPT_BLANK, " ") for line in lines]


def _factors(term: Term) -> list[str]:
    return [f"y{lag}" for lag in term.y_lags] + [f"u{lag}" for lag in term.u_lags]
