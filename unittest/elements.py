"""Small elastic bodies by other methods, in numpy: plane strain by finite elements Q2/P1 (nine
nodes, discontinuous linear pressure: they do not lock), free bricks by Ritz' method."""

import numpy as np
from numpy.polynomial import legendre

POINTS, WEIGHTS = np.polynomial.legendre.leggauss(3)


def lame(young, nu):
    """lambda, mu"""
    return young * nu / ((1 + nu) * (1 - 2 * nu)), young / (2 * (1 + nu))


class PlaneStrain:
    """nx by ny elements on the image of the unit square under shape(s, t) -> (x, y)."""

    def __init__(self, nx, ny, shape, young, nu):
        self.nx, self.ny = nx, ny
        s, t = np.meshgrid(np.linspace(0, 1, 2 * nx + 1), np.linspace(0, 1, 2 * ny + 1),
                           indexing="ij")
        self.grid = s.shape
        self.x = np.stack(shape(s.ravel(), t.ravel()), 1)
        n = 2 * len(self.x)
        # load: unit forces per volume
        self.stiffness, self.mass, self.load = np.zeros((n, n)), np.zeros((n, n)), np.zeros((2, n))
        for i in range(nx):
            for j in range(ny):
                nodes = ((2 * i + np.arange(3))[:, None] * self.grid[1] + 2 * j
                         + np.arange(3)).ravel()
                dof = np.stack([2 * nodes, 2 * nodes + 1], 1).ravel()
                K, M, f = self.element(self.x[nodes], *lame(young, nu))
                self.stiffness[np.ix_(dof, dof)] += K
                self.mass[np.ix_(dof, dof)] += M
                self.load[:, dof] += f

    @staticmethod
    def element(x, lam, mu):
        """Stiffness, mass for unit density, load; the pressure, linear in the element,
        eliminated."""
        K, M, f, B, C = np.zeros((18, 18)), np.zeros((18, 18)), np.zeros((2, 18)), np.zeros(
            (3, 18)), np.zeros((3, 3))
        for a, u in zip(WEIGHTS, POINTS):
            for b, v in zip(WEIGHTS, POINTS):
                (nu, du), (nv, dv) = ((np.array([t * (t - 1) / 2, 1 - t * t, t * (t + 1) / 2]),
                                       np.array([t - 0.5, -2 * t, t + 0.5])) for t in (u, v))
                shape, slope = np.outer(nu, nv).ravel(), np.array(
                    [np.outer(du, nv).ravel(), np.outer(nu, dv).ravel()])
                jacobian = slope @ x
                w, grad = a * b * np.linalg.det(jacobian), np.linalg.solve(jacobian, slope)
                strain, divergence, N = np.zeros((3, 18)), np.zeros(18), np.zeros((2, 18))
                strain[0, 0::2] = strain[2, 1::2] = divergence[0::2] = grad[0]
                strain[1, 1::2] = strain[2, 0::2] = divergence[1::2] = grad[1]
                N[0, 0::2] = N[1, 1::2] = shape
                pressure = np.append(1.0, shape @ x - x[4])
                K += w * strain.T @ (mu * np.array([2, 2, 1])[:, None] * strain)
                M += w * N.T @ N
                f += w * N
                B += w * np.outer(pressure, divergence)
                C += w * np.outer(pressure, pressure)
        return K + lam * B.T @ np.linalg.solve(C, B), M, f

    def solve(self, load, held):
        """Displacements (nodes along s, along t, 2)"""
        free, u = np.repeat(~held, 2), np.zeros(len(load))
        u[free] = np.linalg.solve(self.stiffness[np.ix_(free, free)], load[free])
        return u.reshape(*self.grid, 2)

    def frequencies(self):
        """Those of the free body but rigid motion, for unit density"""
        root = np.linalg.inv(np.linalg.cholesky(self.mass))
        return np.sqrt(np.linalg.eigvalsh(root @ self.stiffness @ root.T)[3:])


def brick(lengths, degrees, young, nu):
    """Frequencies of a free brick but rigid motion, for unit density, with products of Legendre
    polynomials (Demarest 1971)"""
    lam, mu = lame(young, nu)
    integrals = []
    for length, degree in zip(lengths, degrees):
        x, w = legendre.leggauss(degree + 2)
        value = np.array([legendre.legval(x, c) for c in np.eye(degree + 1)])
        slope = np.array([legendre.legval(x, legendre.legder(c)) + 0 * x
                          for c in np.eye(degree + 1)]) * 2 / length
        w = w * length / 2
        integrals.append({(0, 0): (value * w) @ value.T, (1, 0): (slope * w) @ value.T,
                          (0, 1): (value * w) @ slope.T, (1, 1): (slope * w) @ slope.T})

    def product(a, b):
        """Integral of (d/dx_a of one basis function) (d/dx_b of another)"""
        x, y, z = (integrals[k][int(a == k), int(b == k)] for k in range(3))
        return np.kron(np.kron(x, y), z)

    grad = {(a, b): product(a, b) for a in range(3) for b in range(3)}
    laplace = sum(grad[a, a] for a in range(3))
    K = np.block([[lam * grad[a, b] + mu * grad[b, a] + (a == b) * mu * laplace for b in range(3)]
                  for a in range(3)])
    root = np.tile(np.diag(product(3, 3)), 3)**-0.5
    return np.sqrt(np.linalg.eigvalsh(root[:, None] * K * root)[6:])
