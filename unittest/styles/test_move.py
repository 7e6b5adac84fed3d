"""fix fsi/move: where prescribed motions are in the middle and at the end of steps that change,
restarts, and what it does to the order in time."""

import re

import numpy as np
import pytest

from decks import start
from scenes import DX, Scene, dam_gate, differing, lammps, lattice, particles, run, watch

OMEGA = 2 * np.pi / 0.3
STYLES = {  # arguments; where a particle from x is after t, and how fast
    "linear 0.5 0 0 units box": lambda x, t: (x + [0.5 * t, 0, 0], [0.5, 0, 0]),
    "linear 2 3 0": lambda x, t: (x + np.array([0.2, 0.3, 0]) * t, [0.2, 0.3, 0]),  # lattice of 0.1
    "wiggle 0.2 0.1 0 0.3 units box": lambda x, t: (x + np.array([0.2, 0.1, 0]) * np.sin(OMEGA * t),
                                                    np.array([0.2, 0.1, 0]) * OMEGA
                                                    * np.cos(OMEGA * t)),
    "rotate 0.5 0.2 0 0 0 2 0.3 units box": lambda x, t: turned(x, t, [0.5, 0.2, 0], [0, 0, 1]),
    "transrot 0.1 0.4 0 0.5 0.2 0 0 0 1 0.3 units box": lambda x, t: [a + b for a, b in zip(
        turned(x, t, [0.5, 0.2, 0], [0, 0, 1]), ([0.1 * t, 0.4 * t, 0], [0.1, 0.4, 0]))],
    "variable v_dx v_dy Z v_vx v_vy Z": lambda x, t: (x + [0.3 * t**2, 0.1 * np.sin(t), 0],
                                                      [0.6 * t, 0.1 * np.cos(t), 0]),
    "variable v_ax v_dy Z v_avx v_vy Z": lambda x, t: (
        x + np.stack([x[:, 1] * t, 0 * t + 0.1 * np.sin(t) * np.ones(len(x)), np.zeros(len(x))], 1),
                                                            np.stack([x[:, 1], 0.1 * np.cos(t)
                                                                      * np.ones(len(x)),
                                                                      np.zeros(len(x))], 1)),
}
VARIABLES = """
variable zero equal 0
variable t equal time
variable dx equal 0.3*v_t^2
variable vx equal 0.6*v_t
variable dy equal 0.1*sin(v_t)
variable vy equal 0.1*cos(v_t)
fix first all store/state 0 yu
variable ax atom f_first*v_t
variable avx atom f_first
"""


def turned(x, t, point, axis):
    """Rodrigues' formula"""
    d, k = x - point, np.asarray(axis, float)
    c, s = np.cos(OMEGA * t), np.sin(OMEGA * t)
    rotated = d * c + np.cross(k, d) * s + np.outer(d @ k, k) * (1 - c)
    return rotated + point, np.cross(OMEGA * k, rotated)


def held_lattice(dim=2, **more):
    """Water that stays, and water that fix fsi leaves alone."""
    x = np.vstack([lattice([4] * dim, 0.1), lattice([4] * dim, 0.1) + [2.0, 0.0, 0.0]])
    return x, Scene(x, dim=dim, dx=0.1, held=np.arange(len(x)) >= len(x) // 2, **more)


@pytest.mark.parametrize("dim", (2, 3))
@pytest.mark.parametrize("style", [*STYLES, "rotate 0.5 0.2 0.1 1 -2 0.5 0.3 units box"])
def test_where_it_is(style, dim):
    """In the middle of each step, where forces are, and at its end, while the step grows tenfold.
    Round-off of some positions."""
    if style not in STYLES and dim == 2:
        style = "rotate 0.5 0.2 0.1 0 0 -1 0.3 units box"
    axis = np.array([1, -2, 0.5]) / np.linalg.norm([1, -2, 0.5]) if dim == 3 else [0, 0, -1]
    exact = STYLES.get(style) or (lambda x, t: turned(x, t, [0.5, 0.2, 0.1], axis))
    commands = [f"lattice {'sq' if dim == 2 else 'sc'} 0.1", VARIABLES, "fix drive held fsi/move "
                f"{style.replace(' Z', ' NULL' if dim == 2 else ' v_zero')}",
                "fix dt all fsi/dt 1 growth 1.3",
                "fix see all external pf/callback 1 1"]
    x, scene = held_lattice(dim, dt=1e-4, density="mach off", commands=commands)
    n = len(x) // 2
    middle = []
    with scene as s:
        def see(_, step, nlocal, tag, at, f):
            f[:] = 0.0
            now = s.lmp.get_thermo("time") - 0.5 * s.lmp.extract_global("dt") * (step > 0)
            order = np.argsort(tag[:nlocal])
            middle.append((now, np.array(at[:nlocal])[order][n:]))

        s.lmp.set_fix_external_callback("see", see)
        s.run(12)
        t = s.lmp.get_thermo("time")
        place, speed = exact(x[n:], t)
        np.testing.assert_allclose(s.get("x")[n:], place, atol=1e-13)
        np.testing.assert_allclose(s.get("v")[n:], np.broadcast_to(speed, (n, 3)), atol=1e-12)
        assert s.lmp.extract_global("dt") > 5e-4 and len(middle) == 13
        np.testing.assert_allclose(s.get("x")[:n], x[:n], atol=1e-6)  # the rest rests
    for now, at in middle:
        np.testing.assert_allclose(at, exact(x[n:], now)[0], atol=1e-13)


def test_velocities_at_the_first_forces():
    """They are those of the motion when the run starts, and the same after runs of no steps."""
    x, scene = held_lattice(density="mach off",
                            commands=["fix drive held fsi/move wiggle 0.2 NULL NULL 0.3 units box"])
    with scene as s:
        for _ in range(2):
            s.run(0)
            np.testing.assert_allclose(s.get("v")[16:, 0], 0.2 * OMEGA, rtol=1e-14)
            np.testing.assert_array_equal(s.get("x"), x)


def test_as_fix_move(tmp_path):
    """With steps that do not change: LAMMPS' own fix, at the end of the steps."""
    for style in ("linear 1 0 0", "wiggle 0.2 0.1 0 0.3 units box",
                  "rotate 0.5 0.2 0 0 0 2 0.3 units box", "transrot 0.1 0.4 0 0.5 0.2 0 0 0 1 0.3"):
        ends = []
        for name in ("move", "fsi/move"):
            with held_lattice(dt=2e-3, density="mach off", commands=[
                "lattice sq 0.1", f"fix drive held {name} {style}"])[1] as s:
                s.run(50)
                ends.append((s.get("x")[16:], s.get("v")[16:]))
        for a, b in zip(*ends):
            np.testing.assert_allclose(a, b, atol=1e-12)


def test_what_is_free_falls():
    """Along x it is driven, along y it follows its forces by position Verlet, which has a parabola
    exactly. Velocity alone: the trapezoidal rule."""
    commands = ["variable t equal time", "variable vx equal 3*v_t^2",
                "fix g held gravity 9.81 vector 0 -1 0",
                "fix drive held fsi/move variable NULL NULL NULL v_vx NULL NULL"]
    x, scene = held_lattice(dt=1e-3, commands=commands)
    with scene as s:
        s.run(100)
        end, v = s.get("x")[16:], s.get("v")[16:]
        np.testing.assert_allclose(v, [[3 * 0.1**2, -0.981, 0.0]] * 16, atol=1e-12)
        np.testing.assert_allclose(end[:, 1] - x[16:, 1], -0.5 * 9.81 * 0.1**2, atol=1e-12)
        # and the rule's error, h^2/12 of f'
        np.testing.assert_allclose(end[:, 0] - x[16:, 0], 0.1**3 + 0.5 * 0.1 * 1e-6, atol=1e-12)


@pytest.mark.parametrize("style", STYLES)
def test_goes_on_from_where_a_command_has_put_it(style):
    """displace_atoms before the first run, and between runs: no way back, and the same motion from
    there."""
    commands = ["lattice sq 0.1", VARIABLES,
                f"fix drive held fsi/move {style.replace(' Z', ' NULL')}"]
    x, scene = held_lattice(dt=1e-3, density="mach off",
                            commands=[*commands, "displace_atoms held move 0.02 0.01 0 units box"])
    first, shift, exact = x[16:] + [0.02, 0.01, 0.0], np.array([-0.01, 0.03, 0.0]), STYLES[style]
    offset = np.array([0.02, 0.01, 0.0])
    with scene as s:
        for _ in range(2):
            s.run(0)
            np.testing.assert_allclose(s.get("x")[16:], first, atol=1e-13)
        s.run(20)
        # variables that know where particles were at the command go on from that
        moving = lambda t: (  # noqa: E731
            exact(x[16:], t)[0] + offset if "variable" in style else exact(first, t)[0])
        np.testing.assert_allclose(s.get("x")[16:], moving(0.02), atol=1e-13)
        s.run_lines("displace_atoms held move -0.01 0.03 0 units box")
        s.run(0).run(30)
        # what turns is the place that has not drifted
        drift = np.array([0.1, 0.4, 0.0]) if "transrot" in style else np.zeros(3)
        again = turned(moving(0.02) + shift - drift * 0.02, 0.03, [0.5, 0.2, 0],
                       [0, 0, 1])[0] + drift * 0.05
        want = again if "rot" in style else moving(0.05) + shift
        np.testing.assert_allclose(s.get("x")[16:], want, atol=1e-13)


@pytest.mark.parametrize("style", ("equal", "atom"))
def test_a_variable_begins_where_particles_are(style):
    """A displacement that is not 0 when the fix is given, or given again, or that a command
    changes: what it changes by from then on."""
    place, give = lambda t: 0.3 * (1 - np.cos(6 * t)), (
        "fix drive held fsi/move variable v_d v_zero NULL v_u v_zero NULL")
    x, scene = held_lattice(dt=1e-3, density="mach off", commands=[
        "variable zero equal 0", f"variable d {style} 0.3*(1-cos(6*time))",
        f"variable u {style} 1.8*sin(6*time)"])
    with scene as s:
        s.run(100)
        s.run_lines(give)
        for t, command in (0.1, ""), (0.12, "unfix drive\n" + give), (
                0.14, f"variable d {style} 5+0.3*(1-cos(6*time))"):
            s.run_lines(*command.split("\n"))
            s.run(1)
            s.run(19)
            np.testing.assert_allclose(s.get("x")[16:, 0] - x[16:, 0], place(t + 0.02) - place(0.1),
                                       atol=1e-13)


def test_a_run_that_stops_in_a_step_puts_it_back(tmp_path, monkeypatch):
    """So that the next run does not take the middle of that step for a place that a command has
    given."""
    monkeypatch.chdir(tmp_path)
    x, scene = held_lattice(dt=1e-4,
                            commands=["fix drive held fsi/move rotate 0.5 0.2 0 0 0 2 3 units box"])
    with scene as s:
        s.run(10)
        before = s.get("x")[16:]
        s.run_lines("fix push moving addforce 1e12 0 0")
        with pytest.raises(Exception, match="Mach number .* on step 11"):
            s.run(5)
        np.testing.assert_allclose(s.get("x")[16:], before, atol=1e-13)


def test_through_a_periodic_boundary():
    """Twice around the box: places are those of the motion, wrapped."""
    x = lattice([4, 4], 0.1)
    box = ((0.0, -1.0, 0.0), (1.0, 2.0, 0.0))
    with Scene(x, dx=0.1, held=np.arange(16) < 8, box=box, boundary="p f p", dt=1e-2,
               density="mach off",
               commands=["fix drive held fsi/move linear 10 0 0 units box",
                         "group rest subtract all held"]) as s:
        s.put("rho", np.full(16, 1000.0))
        s.run(20)
        np.testing.assert_allclose(s.get("x")[:8, 0], (x[:8, 0] + 2.0) % 1.0, atol=1e-12)


def test_particles_made_in_a_run(tmp_path):
    """They join the motion where they are."""
    scene = dam_gate(2)
    text = scene.text().replace("fix sph all", "group water type 1\ngroup plate type 2\nfix sph water") + """
fix drive plate fsi/move rotate 0.2 0.0 0 0 0 1 0.5 units box
run 20
create_atoms 2 single 0.0 0.2 0 units box
group plate type 2
dump d all custom 20 d.dump id x y
dump_modify d sort id time yes format float %.17g
run 20
"""
    text = text.replace("create_atoms 2 single 0.0 0.2 0 units box",
                        "fix drip plate deposit 1 2 1 5 region where\n"
                        "region where block 0.19 0.21 0.13 0.14 -0.001 0.001 units box")
    text = text.replace("fix drip", "region where block 0.0 0.002 0.15 0.152 -0.001 0.001 units "
                        "box\nfix drip").replace(
        "\nregion where block 0.19 0.21 0.13 0.14 -0.001 0.001 units box",
        "").replace("run 20\ndump", "dump")
    frames = run(tmp_path, text, scene_data=scene.data()).frames("d.dump")
    last = frames[-1]
    new = last["id"].argmax()
    assert len(last) == len(scene.x) + 1
    # its distance from the axis is kept: a rotation
    assert np.hypot(last["x"][new] - 0.2, last["y"][new]) == pytest.approx(np.hypot(0.2, 0.15),
                                                                           abs=0.003)


@pytest.mark.parametrize("ranks, between", [
    (1, ""), (2, ""), (2, "run 20\ndisplace_atoms plate move 1e-4 0 0 units box\n")])
def test_restart_goes_on_bit_for_bit(tmp_path, ranks, between):
    """A held solid, with steps that change, also one that a command has moved."""
    scene = dam_gate(2)
    part = scene.physics().replace("fix sph all",
                                   "group water type 1\ngroup plate type 2\nfix sph water")
    tail = "fix drive plate fsi/move wiggle 0.002 NULL NULL 0.05 units box\nfix dt all fsi/dt 7\n"
    made = scene.setup() + "read_data scene.data\n" + part + tail + between
    whole = run(tmp_path, made + watch(every=80) + "restart 40 mid.*\nrun 80 upto\n", ranks,
                scene_data=scene.data())
    rest = scene.setup() + "read_restart mid.40\n" + scene.physics(coeff=False).replace(
        "fix sph all", "group water type 1\ngroup plate type 2\nfix sph water")
    done = run(tmp_path, rest + tail + watch("rest.dump", 80) + "restart 40 other.*\nrun 40\n",
               ranks)
    assert differing(whole.frames()[-1], done.frames("rest.dump")[-1]) == []


@pytest.mark.parametrize("name, low, high", [("fsi/move", 1.9, 2.1), ("move", 0.9, 1.1)])
def test_order_in_time(tmp_path, name, low, high):
    """Water in a box of wall particles that shakes. With walls half a step ahead (LAMMPS' fix move)
    the scheme is of first order."""
    n, m = 6, 4
    x = lattice([n + 2 * m, n + 2 * m], DX) - [m * DX, m * DX, 0]
    inside = (x[:, :2] > 0).all(1) & (x[:, :2] < n * DX).all(1)
    kind = np.where(inside, 1, 2)
    ends = []
    for k in (1, 2, 4, 8):
        text = start("read_data scene.data") + f"""group water type 1
group wall type 2
pair_style fsi/fluid sound 10 tension yes
pair_coeff * * materials.fsi water_inviscid wall
fix sph water fsi {DX} wendland 1.5
fix walls wall fsi/wall/particle guard 0
variable phase equal 2*PI*time/0.02
variable x equal 0.0005*(1-cos(v_phase))
variable y equal 0.0003*(1-cos(v_phase))
variable u equal 0.0005*2*PI/0.02*sin(v_phase)
variable v equal 0.0003*2*PI/0.02*sin(v_phase)
fix drive wall {name} variable v_x v_y NULL v_u v_v NULL
timestep {2e-4 / k}
run {40 * k}
write_dump all custom end.dump id x y modify sort id time yes format float %.17g
"""
        end, = run(tmp_path / str(k), text, scene_data=particles(
            x, kind, box=[(-0.1, 0.2), (-0.1, 0.2), (-0.005, 0.005)])).frames("end.dump")
        ends.append(end.vector("xy")[inside])
    slopes = [np.log2(np.linalg.norm(a - b) / np.linalg.norm(b - c))
              for a, b, c in zip(ends, ends[1:], ends[2:])]
    print(f"order in dt of water in a box shaken by {name}: {slopes}")
    assert low < slopes[-1] < high


BAD = [
    ("", r"fix fsi/move command: missing"),
    ("jump", r"style jump: expected linear, wiggle, rotate, transrot or variable"),
    ("linear 1 0", r"fix fsi/move linear command: missing"),
    ("linear fast 0 0", r"fast"),
    ("linear 1 0 0 color red", r"keyword color: expected units"),
    ("linear 1 0 0 units", r"fix fsi/move linear units command: missing"),
    ("linear 1 0 0 units metre", r"units metre: expected box or lattice"),
    ("linear 0 0 1", r"linear cannot move along z in 2D"),
    ("wiggle 1 0 0 0", r"wiggle period 0 must be > 0"),
    ("wiggle 1 0 0 -1", r"wiggle period -1 must be > 0"),
    ("rotate 0 0 0 0 0 0 1", r"rotate axis must not be of length 0"),
    ("rotate 0 0 0 1 0 0 1", r"rotate axis must be z in 2D"),
    ("variable x NULL NULL NULL NULL NULL", r"variable x must be NULL or v_name"),
    ("variable v_x NULL NULL NULL NULL NULL",
     r"variable x needs the variable of its velocity, too"),
    ("variable v_x NULL NULL v_u NULL NULL", r"Variable x of fix fsi/move does not exist"),
    ("variable v_s NULL NULL v_s NULL NULL",
     r"Variable s of fix fsi/move must be equal-style or atom-style"),
]


@pytest.mark.parametrize("words, message", BAD, ids=[words for words, _ in BAD])
def test_bad_input(tmp_path, words, message):
    scene = dam_gate(2)
    text = scene.text().replace("fix sph all",
                                "group water type 1\ngroup plate type 2\nfix sph water")
    done = lammps(tmp_path, text + "lattice sq 0.01\nvariable s string red\n"
                  f"fix drive plate fsi/move {words}\nrun 1\n", scene_data=scene.data())
    assert done.status != 0 and any(re.search(message, error)
                                    for error in done.errors), done.output[-1500:]


def test_not_what_fix_fsi_moves(tmp_path):
    scene = dam_gate(2)
    done = lammps(tmp_path, scene.text() + "fix drive all fsi/move linear 1 0 0 units box\nrun 1\n",
                  scene_data=scene.data())
    assert done.status != 0 and any("Particles of fix fsi/move drive are also in the group of fix "
                                    "fsi" in error for error in done.errors)


@pytest.mark.parametrize("dim", (2, 3))
def test_a_strip_rides_on_its_clamp(dim):
    """Uniform motion of a strip and of the clamp that fix fsi/move gives it: at rest in their
    frame, whatever the number of sub-steps. A clamp that waits in the middle of the step strains
    the strip by U dt/2 dx = 0.02 of its length, in the rhythm of the steps."""
    x = lattice((4, 8) if dim == 2 else (3, 6, 3), DX)
    held = x[:, 1] < 3 * DX
    with Scene(x, np.tile([0.5, 0.0, 0.0], (len(x), 1)), dim=dim, dx=DX,
               materials=("solid rho 1000 young 1e6 poisson 0.3",), held=held, dt=0.08 * DX,
               density="substeps 8", solid_style="fsi/solid/tl",
               commands=["fix m held fsi/move linear 0.5 0 0 units box"]) as s:
        s.run(20)
        move = s.get("x") - x
        assert np.abs(move - move[0]).max() < 1e-12 * DX * 20 and np.abs(
            s.get("v")[:, 1:]).max() < 1e-10
