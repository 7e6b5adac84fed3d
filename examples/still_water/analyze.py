#!/usr/bin/env python3
"""Figures and pictures of the tank at rest.   usage: analyze.py FOLDER

Reads series.csv, particles.dump and log.lammps in FOLDER, which tools/run makes; writes
summary.json, pressure.png, energy.png and snapshots.png there.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, plot, series  # noqa: E402
from fsi.geometry import min_pair_distance  # noqa: E402
from fsi.leaks import Leaks  # noqa: E402
from fsi.summary import Summary  # noqa: E402

WATER = 1


def hydrostatic(y, tank):
    """Pressure [Pa] of water at rest at height y [m] above the floor."""
    return tank["rho0"] * tank["g"] * np.maximum(tank["depth"] - y, 0.0)


def pressure_error(water, tank):
    """Relative L2 error of the particles' pressure."""
    exact = hydrostatic(water["y"], tank)
    return float(np.linalg.norm(water["p"] - exact) / np.linalg.norm(exact))


def density_error(water, tank):
    """Largest error of the density over rho0; None without the speed of sound, of which the exact
    profile is made."""
    if "c" not in tank or "rho" not in water:
        return None
    exact = tank["rho0"] + hydrostatic(water["y"], tank) / tank["c"] ** 2
    return float(np.max(np.abs(water["rho"] - exact)) / tank["rho0"])


def ke_over_pe(water, tank):
    """Kinetic over potential energy from the floor up; one mass for all unless there is a column
    `mass`."""
    mass = water["mass"] if "mass" in water else 1.0
    speed_squared = (water.vector(("vx", "vy", "vz")) ** 2).sum(axis=1)
    return float(np.sum(0.5 * mass * speed_squared) / np.sum(mass * tank["g"] * water["y"]))


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    tank = summary.log.values
    missing = [name for name in ("depth", "rho0", "g", "dx") if name not in tank]
    if missing:
        raise SystemExit(
            f"{folder / 'log.lammps'} lacks lines 'FSI <name> <value>' for {', '.join(missing)}")
    spacing = tank["dx"]

    frames = [frame.of_types(WATER) for frame in dump.read(folder / "particles.dump")]
    first, last = frames[0], frames[-1]
    leaks = Leaks(0.5 * spacing)
    walls = [("x", first["x"].min() - 0.5 * spacing, -1),
             ("x", first["x"].max() + 0.5 * spacing, 1), ("y", 0.0, -1)]
    for frame in frames:
        leaks.see(frame)
        leaks.beyond_walls(frame, walls)
    errors = [pressure_error(frame, tank) for frame in frames]

    summary.add("pressure_l2", errors[-1], target=0.015)
    summary.add("pressure_l2_worst", max(errors[len(errors) // 2:]))
    density = density_error(last, tank)
    if density is not None:
        summary.add("density_error", density, "rho0")
    summary.add("ke_over_pe", ke_over_pe(last, tank), target=1e-5)
    summary.add("min_pair_distance", min_pair_distance(last.vector(), spacing) / spacing, "dx")
    summary.add("particles_leaked", leaks.count(summary.log), target=0)

    plot.deviations(folder / "pressure.png", tank["depth"] - last["y"], last["p"],
                    hydrostatic(last["y"], tank), hydrostatic(0.0, tank),
                    "error of p, over p at the floor [%]", f"t = {last.time:.0f} s")
    if (folder / "series.csv").exists():
        history = series.read(folder / "series.csv")
        if "ke" in history:
            moving = history["ke"] > 0.0
            plot.lines(folder / "energy.png", "time [s]", "kinetic energy [J]",
                       [(history.time[moving], history["ke"][moving], "kinetic energy", plot.BLUE)],
                       log_scale=True)
    shown = dump.nearest(frames, np.linspace(first.time, last.time, 3), tolerance=last.time)
    plot.snapshots(folder / "snapshots.png", shown, spacing, (WATER,))
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
