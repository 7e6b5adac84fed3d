"""Runs that stop and go on, and LAMMPS' own commands on our atoms."""

from dataclasses import replace

import numpy as np
import pytest

from conftest import dam_gate, difference, differing, fluid_box, lammps, run, watch

# Going on with other neighbour lists or another rank count changes the order of sums only: see TRAJECTORY in test_parallel.py;
# 40 steps instead of 100.
ROUND_OFF = 1e-11
# Relative error of a number that LAMMPS writes with 16 digits and reads again.
DIGITS = 1e-14

MODES = {
    "dam 2D": lambda: dam_gate(2),
    "dam 3D": lambda: dam_gate(3),
    "ratio": lambda: dam_gate(2, density="fluid ratio solid ratio",
                              fluid="sound 10 artificial/visc 0.05 0 surface 0.9 bulk"),
    "summation": lambda: dam_gate(2, density="fluid summation solid ratio", fluid="sound 10 artificial/visc 0.05 0"),
    "fluid": lambda: fluid_box(2),
    "shift": lambda: dam_gate(2, fluid="sound 10 artificial/visc 0.05 0 density/diffusion 0.1 shift 0.5"),
    "surface": lambda: dam_gate(2, fluid="sound 10 artificial/visc 0.05 0 surface 0.9 max", sph="surface/every 7"),
    "tl 2D": lambda: dam_gate(2, solid_style="fsi/solid/tl", solid="artificial/visc 0.1 0.1 hourglass 0.1"),
    "tl 3D": lambda: dam_gate(3, solid_style="fsi/solid/tl", solid="law neohookean", sph="substeps 4"),
}


def close(a, b, tolerance=ROUND_OFF):
    for quantity in ("x", "v", "rho", "stress"):
        # the stress of a total-Lagrangian solid comes from its positions: 1e-16 of 0.2 m over 0.01 m of 2 MPa, and grows
        assert difference(a, b, quantity) < tolerance * (10 if quantity == "stress" else 1), quantity


def resume(scene, file, grid="* * *"):
    """Input that continues from a restart file; the pair styles come out of it."""
    return scene.setup(grid) + f"read_restart {file}\n" + scene.physics(coeff=False)


@pytest.mark.parametrize("ranks", (1, 2))
@pytest.mark.parametrize("mode", MODES)
def test_restart_n_goes_on_bit_for_bit(tmp_path, mode, ranks):
    """`restart N` makes the running simulation rebuild its lists at N, and so may continue exactly."""
    scene = MODES[mode]()
    whole = run(tmp_path, scene.text() + watch(every=80) + "restart 40 mid.*\nrun 80\n", ranks,
                scene_data=scene.data()).frames()[-1]
    rest = run(tmp_path, resume(scene, "mid.40") + watch("rest.dump", 80) + "restart 40 other.*\nrun 40\n",
               ranks).frames("rest.dump")[-1]
    assert whole.step == rest.step == 80
    assert differing(whole, rest) == []


@pytest.mark.parametrize("mode", MODES)
def test_write_restart_changes_rank_count(tmp_path, mode):
    """write_restart on one rank, going on with four (and pair styles given again, which must be the same)."""
    scene = MODES[mode]()
    whole = run(tmp_path, scene.text() + watch(every=40) + "run 40\nwrite_restart mid.data\nrun 40\n",
                scene_data=scene.data()).frames()[-1]
    rest = run(tmp_path, resume(scene, "mid.data", "2 2 1") + watch("rest.dump", 80) + "run 40\n", 4)
    close(whole, rest.frames("rest.dump")[-1])
    again = scene.setup() + "read_restart mid.data\n" + scene.physics() + watch("again.dump", 80) + "run 40\n"
    close(whole, run(tmp_path, again).frames("again.dump")[-1])


def test_restart_of_one_processor_grid_on_another(tmp_path):
    """Restart files of many ranks (mid.%) read by one."""
    scene = dam_gate(2)
    whole = run(tmp_path, scene.text("2 2 1") + watch(every=40) + "run 40\nwrite_restart mid.%\nrun 40\n", 4,
                scene_data=scene.data()).frames()[-1]
    close(whole, run(tmp_path, resume(scene, "mid.%") + watch("rest.dump", 80) + "run 40\n").frames("rest.dump")[-1])


@pytest.mark.parametrize("ranks", (1, 2))
@pytest.mark.parametrize("mode", MODES)
def test_two_halves_are_the_whole(tmp_path, mode, ranks):
    scene = MODES[mode]()
    frames = []
    for name, runs in (("whole", "run 80\n"), ("halves", "run 40\nrun 40\n"), ("pre", "run 40\nrun 0\nrun 40 pre no\n")):
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
    """Position of the moving wall and number of reflections; the guard is wide here, so that there are some."""
    scene = fluid_box(2)
    scene.walls[0] = (0, 1, 0.0, "velocity 1 0 0 guard 0.45")
    count = 'print "REFLECTED $(f_walls)"\n'
    text = scene.text() + watch(every=40) + f"run 40\n{count}write_restart mid.data\nrun 40\n{count}"
    whole = run(tmp_path, text, scene_data=scene.data())
    rest = run(tmp_path, resume(scene, "mid.data") + f"run 0\n{count}" + watch("rest.dump", 80) + f"run 40\n{count}", 2)
    counts = [[float(line.split()[1]) for line in r.output.splitlines() if line.startswith("REFLECTED")]
              for r in (whole, rest)]
    assert counts[0] == counts[1] and 0 < counts[0][0] < counts[0][1]
    close(whole.frames()[-1], rest.frames("rest.dump")[-1])
    # and it is the wall that makes the difference: at its old place the fluid would feel it less
    scene.walls[0] = (0, 1, 0.0, "guard 0.45")
    still = run(tmp_path / "still", scene.text() + watch(every=80) + "run 80\n", scene_data=scene.data()).frames()[-1]
    assert difference(whole.frames()[-1], still, "v") > 1e-3


def test_restart_with_other_walls_is_refused_or_safe(tmp_path):
    """A restart file of three walls cannot say where a fourth stands."""
    scene = fluid_box(2)
    run(tmp_path, scene.text() + "run 5\nwrite_restart mid.data\n", scene_data=scene.data())
    scene.walls = [*scene.walls, (1, -1, 0.16, "")]
    done = lammps(tmp_path, resume(scene, "mid.data") + watch("rest.dump", 1) + "run 0\n")
    assert done.status != 0 and any("walls" in line for line in done.errors)


def test_rerun(tmp_path):
    """Forces of a fluid whose density follows from positions are those of the run, from its dump alone."""
    scene = fluid_box(2, density="fluid summation solid summation", fluid="sound 10 artificial/visc 0.05 0")
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


@pytest.mark.parametrize("dim", (2, 3))
def test_write_data_read_data(tmp_path, dim):
    """All that a data file knows of a fluid: positions, velocities, masses, densities. Walls stand still for it."""
    scene = fluid_box(dim)
    scene.walls[0] = (0, 1, 0.0, "")
    whole = run(tmp_path, scene.text() + watch(every=40) + "run 40\nwrite_data mid.data\nrun 40\n",
                scene_data=scene.data()).frames()
    rest = run(tmp_path, scene.setup() + "read_data mid.data\nreset_timestep 40\n" + scene.physics()
               + watch("rest.dump", 40) + "run 40\n", 2).frames("rest.dump")
    assert np.array_equal(whole[1]["mol"], rest[0]["mol"]) and np.array_equal(whole[1]["type"], rest[0]["type"])
    for quantity in ("x", "v", "rho"):
        assert difference(whole[1], rest[0], quantity) < DIGITS, quantity
    assert np.abs(whole[1]["mass"] / rest[0]["mass"] - 1.0).max() < DIGITS
    close(whole[2], rest[1], 1e-9)  # DIGITS in the density are 1e-12 in the pressure, and grow


def test_clear(tmp_path):
    """A scene after another of a different dimension in the same process."""
    flat, solid = dam_gate(2), dam_gate(3)
    text = flat.text() + "run 20\nclear\n" + solid.text().replace("scene.data", "solid.data") + watch(every=20) + "run 20\n"
    after = run(tmp_path, text, 2, scene_data=flat.data(), solid_data=solid.data()).frames()[-1]
    alone = run(tmp_path / "alone", solid.text() + watch(every=20) + "run 20\n", 2, scene_data=solid.data()).frames()[-1]
    assert differing(after, alone) == []


@pytest.mark.parametrize("order", ("fsi sphere", "fsi charge", "charge fsi"))
def test_atom_style_hybrid(tmp_path, order):
    """Other atom properties beside ours change nothing."""
    scene = dam_gate(2)
    create = ("create_box 2 box\nlattice sq 0.01 origin 0.5 0.5 0\nregion water block 0 0.14 0 0.14 INF INF units box\n"
              "region plate block 0.14 0.19 0 0.14 INF INF units box\ncreate_atoms 1 region water\n"
              "create_atoms 2 region plate\nset type 2 mol 1\n")
    box = "region box block -0.02 0.22 -0.02 0.2 -0.005 0.005 units box\n"
    frames = []
    for style in ("fsi", f"hybrid {order}"):
        # atom_style sphere makes masses of its own: give them to both
        text = replace(scene, atom_style=style).setup() + box + create + "set group all mass 0.1\n"
        text += scene.physics() + watch(every=40) + "run 40\n"
        frames.append(run(tmp_path / style.replace(" ", "_"), text, 2).frames()[-1])
    close(*frames)


def test_plate_that_moves_as_told(tmp_path):
    """fix move, setforce and rigid on the plate; fix fsi on the water only."""
    scene = dam_gate(2)
    base = scene.text().replace("fix sph all", "group water type 1\ngroup plate type 2\nfix sph all")
    start, end = run(tmp_path, base.replace("fix sph all", "fix sph water")
                     + "fix drive plate move linear -0.1 0 0\n" + watch(every=40) + "run 40\n", 2,
                     scene_data=scene.data()).frames()
    a, b = start.of_types(2), end.of_types(2)
    # steps of a fix move are products, not sums: round-off of x only
    assert np.abs(b["x"] - a["x"] + 0.1 * 40 * scene.dt).max() < 1e-14
    assert np.abs(b["y"] - a["y"]).max() < 1e-14

    start, end = run(tmp_path, base + "velocity plate set 0 0 0\nfix hold plate setforce 0 0 0\n" + watch(every=40)
                     + "run 40\n", 2).frames()
    a, b = start.of_types(2), end.of_types(2)
    assert np.array_equal(a.vector(), b.vector()) and not b.vector(("vx", "vy")).any()

    start, end = run(tmp_path, base.replace("fix sph all", "fix sph water") + "fix body plate rigid single force 1 on on off "
                     "torque 1 off off on\nneigh_modify exclude group plate plate\n" + watch(every=40) + "run 40\n", 2).frames()
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
    rows = [line.split() for line in done.output.splitlines() if line.split()[:1] == ["40"] and len(line.split()) == 7]
    p, rho, own, mol, top, free = map(float, rows[0][1:])
    # sums over 266 particles in another order
    assert p == pytest.approx(last["p"].sum(), rel=1e-11)
    assert rho == own == pytest.approx(last["rho"].sum(), rel=1e-13)
    assert mol == last["mol"].sum() == (last["type"] == 2).sum()
    assert top == extra["c_p[3]"].max() > 0.0
    assert free == extra["c_surface"].sum() > 10
    assert np.array_equal(extra["f_mean"], last["p"]) and np.array_equal(extra["c_own[1]"], last["rho"])
    assert float((tmp_path / "time.txt").read_text().split()[-1]) == pytest.approx(rho, rel=1e-3)
    bins = [list(map(float, line.split())) for line in (tmp_path / "profile.txt").read_text().splitlines()
            if len(line.split()) == 5]
    bins = bins[max(k for k, row in enumerate(bins) if row[0] == 1):]  # those of the last step
    assert sum(row[2] for row in bins) == len(last)


def test_new_particles_start_without_stress(tmp_path):
    """Particles that are made after the fixes, in place of stressed ones, must not inherit from them."""
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
    ("sound 10 shift 0.5 tension yes density/diffusion 0.1 background 50 surface 0.9 max laminar/visc extrapolate yes couple full eos tait", "sound 10"),
    ("sound 10 artificial/visc 0.1 1", "sound 10 eos tait"), ("sound 10 laminar/visc/central", "sound 10 laminar/visc")])
def test_pair_style_given_again(tmp_path, first, again):
    """Only the keywords of the last command count."""
    scene = fluid_box(2, fluid=again)
    text = scene.text() + watch(every=20) + "run 20\n"
    twice = text.replace(f"pair_style fsi/fluid {again}", f"pair_style fsi/fluid {first}\npair_style fsi/fluid {again}")
    assert twice != text
    frames = [run(tmp_path / name, deck, scene_data=scene.data()).frames()[-1] for name, deck in (("once", text), ("twice", twice))]
    assert differing(*frames) == []
