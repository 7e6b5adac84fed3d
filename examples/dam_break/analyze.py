#!/usr/bin/env python3
"""Figures and pictures of the dam break.   usage: analyze.py FOLDER

Reads history.csv, particles.dump and log.lammps in FOLDER, which tools/run makes; writes
summary.json, front.png, gauge.png (classical case) and snapshots.png there. What a run is judged by
follows from its geometry.
"""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, log, plot, series  # noqa: E402
from fsi.leaks import Leaks  # noqa: E402
from fsi.summary import Summary  # noqa: E402

GREEN, PURPLE = "#3a7d34", "#7b4397"
UNTIL = 2.5  # fronts are compared until t sqrt(2g/L) = 2.5, or until the wall is near
PLATEAU = (3.0, 5.0)  # t sqrt(g/H): between the first impact and the return of the run-up
SNAPSHOT_TIMES = (0.0, 1.5, 2.4, 3.0, 4.0, 5.0, 5.7, 6.3, 7.0)  # t sqrt(g/H)
CODE = "code, TrixiParticles WCSPH, H/dx = 400"
# of front and plateau, with 80 particles over the height
FRONT_TARGET, PLATEAU_TARGET = {"code": 0.025, "experiment": 0.05}, 0.15
MPS = "code, Koshizuka & Oka 1996"
BUCHNER = "experiment, Buchner 2002"
MEASURED = {1: ("martin_moyce_57mm", "Martin & Moyce 1952, L = 57 mm", plot.ORANGE),
            2: ("martin_moyce_29mm", "Martin & Moyce 1952, L = 29 mm", GREEN),
            3: ("koshizuka_oka_pysph", "Koshizuka & Oka 1996, digitized in PySPH", PURPLE),
            4: ("koshizuka_oka_dualsphysics", "Koshizuka & Oka 1996, in DualSPHysics", plot.GREY)}
CODE_SET = 5
TIME_LABEL, FRONT_LABEL = "t sqrt(2g/L)", "front x/L"


class Run:
    """A run's history in the dimensionless numbers of the literature."""

    def __init__(self, folder):
        values = log.read(folder / "log.lammps").values
        self.dx, self.H, self.L, self.tank, self.g = (values[k]
                                                      for k in ("dx", "H", "width", "length", "g"))
        self.resolution = round(self.H / self.dx)
        history = series.read(folder / "history.csv")
        self.t_front = history.time * np.sqrt(2.0 * self.g / self.L)
        self.t = history.time * np.sqrt(self.g / self.H)
        self.front, self.gauge = history["front"], history["gauge"]
        self.reach = self.tank / self.L  # the wall

    @property
    def classical(self):
        return abs(self.L - 2.0 * self.H) < 0.5 * self.dx and abs(self.tank - 5.366
                                                                  * self.H) < self.dx

    @property
    def tall(self):
        return abs(self.H - 2.0 * self.L) < 0.5 * self.dx

    def front_at(self, times):
        """x/L, interpolated."""
        return np.interp(times, self.t_front, self.front)

    def deviation(self, times, fronts, lag=0.0):
        """Relative deviation from reference fronts until UNTIL, those at the wall left out."""
        use = (times <= UNTIL) & (fronts < 0.98 * self.reach) & (times <= self.t_front[-1])
        return self.front_at(times[use] - lag) / fronts[use] - 1.0

    def lag(self, times, fronts):
        """Delay of a reference front that fits the run best, in its unit of time."""
        lags = np.linspace(0.0, 1.0, 501)
        return lags[np.argmin([np.mean(self.deviation(times, fronts, lag) ** 2) for lag in lags])]

    def arrival(self):
        """When the front reaches the wall, t sqrt(g/H); None if it does not."""
        there = self.front > 0.995 * self.reach
        return float(self.t[np.argmax(there)]) if there.any() else None


def largest(deviation):
    """Largest absolute value; None of nothing."""
    return float(np.abs(deviation).max()) if len(deviation) else None


def plateau(times, pressure):
    """Mean over the plateau, integrated linearly between the points given."""
    if times[-1] < PLATEAU[1]:
        return None
    fine = np.linspace(*PLATEAU, 401)
    return float(np.mean(np.interp(fine, times, pressure)))


def tall_reference(number):
    """(times, fronts) of one of the sets of front_tall.csv."""
    table = series.read(HERE / "front_tall.csv")
    of_set = table["set"] == number
    return table.time[of_set], table["front"][of_set]


def add_classical(summary, run, suffix=""):
    """Figures of the column 2H x H: front against a converged code, wall pressure against the
    experiment."""
    code, measured = (series.read(HERE / f"{name}.csv")
                      for name in ("front_code", "gauge_experiment"))
    deviation = run.deviation(code.time, code["wcsph"])
    summary.add(f"front_error_code{suffix}", largest(deviation), "", 0.0, CODE, FRONT_TARGET["code"]
                if suffix == "_80" else None)
    summary.add(f"front_error_code_rms{suffix}", float(np.sqrt(np.mean(deviation**2))), "", 0.0,
                CODE)
    summary.add(f"pressure_plateau{suffix}", plateau(run.t, run.gauge), "rho g H",
                plateau(measured.time, measured["pressure"]), BUCHNER,
                PLATEAU_TARGET if suffix == "_80" else None)


def add_tall(summary, run):
    """Figures of the column L x 2L: front against the experiments, as they are and delayed, and
    against a code."""
    for number, (name, label, _) in MEASURED.items():
        times, fronts = tall_reference(number)
        lag = run.lag(times, fronts)
        source = f"experiment, {label}"
        summary.add(f"front_error_experiment_{name}", largest(run.deviation(times, fronts)), "",
                    0.0, source,
                    FRONT_TARGET["experiment"])
        summary.add(f"front_lag_{name}", float(lag), "sqrt(L/2g)", 0.0, source)
        summary.add(f"front_error_lagged_{name}", largest(run.deviation(times, fronts, lag)), "",
                    0.0, source)
    summary.add("front_error_mps", largest(run.deviation(*tall_reference(CODE_SET))), "", 0.0, MPS)


def plot_classical(folder, run):
    """Front and wall pressure."""
    code, measured = (series.read(HERE / f"{name}.csv")
                      for name in ("front_code", "gauge_experiment"))
    label = f"H/dx = {run.resolution}"
    shown = run.t_front <= UNTIL
    plot.lines(folder / "front.png", TIME_LABEL, FRONT_LABEL,
               [(run.t_front[shown], run.front[shown], label, plot.BLUE)],
               [(code.time, code["wcsph"], CODE, plot.ORANGE)])
    shown = run.t > 2.0
    if shown.any():
        plot.lines(folder / "gauge.png", "t sqrt(g/H)", "p/(rho g H) at the wall, 0.2 H",
                   [(run.t[shown], run.gauge[shown], label, plot.BLUE)],
                   [(measured.time, measured["pressure"], BUCHNER, plot.ORANGE)])


def plot_tall(folder, run):
    """Front."""
    shown = run.t_front <= 3.4
    plot.lines(folder / "front.png", TIME_LABEL, FRONT_LABEL,
               [(run.t_front[shown], run.front[shown], f"H/dx = {run.resolution}", plot.BLUE),
                (*tall_reference(CODE_SET), f"{MPS} (MPS)", "#999999")],
               [(*tall_reference(number), label, colour)
                for number, (_, label, colour) in MEASURED.items()])


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    run = Run(folder)
    if run.classical:
        add_classical(summary, run)
        plot_classical(folder, run)
    if run.tall:
        add_tall(summary, run)
        plot_tall(folder, run)
    summary.add("arrival_time", run.arrival(), "sqrt(H/g)")

    leaks = Leaks(0.5 * run.dx)
    frames = dump.read(folder / "particles.dump")
    for frame in frames:
        leaks.see(frame)
        leaks.beyond_walls(frame, [("x", 0.0, -1), ("x", run.tank, 1), ("y", 0.0, -1)])
    summary.add("particles_leaked", leaks.count(summary.log))

    times = [time * np.sqrt(run.H / run.g) for time in SNAPSHOT_TIMES if time <= run.t[-1] + 0.1]
    plot.snapshots(folder / "snapshots.png",
                   dump.nearest(frames, times, tolerance=0.1 * np.sqrt(run.H / run.g)), run.dx,
                   limits=((0.0, run.tank), (0.0, 1.3 * max(run.H, 0.3 * run.tank))))
    return summary.write()


def study(folder, cases):
    """What several runs show together: convergence, ranks, the paper's scheme."""
    summary = Summary(Path(folder))
    runs = {name: Run(Path(path)) for name, path in cases.items()}

    best = sorted((run for name, run in runs.items() if name.startswith("best")),
                  key=lambda run: run.resolution)
    for run in {run.resolution: run for run in best}.values():
        add_classical(summary, run, f"_{run.resolution}")

    if "experiment" in runs:
        add_tall(summary, runs["experiment"])
    if "best_40" in runs and "best_40_serial" in runs:
        serial, parallel = runs["best_40_serial"], runs["best_40"]
        summary.add("front_difference_ranks",
                    largest(parallel.deviation(serial.t_front, serial.front)), "", 0.0,
                    "2 ranks against 1, H/dx = 40")

    if "paper_classical" in runs:
        add_classical(summary, runs["paper_classical"], "_paper")
    if "wide" in runs:
        ours = runs["wide"]
        for name in ("paper", "paper_H"):  # p0 = 17.4 rho g h and 17.4 rho g H
            if name in runs:
                summary.add(f"front_difference_{name}",
                            largest(runs[name].deviation(ours.t_front, ours.front)), "", 0.0,
                            "the recommended scheme in the same geometry")
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
