"""What the package says about a deck, in a copy of it and of the files that it names: every `run N`
becomes `run 0`. Then a few steps of each run for an estimate of time and memory."""

import math
import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

from . import dump, launch, log, paths
from .command import Refusal
from .sweep import deck_variables

# commands whose words are no input
WRITES = ("dump", "fsi/dump", "restart", "write_data", "write_dump", "write_restart", "write_coeff",
          "print", "shell")
NAMES_OUTPUT = ("file", "append")  # of fix and print
WORD = re.compile(r"""(?<![^\s"'])[^\s"']+""")
RUN = re.compile(r"^([ \t]*)run[ \t]+(\S+)(?:[^\n]*&[ \t]*\n)*[^\n]*$", re.M)
BODIES, FEW = "fsi_check.bodies", 6  # a dump of them; how many are listed
SAMPLE = 40  # steps of each run, of which the estimate is made
# a deck may loop until a step that no run reaches
MOST = 50
FIRST = 'if "!$(is_defined(variable,fsi_runs))" then "variable fsi_runs equal 0"\n'
COUNT = "variable fsi_runs equal $(v_fsi_runs+1)"
STOP = f"if $(v_fsi_runs)>{MOST} then quit"
CONDITIONAL_RUN = re.compile(r"""(["'])run[ \t][^"'\n]*(?=\1)""")


def lammps():
    """The LAMMPS of the build, or the one on the PATH."""
    found = str(paths.BUILD / "lmp") if (paths.BUILD / "lmp").exists() else shutil.which("lmp")
    if found is None:
        raise Refusal("there is no LAMMPS: neither build/lmp (tools/setup makes it; FSI_BUILD_DIR "
                      "says where) nor lmp on the PATH")
    return found


def inputs(deck, variables, folder):
    """(files below `folder` that a deck, and those that it includes, may read; those of them that
    hold commands).

    Words that name a file; a variable whose value is not known here stands for anything.
    """
    found, decks, waiting = set(), [deck], [deck]
    while waiting:
        path = waiting.pop()
        known = {**deck_variables(path), **variables}
        for line in path.read_text(errors="replace").replace("&\n", " ").splitlines():
            line = re.sub(r"(^|\s)#.*", "", line)
            words = WORD.findall(line)
            if not words or words[0] in WRITES:
                continue
            quoted = [(None, a or b) for a, b in re.findall(r'"([^"]*)"|\'([^\']*)\'', line)]
            for before, word in [*zip(words, words[1:]), *quoted]:
                if before in NAMES_OUTPUT and words[0] == "fix":
                    continue
                word = spelled(word, known)
                if len(word.replace("*", "")) < 3 or word.startswith("/"):
                    continue
                for file in folder.glob(word) if "*" in word else [folder / word]:
                    if file.is_file() and file not in found:
                        found.add(file)
                        if words[0] in ("include", "jump"):
                            decks.append(file)
                            waiting.append(file)
    return found, decks


def spelled(word, known):
    """A word with the values of variables, * for those that are not known"""
    word = re.sub(r"\$\{(\w+)\}|\$(\w)", lambda m: known.get(m[1] or m[2], "*"), word)
    return re.sub(r"\*+", "*", re.sub(r"\$\([^)]*\)", "*", word))


def kept_below(root, place, text, known):
    """A deck's text that writes below `root` what it would write to absolute paths, and one log;
    folders that it writes into, seen from `place`, are made."""
    def moved(line):
        words = list(WORD.finditer(line))
        if words and words[0][0] == "log":
            return "\n"
        for before, word in reversed(list(zip(words, words[1:]))):
            path = spelled(word[0], known)
            if "/" in path and (before[0] in NAMES_OUTPUT or words[0][0] in WRITES[:-2]):
                above = root if path.startswith("/") else ""
                Path(place, f"{above}{path}").parent.mkdir(parents=True, exist_ok=True)
                line = line[:word.start()] + above + line[word.start():]
        return line

    return "".join(map(moved, text.splitlines(keepends=True)))


def spelled_out(text):
    """A deck's text with the commands that fsi/run stands for."""
    clock, lines = None, []
    for line in text.splitlines():
        if found := re.match(r"[ \t]*(fix[ \t]+\S+[ \t]+\S+[ \t]+fsi/dt[ \t][^#&]*)", line):
            clock = re.sub(r"\bstop[ \t]+\S+", "", found[1]).rstrip()
        found = re.match(r"[ \t]*fsi/run[ \t]+(\S+)([^#]*)", line)
        if found:
            clock = clock or f"fix fsi_dt all fsi/dt 10 {found[2]}".rstrip()
        lines += [f"{clock} stop {found[1]}", "run 1000000000"] if found else [line]
    return "\n".join(lines) + "\n"


def shortened(text, steps=0):
    """A deck's text in which every run computes so few steps; how long it would have been is
    printed, and the time step at its end. Without a step bodies are dumped. It ends after MOST
    runs."""
    text = spelled_out(text)
    text = CONDITIONAL_RUN.sub(rf"\1{COUNT}\1 \1{STOP}\1 \1run {steps}", text)
    after = ('\n{0}print "FSI dt $(dt)"' if steps else "\n{0}write_dump all custom " + BODIES
             + " id type mol x y z modify time yes thresh mol > 0")
    return RUN.sub(lambda m: f'{m[1]}print "FSI steps {m[2]}"\n'
                   f"{m[1]}{COUNT}\n{m[1]}{STOP}\n"
                   f'{m[1]}run {"0" if m[2] == "0" else steps}' + after.format(m[1]), text)


def run(deck, variables, steps=0, look=None):
    """(LAMMPS' exit status, what it printed, its log as read, the log's text) of a deck whose runs
    have so many steps; look: given its folder."""
    deck, folder = Path(deck).resolve(), Path.cwd()
    if not deck.is_file():
        raise Refusal(f"{deck} is not a file")
    with tempfile.TemporaryDirectory(prefix="fsi_check_") as name:
        place = Path(name, *folder.parts[1:])  # what is in .. has a place, too
        place.mkdir(parents=True)
        for path in folder.iterdir():
            if path.is_dir():
                (place / path.name).mkdir()  # what a deck writes into a folder needs the folder
        files, decks = inputs(deck, variables, folder)
        for file in {*files, deck}:
            target = place / (file.relative_to(folder) if folder in file.parents else file.name)
            target.parent.mkdir(parents=True, exist_ok=True)
            if file in decks:
                text = kept_below(name, place, file.read_text(errors="replace"),
                                  {**deck_variables(file), **variables})
                target.write_text(FIRST * (file == deck) + shortened(text, steps))
            else:
                shutil.copyfile(file, target)
        command = [lammps(), "-in",
                   str(deck.relative_to(folder) if folder in deck.parents else deck.name), "-log",
                   "log.lammps", "-nocite"]
        for key, value in variables.items():
            command += ["-var", key, value]
        environment = launch.environment()
        if not paths.POTENTIALS.is_dir():  # not in the repository
            environment["LAMMPS_POTENTIALS"] = os.environ.get("LAMMPS_POTENTIALS", "")
        done = subprocess.run(command, cwd=place, env=environment, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True, errors="replace", check=False)
        if look:
            look(place)
        path = place / "log.lammps"
        return done.returncode, done.stdout, *((log.read(path), path.read_text(errors="replace"))
                                               if path.exists() else (None, ""))


def length(lines, found):
    """How long the runs would have been, in words: to a time where fix fsi/dt stops them, else so
    many steps."""
    steps = sum(int(float(line.split()[2])) for line in lines
                if re.fullmatch(r"FSI steps \d+(\.\d*)?(e\+?\d+)?", line))
    if found.stop is None:
        return f", {steps} steps" if steps else ""
    limits = [match[1] for line in lines
              if (match := re.search(r"Fix fsi/dt: .* limits the time step, to (\S+)", line))]
    return f", to t = {found.stop:g}" + (f" in {found.stop / float(limits[-1]):.2g} steps or more"
                                         if limits else "")


def estimate(found, text):
    """CPU seconds on one rank of a deck whose runs were shortened: those of a step of each, times
    the steps that it would have had. None: not known."""
    seconds, time, stop, steps, runs = 0.0, 0.0, None, None, iter(found.finished)
    for line in text.splitlines():
        if match := log.STOP.match(line):
            stop = float(match[1])
        elif match := re.fullmatch(r"FSI steps ([\d.e+]+)", line):
            steps = float(match[1])
        elif line.startswith("Loop time of"):
            run = next(runs, None)
        elif (match := re.fullmatch(r"FSI dt (\S+)", line)) and run and run.steps:
            if stop is not None:
                steps = min((stop - time) / float(match[1]), steps or math.inf)
                time = stop
            if steps is None:
                return None
            seconds += run.cpu_seconds / run.steps * steps
            steps = None
    return seconds or None


def cost(deck, variables):
    """The estimate in words"""
    status, _, found, text = run(deck, variables, SAMPLE)
    seconds = estimate(found, text) if status == 0 and found else None
    if seconds is None:
        return "fsi check: no estimate of time: the deck does not run in parts\n"
    in_words = (f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} min" if seconds < 7200
                else f"{seconds / 3600:.0f} h")
    memory = max(r.bytes_per_rank or 0.0 for r in found.finished) / 1e6  # as LAMMPS counts it
    return (f"fsi check: about {in_words} of CPU time on one rank, by {SAMPLE} steps of each run: "
            "within a factor of 2 if the number of particles and the time "
            f"step stay; arrays of {memory:.0f} MB\n")


def bodies(folder):
    """[what each body is made of], of the dump in `folder`: a flap whose length is no whole number
    of spacings is shorter than its region."""
    path = folder / BODIES
    frame = next(iter(dump.frames(path)), None) if path.exists() else None
    if frame is None or not len(frame):
        return []
    found = [f"fsi check: {name}: {number} particles, {' x '.join(f'{s:.3g}' for s in sizes)} "
             f"spacings of {dump.spacing(frame.select(frame['mol'] == int(name.split()[1]))):.3g}"
             for name, number, sizes in dump.bodies(frame) if sizes]
    return found[:FEW] + ([f"fsi check: and {len(found) - FEW} more"] if len(found) > FEW else [])


def main(deck, variables):
    """Prints what there is to say; 0 if the deck runs and there is no advice of the package; LAMMPS
    has warnings that are of no concern here."""
    made_of = []
    status, output, found, _ = run(deck, variables,
                                   look=lambda folder: made_of.extend(bodies(folder)))
    lines = output.splitlines()
    for start, line in enumerate(lines):
        if line.startswith("FSI: "):  # the effects: up to where LAMMPS goes on
            end = next((k for k in range(start + 1, len(lines)) if not lines[k].startswith("  ")),
                       len(lines))
            print("\n".join(lines[start:end]))
    warnings = list(dict.fromkeys(line for line in lines if line.startswith("WARNING")))
    # before the place in the source
    advice = [line for line in warnings if re.search("fsi", line.rpartition(" (")[0] or line, re.I)]
    errors = [line for line in lines if line.startswith(("ERROR", "Last input line"))]
    if warnings or errors:
        print(*warnings, *errors, sep="\n")
    ran = found.finished if found else []
    if status:
        if not errors:
            print(*lines[-5:], sep="\n")
        print(f"fsi check: {deck} does not run" if not ran else
              f"fsi check: {deck} fails after {len(ran)} of its runs were set up; perhaps only "
              "because no step was computed")
        return 1
    if not ran:
        print(f"fsi check: {deck} has no run")
        return 1
    if made_of:
        print(*made_of, sep="\n")
    if len(ran) >= MOST:
        print(f"fsi check: only the first {MOST} runs: a loop goes on until a step or time that "
              "these do not reach, or is long")
    print(cost(deck, variables), end="")
    print(f"fsi check: {ran[0].atoms} particles{length(lines, found)}; "
          + (f"{len(advice)} warning{'s' * (len(advice) > 1)}" if advice else "nothing to warn of")
          + (f" (and {len(warnings) - len(advice)} of LAMMPS' own)" if len(warnings) > len(advice)
             else ""))
    return 1 if advice else 0
