"""Collects the figures of a run, or of a study of several, and writes them as summary.json."""

import json
import math
from pathlib import Path

from . import log as lammps_log

RUN_FILE = "run.json"
LOG_FILE = "log.lammps"


class Summary:
    """The figures of the run in `folder`: what was measured about the run itself, and what `add` is
    given.

    In a study's folder, which has no log but holds the folders of its cases, `cases` are their
    summaries by name, and size and cost are summed over them.
    """

    def __init__(self, folder):
        self.folder = Path(folder)
        run = self.folder / RUN_FILE
        self.run = json.loads(run.read_text()) if run.exists() else {}
        self.figures = []
        self.log, self.cases = None, {}
        if (self.folder / LOG_FILE).exists():
            self.log = lammps_log.read(self.folder / LOG_FILE)
        else:
            names = (self.run.get("cases")
                     or [path.parent.name for path in sorted(self.folder.glob("*/summary.json"))])
            self.cases = {name: json.loads((self.folder / name / "summary.json").read_text())
                          for name in names}
            if not self.cases:
                raise FileNotFoundError(
                    f"{self.folder} has neither {LOG_FILE} nor folders with a summary.json")

    def add(self, name, value, unit="", reference=None, source=None, target=None):
        """Adds a figure; `reference` is the published value in the same unit, `source` says whose,
        its kind first (results.KINDS).

        The relative error is positive where the size of the value is too large.

        `target` is what was set out for: the largest allowed size of the relative error, or,
        without a reference or with 0 for it, of the value itself.
        """
        value = _finite(value)
        error = None
        if reference and value is not None:
            error = value / reference - 1.0
        met = None
        if target is not None:
            size = error if reference else value
            met = bool(size is not None and abs(size) <= target)
        self.figures.append({"name": name, "value": value, "unit": unit, "reference": reference,
                             "source": source,
                             "relative_error": _finite(error), "target": target, "met": met})

    def write(self):
        """Writes summary.json, prints it as a table, returns it as a dictionary."""
        cost = self._cost() if self.log else self._cost_of_cases()
        for name, unit in (("cpu_seconds", "s"), ("particle_steps_per_second", "1/s"),
                           ("bytes_per_particle", "B")):
            self.add(name, cost[name], unit)
        summary = {"scene": self.run.get("scene", self.folder.name), "figures": self.figures,
                   **cost,
                   "commit": self.run.get("commit"), "date": self.run.get("date")}
        if self.cases:
            kept = ("given", "particles", "steps", "ranks", "cpu_seconds")
            summary["cases"] = {name: {key: case.get(key) for key in kept}
                                for name, case in self.cases.items()}
            summary["failed_cases"] = self.run.get("failed", [])
        else:
            summary |= {"case": self.run.get("case"), "given": self.run.get("given", {}),
                        "variables": self.run.get("variables", {})}
        (self.folder / "summary.json").write_text(json.dumps(summary, indent=2) + "\n")
        print(table(summary))
        return summary

    def _cost(self):
        """Size and speed. The speed is that of the time loop; cpu_seconds is the whole of LAMMPS'
        run. CPU time, of one rank: what else the machine does hardly counts."""
        runs = self.log.finished
        loop = sum(run.cpu_seconds for run in runs)
        work = sum(run.atoms * run.steps for run in runs)
        ranks = runs[-1].ranks if runs else self.run.get("ranks")
        particles = runs[0].atoms if runs else None
        memory = max((run.bytes_per_rank for run in runs if run.bytes_per_rank), default=None)
        return {
            "particles": particles,
            "steps": sum(run.steps for run in runs),
            "ranks": ranks,
            "cpu_seconds": self.run.get("cpu_seconds", loop if runs else None),
            "loop_seconds": loop,
            "particle_steps": work,
            **_speed(work, loop, loop * (ranks or 0)),
            "bytes_per_particle": memory * ranks / particles if memory and particles else None,
            "lammps": self.log.version,
        }

    def _cost_of_cases(self):
        """As above: particles, ranks and memory of the largest case, the rest over all."""
        cases = list(self.cases.values())
        largest = max(cases, key=lambda case: case["particles"] or 0)
        work, loop, steps, whole = (sum(case[key] or 0 for case in cases)
                                   for key in ("particle_steps", "loop_seconds", "steps",
                                               "cpu_seconds"))
        return {
            "particles": largest["particles"],
            "steps": steps,
            "ranks": largest["ranks"],
            "cpu_seconds": whole,
            "loop_seconds": loop,
            "particle_steps": work,
            **_speed(work, loop,
                     sum(case["loop_seconds"] * (case["ranks"] or 0) for case in cases)),
            "bytes_per_particle": largest["bytes_per_particle"],
            "lammps": largest["lammps"],
        }


def _speed(work, seconds, rank_seconds):
    return {"particle_steps_per_second": work / seconds if seconds else None,
            "particle_steps_per_second_per_rank": work / rank_seconds if rank_seconds else None}


def table(summary):
    """A summary as text for the terminal."""
    rows = [("figure", "value", "unit", "reference", "error", "target", "source")]
    for figure in summary["figures"]:
        met = {None: "", True: " met", False: " MISSED"}[figure["met"]]
        rows.append((figure["name"], number(figure["value"]), figure["unit"],
                     number(figure["reference"], ""),
                     deviation(figure), bound(figure) + met, figure["source"] or ""))
    widths = [max(len(row[k]) for row in rows) for k in range(7)]
    lines = []
    for row in rows:
        cells = [row[0].ljust(widths[0]), row[1].rjust(widths[1]), row[2].ljust(widths[2]),
                 row[3].rjust(widths[3]), row[4].rjust(widths[4]), row[5].ljust(widths[5]), row[6]]
        lines.append("  ".join(cells).rstrip())
    lines.insert(1, "-" * max(map(len, lines)))
    lines.append("")
    size = (f"{len(summary['cases'])} cases of up to {summary['particles']}" if "cases" in summary
            else summary["particles"])
    lines.append(f"{size} particles, {summary['steps']} steps, {summary['ranks']} ranks, "
                 f"{number(summary['particle_steps_per_second_per_rank'])} particle-steps per "
                 "second and rank")
    return "\n".join(lines)


def deviation(figure):
    """A figure's relative error as text; empty if it has none."""
    if figure["relative_error"] is None:
        return ""
    percent = 100 * figure["relative_error"]
    return f"{percent:+.1f} %" if abs(percent) >= 0.05 or percent == 0 else f"{percent:+.1g} %"


def bound(figure):
    """A figure's target as text; empty if it has none."""
    if figure["target"] is None:
        return ""
    return (f"{100 * figure['target']:.3g} %" if figure["reference"]
            else f"{figure['target']:.4g} {figure['unit']}".strip())


def _finite(value):
    """JSON has no NaN: null says that there is no such number."""
    if value is None or isinstance(value, (int, str)):
        return value
    value = float(value)
    return value if math.isfinite(value) else None


def number(value, nothing="-"):
    """A figure's value as text, to four digits."""
    if value is None:
        return nothing
    if isinstance(value, float):
        return f"{value:.4g}" if abs(value) < 1e4 else f"{value:,.0f}"
    return str(value)
