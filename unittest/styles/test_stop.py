"""What fix fsi checks by itself in every run: it stops before NaN is anywhere, names particle and
cause, and leaves a state to go on from."""

import re

import numpy as np
import pytest

from decks import LIMITED, deck, total_lagrangian
from scenes import (DX, RUBBER, WATER, Scene, dam_gate, difference, fluid_box, lammps, lattice, run,
                    watch)

from fsi import dump

CAUSES = r"Mach number|density \S+ is not above 0|not finite"


@pytest.fixture(autouse=True)
def _files_go_elsewhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def error(done):
    assert done.status != 0, "no error"
    lines = [line for line in done.errors if "Fix fsi: " in line]
    assert len(lines) == 1, done.output[-2000:]
    return lines[0]


def test_places_far_from_the_origin():
    """Ten million spacings away the place is that of one particle, and short."""
    x = lattice([4, 4], 0.001) + [1e4, 2.0, 0.0]
    with Scene(x, dx=0.001, dt=1e-7) as s:
        s.run(1)
        s.run_lines("group one id 6", "velocity one set 1e3 0 0 units box")
        with pytest.raises(Exception, match=r"atom 6 \(type 1\) at 10000\.0015 2\.00"):
            s.run(1)


def resume(scene, name="fluid"):
    text = scene.physics(coeff=False)
    return scene.setup() + "read_restart fsi_stop.restart\n" + (text if name in ("fluid", "gate")
                                                                else total_lagrangian(text))


def test_partitions_have_files_of_their_own(tmp_path):
    """Of two partitions in one folder the second stops: the names have its number, as those of log
    files."""
    make, limit = LIMITED["fluid"]
    scene, text = make()
    text = re.sub("timestep .*",
                  f"variable dt world {0.1 * limit!r} {8 * limit!r}\ntimestep ${{dt}}", text)
    done = lammps(tmp_path, text + "run 1000\n", 2, arguments=("-partition", "1", "1"),
                  scene_data=scene.data())
    assert done.status != 0
    assert sorted(p.name for p in tmp_path.glob("fsi_stop*")) == ["fsi_stop.dump.1",
                                                                  "fsi_stop.restart.1"]


@pytest.mark.parametrize("ranks", (1, 2))
@pytest.mark.parametrize("name", LIMITED)
def test_too_long_steps(tmp_path, name, ranks):
    """Eight times the limit: stopped with a cause, nothing that is not finite in any picture, and a
    state to look at."""
    make, limit = LIMITED[name]
    scene, text = make()
    text = re.sub("timestep .*", f"timestep {8 * limit!r}", text)
    done = lammps(tmp_path, text + watch(every=1) + "run 1000\n", ranks, scene_data=scene.data())
    message = error(done)
    print(f"{name}: {message[7:200]}")
    assert re.search(CAUSES, message) and re.search(r"on step \d+, atom \d+ \(type \d\) at ",
                                                    message)
    # c/(c + v) of 8 times 0.25
    usual = 0.5 if "(type 1)" in message else 0.25
    assert re.search(rf"Try a shorter time step \(the Courant number is (1\.9|2), {usual} is "
                     r"usual\): fix fsi/dt", message)
    for frame in done.frames():
        assert np.isfinite(frame.vector(("x", "y", "vx", "vy", "rho"))).all(), f"step {frame.step}"
    first, = run(tmp_path, resume(scene, name) + watch("again.dump", 1) + "run 0\n",
                 ranks).frames("again.dump")
    assert first.step == int(re.search(r"State of step (\d+): fsi_stop.restart", message)[1])
    # some have left the box
    assert np.isfinite(first.vector(("x", "y", "vx", "vy", "rho"))).all() and len(
        first) > 0.9 * len(scene.x)


# ---- one thing at a time -------------------------------------------------------------------------

@pytest.mark.parametrize("ranks", (1, 2))
def test_fast_particle(tmp_path, ranks):
    """At the start; and in the course of the run, where the kick that would make it fast is not
    given."""
    scene = fluid_box(2)
    scene.v[57] = [0.0, 12.0, 0.0]
    message = error(lammps(tmp_path / "start", scene.text() + "run 5\n", ranks,
                           scene_data=scene.data()))
    assert re.search(r"Fix fsi: Mach number 1\.2 is above the limit 1 on step 0, atom 58 \(type "
                     r"1\) at .*units box.*a higher speed of sound", message)
    assert "State of step 0: fsi_stop.restart" in message and "around it: fsi_stop.dump" in message

    scene = fluid_box(2)
    push = "group one id 58\nrun 33\nfix push one addforce 0.0 1e6 0.0\n"
    done = lammps(tmp_path / "push", scene.text() + watch(every=1) + push + "run 5\n", ranks,
                  scene_data=scene.data())
    message = error(done)
    assert re.search(r"Mach number \S+ is above the limit 1 on step 34, atom 58 ",
                     message) and "State of step 33: fsi_stop.restart" in message
    # the state is that of step 33, and the run can go on from it
    rest = run(tmp_path / "push", resume(scene) + watch("rest.dump", 1) + "run 30\n", ranks)
    state, restarted = done.frames()[-1], rest.frames("rest.dump")[0]
    assert state.step == restarted.step == 33
    for quantity in ("x", "v", "rho"):
        assert difference(state, restarted, quantity) < 1e-14, quantity


@pytest.mark.parametrize("ranks", (1, 2))
@pytest.mark.parametrize("name", ("fluid", "body"))
def test_what_leaves_the_box_is_named(tmp_path, name, ranks):
    """LAMMPS only counts lost atoms. The state is that of the step before, with it in the box, and
    goes on without it where that is allowed."""
    scene = fluid_box(2) if name == "fluid" else dam_gate(2)
    who = len(scene.x)  # a corner of the water; of the plate
    scene.v[scene.type == scene.type[-1] if name == "body" else who - 1] = [0.0, 3.0, 0.0]
    face = scene.box[1, 1]
    done = lammps(tmp_path, scene.text() + watch(every=1) + "run 2000\n", ranks,
                  scene_data=scene.data())
    found = re.search(r"Fix fsi: particle leaves the box through its fixed face yhi at (\S+) on "
                      r"step (\d+), atom (\d+) \(type (\d)\) at \S+ (\S+) \S+\. Try walls",
                      error(done))
    assert found and float(found[1]) == pytest.approx(face, rel=1e-5) and float(
        found[5]) >= face * (1 - 1e-5)
    assert int(found[4]) == scene.type[-1] and (name == "body" or int(found[3]) == who)
    step = int(found[2]) - 1
    assert f"State of step {step}: fsi_stop.restart" in "".join(done.errors)
    again = resume(scene, "gate" if name == "body" else "fluid").replace("lost error",
                                                                         "lost ignore")
    rest = run(tmp_path, again + watch("rest.dump", 1) + "run 60\n", ranks).frames("rest.dump")
    state, restarted = done.frames()[-1], rest[0]
    assert state.step == restarted.step == step and len(restarted) == len(scene.x)
    for quantity in ("x", "v", "rho"):
        assert difference(state, restarted, quantity) < 1e-14, quantity
    assert len(rest[-1]) < len(scene.x)


@pytest.mark.parametrize("what", ("surfaces", "alone"))
def test_what_else_the_step_did_to_densities_goes_back(tmp_path, what):
    """The step in which it stops takes room from surfaces that meet (density/surface looks once in
    5 h/c, here in step 38), or holds a torn particle at the density that it has alone: the state
    has neither, and the run that goes on from it is the one that was never stopped."""
    surfaces = "density/surface yes" if what == "surfaces" else ""
    scene = fluid_box(2, fluid=f"sound 10 artificial/visc 0.05 0 density/diffusion 0.1 {surfaces}")
    above = scene.x[:, 1] > 7 * DX
    scene.x[above, 1] += 0.8 * DX
    scene.v[above, 1] = -1.0
    if what == "alone":
        scene.rho[279], scene.v[279] = 1.0, [0.0, 0.5, 0.0]    # goes away from the rest
    whole = run(tmp_path / "whole", scene.text() + watch(every=1) + "run 37\nrun 10\n",
                scene_data=scene.data()).frames()
    done = lammps(tmp_path, scene.text() + watch(every=1)
                  + "group one id 58\nrun 37\nfix push one addforce 0.0 1e6 0.0\nrun 5\n",
                  scene_data=scene.data())
    assert "State of step 37: fsi_stop.restart" in error(done)
    rest = run(tmp_path, resume(scene) + watch("rest.dump", 1) + "run 10\n").frames("rest.dump")
    change = whole[38]["rho"] - whole[37]["rho"]
    assert (np.abs(change).max() > 10.0 if what == "surfaces" else change[279] == 0.0
            and whole[38]["rho"][279] < 250.0)
    for frame in (0, 10):
        assert whole[37 + frame].step == rest[frame].step == 37 + frame
        for quantity in ("x", "v", "rho"):
            assert difference(whole[37 + frame], rest[frame], quantity) < 1e-13, quantity


@pytest.mark.parametrize("ranks", (1, 2))
def test_a_reflection_goes_back(tmp_path, ranks):
    """Of the step in which it stops, at the wall that moves and at the one that stands, whatever
    rank has the particle."""
    scene = fluid_box(2, fluid="sound 10 artificial/visc 0.05 0")
    top = np.flatnonzero(scene.x[:, 1] > 13 * DX)
    for i, speed in ((top[0], -3.0), (top[-1], 3.0)):
        scene.x[i, 1] += DX
        scene.v[i] = [speed, 0.0, 0.0]
    whole = run(tmp_path / "whole", scene.text() + watch(every=1) + "run 30\n", ranks,
                scene_data=scene.data()).frames()
    for i in (top[0], top[-1]):
        v = np.array([frame["vx"][i] for frame in whole])
        step = np.flatnonzero(v[1:] * v[:-1] < 0)[0]    # the state before it is turned back
        done = lammps(tmp_path, scene.text() + watch(every=1)
                      + f"run {step}\ngroup one id 58\nfix push one addforce 0.0 1e6 0.0\nrun 5\n",
                      ranks,
                      scene_data=scene.data())
        assert f"State of step {step}: fsi_stop.restart" in error(done)
        rest = run(tmp_path, resume(scene) + watch("rest.dump", 1) + "run 5\n",
                   ranks).frames("rest.dump")
        for frame in (0, 5):
            for quantity in ("x", "v", "rho"):
                assert difference(whole[step + frame], rest[frame], quantity) < 1e-13, quantity


def test_a_float_goes_back(tmp_path):
    """With the velocity that its acceleration is from, and the sums of energies."""
    body = "fix w float fsi/wall/particle\nfix r float rigid single force * off on off\n"
    text = deck("-0.05 0.25 -0.05 0.25", DX, {"water": WATER, "buoy": "wall rho 500"}, body,
                "fix g all gravity 9.81 vector 0 -1 0", "fix m water fsi/wall/mirror xlo 0 xhi 0.2 "
                "ylo 0", "fsi/set water hydrostatic 0.1", "compute e all fsi/energy",
                "variable v equal vcm(float,y)", dt=2e-4, group="water",
                fluid="sound 15 artificial/visc 0.05 0", water="0 0.2 0 0.1",
                float="0.08 0.12 0.1 0.14")
    told = lambda name: ("fix p all print 1 '$(step) $(v_v:%.17g) $(c_e[5]:%.17g) "
                         f"$(c_e[9]:%.17g)' file {name} screen no\n")
    run(tmp_path / "whole", text + told("whole") + "run 20\nrun 5\n")
    push = "group one id 1\nfix push one addforce 0 1e9 0\n"
    done = lammps(tmp_path, text + f"run 20\n{push}run 5\n")
    assert "State of step 20: fsi_stop.restart" in error(done)
    rest = ("units si\nread_restart fsi_stop.restart\n" + text[text.index("fix sph"):]).replace(
        "fsi/set", "# ")
    run(tmp_path, rest + told("rest") + "run 5\n")
    rows = [np.loadtxt(tmp_path / file) for file in ("whole/whole", "rest")]
    assert np.ptp(rows[0][20:, 1]) > 1e-4
    np.testing.assert_allclose(rows[1], rows[0][-len(rows[1]):], rtol=1e-9)


def test_the_limit_is_a_keyword(tmp_path):
    scene = fluid_box(2, sph="mach 2")
    scene.v[279] = [0.0, 15.0, 0.0]  # one of the surface
    run(tmp_path, scene.text() + "run 1\n", scene_data=scene.data())
    scene.v[279] = [0.0, 25.0, 0.0]
    assert "Mach number 2.5 is above the limit 2" in error(
        lammps(tmp_path, scene.text() + "run 1\n", scene_data=scene.data()))
    run(tmp_path, scene.text().replace("mach 2", "mach off") + "run 1\n", scene_data=scene.data())


def test_a_body_may_be_faster_than_its_waves():
    """As a whole it is in no danger: soft rubber that falls or is thrown. Ten times faster is an
    explosion."""
    c = np.sqrt((1e5 / 1.2 + 4 / 3 * 1e5 / 2.6) / 1000)
    for style in ("fsi/solid", "fsi/solid/tl"):
        with Scene(lattice([6, 6], 0.1), [4 * c, 0.0, 0.0] * np.ones((36, 1)), dx=0.1,
                   materials=(RUBBER,), solid_style=style, dt=1e-4) as s:
            s.run(5)
            s.put("v", [11 * c, 0.0, 0.0] * np.ones((36, 1)))
            with pytest.raises(Exception, match=r"Mach number 11 is above the limit 10 on step 5, "
                               r"atom \d+ \(type 1\)"):
                s.run(5)


@pytest.mark.parametrize("quantity, row, word", [("x", 0, "position"), ("v", 1, "velocity"),
                                                 ("rho", None, "density"), ("rmass", None, "mass")])
def test_nan_between_runs(quantity, row, word):
    """LAMMPS' own answer to a position that is no number does not say whose."""
    with Scene(lattice([6, 6], 0.1), dx=0.1, dt=1e-4) as s:
        s.run(10)
        values = s.get(quantity)
        values[17 if row is None else (17, row)] = np.nan
        s.put(quantity, values)
        with pytest.raises(Exception, match=rf"Fix fsi: {word} is not finite \(-?nan\) on step 10, "
                           r"atom 18 \(type 1\)"):
            s.run(10)


@pytest.mark.parametrize("ranks", (1, 2))
def test_fluid_inside_a_body(tmp_path, ranks):
    """Named before a higher speed of sound, which would not help; not where it is outside"""
    for inside in (True, False):
        scene = dam_gate(2)
        plate = np.flatnonzero(scene.type == 2)
        scene.v[0] = [0.0, 15.0, 0.0]
        if inside:
            middle = scene.x[plate].mean(0)
            nearest = plate[np.linalg.norm(scene.x[plate] - middle, axis=1).argmin()]
            scene.x[0] = scene.x[nearest] + [0.003, 0.002, 0.0]
        message = error(lammps(tmp_path / f"{inside}", total_lagrangian(scene.text()) + "run 5\n",
                               ranks, scene_data=scene.data()))
        found = re.search(rf"step 0, atom {scene.ids[0]} .*, (\S+) from atom (\d+) of body \d+, "
                          rf"whose spacing is {DX}: fluid inside a solid\. Try .*; a higher",
                          message)
        assert bool(found) == inside and ("fluid inside" in message) == inside
        if inside:
            away = np.linalg.norm(scene.x[plate] - scene.x[0], axis=1)
            assert scene.ids[plate[away.argmin()]] == int(found[2]) and abs(
                away.min() - float(found[1])) < 0.05 * away.min()


def test_nan_force_in_the_run(tmp_path):
    """Forces of another style: caught before they get into velocities. The particle next to it is
    not blamed."""
    with Scene(lattice([6, 6], 0.1), dx=0.1, dt=1e-4,
               commands=["fix ext all external pf/callback 1 1"]) as s:
        def push(_, step, nlocal, tag, x, f):
            f[:nlocal] = np.where((tag[:nlocal, None] == 22) & (step == 13), np.nan, 0.0)

        s.lmp.set_fix_external_callback("ext", push)
        with pytest.raises(Exception, match=r"Fix fsi: force is not finite \(-?nan\) on step 13, "
                           r"atom 22 \(type 1\)"):
            s.run(20)
        assert all(np.isfinite(s.get(q)).all() for q in ("x", "v", "rho"))
    near = dump.read(tmp_path / "fsi_stop.dump")[0]
    assert near.step == 12 and np.isfinite(near.vector(("x", "y", "vx", "vy", "rho"))).all()


CHANGES = [("v", 11.0, "Mach number", 20), ("v", np.nan, "(velocity|force) is not finite", 20),
           ("rho", 0.0, "density \\S+ is not above 0|Mach|not finite", 20),
           ("rho", np.nan, "(density|force) is not finite", 20), ("rho", 1e21, "not finite", 20),
           ("x", np.nan, "(position|force) is not finite", 20),
           ("f", 1e12, "Mach number", 13), ("f", np.inf, "force is not finite", 13),
           ("f", 1e280, "not finite", 13)]


@pytest.mark.parametrize("quantity, value, message, step", CHANGES)
@pytest.mark.parametrize("who", (1, 256, 399))
def test_one_of_many(quantity, value, message, step, who):
    """One particle among calm ones: blocks of particles in which all is small are skipped. Forces
    are looked at in each step, what somebody has set in velocities and densities at every tenth;
    what it does to others may be seen before."""
    with Scene(lattice([20, 20], 0.1), dx=0.1, dt=1e-4, fluid="tension yes",
               commands=["fix ext all external pf/callback 1 1"]) as s:
        def change(_, now, nlocal, tag, x, f):
            f[:nlocal] = 0.0
            if now == 13:
                i = np.flatnonzero(tag[:nlocal] == who)[0]
                if quantity == "f":
                    f[i] = value
                else:
                    s.lmp.numpy.extract_atom(quantity)[i] = value

        s.lmp.set_fix_external_callback("ext", change)
        with pytest.raises(Exception, match=r"Fix fsi: .* on step (\d+), atom (\d+) ") as stopped:
            s.run(20)
    text = str(stopped.value)
    found = re.search(r"on step (\d+), atom (\d+) ", text)
    assert 13 <= int(found[1]) <= step and re.search(message, text), text
    assert quantity != "f" or int(found[2]) == who, text


def test_torn_water_may_weigh_nothing(tmp_path):
    """Without tension it has no pressure, whatever density an impact has left it with; with tension
    it pulls, and is stopped."""
    x = np.vstack([lattice([6, 6], 0.1), [[2.0, 2.0, 0.0]]])
    rho = np.r_[np.full(36, 1000.0), -20.0]
    for tension in ("no", "yes"):
        with Scene(x, dx=0.1, dt=1e-4, fluid=f"tension {tension}") as s:
            s.run()
            s.put("rho", rho)
            if tension == "no":
                s.run(30)
                continue
            with pytest.raises(Exception, match=r"Fix fsi: density -20 is not above 0 on step 0, "
                               r"atom 37 \(type 1\)"):
                s.run(30)


def test_inside_the_substeps_of_a_solid(tmp_path):
    """The sub-steps have run when it is seen: the state is that before them, to the last bit of
    positions and velocities."""
    scene = dam_gate(2)
    text = re.sub("timestep .*", "timestep 2e-3", LIMITED["gate, sub-steps"][0]()[1])
    done = lammps(tmp_path, text + watch(every=1) + "run 200\n", scene_data=scene.data())
    message = error(done)
    assert re.search(r"(Mach number|not finite|density \S+ is not above 0).*\(type 2\)", message)
    for frame in done.frames():
        assert np.isfinite(frame.vector(("x", "y", "vx", "vy"))).all()
    rest = run(tmp_path, resume(scene, "tl") + watch("rest.dump", 1) + "run 0\n")
    state, restarted = done.frames()[-1], rest.frames("rest.dump")[0]
    assert state.step == restarted.step
    assert difference(state, restarted, "v") == 0.0 and difference(state, restarted, "x") < 1e-14


def test_advice_names_nothing_that_is_on(tmp_path):
    """The time step is chosen, viscosity and diffusion are there: what is left is the speed of
    sound, and to choose a shorter step."""
    scene = fluid_box(2)
    scene.v[57] = [0.0, 12.0, 0.0]
    plain = error(lammps(tmp_path, scene.text().replace("artificial/visc 0.05 0.1", "") + "run 5\n",
                         scene_data=scene.data()))
    assert all(word in plain for word in ("a higher speed of sound", "artificial/visc 0.02 0",
                                          "fix fsi/dt"))
    full = error(lammps(tmp_path, scene.text() + "fix dt all fsi/dt 10\nrun 5\n",
                        scene_data=scene.data()))
    assert ("a higher speed of sound" in full and "cfl/fluid of fix fsi/dt" in full
            and "artificial/visc" not in full)


def test_a_body_that_folds_is_told_of_another_law(tmp_path):
    """St. Venant-Kirchhoff softens when it is compressed; a blow of twice its speed of sound folds
    the plate, but not one of the other law."""
    def strike(law):
        scene = dam_gate(2, solid_style="fsi/solid/tl", solid=f"law {law} artificial/visc 0.5 0",
                         sph="mach off")
        plate = scene.x[:, 0] > 14 * DX
        scene.v[plate, 1] = -20.0 * np.sign(scene.x[plate, 1] - 7 * DX)
        return lammps(tmp_path / law, re.sub("timestep .*", "timestep 1e-5", scene.text())
                      + "run 500\n", scene_data=scene.data())

    assert "law neohookean, which stays stiff when it is compressed" in error(strike("svk"))
    assert strike("neohookean").status == 0


def test_the_cause_is_told_even_if_nothing_can_be_written(tmp_path):
    scene = fluid_box(2)
    scene.v[57] = [0.0, 12.0, 0.0]
    for file in ("fsi_stop.restart", "fsi_stop.dump"):
        (tmp_path / file).mkdir(parents=True)
    message = error(lammps(tmp_path, scene.text() + "run 5\n", scene_data=scene.data()))
    assert ("Mach number 1.2" in message
            and "fsi_stop.restart cannot be written: Is a directory" in message)


BAD = [("mach", r"fix fsi mach command: missing"), ("mach 0", r"mach 0 must be > 0"),
       ("mach -1", r"mach -1 must be > 0"),
       ("mach nan", r"mach nan"), ("mach 1e30", r"mach 1e30 is too large"), ("mach fast", r"fast")]


@pytest.mark.parametrize("words, message", BAD, ids=[words for words, _ in BAD])
def test_bad_input(tmp_path, words, message):
    scene = fluid_box(2, sph=words)
    done = lammps(tmp_path, scene.text() + "run 1\n", scene_data=scene.data())
    assert done.status != 0 and any(re.search(message, text)
                                    for text in done.errors), done.output[-1500:]
