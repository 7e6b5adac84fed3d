"""Runs a deck with many settings and keeps what each run measured and cost, so that no run is ever
made twice.

A point is one deck with one set of settings. It is stored as JSON under a key made of the deck
without its comments, the settings that differ from the deck's defaults, and the contents of src/
and potentials/.
"""

import contextlib
import hashlib
import io
import json
import re
import resource
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

from . import dump, launch, log, paths, plot
from .command import Refusal

REPEATS = ((1.0, 3), (3.0, 2))  # runs shorter than so many CPU seconds are made so many times
# where a deck of the package is made to leave its particles before its first run
AT_FIRST = "at_first.dump"
# particle-steps of which instructions are counted: valgrind is some fifty times slower
COUNTED = 60000


def deck_variables(path):
    """Names and defaults of what -var can set in a deck: its index-style variables."""
    found = {}
    for line in Path(path).read_text().splitlines():
        match = re.match(r"\s*variable\s+(\w+)\s+index\s+(\"[^\"]*\"|'[^']*'|\S+)", line)
        if match:
            found.setdefault(match[1], match[2].strip("\"'"))
    return found


class Deck:
    """An input file whose settings may be index-style variables, equal-style variables, or named
    edits of its text.

    edits: {name: {"find": regular expression, "put": text with {value}, "default": value that
    means: no edit}}
    """

    def __init__(self, path, edits=None):
        self.path = Path(path)
        self.text = self.path.read_text()
        self.edits = edits or {}
        self.defaults = deck_variables(self.path) | {n: str(e.get("default", ""))
                                                     for n, e in self.edits.items()}
        # those that an `if` declares, too, have no default of their own: the deck's recipe decides
        self.open = set(re.findall(r"[\"']variable\s+(\w+)\s+index\b", self.text))
        self.formulas = set(re.findall(r"^\s*variable\s+(\w+)\s+equal\b", self.text, re.M))

    def normal(self, settings):
        """Settings as strings, without those that are the deck's own."""
        return {n: str(v) for n, v in sorted(settings.items()) if n in self.open or str(v)
                != self.defaults.get(n)}

    def instance(self, settings):
        """(text of the deck, variables for -var) for some settings."""
        text, variables = self.text, {}
        for name, value in self.normal(settings).items():
            if name in self.edits:
                edit = self.edits[name]
                text, count = re.subn(edit["find"],
                                      lambda m: m.expand(edit["put"]).replace("{value}", value),
                                      text, flags=re.M)
                if not count:
                    raise Refusal(
                        f"{self.path}: setting '{name}': the deck has no '{edit['find']}'")
            elif name in self.defaults:
                variables[name] = value
            elif name in self.formulas:
                text = re.sub(rf"^(\s*variable\s+{name}\s+equal)\s.*$", lambda m: f"{m[1]} {value}",
                              text, flags=re.M)
            else:
                raise Refusal(f"{self.path} has no variable '{name}'. It has: " +
                              ", ".join([*self.defaults, *sorted(self.formulas)]))
        return text, variables


def source_hash():
    """What the build was made of, by content: commits that do not touch it change nothing."""
    digest = hashlib.sha1()
    for folder in (paths.ROOT / "src", paths.POTENTIALS):
        for path in sorted(p for p in folder.rglob("*") if p.is_file()):
            digest.update(str(path.relative_to(paths.ROOT)).encode() + path.read_bytes())
    return digest.hexdigest()[:12]


def put(path, result):
    """Stores a result as JSON; an interruption leaves whole files only."""
    unfinished = path.with_suffix(".unfinished")
    unfinished.write_text(json.dumps(result, indent=1) + "\n")
    unfinished.replace(path)
    return result


class Store:
    """Points of one deck, in `folder`. measure(folder of a run) returns {figure: value}."""

    def __init__(self, folder, deck, measure, files=(), limit=600.0, repeats=None, source=None):
        self.folder, self.deck, self.measure, self.files = Path(folder), deck, measure, files
        self.limit, self.repeats = limit, repeats  # limit: CPU seconds of one run
        self.source = source or source_hash()
        self.folder.mkdir(parents=True, exist_ok=True)

    def path(self, settings):
        text, variables = self.deck.instance(settings)
        commands = [words for line in text.splitlines()
                    if (words := re.sub(r"(^|\s)#.*", "", line).split())]
        name = hashlib.sha1(json.dumps([commands, sorted(variables.items()),
                                        self.source]).encode()).hexdigest()[:16]
        return self.folder / f"{name}.json"

    def get(self, settings):
        """The stored point; None if there is none."""
        path = self.path(settings)
        return json.loads(path.read_text()) if path.exists() else None

    def make(self, settings):
        """The point, run if it is not stored yet."""
        found = self.get(settings)
        return found if found is not None else self._put(settings, self._run(settings))

    def take(self, settings, folder, figures):
        """The point from a run of this deck that `folder` holds and whose figures are known, if it
        is not stored yet."""
        if self.get(settings) is None:
            self._put(settings, self._point(settings) | {"figures": figures}
                      | cost_of(log.read(folder / "log.lammps")))

    def again(self, settings):
        """Times a stored point once more."""
        point = self.get(settings)
        with tempfile.TemporaryDirectory(prefix="fsi_cost_") as name:
            point["cpu_seconds"] += self._simulate(Path(name), settings)["cpu_seconds"]
        return self._put(settings, point)

    def count(self, settings):
        """Counts the instructions of a stored point's first time steps, nothing else of the run, by
        callgrind."""
        point = self.get(settings)
        steps = min(max(COUNTED * point["steps"] // point["particle_steps"], 4), point["steps"],
                    500)
        with tempfile.TemporaryDirectory(prefix="fsi_cost_") as name:
            cost = self._simulate(Path(name), settings, steps)
        if "instructions" not in cost:
            return None
        point["instructions"] = {key: cost[key] for key in ("instructions", "steps",
                                                            "particle_steps", "pair_visits")}
        return self._put(settings, point)

    def wanted(self, point):
        """How often a stored point should be run."""
        if point["status"] != "ok":
            return 0
        return self.repeats or next((n for below, n in REPEATS if min(point["cpu_seconds"])
                                     < below), 1)

    def _put(self, settings, point):
        return put(self.path(settings), point)

    def _point(self, settings):
        return {"settings": self.deck.normal(settings), "source": self.source, "status": "ok",
                "why": None, "figures": {}}

    def _run(self, settings):
        point = self._point(settings)
        with tempfile.TemporaryDirectory(prefix="fsi_cost_") as name:
            folder = Path(name)
            cost = self._simulate(folder, settings)
            point |= cost
            if point["status"] == "ok":
                try:
                    with quiet():
                        point["figures"] = self.measure(folder)
                except (Exception, SystemExit) as error:  # pylint: disable=broad-exception-caught
                    point |= {"status": "failed", "why": f"analysis: {error}"[:200]}
        return point

    def _simulate(self, folder, settings, steps=None):
        """One run in `folder`: its status and cost. steps: only so many, under callgrind."""
        text, variables = self.deck.instance(settings)
        if steps:  # in place of the first run; none after it
            first, *rest = re.split(r"^run\s.*$", text, flags=re.M)
            text = f"{first}run {steps}" + "".join(rest) if rest else text
        elif re.search(r"^\s*atom_style\s+fsi\b", text, re.M):
            text = re.sub(r"^(?=run\s)",
                          f"write_dump all custom {AT_FIRST} id type mol x y z modify time yes\n",
                          text, count=1, flags=re.M)
        for path in self.files:
            if not (folder / path.name).exists():
                (folder / path.name).symlink_to(path.resolve())
        (folder / "in.deck").unlink(missing_ok=True)
        (folder / "in.deck").write_text(text)
        (folder / "run.json").write_text(
            json.dumps({"variables": {**deck_variables(self.deck.path), **variables}}))
        seconds = int(min(self.limit, 100.0) if steps else self.limit) + 1
        command = launch.lammps("in.deck", 0, variables)  # no launcher: it dies with this process
        if steps:
            command = launch.callgrind("/dev/null") + command
        done = subprocess.run(command, cwd=folder, env=launch.environment(),
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True,
                              errors="replace", check=False,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU,
                                                                    (seconds, seconds)))
        cost = {"status": "ok", "why": None, "cpu_seconds": []}
        path = folder / "log.lammps"
        found = log.read(path) if path.exists() else None
        if done.returncode or found is None or not found.finished:
            why = (found.errors if found else None) or [line for line in done.stdout.splitlines()
                                                        if "ERROR" in line or "ignal" in line]
            return cost | {"status": "failed", "why": (why or ["stopped"])[0][:200],
                           "dx": found.values.get("dx") if found else None}
        if counted := re.search(r"Collected : (\d+)", done.stdout):
            cost["instructions"] = int(counted[1])
        if (folder / AT_FIRST).exists():
            cost["bodies"] = dump.bodies(next(dump.frames(folder / AT_FIRST)))
        return cost | cost_of(found)


def cost_of(found):
    """What the log of a whole run says of its cost."""
    runs = found.finished
    return {
        "cpu_seconds": [sum(run.cpu_seconds for run in runs)],
        "dx": found.values.get("dx"), "particles": runs[0].atoms,
        "steps": sum(run.steps for run in runs),
        # a sub-step moves the solid's particles only, and visits its bonds
        "particle_steps": round(sum(run.steps * (run.atoms + (found.substeps_of(run) - 1)
                                                 * found.solid_particles) for run in runs)),
        "pair_visits": found.pair_visits(),
        "neighbour_builds": sum(run.builds or 0 for run in runs)}


@contextlib.contextmanager
def quiet():
    """Analyses without their pictures and tables: a sweep wants the figures only."""
    drawn = plot.picture

    @contextlib.contextmanager
    def blank(*_, **__):
        yield plot.Figure()
    plot.picture = blank
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            yield
    finally:
        plot.picture = drawn


def sweep(store, jobs, say=print, budget=None):
    """Makes all points of `jobs`, [(label, settings, expected work in any unit)], the cheap ones
    first; then times them again.

    Repetitions go over all points in turn, so that what else the machine does at one time does not
    fall on one point alone. Says after each run how long the rest will take. budget [CPU s]: stop
    when so much has been used. Returns whether all is done.
    """
    jobs = sorted({store.path(settings): (label, settings, work)
                   for label, settings, work in jobs}.values(), key=lambda job: job[2])
    left = [job for job in jobs if store.get(job[1]) is None]
    say(f"cost: {len(jobs)} points, {len(left)} to run")
    used = worked = spent = 0.0
    for k, (label, settings, work) in enumerate(left, start=1):
        began = time.perf_counter()
        point = store.make(settings)
        used += sum(point["cpu_seconds"])
        if point["status"] == "ok":  # one that fails says nothing about the cost of the others
            worked, spent = worked + work, spent + time.perf_counter() - began
        rest = sum(job[2] for job in left[k:]) * (spent / worked if worked else 0.0)
        say(f"cost: {k}/{len(left)} {label}: "
            + (f"{point['cpu_seconds'][0]:.2f} CPU s" if point["status"] == "ok"
                                                 else f"{point['status']} ({point['why']})")
            + f"; {_time(rest)} left")
        if budget and used > budget and k < len(left):
            say(f"cost: {used:.0f} CPU s used, {len(left) - k} points left: the same command goes "
                "on from here")
            return False
    for turn in range(2, 1 + (store.repeats or max(n for _, n in REPEATS))):
        again = [job for job in jobs if len((point := store.get(job[1]))["cpu_seconds"])
                 < min(turn, store.wanted(point))]
        if again:
            expected = sum(min(store.get(job[1])["cpu_seconds"]) for job in again)
            say(f"cost: run {turn} of {len(again)} short points, {_time(expected)} of CPU time")
        for label, settings, _ in again:
            used += store.again(settings)["cpu_seconds"][-1]
            if budget and used > budget:
                say(f"cost: {used:.0f} CPU s used: the same command goes on with the repetitions")
                return True
    return True


def count(store, jobs, say=print):
    """Counts instructions of some points, [(label, settings)], where there is a valgrind and the
    counts are not there yet."""
    left = [job for job in jobs if (point := store.get(job[1])) and point["status"] == "ok"
            and "instructions" not in point]
    if left and shutil.which("valgrind") is None:
        say("cost: no valgrind, so instructions are not counted")
        return
    for label, settings in left:
        found = store.count(settings)
        say(f"cost: {label}: " + (f"{found['instructions']['instructions']:.3g} instructions in "
                                  f"{found['instructions']['steps']} steps"
                                  if found else "no instructions counted"))


def _time(seconds):
    return f"{seconds:.0f} s" if seconds < 100 else f"{seconds / 60:.0f} min"
