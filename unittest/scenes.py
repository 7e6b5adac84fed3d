"""Small scenes for the tests: LAMMPS in this process, arrays sorted by atom id, and the kernels written a second time.

Needs the environment of tools/test (fsi.launch.environment()): the library path and LAMMPS' Python module.
"""

import tempfile
from pathlib import Path

import numpy as np
from lammps import LMP_STYLE_ATOM, LMP_STYLE_GLOBAL, LMP_TYPE_ARRAY, LMP_TYPE_SCALAR, LMP_TYPE_VECTOR, lammps

KERNELS = ("cubic", "quintic", "wendland")
WATER = "fluid rho 1000"
RUBBER = "solid rho 1000 young 1e5 poisson 0.3"


class Kernel:
    """The kernels as the papers print them: W(r), and g(r) with grad_i W_ij = g x_ij (r > 0)."""

    def __init__(self, name, dim, h):
        self.name, self.h = name, h
        self.cut = (3 if name == "quintic" else 2) * h
        self.norm = {"cubic": (15 / (7 * np.pi), 3 / (2 * np.pi)), "quintic": (7 / (478 * np.pi), 1 / (120 * np.pi)),
                     "wendland": (7 / (4 * np.pi), 21 / (16 * np.pi))}[name][dim - 2] / h**dim

    def _terms(self):
        """W = norm * sum of a (b - q)_+^n, for the two splines."""
        if self.name == "cubic":
            return 3, ((1 / 6, 2), (-4 / 6, 1))
        return 5, ((1, 3), (-6, 2), (15, 1))

    def W(self, r):
        q = np.asarray(r) / self.h
        if self.name == "wendland":
            return self.norm * np.maximum(1 - q / 2, 0)**4 * (2 * q + 1)
        n, terms = self._terms()
        return self.norm * sum(a * np.maximum(b - q, 0)**n for a, b in terms)

    def g(self, r):
        r = np.asarray(r)
        q = r / self.h
        if self.name == "wendland":
            return -5 * self.norm / self.h**2 * np.maximum(1 - q / 2, 0)**3
        n, terms = self._terms()
        return -n * self.norm / self.h / r * sum(a * np.maximum(b - q, 0)**(n - 1) for a, b in terms)

    def lattice_sum(self, dx, dim):
        """sum of W over an infinite square or cubic lattice"""
        return self.W(np.linalg.norm(lattice([2 * int(self.cut / dx) + 3] * dim, dx, centre=True), axis=1)).sum()


def lattice(n, dx, origin=0.0, centre=False):
    """Points of a lattice with n[k] points along k, the first half a spacing from `origin`, or about 0; z = 0 in 2D."""
    axes = [(np.arange(m) - (m - 1) / 2) * dx if centre else (np.arange(m) + 0.5) * dx for m in n]
    x = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, len(n))
    x = np.hstack([x, np.zeros((len(x), 3 - len(n)))])
    x[:, :len(n)] += 0.0 if centre else origin
    return x


def cloud(n, dx, seed=1, jitter=0.2, origin=0.0, vmax=0.0):
    """A lattice shaken by up to jitter * dx, and random velocities up to vmax: (x, v)."""
    random = np.random.default_rng(seed)
    x, dim = lattice(n, dx, origin), len(n)
    v = np.zeros_like(x)
    x[:, :dim] += random.uniform(-jitter, jitter, (len(x), dim)) * dx
    v[:, :dim] = random.uniform(-vmax, vmax, (len(x), dim))
    return x, v


class Scene:
    """A scene of given particles. Types count from 1 and name `materials`, lines of a material file without the name.

    dim, dx, kernel, hdx    discretisation
    v, type, mol            per particle, or one value for all
    fluid, solid            keywords of the pair styles ("sound 10" is there by default); density: those of fix fsi
    stress                  keywords of fix fsi/stress
    solid_style             fsi/solid or fsi/solid/tl, which needs no fix fsi/stress
    held                    per particle: left out of fix fsi's group, so that it does not move
    box, boundary           ((xlo, ylo, zlo), (xhi, yhi, zhi)); default: far from all particles, fixed
    id_map                  LAMMPS' map of atom IDs, whether the styles need one or not
    commands                run before the first run, after all else
    """

    def __init__(self, x, v=None, *, dim=2, dx=1.0, kernel="wendland", hdx=1.5, type=1, mol=1, materials=(WATER,),
                 fluid="", solid="", density="", stress="", solid_style="fsi/solid", held=None, box=None, boundary=None, dt=1e-3, skin=0.3, id_map=True, commands=()):
        x = np.asarray(x, float)
        self.n, self.dim, self.dx = len(x), dim, dx
        self.kernel = Kernel(kernel, dim, hdx * dx)
        margin = 20 * dx
        lo, hi = box if box else (x.min(0) - margin, x.max(0) + margin)
        if dim == 2:
            lo, hi = (*lo[:2], -dx / 2), (*hi[:2], dx / 2)
        self.lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
        has = {m.split()[0] for m in materials} - {"wall"}
        styles = {"fluid": f"fsi/fluid sound 10 {fluid}" if "sound" not in fluid else f"fsi/fluid {fluid}",
                  "solid": f"{solid_style} {solid}"}
        sub = {"fluid": "fsi/fluid", "solid": solid_style}
        names = [f"m{k}" for k in range(len(materials))]
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "materials.fsi"
            file.write_text("# DATE: 2026-01-01 UNITS: si CITATION: none\n"
                            + "".join(f"{n} {m}\n" for n, m in zip(names, materials)))
            self.run_lines(f"""units si
                dimension {dim}
                boundary {boundary or ('f f p' if dim == 2 else 'f f f')}
                atom_style fsi
                atom_modify {'map array ' if id_map else ''}sort 0 0
                newton on
                region box block {lo[0]} {hi[0]} {lo[1]} {hi[1]} {lo[2]} {hi[2]}
                create_box {len(materials)} box""")
            types = np.broadcast_to(type, self.n).astype(int).tolist()
            self.lmp.create_atoms(self.n, list(range(1, self.n + 1)), types, x.ravel().tolist(),
                                  None if v is None else np.asarray(v, float).ravel().tolist())
            assert self.lmp.get_natoms() == self.n, "particles outside the box"
            self.put("molecule", np.broadcast_to(mol, self.n))
            if len(has) == 2:
                null = {s: " ".join(n if s == "fluid" or m.startswith(s) else "NULL" for n, m in zip(names, materials))
                        for s in has}
                self.run_lines(f"pair_style hybrid {styles['fluid']} {styles['solid']}",
                               *(f"pair_coeff * * {sub[s]} {file} {null[s]}" for s in sorted(has)))
            else:
                self.run_lines(f"pair_style {styles[has.copy().pop()]}", f"pair_coeff * * {file} {' '.join(names)}")
        if held is not None:
            ids = " ".join(map(str, np.flatnonzero(held) + 1))
            self.run_lines(f"group held id {ids}", "group moving subtract all held")
        self.run_lines(f"fix sph {'all' if held is None else 'moving'} fsi {dx} {kernel} {hdx} {density}", f"timestep {dt}", f"neighbor {skin * dx} bin",
                       "neigh_modify every 1 delay 0 check yes", "thermo_modify lost error norm no")
        if "solid" in has:
            self.run_lines(f"fix stress all fsi/stress {stress}" if solid_style == "fsi/solid" else "",
                           "compute sigma all fsi/atom p sxx syy szz sxy sxz syz")
        else:
            self.run_lines("compute sigma all fsi/atom p rho")
        self.run_lines(*commands)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.lmp.close()

    def run_lines(self, *blocks):
        for block in blocks:
            for line in filter(str.strip, block.splitlines()):
                self.lmp.command(line.strip())

    def run(self, steps=0, dt=None):
        if dt is not None:
            self.lmp.command(f"timestep {dt}")
        self.lmp.command(f"run {steps} post no")
        return self

    # ---- per-atom data, sorted by id ----
    def get(self, name):
        """x, v, f, rho, rmass, id, type, molecule, ..."""
        data = np.array(self.lmp.numpy.extract_atom(name))[:self.n]
        return data[self._order()]

    def put(self, name, values):
        """for x, v (n x 3), rho, rmass, molecule (n), in the order of ids"""
        target = self.lmp.numpy.extract_atom(name)
        target[self._order()] = values

    def _order(self):
        return np.argsort(self.lmp.numpy.extract_atom("id")[:self.n])

    def compute(self, name, columns=True):
        kind = LMP_TYPE_ARRAY if columns else LMP_TYPE_VECTOR
        data = np.array(self.lmp.numpy.extract_compute(name, LMP_STYLE_ATOM, kind))[:self.n]
        return data[self._order()]

    @property
    def p(self):
        return self.compute("sigma")[:, 0]

    @property
    def sigma(self):
        """Cauchy stress of a scene with solids, n x 3 x 3"""
        s = self.compute("sigma")
        return s[:, [1, 4, 5, 4, 2, 6, 5, 6, 3]].reshape(-1, 3, 3)

    def fix_scalar(self, name):
        return self.lmp.extract_fix(name, LMP_STYLE_GLOBAL, LMP_TYPE_SCALAR)

    def fix_array(self, name, rows):
        return np.array([[self.lmp.extract_fix(name, LMP_STYLE_GLOBAL, LMP_TYPE_ARRAY, i, j) for j in range(3)]
                         for i in range(rows)])

    def momentum(self):
        return (self.get("rmass")[:, None] * self.get("v")).sum(0)


def pairs(x, cut, images=None):
    """i, j, x_ij, r of all ordered pairs i != j within `cut`; `images`: shifts of a periodic box."""
    i, j, d = [], [], []
    for shift in [np.zeros(3)] if images is None else images:
        dx = x[:, None] - x[None] - shift
        r = np.linalg.norm(dx, axis=2)
        a, b = np.nonzero((r < cut) & (r > 0))
        i.append(a), j.append(b), d.append(dx[a, b])
    i, j, d = np.concatenate(i), np.concatenate(j), np.concatenate(d)
    return i, j, d, np.linalg.norm(d, axis=1)


def sum_over(i, values, n):
    """sum of values over the pairs of each particle i"""
    out = np.zeros((n, *values.shape[1:]))
    np.add.at(out, i, values)
    return out


def close(a, b, tolerance):
    """max |a - b| relative to the largest |b|; asserts that it is below the tolerance and returns it"""
    a, b = np.asarray(a), np.asarray(b)
    error = np.abs(a - b).max() / np.abs(b).max()
    assert error < tolerance, f"relative error {error:.3g}, allowed {tolerance:.3g}"
    return error
