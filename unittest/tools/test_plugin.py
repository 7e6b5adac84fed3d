"""The package as a plugin: in a LAMMPS of the same release built without it, results are those of
the package compiled in."""

import re
import shutil
import subprocess

import pytest
from scenes import dam_gate, differing, fluid_box, lammps, run, watch

from fsi import dump, launch, paths

PLAIN = paths.ROOT / "build-plain"
SCENE = dam_gate(2)
LOAD = "plugin load fsiplugin.so\n"


def same_options():
    """Options of cmake that make the objects those of the usual build."""
    cache = (paths.BUILD / "CMakeCache.txt").read_text().splitlines()
    return [f"-D{line}" for line in cache if line.startswith(
        ("FSI_NATIVE:", "LAMMPS_SIZES:", "BUILD_MPI:", "LAMMPS_SOURCE_DIR:"))]


@pytest.fixture(scope="module")
def plain():
    """The folder of a LAMMPS without the package, and the plugin: about a minute with the compiler
    cache of the usual build."""
    for command in (["cmake", "-S", paths.ROOT, "-B", PLAIN, "-G", "Ninja", "-DFSI_COMPILED_IN=OFF",
                     *same_options()], ["cmake", "--build", PLAIN]):
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              check=False)
        assert done.returncode == 0, "\n".join(done.stdout.splitlines()[-20:])
    return PLAIN


def load(build, folder, text, ranks=1, **environment):
    """Runs the LAMMPS of a build folder with the plugin beside the input."""
    folder.mkdir(parents=True, exist_ok=True)
    if not (folder / "fsiplugin.so").exists():
        shutil.copy(PLAIN / "fsiplugin.so", folder)
    return lammps(folder, text, ranks, build=build, environment=environment,
                  scene_data=SCENE.data())


def good(result):
    assert result.status == 0, "\n".join(result.output.splitlines()[-15:])
    return result.frames()[-1]


def expected(folder, text, ranks):
    return run(folder, text, ranks, scene_data=SCENE.data()).frames()[-1]


def test_styles_are_not_compiled_in(plain, tmp_path):
    assert "Unrecognized atom style 'fsi'" in load(plain, tmp_path, "atom_style fsi\n").output


def test_it_has_every_style(plain, tmp_path):
    styles = {(kind.lower(), name) for package in ("FSI", "FSI-CLASSIC", "OPENMP")
              for path in (paths.ROOT / "src" / package).glob("*fsi*.h")
              for kind, name in re.findall(r"^(Pair|Fix|Compute|Command)Style\(([\w/]+),",
                                           path.read_text(), re.MULTILINE)}
    result = load(plain, tmp_path, LOAD + "plugin list\n")
    assert (len(styles) > 25 and set(re.findall(r": +(\w+) style plugin ([\w/]+)", result.output))
            == styles)


@pytest.mark.parametrize("ranks", [1, 2])
def test_plugin_load(plain, tmp_path, ranks):
    text = SCENE.text("2 * *" if ranks > 1 else "* * *") + watch() + "run 100\n"
    frame = good(load(plain, tmp_path / "plugin", LOAD + text, ranks))
    assert differing(frame, expected(tmp_path / "package", text, ranks)) == []


def test_plugin_path(plain, tmp_path):
    folder = tmp_path / "plugins"
    folder.mkdir()
    shutil.copy(plain / "fsiplugin.so", folder)
    result = load(plain, tmp_path, SCENE.text() + watch() + "run 20\n",
                  LAMMPS_PLUGIN_PATH=str(folder))
    good(result)
    assert "Loaded 1 plugins" in result.output


@pytest.mark.parametrize("solid", ["fsi/solid", "fsi/solid/tl"])
def test_restart(plain, tmp_path, solid):
    """A restart goes on bit for bit with the plugin, too; the total-Lagrangian solid adds a fix of
    its own."""

    def physics(coeff):
        text = SCENE.physics(coeff)
        if solid == "fsi/solid/tl":
            text = text.replace(f"fsi/solid {SCENE.solid}", "fsi/solid/tl artificial/visc 0.1 0")
            text = text.replace("* * fsi/solid ",
                                "* * fsi/solid/tl ").replace("fix stress all fsi/stress", "")
        return text
    first = LOAD + SCENE.setup() + "read_data scene.data\n" + physics(True) + watch(
        every=80) + "restart 40 half.*\nrun 80\n"
    whole = good(load(plain, tmp_path, first))
    again = LOAD + "read_restart half.40\n" + physics(False) + watch(
        "again.dump", 80) + "restart 40 other.*\nrun 40\n"
    good(load(plain, tmp_path, again))
    assert differing(dump.read(tmp_path / "again.dump")[-1], whole) == []


def test_clear(plain, tmp_path):
    """The command clear forgets every plugin; loaded again, the second run is the first."""
    text = SCENE.text() + watch("{}.dump") + "run 40\n"
    good(result := load(plain, tmp_path, LOAD + text.replace("{}", "atoms") + "clear\n" + LOAD
                        + text.replace("{}", "second")))
    assert differing(result.frames()[-1], result.frames("second.dump")[-1]) == []


def test_clear_without_loading(plain, tmp_path):
    assert "Unrecognized atom style 'fsi'" in load(plain, tmp_path,
                                                   LOAD + "clear\natom_style fsi\n").output


def test_unload(plain, tmp_path):
    """Unloading styles in use takes their instances along, and LAMMPS goes on."""
    text = LOAD + SCENE.text() + "run 5\n" + "".join(
        f"plugin unload {kind}\n" for kind in ("pair fsi/solid", "pair fsi/fluid",
                                               "fix fsi/wall/mirror", "fix fsi/stress", "fix fsi"))
    result = load(plain, tmp_path, text + "fix 1 all nve\nrun 0\nprint 'still here'\n")
    assert result.status == 0 and "still here" in result.output


def test_hybrid_atom_style(plain, tmp_path):
    text = LOAD + fluid_box(2, atom_style="hybrid fsi ellipsoid").setup() + "print 'entered'\n"
    assert "\nentered" in load(plain, tmp_path, text).output


def version():
    return next(line.split('"')[1]
                for line in (paths.lammps_source() / "src/version.h").read_text().splitlines()
                if "define LAMMPS_VERSION" in line)


def another():
    """Of another release, as long."""
    return version()[:-1] + ("6" if version()[-1] != "6" else "7")


def other_release(plain, folder):
    """A folder with a library that says it is another release."""
    library = folder / "lib"
    library.mkdir()
    data = (plain / "liblammps.so.0").resolve().read_bytes()
    (library / "liblammps.so.0").write_bytes(data.replace(version().encode() + b"\0",
                                                          another().encode() + b"\0"))
    return library


def test_version_that_differs(plain, tmp_path):
    """Refused with both versions, and nothing is registered."""
    library = other_release(plain, tmp_path)
    result = load(plain, tmp_path, LOAD + "plugin list\natom_style fsi\n",
                  LD_LIBRARY_PATH=str(library))
    assert (f"FSI plugin not loaded: it was compiled for LAMMPS version {version()}, this is "
            f"version {another()}" in result.output)
    assert ("style plugin fsi" not in result.output
            and "Unrecognized atom style 'fsi'" in result.output)


def test_package_compiled_in(plain, tmp_path):
    """In a LAMMPS that has the package the plugin changes nothing, and says so."""
    text = LOAD + SCENE.text() + watch() + "run 5\n"
    result = load(paths.BUILD, tmp_path, text)
    good(result)
    assert "FSI plugin not loaded: this LAMMPS has the FSI package compiled in" in result.output
    assert "Overriding" not in result.output


# ---- tools/setup --lammps, where LAMMPS is installed ----

def run_setup(folder, *words, **environment):
    """tools/setup with a build folder: (status, what it says)."""
    # which names the usual build
    own = {name: value for name, value in launch.environment().items() if name != "LD_LIBRARY_PATH"}
    done = subprocess.run([paths.ROOT / "tools/setup", *words],
                          env={**own, "FSI_BUILD_DIR": str(folder), **environment},
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, check=False)
    return done.returncode, done.stdout


def source():
    return {"LAMMPS_SOURCE_DIR": str(paths.lammps_source())}


def test_setup_for_an_installed_lammps(plain, tmp_path):
    """Only the plugin is built, it is the same one, and build/lmp is that LAMMPS with it. Of
    another release: refused when it starts."""
    # beside the usual one, whose objects the compiler cache then knows
    build = paths.ROOT / "build-plugin"
    shutil.rmtree(build, ignore_errors=True)
    status, said = run_setup(build, "--lammps", plain / "lmp", **source())
    assert status == 0 and f"{build}/lmp is {plain}/lmp with the plugin" in said, said
    assert not list(build.rglob("liblammps*"))
    text = SCENE.text() + watch() + "run 40\n"
    frame = good(lammps(tmp_path / "run", text, build=build,
                        environment={"LD_LIBRARY_PATH": str(plain)}, scene_data=SCENE.data()))
    assert differing(frame, expected(tmp_path / "package", text, 1)) == []
    status, said = run_setup(build, LD_LIBRARY_PATH=str(other_release(plain, tmp_path)), **source())
    assert status == 1 and re.search(r"FSI plugin not loaded: it was compiled for LAMMPS version "
                                     r".*, this is version .*: compile it with", said), said
    assert run_setup(build, "--tests", **source()) == (
        1, f"setup: {build} holds the plugin alone: the tests need LAMMPS built here, in another "
        "folder "
                                                      "(FSI_BUILD_DIR)\n")


@pytest.mark.parametrize("change, says", [
    (("- RELEASE", "- 29 Aug 2024 - Update 1"), "is LAMMPS 29 Aug 2024, the sources are LAMMPS "
     "SOURCES: a plugin needs the sources of the same release"),
    (("- RELEASE", "- RELEASE - Update 2"), "built without LAMMPS' package PLUGIN"),
    (("RIGID", "PLUGIN RIGID fsi/fluid"), "has the package already"),
    (("Simulator -", "Simulator"), "names no release of LAMMPS")])
def test_setup_refuses(tmp_path, change, says):
    """Before anything is installed, downloaded or built, in one line."""
    about = ("Large-scale Atomic/Molecular Massively Parallel Simulator - RELEASE\n\n"
             "Installed packages:\n\nRIGID \n\n"
             "List of individual style options included in this LAMMPS executable\nplugin PLUGIN\n")
    program = tmp_path / "lmp"
    of_tree = re.search('LAMMPS_VERSION "(.*)"',
                        (paths.lammps_source() / "src/version.h").read_text())[1]
    obtained = {"LAMMPS_SOURCE_DIR": ""}
    for release, sources, environment in ((of_tree, of_tree, source()),
                                          ("4 Feb 2025", "4 Feb 2025", obtained),
                                          ("4 Jul 2026", "4 Feb 2025", obtained)):
        answer = about.replace(*change).replace("RELEASE", release)
        program.write_text(f"#!/bin/sh\ncat <<'END'\n{answer}END\n")
        program.chmod(0o755)
        status, said = run_setup(tmp_path / "build", "--lammps", program, **environment)
        assert status == 1 and says.replace("SOURCES",
                                            sources) in said and said.count("\n") == 1, said
    assert not (tmp_path / "build").exists()


def test_setup_refuses_what_is_no_program_and_a_build_of_lammps(tmp_path):
    assert run_setup(tmp_path, "--lammps", "no_such_lmp") == (
        1, "setup: --lammps no_such_lmp: there is no such program\n")
    status, said = run_setup(paths.BUILD, "--lammps", paths.BUILD / "lmp")
    assert (status == 1 and f"{paths.BUILD} holds a build of LAMMPS: remove it, or name another "
            "folder with FSI_BUILD_DIR" in said)
