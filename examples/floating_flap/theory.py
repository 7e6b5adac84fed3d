"""A rigid box afloat in regular waves, in linear potential flow: heave and pitch in two dimensions,
water of any depth, sway held.

Eigenfunction matching (Black, Mei and Bray 1971): a series under the box, one beside it, joined at
the side of the box. Its edges slow the convergence down; 40 terms are good for three digits of the
added mass.
"""

import numpy as np

GRAVITY = 9.81


def wave_number(omega, depth):
    """omega^2 = g k tanh k d"""
    k = omega**2 / GRAVITY
    for _ in range(100):
        k = 0.5 * (k + omega**2 / (GRAVITY * np.tanh(k * depth)))
    return k


def evanescent(omega, depth, count):
    """omega^2 = -g kappa tan kappa d, one in each branch"""
    low = (np.arange(1, count + 1) - 0.5) * np.pi / depth * (1 + 1e-12)
    high = np.arange(1, count + 1) * np.pi / depth
    for _ in range(80):
        middle = 0.5 * (low + high)
        below = omega**2 + GRAVITY * middle * np.tan(middle * depth) < 0
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return 0.5 * (low + high)


def integrate(f, low, high, n=400):
    """Gauss-Legendre; f of points returns rows"""
    x, w = np.polynomial.legendre.leggauss(n)
    return f(0.5 * (high - low) * x + 0.5 * (high + low)) @ w * 0.5 * (high - low)


class Box:
    """half: of the width; depth of the water; draft; axis: height of the center of rotation above
    the bottom of the water."""

    def __init__(self, omega, half, depth, draft, axis, terms=40):
        self.omega, self.half, self.depth, self.gap, self.axis = (omega, half, depth, depth - draft,
                                                                  axis)
        self.k = wave_number(omega, depth)
        kappa = evanescent(omega, depth, terms - 1)

        def outside(z):
            wave = np.cosh(self.k * z) / np.cosh(self.k * depth)
            return np.vstack([wave, np.cos(np.outer(kappa, z))]).reshape(terms, -1)

        self.beside = outside
        self.under = np.arange(terms) * np.pi / self.gap
        self.inside = lambda z: np.cos(np.outer(self.under, z))
        self.growth = np.concatenate([[1j * self.k], -kappa])  # of outgoing terms along x
        self.norm = integrate(lambda z: outside(z)**2, 0, depth)
        self.own = np.where(np.arange(terms) == 0, self.gap, self.gap / 2)
        self.mixed = integrate(lambda z: (self.inside(z)[:, None] * outside(z)[None]).reshape(
            terms * terms, -1), 0, self.gap).reshape(terms, terms)

    def solve(self, odd, moving, incoming=0.0):
        """(force, far amplitude): i omega rho times the integral of the potential over the box, per
        rho: heave (even) or pitch (odd), for unit velocity of the box or an incoming wave
        `incoming` exp(-ikx) of the potential at the surface."""
        b, s, n = self.half, self.gap, len(self.under)
        # series under the box, 1 or x/b for n = 0: value and slope at its side
        series = self.under[1:] * b
        slope = np.concatenate([[1 / b if odd else 0.0], series / b / np.tanh(series) if odd
                                else series / b * np.tanh(series)])

        def particular(z):  # unit velocity of the bottom
            return ((b * z**2 - b**3 / 3) if odd else (z**2 - b**2)) / (2 * s), (z**2 - b**2) / (
                2 * s) if odd else np.full_like(z, -b / s)

        value = integrate(lambda z: self.inside(z) * particular(z)[0], 0, s) * moving
        leaving = integrate(lambda z: self.beside(z) * particular(z)[1], 0, s) * moving
        if odd and moving:  # the side turns with the box
            leaving = leaving - integrate(lambda z: self.beside(z) * (z - self.axis), s, self.depth)
        wave = np.zeros(n, complex)
        wave[0] = incoming * np.exp(-1j * self.k * b)
        # value: own a + value = mixed (B + wave); slope: norm (growth B - ik wave) = mixed^T (slope
        # a) + leaving
        inner = self.mixed / self.own[:, None]
        matrix = np.diag(self.norm * self.growth) - self.mixed.T @ (slope[:, None] * inner)
        right = (leaving + self.mixed.T @ (slope * (inner @ wave - value / self.own)) + self.norm
                 * 1j * self.k * wave)
        B = np.linalg.solve(matrix, right)
        a = inner @ (B + wave) - value / self.own
        # over the bottom
        x, w = np.polynomial.legendre.leggauss(200)
        x, w = 0.5 * b * (x + 1), 0.5 * b * w
        e, sign = np.outer(self.under[1:], x), -1.0 if odd else 1.0
        shape = np.exp(e - series[:, None]) * (1 + sign * np.exp(-2 * e)) / (
            1 + sign * np.exp(-2 * series))[:, None]
        shape = np.vstack([x / b if odd else np.ones_like(x), shape])
        bottom = (a * np.cos(self.under * s)) @ shape + moving * ((x * s**2 - x**3 / 3) if odd
                                                                  else (s**2 - x**2)) / (2 * s)
        total = 2 * (bottom * (x if odd else 1.0)) @ w
        if odd:
            total += 2 * integrate(
                lambda z: ((z - self.axis) * ((B + wave) @ self.beside(z)))[None], s, self.depth)[0]
        return total

    def added_mass(self, odd):
        """(added mass, damping) per density of the water"""
        total = self.solve(odd, 1.0)
        return total.real, self.omega * total.imag

    def exciting(self, odd):
        """force in a wave of unit height of the surface, eta = cos(kx - omega t), from the left;
        per density"""
        potential = -1j * GRAVITY / self.omega  # eta = i omega phi/g
        total = self.solve(odd, 0.0, (-0.5 if odd else 0.5) * potential)
        return 1j * self.omega * total


def response(omega, width, depth, draft, rho, mass, inertia, center, axis):
    """Complex heave over the wave's amplitude and pitch over its slope. center: height of the
    center of mass above the bottom."""
    box = Box(omega, width / 2, depth, draft, axis)
    out = []
    for odd, own, stiffness, scale in ((False, mass, rho * GRAVITY * width, 1.0),
                                       (True, inertia, rho * GRAVITY * width**3 / 12 + mass
                                        * GRAVITY * (depth - draft / 2 - center), box.k)):
        A, B = box.added_mass(odd)
        out.append(rho * box.exciting(odd)
                   / (stiffness - omega**2 * (own + rho * A) - 1j * omega * rho * B) / scale)
    return out
