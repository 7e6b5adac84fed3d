"""Small scenes and how to run them: what the tests of the styles share."""

import subprocess
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from fsi import dump, launch

DX = 0.01  # particle spacing of the scenes [m]
SOUND = {1: 10.0, 2: 38.0}  # fastest waves of water and plate [m/s]: sound of the script, longitudinal wave of the material


@dataclass
class Scene:
    """Particles in a box, and the physics as input text. Particle k is row k of the arrays."""

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
        """The particles as a LAMMPS data file; mass 0: that of the stress-free lattice."""
        lines = ["FSI test scene", "", f"{len(self.x)} atoms", f"{1 + self.has_solid} atom types", ""]
        lines += [f"{lo!r} {hi!r} {a}lo {a}hi" for (lo, hi), a in zip(self.box.tolist(), "xyz")]
        lines += ["", "Atoms # fsi", ""]
        lines += [f"{i} {t - 1} {t} {r!r} 0.0 {p[0]!r} {p[1]!r} {p[2]!r}" for i, t, r, p in
                  zip(self.ids.tolist(), self.type.tolist(), self.rho.tolist(), self.x.tolist())]
        lines += ["", "Velocities", ""]
        lines += [f"{i} {p[0]!r} {p[1]!r} {p[2]!r}" for i, p in zip(self.ids.tolist(), self.v.tolist())]
        return "\n".join(lines) + "\n"

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
        """Pair styles and fixes; coeff=False after read_restart, which knows the pair styles already."""
        plate = self.has_solid
        if plate:
            style = f"pair_style hybrid fsi/fluid {self.fluid} {self.solid_style} {self.solid}\n" * coeff
            # restart files do not hold the coefficients of a hybrid style, whatever its parts
            pair = style + "pair_coeff * * fsi/fluid materials.fsi water plate\n" \
                f"pair_coeff * * {self.solid_style} materials.fsi NULL plate\n"
        else:
            pair = f"pair_style fsi/fluid {self.fluid}\npair_coeff * * materials.fsi water\n" * coeff
        walls = "".join(f" {'xyz'[a]}{'lo' if s > 0 else 'hi'} {p!r} {rest}" for a, s, p, rest in self.walls)
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
        return replace(self, x=self.x[order], v=self.v[order], type=self.type[order], rho=self.rho[order],
                       ids=np.random.default_rng(seed + 1).permutation(self.ids))

    def turned(self, axes, signs):
        """The scene under a signed permutation of axes: new axis k is signs[k] times old axis axes[k]."""
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
                        ends = [end if end == "INF" else repr(-float(end)) for end in reversed(ends)]
                    out += ["range", "xyz"[b], *ends]
                elif word == "velocity":
                    w = np.array([float(words.pop(0)) for _ in range(3)])
                    out += ["velocity", *map(repr, (w[axes] * signs).tolist())]
                else:
                    out += [word, words.pop(0)]
            walls.append((k, s * signs[k], p * signs[k], " ".join(out)))
        return replace(self, x=self.x[:, axes] * signs, v=self.v[:, axes] * signs, box=box, walls=walls,
                       gravity=self.gravity[axes] * signs)


def _lattice(*counts):
    """Cell centres of a lattice with its corner at the origin, in x, y (and z)."""
    grid = np.stack(np.meshgrid(*[(np.arange(n) + 0.5) * DX for n in counts], indexing="ij"), axis=-1)
    points = np.zeros((int(np.prod(counts)), 3))
    points[:, : len(counts)] = grid.reshape(-1, len(counts))
    return points


def _scene(dim, water, plate, walls, seed=7, **options):
    """Perturbs positions (a tenth of the spacing), velocities (0.1 m/s) and densities (0.5 %): every term is active."""
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
    return Scene(dim, x + shift, v, kind, rho, box, walls, **options)


def fluid_box(dim, **options):
    """Water on a no-slip floor between mirror walls, one of them moving; free surface on top."""
    n = (20, 14) if dim == 2 else (8, 8, 7)
    walls = [(0, 1, 0.0, "velocity 0.1 0 0"), (0, -1, n[0] * DX, ""), (1, 1, 0.0, "slip no")]
    if dim == 3:
        walls += [(2, 1, 0.0, ""), (2, -1, n[2] * DX, "slip no")]
    return _scene(dim, _lattice(*n), [], walls, **options)


def dam_gate(dim, **options):
    """Water between mirror walls and an elastic plate that it touches; a finite wall goes on above the plate."""
    n, across = ((14, 14), 5) if dim == 2 else ((7, 7, 7), 3)
    plate = _lattice(across, *n[1:])
    plate[:, 0] += n[0] * DX
    walls = [(0, 1, 0.0, "velocity 0.1 0 0"), (1, 1, 0.0, f"slip no range x INF {(n[0] + across) * DX!r}"),
             (0, -1, n[0] * DX, f"range y {n[1] * DX!r} INF")]
    if dim == 3:
        walls += [(2, 1, 0.0, ""), (2, -1, n[2] * DX, "")]
    return _scene(dim, _lattice(*n), plate, walls, **options)


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
    """Largest difference of a quantity between two frames, relative to its largest size (or the size given)."""
    assert np.array_equal(a["id"], b["id"])
    p, q = (frame.vector(QUANTITIES[quantity]) for frame in (a, b))
    return np.abs(p - q).max() / (np.abs(p).max() if size is None else size)


def differing(a, b):
    """Names of the columns in which two frames differ in any bit."""
    return [name for name in a.columns if not np.array_equal(a[name], b[name])]


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


def lammps(folder, text, ranks=1, timeout=120, arguments=(), **files):
    """Runs LAMMPS on an input text; files: contents by name, with _ for the dot before the ending."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        (folder / ".".join(name.rsplit("_", 1))).write_text(content)
    (folder / "in.test").write_text(text)
    command = [*launch.lammps("in.test", ranks), *arguments]
    done = subprocess.run(command, cwd=folder, env=launch.environment(), stdin=subprocess.DEVNULL, timeout=timeout,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace", check=False)
    return Result(done.returncode, done.stdout, folder)


def run(folder, text, ranks=1, **options):
    """As `lammps`, for input that must work."""
    result = lammps(folder, text, ranks, **options)
    assert result.status == 0, "\n".join(result.output.splitlines()[-15:])
    return result
