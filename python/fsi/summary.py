"""Collects a run's figures and writes them as summary.json."""

import json
import math
from pathlib import Path

from . import log as lammps_log

RUN_FILE = "run.json"


class Summary:
    """The figures of the run in `folder`: what was measured about the run itself, and what `add` is given."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.log = lammps_log.read(self.folder / "log.lammps")
        run = self.folder / RUN_FILE
        self.run = json.loads(run.read_text()) if run.exists() else {}
        self.figures = []

    def add(self, name, value, unit="", reference=None, source=None):
        """Adds a figure; `reference` is the published value in the same unit, `source` says whose."""
        error = None
        if reference and value is not None:
            error = (value - reference) / abs(reference)
        self.figures.append({"name": name, "value": _finite(value), "unit": unit, "reference": reference,
                             "source": source, "relative_error": _finite(error)})

    def write(self):
        """Writes summary.json, prints it as a table, returns it as a dictionary."""
        cost = self._cost()
        for name, unit in (("wall_seconds", "s"), ("particle_steps_per_second", "1/s"), ("bytes_per_particle", "B")):
            self.add(name, cost[name], unit)
        summary = {"scene": self.run.get("scene", self.folder.name), "figures": self.figures, **cost,
                   "variables": self.run.get("variables", {})}
        (self.folder / "summary.json").write_text(json.dumps(summary, indent=2) + "\n")
        print(table(summary))
        return summary

    def _cost(self):
        """Size and speed. The speed is that of the time loop; wall_seconds is the whole of LAMMPS' run."""
        runs = self.log.finished
        loop = sum(run.loop_seconds for run in runs)
        work = sum(run.atoms * run.steps for run in runs)
        ranks = runs[-1].ranks if runs else self.run.get("ranks")
        particles = runs[0].atoms if runs else None
        memory = max((run.bytes_per_rank for run in runs if run.bytes_per_rank), default=None)
        speed = work / loop if loop > 0.0 else None
        return {
            "particles": particles,
            "steps": sum(run.steps for run in runs),
            "ranks": ranks,
            "wall_seconds": self.run.get("wall_seconds", loop if runs else None),
            "particle_steps_per_second": speed,
            "particle_steps_per_second_per_rank": speed / ranks if speed and ranks else None,
            "bytes_per_particle": memory * ranks / particles if memory and particles else None,
        }


def table(summary):
    """A summary as text for the terminal."""
    rows = [("figure", "value", "unit", "reference", "error", "source")]
    for figure in summary["figures"]:
        error = figure["relative_error"]
        rows.append((figure["name"], _text(figure["value"]), figure["unit"], _text(figure["reference"], ""),
                     "" if error is None else f"{100 * error:+.1f} %", figure["source"] or ""))
    widths = [max(len(row[k]) for row in rows) for k in range(6)]
    lines = []
    for row in rows:
        cells = [row[0].ljust(widths[0]), row[1].rjust(widths[1]), row[2].ljust(widths[2]),
                 row[3].rjust(widths[3]), row[4].rjust(widths[4]), row[5]]
        lines.append("  ".join(cells).rstrip())
    lines.insert(1, "-" * max(map(len, lines)))
    lines.append("")
    lines.append(f"{summary['particles']} particles, {summary['steps']} steps, {summary['ranks']} ranks, "
                 f"{_text(summary['particle_steps_per_second_per_rank'])} particle-steps per second and rank")
    return "\n".join(lines)


def _finite(value):
    """JSON has no NaN: null says that there is no such number."""
    if value is None or isinstance(value, (int, str)):
        return value
    value = float(value)
    return value if math.isfinite(value) else None


def _text(value, nothing="-"):
    if value is None:
        return nothing
    if isinstance(value, float):
        return f"{value:.4g}" if abs(value) < 1e4 else f"{value:,.0f}"
    return str(value)
