"""Runs that stop and go on, and LAMMPS' own commands on our atoms."""

import re
from dataclasses import replace

import numpy as np
import pytest
from decks import WALL, atoms, box, deck, materials, resume, start
from scenes import (RUBBER, WATER as INVISCID, dam_gate, difference, differing, fluid_box, lammps,
                    run, watch)

# Going on with other neighbor lists or another rank count changes the order of sums only: see
# TRAJECTORY in test_parallel.py;
# 40 steps instead of 100.
ROUND_OFF = 1e-11
# Relative error of a number that LAMMPS writes with 16 digits and reads again.
DIGITS = 1e-14

MODES = {
    "dam 2D": lambda: dam_gate(2),
    "dam 3D": lambda: dam_gate(3),
    "article": lambda: dam_gate(2, density="scheme article",
                                fluid="sound 10 tension yes artificial/visc 0.05 0",
                                solid="artificial/visc 0.1 0.1"),
    "fluid": lambda: fluid_box(2),
    "shift": lambda: dam_gate(
        2, fluid="sound 10 artificial/visc 0.05 0 density/diffusion 0.1 shift 0.5"),
    "shift every third step": lambda: dam_gate(
        2, fluid="sound 10 artificial/visc 0.05 0 density/diffusion 0.1 shift 0.5 shift/every 3"),
    "shift in a full box": lambda: dam_gate(
        2, fluid="sound 10 tension yes background 50 density/diffusion 0.1 shift 0.5"),
    "surfaces": lambda: dam_gate(
        2, fluid="sound 10 artificial/visc 0.05 0 density/diffusion 0.1 density/surface yes"),
    "tl 2D": lambda: dam_gate(2, solid_style="fsi/solid/tl",
                              solid="artificial/visc 0.1 0.1 hourglass 0.1"),
    "tl 3D": lambda: dam_gate(3, solid_style="fsi/solid/tl", solid="law neohookean",
                              sph="substeps 4"),
}


def close(a, b, tolerance=ROUND_OFF):
    for quantity in ("x", "v", "rho", "stress"):
        # the stress of a total-Lagrangian solid comes from its positions: 1e-16 of 0.2 m over 0.01
        # m of 2 MPa, and grows
        assert difference(a, b, quantity) < tolerance * (10 if quantity == "stress"
                                                         else 1), quantity


@pytest.mark.parametrize("ranks", (1, 2))
@pytest.mark.parametrize("mode", MODES)
def test_restart_n_goes_on_bit_for_bit(tmp_path, mode, ranks):
    """`restart N` makes the running simulation rebuild its lists at N, and so may continue
    exactly."""
    scene = MODES[mode]()
    whole = run(tmp_path, scene.text() + watch(every=80) + "restart 40 mid.*\nrun 80\n", ranks,
                scene_data=scene.data()).frames()[-1]
    rest = run(tmp_path, resume(scene, "mid.40") + watch("rest.dump", 80)
               + "restart 40 other.*\nrun 40\n",
               ranks).frames("rest.dump")[-1]
    assert whole.step == rest.step == 80
    assert differing(whole, rest) == []


WALL_PARTICLES = """
pair_style fsi/fluid sound 10 background 500 tension yes laminar/visc shift 0.2 density/diffusion 0.1
pair_coeff * * materials.fsi water wall
fix sph water fsi 0.05 wendland 1.5
fix mirror water fsi/wall/mirror xlo 0 xhi 1 yhi 0.6 slip no velocity 0.5 0 0
fix wall wall fsi/wall/particle slip no
timestep 2e-4
neighbor 0.015 bin
thermo_modify norm no
"""


@pytest.mark.parametrize("ranks", (1, 2))
def test_shifting_beside_wall_particles_goes_on_bit_for_bit(tmp_path, ranks):
    """The density of walls, found in setup, too, is another than the running simulation had
    there."""
    make = (box("-0.4 1.4 -0.4 1", 0.05, water="0 1 0 0.6", wall="0 1 -0.2 0")
            + "displace_atoms all random 0.005 0.005 0 7 units box\n" + WALL_PARTICLES)
    whole = run(tmp_path, make + watch(every=120) + "restart 60 mid.*\nrun 120\n",
                ranks).frames()[-1]
    rest = run(tmp_path, start() + "read_restart mid.60\n"
               + WALL_PARTICLES + watch("rest.dump", 120) + "restart 60 other.*\nrun 60\n",
               ranks).frames("rest.dump")[-1]
    assert whole.step == rest.step == 120
    assert differing(whole, rest) == []


@pytest.mark.parametrize("ranks", (1, 2))
@pytest.mark.parametrize("bounds", ("s s p", "f s p"))
def test_particles_that_leave_the_box_go_on_bit_for_bit(tmp_path, bounds, ranks):
    """They move on after the lists of the step in which a file is written, and are in its box: a
    shrink-wrapped one is around them; what leaves a fixed one, as one row does here in that half
    step, is lost a step later."""
    physics = ("fsi/material water fluid rho 1000\npair_style fsi/fluid sound 20\n"
               "pair_coeff * * NULL water\nfix sph all fsi 0.01 wendland 1.5\n"
               "timestep 2e-4\nneighbor 0.003 bin\nthermo_modify lost ignore\n")
    make = (box("0 0.105 0 0.1", 0.01, boundary=bounds, water="0 0.1 0 0.1") + "velocity all set 1 "
            "0.3 0 units box\nvelocity all ramp vx -1 0.68 x 0 0.095 sum yes units box\n")
    whole = run(tmp_path, make + physics + watch(every=60) + "restart 30 mid.*\nrun 60\n",
                ranks).frames()[-1]
    rest = run(tmp_path, start(boundary=bounds) + "read_restart mid.30\n" + physics
               + watch("rest.dump", 60) + "restart 30 other.*\nrun 30\n",
               ranks).frames("rest.dump")[-1]
    assert whole.step == rest.step == 60 and (len(whole["id"]) < 100) == (
        bounds[0] == "f") and differing(whole, rest) == []


@pytest.mark.parametrize("mode", MODES)
def test_write_restart_changes_rank_count(tmp_path, mode):
    """write_restart on one rank, going on with four (and pair styles given again, which must be the
    same)."""
    scene = MODES[mode]()
    whole = run(tmp_path, scene.text() + watch(every=40)
                + "run 40\nwrite_restart mid.data\nrun 40\n",
                scene_data=scene.data()).frames()[-1]
    rest = run(tmp_path, resume(scene, "mid.data", "2 2 1") + watch("rest.dump", 80) + "run 40\n",
               4)
    close(whole, rest.frames("rest.dump")[-1])
    again = scene.setup() + "read_restart mid.data\n" + scene.physics() + watch("again.dump",
                                                                                80) + "run 40\n"
    close(whole, run(tmp_path, again).frames("again.dump")[-1])


def test_restart_of_one_processor_grid_on_another(tmp_path):
    """Restart files of many ranks (mid.%) read by one."""
    scene = dam_gate(2)
    whole = run(tmp_path, scene.text("2 2 1") + watch(every=40)
                + "run 40\nwrite_restart mid.%\nrun 40\n", 4,
                scene_data=scene.data()).frames()[-1]
    close(whole, run(tmp_path, resume(scene, "mid.%") + watch("rest.dump", 80)
                     + "run 40\n").frames("rest.dump")[-1])


@pytest.mark.parametrize("ranks", (1, 2))
@pytest.mark.parametrize("mode", MODES)
def test_two_halves_are_the_whole(tmp_path, mode, ranks):
    scene = MODES[mode]()
    frames = []
    for name, runs in (("whole", "run 80\n"), ("halves", "run 40\nrun 40\n"),
                       ("pre", "run 40\nrun 0\nrun 40 pre no\n")):
        frames.append(run(tmp_path / name, scene.text() + watch(every=80) + runs, ranks,
                          scene_data=scene.data()).frames()[-1])
    close(frames[0], frames[1])
    close(frames[0], frames[2])


@pytest.mark.parametrize("mode", MODES)
def test_run_0_changes_nothing(tmp_path, mode):
    """Neither stress nor density evolve in setup: any number of `run 0` gives the same bits."""
    scene = MODES[mode]()
    text = scene.text() + "run 20\nrun 0\n" + watch(every=1) + "run 0\n" + "".join(
        f"undump atoms\nuncompute atoms\n{watch(f'{k}.dump', 1)}run 0\n" for k in range(2))
    done = run(tmp_path, text, scene_data=scene.data())
    first, second, third = (done.frames(file)[-1] for file in ("atoms.dump", "0.dump", "1.dump"))
    assert differing(first, second) == differing(first, third) == []


def test_walls_survive(tmp_path):
    """Position of the moving wall and number of reflections; the guard is wide here, so that there
    are some."""
    scene = fluid_box(2)
    scene.walls[0] = (0, 1, 0.0, "velocity 1 0 0 guard 0.45")
    count = 'print "REFLECTED $(f_walls)"\n'
    text = scene.text() + watch(
        every=40) + f"run 40\n{count}write_restart mid.data\nrun 40\n{count}"
    whole = run(tmp_path, text, scene_data=scene.data())
    rest = run(tmp_path, resume(scene, "mid.data") + f"run 0\n{count}" + watch("rest.dump", 80)
               + f"run 40\n{count}", 2)
    counts = [[float(line.split()[1]) for line in r.output.splitlines()
               if line.startswith("REFLECTED")]
              for r in (whole, rest)]
    assert counts[0] == counts[1] and 0 < counts[0][0] < counts[0][1]
    close(whole.frames()[-1], rest.frames("rest.dump")[-1])
    # and it is the wall that makes the difference: at its old place the fluid would feel it less
    scene.walls[0] = (0, 1, 0.0, "guard 0.45")
    still = run(tmp_path / "still", scene.text() + watch(every=80) + "run 80\n",
                scene_data=scene.data()).frames()[-1]
    assert difference(whole.frames()[-1], still, "v") > 1e-3


def test_restart_with_other_walls_is_refused_or_safe(tmp_path):
    """A restart file of three walls cannot say where a fourth stands."""
    scene = fluid_box(2)
    run(tmp_path, scene.text() + "run 5\nwrite_restart mid.data\n", scene_data=scene.data())
    scene.walls = [*scene.walls, (1, -1, 0.16, "")]
    done = lammps(tmp_path, resume(scene, "mid.data") + watch("rest.dump", 1) + "run 0\n")
    assert done.status != 0 and any(
        re.search(r"has the walls xlo xhi ylo yhi, the restart file xlo xhi ylo of it", line)
        for line in done.errors)


def test_wall_that_the_second_script_puts_elsewhere_stands_there(tmp_path):
    """A dam that is opened by the restart."""
    scene = fluid_box(2)
    scene.walls[1] = (0, -1, 0.2, "")
    run(tmp_path, scene.text() + "run 5\nwrite_restart mid.data\n", scene_data=scene.data())
    scene.walls[1] = (0, -1, 0.22, "")
    done = run(tmp_path, resume(scene, "mid.data")
               + "run 200\nvariable right equal bound(all,xmax)\nprint \"RIGHT $(v_right)\"\n")
    assert re.search(r"WARNING: Fix fsi/wall/mirror walls: wall xhi was put at 0.2 when the "
                     r"restart file was written, and is at 0.22 now", done.output)
    # half a spacing from a wall at 0.2 the lattice is at rest; water is not held there any more
    assert float(re.search(r"^RIGHT (.*)$", done.output, re.M)[1]) > 0.2


def test_rerun(tmp_path):
    """Forces of a fluid whose density follows from positions are those of the run, from its dump
    alone."""
    scene = fluid_box(2, density="fluid summation solid summation",
                      fluid="sound 10 artificial/visc 0.05 0")
    scene.walls[0] = (0, 1, 0.0, "")
    text = scene.text() + "dump all all custom 10 all.dump id type mol x y vx vy\n" \
        "dump_modify all sort id format float %.17g\nrun 20\nrun 0\n" + watch(every=1) + "run 0\n"
    run_forces = run(tmp_path, text, scene_data=scene.data()).frames()[-1]
    text = scene.text() + watch("rerun.dump", 1) + "rerun all.dump dump x y vx vy\n"
    frames = run(tmp_path, text).frames("rerun.dump")
    assert [frame.step for frame in frames] == [0, 10, 20]
    # the same state in another order of sums
    assert difference(run_forces, frames[-1], "f") < 1e-13
    assert difference(run_forces, frames[-1], "rho") < 1e-13


def test_rerun_beside_walls(tmp_path):
    """Rerun sets fixes up for each frame, and pair styles once. The stress of a total-Lagrangian
    body is that of the run, to 1e-16 of 0.2 m over 0.01 m."""
    text = deck("-0.1 0.3 -0.1 0.3", 0.01, {"water": INVISCID, "wall": WALL, "plate": RUBBER},
                "fix wall wall fsi/wall/particle", "variable shear atom 50*y",
                "velocity plate set v_shear 0 0 units box",
                water="0 0.1 0 0.1", wall="0 0.2 -0.04 0", plate="0.1 0.13 0 0.1",
                made="group moves subtract all wall", group="moves")
    frames = run(tmp_path, text + watch(every=10) + "run 20\n").frames()
    again = run(tmp_path, text + watch("rerun.dump", 1)
                + "rerun atoms.dump dump x y vx vy\n").frames("rerun.dump")
    assert [frame.step for frame in again] == [0, 10, 20]
    stress = [frame["sxx"][frame["type"] == 3] for frame in (frames[2], again[2])]
    assert np.abs(stress[0]).max() > 100.0
    np.testing.assert_allclose(*stress, atol=1e-11 * np.abs(stress[0]).max())


@pytest.mark.parametrize("dim", (2, 3))
def test_write_data_read_data(tmp_path, dim):
    """All that a data file knows of a fluid: positions, velocities, masses, densities. Walls stand
    still for it."""
    scene = fluid_box(dim)
    scene.walls[0] = (0, 1, 0.0, "")
    whole = run(tmp_path, scene.text() + watch(every=40) + "run 40\nwrite_data mid.data\nrun 40\n",
                scene_data=scene.data()).frames()
    rest = run(tmp_path, scene.setup() + "read_data mid.data\nreset_timestep 40\n" + scene.physics()
               + watch("rest.dump", 40) + "run 40\n", 2).frames("rest.dump")
    assert np.array_equal(whole[1]["mol"], rest[0]["mol"]) and np.array_equal(whole[1]["type"],
                                                                              rest[0]["type"])
    for quantity in ("x", "v", "rho"):
        assert difference(whole[1], rest[0], quantity) < DIGITS, quantity
    assert np.abs(whole[1]["mass"] / rest[0]["mass"] - 1.0).max() < DIGITS
    close(whole[2], rest[1], 1e-9)  # DIGITS in the density are 1e-12 in the pressure, and grow


def test_clear(tmp_path):
    """A scene after another of a different dimension in the same process."""
    flat, solid = dam_gate(2), dam_gate(3)
    text = flat.text() + "run 20\nclear\n" + solid.text().replace(
        "scene.data", "solid.data") + watch(every=20) + "run 20\n"
    after = run(tmp_path, text, 2, scene_data=flat.data(), solid_data=solid.data()).frames()[-1]
    alone = run(tmp_path / "alone", solid.text() + watch(every=20) + "run 20\n", 2,
                scene_data=solid.data()).frames()[-1]
    assert differing(after, alone) == []


@pytest.mark.parametrize("order", ("fsi sphere", "fsi charge", "charge fsi"))
def test_atom_style_hybrid(tmp_path, order):
    """Other atom properties beside ours change nothing."""
    scene = dam_gate(2)
    particles = atoms("-0.02 0.22 -0.02 0.2", 0.01, water="0 0.14 0 0.14", plate="0.14 0.19 0 0.14")
    frames = []
    for style in ("fsi", f"hybrid {order}"):
        # atom_style sphere makes masses of its own: give them to both
        text = replace(scene, atom_style=style).setup() + particles + "set group all mass 0.1\n"
        text += scene.physics() + watch(every=40) + "run 40\n"
        frames.append(run(tmp_path / style.replace(" ", "_"), text, 2).frames()[-1])
    close(*frames)


def test_plate_that_moves_as_told(tmp_path):
    """fix move, setforce and rigid on the plate; fix fsi on the water only."""
    scene = dam_gate(2)
    base = scene.text().replace("fix sph all",
                                "group water type 1\ngroup plate type 2\nfix sph all")
    start, end = run(tmp_path, base.replace("fix sph all", "fix sph water")
                     + "fix drive plate move linear -0.1 0 0\n" + watch(every=40) + "run 40\n", 2,
                     scene_data=scene.data()).frames()
    a, b = start.of_types(2), end.of_types(2)
    # steps of a fix move are products, not sums: round-off of x only
    assert np.abs(b["x"] - a["x"] + 0.1 * 40 * scene.dt).max() < 1e-14
    assert np.abs(b["y"] - a["y"]).max() < 1e-14

    start, end = run(tmp_path, base + "velocity plate set 0 0 0\nfix hold plate setforce 0 0 0\n"
                     + watch(every=40)
                     + "run 40\n", 2).frames()
    a, b = start.of_types(2), end.of_types(2)
    assert np.array_equal(a.vector(), b.vector()) and not b.vector(("vx", "vy")).any()

    start, end = run(tmp_path, base.replace("fix sph all", "fix sph water")
                     + "fix body plate rigid single force 1 on on off "
                     "torque 1 off off on\nneigh_modify exclude group plate plate\n"
                     + watch(every=40) + "run 40\n", 2).frames()
    a, b = start.of_types(2).vector(("x", "y")), end.of_types(2).vector(("x", "y"))
    assert np.abs(b - a).max() > 1e-5
    apart = [np.linalg.norm(p[:, None] - p[None], axis=2) for p in (a, b)]
    assert np.abs(apart[0] - apart[1]).max() < 1e-13  # round-off of a size of 0.2


def test_averages_reductions_and_dumps(tmp_path):
    """compute reduce, fix ave/*, dump custom and property/atom see what a dump shows."""
    scene = dam_gate(2)
    text = scene.text() + watch(every=20) + """
compute p all fsi/atom p rho vonmises
compute own all property/atom rho mass mol
compute sum all reduce sum c_p[1] c_p[2] c_own[1] c_own[3]
compute top all reduce max c_p[3]
compute surface all fsi/surface/atom
compute free all reduce sum c_surface
fix mean all ave/atom 10 1 20 c_p[1]
fix time all ave/time 10 2 20 c_sum[2] file time.txt format " %.17g"
compute bins all chunk/atom bin/1d x lower 0.01 units box
fix profile all ave/chunk 20 1 20 bins c_p[1] v_rho file profile.txt format " %.17g"
dump extra all custom 20 extra.dump id type x y z c_p[3] c_own[1] f_mean c_surface
dump_modify extra sort id time yes format float %.17g
thermo_style custom step c_sum[*] c_top c_free
thermo_modify format float %.17g
run 40
""".replace("v_rho", "c_p[2]")
    done = run(tmp_path, text, 2, scene_data=scene.data())
    last, extra = done.frames()[-1], done.frames("extra.dump")[-1]
    rows = [line.split() for line in done.output.splitlines() if line.split()[:1] == ["40"]
            and len(line.split()) == 7]
    p, rho, own, mol, top, free = map(float, rows[0][1:])
    # sums over 266 particles in another order
    assert p == pytest.approx(last["p"].sum(), rel=1e-11)
    assert rho == own == pytest.approx(last["rho"].sum(), rel=1e-13)
    assert mol == last["mol"].sum() == (last["type"] == 2).sum()
    assert top == extra["c_p[3]"].max() > 0.0
    assert free == extra["c_surface"].sum() > 10
    assert np.array_equal(extra["f_mean"], last["p"]) and np.array_equal(extra["c_own[1]"],
                                                                         last["rho"])
    assert float((tmp_path / "time.txt").read_text().split()[-1]) == pytest.approx(rho, rel=1e-3)
    bins = [list(map(float, line.split()))
            for line in (tmp_path / "profile.txt").read_text().splitlines()
            if len(line.split()) == 5]
    bins = bins[max(k for k, row in enumerate(bins) if row[0] == 1):]  # those of the last step
    assert sum(row[2] for row in bins) == len(last)


def test_new_particles_start_without_stress(tmp_path):
    """Particles that are made after the fixes, in place of stressed ones, must not inherit from
    them."""
    scene = dam_gate(2)
    text = scene.text() + """
group plate type 2
run 100
delete_atoms group plate compress no
lattice sq 0.01 origin 0.5 0.5 0
region plate block 0.14 0.19 0 0.14 INF INF units box
create_atoms 2 region plate
""" + watch(every=100) + "run 0\n"
    # p = 0 at the density of the material, so all of sigma is the deviator
    plate = run(tmp_path, text, scene_data=scene.data()).frames()[-1].of_types(2)
    assert len(plate) == 70
    for name in ("sxx", "syy", "sxy"):
        assert not plate[name].any(), name


@pytest.mark.parametrize("first, again", [
    ("sound 10 shift 0.5 tension yes density/diffusion 0.1 background 50 surface 0.9 laminar/visc "
     "extrapolate yes couple full eos tait", "sound 10"),
    ("sound 10 artificial/visc 0.1 1", "sound 10 eos tait"),
    ("sound 10 laminar/visc/central", "sound 10 laminar/visc")])
def test_pair_style_given_again(tmp_path, first, again):
    """Only the keywords of the last command count."""
    scene = fluid_box(2, fluid=again)
    text = scene.text() + watch(every=20) + "run 20\n"
    twice = text.replace(f"pair_style fsi/fluid {again}",
                         f"pair_style fsi/fluid {first}\npair_style fsi/fluid {again}")
    assert twice != text
    frames = [run(tmp_path / name, deck, scene_data=scene.data()).frames()[-1]
              for name, deck in (("once", text), ("twice", twice))]
    assert differing(*frames) == []


WATER = atoms("-0.05 0.65 -0.05 0.5", 0.01, water="0 0.2 0 0.2") + """pair_style fsi/fluid sound 20 artificial/visc 0.05 0 surface 0.9
pair_coeff * * water.fsi water
"""
PHYSICS = """fix 1 all fsi {sph}
fix 2 all gravity 9.81 vector 0 -1 0
fix 3 all fsi/wall/mirror xlo 0 xhi 0.6 ylo 0
compute s all fsi/atom p rho
compute m all reduce min c_s[1] c_s[2]
compute x all reduce max c_s[1] c_s[2]
thermo_style custom step time dt c_m[*] c_x[*]
thermo_modify norm no format float %.17g
thermo 10
{more}
"""
MATERIALS = materials(water=INVISCID)


def rows(output):
    """thermo output: numbers by step"""
    found = [line.split() for line in output.splitlines()]
    return {int(words[0]): [float(w) for w in words[1:]] for words in found if len(words) == 7
            and re.match(r"\d+$", words[0])}


def first_part(folder, sph, more="timestep 1e-4", steps=30):
    text = start() + WATER + PHYSICS.format(
        sph=sph, more=more) + f"restart {steps} r.*\nrun {steps}\nrun {steps}\n"
    return run(folder, text, water_fsi=MATERIALS)


def second_part(folder, sph, more="", steps=30, runner=run):
    return runner(folder, start() + f"read_restart r.{steps}\n" + PHYSICS.format(sph=sph, more=more)
                  + f"run {steps}\n", water_fsi=MATERIALS)


MODES_OF_FLUID = {"": "", "summation": "fluid summation"}


@pytest.mark.parametrize("after", MODES_OF_FLUID)
@pytest.mark.parametrize("before", MODES_OF_FLUID)
def test_other_keywords(tmp_path, before, after):
    """Each mode after each other: nothing is taken for what it is not, and who changes what is told
    both sides."""
    one, two = ("0.01 wendland 1.5 " + MODES_OF_FLUID[k] for k in (before, after))
    whole = rows(first_part(tmp_path, one).output)
    done = second_part(tmp_path, two)
    rest = rows(done.output)
    if before == after:
        assert (rest[30] == whole[30] and rest[60] == whole[60]
                and "when the restart file was written" not in done.output)
        return
    warnings = [line for line in done.output.splitlines() if "WARNING: Fix fsi: " in line
                and "when the restart file was written" in line]
    values = [dict(zip(*[iter(w.split())] * 2))
              for w in (MODES_OF_FLUID[before], MODES_OF_FLUID[after])]
    changed = {key for v in values for key in v if values[0].get(key) != values[1].get(key)}
    assert len(warnings) == len(changed) and all(any(f"Fix fsi: {key} was " in w for w in warnings)
                                                 for key in changed), warnings
    # the column of water is 0.2 m high and falls freely: pressures of at most its weight and what
    # its sound makes of 3 ms of falling, densities within the 2 % of the number density at its
    # surface, where summation lacks half of the kernel
    for step, row in rest.items():
        low, density_low, high, density_high = row[2:]
        assert np.isfinite(row).all() and low >= 0.0 and high < 8000.0, (step, row)
        assert (density_low > 400.0 if "summation" in (before, after) else density_low
                > 950.0) and density_high < 1050.0, (step, row)


def test_sound_of_the_material(tmp_path):
    """The pair style names no speed of sound: its fluid has one."""
    fluid, physics = MATERIALS.replace("rho 1000", "rho 1000 sound 20"), PHYSICS.format(
        sph="0.01 wendland 1.5", more="timestep 1e-4")
    whole = run(tmp_path, start() + WATER.replace("sound 20 ", "") + physics
                + "restart 30 r.*\nrun 30\nrun 30\n", water_fsi=fluid)
    rest = run(tmp_path, start() + "read_restart r.30\n" + physics + "run 30\n", water_fsi=fluid)
    assert rows(rest.output)[60] == rows(whole.output)[60]


@pytest.mark.parametrize("sph, message", [
    ("0.02 wendland 1.5", r"ERROR: Fix fsi: particle spacing was 0\.01 when the restart file was "
     r"written, and is 0\.02 now"),
    ("0.01 cubic 1.5",
     r"WARNING: Fix fsi: kernel was wendland when the restart file was written, and is cubic now"),
    ("0.01 wendland 1.3",
     r"WARNING: Fix fsi: smoothing length over spacing was 1\.5 when .*, and is 1\.3 now"),
    ("0.01 wendland 1.3 fluid summation",
     r"ERROR: Fix fsi: density mode summation must keep kernel and smoothing length")])
def test_other_discretization(tmp_path, sph, message):
    first_part(tmp_path, "0.01 wendland 1.5")
    done = second_part(tmp_path, sph, runner=lammps)
    assert re.search(message, done.output), done.output[-2000:]
    assert (done.status != 0) == message.startswith("ERROR")


@pytest.mark.parametrize("before", ("timestep 1e-4", "fix 4 all fsi/dt 10 max 1e-4",
                                    "timestep 1e-4\nfix 4 all fsi/dt 1"))
@pytest.mark.parametrize("after", ("", "timestep 1e-4", "timestep 2e-5"))
def test_time_goes_on(tmp_path, before, after):
    """With and without fix fsi/dt and timestep command; bit for bit where the step is the same."""
    whole = rows(first_part(tmp_path, "0.01 wendland 1.5", before).output)
    adaptive = re.sub(r"timestep.*\n?", "", before)
    rest = rows(second_part(tmp_path, "0.01 wendland 1.5", f"{adaptive}\n{after}").output)
    assert rest[30][0] == pytest.approx(whole[30][0], rel=1e-14) and whole[30][0] > 1e-4
    if adaptive or after != "timestep 2e-5":
        assert [row[0] for row in rest.values()] == pytest.approx([whole[step][0] for step in rest],
                                                                  rel=1e-14)
    else:
        assert rest[60][0] == pytest.approx(whole[30][0] + 30 * 2e-5, rel=1e-14)
    if after == "":
        assert rest == {step: whole[step] for step in rest}


def test_fixes_of_other_names(tmp_path):
    """Who gives a fix another ID loses what the file has of it: an error where particles' state is
    lost, a warning elsewhere."""
    scene = dam_gate(2)
    run(tmp_path, scene.text() + "run 5\nwrite_restart mid.data\n", scene_data=scene.data())
    text = resume(scene, "mid.data") + "run 0\n"
    done = lammps(tmp_path, text.replace("fix stress", "fix other"))
    assert done.status != 0 and any("Fix other (style fsi/stress) takes nothing from the restart "
                                    "file, in which it had the ID stress" in e for e in done.errors)
    done = run(tmp_path, text.replace("fix walls", "fix others"))
    assert ("WARNING: Fix others (style fsi/wall/mirror) takes nothing from the restart file, in "
            "which it had the ID walls" in done.output)


STRESS_BOX = box("0 0.2 0 0.2", 0.01, boundary="p p p", metal="") + """pair_style fsi/solid artificial/visc 0.1 0 {first}
pair_coeff * * metal.fsi metal
fix sph all fsi 0.01 wendland 1.5
fix s all fsi/stress {stress}
timestep 1e-6
neighbor 0.003 bin
variable vx atom 1*sin(2*PI*y/0.2)
velocity all set v_vx NULL NULL
run 20
write_restart mid
"""
STRESS_AGAIN = """read_restart mid
{pair}
fix sph all fsi 0.01 wendland 1.5
fix s all fsi/stress {stress}
timestep 1e-6
compute e all fsi/energy
compute c all fsi/atom vonmises
compute m all reduce max c_c
thermo_style custom step c_m c_e[12] c_e[4]
thermo_modify format float %.17g norm no
run 0
"""
METAL = materials(metal="solid rho 1000 young 2e6 poisson 0.3 yield 1e3 hardening 1e6")


@pytest.mark.parametrize("before, after, told", [
    ("plane strain", "plastic", "plastic was no .*, and is yes now"),
    ("plastic", "plane strain", "plastic was yes .*, and is no now"),
    ("plastic", "plastic", None),
    ("", "plane stress", "ERROR: Fix fsi/stress: plane was strain .*, and is stress now")])
def test_other_stress(tmp_path, before, after, told):
    """The stress goes on; what is new begins with 0."""
    text = STRESS_BOX.format(first="", stress=before) + """compute c all fsi/atom vonmises
compute m all reduce max c_c
run 0
print "VONMISES $(c_m:%.17g)"
"""
    first = run(tmp_path, text, metal_fsi=METAL)
    mises = float(re.search(r"^VONMISES (.*)$", first.output, re.M)[1])
    done = lammps(tmp_path, STRESS_AGAIN.format(pair="", stress=after))
    assert mises > 10.0 and (told is None) == (
        "when the restart file was written" not in done.output)
    if told:
        assert re.search(told, done.output)
    if told and told.startswith("ERROR"):
        assert done.status != 0
        return
    row = next(words for words in map(str.split, done.output.splitlines()) if words[:1] == ["20"]
               and len(words) == 4)
    # what has been taken belongs to the ledger, which begins here
    assert float(row[1]) == pytest.approx(mises, rel=1e-12) and float(row[2]) == 0.0


@pytest.mark.parametrize("first, again", [("", "hourglass 0.1"), ("hourglass 0.1", "")])
def test_hourglass_control_comes_and_goes(tmp_path, first, again):
    """With a restart: the stress is the same, and forces of control begin with 0."""
    run(tmp_path, STRESS_BOX.format(first=first, stress=""), metal_fsi=METAL)
    rest = []
    for pair in ("", f"pair_style fsi/solid artificial/visc 0.1 0 {again}\n"
                 "pair_coeff * * metal.fsi metal"):
        done = run(tmp_path, STRESS_AGAIN.format(pair=pair, stress=""))
        rest.append(next(words for words in map(str.split, done.output.splitlines()) if words[:1]
                         == ["20"] and len(words) == 4))
    assert rest[0] == rest[1] and float(rest[0][3]) > 0.0


def test_bonds_do_not_change(tmp_path):
    """Bonds were made by keywords that a restart cannot change: error, not silence."""
    scene = dam_gate(2, solid_style="fsi/solid/tl", solid="gradient quadratic")
    run(tmp_path, scene.text() + "run 5\nwrite_restart mid.data\n", scene_data=scene.data())
    again = replace(scene, solid="gradient linear")
    done = lammps(tmp_path, again.setup() + "read_restart mid.data\n" + again.physics() + "run 0\n")
    assert done.status != 0 and any("gradient linear volumes corrected: the bonds of its bodies "
                                    "were made with gradient quadratic" in e for e in done.errors)


def test_file_of_another_version(tmp_path):
    """What is not of this version is not read as if it was."""
    scene = fluid_box(2)
    run(tmp_path, scene.text() + "run 5\nwrite_restart mid.data\n", scene_data=scene.data())
    whole = (tmp_path / "mid.data").read_bytes()
    for name in (b"FSI 2 fix fsi\n", b"FSI 2 pair_style fsi/fluid\n",
                 b"FSI 2 fix fsi/wall/mirror\n"):
        assert whole.count(name) == 1
        (tmp_path / "mid.data").write_bytes(whole.replace(name, name.replace(b"FSI 2", b"FSI 1")))
        done = lammps(tmp_path, resume(scene, "mid.data") + "run 0\n")
        assert done.status != 0 and any("written by another version of the FSI package" in e
                                        for e in done.errors)


RIGID = box("-0.1 0.4 -0.1 0.4", 0.01, water="0 0.1 0 0.1", body="0.2 0.25 0.2 0.25") + """pair_style fsi/fluid sound 20
pair_coeff * * water.fsi water tank
velocity body set 1 0 0 units box
"""
RIGID_FIXES = """fix sph water fsi 0.01 wendland 1.5
fix b body fsi/wall/particle
fix rig body rigid single force 1 on on off torque 1 off off on
neigh_modify exclude group body body
fix dt all fsi/dt 1 max 5e-5 growth 1.1
neighbor 0.003 bin
variable x equal xcm(body,x)
thermo_style custom step v_x
thermo_modify format float %.17g
"""


def test_fixes_that_keep_the_time_step(tmp_path):
    """fix rigid takes the restored step, not that of a timestep command before."""
    whole = run(tmp_path,
                RIGID + RIGID_FIXES + "timestep 5e-5\nrun 50\nwrite_restart mid\nrun 50\n",
                water_fsi=materials(water=INVISCID, tank=WALL))
    rest = run(tmp_path, "read_restart mid\ngroup water type 1\ngroup body type 2\ntimestep 1e-4\n"
               + RIGID_FIXES + "run 50\n")
    place = [float(next(w for w in reversed(list(map(str.split, r.output.splitlines()))) if w[:1]
                        == ["100"] and len(w) == 2)[1]) for r in (whole, rest)]
    assert place[0] == pytest.approx(0.225 + 100 * 5e-5,
                                     abs=1e-9) and place[1] == pytest.approx(place[0], rel=1e-13)


def test_ledger_goes_on(tmp_path):
    """What the terms have taken is in the file: the sum of the restarted run is that of the
    uninterrupted one."""
    more = "compute e all fsi/energy\nthermo_style custom step time c_e c_e[5] c_e[9] dt time"
    whole = rows(first_part(tmp_path, "0.01 wendland 1.5", "timestep 1e-4\n" + more).output)
    rest = rows(second_part(tmp_path, "0.01 wendland 1.5", more).output)
    assert whole[60][2] != 0.0
    for step, row in rest.items():
        assert row == pytest.approx(whole[step], rel=1e-12), step


WALLS_GONE = box("-0.03 2.43 -0.03 2.33", 0.01, water="0 0.05 0 0.05") + """region two block 0.2 0.9 0 0.8 INF INF units box
pair_style fsi/fluid sound 20
pair_coeff * * water.fsi water
fix sph all fsi 0.01 wendland 1.5
fix w all fsi/wall/mirror ylo 0
timestep 1e-5
neighbor 0.003 bin
run 1
unfix w
create_atoms 1 region two
run 1
"""
FLUID_GONE = box("-0.03 0.43 -0.03 0.33", 0.01, water="0 0.1 0 0.2", plate="0.3 0.4 0 0.1") + """pair_style hybrid fsi/fluid sound 20 shift 0.2 fsi/solid artificial/visc 0.1 0
pair_coeff * * fsi/fluid water.fsi water plate
pair_coeff * * fsi/solid water.fsi NULL plate
fix sph all fsi 0.01 wendland 1.5
fix s all fsi/stress
timestep 1e-5
neighbor 0.003 bin
run 2
delete_atoms group water
pair_style fsi/solid artificial/visc 0.1 0
pair_coeff * * water.fsi plate plate
run 2
"""


@pytest.mark.parametrize("text", (WALLS_GONE, FLUID_GONE), ids=("walls", "fluid"))
def test_effects_that_are_gone(tmp_path, text):
    """Arrays of walls and fluids are gone with them, whatever the number of atoms becomes."""
    done = run(tmp_path, text,
               water_fsi=materials(water=INVISCID, plate="solid rho 1000 young 2e6 poisson 0.4"))
    assert "Loop time" in done.output


BEFORE_A_RUN = start() + WATER + """fix 1 all fsi 0.01 wendland 1.5
fix 2 all gravity 9.81 vector 0 -1 0
timestep 1e-5
"""
OUTPUTS = {"atom": "compute c all fsi/atom p", "surface": "compute c all fsi/surface/atom",
           "energy": "compute c all fsi/energy",
           "probe": "compute c all fsi/probe p point 0.1 0.1 0", "force": "compute c all fsi/force"}


@pytest.mark.parametrize("when", ("fsi/set all hydrostatic 0.1",
                                  "run 1\ncreate_atoms 1 single 0.4 0.4 0 units box",
                                  "run 1\npair_style zero 0.1"), ids=("before", "created", "gone"))
@pytest.mark.parametrize("kind", OUTPUTS)
def test_computes_between_runs(tmp_path, kind, when):
    """After fsi/set and before a run, after atoms are created, or without pair styles of the
    package: an error that says what is needed."""
    show = {"atom": "write_dump all custom a.dump id c_c",
            "surface": "write_dump all custom a.dump id c_c", "energy": 'print "$(c_c)"',
            "probe": 'print "$(c_c)"', "force": 'print "$(c_c[1])"'}[kind]
    done = lammps(tmp_path, f"{BEFORE_A_RUN}{OUTPUTS[kind]}\n{when}\n{show}\n", water_fsi=MATERIALS)
    assert done.status != 0 and any("needs a run before it" in e
                                    for e in done.errors), done.output[-1500:]


@pytest.mark.parametrize("command", ("create_atoms 1 region none", "comm_style tiled",
                                     "change_box all boundary p f p"))
def test_ghosts_that_are_gone(tmp_path, command):
    """Commands that take ghosts away, if they change no particle: lists still name them."""
    text = deck("0 0.2 -0.1 0.2", 0.01, {"water": INVISCID}, "compute c all fsi/atom shear/rate",
                "region none block 8 9 8 9 INF INF units box", water="0 0.2 0 0.1",
                boundary="p f p")
    done = lammps(tmp_path, f"{text}run 1\n{command}\nwrite_dump all custom a.dump id c_c\n")
    assert "Compute fsi/atom needs a run before it" in done.output
    run(tmp_path, f"{text}run 1\n{command}\nrun 0\nwrite_dump all custom a.dump id c_c\n")


def test_fixes_before_a_run(tmp_path):
    """Outputs of fixes that know nothing yet are 0, not a crash."""
    text = BEFORE_A_RUN + (
        "fix 5 all fsi/dt 10\nfix 6 all fsi/report\nfix 7 all fsi/watch 10\n"
        "fix 8 all fsi/wall/mirror xlo 0\nfix 9 all fsi/wall/particle\n"
        'print "VALUES $(f_5) $(f_5[7]) $(f_6[1]) $(f_6[3]) $(f_7) $(f_8) $(f_8[1][1]) '
        '$(f_9) $(f_9[1])"\n')
    done = run(tmp_path, text, water_fsi=MATERIALS)
    values = list(map(float, re.search(r"^VALUES (.*)$", done.output, re.M)[1].split()))
    assert values[0] == 1e-5 and not any(values[1:])
