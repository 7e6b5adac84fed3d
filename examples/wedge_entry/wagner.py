#!/usr/bin/env python3
"""Deflection of the elastic faces of a wedge that enters water at constant speed: Wagner's theory
and beams.   usage: wagner.py

Each face is a Timoshenko beam in plane strain, clamped at both ends, with the membrane force of its
stretched middle line. The water is that of Wagner: potential flow on the plane of the still
surface, wet between -c and c, pressure -rho dphi/dt. phi is found for the normal velocity of the
rigid wedge and of each mode of the beams. c is where the risen surface, by Wagner's condition,
meets the bent faces. What is left out is of the order of the deadrise: at 10 degrees the similarity
solution's force on a rigid wedge is 0.858 of Wagner's (Zhao and Faltinsen 1993). `load` scales the
water by that.

Prints how far the deflection depends on modes, elements, time step, and on what is left out.
"""

import numpy as np

SPEED, DEADRISE, FACE, THICKNESS = 30.0, 10.0, 0.6, 0.04  # [m/s], [degrees], [m], [m]
YOUNG, POISSON, DENSITY, WATER = 67.5e9, 0.34, 2700.0, 1000.0
SIMILARITY = 213.98 / (np.pi**3 / 4.0 / np.tan(np.radians(DEADRISE)) ** 2)


def beam(elements, modes, shear=True):
    """(angular frequencies, values at the nodes, places of the nodes) of a clamped beam; modes are
    normal over its mass."""
    stiff = YOUNG / (1.0 - POISSON**2)
    bend, mass = stiff * THICKNESS**3 / 12.0, DENSITY * THICKNESS
    slide = 5.0 / 6.0 * YOUNG / (2.0 * (1.0 + POISSON)) * THICKNESS * (1.0 if shear else 1e4)
    size = FACE / elements
    # deflection and rotation of each node, one-point rule for shear
    K = np.zeros((2 * elements + 2, 2 * elements + 2))
    gamma = np.array([-1.0 / size, -0.5, 1.0 / size, -0.5])
    kappa = np.array([0.0, -1.0, 0.0, 1.0]) / size
    for e in range(elements):
        part = slice(2 * e, 2 * e + 4)
        K[part, part] += size * (slide * np.outer(gamma, gamma) + bend * np.outer(kappa, kappa))
    M = np.tile([mass * size, mass * size * (THICKNESS**2 / 12.0 if shear else 1e-9)], elements + 1)
    free = slice(2, -2)
    root = 1.0 / np.sqrt(M[free])
    squares, shapes = np.linalg.eigh(K[free, free] * np.outer(root, root))
    values = np.zeros((modes, elements + 1))
    values[:, 1:-1] = (root[:, None] * shapes)[::2, :modes].T
    return np.sqrt(squares[:modes]), values, np.linspace(0.0, FACE, elements + 1)


class Water:
    """Added masses of the modes, and the means that Wagner's condition asks for, tabled over the
    wet half width."""

    def __init__(self, values, nodes, widths=200, terms=100, points=1000):
        self.step = FACE * np.cos(np.radians(DEADRISE)) / widths
        n = len(values)
        angle = (np.arange(points) + 0.5) * np.pi / points
        odd = np.arange(1, 2 * terms, 2)  # the flow is symmetric
        sines = np.sin(np.outer(odd, angle))
        self.mass, self.mean = np.zeros((widths + 1, n + 1, n + 1)), np.zeros((widths + 1, n))
        for k in range(1, widths + 1):
            c = k * self.step
            s = c * np.abs(np.cos(angle)) / np.cos(np.radians(DEADRISE))
            v = np.vstack([np.ones(points), [np.interp(s, nodes, row) for row in values]])
            parts = (v * np.sin(angle)) @ sines.T * np.pi / points  # of v sin(a) in sin(m a)
            # phi = c sum b_m sin(m a), b_m = 2/(pi m) parts; mass = rho int phi_n v_m dx
            self.mass[k] = WATER * c**2 * (2.0 / np.pi * parts / odd) @ parts.T
            self.mean[k] = v[1:].mean(axis=1)

    def at(self, c, table):
        """A table at the half width c, by a cubic."""
        x = c / self.step
        k = min(max(int(x) - 1, 0), len(table) - 4)
        t = x - k
        weights = (-(t - 1) * (t - 2) * (t - 3) / 6, t * (t - 2) * (t - 3) / 2,
                   -t * (t - 1) * (t - 3) / 2, t * (t - 1) * (t - 2) / 6)
        return sum(w * table[k + m] for m, w in enumerate(weights))


def deflection(end=2e-3, step=4e-6, elements=60, modes=5, load=1.0, shear=True, membrane=True):
    """(time [s], deflection of the middle of a face [m], wet half width [m])"""
    omega, values, nodes = beam(elements, modes, shear)
    water = Water(values, nodes)
    slope, cosine = np.radians(DEADRISE), np.cos(np.radians(DEADRISE))
    rises = np.diff(values, axis=1) / np.diff(nodes)
    stretch = rises @ rises.T * np.diff(nodes)[0] / FACE  # strain = a stretch a/2
    axial = YOUNG / (1.0 - POISSON**2) * THICKNESS * FACE if membrane else 0.0
    most = FACE * cosine

    def wet(t, a):
        """Wagner's condition: the mean of the wedge's height over the still water, at x = c
        sin(theta), is zero."""
        low, high = 0.0, most
        for _ in range(50):
            c = 0.5 * (low + high)
            below = 2.0 / np.pi * c * np.tan(slope) - SPEED * t + water.at(
                c, water.mean) @ a / cosine < 0.0
            low, high = (c, high) if below else (low, c)
        return 0.5 * (low + high)

    def rate(t, a, q):
        # q: momentum of the modes of both faces and their water; a face is 1/cos longer than it is
        # wide
        c = wet(t, a)
        mass = load * water.at(c, water.mass)
        moved = np.linalg.solve(2.0 * np.eye(modes) + mass[1:, 1:] / cosine**2,
                                q + SPEED * mass[1:, 0] / cosine)
        strain = 0.5 * a @ stretch @ a
        return moved, -2.0 * (omega**2 * a + axial * strain * stretch @ a), c

    a, q, found = np.zeros(modes), np.zeros(modes), [(0.0, 0.0, 0.0)]
    middle = values[:, elements // 2]
    for k in range(round(end / step)):
        t, half = k * step, 0.5 * step
        a1, q1, _ = rate(t, a, q)
        a2, q2, _ = rate(t + half, a + half * a1, q + half * q1)
        a3, q3, _ = rate(t + half, a + half * a2, q + half * q2)
        a4, q4, c = rate(t + step, a + step * a3, q + step * q3)
        a = a + step / 6.0 * (a1 + 2.0 * (a2 + a3) + a4)
        q = q + step / 6.0 * (q1 + 2.0 * (q2 + q3) + q4)
        found.append((t + step, middle @ a, c))
    return tuple(np.array(found).T)


def main():
    """Prints the reference at 1, 1.5 and 1.97 ms, and what it depends on."""
    for label, settings in {"reference": {}, "3 modes": {"modes": 3}, "8 modes": {"modes": 8},
                            "120 elements": {"elements": 120},
                            "half the step": {"step": 2e-6},
                            "no membrane force": {"membrane": False},
                            "no shear, no rotary inertia": {"shear": False},
                            "neither, as Scolan": {"shear": False, "membrane": False},
                            "load of the similarity solution": {"load": SIMILARITY}}.items():
        time, bent, c = deflection(**settings)
        print(f"{label:32s}",
              *(f"{1e3 * np.interp(t, time, bent):7.3f} mm" for t in (1e-3, 1.5e-3, 1.97e-3)),
              f"  c = {np.interp(1.97e-3, time, c):.3f} m")


if __name__ == "__main__":
    main()
