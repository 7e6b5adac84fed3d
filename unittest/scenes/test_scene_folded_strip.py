"""The beam that the folded strip is judged by, and a short form of the scene."""

import numpy as np
import pytest
from scenes import run_scene

from fsi import scene

ANALYSIS = scene.analysis("folded_strip")
VALUES = {"thickness": 0.01, "gap": 0.01, "length": 0.25}


def obstacle(load, shear, elements=125):
    """(free length, mean displacement) of a cantilever that `load` [N/m] presses on a plane at half
    the gap: linear elements, one shear point each (without shear: a thousandfold shear stiffness),
    nodes beyond the plane held there while it pushes."""
    thick, length, apart = VALUES["thickness"], VALUES["length"], 0.5 * VALUES["gap"]
    bending = ANALYSIS.YOUNG / (1 - ANALYSIS.POISSON**2) * thick**3 / 12
    shearing = 5 / 6 * ANALYSIS.YOUNG / 2 / (1 + ANALYSIS.POISSON) * thick * (1 if shear else 1000)
    step, n = length / elements, elements + 1
    matrix, source = np.zeros((2 * n, 2 * n)), np.zeros(2 * n)
    curvature, slide = np.array([0, -1, 0, 1]) / step, np.array([-1 / step, -0.5, 1 / step, -0.5])
    for e in range(elements):
        at = np.arange(2 * e, 2 * e + 4)
        matrix[np.ix_(at, at)] += step * (bending * np.outer(curvature, curvature) + shearing
                                          * np.outer(slide, slide))
        source[at[::2]] += 0.5 * load * step
    held = np.zeros(n, bool)
    for _ in range(200):
        known = np.zeros(2 * n, bool)
        known[::2] = held
        known[:2] = True
        u = np.zeros(2 * n)
        u[::2][held] = apart
        u[~known] = np.linalg.solve(matrix[np.ix_(~known, ~known)], (source - matrix @ u)[~known])
        push = (matrix @ u - source)[::2]  # what a held node needs, > 0 away from the plane
        now = np.where(held, push < 0, u[::2] > apart)
        now[0] = False
        if (now == held).all():
            break
        held = now
    return step * np.flatnonzero(held).min(), np.trapz(u[::2], dx=step) / length


@pytest.mark.parametrize("shear", [True, False])
@pytest.mark.parametrize("free", [0.2, 0.15, 0.125])
def test_beam(free, shear):
    """Against finite elements with an obstacle: where contact begins to a node, the mean
    displacement to 0.1 %."""
    load, mean = ANALYSIS.theory(free, VALUES, shear)
    begins, other = obstacle(load * ANALYSIS.DENSITY * VALUES["thickness"], shear)
    assert begins == pytest.approx(free, abs=0.25 / 125)
    assert other == pytest.approx(mean, rel=1e-3)


def test_arms_lie_on_each_other(tmp_path):
    """Four particles through an arm, half of the load: the target of the scene, 1 % of the mean
    displacement; contact begins where the beam's does to half a thickness."""
    figures = run_scene(tmp_path, "folded_strip", tend=1)
    free, load, mean = ANALYSIS.table(VALUES)
    push = 6.75 * ANALYSIS.series.read(tmp_path / "strip.csv").time[-1]
    assert figures["mean_displacement"] == pytest.approx(1e3 * np.interp(push, load, mean),
                                                         rel=0.01)
    assert figures["free_length"] == pytest.approx(1e3 * np.interp(push, load, free), abs=5)
    assert 0.99 < figures["nearest_rows"] < 1.0  # they push, and barely enter each other
    assert figures["asymmetry"] < 1e-10
