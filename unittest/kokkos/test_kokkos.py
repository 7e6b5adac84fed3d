"""Styles with suffix kk against the plain ones, on Kokkos' backend of threads: forces, places,
velocities, densities, step by step (tools/kokkos)."""

import re
from dataclasses import replace

import numpy as np
import pytest
from decks import INVISCID, deck, resume
from scenes import DX, Deck, dam_gate, difference, fluid_box, lammps, particles, run

from fsi import paths

# Sums in another order: some hundred terms of 1e-16 of the largest. What is missing shows at 1e-3
# and above. In single precision (FSI_CMAKE_OPTIONS= -DKOKKOS_PREC=single) arrays of the host and of
# Kokkos are apart on processors, too: then these tests show what was not brought from one to the
# other.
SINGLE = re.search("^KOKKOS_PREC:STRING=single", (paths.BUILD / "CMakeCache.txt").read_text(), re.M)
CLOSE, LATER = (5e-3, 5e-2) if SINGLE else (1e-11, 1e-8)
STEPS = 20


def kokkos(threads=1, *options):
    return ("-k", "on", "t", str(threads), "-sf", "kk",
            *(("-pk", "kokkos", *options) if options else ()))


WAYS = {"1 thread": (1, kokkos()), "2 threads": (1, kokkos(2)), "2 ranks": (2, kokkos()),
        "2 ranks, messages by device": (2, kokkos(1, "comm", "device")),
        "2 ranks of 2 threads": (2, kokkos(2))}


def watch(file="atoms.dump", every=1):
    """Input that dumps the state of all particles in full precision"""
    return (f"compute rho all fsi/atom rho\ndump atoms all custom {every} {file} id type x y z vx "
            "vy vz fx fy fz c_rho\n"
            "dump_modify atoms sort id time yes format float %.17g colname c_rho rho\n")


def box(dim, **options):
    return fluid_box(dim, **options)


def limited(dim, **options):
    """A wall that ends in the fluid, met from both sides, beside others without end"""
    scene = fluid_box(dim, **options)
    middle, top = float(scene.x[:, 0].mean()), float(scene.x[:, 1].max())
    return replace(scene, walls=[*scene.walls, (0, 1, middle, f"range y {0.5 * top!r} INF slip no"),
                                 (0, -1, middle, f"range y {0.5 * top!r} INF")])


def hydrostatic(dim):
    scene = fluid_box(dim)
    return replace(scene, walls=[(a, s, p, rest + " hydrostatic yes" if a == 1 else rest)
                                 for a, s, p, rest in scene.walls])


class TwoFluids(Deck):
    """Two fluids, half and half"""

    has_solid = False

    def data(self):
        return particles(self.x, self.type, 0, self.v, self.rho
                         * np.where(self.type == 2, 0.8, 1.0), box=self.box, types=2, ids=self.ids)

    def physics(self, coeff=True):
        oil = ("fsi/material oil fluid rho 800 viscosity 0.02 sound 12\n"
               "fsi/material sea fluid rho 1000 viscosity 0.001 sound 10\n")
        return oil + super().physics(coeff).replace("materials.fsi water", "NULL sea oil")


def two_fluids(dim):
    scene = fluid_box(dim)
    kind = np.where(scene.x[:, 1] > np.median(scene.x[:, 1]), 2, 1)
    return TwoFluids(scene.dim, scene.x, scene.v, kind, scene.rho, scene.box, scene.walls)


def box_of(dim, fluid, **options):
    return fluid_box(dim, fluid=fluid, **options)


SCENES = {
    "mirror walls": box,
    "newton off": lambda dim: box(dim, newton="off"),
    "kernel cubic": lambda dim: box(dim, kernel="cubic 1.3"),
    "kernel quintic": lambda dim: box(dim, kernel="quintic 1.1"),
    "without viscosity": lambda dim: box_of(dim, "sound 10"),
    "artificial viscosity": lambda dim: box_of(dim, "sound 10 artificial/visc 0.05 0.1"),
    "diffusion alone": lambda dim: box_of(dim, "sound 10 density/diffusion 0.1"),
    "central viscosity, tait": lambda dim: box_of(
        dim, "sound 10 eos tait laminar/visc/central density/diffusion 0.1"),
    "tension, background": lambda dim: box_of(
        dim, "sound 10 tension yes background 50 laminar/visc density/diffusion 0.1"),
    "preset splash": lambda dim: box_of(dim, "preset splash 1"),
    "limited walls": limited,
    "limited walls, newton off": lambda dim: limited(dim, newton="off"),
    "hydrostatic walls": hydrostatic,
    "two fluids": two_fluids,
    "no walls": lambda dim: replace(box(dim), walls=[]),
    "other IDs": lambda dim: box(dim).permuted(),
}
ALL = [(name, dim) for name in SCENES for dim in (2, 3)]


def ends(scene):
    walls = " ".join(f"$(f_walls[{k + 1}][{d + 1}]:%.17g)" for k in range(len(scene.walls))
                     for d in range(scene.dim)) if scene.walls else "0"
    return (f'run {STEPS}\nprint "WALLS {walls} $(f_walls:%.17g)"\n' if scene.walls
            else f"run {STEPS}\n")


def state(folder, scene, arguments=(), ranks=1):
    """All steps, and what else the run wrote"""
    return run(folder, scene.text() + watch(every=1) + ends(scene), ranks, arguments=arguments,
               scene_data=scene.data())


def numbers(result, name):
    return np.array(" ".join(re.findall(f"^{name} (.*)$", result.output, re.M)).split(), float)


@pytest.fixture(scope="module", name="plain")
def plain_states(tmp_path_factory):
    """Runs of the plain styles, each once"""
    known = {}

    def of(name, dim):
        if (name, dim) not in known:
            known[name, dim] = state(tmp_path_factory.mktemp("plain"), SCENES[name](dim))
        return known[name, dim]

    return of


def agree(want, got):
    a, b = want.frames(), got.frames()
    assert len(a) == len(b) == STEPS + 1
    for one, other in zip(a, b):
        for quantity in ("f", "x", "v", "rho"):
            assert difference(one, other, quantity) < CLOSE, (one.step, quantity)
    walls, others = numbers(want, "WALLS"), numbers(got, "WALLS")
    assert len(walls) == len(others)
    if len(walls):
        assert np.abs(walls - others).max() < CLOSE * np.abs(walls).max()


@pytest.mark.parametrize("name, dim", ALL)
def test_step_by_step(tmp_path, plain, name, dim):
    """One thread; and the styles are those with the suffix."""
    got = state(tmp_path, SCENES[name](dim), kokkos())
    assert "pair fsi/fluid/kk" in got.output
    agree(plain(name, dim), got)


@pytest.mark.parametrize("way", [way for way in WAYS if way != "1 thread"])
@pytest.mark.parametrize("name, dim", [("mirror walls", 2), ("mirror walls", 3),
                                       ("limited walls", 2), ("newton off", 3), ("two fluids", 2),
                                       ("no walls", 3)])
def test_threads_and_ranks(tmp_path, plain, name, dim, way):
    ranks, arguments = WAYS[way]
    agree(plain(name, dim), state(tmp_path, SCENES[name](dim), arguments, ranks))


@pytest.mark.parametrize("ranks", (1, 2))
@pytest.mark.parametrize("dim", (2, 3))
def test_periodic(tmp_path, dim, ranks):
    """Across periodic faces a particle meets its neighbors' images, on one rank and on two."""
    size = " ".join([f"0 {12 * DX!r}"] * dim)
    disorder = " ".join([repr(0.1 * DX)] * dim + ["0"] * (3 - dim))
    text = deck(size, DX, INVISCID, boundary="p p p", dim=dim, water="",
                fluid="sound 10 tension yes background 50 laminar/visc density/diffusion 0.1")
    text += (f"displace_atoms all random {disorder} 7 units box\n"
             "variable u atom sin(x*60)*cos(y*70)\nvelocity all set v_u v_u 0 units box\n")
    text += watch(every=1) + f"run {STEPS}\n"
    want = run(tmp_path / "plain", text, ranks)
    agree(want, run(tmp_path / "kk", text, ranks, arguments=kokkos()))


def test_turned_back(tmp_path):
    """Fast particles come too near to walls; some are held."""
    scene = fluid_box(2, fluid="sound 20 artificial/visc 0.05 0")
    v = scene.v.copy()
    v[:, :2] += np.where(np.abs(scene.x[:, :1] - scene.x[:, 0].mean()) > 0.4
                         * np.ptp(scene.x[:, 0]),
                         3.0 * np.sign(scene.x[:, :1] - scene.x[:, 0].mean()), 0.0)
    scene = replace(scene, v=v)
    scene.walls[0] = (0, 1, 0.0, "")
    want = state(tmp_path / "plain", scene)
    assert numbers(want, "WALLS")[-1] > 2
    agree(want, state(tmp_path / "kk", scene, kokkos(2)))


TERMS = 14
LEDGER = ('compute e all fsi/energy\nrun 0 post no\nrun 40\n'
          'print "LEDGER $(press:%.17g) $(c_e:%.17g) '
          + " ".join(f"$(c_e[{k + 1}]:%.17g)" for k in range(TERMS)) + '"\n')


@pytest.mark.parametrize("ranks", (1, 2))
@pytest.mark.parametrize("name", ("mirror walls", "no walls", "hydrostatic walls", "newton off"))
def test_energies(tmp_path, name, ranks):
    """Powers of terms, and the virial"""
    scene = SCENES[name](2)
    text = scene.text() + LEDGER
    plain, kk = (numbers(run(tmp_path / str(k), text, ranks if k else 1, arguments=k,
                             scene_data=scene.data()), "LEDGER") for k in ((), kokkos(2)))
    assert len(plain) == len(kk) == TERMS + 2 and np.count_nonzero(plain) > 7
    assert np.all(np.abs(plain - kk) <= LATER * np.abs(plain) + 1e-12 * np.abs(plain[1:]).max())


@pytest.mark.parametrize("ranks", (1, 2))
def test_restart(tmp_path, ranks):
    """A run goes on from a restart file of either, in either, as the whole run does."""
    scene = fluid_box(2)
    whole = scene.text() + watch(every=40) + "restart 20 mid.*\nrun 40\n"
    rest = resume(scene, "mid.20") + watch("rest.dump", 20) + "restart 20 other.*\nrun 20\n"
    frames = []
    for k, first in enumerate(((), kokkos())):
        folder = tmp_path / str(k)
        frames.append(run(folder, whole, ranks, arguments=first,
                          scene_data=scene.data()).frames()[-1])
        for second in ((), kokkos()):
            frames.append(run(folder, rest, ranks, arguments=second).frames("rest.dump")[-1])
    for frame in frames[1:]:
        assert frame.step == 40 and all(difference(frames[0], frame, quantity) < LATER
                                        for quantity in ("x", "v", "rho"))


@pytest.mark.parametrize("name, options", [("dam_break", ("-var", "dx", "0.03")),
                                           ("dam_break", ("-var", "dx", "0.015"))])
def test_dam_break(tmp_path, name, options):
    """The bundled deck as it is, but for its end"""
    text = (paths.EXAMPLES / name / f"in.{name}").read_text()
    text = re.sub(r"^fsi/dump .*$|^fsi/run .*$", "", text,
                  flags=re.M) + watch(every=100) + "run 200\n"
    frames = [run(tmp_path / str(k), text, ranks, arguments=(*options, *arguments)).frames()
              for k, (ranks, arguments) in
              enumerate(((1, ()), (1, kokkos()), (2, kokkos(2))))]
    for other in frames[1:]:
        assert len(other) == 3 and difference(frames[0][0], other[0], "f") < CLOSE
        assert all(difference(frames[0][-1], other[-1], quantity) < LATER
                   for quantity in ("x", "v", "rho"))


def test_dam_break_3d(tmp_path):
    """A column between six walls, without the obstacle, which is a solid"""
    text = deck(f"{-4 * DX!r} {40 * DX!r} {-4 * DX!r} {16 * DX!r} {-4 * DX!r} {12 * DX!r}", DX,
                INVISCID, "fix g all gravity 9.81 vector 0 -1 0",
                f"fix walls all fsi/wall/mirror xlo 0 xhi {36 * DX!r} ylo 0 zlo 0 zhi {8 * DX!r}",
                "fix dt all fsi/dt 10",
                dim=3, fluid="preset splash 4",
                water=f"0 {12 * DX!r} 0 {12 * DX!r} 0 {8 * DX!r}") + (
                    f"fsi/set all hydrostatic {12 * DX!r}\n") + watch(every=50) + "run 100\n"
    plain, kk = (run(tmp_path / str(len(k)), text, arguments=k).frames() for k in ((), kokkos(2)))
    assert difference(plain[0], kk[0], "f") < CLOSE
    assert all(difference(plain[-1], kk[-1], quantity) < LATER for quantity in ("x", "v", "rho"))


def test_stop(tmp_path):
    """A run that loses its meaning stops at the same step with the same words, and leaves the same
    state."""
    scene = fluid_box(2)
    v = scene.v.copy()
    v[7, 0] = 30.0
    scene = replace(scene, v=v)
    text = scene.text() + "fix push all addforce 2000 0 0\nrun 40\n"
    plain, kk = (lammps(tmp_path / str(len(k)), text, arguments=k, scene_data=scene.data())
                 for k in ((), kokkos()))
    assert plain.status and kk.status and plain.errors
    words = lambda result: re.sub(r"\(src[^)]*\)|/\S*", "",
                                  result.errors[0]).replace(str(result.folder), "")
    assert words(plain) == words(kk)


DAM = deck("-0.1 0.6 -0.1 0.5", 0.02, INVISCID, "fix g all gravity 9.81 vector 0 -1 0",
           "fix walls all fsi/wall/mirror xlo 0 xhi 0.5 ylo 0", water="0 0.2 0 0.3")


def dam(old="", new="", more=""):
    assert old in DAM
    return DAM.replace(old, new) + more


REFUSED = {
    "shift": (dam("fsi/fluid sound 10", "fsi/fluid sound 10 shift 0.5"), "keyword shift"),
    "surfaces": (dam("fsi/fluid sound 10", "fsi/fluid sound 10 density/surface yes"),
                 "keyword density/surface"),
    "surface": (dam("fsi/fluid sound 10", "fsi/fluid sound 10 surface 0.9"), "keyword surface"),
    "implicit": (dam("fsi/fluid sound 10", "fsi/fluid sound 10 laminar/visc laminar/implicit yes"),
                 "keyword laminar/implicit"),
    "eddies": (dam("fsi/fluid sound 10", "fsi/fluid sound 10 laminar/visc smagorinsky 0.1"),
               "keyword smagorinsky"),
    "law": (dam("fluid rho 1000", "fluid rho 1000 power 1 0.5 viscosity/limits 0.01 10").replace(
        "fsi/fluid sound 10", "fsi/fluid sound 10 laminar/visc"), "viscosity that varies"),
    "summation": (dam("wendland 1.5", "wendland 1.5 fluid summation"), "fix fsi fluid summation"),
    "stream": (dam(more="region all block INF INF INF INF INF INF\nfix s all fsi/stream 1 NULL "
                   "NULL region all rate 10\n"), "does not support fix s"),
    "force": (dam(more="compute c all fsi/force\n"), "compute fsi/force"),
    "shear rates": (dam("fsi/fluid sound 10", "fsi/fluid sound 10 laminar/visc",
                        more="compute c all fsi/atom shear/rate\ncompute m all reduce max c_c\n"
                        "thermo_style custom step c_m\n"),
                    "not supported with it"),
    "surface particles": (dam(more="compute c all fsi/surface/atom\ncompute m all reduce max c_c\n"
                              "thermo_style custom step c_m\n"), "not supported with it"),
    "the pair style without suffix": (
        dam("pair_style", "suffix off\npair_style").replace("pair_coeff", "suffix on\npair_coeff"),
        "requires pair_style fsi/fluid/kk"),
    "fix fsi without suffix": (dam("fix sph", "suffix off\nfix sph").replace(
        "fix g", "suffix on\nfix g"), "requires fix fsi/kk"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_refused(tmp_path, what):
    """By name"""
    text, words = REFUSED[what]
    result = lammps(tmp_path, text + "run 1\n", arguments=kokkos())
    assert result.status and words in " ".join(
        result.errors), result.errors or result.output[-1000:]


@pytest.mark.parametrize("dim", (2, 3))
def test_solids_refused(tmp_path, dim):
    scene = dam_gate(dim)
    result = lammps(tmp_path, scene.text() + "run 1\n", arguments=kokkos(), scene_data=scene.data())
    assert result.status and any(words in " ".join(result.errors) for words in (
        "hybrid", "fluids only", "does not support fix stress")), result.errors
