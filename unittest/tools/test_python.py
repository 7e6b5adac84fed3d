"""The Python package by itself: installed by pip, its command line, its readers and converters;
what ParaView would read is decoded anew."""

import base64
import contextlib
import gzip
import os
import re
import shutil
import subprocess
import sys
from xml.etree import ElementTree

import numpy as np
import pytest
from scenes import run

from fsi import animate, cli, dump, launch, log, paths, plot, report, series, vtk

DUMP = """ITEM: TIMESTEP
{step}
ITEM: TIME
{time}
ITEM: NUMBER OF ATOMS
3
ITEM: BOX BOUNDS ff ff pp
0 1
0 1
-0.5 0.5
ITEM: ATOMS id type mol x y vx vy sxx sxy p
3 2 1 0.2 0 0 0 1e5 2e5 300
1 1 0 0 0 1 -1 0 0 100
2 1 0 0.1 0.05 1.5 -2 0 0 {p}
"""
LOG = """LAMMPS (4 Feb 2025)
WARNING: Fix fsi: mind the gap
FSI peak 4.5
Per MPI rank memory allocation (min/avg/max) = 1 | 2 | 3 Mbytes
   Step         v_time
         0   0
       100   0.5
Loop time of 2.0 on 1 procs for 100 steps with 400 atoms
"""


@pytest.fixture
def frames(tmp_path):
    path = tmp_path / "some.dump"
    path.write_text(DUMP.format(step=0, time=0, p=200) + DUMP.format(step=50, time=0.25, p="nan"))
    return path


def test_installed_by_pip(tmp_path, frames):
    """Without network; used from a folder that knows nothing of the repository."""
    shutil.copytree(paths.ROOT / "python", tmp_path / "python",
                    ignore=shutil.ignore_patterns("build", "*.egg-info", "__pycache__"))
    subprocess.run([sys.executable, "-m", "pip", "install", "-q", "--no-index", "--no-deps",
                    "--no-build-isolation", "--target",
                    tmp_path / "site", tmp_path / "python"], check=True)
    env = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "FSI_BUILD_DIR")}
    env["PYTHONPATH"] = str(tmp_path / "site")
    done = subprocess.run([tmp_path / "site/bin/fsi", "dump", frames], cwd=tmp_path / "site",
                          env=env, capture_output=True, text=True, check=True)
    assert "2 frames from t = 0 to 0.25, 3 particles" in done.stdout
    where = subprocess.run([sys.executable, "-c", "import fsi; print(fsi.__file__)"], cwd=tmp_path,
                           env=env, capture_output=True, text=True, check=True)
    assert str(tmp_path / "site") in where.stdout


def decode(array):
    """A DataArray of a .vtu file by the format's definition: base64 of a little-endian UInt64
    length and that many bytes."""
    raw = base64.b64decode(array.text)
    data = raw[8:]
    assert int.from_bytes(raw[:8], "little") == len(data)
    values = np.frombuffer(data,
                           {"Float64": "<f8", "Int64": "<i8", "UInt8": "u1"}[array.get("type")])
    return values.reshape(-1, 3) if array.get("NumberOfComponents") == "3" else values


def read_vtu(path):
    """(the piece, {name: array at points}); the file says of itself what `decode` takes for
    granted."""
    root = ElementTree.parse(path).getroot()
    assert (root.tag == "VTKFile" and [root.get(a) for a in ("type", "byte_order", "header_type")]
            == ["UnstructuredGrid", "LittleEndian", "UInt64"])
    piece = root.find("UnstructuredGrid/Piece")
    assert {a.get("format") for a in piece.iter("DataArray")} == {"binary"}
    return piece, {a.get("Name"): decode(a) for a in piece.find("PointData")}


def test_vtk(frames):
    index = vtk.convert(frames)
    sets = ElementTree.parse(index).getroot().findall("Collection/DataSet")
    assert [float(s.get("timestep")) for s in sets] == [0.0, 0.25]
    piece, data = read_vtu(index.parent / sets[1].get("file"))
    assert piece.get("NumberOfPoints") == piece.get("NumberOfCells") == "3"
    assert set(data) == {"id", "type", "mol", "v", "sxx", "sxy", "p"}
    np.testing.assert_array_equal(data["id"], [1, 2, 3])
    np.testing.assert_array_equal(data["v"], [[1, -1, 0], [1.5, -2, 0], [0, 0, 0]])
    np.testing.assert_array_equal(data["p"], [100, np.nan, 300])
    np.testing.assert_array_equal(decode(piece.find("Points/DataArray")),
                                  [[0, 0, 0], [0.1, 0.05, 0], [0.2, 0, 0]])
    cells = {a.get("Name"): decode(a) for a in piece.find("Cells")}
    np.testing.assert_array_equal(cells["connectivity"], [0, 1, 2])
    np.testing.assert_array_equal(cells["offsets"], [1, 2, 3])
    np.testing.assert_array_equal(cells["types"], [1, 1, 1])  # VTK_VERTEX


def test_vtk_of_what_is_no_dump(tmp_path):
    """An error, and nothing written; a file where the folder would be is named."""
    for name in ("wrong.csv", "hostname"):
        (tmp_path / name).write_text("t,x\n0,1\n")
        with pytest.raises(SystemExit, match=f"{name} has no frames: is it a dump"):
            cli.main(["vtk", str(tmp_path / name)])
    assert sorted(p.name for p in tmp_path.iterdir()) == ["hostname", "wrong.csv"]


def test_vtk_where_a_file_is_in_the_way(frames):
    frames.with_suffix("").write_text("")
    with pytest.raises(SystemExit, match="is a file: name another folder"):
        cli.main(["vtk", str(frames)])


def test_vtk_of_a_run(tmp_path, capsys):
    """Three dimensions, compressed, by the command line: eight atoms that fly straight on are where
    velocity times time puts them."""
    run(tmp_path, """units lj
region box block 0 8 0 8 0 8
create_box 1 box
lattice sc 1
region corner block 0 1 0 1 0 1
create_atoms 1 region corner
mass 1 1
pair_style zero 1
pair_coeff * *
timestep 0.25
fix 1 all nve
velocity all set 1 2 3
variable p atom x+10*y+100*z
dump 1 all custom 2 flight.dump.gz id type x y z vx vy vz v_p
dump_modify 1 time yes sort id format float %.17g colname v_p p
run 4
""")
    cli.main(["vtk", str(tmp_path / "flight.dump.gz")])
    index = tmp_path / "flight/flight.pvd"
    assert capsys.readouterr().out.split() == [str(index)]
    sets = ElementTree.parse(index).getroot().findall("Collection/DataSet")
    assert [float(s.get("timestep")) for s in sets] == [0.0, 0.5, 1.0]
    for one in sets:
        piece, data = read_vtu(index.parent / one.get("file"))
        x = np.array([[i, j, k] for k in (0, 1) for j in (0, 1) for i in (0, 1)]) + float(
            one.get("timestep")) * np.array([1.0, 2.0, 3.0])
        order = np.lexsort(decode(piece.find("Points/DataArray")).T)
        np.testing.assert_array_equal(decode(piece.find("Points/DataArray"))[order], x)
        np.testing.assert_array_equal(data["p"][order], x @ [1.0, 10.0, 100.0])
        np.testing.assert_array_equal(data["v"], np.tile([1.0, 2.0, 3.0], (8, 1)))
        np.testing.assert_array_equal(data["id"], np.arange(1, 9))


def test_species_and_spacing(frames):
    read = dump.read(frames)
    assert animate.species(read) == ((1,), (2,), ())
    assert animate.species(read, {1}) == ((2,), (1,), ())
    assert animate.species(read, wall={1}) == ((), (2,), (1,))
    assert animate.spacing(read[0]) == pytest.approx(np.hypot(0.1, 0.05))


def moved(k, x1, x2, v2=0.0):
    """Frame k of a particle of fluid, one of a wall or fluid, and one of a body."""
    return dump.Frame(k, float(k), None, {"type": np.array([1, 2, 3]), "mol": np.array([0, 0, 1]),
                                          "x": np.array([x1, x2, 2.0]), "y": np.zeros(3),
                                          "vx": np.array([1.0, v2, 0.0])})


def test_walls_are_what_stands_still():
    assert animate.species([moved(0, 0.0, 1.0), moved(1, 0.1, 1.0)]) == ((1,), (3,), (2,))
    # one frame does not tell; it moves; it is about to
    for others in ([], [moved(1, 0.1, 1.1)], [moved(1, 0.1, 1.0, v2=1e-9)]):
        assert animate.species([moved(0, 0.0, 1.0), *others]) == ((1, 2), (3,), ())
    still = [moved(k, 0.0, 1.0) for k in range(2)]
    for frame in still:
        frame["vx"][:] = 0.0
    assert animate.species(still) == ((1, 2), (3,), ())  # nothing has begun to move


@pytest.mark.parametrize("low, high, start", [(0, 1000, 0), (-10, 1000, 0), (900, 1100, 900),
                                              (-500, 1000, -500), (-500, 0, -500)])
def test_where_colors_begin(low, high, start):
    frame = dump.Frame(0, 0.0, None,
                       {"type": np.ones(1001, int), "p": np.linspace(low, high, 1001)})
    (*_, norm, scale, _), = plot._scales([frame], (1,), ())
    assert norm.vmin * scale == pytest.approx(start,
                                              abs=0.006 * (high - low)) and norm.vmax > norm.vmin


def test_animation(frames, tmp_path, monkeypatch, capsys):
    """A stand-in for ffmpeg finds all pictures, numbered, of one size; without any the pictures
    stay."""
    tools = tmp_path / "bin"
    tools.mkdir()
    monkeypatch.setenv("PATH", str(tools))
    cli.main(["animate", str(frames)])
    pictures = sorted((tmp_path / "some").glob("*.png"))
    assert [p.name for p in pictures] == ["00000.png", "00001.png"]
    assert "ffmpeg is not here" in capsys.readouterr().err
    assert len({p.read_bytes()[16:24] for p in pictures}) == 1  # width and height in the header

    fake = tools / "ffmpeg"
    fake.write_text(f"#!{sys.executable}\nimport sys, glob, os\nfrom pathlib import Path\n"
                    "source = Path(sys.argv[sys.argv.index('-i') + 1])\n"
                    "assert source.name == '%05d.png'\n"
                    "Path(sys.argv[-1]).write_text(sys.argv[sys.argv.index('-framerate') + 1] + ' "
                    "' + str(len(list(source.parent.glob('*.png')))))\n")
    fake.chmod(0o755)
    cli.main(["animate", str(frames), str(tmp_path / "a.mp4"), "rate=5"])
    assert (tmp_path / "a.mp4").read_text() == "5.0 2"


def test_command_line(frames, tmp_path, capsys):
    path = tmp_path / "log.lammps"
    path.write_text(LOG)

    def says(*words):
        cli.main([str(w) for w in words])
        return capsys.readouterr().out

    text = says("log", path)
    assert ("400 atoms, 100 steps on 1 ranks in 2 s, 2e+04 particle-steps/s" in text
            and "peak = 4.5" in text and "mind the gap" in text)
    assert says("log", path, "Step", "time") == "Step,time\n0,0\n100,0.5\n"
    says("log", path, "time", "Step", f"plot={tmp_path / 'log.png'}")
    says("dump", frames, f"plot={tmp_path / 'dump.png'}")
    assert all((tmp_path / name).read_bytes().startswith(b"\x89PNG")
               for name in ("log.png", "dump.png"))
    # into a pipe that nobody reads any more
    closed = f"from fsi import cli; cli.main(['dump', {str(frames)!r}])"
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run([sys.executable, "-c", closed], stdout=write, stderr=subprocess.PIPE,
                          env=launch.environment(), check=False)
    os.close(write)
    assert done.returncode == 0 and not done.stderr
    assert "view=" in says("dump", "--help") and "fsi check" in says("--help")
    for words, message in (([], "Usage"),
                           (["log", path, "speed"], "no column speed; it has Step, v_time"),
                           (["dump", path], "no frames"),
                           (["log", tmp_path / "none"], "No such file"),
                           (["lag", path], "no command lag; there are log"),
                           (["vtk"], "fsi vtk DUMP"),
                           (["log", path, "plt=a.png"], "options are plot"),
                           (["log", path, "plot="], "value is missing"),
                           (["dump", frames, "view=x"], "only with plot")):
        with pytest.raises(SystemExit, match=message):
            cli.main([str(w) for w in words])


def test_one_column_is_drawn_over_the_time(tmp_path, monkeypatch, capsys):
    drawn = []
    monkeypatch.setattr(plot, "lines", lambda path, label, value, curves: drawn.append(
        (label, value, [list(c[0]) for c in curves], [list(c[1]) for c in curves])))
    (tmp_path / "log.lammps").write_text(LOG.replace("v_time\n", "v_time v_tip\n").replace(
        "0   0\n", "0   0  3\n").replace("0.5\n", "0.5  4\n"))
    (tmp_path / "tip.csv").write_text("t,tip\n0,1\n2,3\n")
    cli.main(["log", str(tmp_path / "log.lammps"), "tip", "plot=a.png"])
    cli.main(["series", str(tmp_path / "tip.csv"), "tip", "plot=a.png"])
    (tmp_path / "log.lammps").write_text(
        (tmp_path / "log.lammps").read_text().replace("v_time", "Time"))
    cli.main(["log", str(tmp_path / "log.lammps"), "time", "tip", "plot=a.png"])
    assert drawn == [("time", "tip", [[0, 0.5]], [[3, 4]]), ("t", "tip", [[0, 2]], [[1, 3]]),
                     ("time", "tip", [[0, 0.5]], [[3, 4]])]
    (tmp_path / "one.csv").write_text("t\n0\n2\n")
    with pytest.raises(SystemExit, match="one column only"):
        cli.main(["series", str(tmp_path / "one.csv"), "plot=a.png"])


def test_another_python_goes_on_where_the_first_lacks_numpy(frames, tmp_path):
    """A python without packages first on the PATH: the one that is found beside it does the work;
    where there is none the message says what to install."""
    bare = tmp_path / "bare/python3"
    bare.parent.mkdir()
    bare.write_text(f'#!/bin/sh\nexec {sys.executable} -S "$@"\n')  # knows no site-packages
    bare.chmod(0o755)
    env = {k: v for k, v in os.environ.items()
           if k != "PYTHONPATH"} | {"PYTHONPATH": str(paths.ROOT / "python")}
    main = ("import sys; from fsi import __main__ as m; m.able_python = lambda: {}; sys.argv = "
            "['fsi', 'dump', {!r}]; m.main()")
    found = subprocess.run([bare, "-c", main.format(repr(sys.executable), str(frames))], env=env,
                           capture_output=True, text=True, check=False)
    assert found.returncode == 0 and "2 frames" in found.stdout, found.stderr
    none = subprocess.run([bare, "-c", main.format(None, str(frames))], env=env,
                          capture_output=True, text=True, check=False)
    assert (none.returncode != 0 and "has no numpy and no matplotlib" in none.stderr
            and "python3-numpy" in none.stderr)
    # a script of one's own
    own = subprocess.run([bare, "-c", "from fsi import dump"], env=env, capture_output=True,
                         text=True, check=False)
    assert (own.returncode != 0 and "fsi.dump needs numpy, which" in own.stderr.splitlines()[-1]
            and (" has it" in own.stderr or "install it" in own.stderr))
    real = subprocess.run([sys.executable, "-c",
                           "from fsi.__main__ import able_python; print(able_python())"], env=env,
                          capture_output=True, text=True, check=True)
    assert real.stdout.strip() != "None"


def test_views():
    """Corners of a box where drawing says they are: the nearer hides the farther."""
    box = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    frame = dump.Frame(0, 0.0, None, {"x": box[:, 0], "y": box[:, 1], "z": box[:, 2]})

    def look(view):
        (found,), labels = plot.seen([frame], view)
        return np.column_stack([found["x"], found["y"], found["depth"]]), labels

    for view, across, up, near in (("z", box[:, 0], box[:, 1], box[:, 2]),
                                   ("y", box[:, 0], box[:, 2], -box[:, 1]),
                                   ("x", box[:, 1], box[:, 2], box[:, 0]),
                                   ("0,0", box[:, 0], box[:, 2], -box[:, 1]),
                                   ("90,0", box[:, 1], box[:, 2], box[:, 0]),
                                   ("0,90", box[:, 0], box[:, 1], box[:, 2]),
                                   ("0,0,y", box[:, 0], box[:, 1], box[:, 2]),
                                   ("0,0,x", box[:, 1], box[:, 0], -box[:, 2])):
        np.testing.assert_allclose(look(view)[0], np.column_stack([across, up, near]), atol=1e-15,
                                   err_msg=view)
    turned, labels = look("30,20")
    assert labels is None and look("x")[1] == ("y [m]", "z [m]")
    assert turned[7, 1] > turned[6, 1]  # z is up
    np.testing.assert_allclose(turned @ turned.T, box @ box.T, atol=1e-14)  # a rotation
    for view in ("w", "1", "1,2,w", "1,2,z,3", "a,b"):
        with pytest.raises(ValueError, match="AZIMUTH"):
            plot.seen([frame], view)


def test_pictures_in_three_dimensions(tmp_path, capsys):
    path = tmp_path / "cube.dump"
    path.write_text("".join(DUMP.format(step=k, time=k, p=k).replace("x y vx vy sxx sxy p",
                                                                     "x y z vx vy vz p")
                            for k in range(9)))
    for words in (["view=30,20"], ["view=y", "color=speed", "types=1"],
                  ["frames=2", "solid=1,2", "color=vx"]):
        cli.main(["dump", str(path), f"plot={tmp_path / 'a.png'}", *words])
        assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    assert [frame.step for frame in dump.some(path, 3)] == [0, 4, 8]
    for words, message in ((["types=7"], "no such particles"),
                           (["types=a"], "atom types are needed"), (["color=q"], "no column q"),
                           (["view=w"], "AZIMUTH"),
                           (["frames=0"], "whole number")):
        with pytest.raises(SystemExit, match=message):
            cli.main(["dump", str(path), f"plot={tmp_path / 'a.png'}", *words])


def test_errors_below_zero_are_drawn(tmp_path, monkeypatch):
    """By their size, hollow; a logarithmic axis would leave them out."""
    drawn = []
    whole = plot.picture

    @contextlib.contextmanager
    def kept(*a):
        with whole(*a) as figure:
            yield figure
            drawn.append(figure)

    monkeypatch.setattr(plot, "picture", kept)
    plot.errors(tmp_path / "a.png", "n", "error",
                [([3, 5, 10], [-0.9, 0.3, -0.05], "one", plot.BLUE)])
    line, above, below, _ = drawn[0].axes[0].lines
    np.testing.assert_allclose(line.get_ydata(), [0.9, 0.3, 0.05])
    assert list(above.get_ydata()) == [0.3] and list(below.get_ydata()) == [
        0.9, 0.05] and below.get_markerfacecolor() == "white"


def test_noisy_curves_have_their_means(tmp_path, monkeypatch):
    """A sine of the window's period is gone, a constant stays; the axis says which is which."""
    drawn = []
    monkeypatch.setattr(plot, "packed", lambda file: b"")
    monkeypatch.setattr(plot, "Figure",
                        lambda *a, figure=plot.Figure, **k: drawn.append(figure(*a, **k))
                        or drawn[-1])
    x = np.arange(0.0, 2.0, 0.01)
    plot.noisy(tmp_path / "a.png", "t [s]", [
        ("drag", [(x, 3.0 + np.sin(20 * np.pi * x), "computed", plot.BLUE)], (), [(3.0, "exact")])],
               0.1)
    raw, smooth, _ = drawn[0].axes[0].lines
    assert np.ptp(raw.get_ydata()) > 1.8 and np.abs(smooth.get_ydata()[10:-10] - 3.0).max() < 1e-12
    assert "running means over 0.1" in drawn[0].axes[0].get_xlabel()


def test_depth_decides_who_is_seen():
    """Two particles at one place of the picture: the color of the nearer is seen, as bright as a
    sphere's middle under that light; no other."""
    frame = dump.Frame(0, 0.0, None, {"type": np.array([1, 2, 1]), "x": np.zeros(3),
                                      "y": np.zeros(3), "depth": np.array([2.0, 1.0, 0.0]),
                                      "p": np.array([0.0, 0.0, 1.0]), "vonmises": np.zeros(3)})
    scales = plot._scales([frame], (1,), (2,))
    with plot.matplotlib.rc_context():
        axes = plot.Figure().add_subplot()
        plot._particles(axes, frame, scales, 0.1, ((-0.1, 0.1), (-0.1, 0.1)))
    pixels = axes.images[0].get_array()
    middle = pixels[pixels.shape[0] // 2, pixels.shape[1] // 2]
    np.testing.assert_allclose(middle[:3] / middle[:3].max(),
                               np.divide(plot.matplotlib.colormaps["viridis"](0.0)[:3],
                                         plot.matplotlib.colormaps["viridis"](0.0)[2]),
                               atol=0.02)


def test_report(tmp_path, frames):
    """All of a folder in one file: figures, warnings, pictures, curves and costs, nothing from
    elsewhere."""
    folder = tmp_path / "run"
    folder.mkdir()
    log = LOG.replace("Per MPI",
                      "FSI: Wendland C2, h = 1.5 dx\n  on: \n    diffusion <0.1>\nPer MPI") + (
        "Performance: 1\nMPI task timing breakdown:\nSection |  min time\n-----\nPair    | 1.5\n"
        "Other   | 0.5\n\nNlocal: 1\n")
    (folder / "log.lammps").write_text(log.replace("         0   0\n",
                                                   "         0   0\n        50   0.25\n"))
    (folder / "tip.csv").write_text("time,tip\n0,1\n1,2\n2,3\n")
    shutil.copyfile(frames, folder / "some.dump")
    cli.main(["report", str(folder)])
    page = (folder / "report.html").read_text()
    for text in ("400 particles, 100 steps", "<td>peak</td>", "mind the gap",
                 "diffusion &lt;0.1&gt;", "Pair    | 1.5", "tip (tip.csv)",
                 "some.dump"):
        assert text in page, text
    assert not [source for source in re.findall(r'(?:src|href)="([^"]{0,30})', page)
                if not source.startswith("data:image/png;base64")]
    for data in re.findall(r'src="data:image/png;base64,([^"]*)"', page):
        assert base64.b64decode(data).startswith(b"\x89PNG")
    (folder / "summary.json").write_text('{"scene": "x", "figures": [{"name": "peak", "value": '
                                         '4.5, "unit": "mm", "reference": 4.0, "source": "theory", '
                                         '"relative_error": 0.125, "target": 0.1, "met": false}], '
                                         '"cases": {"fine": {"particles": 7, "steps": 8, '
                                         '"cpu_seconds": 9.0}}}')
    (folder / "shot.png").write_bytes(b"\x89PNGmine")
    page = report.write(folder, tmp_path / "other.html").read_text()
    assert '+12.5 %' in page and "missed" in page and base64.b64encode(
        b"\x89PNGmine").decode() in page and "some.dump" not in page and "<td>fine</td>" in page
    with pytest.raises(SystemExit, match="neither log.lammps nor summary.json"):
        cli.main(["report", str(tmp_path)])


def test_report_of_a_log_with_another_name(tmp_path):
    """The only log.* of a folder is found; of two one must be named."""
    (tmp_path / "log.viv").write_text(LOG)
    cli.main(["report", str(tmp_path)])
    assert "400 particles, 100 steps" in (tmp_path / "report.html").read_text()
    (tmp_path / "log.other").write_text(LOG.replace("400", "300"))
    with pytest.raises(SystemExit, match="more than one log: log=log.other or log=log.viv"):
        cli.main(["report", str(tmp_path)])
    cli.main(["report", str(tmp_path), "log=log.other"])
    assert "300 particles" in (tmp_path / "report.html").read_text()
    with pytest.raises(SystemExit, match="has no log log.none"):
        cli.main(["report", str(tmp_path), "log=log.none"])


def test_mean_of_a_steady_column(tmp_path, capsys):
    """Uneven steps, noise that has the mean 0; a column that still grows is said to. Two spacings
    with errors of first and of second order."""
    rng = np.random.default_rng(5)
    t = np.sort(
        np.concatenate([[0.0, 2.0], rng.uniform(0.0, 1.0, 3000), rng.uniform(1.0, 2.0, 300)]))
    for name, value in (("coarse", 5.0 - 2.0 * 0.2), ("fine", 5.0 - 2.0 * 0.1)):
        y = value + 0.01 * np.sin(200.0 * t) - 3.0 * np.exp(-t / 0.1)
        np.savetxt(tmp_path / f"{name}.csv", np.column_stack([t, y, t]), delimiter=",",
                   header="time,tip,grows", comments="")
        mean, error, change = series.steady(t[t >= 1.0], y[t >= 1.0])
        assert abs(mean - value) < 1e-3 and error < 1e-3 and abs(change) < 2e-3
    files = [str(tmp_path / f"{name}.csv") for name in ("fine", "coarse")]
    cli.main(["mean", *files, "tip", "from=1", "dx=0.1,0.2"])
    said = capsys.readouterr().out
    assert "tip = 4.8 +-" in said and "tip = 4.6 +-" in said and "not steady" not in said
    low, high = map(float, re.search(r"limit (\S+) to (\S+) ", said).groups())
    assert low == pytest.approx(4.8 + 0.2 / 3.0, abs=2e-3) and high == pytest.approx(5.0, abs=2e-3)
    assert re.search(r"dx = 0.1 is off by -0.067 to -0.2, -1.4 to -4.0 %", said)
    cli.main(["mean", files[0], "grows"])
    assert "not steady" in capsys.readouterr().out
    for words in (["tip"], [files[0], "tip", "dx=0"], [*files, "tip", "dx=0.1"],
                  [*files, "tip", "dx=0.1,0.1"], [files[0], "tip", "from=x"],
                  [files[0], "tip", "from=1.9999"],
                  [files[0], "other"]):
        with pytest.raises(SystemExit):
            cli.main(["mean", *words])


def test_frequency(tmp_path, capsys):
    """Four periods: the window's bias is below 1 %; a drift and a smaller, faster swing change
    nothing more."""
    t = np.arange(0.0, 2.0, 0.01)**1.01  # unevenly spaced
    for f in (2.1, 3.7):
        y = 5.0 + 0.3 * t + np.cos(2 * np.pi * f * t) + 0.3 * np.sin(2 * np.pi * 11 * t)
        assert series.frequency(t, y) == pytest.approx(f, rel=0.01)
    (tmp_path / "tip.csv").write_text("time,tip\n" + "".join(f"{a},{b}\n" for a, b in zip(t, y)))
    cli.main(["frequency", str(tmp_path / "tip.csv"), "tip", "0.2"])
    text = capsys.readouterr().out
    assert float(text.split()[0]) == pytest.approx(3.7, rel=0.01)
    assert "last 3 of " in text
    plain, fitted = (float(value) for value in re.findall(r"amplitude +([\d.]+)", text))
    assert fitted == pytest.approx(plain, abs=0.05)  # the faster swing is almost the third harmonic
    for words, message in ((["tip", "0", "0.01"], "has 2 rows"), ([], "takes a column"),
                           (["speed"], "no column speed")):
        with pytest.raises(SystemExit, match=message):
            cli.main(["frequency", str(tmp_path / "tip.csv"), *words])
    with pytest.raises(ValueError, match="constant"):
        series.frequency(t, np.ones(len(t)))


def test_swing_in_noise():
    """A signal of two harmonics, of uneven steps, in sound of twice its size and another frequency,
    and noise: its own mean and amplitude. Of 900 rows of noise of 0.77 (RMS) a fit leaves 0.036 in
    each of nine coefficients, 0.1 in the curve."""
    rng = np.random.default_rng(2)
    t = np.sort(rng.uniform(0, 4.0, 900))
    phase = 2 * np.pi * 2.0 * t
    wave = 3.0 + 0.5 * np.sin(phase) + 0.2 * np.cos(2 * phase)
    top = max(0.5 * np.sin(np.linspace(0, 7, 9999)) + 0.2 * np.cos(2 * np.linspace(0, 7, 9999)))
    mean, amplitude = 3.0 + (top - 0.7) / 2, (top + 0.7) / 2
    assert series.swing(t, wave, 2.0) == pytest.approx((mean, amplitude), abs=1e-4)
    assert series.swing(t, wave + np.sin(2 * np.pi * 23.3 * t) + rng.normal(0, 0.3, len(t)),
                        2.0) == pytest.approx((mean, amplitude), abs=0.15)
    with pytest.raises(ValueError):
        series.swing(t, wave, 0.1)


def test_periods():
    """Mean and amplitude of a triangle wave are those of its corners, whatever its past; noise of a
    tenth makes no periods, and moves corners by no more."""
    t = np.arange(0.0, 10.0, 1e-3)
    wave = 1.5 + 2.0 * np.abs(2.0 * ((1.25 * t) % 1.0) - 1.0) * np.where(t < 3.0, 0.2, 1.0)
    found = series.periodic(t, wave, 4)
    assert found["count"] >= 8 and [len(found[name])
                                    for name in ("mean", "amplitude", "frequency")] == [4, 4, 4]
    # corners lie between samples: 2 x 2.5/s x 1e-3 s / 2
    np.testing.assert_allclose(found["mean"], 2.5, atol=2e-3)
    np.testing.assert_allclose(found["amplitude"], 1.0, atol=3e-3)
    np.testing.assert_allclose(found["frequency"], 1.25, rtol=1e-3)
    noisy = series.periodic(t, wave + np.random.default_rng(1).uniform(-0.1, 0.1, len(t)), 4)
    # 0.1 / slope 5 at both ends of 0.8 s is 5 %, averaged over some 40 crossings
    np.testing.assert_allclose(noisy["frequency"], 1.25, rtol=0.02)
    np.testing.assert_allclose(noisy["mean"], 2.5, atol=0.1)
    np.testing.assert_allclose(noisy["amplitude"], 1.0, atol=0.11)
    assert series.periodic(t, 3.0 + 0.0 * t) is None
    assert series.periodic(t, np.exp(-t)) is None


def test_last_rise():
    """sin(2 pi f (t - 0.07)) with its mean, an overtone that begins elsewhere, and noise, f = 2:
    three whole periods before t = 10 begin at 8.07."""
    t = np.linspace(0.0, 10.0, 4001)
    wave = 5.0 + np.sin(4 * np.pi * (t - 0.07)) + 0.4 * np.cos(8 * np.pi * t)
    noise = np.random.default_rng(3).normal(0, 0.3, len(t))
    assert series.last_rise(t, wave, 2.0, 3) == pytest.approx(8.07, abs=1e-3)
    # 0.3 sqrt(2/600) of a radian is 0.0014
    assert series.last_rise(t, wave + noise, 2.0, 3) == pytest.approx(8.07, abs=0.01)
    assert series.last_rise(t[t < 9.57], wave[t < 9.57], 2.0, 3) == pytest.approx(7.57, abs=1e-3)


def test_swing_that_has_not_settled(tmp_path, capsys):
    t = np.arange(0.0, 5.0, 0.01)
    (tmp_path / "tip.csv").write_text(
        "time,tip\n" + "".join(f"{a},{np.exp(0.1 * a) * np.sin(6.0 * a)}\n" for a in t))
    cli.main(["frequency", str(tmp_path / "tip.csv"), "tip", "periods=2"])
    text = capsys.readouterr().out
    assert "last 2 of " in text and "not settled" in text and "not one swing" not in text
    (tmp_path / "tip.csv").write_text("time,tip\n" + "".join(
        f"{a},{np.sin(6.0 * a) if a < 4.0 else 0.5 * np.sin(60.0 * a)}\n" for a in t))
    cli.main(["frequency", str(tmp_path / "tip.csv"), "tip", "periods=2"])
    assert "not one swing: 9.5" in capsys.readouterr().out  # 60/2 pi


def test_what_a_frame_is_made_of():
    """Water 10 x 6, and a plate 3 x 20 that lies aslant with its own, finer spacing; a single
    particle has no extent."""
    block = lambda n, m, dx: dx * np.stack(np.meshgrid(np.arange(n), np.arange(m)),
                                           -1).reshape(-1, 2).astype(float)
    turn = np.array([[np.cos(0.5), -np.sin(0.5)], [np.sin(0.5), np.cos(0.5)]])
    x = np.concatenate([block(10, 6, 0.1), 5.0 + block(3, 20, 0.04) @ turn.T, [[9.0, 9.0]]])
    kind, mol = np.repeat([1, 2, 3], (60, 60, 1)), np.repeat([0, 7, 0], (60, 60, 1))
    found = dump.bodies(dump.Frame(0, 0.0, None, {"type": kind, "mol": mol, "x": x[:, 0],
                                                  "y": x[:, 1], "z": 0.0 * kind}))
    assert [(name, number) for name, number, _ in found] == [("type 1", 60), ("type 3", 1),
                                                             ("body 7", 60)]
    np.testing.assert_allclose(found[0][2], [6, 10])
    np.testing.assert_allclose(found[2][2], [3, 20])
    assert found[1][2] == []


def test_animation_says_what_the_dump_lacks(tmp_path):
    path = tmp_path / "bare.dump"
    path.write_text(DUMP.format(step=0, time=0, p=1).replace(" p\n", " c_1[1]\n"))
    with pytest.raises(SystemExit, match="colname"):
        cli.main(["animate", str(path)])


LATTICE = """units lj
region box block 0 4 0 4 0 4
lattice sc 1
create_box 1 box
create_atoms 1 box
mass 1 1
pair_style zero 1
pair_coeff * *
fix 1 all nve
"""


def test_files_of_fix_ave_time_and_print(tmp_path):
    """As LAMMPS itself writes them, in both modes; a cut-off end is left out."""
    run(tmp_path, LATTICE + """velocity all set 1 2 0
compute v all reduce sum vx vy
variable t equal step*dt
fix a all ave/time 1 2 4 c_v[1] v_t file scalar.ave
fix b all ave/time 1 1 4 c_v mode vector file vector.ave
fix c all print 4 "${t},$(step)" file print.csv title "time,step" screen no
run 8
""")
    scalar = series.read_any(tmp_path / "scalar.ave")
    np.testing.assert_array_equal(scalar.time, [4, 8])
    np.testing.assert_allclose(scalar["c_v[1]"], 64)
    np.testing.assert_allclose(scalar["v_t"], [0.0175, 0.0375], rtol=1e-6)
    vector = series.rows(series.read_any(tmp_path / "vector.ave").columns)
    np.testing.assert_allclose(vector["c_v[1]"], [64, 64, 64])
    np.testing.assert_allclose(vector["c_v[2]"], [128, 128, 128])
    np.testing.assert_array_equal(vector["TimeStep"], [0, 4, 8])
    np.testing.assert_array_equal(series.read_any(tmp_path / "print.csv")["step"], [0, 4, 8])
    text = (tmp_path / "vector.ave").read_text()
    (tmp_path / "cut.ave").write_text(text[:text.rindex("\n", 0, -1)])
    assert len(series.read_ave(tmp_path / "cut.ave").time) == 2
    with pytest.raises(ValueError, match="not a file of fix ave/time"):
        series.read_ave(tmp_path / "print.csv")


def test_files_that_runs_go_on_with(tmp_path):
    """LAMMPS writes the titles again where a continued run appends; rows beyond its start are of
    the run that was given up."""
    deck = LATTICE + """velocity all set {v} 2 0
compute v all reduce sum vx vy
reset_timestep {start}
variable v equal c_v[1]/64
fix a all ave/time 4 1 4 c_v[1] {how} scalar.ave
fix b all ave/time 4 1 4 c_v mode vector {how} vector.ave
fix c all print 4 "$(step),$(v_v)" {how} print.csv title "step,v" screen no
run {n}
"""
    run(tmp_path, deck.format(v=1, start=0, how="file", n=12))
    with (tmp_path / "print.csv").open("a") as file:
        file.write("16,1.0")  # it was killed
    run(tmp_path, deck.format(v=3, start=8, how="append", n=12))
    found = series.read_any(tmp_path / "print.csv")
    np.testing.assert_array_equal(found.time, [0, 4, 8, 12, 16, 20])
    np.testing.assert_allclose(found["v"], [1, 1, 3, 3, 3, 3])
    found = series.read_any(tmp_path / "scalar.ave")
    np.testing.assert_array_equal(found.time, [0, 4, 8, 12, 16, 20])
    np.testing.assert_allclose(found["c_v[1]"], 64 * np.array([1, 1, 3, 3, 3, 3]))
    found = series.rows(series.read_any(tmp_path / "vector.ave").columns)
    np.testing.assert_allclose(found["c_v[1]"], 64 * np.array([1, 1, 3, 3, 3, 3]))


def test_runs_without_a_new_setup(tmp_path):
    """`pre no` leaves out the line of memory before the table, `post no` LAMMPS' times after it."""
    run(tmp_path, LATTICE + """variable t equal step*2
thermo 2
thermo_style custom step v_t
run 4
print "these are words"
run 6 pre no post no
run 2 pre no
""")
    found = log.read(tmp_path / "log.lammps")
    assert [r.steps for r in found.finished] == [4, 6, 2]
    assert [bool(r.times) for r in found.runs] == [True, False, True]
    steps = [0, 2, 4, 4, 6, 8, 10, 10, 12]
    np.testing.assert_array_equal(found.column("Step"), steps)
    np.testing.assert_array_equal(found.column("v_t"), np.multiply(2, steps))


def test_series_without_titles(tmp_path):
    (tmp_path / "print.csv").write_text("# of fix print\n0,1.5\n1e-3,-2\n2e-3,3\n")
    with pytest.raises(ValueError, match="begins with numbers: expected names of columns"):
        series.read(tmp_path / "print.csv")


@pytest.mark.parametrize("style", ["", "thermo_modify line multi", "thermo_modify line yaml"])
def test_thermo_styles(tmp_path, style):
    run(tmp_path, LATTICE + f"""variable t equal step*2
thermo 2
thermo_style custom step v_t
{style}
run 4
run 2 pre no
""")
    found = log.read(tmp_path / "log.lammps")
    np.testing.assert_array_equal(found.column("v_t"), [0, 4, 8, 8, 12])
    assert found.runs[0].thermo.keys() - {"CPU"} == {"Step", "v_t"}


@pytest.mark.parametrize("cut", (0.95, 0.7, 0.52))
@pytest.mark.parametrize("name", ("some.dump", "some.dump.gz"))
def test_dump_that_is_cut_off(tmp_path, frames, capsys, name, cut):
    """Of a run that was killed: in a row, in the header, in what gzip had written."""
    text = frames.read_bytes()
    text = text if name == "some.dump" else gzip.compress(text, 0)
    (tmp_path / name).write_bytes(text[:int(cut * len(text))])
    with pytest.warns(UserWarning, match="the last frame is incomplete and left out"):
        cli.main(["dump", str(tmp_path / name)])
    assert "1 frames from t = 0 to 0, 3 particles" in capsys.readouterr().out


def test_dumps_of_other_decks(tmp_path, frames, capsys):
    """Columns of words; frames without particles; no positions."""
    lines = frames.read_text().replace("mol x", "mol element x").splitlines()
    words = tmp_path / "words.dump"
    words.write_text("\n".join(re.sub(r"^(\d \d \d )", r"\1H2O ", line) for line in lines) + "\n")
    assert [list(f["vx"]) for f in dump.read(words)] == [list(f["vx"]) for f in dump.read(frames)]
    nothing = "\n".join(DUMP.format(step=9, time=0.1, p=0).splitlines()[:-3]).replace(
        "ATOMS\n3", "ATOMS\n0") + "\n"
    empty = tmp_path / "empty.dump"
    for text in (nothing + frames.read_text(), frames.read_text() + nothing):
        empty.write_text(text)
        cli.main(["dump", str(empty)])
        assert "3 frames" in capsys.readouterr().out
        cli.main(["dump", str(empty), f"plot={tmp_path / 'empty.png'}"])
        assert (tmp_path / "empty.png").stat().st_size > 0
        assert vtk.convert(empty).exists()
    empty.write_text(nothing)
    with pytest.raises(SystemExit, match="the dump has no particles"):
        cli.main(["dump", str(empty), f"plot={tmp_path / 'empty.png'}"])
    unwrapped = tmp_path / "unwrapped.dump"
    unwrapped.write_text(frames.read_text().replace("x y vx", "xu yu vx"))
    for command in (["vtk", str(unwrapped)], ["dump", str(unwrapped), "plot=none.png"]):
        with pytest.raises(SystemExit, match="has no column.* x and .*it has .*xu, yu"):
            cli.main(command)
