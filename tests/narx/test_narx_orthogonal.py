"""FROLS against orthogonalisation written out term by term."""

import numpy as np

from dea.narx import NarxModel, Orthogonal, Scaling, select_terms
from dea.narx.orthogonal import orthogonal_order


def slow_order(matrix, target, most):
    """Billings (2013), section 3.2: orthogonalise every candidate to those taken, by hand."""
    taken, order, ratios = [], [], []
    for _ in range(most):
        best = (-1.0, None, None)
        for j in range(matrix.shape[1]):
            if j in order:
                continue
            w = matrix[:, j] - sum(
                (q * (q @ matrix[:, j]) / (q @ q) for q in taken), np.zeros(target.size)
            )
            ratio = (w @ target) ** 2 / ((w @ w) * (target @ target))
            if ratio > best[0]:
                best = (ratio, j, w)
        ratios.append(best[0])
        order.append(best[1])
        taken.append(best[2])
    return order, ratios


def compressed(matrix, target):
    return np.ascontiguousarray(np.linalg.qr(np.column_stack([matrix, target]), mode="r").T)


def test_terms_and_ratios_are_those_of_the_textbook():
    rng = np.random.default_rng(0)
    matrix = rng.standard_normal((200, 12)) @ rng.standard_normal((12, 12))
    target = matrix[:, [1, 4, 7]] @ [1.0, -0.5, 0.2] + 0.1 * rng.standard_normal(200)
    order, ratios = orthogonal_order(compressed(matrix, target)[None], 8)
    expected, shares = slow_order(matrix, target, 8)
    assert order.tolist() == expected
    np.testing.assert_allclose(ratios, shares, rtol=1e-8)


def test_ratios_of_several_systems_are_averaged():
    rng = np.random.default_rng(1)
    matrices = [rng.standard_normal((100, 3)) for _ in range(2)]
    # Each system's own first term explains it alone; the third explains half of both.
    targets = [
        matrix[:, own] + 0.9 * matrix[:, 2] for own, matrix in zip((0, 1), matrices, strict=True)
    ]
    triangles = np.stack([compressed(*pair) for pair in zip(matrices, targets, strict=True)])
    order, ratios = orthogonal_order(triangles, 1)
    assert order.tolist() == [2]
    alone = [slow_order(m[:, [2]], t, 1)[1][0] for m, t in zip(matrices, targets, strict=True)]
    np.testing.assert_allclose(ratios, [np.mean(alone)], rtol=1e-8)


def test_dependent_terms_are_taken_once():
    u = np.random.default_rng(2).standard_normal(50)
    order, _ = orthogonal_order(compressed(np.column_stack([u, 2 * u]), u)[None], 2)
    assert order.size == 1


def test_the_orthogonal_search_finds_the_terms_of_a_system_without_noise():
    plant = NarxModel.from_terms({"y(t-1)": 0.5, "u(t-1)": 0.4, "u(t-1)^2": 0.3})
    u = np.random.default_rng(3).uniform(-1, 1, 400)
    found = select_terms(
        u, plant.simulate(u), y_lags=1, u_lags=2, degree=2,
        search=Orthogonal(max_terms=3), scaling=Scaling(),
    )  # fmt: skip
    assert set(found.terms) == set(plant.terms)
