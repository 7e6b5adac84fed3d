"""A channel between an inlet and an outlet, a hundred times through. tools/cost open_ends [ranks=N]
[times=100]

Oil, Poiseuille's profile in, pressure out, 30 by 10 particles, as in unittest/styles/test_inlet.py:
what came, what left, how many there were, and the pressure drop of thirds of the run. Exit status 1
if one particle is unaccounted for.
"""

import subprocess
import tempfile
from pathlib import Path

from fsi import launch, scene, series
from fsi.command import Refusal, split, start, whole

DECK = """
units si
dimension 2
boundary f f p
atom_style fsi
newton on
region box block -0.6 3.6 -0.5 1.5 -0.05 0.05
create_box 1 box
lattice sq 0.1 origin 0.5 0.5 0
region channel block 0 3 0 1 INF INF units box
create_atoms 1 region channel
pair_style fsi/fluid sound 10 tension yes laminar/visc density/diffusion 0.1 shift 0.2
pair_coeff * * oil.fsi oil
fix sph all fsi 0.1 wendland 1.5
fix w all fsi/wall/mirror ylo 0 slip no yhi 1 slip no
variable u atom 6*y*(1-y)*(1-exp(-time/0.5))
fix i all fsi/inlet xlo 0 velocity v_u 0 0
fix o all fsi/outlet xhi 3
timestep 0.003
neighbor 0.03 bin
thermo_modify norm no lost error
thermo 10000
variable came equal f_i[2]-f_i[3]
variable left equal f_o[3]-f_o[2]
variable inside equal atoms-f_i[1]-f_o[1]
variable drop equal f_i[6]-f_o[6]
fix s all print 100 "$(time),$(atoms),$(v_inside),$(v_came),$(v_left),$(v_drop)" file s.csv title "time,atoms,inside,came,left,drop" screen no
thermo_style custom step atoms v_inside v_came v_left v_drop
"""


def run(ranks, times):
    """The series of one run."""
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        (folder / "oil.fsi").write_text("# DATE: 2026-01-01 UNITS: si CITATION: none\n"
                                        "oil fluid rho 1000 viscosity 100\n")
        (folder / "in.channel").write_text(f"{DECK}run {1000 * times}\n")
        done = subprocess.run(launch.lammps(folder / "in.channel", ranks), cwd=folder,
                              env=launch.environment(), capture_output=True, text=True, check=False)
        if done.returncode:
            raise Refusal(done.stdout[-2000:])
        return series.read(folder / "s.csv")


def main(arguments):
    """tools/cost open_ends"""
    options, _ = split(arguments, ("ranks", "times"), "ranks=N or times=N", more=False)
    ranks, times = whole("ranks", options.get("ranks", "1")), whole("times",
                                                                    options.get("times", "100"))
    if not scene.build():
        return 1
    s = run(ranks, times)
    lost = s["inside"][0] + s["came"] - s["left"] - s["inside"]
    end = s.time[-1]
    thirds = [s["drop"][(s.time > a * end) & (s.time <= b * end)].mean()
              for a, b in ((0.1, 1 / 3), (1 / 3, 2 / 3), (2 / 3, 1))]
    print(f"{times} times through on {ranks}: {s['came'][-1]:.0f} came, {s['left'][-1]:.0f} left, "
          f"{abs(lost).max():.0f} lost; {s['atoms'].min():.0f} to {s['atoms'].max():.0f} "
          f"particles with the buffers; mean pressure drop {', '.join(f'{p:.0f}' for p in thirds)} "
          "Pa in the run's thirds but for its first tenth, 3600 is Poiseuille's")
    return int(lost.any())


if __name__ == "__main__":
    start("cost", main)
