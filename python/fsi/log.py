"""Reads log.lammps.

LAMMPS' own reader (lammps/formats.py) has the tables only, of runs that came to their end, and is
not there where this package is installed alone.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

_LOOP = re.compile(r"Loop time of (\S+) on (\d+) procs for (\d+) steps with (\d+) atoms")
_MEMORY = re.compile(r"Per MPI rank memory allocation \(min/avg/max\) = (\S+) \| (\S+) \| (\S+) "
                     r"Mbytes")
_USE = re.compile(r"(\S+)% CPU use with")
_NEIGHBOURS = re.compile(r"(Neighs|FullNghs):\s+(\S+) ave")
_BONDS = re.compile(r"\s*fsi/solid/tl: reference of (\d+) particles taken, (\S+) bonds each")
_SUBSTEPS = re.compile(r"fix\s+\S+\s+\S+\s+fsi\s.*\ssubsteps\s+(\d+)")
# their number is in thermo output where that has it
_CHOSEN = re.compile(r"fix\s+(\S+)\s+\S+\s+fsi/dt\s.*\ssubsteps\s+auto")
STOP = re.compile(r"fix\s+\S+\s+\S+\s+fsi/dt\s.*\sstop\s+([-+.\deE]+)")
_BUILDS = re.compile(r"Neighbor list builds = (\d+)")
_VERSION = re.compile(r"^LAMMPS \(([^)]+)\)")
_REPORT = re.compile(r"^FSI report (\w+) (.+)$")  # of fix fsi/report
_VALUE = re.compile(r"^FSI (\w+) (\S+)\s*$")
# of thermo styles that are not lines of numbers
_YAML = re.compile(r"(?:keywords:|  -) \[(.*)\]$")
_STEP = re.compile(r"-{12} Step +(\d+) -{5} CPU = +(\S+) \(sec\) -+$")
_EQUAL = re.compile(r"(\S+) += +(\S+)")


@dataclass
class Run:
    """One `run` command: its thermo table and what LAMMPS reports after it (None: it did not get
    there)."""

    thermo: dict = field(default_factory=dict)  # column name -> array (rows,)
    loop_seconds: float = None
    ranks: int = None
    steps: int = None
    atoms: int = None
    bytes_per_rank: float = None  # average over ranks
    cpu_use: float = None  # CPU over wall time in the loop
    # entries of the half neighbour list at the end, 0 where LAMMPS does not find it (pair style
    # hybrid)
    neighbours: int = None
    # of the full one, which total-Lagrangian solids take their reference from
    full_neighbours: int = None
    builds: int = None  # of the neighbour list
    report: dict = field(default_factory=dict)  # of fix fsi/report: {name: value}
    cost: str = ""  # its text for readers
    times: str = ""  # LAMMPS' table of times

    @property
    def cpu_seconds(self):
        """Of the loop, per rank."""
        return self.loop_seconds * (self.cpu_use or 1.0)


@dataclass
class Log:
    """A whole log file."""

    runs: list
    values: dict  # what the deck printed as "FSI <name> <value>": numbers where they are numbers
    warnings: list
    errors: list
    version: str = None  # of LAMMPS: "4 Feb 2025"
    solid_particles: int = 0  # of total-Lagrangian solids
    bonds: float = 0.0  # of all of them, each seen from both ends
    substeps: int = 1  # steps of total-Lagrangian solids in each step, as fix fsi is told
    stop: float = None  # time at which fix fsi/dt ends the last run
    chosen: str = None  # column of thermo output with those that fix fsi/dt chooses
    # the lists of effects that are on, as fix fsi printed them
    effects: list = field(default_factory=list)

    @property
    def finished(self):
        """Runs that came to their end."""
        return [run for run in self.runs if run.loop_seconds is not None]

    def substeps_of(self, run):
        """Steps of total-Lagrangian solids in each step of a run, the mean where they change."""
        found = run.thermo.get(self.chosen)
        return self.substeps if found is None or len(found) == 0 else float(np.mean(found))

    def pair_visits(self):
        """Entries of the neighbour list, each pair once, and bonds of total-Lagrangian solids, from
        both ends, times (sub-)steps.

        Beside such solids LAMMPS counts only a full list of all, less their bonds then. None where
        it counts nothing.
        """
        visits = 0.0
        for run in self.finished:
            listed = run.neighbours or 0.5 * max(0.0, (run.full_neighbours or 0) - self.bonds)
            if self.solid_particles == run.atoms:  # one body alone needs no list
                listed = 0.0
            visits += run.steps * (listed + self.substeps_of(run) * self.bonds)
        return visits or None

    def column(self, *names):
        """A thermo column over all runs, by the first of the names that exists; None if none
        does."""
        for name in names:
            parts = [run.thermo[name] for run in self.runs if name in run.thermo]
            if parts:
                return np.concatenate(parts)
        return None


def read(path):
    """Reads a log file, of any thermo style."""
    log = Log(runs=[], values={}, warnings=[], errors=[])
    header, rows = None, []

    def close_table():
        if header and log.runs:
            table = np.array(rows, dtype=float).reshape(-1, len(header))
            log.runs[-1].thermo = {name: table[:, k] for k, name in enumerate(header)}

    expect_header = False
    lines, starts, ended = _in_lines(Path(path).read_text(errors="replace").splitlines()), [], 0
    for k, line in enumerate(lines):
        match = _LOOP.match(line) or _REPORT.match(line)
        if match and log.runs and log.runs[-1].loop_seconds is not None:
            # a run with "pre no" has no line of memory before its table
            starts.append(_header(lines, ended, k))
            log.runs.append(Run())
            header = lines[starts[-1]].split() if starts[-1] < k else None
            rows = [row for row in (_row(each, len(header or ())) for each in lines[starts[-1]:k])
                    if row]
        if line.startswith("WARNING"):
            log.warnings.append(line)
        elif line.startswith("ERROR"):
            log.errors.append(line)
        elif match := _MEMORY.match(line):
            close_table()
            starts.append(k)
            log.runs.append(Run(bytes_per_rank=float(match[2]) * 2**20))
            header, rows, expect_header = None, [], True
        elif match := _LOOP.match(line):
            close_table()
            header, rows, ended = None, [], k
            if log.runs:
                run = log.runs[-1]
                run.loop_seconds, run.ranks = float(match[1]), int(match[2])
                run.steps, run.atoms = int(match[3]), int(match[4])
        elif log.runs and (match := _USE.match(line)):
            log.runs[-1].cpu_use = float(match[1]) / 100.0
        elif log.runs and (match := _NEIGHBOURS.match(line)):
            count = max(0, round(float(match[2]) * (log.runs[-1].ranks or 1)))
            setattr(log.runs[-1], "neighbours" if match[1] == "Neighs" else "full_neighbours",
                    count)
        elif log.runs and (match := _BUILDS.match(line)):
            log.runs[-1].builds = int(match[1])
        elif match := _VERSION.match(line):
            log.version = log.version or match[1]
        elif match := _BONDS.match(line):
            log.solid_particles, log.bonds = int(match[1]), int(match[1]) * float(match[2])
        elif match := _SUBSTEPS.match(line):
            log.substeps = int(match[1])
        elif line.startswith("fix") and "fsi/dt" in line:
            if match := STOP.match(line):
                log.stop = float(match[1])
            if match := _CHOSEN.match(line):
                log.chosen = f"f_{match[1]}[7]"
        elif log.runs and (match := _REPORT.match(line)):
            log.runs[-1].report[match[1]] = _number(match[2])
        elif match := _VALUE.match(line):
            log.values[match[1]] = _number(match[2])
        elif expect_header and line.strip():
            header, expect_header = line.split(), False
        elif header:
            row = _row(line, len(header))
            if row:
                rows.append(row)
    close_table()
    _blocks(log, lines, starts)
    return log


def _in_lines(lines):
    """A log whose thermo output, of style yaml or multi, stands in lines of names and of numbers"""
    result, row, columns = [], None, None
    for line in lines:
        if row and not _EQUAL.match(line):  # the end of what style multi writes for a step
            if columns != list(row):
                columns = list(row)
                result.append(" ".join(columns))
            result.append(" ".join(row.values()))
            row = None
        if _LOOP.match(line):
            columns = None
        if match := _STEP.match(line):
            row = {"Step": match[1], "CPU": match[2]}
        elif row:
            row.update(_EQUAL.findall(line))
        elif match := _YAML.match(line):
            result.append(re.sub("[',]", " ", match[1]))
        elif line not in ("---", "data:", "..."):
            result.append(line)
    return result


def _header(lines, first, last):
    """Where a table begins: the first line of words with as many numbers below it"""
    for k in range(first, last - 1):
        width = len(lines[k].split())
        if width and not _row(lines[k], width) and _row(lines[k + 1], width):
            return k
    return last


def _blocks(log, lines, starts):
    """Texts of several lines, as they stand in the log; starts: of runs, line numbers"""
    text = lambda first, last=None: "".join(f"{line}\n" for line in lines[first:last])
    log.effects = re.findall(r"^FSI: .*\n(?:  .*\n)*", text(0), re.M)
    for run, first, last in zip(log.runs, starts, [*starts[1:], None]):
        part = text(first, last)
        run.cost = "".join(re.findall(r"^FSI report: .*\n(?:  .*\n)*", part, re.M))
        run.times = "".join(re.findall(r"^MPI task timing breakdown:\n(?:.*\|.*\n|-+\n)*", part,
                                       re.M))


def reports(path):
    """What fix fsi/report wrote into the file of its keyword `file`: a dictionary per run."""
    found = []
    for line in Path(path).read_text().splitlines():
        if match := _REPORT.match(line):
            if match[1] == "first_step":
                found.append({})
            found[-1][match[1]] = _number(match[2])
    return found


def _number(text):
    try:
        return float(text)
    except ValueError:
        return text


def _row(line, width):
    """The numbers of a table's line; None for anything that a fix may have printed in between."""
    words = line.split()
    if len(words) != width:
        return None
    try:
        return [float(word) for word in words]
    except ValueError:
        return None
