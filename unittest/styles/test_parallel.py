"""Neither decomposition, newton flag, numbering nor orientation may change the result."""

import re
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from decks import box, deck
from scenes import WATER, dam_gate, difference, fluid_box, lammps, run, watch


SCENES = {"fluid_box": fluid_box, "dam_gate": dam_gate}
# Forces at step 0 differ by the order of summation only: about 100 terms, each 1e-16 of the
# largest, in sums that cancel to a tenth or so.
FORCE = 1e-13
# A total-Lagrangian plate of 2 MPa starts with the elastic forces of F = 1 to round-off: 1e-16 of
# 10 terms, 1e4 times the weight.
FORCE_TL = 1e-11
# After 100 steps relative to the largest coordinate, velocity, density, stress: growth of those
# 1e-16 by collisions of perturbed particles; measured: 4e-13 at most. A missing ghost shows at 1e-4
# and above.
TRAJECTORY = 1e-9

GRIDS = [(1, "1 1 1", "off"), (2, "2 1 1", "on"), (2, "1 2 1", "off"), (4, "4 1 1", "on"),
         (4, "2 2 1", "on"),
         (4, "1 4 1", "off"), (2, "2 1 1", "off on")]
GRIDS_3D = [*GRIDS, (2, "1 1 2", "on"), (4, "1 2 2", "off")]
CASES = [(name, dim, *grid) for name in SCENES for dim in (2, 3)
         for grid in (GRIDS if dim == 2 else GRIDS_3D)]
NO_DIFFUSION = "sound 10 couple wall artificial/visc 0.05 0.1"
ALTERNATIVES = {  # what else crosses ranks: options of the scene, in 2D and 3D
    "summation": {"density": "fluid summation solid continuity",
                  "fluid": NO_DIFFUSION + " surface 0.9"},
    "solid summation": {"density": "fluid summation solid summation", "fluid": NO_DIFFUSION},
    "article": {"density": "scheme article", "fluid": NO_DIFFUSION + " tension yes",
                "solid": "artificial/visc 0.1 0"},
    "plain": {"kernel": "cubic 1.3", "fluid": "sound 10 eos tait couple full artificial/visc 0.1 0",
              "solid": "artificial/visc 0.5 0"},
    "full": {"kernel": "quintic 1.0",
             "fluid": "sound 10 couple full tension yes artificial/visc 0.1 0",
             # it does not stay sound in 3D: ranks agree all the same
             "solid": "artificial/visc 0.1 0 artificial/stress 0.3", "sph": "mach off"},
    "hourglass": {"solid": "artificial/visc 0.1 0 hourglass 0.5 gradient quadratic"},
    "quadratic": {"solid": "artificial/visc 0.1 0 artificial/stress 0.2 gradient quadratic"},
    "no slip": {"solid_style": "fsi/solid/tl", "solid": "artificial/visc 0.1 0",
                "fluid": "sound 10 laminar/visc"},
    "shift": {"fluid": "sound 10 laminar/visc/central shift 0.5"},
    "shift every third step": {"fluid": "sound 10 laminar/visc shift 0.5 shift/every 3"},
    "shift in a full box": {
        "fluid": "sound 10 laminar/visc tension yes background 50 density/diffusion 0.1 shift 0.5"},
    "surfaces": {"fluid": "sound 10 artificial/visc 0.05 0 density/diffusion 0.1 density/surface "
                 "yes"},
    "extrapolate": {"fluid": NO_DIFFUSION + " extrapolate yes"},
    "tl": {"solid_style": "fsi/solid/tl", "solid": "artificial/visc 0.1 0.1 hourglass 0.1"},
    "tl substeps": {"solid_style": "fsi/solid/tl", "solid": "law neohookean", "sph": "substeps 4"},
    "tl viscous substeps": {"solid_style": "fsi/solid/tl",
                            "solid": "artificial/visc 0.2 0 gradient linear",
                            "sph": "substeps 3"},
}
# a thin plate of the article's raw density is in such tension at its corners that it tears itself
# apart in 3D
OTHERS = [(name, dim) for name in ALTERNATIVES for dim in (2, 3) if (name, dim)
          != ("solid summation", 3)]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("parallel")


def frames(folder, scene, ranks=1, grid="* * *", extra="", steps=100):
    """State at the first and the last step."""
    return run(folder, scene.text(grid) + extra + watch(every=steps) + f"run {steps}\n", ranks,
               scene_data=scene.data()).frames()


@pytest.fixture(scope="module")
def reference(folder):
    """reference(name, dim): the scene and its frames on one rank."""
    known = {}

    def get(name, dim):
        if (name, dim) not in known:
            scene = SCENES[name](dim)
            known[name, dim] = scene, frames(folder / f"{name}{dim}", scene)
        return known[name, dim]

    return get


def agree(want, got, force=FORCE):
    assert [frame.step for frame in got] == [frame.step for frame in want] and len(got) == 2
    assert difference(want[0], got[0], "f") < force
    for quantity in ("x", "v", "rho", "stress"):
        assert difference(want[1], got[1], quantity) < TRAJECTORY, quantity


@pytest.mark.parametrize("name, dim", [(name, dim) for name in SCENES for dim in (2, 3)])
def test_scene_is_worth_comparing(reference, name, dim):
    """Forces act, particles move, and the plate gets stressed: or agreement would mean nothing."""
    scene, (start, end) = reference(name, dim)
    weight = start["mass"].max() * 9.81
    assert np.abs(start.vector(("fx", "fy", "fz"))).max() > 2.0 * weight
    assert difference(start, end, "x", size=1.0) > 1e-4
    if scene.has_solid:
        viscous = np.abs(end.of_types(1)["sxy"]).max()    # of laminar viscosity
        assert np.abs(end.of_types(2)["sxy"]).max() > 100.0 and viscous < 0.1


@pytest.mark.parametrize("name, dim, ranks, grid, newton", CASES)
def test_decomposition(tmp_path, reference, name, dim, ranks, grid, newton):
    scene, want = reference(name, dim)
    agree(want, frames(tmp_path, replace(scene, newton=newton), ranks, grid))


@pytest.mark.parametrize("name, dim", OTHERS)
def test_decomposition_of_other_effects(tmp_path, name, dim):
    scene = dam_gate(dim, **ALTERNATIVES[name])
    want = frames(tmp_path / "one", scene, steps=30)
    force = FORCE_TL if scene.solid_style == "fsi/solid/tl" else FORCE
    agree(want, frames(tmp_path / "four", replace(scene, newton="off"), 4, "2 2 1", steps=30),
          force)
    agree(want, frames(tmp_path / "on", scene, 4, "2 2 1", steps=30), force)


@pytest.mark.parametrize("newton", ("on", "off"))
def test_pressure_does_not_depend_on_newton(tmp_path, newton):
    """Global virial, from x.f with newton on. No walls and no gravity: their forces are no part of
    the pair virial."""
    scene = dam_gate(2, newton=newton, gravity=np.array([0.0, -1e-9, 0.0]))
    scene.walls = []
    # a few steps, in which the gate comes under stress, and ranks that have parts of it
    end = 'thermo_modify line one format float %.15g\nrun 20\nprint "PRESS $(press:%.17g)"\n'
    want = run(tmp_path / "on", scene.text().replace(f"newton {newton}", "newton on") + end,
               scene_data=scene.data())
    got = run(tmp_path / "it", scene.text("1 2 1") + end, 2, scene_data=scene.data())
    values = [
        float([line for line in r.output.splitlines() if line.startswith("PRESS")][0].split()[1])
        for r in (want, got)]
    # sums of 20,000 pairs; x.f cancels to a hundredth of its terms
    assert values[1] == pytest.approx(values[0], rel=1e-10)


@pytest.mark.parametrize("name, dim", [("dam_gate", 2), ("dam_gate", 3)])
@pytest.mark.parametrize("how", ("once", "always", "rcb"))
def test_balance(tmp_path, reference, name, dim, how):
    scene, want = reference(name, dim)
    extra = {"once": "balance 1.0 shift xy 20 1.0\n",
             "always": "fix balance all balance 10 1.0 shift xy 10 1.0\n",
             "rcb": "comm_style tiled\nfix balance all balance 20 1.0 rcb\n"}[how]
    agree(want, frames(tmp_path, scene, 4, "2 2 1", extra))


@pytest.mark.parametrize("dim", (2, 3))
def test_balance_of_total_lagrangian_solid(tmp_path, dim):
    """Bonds travel with their particles when ranks change their shape, too."""
    scene = dam_gate(dim, **ALTERNATIVES["tl viscous substeps"])
    rcb = "comm_style tiled\nfix balance all balance 20 1.0 rcb\n"
    agree(frames(tmp_path / "one", scene), frames(tmp_path / "four", scene, 4, "2 2 1", rcb),
          FORCE_TL)


@pytest.mark.parametrize("ranks", (1, 4))
@pytest.mark.parametrize("dim", (2, 3))
def test_permuted_ids(tmp_path, reference, dim, ranks):
    scene, want = reference("dam_gate", dim)
    other = scene.permuted()
    got = frames(tmp_path, other, ranks)
    # new id -> the particle's row in the reference, by its place at the start
    place = {tuple(p): k for k, p in enumerate(want[0].vector())}
    order = np.empty(len(scene.x), dtype=int)
    for k, p in enumerate(got[0].vector()):
        order[place[tuple(p)]] = k
    assert (order != np.arange(len(order))).any()
    for frame in got:
        for column in frame.columns:
            if column != "id":
                frame.columns[column] = frame[column][order]
    agree(want, got)


TURNS = [("half turn", (0, 1, 2), (-1, -1, 1)), ("quarter turn", (1, 0, 2), (-1, 1, 1)),
         ("mirror x", (0, 1, 2), (-1, 1, 1)),
         ("swap", (1, 0, 2), (1, 1, 1)), ("about x", (0, 2, 1), (1, -1, 1)),
         ("cyclic", (2, 0, 1), (1, 1, 1)),
         ("point", (0, 1, 2), (-1, -1, -1))]


@pytest.mark.parametrize("dim, axes, signs",
                         [pytest.param(dim, axes, signs, id=f"{dim}D {what}")
                          for what, axes, signs in TURNS
                          for dim in (2, 3) if dim == 3 or axes[2] == 2 and signs[2] == 1])
def test_turned_and_mirrored(tmp_path, reference, dim, axes, signs):
    scene, want = reference("dam_gate", dim)
    got = frames(tmp_path, scene.turned(axes, signs), 2)
    back = [list(axes).index(k) for k in range(3)]  # where old axis k went
    names = "xyz"
    for frame in got:
        c = dict(frame.columns)
        for k, b in enumerate(back):
            for p in ("", "v", "f"):
                frame.columns[p + names[k]] = signs[b] * c[p + names[b]]
            for m in range(k, 3):
                i, j = sorted((b, back[m]))
                frame.columns["s" + names[k]
                              + names[m]] = signs[b] * signs[back[m]] * c["s" + names[i] + names[j]]
    agree(want, got)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("ranks, newton", [(1, "off"), (2, "on"), (2, "off"), (4, "off")])
def test_sums_over_pairs(tmp_path, dim, ranks, newton):
    """Forces on walls and the energy ledger count every pair once, also where two ranks compute
    it."""
    def sums(folder, ranks, newton):
        scene = replace(dam_gate(dim), newton=newton)
        rows = len(scene.walls)
        columns = [f"f_walls[{k + 1}][{d + 1}]" for k in range(rows) for d in range(dim)]
        columns += [f"c_energy[{k}]" for k in range(1, 12)]
        text = "compute energy all fsi/energy\nthermo_style custom step " + " ".join(columns) + \
            "\nthermo_modify format float %.17g\n"
        output = run(folder, scene.text() + text + "run 40\n", ranks,
                     scene_data=scene.data()).output
        return np.array([float(w) for w in [r for r in output.splitlines() if r.split()[:1]
                                            == ["40"]][-1].split()[1:]])

    one, other = sums(tmp_path / "one", 1, "on"), sums(tmp_path / "other", ranks, newton)
    # sums in another order, after 40 steps: see TRAJECTORY; relative to the largest force and to
    # the largest energy
    walls = len(one) - 11
    for part in (slice(None, walls), slice(walls, None)):
        assert np.abs(one[part] - other[part]).max() < 1e-9 * np.abs(one[part]).max()
    assert np.abs(one[walls + 4:] - other[walls + 4:]).max() < 1e-9 * np.abs(one[walls + 4:]).max()


def test_pressure_is_of_pairs(tmp_path):
    """Images in mirror walls are no particles: with newton on and off the virial is that of
    pairs."""
    found = []
    for newton in ("on", "off"):
        scene = fluid_box(2, newton=newton)
        output = run(tmp_path / newton, scene.text() + "thermo_style custom step press\nrun 0\n",
                     scene_data=scene.data()).output
        found.append(float(re.search(r"Press\s*\n\s*0\s+(\S+)", output)[1]))
    assert found[0] != 0.0 and found[0] == pytest.approx(found[1], rel=1e-9)


COUNTER = """#include <mpi.h>
#include <stdio.h>
static long long bytes;
int MPI_Allgatherv(const void *s, int n, MPI_Datatype t, void *r, const int *c, const int *first, MPI_Datatype to, MPI_Comm w)
{
  int size, one;
  MPI_Comm_size(w, &size);
  MPI_Type_size(to, &one);
  for (int k = 0; k < size; k++) bytes += (long long) c[k] * one;
  return PMPI_Allgatherv(s, n, t, r, c, first, to, w);
}
int MPI_Finalize(void)
{
  printf("bytes on every rank %lld\\n", bytes);
  fflush(stdout);
  return PMPI_Finalize();
}
"""


def bytes_on_every_rank(folder, text, ranks=4):
    (folder / "count.c").write_text(COUNTER)
    subprocess.run(["mpicc", "-shared", "-fPIC", "-o", "count.so", "count.c"], cwd=folder,
                   check=True)
    output = run(folder, text, ranks, environment={"LD_PRELOAD": str(folder / "count.so")}).output
    return int(re.findall(r"bytes on every rank (\d+)", output)[-1])


PHYSICS = """
fsi/material w fluid rho 1000
fsi/material b wall rho 1000
timestep 1e-4
neighbor 0.015 bin
"""


def test_states_of_clamped_bodies_alone(tmp_path):
    """One wall among 400 grains that fix rigid/small moves: 20 steps take its state alone to all
    ranks, 144 bytes twice a step, and IDs at the start."""
    text = box("0 4 0 2", 0.1, "atom_modify map array", types=3, water="0 1 0 1", wall="1 1.2 0 1") + """lattice sq 0.05 origin 0.5 0.5 0
region grains block 2 4 0 2 INF INF units box
create_atoms 3 region grains""" + PHYSICS + """pair_style hybrid/overlay fsi/fluid sound 10 zero 0.1
pair_coeff * * zero
pair_coeff * * fsi/fluid NULL w b NULL
variable body atom "(type==3)*(2+floor(x*10)+100*floor(y*10))+(type==2)"
group bodies type 2 3
set type 3 mass 1
set group bodies mol v_body
fix sph water fsi 0.1 wendland 1.5
fix w all fsi/wall/mirror xlo 0 ylo 0
fix wp wall fsi/wall/particle
comm_modify cutoff 1
fix r bodies rigid/small molecule
run 20
"""
    assert 5000 < bytes_on_every_rank(tmp_path, text, 2) < 8000


def test_places_of_a_body_go_where_they_matter(tmp_path):
    """Levels around a body in half of a long box: 8 events on four ranks take its 160 places to
    none of them that is not near."""
    text = box("0 8 0 1", 0.05, "atom_modify map array", boundary="p p p", types=3, water="") + """region body block 0 4 0.2 0.3 INF INF units box
set region body type 3""" + PHYSICS + """pair_style fsi/fluid sound 10 tension yes
pair_coeff * * NULL w w b
group body type 3
group moving subtract all body
fix sph moving fsi 0.05 wendland 1.5 spacing 2 $(0.05/sqrt(2))
fix wp body fsi/wall/particle
fix r moving fsi/refine 5 types 1 2 distance body 0.15
velocity moving set 1 0 0
run 40
"""
    assert bytes_on_every_rank(tmp_path, text) < 20000


def test_a_rank_that_has_nothing(tmp_path):
    """Half of the box is empty and has no ghosts. Tiled ranks wait for each other's empty messages,
    in the balance of energy, too, so all have to send them."""
    text = deck("-0.1 0.3 -0.1 0.9", 0.01, {"water": WATER}, "fix g all gravity 9.81 vector 0 -1 0",
                "fix w all fsi/wall/mirror xlo 0 ylo 0", "compute e all fsi/energy",
                "thermo_style custom step c_e", "run 10", 'print "ENERGY $(c_e:%.17g)"',
                water="0 0.2 0 0.1", before=("comm_style tiled", "processors 1 * *"),
                fluid="sound 10 artificial/visc 0.05 0")
    one, two = (float(re.search(r"^ENERGY (.*)$", lammps(tmp_path, text, ranks, timeout=60).output,
                                re.M)[1]) for ranks in (1, 2))
    assert one > 1.0 and abs(two / one - 1.0) < 1e-13
