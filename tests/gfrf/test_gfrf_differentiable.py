"""Derivatives that arrays carry, against central differences."""

import numpy as np
import pytest

from dea.gfrf.differentiable import Differentiable

STEP = 1e-6
PLAIN = np.array([0.7, -1.3, 2.1])


@pytest.mark.parametrize(
    "rule",
    [
        lambda a, b: a + b,
        lambda a, b: a + PLAIN,
        lambda a, b: PLAIN + a,
        lambda a, b: PLAIN - a,
        lambda a, b: a * b,
        lambda a, b: a * PLAIN,
        lambda a, b: PLAIN * a,
        lambda a, b: a / b,
        lambda a, b: a / PLAIN,
        lambda a, b: PLAIN / a,
        lambda a, b: a**3,
        lambda a, b: a**1,
        lambda a, b: a**0,
        lambda a, b: (1.0 / (2.0 - a * b) + a**2 * PLAIN) / b,
        lambda a, b: a[1:] * b[:-1],
        lambda a, b: a[2] + b[0],
    ],
)
@pytest.mark.parametrize("turn", [1.0, np.exp(0.4j)])
def test_every_rule_agrees_with_central_differences(rule, turn):
    rng = np.random.default_rng(3)
    a, b = rng.uniform(0.5, 1.5, (2, 3)) * turn
    along_a, along_b = rng.standard_normal((2, 4, 3))
    found = rule(Differentiable(a, along_a), Differentiable(b, along_b))
    np.testing.assert_allclose(found.value, rule(a, b))
    for slope, da, db in zip(found.slope, along_a, along_b, strict=True):
        ahead, behind = (rule(a + h * da, b + h * db) for h in (STEP, -STEP))
        np.testing.assert_allclose(slope, (ahead - behind) / (2 * STEP), atol=1e-8)
