"""Runs the scenes in examples/, and the drivers of tests in unittest/: builds, simulates, analyzes.
The command line of tools/run.

Each scene is a folder with an analyze.py whose main(folder) writes summary.json and pictures, and a
deck, study/in.<scene>. in.<scene> is the same in few lines, for users to copy
(unittest/scenes/test_plain_decks.py); starters have this one alone. One that needs several runs
lists them in cases.json, {"CASE": {"variables": {...}, "ranks": N}} with `ranks` optional; after
them study(folder, {case: its folder}) of analyze.py writes what is said about all of them into the
folder above. A case may run another scene's deck, with any of its variables and the edits that
edits.json names, and it may be one whose failure is a result.
"""

import difflib
import importlib.util
import json
import os
import re
import subprocess
import sys
import time
import traceback
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from datetime import date
from io import StringIO
from itertools import groupby
from multiprocessing import get_context
from pathlib import Path

from . import launch, log, paths, report, results
from .command import Refusal, split, start, whole
from .paths import scenes
from .summary import RUN_FILE
from .sweep import Deck, deck_variables

OPTIONS = ("ranks", "out", "case")
MADE_FILE = ".made-by-tools-run"
CASES_FILE = "cases.json"
# where nobody says how many: small scenes gain nothing by more, and on a busy machine ranks wait
# for each other
RANKS = 1
# {name: {"find": regular expression, "put": text with {value}}}: settings that no deck has a
# variable for
EDITS_FILE = "edits.json"
# of a scene without cases
ONE_RUN = {"variables": {}, "ranks": None, "deck": None, "may_fail": False}
# folder of a run with the user's variables beside the cases, whose results stay as they are
OWN_RUN = "custom"
# what decides a result
SOURCES = ("src", "cmake", "potentials", "examples", "python", "tools", "bench", "unittest/hard")


def deck(scene):
    """The scene's input file with the settings that sweeps and tests need: that in study/ where
    there is one."""
    folder = paths.folder(scene)
    study = folder / "study" / f"in.{scene}"
    return study if study.exists() else folder / f"in.{scene}"


def cases(scene):
    """The runs that make up a scene, {case: {"variables", "ranks", "deck", "may_fail"}}; {} if it
    is one run."""
    path = paths.folder(scene) / CASES_FILE
    if not path.exists():
        return {}
    try:
        found = {name: {"variables": {k: str(v) for k, v in case.get("variables", {}).items()},
                        "ranks": case.get("ranks"),
                        "deck": case.get("deck"), "may_fail": bool(case.get("may_fail"))}
                 for name, case in json.loads(path.read_text()).items()}
    except (ValueError, AttributeError) as error:
        raise Refusal(
            f"{path} is not of the form {{\"CASE\": {{\"variables\": {{...}}}}}}: "
            f"{error}") from None
    for name, case in found.items():
        if not re.fullmatch(r"\w[\w.+-]*", name) or name == OWN_RUN:
            raise Refusal(f"{path}: '{name}' cannot be a case, since it has to be the name of a "
                          "folder")
        if case["ranks"] is not None and (not isinstance(case["ranks"], int) or case["ranks"] < 1):
            raise Refusal(f"{path}: ranks of '{name}' must be a whole number, 1 or more")
        try:
            if case["deck"]:
                _borrowed(scene, case["deck"]).instance(case["variables"])
            else:
                check(scene, case["variables"])
        except Refusal as refusal:
            raise Refusal(f"{path}: case '{name}': {refusal}") from None
    return found


def _borrowed(scene, name):
    """The deck of another scene, with the edits of `scene`."""
    if name not in scenes():
        raise Refusal(f"there is no scene '{name}'{_similar(name, scenes())}")
    path = paths.folder(scene) / EDITS_FILE
    return Deck(deck(name), json.loads(path.read_text()) if path.exists() else None)


def parse(arguments):
    """Splits NAME=VALUE arguments into (options of this tool, LAMMPS variables)."""
    options, variables = split(arguments, OPTIONS, "NAME=VALUE, such as ranks=2")
    if "ranks" in options:
        options["ranks"] = whole("ranks", options["ranks"])
    return options, variables


def check(scene, variables):
    """Refuses a scene or a variable that does not exist, and words where the deck's default is a
    number."""
    if scene not in scenes():
        listed = ", ".join(scenes()) or "none"
        raise Refusal(f"there is no scene '{scene}'{_similar(scene, scenes())}. Scenes: {listed}")
    known = deck_variables(deck(scene))
    for name, value in variables.items():
        if name not in known:
            listed = ", ".join(f"{n}={default}" for n, default in known.items()) or "none"
            raise Refusal(f"{scene} has no variable '{name}'{_similar(name, [*known, *OPTIONS])}. "
                          f"Its variables and their defaults: {listed}. Options: ranks=N, "
                          "out=FOLDER, case=NAME")
        if _is_number(known[name]) and not _is_number(value):
            raise Refusal(f"{name}={value}: a number is needed, such as the default {known[name]}")


def run(scene, folder, ranks, variables, case=None, borrowed=None, may_fail=False):
    """Simulates and analyses a scene in `folder`; returns 0 if all went well, else LAMMPS' exit
    status or 1.

    borrowed: name of the scene whose deck is run; may_fail: a run that LAMMPS ends with an error is
    analysed, too.
    """
    folder = Path(folder)
    with _record(folder):
        given = "".join(f" {name}={value}" for name, value in variables.items())
        print(f"run: {scene}{given} ranks={ranks}, results in {folder}", flush=True)
        path, settings = deck(scene), variables
        if borrowed:
            text, settings = _borrowed(scene, borrowed).instance(variables)
            path = folder / f"in.{borrowed}"
            path.write_text(text)
        status, seconds, output = _simulate(path, folder, ranks, settings)
        if status != 0:
            _explain(folder, status, output)
            if not may_fail:
                _report(folder)
                return status
        _write_run(folder, {"scene": scene, **({"case": case} if case else {}), "ranks": ranks,
                            "cpu_seconds": round(seconds, 3), "given": variables,
                            **({"status": status} if status else {}),
                            "variables": {**deck_variables(path), **variables}})
        module = analysis(scene)
        good = module is None or _calls(module.main, folder)
        _report(folder)
        if good:
            # far up among LAMMPS' own lines by now
            for line in dict.fromkeys(log.read(folder / "log.lammps").warnings):
                print(f"run: {line}")
            print(f"run: figures, pictures and log are in {folder}; all on one page: "
                  f"{folder / report.OUT}", flush=True)
        return 0 if good else 1


def run_cases(scene, folder, ranks=None):
    """Runs every case of a scene in a folder of its own below `folder`, then the study of those
    that ran.

    `ranks` overrides what the cases say. Returns 0 if all of it went well; a case that fails does
    not stop the others.
    """
    folder = Path(folder)
    wanted = cases(scene)
    ran = []
    for k, (name, case) in enumerate(wanted.items(), start=1):
        print(f"run: {scene}, case {name} ({k} of {len(wanted)})", flush=True)
        if run(scene, folder / name, ranks or case["ranks"] or RANKS, case["variables"], name,
               case["deck"],
               case["may_fail"]) == 0:
            ran.append(name)
    return study(scene, folder, list(wanted), ran)


def study(scene, folder, wanted, ran):
    """What is said about all cases of a scene, of those that ran; returns 0 if these are all and
    the analysis came to its end."""
    with _record(folder):
        failed = [name for name in wanted if name not in ran]
        _write_run(folder, {"scene": scene, "cases": ran, "failed": failed})
        good = not failed
        module = analysis(scene)
        if ran and hasattr(module, "study"):
            good &= _calls(module.study, folder, {name: folder / name for name in ran})
        _report(folder)
        print(f"run: {scene}: {len(ran)} of {len(wanted)} cases ran" +
              (f"; failed: {', '.join(failed)}" if failed else ""), flush=True)
        return 0 if good else 1


def run_all(names, folder, ranks=None):
    """Runs all cases of these scenes, as many side by side as there are cores, the longest first;
    returns the scenes of which something failed.

    `ranks` overrides what the cases say; those on several ranks come last. What an earlier call
    left at this commit is not run again.
    """
    folder = Path(folder)
    wanted = {scene: cases(scene) for scene in names}
    tasks = [(scene, folder / scene / (name or ""), ranks or case["ranks"] or RANKS,
              case["variables"], name, case["deck"], case["may_fail"])
             for scene, found in wanted.items()
             for name, case in (found or {None: ONE_RUN}).items()]
    now = commit()
    good = {task[1] for task in tasks if _is_there(task, now)}
    todo = [task for task in tasks if task[1] not in good]
    took = _seconds_of_page()
    typical = sum(took.values()) / len(took) if took else 60.0  # of what was never run
    estimates = {task[1]: took.get((task[0], task[4]), typical) for task in todo}
    todo.sort(key=lambda task: (task[2], -estimates[task[1]]))
    if good:
        print(f"run: {len(good)} of {len(tasks)} runs are there, of this commit", flush=True)
    began, k, sum_of_done, left = time.monotonic(), len(good), 0.0, sum(estimates.values())
    for on, some in groupby(todo, key=lambda task: task[2]):
        with ProcessPoolExecutor(max(1, launch.cores() // on),
                                 mp_context=get_context("fork")) as pool:
            running = {pool.submit(_apart, task): task for task in some}
            for future in as_completed(running):
                scene, place, _, _, name, *_ = running[future]
                status, seconds, output = future.result()
                if status == 0:
                    good.add(place)
                else:
                    print(output)
                k += 1
                sum_of_done += estimates[place]
                left -= estimates[place]
                spent = time.monotonic() - began
                print(f"run: {k} of {len(tasks)}: {' '.join(filter(None, (scene, name)))} "
                      f"{'took' if status == 0 else 'FAILED after'} {seconds:.0f} s; "
                      f"{spent / 60:.0f} minutes, some {spent * left / sum_of_done / 60:.0f} left",
                      flush=True)
    failed = []
    for scene, found in wanted.items():
        ran = [name for name in found if folder / scene / name in good]
        if study(scene, folder / scene, list(found), ran) if found else folder / scene not in good:
            failed.append(scene)
    return failed


def _apart(task):
    """(status, seconds, what it had to say) of a run in a process of its own."""
    began = time.monotonic()
    with redirect_stdout(StringIO()) as said, redirect_stderr(said):
        status = run(*task)
    return status, time.monotonic() - began, said.getvalue()


def _is_there(task, now):
    """Whether an earlier call left this very run, of a commit without changes."""
    _, folder, ranks, variables, *_ = task
    if now is None or now.endswith("+") or not (folder / "summary.json").exists():
        return False
    try:
        found = json.loads((folder / RUN_FILE).read_text())
    except (OSError, ValueError):
        return False
    return (found["commit"], found["ranks"], found["given"]) == (now, ranks, variables)


def left(scene, case):
    """The folder in which tools/run left a case of this commit on one core, its own deck whole;
    None if it did not."""
    found = cases(scene)[case]
    folder = paths.RESULTS / scene / case
    task = (scene, folder, RANKS, found["variables"], case)
    return folder if not found["deck"] and not found["may_fail"] and _is_there(task,
                                                                               commit()) else None


def _seconds_of_page():
    """{(scene, case): core seconds} of what the page of results knows."""
    took = {}
    for scene, entry in results.scenes_of(paths.PAGE).items():
        summary = entry["summary"] or {}
        for name, ran in (summary.get("cases") or {None: summary}).items():
            if ran.get("cpu_seconds"):
                took[scene, name] = ran["cpu_seconds"] * (ran.get("ranks") or 1)
    return took


def analysis(scene):
    """The scene's analyze.py as a module; None if it has none."""
    path = paths.folder(scene) / "analyze.py"
    if not path.exists():
        return None
    spec = importlib.util.spec_from_file_location(f"fsi_analyze_{scene}", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _calls(function, *arguments):
    """Whether an analysis comes to its end; if not, says why, so that what else is to be run can go
    on."""
    try:
        function(*arguments)
    except SystemExit as refusal:  # what the analysis has to say, in its own words
        print(f"\nrun: {refusal}", file=sys.stderr)
        return False
    except Exception:  # pylint: disable=broad-exception-caught
        print(f"\nrun: what was to be made of {arguments[0]} failed", file=sys.stderr)
        traceback.print_exc()
        return False
    return True


def _report(folder):
    """The page of a run or of a study, if there is something to be said."""
    if (folder / "log.lammps").exists() or (folder / "summary.json").exists():
        _calls(report.write, folder)


@contextmanager
def _record(folder):
    """Clears `folder` of what an earlier run left there; afterwards notes what this one leaves."""
    folder.mkdir(parents=True, exist_ok=True)
    _clear(folder)
    before = _files(folder)
    try:
        yield
    finally:
        # what is noted further down is that folder's own business
        below = {str(path.parent.relative_to(folder)) for path in folder.rglob(MADE_FILE)
                 if path.parent != folder}
        made = [name for name in sorted(_files(folder) - before - {MADE_FILE})
                if not any(str(parent) in below for parent in Path(name).parents)]
        (folder / MADE_FILE).write_text("".join(f"{name}\n" for name in made))


def _write_run(folder, record):
    """run.json: what was run, for the summary."""
    (folder / RUN_FILE).write_text(
        json.dumps({**record, "commit": commit(), "date": date.today().isoformat()}, indent=2)
        + "\n")


def commit():
    """The commit that is checked out, "+" behind it where sources differ from it; None without
    git."""
    def git(*words):
        return subprocess.run(["git", "-C", str(paths.ROOT), *words], capture_output=True,
                              text=True, check=True).stdout
    try:
        return git("rev-parse", "--short=10",
                   "HEAD").strip() + ("+" if git("status", "--porcelain", *SOURCES) else "")
    except (OSError, subprocess.CalledProcessError):
        return None


def _simulate(path, folder, ranks, variables):
    """Runs LAMMPS, its output going to the terminal; returns (status, CPU seconds per rank, last
    lines)."""
    command = launch.lammps(Path(path).resolve(), ranks, variables)
    started = time.perf_counter()
    tail = []
    with subprocess.Popen(command, cwd=folder, env=launch.environment(), stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          errors="replace") as process:
        for line in process.stdout:
            print(line, end="", flush=True)
            tail = [*tail[-199:], line.rstrip()]
        # what it waited for included: the ranks of mpirun
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    seconds = (usage.ru_utime + usage.ru_stime) / ranks
    print(f"run: LAMMPS took {time.perf_counter() - started:.1f} s, {seconds:.1f} s of CPU time on "
          "each core", flush=True)
    return process.returncode, seconds, tail


def _explain(folder, status, output):
    """Says why LAMMPS failed, in its own words."""
    errors = list(dict.fromkeys(line for line in output if "ERROR" in line
                                or line.startswith("Last ")))
    print(f"\nrun: LAMMPS failed (status {status}); the log is {folder / 'log.lammps'}",
          file=sys.stderr)
    for line in errors or output[-5:]:
        print(f"  {line}", file=sys.stderr)


def _files(folder):
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}


def _clear(folder):
    """Removes what an earlier run left, and nothing else: the folder may be the user's own."""
    listing = folder / MADE_FILE
    if listing.exists():
        for name in listing.read_text().splitlines():
            path = (folder / name).resolve()
            if folder.resolve() in path.parents:
                path.unlink(missing_ok=True)


def _similar(name, known):
    close = difflib.get_close_matches(name, known, n=1)
    return f" (did you mean '{close[0]}'?)" if close else ""


def _is_number(text):
    try:
        float(text)
    except ValueError:
        return False
    return True


def main(arguments):
    """tools/run with at least one argument."""
    if not arguments:
        raise Refusal("which scene? " + ", ".join(scenes()))
    options, variables = parse(arguments[1:])
    if arguments[0] != "all":
        job = _job(arguments[0], options, variables)
        return job() if build() else 1
    if "case" in options or variables:
        raise Refusal("case= and variables are for one scene, not for all")
    names = scenes()
    for name in names:
        cases(name)  # refused before the build
    if not build():
        return 1
    out = Path(options["out"]).resolve() if "out" in options else None
    failed = run_all(names, out or paths.RESULTS, options.get("ranks"))
    print(f"run: {len(names) - len(failed)} scenes ran, {len(failed)} failed", *failed)
    return 1 if failed else 0


def build():
    """Brings the build up to date; whether that worked."""
    return subprocess.run([str(paths.ROOT / "tools" / "setup")], check=False).returncode == 0


def _job(scene, options, variables):
    """What the command line asks of a scene, checked, as a function without arguments that returns
    an exit status."""
    check(scene, variables)
    known = cases(scene)
    ranks = options.get("ranks")
    out = Path(options["out"]).resolve() if "out" in options else None
    folder = out or paths.RESULTS / scene
    if known and not variables and "case" not in options:
        return lambda: run_cases(scene, folder, ranks)
    if "case" not in options:
        below = OWN_RUN if known and out is None else ""
        return lambda: run(scene, folder / below, ranks or RANKS, variables)
    name = options["case"]
    if name not in known:
        raise Refusal(f"{scene} has no case '{name}'{_similar(name, known)}. Its cases: "
                      f"{', '.join(known) or 'none'}")
    if variables:
        raise Refusal("case= sets the variables: give either it or NAME=VALUE")
    return lambda: run(scene, folder / name if out is None else folder,
                       ranks or known[name]["ranks"] or RANKS, known[name]["variables"], name,
                       known[name]["deck"], known[name]["may_fail"])


if __name__ == "__main__":
    start("run", main)
