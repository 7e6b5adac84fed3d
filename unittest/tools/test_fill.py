"""Particles inside outlines and STL surfaces."""

import struct

import numpy as np
import pytest
from decks import start
from scenes import run

from fsi import cli, fill


def circle(radius, n=400, center=(0.0, 0.0)):
    angle = 2 * np.pi * np.arange(n) / n
    return np.column_stack([np.cos(angle), np.sin(angle)]) * radius + center


def box(low, high):
    """Twelve triangles, corners in any order: only crossings count."""
    corner = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1])
                       for z in (low[2], high[2])], float)
    quads = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    return np.array([corner[[q[0], q[k], q[k + 1]]] for q in quads for k in (1, 2)])


def sphere(radius, n=24):
    """Triangles between meridians and parallels."""
    u, w = np.pi * np.arange(n + 1) / n, 2 * np.pi * np.arange(2 * n) / (2 * n)
    ring = [radius
            * np.array([[np.sin(a) * np.cos(b), np.sin(a) * np.sin(b), np.cos(a)] for b in w])
            for a in u]
    ring[0][:], ring[-1][:] = (0, 0, radius), (0, 0, -radius)
    out = []
    for a, b in zip(ring, ring[1:]):
        for k in range(2 * n):
            m = (k + 1) % (2 * n)
            out += [t for t in ([a[k], b[k], b[m]], [a[k], b[m], a[m]])
                    if np.linalg.norm(np.cross(t[1] - t[0], t[2] - t[0])) > 1e-12]
    return np.array(out)


def write_outline(path, *loops):
    path.write_text("\n\n".join("\n".join(f"{x!r}, {y!r}" for x, y in loop.tolist())
                                for loop in loops) + "\n")
    return str(path)


def write_stl(path, triangles, binary=True):
    if binary:
        body = b"".join(struct.pack("<12fH", 0, 0, 0, *t.ravel(), 0) for t in triangles)
        path.write_bytes(b"solid but binary".ljust(80) + struct.pack("<I", len(triangles)) + body)
    else:
        facet = "facet normal 0 0 0\n outer loop\n{} endloop\nendfacet\n"
        path.write_text("solid s\n" + "".join(
            facet.format("".join(f"  vertex {p[0]!r} {p[1]!r} {p[2]!r}\n" for p in t.tolist()))
            for t in triangles) + "endsolid s\n")
    return str(path)


def atoms(path):
    rows = path.read_text().split("Atoms # fsi\n\n")[1].split("\n")
    return np.array([[float(w) for w in row.split()] for row in rows if row])


def test_circle_with_a_hole(tmp_path):
    """Every particle is inside, every lattice point inside is one: the distance from the center
    decides, but for the outline's own deviation from a circle, 3e-5."""
    outline = write_outline(tmp_path / "ring.csv", circle(0.5, center=(0.3, 0.1)),
                            circle(0.2, center=(0.3, 0.1)))
    fill.main([outline, "0.02", str(tmp_path / "ring.data"), "--type", "2", "--mol", "7"])
    rows = atoms(tmp_path / "ring.data")
    assert (rows[:, 1] == 7).all() and (rows[:, 2] == 2).all() and (rows[:, 3:5] == 0).all() and (
        rows[:, 7] == 0).all()
    grid = (np.arange(-50, 60) + 0.5) * 0.02
    x, y = np.meshgrid(grid, grid, indexing="ij")
    r = np.hypot(x - 0.3, y - 0.1)
    assert (np.abs(r - 0.5).min() > 5e-5) and (np.abs(r - 0.2).min() > 5e-5)
    want = np.column_stack([x[(r < 0.5) & (r > 0.2)], y[(r < 0.5) & (r > 0.2)]])
    assert {tuple(p) for p in np.round(rows[:, 5:7], 6)} == {tuple(p) for p in np.round(want, 6)}


@pytest.mark.parametrize("binary", [True, False])
def test_box_on_the_lattice(tmp_path, binary):
    """Faces on cell faces, edges and vertices on rays' planes: 4 x 5 x 6 particles, none more."""
    surface = write_stl(tmp_path / "box.stl", box((0.1, -0.2, 0.0), (0.5, 0.3, 0.6)), binary)
    fill.main([surface, "0.1", str(tmp_path / "box.data")])
    x = atoms(tmp_path / "box.data")[:, 5:]
    assert len(x) == 4 * 5 * 6
    assert np.allclose(x.min(0), (0.15, -0.15, 0.05)) and np.allclose(x.max(0), (0.45, 0.25, 0.55))


def test_sphere_volume_scale_and_origin(tmp_path):
    """A polyhedron whose volume is the sum of its tetrahedra; lattice counts deviate by some 1/n^2
    of it."""
    triangles = sphere(1.0)
    surface = write_stl(tmp_path / "s.stl", triangles)
    fill.main([surface, "0.02", str(tmp_path / "s.data"), "--scale", "0.3", "--origin", "1", "2",
               "3"])
    x = atoms(tmp_path / "s.data")[:, 5:]
    volume = abs(np.einsum("ij,ij->i", triangles[:, 0],
                           np.cross(triangles[:, 1], triangles[:, 2])).sum()) / 6 * 0.027
    assert len(x) * 0.02**3 == pytest.approx(volume, rel=0.01)
    assert np.allclose(x.mean(0), (1, 2, 3), atol=0.002)
    assert (np.linalg.norm(x - (1, 2, 3), axis=1) < 0.3).all()


def test_vessel(tmp_path):
    """A shell of three layers around a square: what is left of it in the corners is nearer than
    three spacings to the inside."""
    outline = write_outline(tmp_path / "square.txt",
                            np.array([[0.0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]))
    fill.main([outline, "0.1", str(tmp_path / "v.data"), "--shell", "3"])
    x = atoms(tmp_path / "v.data")[:, 5:7]
    outside = np.maximum(np.maximum(0.05 - x, x - 0.95), 0)
    distance = np.hypot(*outside.T)
    assert distance.min() > 0.09 and distance.max() < 0.3001
    # 16 x 16 lattice less 10 x 10, less those of the 3 x 3 corners that are beyond three spacings:
    # 5 each
    beyond = sum(i * i + j * j > 9 for i in (1, 2, 3) for j in (1, 2, 3))
    assert len(x) == 16 * 16 - 100 - 4 * beyond


def test_lammps_reads_it(tmp_path):
    """Liquid and vessel of one outline, put together by read_data add append."""
    outline = write_outline(tmp_path / "bowl.csv", circle(0.1))
    fill.main([outline, "0.01", str(tmp_path / "water.data")])
    fill.main([outline, "0.01", str(tmp_path / "bowl.data"), "--shell", "4", "--type", "1"])
    counts = [len(atoms(tmp_path / f"{n}.data")) for n in ("water", "bowl")]
    result = run(tmp_path, start() + """read_data water.data extra/atom/types 1 group water
read_data bowl.data add append offset 1 0 0 0 0 group bowl
pair_style fsi/fluid sound 20
pair_coeff * * materials.fsi water wall
fix sph water fsi 0.01 wendland 1.5
fix bowl bowl fsi/wall/particle
thermo_modify lost error norm no
timestep 1e-4
run 5
print "WATER $(count(water)) BOWL $(count(bowl))"
""")
    assert f"WATER {counts[0]} BOWL {counts[1]}" in result.output


@pytest.mark.parametrize("scale, dx, says", [
    (100.0, "0.05", "100 x 100 x 100, in spacings 2000 x 2000 x 2000: too many particles. If it is "
     "in millimeters: --scale 0.001"),
    (1e-4, "0.01", "0.0001 x 0.0001 x 0.0001, in spacings 0.01 x 0.01 x 0.01: no particle fits. If "
     "it is in meters, DX in millimeters: --scale 1000"),
    (1e6, "0.05", "too many particles. Mind its units"),
    (1e-9, "0.05", "no particle fits. Mind its units")])
def test_scale_that_is_off(tmp_path, scale, dx, says):
    surface = write_stl(tmp_path / "box.stl", scale * box((0, 0, 0), (1, 1, 1)))
    with pytest.raises(SystemExit) as stop:
        cli.main(["fill", surface, dx, str(tmp_path / "out.data")])
    assert says in str(stop.value) and not (tmp_path / "out.data").exists()


def test_size_is_said(tmp_path, capsys):
    surface = write_stl(tmp_path / "box.stl", box((0, 0, 0), (100, 200, 20)))
    cli.main(["fill", surface, "0.01", str(tmp_path / "out.data"), "--scale", "0.001"])
    text = capsys.readouterr().out
    assert ("0.1 x 0.2 x 0.02, in spacings 10 x 20 x 2; 400 particles" in text
            and "only 2 particles through the thickness" in text)


def test_millimetres_in_surface_and_spacing(tmp_path, capsys):
    """Both in millimetres fit each other, and make a body a thousand times too long: the summary
    says its length and unit."""
    surface = write_stl(tmp_path / "box.stl", box((0, 0, 0), (100, 50, 50)))
    cli.main(["fill", surface, "10", str(tmp_path / "out.data")])
    text = capsys.readouterr().out
    assert ("100 x 50 x 50" in text and "lengths are meters with units si" in text
            and "it is 100 m long. If it is in millimeters: --scale 0.001" in text)
    cli.main(["fill", surface, "0.01", str(tmp_path / "out.data"), "--scale", "0.001"])
    assert "m long" not in capsys.readouterr().out


def test_turned(tmp_path):
    """A quarter turn about z, then one about x of a box of 2 x 3 x 4 particles, and one in the
    plane: where the corners go by hand."""
    surface = write_stl(tmp_path / "box.stl", box((0, 0, 0), (0.2, 0.3, 0.4)))
    # x, y, z -> -y, x, z
    fill.main([surface, "0.1", str(tmp_path / "a.data"), "--turn", "0", "0", "90"])
    x = atoms(tmp_path / "a.data")[:, 5:]
    assert len(x) == 24 and np.allclose(x.min(0), (-0.25, 0.05, 0.05)) and np.allclose(
        x.max(0), (-0.05, 0.15, 0.35))
    # about x first: x, -z, y; then z, x, y
    fill.main([surface, "0.1", str(tmp_path / "a.data"), "--turn", "90", "0", "90"])
    x = atoms(tmp_path / "a.data")[:, 5:]
    assert len(x) == 24 and np.allclose(x.min(0), (0.05, 0.05, 0.05)) and np.allclose(
        x.max(0), (0.35, 0.15, 0.25))
    outline = write_outline(tmp_path / "o.csv",
                            np.array([(0, 0), (0.2, 0), (0.2, 0.3), (0, 0.3)], float))
    fill.main([outline, "0.1", str(tmp_path / "a.data"), "--turn", "90", "--origin", "1", "0"])
    x = atoms(tmp_path / "a.data")[:, 5:7]
    assert len(x) == 6 and np.allclose(x.min(0),
                                       (0.75, 0.05)) and np.allclose(x.max(0), (0.95, 0.15))
    with pytest.raises(SystemExit):
        fill.main([outline, "0.1", str(tmp_path / "a.data"), "--turn", "1", "2", "3"])


@pytest.mark.parametrize("name, content, says", [
    ("open.stl", "open", "surface is not closed: 3 of its edges"),
    ("text.stl", "hello\n", "not an STL file"), ("word.csv", "0 0\n1 x\n", "expected x and y"),
    ("two.csv", "0 0\n1 0\n", "three or more"), ("none.csv", "# nothing\n", "no points"),
    ("small.csv", "0 0\n1e-3 0\n0 1e-3\n", "no particle fits"),
])
def test_what_cannot_be_filled(tmp_path, capsys, name, content, says):
    path = tmp_path / name
    if content == "open":
        write_stl(path, box((0, 0, 0), (1, 1, 1))[:-1])
    else:
        path.write_text(content)
    with pytest.raises(SystemExit) as stop:
        fill.main([str(path), "0.1", str(tmp_path / "out.data")])
    assert says in str(stop.value) + capsys.readouterr().err
    assert not (tmp_path / "out.data").exists()


@pytest.mark.parametrize("off, closed", [(2e-7, True), (1e-5, False)])
def test_corners_that_were_rounded_apart(tmp_path, off, closed):
    """Each triangle of a box has corners of its own, off by part of the size: as one up to a
    millionth of it."""
    triangles = box((0.1, -0.2, 0.0), (0.5, 0.3, 0.6))
    path = write_stl(tmp_path / "box.stl", triangles + 0.6 * off
                     * np.random.default_rng(1).uniform(-1, 1, triangles.shape), binary=False)
    if closed:
        fill.main([path, "0.1", str(tmp_path / "box.data")])
        assert len(atoms(tmp_path / "box.data")) == 4 * 5 * 6
    else:
        with pytest.raises(SystemExit, match="not closed: .* the first near "):
            fill.main([path, "0.1", str(tmp_path / "box.data")])


@pytest.mark.parametrize("between", ("\n", " \t\n", ",\n", "\n\n"))
def test_lines_between_outlines(tmp_path, between):
    """A square with a square hole, whatever blank an export leaves between the two; the second is
    no part of the first. Numbers with exponents are no options."""
    path = tmp_path / "two.csv"
    path.write_text("0,0\n1,0\n1,1\n0,1\n" + between + "0.3,0.3\n0.7,0.3\n0.7,0.7\n0.3,0.7\n")
    fill.main([str(path), "0.1", str(tmp_path / "two.data"), "--origin", "-1e-3", "-2.5E-1"])
    x = atoms(tmp_path / "two.data")[:, 5:7]
    assert len(x) == 100 - 16 and x[:, 1].min() < -0.15
    with pytest.raises(SystemExit, match="fsi fill: .*nowhere"):
        cli.main(["fill", str(path), "0.1", str(tmp_path / "nowhere/two.data")])
