"""Inclusion frequency of each selected term: how often selection on resampled records finds it."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from dea.arrays import Array
from dea.errors import InputError
from dea.narx.estimation import as_segments, scaling_of
from dea.narx.labels import Signals, unpacked
from dea.narx.selection import least_stretch, search_terms
from dea.store import Record
from dea.terms import Term, as_terms


def inclusion_frequency(
    terms: Iterable[Term | str],
    u: Signals | Record | Sequence[Record],
    y: Signals | None = None,
    *,
    rng: np.random.Generator,
    resamples: int = 20,
    blocks: int = 10,
    **selection: Any,
) -> Array:
    """Share of bootstrap resamples whose selection contains each of ``terms``.

    The records are cut into contiguous blocks of about one length, which keeps the dynamics inside
    them; each resample draws as many blocks with replacement and selects terms on them anew. A low
    share means that other terms describe the data equally well, often neighbouring lags of a smooth
    signal.

    Parameters
    ----------
    terms
        Terms, as text or parsed.
    u, y
        Records as for :func:`dea.narx.select_terms`.
    rng
        Draws the blocks.
    resamples, blocks
        Number of selections, one at least, and of blocks that the records are cut into, two.
    selection
        Further arguments of :func:`dea.narx.select_terms`. The scaling is by default that of the
        whole records, so that terms are comparable between resamples.

    Returns
    -------
    ndarray
        Shape (terms,), each 0 to 1.

    Raises
    ------
    InputError
        If there are too few resamples or blocks, as well as for what
        :func:`dea.narx.select_terms` refuses.
    """
    for field, given, least in (("resamples", resamples, 1), ("blocks", blocks, 2)):
        if given < least:
            raise InputError(f"is {given}", field=field, remedy=f"Use {least} at least.")
    sought = as_terms(terms)
    inputs, outputs, _ = unpacked(u, y, *least_stretch(u, **selection))
    records = as_segments(inputs, outputs)
    scaling = scaling_of(records, not selection.get("even_in_input", False))
    settings = {"scaling": scaling} | selection
    total = sum(other.size for _, other in records)
    pieces: list[tuple[Array, Array]] = []
    for one, other in records:
        parts = max(1, round(blocks * other.size / total))
        pieces += zip(np.array_split(one, parts), np.array_split(other, parts), strict=True)
    found = []
    for _ in range(resamples):
        drawn = [pieces[i] for i in rng.integers(0, len(pieces), len(pieces))]
        found.append(search_terms(*map(list, zip(*drawn, strict=True)), **settings).terms)
    return np.array([np.mean([term in each for each in found]) for term in sought])
