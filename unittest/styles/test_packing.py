"""Command fsi/pack: a body and the water around it along a surface. Sums, masses, ranks, files, and
flows that know the lattice."""

import math
import re

import numpy as np
import pytest
from decks import WALL, WATER
from decks import deck as deck_of
from scenes import lammps

from fsi import dump

DX, R = 0.01, 0.055
DECK = """units si
dimension {dim}
boundary p p p
atom_style fsi
region box block -0.15 0.15 -0.15 0.15 {z} units box
create_box 2 box
lattice {lattice} {dx} origin 0.5 0.5 {origin}
region near block -0.145 0.145 -0.145 0.145 {near} units box
{water}
create_atoms 2 region near
group water type 1
group body type 2
fsi/material water fluid rho 1000
fsi/material body wall rho 1500
pair_style fsi/fluid sound 10 background 500 tension yes
pair_coeff * * NULL water body
fix 1 water fsi {dx} wendland 1.5
fix 2 body fsi/wall/particle
neighbor 0.005 bin
timestep 1e-5
{region}
fsi/pack body {fluid} {surface} {steps}
write_dump all custom end.dump id type mass x y z modify sort id format float %.17g
run 0
"""


def deck(surface, dim=2, region="", fluid="water", steps="", dx=DX):
    z, near = ("-0.15 0.15", "-0.145 0.145") if dim == 3 else (f"{-dx / 2} {dx / 2}", "INF INF")
    return DECK.format(dim=dim, z=z, near=near, lattice="sc" if dim == 3 else "sq",
                       origin=0.5 if dim == 3 else 0, dx=dx, region=region,
                       fluid=fluid, surface=surface, steps=steps, water="create_atoms 1 box"
                       if fluid != "NULL" else "")


def state(folder):
    lines = (folder / "end.dump").read_text().splitlines()
    table = np.array(
        [line.split() for line in lines[lines.index("ITEM: ATOMS id type mass x y z") + 1:]], float)
    return table[:, 1].astype(int), table[:, 2], table[:, 3:]


def residue(log):
    found = re.search(r"surface: (\S+) at most, (\S+) rms", log)
    return float(found[1]), float(found[2])


def sums(x, volume, box, h, dim):
    """dx |sum V grad W| of each particle, Wendland C2, in a periodic box"""
    norm = {2: 7 / (4 * math.pi * h**2), 3: 21 / (16 * math.pi * h**3)}[dim]
    found = np.zeros((len(x), 3))
    for i, xi in enumerate(x):
        d = xi - x
        d[:, :dim] -= box * np.round(d[:, :dim] / box)
        q = np.sqrt((d**2).sum(1)) / h
        g = np.where(q < 2, -5 * q * (1 - q / 2)**3, 0) * norm / h
        with np.errstate(invalid="ignore", divide="ignore"):
            found[i] = (volume * np.where(q > 0, g / (q * h), 0))[:, None].T @ d
    return DX * np.sqrt((found**2).sum(1))


DISC = f"region s cylinder z 0 0 {R} INF INF units box"


def test_disc(tmp_path):
    done = lammps(tmp_path, deck("region s", region=DISC))
    kind, mass, x = state(tmp_path)
    r = np.hypot(x[:, 0], x[:, 1])
    body, near = kind == 2, abs(r - R) < 6 * DX
    area = math.pi * R**2
    assert body.sum() == round(area / DX**2)
    # the volume is found by cells of a quarter of the spacing
    assert mass[body].sum() == pytest.approx(1500 * area, rel=2e-4)
    assert len(x) == 900 and np.ptp(mass[body]) == 0.0
    assert r[body].max() < R - 0.499 * DX and r[~body].min() > R + 0.499 * DX
    of = sums(x, np.where(body, mass / 1500, mass / 1000), 0.3, 1.5 * DX, 2)[near]
    largest, rms = residue(done.output)
    # of a lattice that the disc cuts it is 0.4; what is printed is what numpy finds at the end, one
    # step later
    assert of.max() < 0.05 and math.sqrt((of**2).mean()) < 0.01
    assert largest == pytest.approx(of.max(), rel=0.1) and rms == pytest.approx(
        math.sqrt((of**2).mean()), rel=0.1)


def test_lattice_cut_by_the_same_disc_is_far_from_it(tmp_path):
    """The sums of what is not packed: an order of magnitude more."""
    lammps(tmp_path, deck("region s", region=DISC, steps="steps 0"))
    kind, mass, x = state(tmp_path)
    x = x[kind == 1]
    r = np.hypot(x[:, 0], x[:, 1])
    assert len(x) == 900 - round(math.pi * R**2 / DX**2) and r.min() > R - DX


@pytest.mark.parametrize("ranks", [2, 4])
def test_ranks(tmp_path, ranks):
    places = []
    for n in (1, ranks):
        folder = tmp_path / str(n)
        folder.mkdir()
        lammps(folder, deck("region s", region=DISC, steps="steps 60"), n)
        places.append(state(folder))
    # atoms created on other ranks have other IDs; sums in another order
    for kind in (1, 2):
        a, b = (x[of == kind] for of, _, x in places)
        assert len(a) == len(b)
        assert max(np.linalg.norm(b - x, axis=1).min() for x in a) < 1e-9 * DX


@pytest.mark.parametrize("steps, loose", [("steps 1", True), ("", False)])
def test_a_residue_that_stays_is_said(tmp_path, steps, loose):
    """That of a cut lattice is 0.1."""
    log = lammps(tmp_path, deck("region s", region=DISC, steps=steps)).output
    assert ("fsi/pack: the residue stays at" in log) == loose == (residue(log)[1] > 0.05)


def test_water_created_twice_goes_apart(tmp_path):
    """The kernel's gradient leaves two at one place there."""
    text = deck("region s", region=DISC).replace(
        "group water", "create_atoms 1 single 0.075 0.025 0 units box\ngroup water")
    lammps(tmp_path, text)
    _, _, x = state(tmp_path)
    apart = np.linalg.norm(x[:, None] - x, axis=2) + np.eye(len(x))
    assert len(x) == 901 and apart.min() > 0.6 * DX


SPHERE = "region s sphere 0 0 0 0.1 units box"


def test_sphere(tmp_path):
    done = lammps(tmp_path, deck("region s", dim=3, region=SPHERE, dx=0.02, steps="steps 200"), 2)
    kind, mass, x = state(tmp_path)
    body, r = kind == 2, np.sqrt((x**2).sum(1))
    assert mass[body].sum() == pytest.approx(1500 * 4 / 3 * math.pi * 0.1**3, rel=1e-3)
    assert r[body].max() < 0.1 - 0.499 * 0.02 and r[~body].min() > 0.1 + 0.499 * 0.02
    assert residue(done.output)[0] < 0.05 and residue(done.output)[1] < 0.005


# made along the axes and turned, six spacings wide
PLATE = """region p block -0.06 0.06 -0.03 0.03 INF INF units box
create_atoms 2 region p
group body type 2
displace_atoms body rotate 0 0 0 0 0 1 {angle} units box
variable turned equal {angle}*PI/180
region s block -0.06 0.06 -0.03 0.03 INF INF units box rotate v_turned 0 0 0 0 0 1
"""


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("angle", [5, 22.5, 45])
def test_water_around_a_turned_body(tmp_path, angle, ranks):
    """The body stays as it is; as much water goes as it has volume."""
    text = deck("region s still body", region=PLATE.format(angle=angle)).replace(
        "create_atoms 2 region near\n", "").replace(
        "fsi/pack body", "fsi/pack NULL")
    done = lammps(tmp_path, text, ranks)
    kind, _, x = state(tmp_path)
    body = kind == 2
    assert body.sum() == 72 and len(x) == 900
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    own = x[body][:, :2] @ np.array([[c, -s], [s, c]])
    # each in the middle of its cell, to the digits of a rotation by a quaternion
    assert abs(own / DX - np.floor(own / DX) - 0.5).max() < 1e-9
    largest, rms = residue(done.output)
    assert largest < 0.05 and rms < 0.01


def test_alone(tmp_path):
    """Without fluid the body's own lattice completes the sums, and goes: no particle is left
    outside."""
    done = lammps(tmp_path, deck("region s", region=DISC, fluid="NULL"))
    kind, mass, x = state(tmp_path)
    assert set(kind) == {2} and np.hypot(x[:, 0], x[:, 1]).max() < R - 0.499 * DX
    assert mass.sum() == pytest.approx(1500 * math.pi * R**2, rel=2e-4)
    assert residue(done.output)[0] < 0.05


@pytest.mark.parametrize("low", [-0.075, -0.15])
@pytest.mark.parametrize("of, ends", [("s", True), ("s", False), ("both", True)])
def test_half_before_a_plane(tmp_path, low, of, ends):
    """Of a body that a mirror wall halves, what is before it is packed, wherever the box ends. What
    is behind is left of its lattice; the body may end at the wall, and so may the region."""
    text = deck(f"region {of}", region=f"{DISC}\nregion front block INF INF 0 INF INF INF units "
                "box\nregion both intersect 2 s front")
    text = text.replace("boundary p p p", "boundary p f p").replace("block -0.15 0.15 -0.15",
                                                                    f"block -0.15 0.15 {low}")
    text = text.replace("create_atoms 1 box", "region channel block INF INF 0 0.15 INF INF units "
                        "box\ncreate_atoms 1 region channel")
    text = text.replace("-0.145 0.145 INF INF units",
                        f"{0 if ends else -0.075} 0.145 INF INF units")
    done = lammps(tmp_path, text.replace("fix 2 body",
                                         "fix 3 water fsi/wall/mirror ylo 0 yhi 0.15\nfix 2 body"))
    kind, mass, x = state(tmp_path)
    before = x[:, 1] > 0
    body = kind == 2
    assert mass[body & before].sum() == pytest.approx(750 * math.pi * R**2, rel=5e-4)
    assert (body & before).sum() == round(math.pi * R**2 / 2 / DX**2) and x[before,
                                                                            1].min() > 0.2 * DX
    assert residue(done.output)[0] < 0.05
    side = (np.arange(-10, 10) + 0.5) * DX
    assert (body & ~before).sum() == (0 if ends else (np.hypot(side, side[:10, None]) < R).sum())
    assert (body | before).all() and np.hypot(x[~before, 0],
                                              x[~before, 1]).max(initial=0) < R + 0.25 * DX


def test_vessel(tmp_path):
    """Water rests in a round vessel whose wall is packed with it. Each row of water is a step of 5
    % in the pressure at the bottom."""
    lammps(tmp_path, deck_of(
        "-0.25 0.25 -0.25 0.25", DX, {"water": WATER, "wall": WALL},
        "fix g all gravity 9.81 vector 0 -1 0", "fix wall wall fsi/wall/particle",
        "region vessel cylinder z 0 0 0.2 INF INF side out units box",
        "fsi/pack wall water region vessel", "fsi/set water hydrostatic 0",
        "compute p all fsi/atom p", "fsi/run 1.5",
        "write_dump water custom end.dump id x y c_p modify sort id time yes",
        fluid="preset splash 2", group="water", water="-0.23 0.23 -0.23 0", wall=""))
    end = dump.read(tmp_path / "end.dump")[-1]
    x, y, p = end["x"], end["y"], end["c_p"]
    top = y.max() + 0.005
    assert len(x) == pytest.approx(math.pi * 20**2 / 2, abs=3)    # in cells
    assert np.hypot(x, y).max() < 0.2 and abs(top) < 0.004
    assert np.sqrt(np.mean((p - 9810 * (top - y))**2)) < 0.02 * 9810 * 0.2


@pytest.mark.parametrize("side, ranks", [(0.25, 1), (0.246, 1), (0.254, 2)])
def test_wall_in_a_box_of_no_whole_spacings(tmp_path, side, ranks):
    """The cells of its lattice, 50 by 50, go beyond the box or end before it: as many particles as
    they have room for outside the vessel."""
    done = lammps(tmp_path, deck_of(
        f"-{side} {side} -{side} {side}", DX, {"water": WATER, "wall": WALL},
        "fix wall wall fsi/wall/particle",
        "region vessel cylinder z 0 0 0.2 INF INF side out units box",
        "fsi/pack wall water region vessel steps 0",
        "write_dump all custom end.dump id type mass x y z modify sort id format float %.17g",
        fluid="preset splash 2", group="water", water="", wall=""), ranks)
    assert done.status == 0, done.errors
    kind, mass, x = state(tmp_path)
    wall, r = kind == 2, np.hypot(x[:, 0], x[:, 1])
    assert wall.sum() == round(0.25 / DX**2 - math.pi * 20**2)
    # their density, to the digits of the volume
    assert mass[wall].sum() == pytest.approx(1000 * (0.25 - math.pi * 0.2**2), rel=5e-4)
    # next to the water, where the lattice is cut: the error of a count of cells in a ring
    assert (wall & (r < 0.2 + 3 * DX)).sum() == pytest.approx(math.pi * (23**2 - 20**2), abs=12)


def test_disc_in_a_vessel(tmp_path):
    """Packed one after the other, 7.5 spacings apart. The lattice of the second, which is in the
    whole box until it is packed, does not press on the water beside the first."""
    vessel = """create_atoms 3 box
group vessel type 3
fix 3 vessel fsi/wall/particle
region v cylinder z 0 0 0.13 INF INF units box side out
fsi/pack vessel water region v
write_dump"""
    text = deck("region s", region=DISC).replace("create_box 2", "create_box 3").replace(
        "water body\n", "water body body\n").replace("write_dump", vessel)
    lammps(tmp_path, text)
    kind, mass, x = state(tmp_path)
    r = np.hypot(x[:, 0], x[:, 1])
    of = sums(x, mass / np.array([0, 1000, 1500, 1500])[kind], 0.3, 1.5 * DX, 2)
    # as in test_disc; 0.1 with two lattices in the disc
    assert math.sqrt((of[(kind < 3) & (abs(r - R) < 3 * DX)]**2).mean()) < 0.02
    assert r[kind == 1].min() > R and r[kind == 1].max() < 0.13 - 0.499 * DX


def test_volume_of_several_regions(tmp_path):
    """A disc with a strip: LAMMPS has no distance from the two corners between them."""
    width = 0.03
    text = deck("region both", region=f"{DISC}\nregion strip block -0.1 0 {-width / 2} {width / 2} "
                "INF INF units box\nregion both union 2 s strip")
    lammps(tmp_path, text)
    kind, mass, _ = state(tmp_path)
    half = math.asin(width / 2 / R)
    inside = R**2 * half + width / 2 * R * math.cos(half)   # of the strip in the disc
    assert mass[kind == 2].sum() == pytest.approx(1500 * (math.pi * R**2 + 0.1 * width - inside),
                                                  rel=1e-3)


UNION = """region a cylinder z -0.07 0 0.04 INF INF units box
region b cylinder z 0.06 0 0.05 INF INF units box
region s union 2 a b"""


@pytest.mark.parametrize("side", ["in", "out"])
def test_union(tmp_path, side):
    """Two discs, and the water around them; body and water exchanged if it is side out."""
    text = deck("region s", region=UNION.replace("2 a b", f"2 a b side {side} units box"))
    if side == "out":
        text = text.replace("fsi/pack body water", "fsi/pack water body")
    done = lammps(tmp_path, text)
    kind, _, x = state(tmp_path)
    off = np.minimum(np.hypot(x[:, 0] + 0.07, x[:, 1]) - 0.04, np.hypot(x[:, 0] - 0.06, x[:, 1])
                     - 0.05)
    body = kind == 2
    assert body.sum() == pytest.approx(math.pi * (0.04**2 + 0.05**2) / DX**2, abs=1)
    assert off[body].max() < -0.499 * DX and off[~body].min() > 0.499 * DX
    assert residue(done.output)[0] < 0.05 and residue(done.output)[1] < 0.01


@pytest.mark.parametrize("angle", [10, 26.565, 45])
@pytest.mark.parametrize("box", ["-0.15 0.15 -0.15 0.15", "-0.15 0.155 -0.18 0.15"])
def test_volume_of_a_turned_block(tmp_path, angle, box):
    """Cells are cut by their plane: at 45 degrees, where rows of them lie along a face, half a cell
    would be missing otherwise (0.5 %). Also where no whole number of spacings goes into the box, so
    that cells are no squares."""
    region = (f"variable turned equal {angle}*PI/180\nregion s block -0.08 0.08 -0.02 0.02 INF INF "
              "units box rotate v_turned 0 0 0 0 0 1")
    text = deck("region s", region=region, fluid="NULL", steps="steps 0").replace(
        "region box block -0.15 0.15 -0.15 0.15", f"region box block {box}")
    lammps(tmp_path, text)
    # at the four corners two planes cut a cell
    assert state(tmp_path)[1].sum() == pytest.approx(1500 * 0.16 * 0.04, rel=1e-3)


def outline(points):
    return "".join(f"{x!r},{y!r}\n" for x, y in points)


def test_outline_with_a_cavity(tmp_path):
    """A ring: its inner outline is given the same way round as the outer one."""
    circle = [(math.cos(a), math.sin(a)) for a in np.linspace(0, 2 * math.pi, 200, endpoint=False)]
    text = outline([(0.09 * x, 0.09 * y) for x, y in circle]) + "\n" + outline(
        [(0.04 * x, 0.04 * y) for x, y in circle])
    lammps(tmp_path, deck("outline ring.csv"), ring_csv=text)
    kind, mass, x = state(tmp_path)
    r = np.hypot(x[:, 0], x[:, 1])
    body = kind == 2
    area = 100 * math.sin(math.pi / 100) * (0.09**2 - 0.04**2)
    assert mass[body].sum() == pytest.approx(1500 * area, rel=1e-9)
    assert r[body].min() > 0.0449 and r[body].max() < 0.0851 and (r[~body] < 0.0351).sum() > 20


CORNERS = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
FACES = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6),
         (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]


def stl(faces, size=0.07):
    lines = ["solid cube"]
    for face in faces:
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += [f"vertex {' '.join(repr(size * c) for c in CORNERS[k])}" for k in face]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid"])


def test_stl(tmp_path):
    """A cube, of no whole number of spacings, by its triangles: mass, sharp edges."""
    lammps(tmp_path, deck("stl cube.stl steps 100", dim=3, dx=0.02), cube_stl=stl(FACES))
    kind, mass, x = state(tmp_path)
    body = kind == 2
    assert mass[body].sum() == pytest.approx(1500 * 0.14**3, rel=1e-9)
    away = np.linalg.norm(np.maximum(abs(x[~body]) - 0.07, 0), axis=1)
    assert abs(x[body]).max() < 0.06 + 1e-9 and away.min() > 0.01 - 1e-4


def turned_angle():
    """An L of triangles, 11 by 11 by 8 spacings, its legs 5 wide, in no direction of the lattice:
    (STL, corners' own axes)"""
    plan = np.array([(0, 0), (11, 0), (11, 5), (5, 5), (5, 11), (0, 11)]) - 4.5
    c, s, d, t = (f(a) for a in np.radians((20, 15)) for f in (np.cos, np.sin))
    axes = np.array([(1, 0, 0), (0, d, -t), (0, t, d)]) @ np.array(
        [(c, -s, 0), (s, c, 0), (0, 0, 1)])
    corners = DX * np.array([(x, y, z) for z in (-4, 4) for x, y in plan]) @ axes.T
    ends = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]
    faces = [f[::-1] for f in ends] + [tuple(k + 6 for k in f) for f in ends]
    for a in range(6):
        b = (a + 1) % 6
        faces += [(a, b, b + 6), (a, b + 6, a + 6)]
    lines = ["facet normal 0 0 0\nouter loop\n"
             + "".join("vertex %.12g %.12g %.12g\n" % tuple(corners[k]) for k in f)
             + "endloop\nendfacet\n" for f in faces]
    return "solid angle\n" + "".join(lines) + "endsolid\n", axes


@pytest.mark.slow
def test_turned_stl(tmp_path):
    """Edges in no direction of the lattice, one of them reentrant: sums of a tenth of those of a
    lattice that is cut, and each on its side."""
    text, axes = turned_angle()
    done = lammps(tmp_path, deck("stl angle.stl steps 200", dim=3), angle_stl=text)
    kind, mass, x = state(tmp_path)
    own = x @ axes / DX
    legs = [abs(own - middle) - half
            for middle, half in (((1, -2, 0), (5.5, 2.5, 4)), ((-2, 1, 0), (2.5, 5.5, 4)))]
    outside = np.min([np.linalg.norm(np.maximum(leg, 0), axis=1) for leg in legs], axis=0)
    hull = (abs(own - (1, 1, 0)) - (5.5, 5.5, 4)).max(1)
    body = kind == 2
    assert mass[body].sum() == pytest.approx(1500 * 85 * 8 * DX**3, rel=1e-9) and body.sum() == 680
    assert hull[body].max() < -0.499 and own[body, :2].min(
        1).max() < 0.5 - 0.499 and outside[~body].min() > 0.499
    largest, rms = residue(done.output)
    assert largest < 0.05 and rms < 0.005


@pytest.mark.parametrize("words, files, message", [
    ("stl cube.stl", {"cube_stl": stl(FACES[1:])}, "file cube.stl is not closed"),
    ("stl cube.stl", {"cube_stl": "solid cube\nendsolid"}, "file cube.stl is no STL file"),
    ("stl none.stl", {}, "cannot open file none.stl"),
    ("region none", {}, "region none does not exist"),
    ("steps 10", {}, "takes one of region, stl and outline"),
])
def test_refused(tmp_path, words, files, message):
    done = lammps(tmp_path,
                  deck(words, dim=3 if "stl" in words else 2, dx=0.02 if "stl" in words else DX),
                  **files)
    assert done.status != 0 and message in done.errors[0]


def test_outline_that_crosses_itself(tmp_path):
    bow = outline([(-0.08, -0.05), (0.08, 0.05), (0.08, -0.05), (-0.08, 0.05)])
    done = lammps(tmp_path, deck("outline bow.csv"), bow_csv=bow)
    assert done.status != 0 and "cross" in done.errors[0]


def test_body_without_lattice(tmp_path):
    text = deck("region s", region=DISC).replace("region near block -0.145 0.145",
                                                 "region near block -0.03 0.03")
    done = lammps(tmp_path, text)
    assert done.status != 0 and "expected one that goes on beyond the surface" in done.errors[0]


def test_groups_in_common(tmp_path):
    done = lammps(tmp_path, deck("region s", region=DISC, fluid="all"))
    assert done.status != 0 and "are in two of the groups body, fluid and still" in done.errors[0]


@pytest.mark.parametrize("before, refused", [("", False), ("run 0\n", True)])
def test_body_with_bonds(tmp_path, before, refused):
    """An elastic body is packed before it is bonded, or it would begin with strain."""
    text = deck("region s", region=DISC, fluid="NULL")
    text = re.sub(r"fsi/material body wall.*\n(.*\n)+?fix 1 ", "fsi/material body solid rho 1500 "
                  "young 1e6 poisson 0.3\npair_style fsi/solid/tl\n"
                  "pair_coeff * * NULL body body\nset group body mol 1\nfix 1 ",
                  text).replace("fix 1 water", "fix 1 body")
    text = text.replace("fix 2 body fsi/wall/particle", "").replace("fsi/pack", before + "fsi/pack")
    done = lammps(tmp_path, text)
    assert (done.status != 0) == refused, done.output[-1000:]
    assert not refused or "have bonds since an earlier run" in done.errors[0]
