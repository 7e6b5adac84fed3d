"""The theory that the submerged plate is judged by, and a short form of the scene."""

import numpy as np
import pytest
from scenes import run_scene

from fsi import scene

ANALYSIS = scene.analysis("submerged_plate")
ROOT, TOP, THICK, DEPTH = 0.01, 0.11, 0.005, 0.16


def test_frequencies():
    """In vacuo Euler's cantilever, less 0.2 % of shear and rotation. In water, of a tank short
    enough for it, finite differences: Rayleigh's quotient with the mode in vacuo, on cells half as
    wide as the plate is thick, which get a corner right to their width."""
    half, cell = 0.1025, 0.0025
    vacuo, wet = ANALYSIS.theory(ROOT, TOP, THICK, DEPTH, half)
    length, bending = TOP - ROOT, ANALYSIS.YOUNG / (1 - ANALYSIS.POISSON**2) * THICK**3 / 12
    euler = 1.8751**2 / (2 * np.pi * length**2) * np.sqrt(bending / (ANALYSIS.DENSITY * THICK))
    assert vacuo == pytest.approx(0.998 * euler, rel=0.002)

    nx, ny = round(half / cell), round(DEPTH / cell)
    y = (np.arange(ny) + 0.5) * cell
    z = 1.8751 * np.clip((y - ROOT) / length, 0, None)
    mode = np.where(y < TOP, np.cosh(z) - np.cos(z) - 0.7341 * (np.sinh(z) - np.sin(z)), 0)
    matrix, source = np.zeros((nx * ny, nx * ny)), np.zeros(nx * ny)
    for i in range(nx):
        for j in range(ny):
            # the first column is the plate's half and what is above it
            k, solid = i * ny + j, i == 0 and y[j] < TOP
            for other, inside in ((k + ny, i < nx - 1), (k - ny, i > 0), (k + 1, j < ny - 1),
                                  (k - 1, j > 0)):
                if not inside or solid:
                    continue
                # the plate's face, or its end, which does not move up
                if other < ny and y[other] < TOP:
                    source[k] -= mode[j] * cell * (other == k - ny)
                else:
                    matrix[k, k] += 1
                    matrix[k, other] -= 1
            if solid:
                matrix[k, k] = 1
            elif i == 0:
                matrix[k, k] += 2    # odd about the middle
            if j == ny - 1 and not solid:
                matrix[k, k] += 2    # no pressure at the surface
    potential = np.linalg.solve(matrix, source).reshape(nx, ny)
    added = -2 * ANALYSIS.WATER_DENSITY * (potential[1] * mode).sum() * cell
    own = ANALYSIS.DENSITY * THICK * (mode**2).sum() * cell
    assert wet == pytest.approx(vacuo * np.sqrt(own / (own + added)), rel=0.03)
    assert ANALYSIS.theory(ROOT, TOP, THICK, DEPTH, half,
                           sound=20.0)[1] == pytest.approx(wet, rel=0.01)


def test_rests(tmp_path):
    """Nobody gets into the plate or through it"""
    figures = run_scene(tmp_path, "submerged_plate", push=0, tend=0.02, frames=4)
    assert figures["particles_leaked"] == figures["particles_inside_plate"] == 0
