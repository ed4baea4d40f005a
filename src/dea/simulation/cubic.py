"""The cubic through four equidistant values."""

from numba import njit


@njit(cache=True, error_model="numpy")
def weights(place: float) -> tuple[float, float, float, float]:
    """Return the weights of the values at 0, 1, 2 and 3 in their cubic's value at ``place``."""
    a, b, c, d = place, place - 1.0, place - 2.0, place - 3.0
    return -b * c * d / 6.0, 0.5 * a * c * d, -0.5 * a * b * d, a * b * c / 6.0
