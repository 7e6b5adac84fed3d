"""What is installed works without the build, and the sources work inside a LAMMPS tree."""

import shutil
import subprocess

import pytest
from scenes import dam_gate

from fsi import launch, paths


def command(*words, **options):
    done = subprocess.run([str(w) for w in words], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT,
                          text=True, check=False, **options)
    assert done.returncode == 0, "\n".join(done.stdout.splitlines()[-20:])
    return done.stdout


def test_install(tmp_path):
    """Program, library, plugin and materials; the script for the shell is all that a run needs."""
    prefix = tmp_path / "some where"
    command("cmake", "--install", paths.BUILD, "--prefix", prefix)
    assert list(prefix.glob("lib*/lammps/plugins/fsiplugin.so")) and list(
        prefix.glob("lib*/liblammps.so"))
    scene = dam_gate(2)
    (tmp_path / "scene.data").write_text(scene.data())
    (tmp_path / "in.test").write_text(scene.text() + "run 5\n")
    environment = {k: v for k, v in launch.environment().items()
                   if k not in ("LAMMPS_POTENTIALS", "LD_LIBRARY_PATH")}
    text = command("sh", "-c",
                   f". '{prefix}/etc/profile.d/lammps-fsi.sh'; command -v lmp; lmp -in in.test",
                   cwd=tmp_path,
                   env=environment)
    assert text.startswith(str(prefix)) and "Total wall time" in text


@pytest.mark.parametrize("form", ["package", "files"])
def test_inside_a_lammps_tree(tmp_path, monkeypatch, form):
    """Both forms of doc/src/Build_fsi.rst, configured; LAMMPS' style headers have the styles, and
    sources compile there."""
    source, tree = paths.lammps_source(), tmp_path / "lammps"
    tree.mkdir()
    for entry in source.iterdir():  # links instead of 500 MB
        if entry.name not in ("src", "cmake"):
            (tree / entry.name).symlink_to(entry)
    shutil.copytree(source / "cmake", tree / "cmake")
    (tree / "src").mkdir()
    for entry in (source / "src").iterdir():
        (tree / "src" / entry.name).symlink_to(entry)

    options = []
    if form == "package":
        for package in paths.PACKAGES:
            target = tree / "src" / package.name
            if target.is_symlink():  # one of LAMMPS, which gets files
                target.unlink()
                shutil.copytree(source / "src" / package.name, target)
            shutil.copytree(package, target, dirs_exist_ok=True)
        command("sed", "-i", "s/^set(STANDARD_PACKAGES/& FSI FSI-CLASSIC/",
                tree / "cmake/CMakeLists.txt")
        options = ["-DPKG_FSI=ON", "-DPKG_FSI-CLASSIC=ON", "-DPKG_OPENMP=ON"]
    else:
        for entry in (entry for package in paths.PACKAGES for entry in package.iterdir()):
            shutil.copy(entry, tree / "src")
    build = tmp_path / "build"
    # the compiler cache knows the objects in whatever folder the tree is
    monkeypatch.setenv("CCACHE_BASEDIR", str(tmp_path))
    launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
    command("cmake", "-S", tree / "cmake", "-B", build, "-G", "Ninja", *launcher, *options)
    headers = "".join(h.read_text() for h in (build / "styles").glob("style_*.h"))
    for name in ("atom_vec_fsi", "pair_fsi_fluid", "pair_fsi_fluid_omp", "pair_fsi_solid",
                 "pair_fsi_solid_tl", "fix_fsi", "compute_fsi_atom", "fsi_commands"):
        assert f'{name}.h"' in headers
    objects = [line.split(":")[0]
               for line in command("ninja", "-C", build, "-t", "targets", "all").splitlines()
               # the last without FFTW
               if any(line.split(":")[0].endswith(f"/{name}.cpp.o") for name in (
                   "atom_vec_fsi", "fsi_commands", "fsi_material", "fix_fsi_spectrum"))]
    assert len(objects) == 4
    command("ninja", "-C", build, *objects)
