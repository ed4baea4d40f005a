"""A shift in time by parts of a sample: instruments seldom log input and output at one instant."""

import numpy as np


def shifted(y: np.ndarray, samples: float) -> np.ndarray:
    """Return ``y`` (n,) as it is logged ``samples`` late (early where negative), shape (n,).

    Between samples it is a cubic that joins them smoothly (Keys 1981, IEEE Transactions on
    Acoustics, Speech and Signal Processing 29:1153), so that the result has a continuous
    derivative by the shift, also at zero. Beyond its ends the signal keeps their values.
    """
    if samples == 0.0:
        return y
    whole = int(np.floor(samples))
    a = 1.0 - (samples - whole)
    weights = 0.5 * np.array(
        [
            ((2.0 - a) * a - 1.0) * a,
            (3.0 * a - 5.0) * a**2 + 2.0,
            ((4.0 - 3.0 * a) * a + 1.0) * a,
            (a - 1.0) * a**2,
        ]
    )
    reach = abs(whole) + 3
    padded = np.concatenate([np.full(reach, y[0]), y, np.full(reach, y[-1])])
    first = reach - whole - 2
    result: np.ndarray = sum(
        weight * padded[first + k : first + k + y.size] for k, weight in enumerate(weights)
    )
    return result
