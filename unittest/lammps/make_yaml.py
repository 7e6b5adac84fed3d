"""Writes the tests of LAMMPS' own frame for styles (unittest/force-styles) that lammps/ has, with
forces from numpy.

   PYTHONPATH=unittest:unittest/styles:python:LAMMPS/python python3 unittest/lammps/make_yaml.py
   [FOLDER]

test_pair_style reads atoms, defines pair style and fix fsi, and compares forces and virial before
and after 4 steps of fix nve, with
newton on and off, from a restart file and from a data file. Fix fsi has an empty group: fix nve
moves the particles.
"""

import importlib.util
import sys
from pathlib import Path

import numpy as np
from scenes import Kernel, cloud, pairs, sum_over

TESTS = Path(__file__).resolve().parents[2] / "lammps/unittest/force-styles/tests"
# a copy of its own: the constants of the material are set below
_spec = importlib.util.spec_from_file_location(
    "solid_tl_of_yaml", Path(__file__).resolve().parents[1] / "solids.py")
tl = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(tl)
DX, DT, C = 0.01, 1e-4, 10.0
DATE = "Wed Feb  5 00:00:00 2025"


# ---- particles ----------------------------------------------------------------------------------


def particles():
    """4 by 4 by 4, two bodies: x, v, density, body; as the data file has them, in decimals"""
    x, v = cloud([4] * 3, DX, seed=5, jitter=0.2, vmax=0.5)
    rho = np.random.default_rng(6).uniform(985, 1015, len(x))
    return x.round(6), v.round(4), rho.round(2), 1 + (x[:, 0] > 2 * DX).astype(int)


def data_file(x, v, rho, mol, mass):
    rows = [f"{k} {mol[k - 1]} 1 {rho[k - 1]} {mass} {' '.join(map(str, x[k - 1]))} 0 0 0"
            for k in range(1, len(x) + 1)]
    speeds = [f"{k} {' '.join(map(str, v[k - 1]))}" for k in range(1, len(x) + 1)]
    box = "\n".join(f"-0.1 0.14 {a}lo {a}hi" for a in "xyz")
    return (f"LAMMPS data file of 64 particles of the FSI package\n\n{len(x)} atoms\n"
            f"1 atom types\n\n{box}\n\nAtoms # fsi\n\n" + "\n".join(rows)
            + "\n\nVelocities\n\n" + "\n".join(speeds) + "\n")


class State:
    """Velocity Verlet of fix nve about a law: forces, and what fix fsi advances in each step
    (density, stress)."""

    def __init__(self, law, x, v, rho, mol, mass):
        self.law, self.x, self.v, self.rho, self.mol = law, x, v, rho, mol
        self.m = np.broadcast_to(mass, len(x)).astype(float)
        self.f = law.force(self)

    def step(self):
        self.v = self.v + DT / 2 * self.f / self.m[:, None]
        self.x = self.x + DT * self.v
        self.law.advance(self)
        self.f = self.law.force(self)
        self.v = self.v + DT / 2 * self.f / self.m[:, None]

    def middle(self):
        """where rates are taken: fix fsi expects particles half a step further, for its own
        drift"""
        return self.x - DT / 2 * self.v


# ---- laws ---------------------------------------------------------------------------------------


class Fluid:
    """doc/src/pair_fsi_fluid.rst: pressure, artificial and central laminar viscosity,
    density by continuity"""

    def __init__(self, kernel, tait=False, artificial=(0, 0), eta=0.0):
        self.kernel, self.tait, self.artificial, self.eta = kernel, tait, artificial, eta

    def p(self, rho):
        return 1000 * C**2 / 7 * ((rho / 1000)**7 - 1) if self.tait else C**2 * (rho - 1000)

    def force(self, s):
        k, (i, j, d, r), V = self.kernel, pairs(s.x, self.kernel.cut), s.m / s.rho
        vd = ((s.v[i] - s.v[j]) * d).sum(1)
        mu = np.minimum(vd, 0) * k.h / (r**2 + 0.01 * k.h**2)
        alpha, beta = self.artificial
        Q = (s.rho[i] + s.rho[j]) / 2 * V[i] * V[j] * (-alpha * C * mu + beta * mu**2)
        pv2 = self.p(s.rho) * V**2
        pair = -(pv2[i] + pv2[j] + Q)[:, None] * d
        rubbing = k.rubbing("central", k.h / DX, s.v[i] - s.v[j], d)
        pair += (s.m[i] * s.m[j] / 1000**2 * 2 * self.eta)[:, None] * rubbing
        return sum_over(i, pair * k.g(r)[:, None], len(s.x))

    def advance(self, s):
        k, (i, j, d, r) = self.kernel, pairs(s.middle(), self.kernel.cut)
        rate = s.m[i] * k.g(r) * ((s.v[i] - s.v[j]) * d).sum(1)
        s.rho = s.rho + DT * sum_over(i, rate, len(s.x))


class Grains(Fluid):
    """doc/src/pair_fsi_grain.rst: a fluid, and spheres of diameter d in it, which have no forces
    among themselves"""

    def __init__(self, kernel, eta, grain, d):
        super().__init__(kernel, eta=eta)
        self.grain, self.d = grain, d

    def part(self, s):
        water = State.__new__(State)
        water.x, water.v, water.rho, water.m = (a[~self.grain] for a in (s.x, s.v, s.rho, s.m))
        return water

    def force(self, s):
        water, f = self.part(s), np.zeros_like(s.x)
        on_water = super().force(water)
        for g in np.flatnonzero(self.grain):
            r = np.linalg.norm(water.x - s.x[g], axis=1)
            w = np.where(r < self.kernel.cut, water.m / water.rho * self.kernel.W(r), 0)
            A = np.hstack([np.ones((len(r), 1)), water.x - s.x[g]]) * np.sqrt(w)[:, None]
            grad = np.linalg.solve(A.T @ A, A.T @ (np.sqrt(w) * self.p(water.rho)))[1:]
            u, rho = w @ water.v / w.sum() - s.v[g], w @ water.rho / w.sum()
            Re = rho * self.d * np.linalg.norm(u) / self.eta
            C_D = max(24 / Re * (1 + 0.15 * Re**0.687), 0.44)
            f[g] = (min(1, 4 * w.sum()) * np.pi / 8 * rho * self.d**2 * C_D * np.linalg.norm(u) * u
                    - np.pi / 6 * self.d**3 * grad)
            on_water -= w[:, None] / w.sum() * f[g]
        f[~self.grain] = on_water
        return f

    def advance(self, s):
        water = self.part(s)
        super().advance(water)
        s.rho[~self.grain] = water.rho


class Lagrangian:
    """doc/src/pair_fsi_solid_tl.rst, as unittest/solids.py has it"""

    def __init__(self, reference, law, zeta, artificial, c):
        self.reference, self.name, self.zeta = reference, law, zeta
        self.artificial, self.c = artificial, c

    def force(self, s):
        return self.reference(s.x, self.name, self.zeta, tl.LAMBDA,
                              tl.E)[1] + self.reference.viscous(s.x, s.v, *self.artificial, self.c)

    def advance(self, s):
        pass


class Eulerian:
    """doc/src/pair_fsi_solid.rst with gradient plain; stress as in unittest/styles/test_solid.py"""

    def __init__(self, kernel, artificial, epsilon, young, nu):
        self.kernel, self.artificial, self.epsilon = kernel, artificial, epsilon
        self.G, self.K = young / (2 * (1 + nu)), young / (3 * (1 - 2 * nu))
        self.c = np.sqrt(self.K / 1000)
        self.S = None

    def force(self, s):
        k, (i, j, d, r), V = self.kernel, pairs(s.x, self.kernel.cut), s.m / s.rho
        if self.S is None:
            self.S = np.zeros((len(s.x), 3, 3))
        sigma = self.S - (self.c**2 * (s.rho - 1000))[:, None, None] * np.eye(3)
        value, axis = np.linalg.eigh(sigma)
        R = -self.epsilon * np.einsum("nk,nak,nbk->nab", np.maximum(value, 0), axis, axis)
        v2, f4 = (V**2)[:, None, None], ((k.W(r) / k.W(DX))**4)[:, None, None]
        t = (sigma * v2)[i] + (sigma * v2)[j] + f4 * ((R * v2)[i] + (R * v2)[j])
        contact = self.K * DX * np.maximum(DX / r - 1, 0) / k.g(r)
        t = np.where((s.mol[i] == s.mol[j])[:, None, None], t, contact[:, None, None] * np.eye(3))
        alpha, beta = self.artificial
        mu = np.minimum(((s.v[i] - s.v[j]) * d).sum(1), 0) * k.h / (r**2 + 0.01 * k.h**2)
        Q = (s.rho[i] + s.rho[j]) / 2 * V[i] * V[j] * (-alpha * self.c * mu + beta * mu**2)
        t = t - Q[:, None, None] * np.eye(3)
        return sum_over(i, np.einsum("nab,nb->na", t, k.g(r)[:, None] * d), len(s.x))

    def advance(self, s):
        k, (i, j, d, r), V = self.kernel, pairs(s.middle(),
                                                # of the gradient: m/rho0
                                                self.kernel.cut), s.m / 1000
        own = (s.mol[i] == s.mol[j])
        L = sum_over(i, (own * V[j] * k.g(r))[:, None, None]
                     * np.einsum("na,nb->nab", s.v[j] - s.v[i], d), len(s.x))
        for n, A in enumerate(L):
            e, w = (A + A.T) / 2, (A - A.T) / 2
            Q = rotation(w * DT / 2)
            S = Q @ self.S[n] @ Q.T + 2 * self.G * DT * (e - np.trace(e) / 3 * np.eye(3))
            self.S[n] = Q @ S @ Q.T
        a = DT / 2 * np.trace(L, axis1=1, axis2=2)
        s.rho = s.rho * (1 - a) / (1 + a)


def rotation(w):
    out, term = np.eye(3), np.eye(3)
    for k in range(1, 20):
        term = term @ w / k
        out = out + term
    return out


# ---- files --------------------------------------------------------------------------------------


def block(lines):
    return "! |\n" + "".join(f"  {line}\n" for line in lines) if lines else '! ""\n'


def numbers(f):
    return "! |2\n" + "".join(f"  {k:3} {a:23.16e} {b:23.16e} {c:23.16e}\n" for k,
                              (a, b, c) in enumerate(f, 1))


def virial(s):
    w = s.x.T @ s.f
    return "! |2-\n  " + " ".join(f"{value:23.16e}"
                                  for value in (*np.diag(w), w[0, 1], w[0, 2], w[1, 2])) + "\n"


def yaml(style, coeff, post, s, prerequisites=(), epsilon=1e-10, deck="in.fsi"):
    head = (f"---\nlammps_version: 4 Feb 2025\ndate_generated: {DATE}\nepsilon: {epsilon}\n"
            "skip_tests:\nprerequisites: "
            + block(["atom fsi", f"pair {style.split()[0]}", "fix fsi", *prerequisites])
            + 'pre_commands: ! ""\n' + "post_commands: " + block(post)
            + f"input_file: {deck}\npair_style: {style}\npair_coeff: "
            + block(coeff if isinstance(coeff, list) else [coeff])
            + 'extract: ! ""\n'
            + f"natoms: {len(s.x)}\ninit_vdwl: 0\ninit_coul: 0\n"
            + f"init_stress: {virial(s)}init_forces: {numbers(s.f)}")
    for _ in range(4):
        s.step()
    return (head + f"run_vdwl: 0\nrun_coul: 0\nrun_stress: {virial(s)}"
            + f"run_forces: {numbers(s.f)}...\n")


def main(folder):
    x, v, rho, mol = particles()
    mass = 0.001
    files = {"data.fsi": data_file(x, v, rho, mol, mass)}
    empty = "group none empty"

    def fluid(name, words, law, h, kernel, material):
        post = [empty, f"fix sph none fsi {DX} {kernel} {h} mach off"]
        files[f"atomic-pair-fsi_{name}.yaml"] = yaml(f"fsi/fluid sound {C:g} {words}",
                                                     f"* * materials.fsi {material}", post,
                                                     State(law, x, v, rho, mol, mass))

    fluid("fluid", "tension yes", Fluid(Kernel("wendland", 3, 1.5 * DX)), 1.5, "wendland",
          "water_inviscid")
    fluid("fluid_viscous", "eos tait tension yes artificial/visc 0.3 0.5 laminar/visc/central",
          Fluid(Kernel("quintic", 3, 1.0 * DX), tait=True, artificial=(0.3, 0.5), eta=ETA), 1.0,
          "quintic", VISCOUS)

    post = [empty, f"fix sph none fsi {DX} cubic 1.3 mach off", "fix stress all fsi/stress"]
    law = Eulerian(Kernel("cubic", 3, 1.3 * DX), (0.4, 1.0), 0.3, YOUNG, POISSON)
    files["atomic-pair-fsi_solid.yaml"] = yaml(
        "fsi/solid artificial/visc 0.4 1 artificial/stress 0.3", f"* * materials.fsi {SOLID}", post,
        State(law, x, v, rho, mol, mass), ["fix fsi/stress"])

    for name, law, zeta, quadratic in (("solid_tl", "svk", 0.0, True),
                                       ("solid_tl_neohookean", "neohookean", 0.2, False)):
        X, y, post = deformation()
        kernel = Kernel("wendland", 3, 1.5 * DX)
        tl.RHO, tl.E, tl.NU = 1000.0, YOUNG, POISSON
        tl.G, tl.K = YOUNG / (2 * (1 + POISSON)), YOUNG / (3 * (1 - 2 * POISSON))
        tl.LAMBDA = tl.K - 2 * tl.G / 3
        reference = tl.Reference(X, kernel, 3, np.full(len(X), mass), quadratic=quadratic)
        state = State(Lagrangian(reference, law, zeta, (0.2, 0.4), np.sqrt(tl.K / 1000)), y, v,
                      rho, mol, mass)
        words = (f"fsi/solid/tl law {law} gradient {'quadratic' if quadratic else 'linear'} "
                 f"hourglass {zeta:g} volumes plain artificial/visc 0.2 0.4")
        files[f"atomic-pair-fsi_{name}.yaml"] = yaml(
            words, f"* * materials.fsi {SOLID}",
            [empty, f"fix sph none fsi {DX} wendland 1.5 mach off", *post], state)

    files.update(of_grains(x, v, rho, mol, mass))
    files.update(of_fix(x, v, rho, mol, mass))
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in files.items():
        (folder / name).write_text(text)


def of_grains(x, v, rho, mol, mass):
    """Six of the particles are grains: their data file, deck and test"""
    d, density = 0.004, 2500
    grain = np.isin(np.arange(1, len(x) + 1), (22, 23, 27, 38, 42, 43))
    head, rest = data_file(x, v, rho, mol, mass).split("Atoms # fsi")
    atoms, speeds = ([row.split() for row in part.strip().splitlines()]
                     for part in rest.split("Velocities"))
    # of particles with a diameter the column of masses is a density
    rows = [" ".join([row[0], "2" if of else "1", *row[4 + 1:8], row[1], row[3],
                      str(density) if of else row[4], str(d) if of else "0", "0 0 0"])
            for row, of in zip(atoms, grain)]
    data = (head.replace("1 atom types", "2 atom types") + "Atoms # hybrid\n\n" + "\n".join(rows)
            + "\n\nVelocities\n\n" + "\n".join(" ".join(row) + " 0 0 0" for row in speeds) + "\n")
    deck = (TESTS / "in.fsi").read_text().replace("data.fsi", "data.fsi_grain").replace(
        "atom_style       fsi", "atom_style       hybrid fsi sphere")
    m = np.where(grain, density * np.pi / 6 * d**3, mass)
    state = State(Grains(Kernel("wendland", 3, 1.5 * DX), ETA, grain, d), x, v, rho.copy(), mol, m)
    return {"data.fsi_grain": data, "in.fsi_grain": deck, "atomic-pair-fsi_grain.yaml": yaml(
        f"hybrid/overlay fsi/fluid sound {C:g} tension yes laminar/visc/central fsi/grain",
        [f"* * fsi/fluid materials.fsi {VISCOUS} NULL", "1 2 fsi/grain", "2 2 none"],
        ["group none empty", f"fix sph none fsi {DX} wendland 1.5 mach off"], state,
        ["atom sphere", "pair fsi/fluid"], deck="in.fsi_grain")}


def of_fix(x, v, rho, mol, mass):
    """Eight steps of fix fsi. The frame takes steps of 0.25 and defines a force field with bonds,
    which is given up again. It runs the fix of ID test with rRESPA, too, which fix fsi refuses,
    but for some styles: fix nve/limit of an empty group has the ID."""
    unit = DT / 0.25    # of time, s
    state = State(Fluid(Kernel("wendland", 3, 1.5 * DX), artificial=(0.3, 0.5)), x, v, rho, mol,
                  mass)
    for _ in range(8):    # doc/src/fix_fsi.rst
        state.x = state.x + DT / 2 * state.v
        state.law.advance(state)
        state.v = state.v + DT * state.law.force(state) / state.m[:, None]
        state.x = state.x + DT / 2 * state.v
    head, rest = data_file(x, (v * unit).round(9), rho, mol, mass).split("Atoms # fsi")
    atoms, speeds = rest.split("Velocities")
    rows = [row.split() for row in atoms.strip().splitlines()]
    rows = [" ".join([row[0], "1", *row[5:8], row[1], row[3], row[4], "0 0 0"]) for row in rows]
    data = (head.replace("1 atom types", "5 atom types\n5 bond types\n4 angle types")
            + "Atoms # hybrid\n\n" + "\n".join(rows) + "\n\nVelocities" + speeds)
    deck = (TESTS / "in.fsi").read_text().replace("data.fsi", "data.fsi_timestep").replace(
        "atom_style       fsi", "atom_style       hybrid fsi angle")
    post = ["bond_style none", "angle_style none",
            f"fsi/material water fluid rho 1000 sound {C * unit:g}",
            "pair_style fsi/fluid tension yes artificial/visc 0.3 0.5",
            "pair_coeff * * NULL water water water water water", "group none empty",
            f"fix sph all fsi {DX} wendland 1.5 mach off", "fix test none nve/limit 1"]
    test = (f"---\nlammps_version: 4 Feb 2025\ndate_generated: {DATE}\nepsilon: 1e-10\n"
            "skip_tests:\nprerequisites: "
            + block(["atom fsi", "atom angle", "pair fsi/fluid", "fix fsi", "fix nve/limit"])
            + 'pre_commands: ! ""\n' + "post_commands: " + block(post)
            + f"input_file: in.fsi_timestep\nnatoms: {len(x)}\nglobal_scalar: 0\n"
            + f"run_pos: {numbers(state.x)}run_vel: {numbers(state.v * unit)}...\n")
    return {"data.fsi_timestep": data, "in.fsi_timestep": deck, "fix-timestep-fsi.yaml": test}


def deformation():
    """Of one body, which takes its reference in a run of no steps: reference, deformed
    positions, the commands that make them"""
    k = np.arange(64)
    n = np.stack([k % 4, k // 4 % 4, k // 16], 1)
    X = (n + 0.5) * DX
    y = X + np.stack([5 * X[:, 1]**2 + 0.03 * X[:, 0], 0.04 * X[:, 2] - 3 * X[:, 0] * X[:, 1], 0.05
                      * X[:, 0] + 4 * X[:, 2]**2], 1)
    post = ["set group all mol 1", 'variable X atom "((id-1)%4+0.5)*0.01"',
            'variable Y atom "(floor((id-1)/4)%4+0.5)*0.01"',
            'variable Z atom "(floor((id-1)/16)+0.5)*0.01"', "set group all x v_X y v_Y z v_Z",
            "run 0 post no",
            'variable x atom "v_X+5*v_Y^2+0.03*v_X"', 'variable y atom "v_Y+0.04*v_Z-3*v_X*v_Y"',
            'variable z atom "v_Z+0.05*v_X+4*v_Z^2"',
            "set group all x v_x y v_y z v_z"]
    return X, y, post


# of potentials/materials.fsi
VISCOUS, ETA = "vortex_Re1000", 1.0
SOLID, YOUNG, POISSON = "plate", 1.9984472e6, 0.39751553

if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else TESTS)
