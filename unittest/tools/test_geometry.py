"""Geometry of points, against sums over all pairs."""

import numpy as np

from fsi import geometry

RANDOM = np.random.default_rng(2)


def test_vorticity():
    x, y = RANDOM.uniform(-1, 1, (2, 400))
    # of a linear field it is exact: twice the rate of rotation, whatever strain and stream come
    # with it
    u, v = 3 + 0.4 * x - 1.1 * y, -2 + 0.7 * x - 0.4 * y
    np.testing.assert_allclose(geometry.vorticity(x, y, u, v, 0.4), 1.8, rtol=1e-9)
    # of another it is the best fit's, one particle at a time
    u, v = np.sin(3 * y) + x * y, np.cos(2 * x) - y**2
    expected = []
    for k in range(len(x)):
        ex, ey = x - x[k], y - y[k]
        weight = np.sqrt(np.maximum(0.0, 1 - (ex**2 + ey**2) / 0.4**2))
        gradient = np.linalg.lstsq(weight[:, None] * np.column_stack([ex, ey]), weight[:, None]
                                   * np.column_stack([u - u[k], v - v[k]]), rcond=None)[0]
        expected.append(gradient[0, 1] - gradient[1, 0])
    np.testing.assert_allclose(geometry.vorticity(x, y, u, v, 0.4), expected, rtol=1e-8, atol=1e-10)


def test_vorticity_of_points_that_do_not_tell():
    x = np.array([0.0, 0.1, 0.2, 5.0])
    assert not geometry.vorticity(x, 2 * x, x, -x, 1.0).any()


def test_min_pair_distance():
    for points in (RANDOM.uniform(-1, 1, (300, 2)), RANDOM.uniform(-1, 1, (300, 3))):
        apart = np.linalg.norm(points[:, None] - points,
                               axis=2) + np.where(np.eye(300), np.inf, 0.0)
        assert np.isclose(geometry.min_pair_distance(points, 0.01), apart.min(), rtol=1e-12)
    assert geometry.min_pair_distance(np.zeros((1, 2)), 1.0) == np.inf
