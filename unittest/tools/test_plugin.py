"""The package as a plugin: in a LAMMPS of the same release built without it, results are those of the package compiled in."""

import shutil
import subprocess

import pytest
from scenes import dam_gate, differing, fluid_box, lammps, run, watch

from fsi import dump, paths

PLAIN = paths.ROOT / "build-plain"
SCENE = dam_gate(2)
LOAD = "plugin load fsiplugin.so\n"


def same_options():
    """Options of cmake that make the objects those of the usual build."""
    cache = (paths.BUILD / "CMakeCache.txt").read_text().splitlines()
    return [f"-D{line}" for line in cache if line.startswith(("FSI_NATIVE:", "LAMMPS_SIZES:", "BUILD_MPI:", "LAMMPS_SOURCE_DIR:"))]


@pytest.fixture(scope="module")
def plain():
    """The folder of a LAMMPS without the package, and the plugin: about a minute with the compiler cache of the usual build."""
    for command in (["cmake", "-S", paths.ROOT, "-B", PLAIN, "-G", "Ninja", "-DFSI_COMPILED_IN=OFF", *same_options()], ["cmake", "--build", PLAIN]):
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        assert done.returncode == 0, "\n".join(done.stdout.splitlines()[-20:])
    return PLAIN


def load(build, folder, text, ranks=1, **environment):
    """Runs the LAMMPS of a build folder with the plugin beside the input."""
    folder.mkdir(parents=True, exist_ok=True)
    if not (folder / "fsiplugin.so").exists():
        shutil.copy(PLAIN / "fsiplugin.so", folder)
    return lammps(folder, text, ranks, build=build, environment=environment, scene_data=SCENE.data())


def good(result):
    assert result.status == 0, "\n".join(result.output.splitlines()[-15:])
    return result.frames()[-1]


def expected(folder, text, ranks):
    return run(folder, text, ranks, scene_data=SCENE.data()).frames()[-1]


def test_styles_are_not_compiled_in(plain, tmp_path):
    assert "Unrecognized atom style 'fsi'" in load(plain, tmp_path, "atom_style fsi\n").output


@pytest.mark.parametrize("ranks", [1, 2])
def test_plugin_load(plain, tmp_path, ranks):
    text = SCENE.text("2 * *" if ranks > 1 else "* * *") + watch() + "run 100\n"
    frame = good(load(plain, tmp_path / "plugin", LOAD + text, ranks))
    assert differing(frame, expected(tmp_path / "package", text, ranks)) == []


def test_plugin_path(plain, tmp_path):
    folder = tmp_path / "plugins"
    folder.mkdir()
    shutil.copy(plain / "fsiplugin.so", folder)
    result = load(plain, tmp_path, SCENE.text() + watch() + "run 20\n", LAMMPS_PLUGIN_PATH=str(folder))
    good(result)
    assert "Loaded 1 plugins" in result.output


@pytest.mark.parametrize("solid", ["fsi/solid", "fsi/solid/tl"])
def test_restart(plain, tmp_path, solid):
    """A restart goes on bit for bit with the plugin, too; the total-Lagrangian solid adds a fix of its own."""

    def physics(coeff):
        text = SCENE.physics(coeff)
        if solid == "fsi/solid/tl":
            text = text.replace(f"fsi/solid {SCENE.solid}", "fsi/solid/tl artificial/visc 0.1 0")
            text = text.replace("* * fsi/solid ", "* * fsi/solid/tl ").replace("fix stress all fsi/stress", "")
        return text
    first = LOAD + SCENE.setup() + "read_data scene.data\n" + physics(True) + watch(every=80) + "restart 40 half.*\nrun 80\n"
    whole = good(load(plain, tmp_path, first))
    again = LOAD + "read_restart half.40\n" + physics(False) + watch("again.dump", 80) + "restart 40 other.*\nrun 40\n"
    good(load(plain, tmp_path, again))
    assert differing(dump.read(tmp_path / "again.dump")[-1], whole) == []


def test_clear(plain, tmp_path):
    """The command clear forgets every plugin; loaded again, the second run is the first."""
    text = SCENE.text() + watch("{}.dump") + "run 40\n"
    good(result := load(plain, tmp_path, LOAD + text.replace("{}", "atoms") + "clear\n" + LOAD + text.replace("{}", "second")))
    assert differing(result.frames()[-1], result.frames("second.dump")[-1]) == []


def test_clear_without_loading(plain, tmp_path):
    assert "Unrecognized atom style 'fsi'" in load(plain, tmp_path, LOAD + "clear\natom_style fsi\n").output


def test_unload(plain, tmp_path):
    """Unloading styles in use takes their instances along, and LAMMPS goes on."""
    text = LOAD + SCENE.text() + "run 5\n" + "".join(
        f"plugin unload {kind}\n" for kind in ("pair fsi/solid", "pair fsi/fluid", "fix fsi/wall/mirror", "fix fsi/stress", "fix fsi"))
    result = load(plain, tmp_path, text + "fix 1 all nve\nrun 0\nprint 'still here'\n")
    assert result.status == 0 and "still here" in result.output


def test_hybrid_atom_style(plain, tmp_path):
    text = LOAD + fluid_box(2, atom_style="hybrid fsi ellipsoid").setup() + "print 'entered'\n"
    assert "\nentered" in load(plain, tmp_path, text).output


def test_version_that_differs(plain, tmp_path):
    """A library that says it is another release: refused with both versions, and nothing is registered."""
    library = tmp_path / "lib"
    library.mkdir()
    data = (plain / "liblammps.so.0").resolve().read_bytes()
    version = next(line.split('"')[1] for line in (paths.lammps_source() / "src/version.h").read_text().splitlines()
                   if "define LAMMPS_VERSION" in line)
    other = version[:-1] + ("6" if version[-1] != "6" else "7")
    (library / "liblammps.so.0").write_bytes(data.replace(version.encode() + b"\0", other.encode() + b"\0"))
    result = load(plain, tmp_path, LOAD + "plugin list\natom_style fsi\n", LD_LIBRARY_PATH=str(library))
    assert f"FSI plugin not loaded: it was compiled for LAMMPS version {version}, this is version {other}" in result.output
    assert "style plugin fsi" not in result.output and "Unrecognized atom style 'fsi'" in result.output


def test_package_compiled_in(plain, tmp_path):
    """In a LAMMPS that has the package the plugin changes nothing, and says so."""
    text = LOAD + SCENE.text() + watch() + "run 5\n"
    result = load(paths.BUILD, tmp_path, text)
    good(result)
    assert "FSI plugin not loaded: this LAMMPS has the FSI package compiled in" in result.output
    assert "Overriding" not in result.output


def test_plugin_alone(plain, tmp_path):
    """Configured for a LAMMPS that is there, only the plugin is built, and it is the same one."""
    build = paths.ROOT / "build-plugin"  # beside the usual one, whose objects the compiler cache then knows
    for command in (["cmake", "-S", paths.ROOT, "-B", build, "-G", "Ninja", "-DFSI_BUILD_LAMMPS=OFF", "-DBUILD_OMP=OFF",
                     *same_options()], ["cmake", "--build", build]):
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        assert done.returncode == 0, "\n".join(done.stdout.splitlines()[-20:])
    assert not list(build.rglob("liblammps*"))
    folder = tmp_path / "run"
    folder.mkdir()
    shutil.copy(build / "fsiplugin.so", folder)
    text = SCENE.text() + watch() + "run 40\n"
    frame = good(load(plain, folder, LOAD + text))
    assert differing(frame, expected(tmp_path / "package", text, 1)) == []
