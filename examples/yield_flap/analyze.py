#!/usr/bin/env python3
"""Figures and pictures of mud that comes to rest on flaps.   usage: analyze.py FOLDER

main reads flap.csv, particles.dump and run.json of one run; study compares the runs of cases.json.
"""

import json
import sys
from functools import cache
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, plot, series  # noqa: E402
from fsi.summary import RUN_FILE, Summary  # noqa: E402

PERIOD, DEPTH, THICKNESS, HEIGHT = 0.15, 0.1, 0.01, 0.05
YIELD, K, M, WEIGHT = 50.0, 10.0, 20.0, 1000 * 0.3  # along the slope at the end [Pa/m]
YOUNG, POISSON = 8e5, 0.4
CELL = 0.00125  # [m] of the finite differences; half an element
# creep of the law with m, and the flap under its load
FLOW, PLATE = "theory, finite differences of the regularized law", "finite elements"


def viscosity(rate):
    """Bingham's law, regularized by Papanastasiou"""
    rate = np.maximum(rate, 1e-12)
    return K - YIELD * np.expm1(-M * rate) / rate


def operators(n):
    """(ops, number of unknowns) of half a period, the flap at the left: each op is a place (i, j),
    its area, and what its rate is of stream functions; strains in the middles of cells, shear at
    their corners. Faces that do not slip or are of symmetry see the opposite velocity beyond.
    """
    nx, ny, ib, jh = n
    number = -np.ones((nx + 1, ny + 1), int)  # -1: 0, on bed and flap
    inner = [(i, j) for i in range(nx + 1) for j in range(1, ny) if i > ib or j > jh]
    for k, node in enumerate(inner):
        number[node] = k
    number[:, ny] = len(inner)  # the flux, one unknown

    def u(i, j, c):
        return [(number[i, j + 1], c), (number[i, j], -c)]

    def v(i, j, c):
        return [(number[i + 1, j], -c), (number[i, j], c)]

    cells = [((i, j), 1.0, u(i + 1, j, 1.0) + u(i, j, -1.0)) for i in range(nx) for j in range(ny)
             if i >= ib or j >= jh]
    corners = []
    for i in range(nx + 1):
        for j in range(ny):  # no shear at the surface
            if i < ib and j < jh:
                continue
            right, left = i in (0, ib if j < jh else 0), i == nx
            floor = j == 0 or (j == jh and i < ib)
            op = v(i - 1, j, -2.0) if left else v(i, j, 2.0) if right else v(i, j, 1.0) + v(
                i - 1, j, -1.0)
            op = op + (u(i, j, 2.0) if floor else u(i, j, 1.0) + u(i, j - 1, -1.0))
            corners.append(((i, j), 0.75 if (i, j) == (ib, jh) else (0.5 if left or right else 1.0)
                            * (0.5 if floor else 1.0), op))
    return cells, corners, len(inner) + 1


def sparse(ops):
    """(unknowns, factors) of ops, one row each, padded"""
    width = max(len(op) for _, _, op in ops)
    index, factor = np.zeros((len(ops), width), int), np.zeros((len(ops), width))
    for row, (_, _, op) in enumerate(ops):
        for k, (unknown, c) in enumerate(op):
            if unknown >= 0:
                index[row, k], factor[row, k] = unknown, c
    return index, factor


def solve(matrix, width):
    """Stream functions for a force 1 on the last unknown, the flux. The others' matrix has this
    half bandwidth: by blocks."""
    n, right = len(matrix) - 1, matrix[:-1, -1]
    starts, diagonal, rest = range(0, n, width), [], []
    for a in starts:
        block, r = matrix[a:min(a + width, n),
                          a:min(a + width, n)].copy(), right[a:min(a + width, n)].copy()
        if a:
            beside = matrix[a - width:a, a:min(a + width, n)]
            both = np.linalg.solve(diagonal[-1], np.column_stack([beside, rest[-1]]))
            block, r = block - beside.T @ both[:, :-1], r - beside.T @ both[:, -1]
        diagonal.append(block)
        rest.append(r)
    x = np.zeros(n + 1)
    for a, block, r in reversed(list(zip(starts, diagonal, rest))):
        end = min(a + width, n)
        x[a:end] = np.linalg.solve(block, r - matrix[a:end, end:min(end + width, n)]
                                   @ x[end:min(end + width, n)])
    flux = 1 / (matrix[-1, -1] - right @ x[:-1])
    return flux * np.append(-x[:-1], 1.0)


@cache
def flow():
    """Creep about an undeformed flap: (load by rows over its height, force on its top, stress up
    its sides, force on the bed, flux)"""
    nx, ny, ib, jh = n = [round(x / CELL) for x in (PERIOD / 2, DEPTH, THICKNESS / 2, HEIGHT)]
    cells, corners, unknowns = operators(n)
    (strain, c), (shear, d) = sparse(cells), sparse(corners)
    area = np.array([a for _, a, _ in corners])
    of_cell, of_corner = ({place: k for k, (place, *_) in enumerate(ops)}
                          for ops in (cells, corners))

    def mean(values, to, known, shifts):
        near = [[values[known[i + s, j + t]] for s in shifts for t in shifts
                 if (i + s, j + t) in known] for (i, j), *_ in to]
        return np.array([sum(x) / (4 if shifts[1] == 1 else len(x)) for x in near])

    eta, eta_corner, psi = np.full(len(cells), K + YIELD * M), np.full(len(corners),
                                                                       K + YIELD * M), 0.0
    for _ in range(100):
        matrix = np.zeros((unknowns, unknowns))
        for index, factor, weight in ((strain, c, 4 * eta / CELL**2),
                                      (shear, d, area * eta_corner / CELL**2)):
            np.add.at(matrix, (index[:, :, None], index[:, None, :]),
                      weight[:, None, None] * factor[:, :, None] * factor[:, None, :])
        before, psi = psi, solve(matrix, 2 * ny) * WEIGHT * PERIOD / 2
        e, g = (c * psi[strain]).sum(1) / CELL**2, (d * psi[shear]).sum(1) / CELL**2
        eta = viscosity(np.sqrt(4 * e**2 + mean(g**2, cells, of_corner, (0, 1))))
        eta_corner = viscosity(np.sqrt(g**2 + 4 * mean(e**2, corners, of_cell, (0, -1))))
        if np.max(np.abs(psi - before)) < 1e-6 * psi[-1]:
            break
    stress = {place: s for (place, *_), s in zip(corners, eta_corner * g)}

    def along(j, first, last):  # integral of the shear stress along x
        return CELL * sum(stress[i, j] * (0.5 if i in (first, last) else 1.0)
                          for i in range(first, last + 1))

    # its differences and the weight push on the flap
    beside = np.array([along(j, ib, nx) for j in range(jh + 1)])
    load = WEIGHT * (PERIOD - THICKNESS) + 2 * np.diff(beside) / CELL
    return (load, 2 * along(jh, 0, ib), np.array([stress[ib, j] for j in range(jh)]), 2 * beside[0],
            psi[-1])


def bend(load, top, side, across=4):
    """Where the flap's sides go under a load by rows over its height, a force on its top, stress up
    its sides: (heights, deflections). Plane strain, 9-node quadrilaterals, clamped at its root.
    """
    up = round(HEIGHT / (2 * CELL))
    rows, (hx, hy) = 2 * up + 1, (THICKNESS / across, HEIGHT / up)
    elastic = YOUNG / (1 + POISSON) / (1 - 2 * POISSON) * np.array(
        [[1 - POISSON, POISSON, 0], [POISSON, 1 - POISSON, 0], [0, 0, 0.5 - POISSON]])
    places, weights = np.polynomial.legendre.leggauss(3)
    shapes = [(np.array([s * (s - 1) / 2, 1 - s * s, s * (s + 1) / 2]),
               np.array([s - 0.5, -2 * s, s + 0.5])) for s in places]
    stiffness = np.zeros((18, 18))
    for (a, da), p in zip(shapes, weights):
        for (b, db), q in zip(shapes, weights):
            x, y, strain = (np.outer(da, b).ravel() * 2 / hx, np.outer(a, db).ravel() * 2 / hy,
                            np.zeros((3, 18)))
            strain[0, 0::2] = strain[2, 1::2] = x
            strain[1, 1::2] = strain[2, 0::2] = y
            stiffness += p * q * hx * hy / 4 * strain.T @ elastic @ strain
    matrix, force = np.zeros((2 * (2 * across + 1) * rows,)
                             * 2), np.zeros(2 * (2 * across + 1) * rows)
    for i in range(across):
        for j in range(up):
            nodes = np.array([(2 * i + a) * rows + 2 * j + b for a in range(3) for b in range(3)])
            places = np.column_stack([2 * nodes, 2 * nodes + 1]).ravel()
            matrix[np.ix_(places, places)] += stiffness
    # Simpson's, across
    share = np.array([1.0] + [4.0, 2.0] * (across - 1) + [4.0, 1.0]) / (6 * across)
    for i, part in enumerate(share):
        at = force[2 * i * rows:2 * (i + 1) * rows:2]
        at[:-1] += 0.5 * part * load * CELL
        at[1:] += 0.5 * part * load * CELL
        at[-1] += part * top
    force[1:2 * (rows - 1):2] -= side * CELL
    force[2 * 2 * across * rows + 1:-1:2] += side * CELL
    free = np.array([2 * n + k for n in range(len(force) // 2) if n % rows for k in (0, 1)])
    moved = np.zeros(len(force))
    moved[free] = np.linalg.solve(matrix[np.ix_(free, free)], force[free])
    return np.arange(rows) * CELL, moved[-2 * rows::2]


def add(summary, folder, suffix=""):
    """The figures of one run at its end"""
    dx = float(json.loads((Path(folder) / RUN_FILE).read_text())["variables"]["dx"])
    s, frame = series.read(Path(folder) / "flap.csv"), dump.read(Path(folder)
                                                                 / "particles.dump")[-1]
    late = s.time > 0.9 * s.time[-1]
    tip, force, bed = (float(s[name][late].mean()) for name in ("tip", "flap", "bed"))
    load, top, side, _, flux = flow()
    own = np.full(len(load), WEIGHT * THICKNESS)

    def deflection(*loads):
        return float(np.interp(HEIGHT - dx / 4, *bend(*loads)))

    whole, dead = deflection(load + own, top, side), deflection(own, 0.0, 0 * side)
    carried = np.sum(load) * CELL + top
    summary.add("deflection" + suffix, tip, "m", whole, PLATE, 0.03)
    summary.add("deflection_under_its_force" + suffix, tip, "m", dead + (whole - dead) * force
                / carried, PLATE)
    summary.add("force" + suffix, force, "N/m", carried, FLOW)
    total = WEIGHT * (PERIOD * DEPTH - THICKNESS * HEIGHT)
    summary.add("balance" + suffix, force + bed, "N/m", total,
                "theory, weight of the mud along the slope")
    mud = frame.of_types(1)
    summary.add("velocity" + suffix, mud["vx"].mean(), "m/s",
                flux * PERIOD / (PERIOD * DEPTH - THICKNESS * HEIGHT), FLOW)
    summary.add("drift" + suffix, (s["tip"][-1] - s["tip"][late][0]) / tip, "of the deflection")


def draw(folder, run):
    """Viscosity of the mud in motion and at rest; what does not yield is bright"""
    dx = float(json.loads((Path(run) / RUN_FILE).read_text())["variables"]["dx"])
    frames = dump.read(Path(run) / "particles.dump")
    colors = plot.matplotlib.colormaps["viridis"]
    with plot.picture(Path(folder) / "viscosity.png", 6.4, 2.3) as figure:
        for k, (frame, text) in enumerate(((min(frames, key=lambda f: abs(f.time - 0.4)), "0.4 s"),
                                           (frames[-1], f"{frames[-1].time:g} s"))):
            axes = figure.add_axes((0.09 + 0.42 * k, 0.18, 0.36, 0.7))
            limits = ((0.0, PERIOD), (-dx, DEPTH))
            mud, flap = frame.of_types(1), frame.of_types(2, 3)
            plot.field(axes, mud["x"], mud["y"], dx,
                       colors(np.clip((np.log10(mud["viscosity"]) - 1) / 2, 0, 1)), limits)
            plot.field(axes, flap["x"], flap["y"], dx / 2,
                       np.tile(plot.to_rgba(plot.RED), (len(flap), 1)), limits)
            axes.set(xlabel="x [m]", ylabel="" if k else "y [m]", title=text,
                     xticks=(0, 0.05, 0.1, 0.15), yticks=(0, 0.05, 0.1))
        bar = plot.ScalarMappable(plot.Normalize(1, 3), colors)
        figure.colorbar(bar, cax=figure.add_axes((0.9, 0.18, 0.015, 0.7)), label="log10 eta [Pa s]")


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    summary = Summary(folder)
    add(summary, folder)
    draw(folder, folder)
    return summary.write()


def study(folder, cases):
    """Figures of all cases"""
    summary = Summary(folder)
    for name, path in cases.items():
        add(summary, path, f"_{name}")
    draw(folder, list(cases.values())[-1])
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
