"""A random generator for each job, so that results do not depend on the order of jobs."""

import hashlib

import numpy as np

from dea.errors import InputError
from dea.given_numbers import is_count


def generator(seed: int, *names: str) -> np.random.Generator:
    """Return the generator of the job ``names``, which follows from the study's ``seed``.

    Raises
    ------
    InputError
        If the seed is no whole number from 0 on.
    """
    if not is_count(seed, 0):
        raise InputError(
            f"it is {seed!r}", field="seed", remedy="Give a whole number of at least 0."
        )
    digest = hashlib.sha256("/".join(names).encode()).digest()
    return np.random.default_rng([seed, int.from_bytes(digest[:8], "big")])
