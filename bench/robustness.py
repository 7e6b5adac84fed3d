"""Each bundled scene with what a user would change first. tools/cost robustness [SCENE ...]
[out=FOLDER]

As it is, its solids 10 times stiffer and softer and with Poisson's ratio 0.49, its spacing doubled
and halved; coarse, and some hundred steps of each. A run is sound if it ends with exit status 0,
all particles in place that the deck watches over, finite and slower than sound; or it is stopped by
an error that names the cause. Anything else is an error of this tool, too: exit status 1.
"""

import math
import re
import resource
import subprocess
import tempfile
from pathlib import Path

from tool import say, write_csv

from fsi import launch, log, paths, scene, sweep
from fsi.command import Refusal, split, start

STEPS, LIMIT = 400, 300  # of a run; its CPU seconds
# scene: (variable of the resolution, its value, whether it is a number of particles; other
# variables)
SCENES = {
    "beam": ("across", 4, True, {}),
    "bending_column": ("across", 4, True, {}),
    "colliding_rings": ("dx", 0.002, False, {}),
    "column": ("dx", 0.01, False, {}),
    "couette_poiseuille": ("n", 10, True, {"wall": "solid"}),
    "cylinder_channel": ("across", 8, True, {"length": 0.5}),
    "cylinder_free": ("across", 6, True, {"width": 8}),
    "dam_break": ("resolution", 20, True, {}),
    "dam_break_3d": ("dx", 0.055, False, {}),
    "dam_break_elastic": ("dx", 0.004, False, {"dim": 2, "column": 0.292, "depth": 0.12}),
    "dam_break_gate": ("rows", 80, True, {"across": 2}),
    "droplet": ("dx", 0.005, False, {}),
    "elastic_gate": ("dx", 0.0025, False, {}),
    "elliptical_drop": ("dx", 0.05, False, {}),
    "floating_blocks": ("dx", 0.02, False, {}),
    "gate_static": ("dx", 0.00125, False, {}),
    "hydrostatic_plate": ("across", 4, True, {"depth": 0.5}),
    "lid_driven_cavity": ("n", 20, True, {}),
    "open_channel": ("across", 8, True, {"length": 0.5}),
    "oscillating_plate": ("n", 4, True, {"spectrum": "no"}),
    "rolling_tank": ("dx", 0.002, False, {}),
    "rotating_square_patch": ("dx", 0.05, False, {}),
    "spinning_plate": ("across", 6, True, {}),
    "standing_wave": ("dx", 0.05, False, {}),
    "still_water": ("dx", 0.04, False, {}),
    "taylor_bar": ("rows", 16, True, {}),
    "taylor_green": ("dx", 0.05, False, {}),
    "turek_hron_csm": ("across", 4, True, {}),
    "turek_hron_fsi": ("across", 2, True, {"length": 0.8}),
    "twisting_column": ("across", 4, True, {}),
}
# whose solids are walls that do not move: their material changes nothing
HELD = ("couette_poiseuille",)
COLUMNS = ("scene", "change", "particles", "steps", "verdict", "fastest", "cause")
CHANGES = {  # name: (factor of Young's modulus, Poisson's ratio, factor of the spacing)
    "as it is": (1, None, 1), "10 times stiffer": (10, None, 1), "10 times softer": (0.1, None, 1),
           "Poisson's ratio 0.49": (1, 0.49, 1),
    "spacing doubled": (1, None, 2), "spacing halved": (1, None, 0.5)}
END = """
variable robust_v atom sqrt(vx^2+vy^2+vz^2)
compute robust_v all reduce max v_robust_v
compute robust_x all reduce sum x y z
thermo_style custom step c_robust_v c_robust_x[1] c_robust_x[2] c_robust_x[3] atoms
run 0
"""


def solids(text, young, poisson):
    """A file of materials, or a deck that writes one, with other solids."""
    text = re.sub(r"(\bsolid +rho .*?young +)([\d.e+-]+)",
                  lambda m: f"{m[1]}{float(m[2]) * young!r}", text)
    return text if poisson is None else re.sub(r"(\bsolid +rho .*?poisson +)[\d.e+-]+",
                                               rf"\g<1>{poisson}", text)


def variables(name, young, spacing):
    """The deck's variables of a change."""
    variable, value, counts, more = SCENES[name]
    value = round(value / spacing) if counts else value * spacing
    known = scene.deck_variables(scene.deck(name))
    more = dict(more) | ({"young": float(known["young"]) * young} if "young" in known else {})
    return {**more, variable: value}


def run(name, young, poisson, spacing):
    """{column: value} of one run."""
    text, given = sweep.Deck(scene.deck(name)).instance(variables(name, young, spacing))
    runs = re.findall(r"^run  .*", text, flags=re.M)
    if not runs:
        raise Refusal(f"{name}'s deck has no run")
    text = re.sub(r"^run  .*", f"run {STEPS // len(runs)}", text, flags=re.M)
    with tempfile.TemporaryDirectory(prefix="fsi_robust_") as folder:
        folder = Path(folder)
        (folder / "materials.fsi").write_text(
            solids((paths.POTENTIALS / "materials.fsi").read_text(), young, poisson))
        (folder / "in.deck").write_text(solids(text, 1, poisson) + END)
        done = subprocess.run(launch.lammps("in.deck", 0, given), cwd=folder,
                              env=launch.environment(),
                              stdin=subprocess.DEVNULL, capture_output=True, text=True,
                              errors="replace", check=False,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU,
                                                                    (LIMIT, LIMIT + 1)))
        found = log.read(folder / "log.lammps")
    steps, atoms = sum(r.steps for r in found.finished[:-1]
                       or found.finished), next((r.atoms for r in found.finished), None)
    if done.returncode:
        cause = re.sub(r"^ERROR[^:]*: |\s*\(\S+:\d+\)$", "",
                       (found.errors or [f"exit status {done.returncode}"])[0])
        named = bool(found.errors) and not re.match("Lost atoms|Non-numeric|Unknown", cause)
        return {"particles": atoms, "steps": steps, "verdict": "stopped" if named else "failed",
                "cause": cause}
    last = {column: values[-1] for column, values in found.runs[-1].thermo.items() if len(values)}
    if not last or not all(map(math.isfinite, last.values())):
        return {"particles": atoms, "steps": steps, "verdict": "failed",
                "cause": "not finite, with exit status 0"}
    return {"particles": atoms, "steps": steps, "verdict": "sound", "fastest": last["c_robust_v"]}


def main(arguments):
    """tools/cost robustness"""
    chosen = [a for a in arguments if a in SCENES]
    options, _ = split([a for a in arguments if a not in SCENES], ("out",),
                       f"out=FOLDER or some of {', '.join(SCENES)}", more=False)
    if not scene.build():
        return 1
    rows = []
    for name in chosen or SCENES:
        has_solid = "fsi/solid" in scene.deck(name).read_text() and name not in HELD
        for change, (young, poisson, spacing) in CHANGES.items():
            if not has_solid and (young != 1 or poisson is not None):
                continue
            rows.append({"scene": name, "change": change, **run(name, young, poisson, spacing)})
            say("robustness: {scene}, {change}: {verdict}".format(**rows[-1])
                + f" {rows[-1].get('cause', '')}".rstrip())
    folder = Path(options.get("out", paths.RESULTS / "cost" / "robustness")).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    write_csv(folder / "robustness.csv", " ".join(["tools/cost robustness", *chosen]), COLUMNS,
              rows, 3)
    say(f"cost: the table is in {folder}")
    return int(any(row["verdict"] == "failed" for row in rows))


if __name__ == "__main__":
    start("cost", main)
