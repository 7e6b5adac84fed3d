"""What the package says about a deck, without computing a step: every `run N` becomes `run 0`, in a copy of the deck and of the files that it names."""

import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

from . import launch, log, paths
from .command import Refusal
from .sweep import deck_variables

WRITES = ("dump", "restart", "write_data", "write_dump", "write_restart", "write_coeff", "log", "print", "shell")  # commands whose words are no input
RUN = re.compile(r"^([ \t]*)run[ \t]+(\S+)(?:[^\n]*&[ \t]*\n)*[^\n]*$", re.M)
CONDITIONAL_RUN = re.compile(r"""(["'])run[ \t][^"'\n]*(?=\1)""")


def lammps():
    """The LAMMPS of the build, or the one on the PATH."""
    found = str(paths.BUILD / "lmp") if (paths.BUILD / "lmp").exists() else shutil.which("lmp")
    if found is None:
        raise Refusal("there is no LAMMPS: neither build/lmp (tools/setup makes it; FSI_BUILD_DIR says where) nor lmp on the PATH")
    return found


def inputs(deck, variables, folder):
    """(files below `folder` that a deck, and those that it includes, may read; those of them that hold commands).

    Words that name a file; a variable whose value is not known here stands for anything.
    """
    found, decks, waiting = set(), [deck], [deck]
    while waiting:
        path = waiting.pop()
        known = {**deck_variables(path), **variables}
        for line in path.read_text(errors="replace").replace("&\n", " ").splitlines():
            words = re.sub(r"(^|\s)#.*", "", line).replace('"', " ").replace("'", " ").split()
            if not words or words[0] in WRITES:
                continue
            for before, word in zip(words, words[1:]):
                if before in ("file", "append") and words[0] in ("fix", "print"):
                    continue
                word = re.sub(r"\$\{(\w+)\}|\$(\w)", lambda m: known.get(m[1] or m[2], "*"), word)
                word = re.sub(r"\*+", "*", re.sub(r"\$\([^)]*\)", "*", word))
                if len(word.replace("*", "")) < 3 or word.startswith("/") or ".." in Path(word).parts:
                    continue
                for file in folder.glob(word) if "*" in word else [folder / word]:
                    if file.is_file() and file not in found:
                        found.add(file)
                        if words[0] in ("include", "jump"):
                            decks.append(file)
                            waiting.append(file)
    return found, decks


def without_steps(text):
    """A deck's text in which every run sets up and computes nothing; how long it would have been is printed."""
    text = CONDITIONAL_RUN.sub(r"\1run 0", text)
    return RUN.sub(lambda m: f'{m[1]}print "FSI steps {m[2]}"\n{m[1]}run 0', text)


def run(deck, variables):
    """(LAMMPS' exit status, what it printed, its log as read) of a deck without its steps."""
    deck, folder = Path(deck).resolve(), Path.cwd()
    if not deck.is_file():
        raise Refusal(f"{deck} is not a file")
    with tempfile.TemporaryDirectory(prefix="fsi_check_") as name:
        place = Path(name)
        for path in folder.iterdir():
            if path.is_dir():
                (place / path.name).mkdir()  # what a deck writes into a folder needs the folder
        files, decks = inputs(deck, variables, folder)
        for file in {*files, deck}:
            target = place / (file.relative_to(folder) if folder in file.parents else file.name)
            target.parent.mkdir(parents=True, exist_ok=True)
            if file in decks:
                target.write_text(without_steps(file.read_text(errors="replace")))
            else:
                shutil.copyfile(file, target)
        command = [lammps(), "-in", str(deck.relative_to(folder) if folder in deck.parents else deck.name), "-log", "log.lammps", "-nocite"]
        for key, value in variables.items():
            command += ["-var", key, value]
        environment = launch.environment()
        if not paths.POTENTIALS.is_dir():  # not in the repository
            environment["LAMMPS_POTENTIALS"] = os.environ.get("LAMMPS_POTENTIALS", "")
        done = subprocess.run(command, cwd=place, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True, errors="replace", check=False)
        path = place / "log.lammps"
        return done.returncode, done.stdout, log.read(path) if path.exists() else None


def length(lines, found):
    """How long the runs would have been, in words: to a time where fix fsi/dt stops them, else so many steps."""
    steps = sum(int(float(line.split()[2])) for line in lines if re.fullmatch(r"FSI steps \d+(\.\d*)?(e\+?\d+)?", line))
    if found.stop is None:
        return f", {steps} steps" if steps else ""
    limits = [match[1] for line in lines if (match := re.search(r"Fix fsi/dt: .* limits the time step, to (\S+)", line))]
    return f", to t = {found.stop:g}" + (f" in {found.stop / float(limits[-1]):.2g} steps or more" if limits else "")


def main(deck, variables):
    """Prints what there is to say; 0 if the deck runs and there is no advice of the package; LAMMPS has warnings that are of no concern here."""
    status, output, found = run(deck, variables)
    lines = output.splitlines()
    for start, line in enumerate(lines):
        if line.startswith("FSI: "):  # the effects: up to where LAMMPS goes on
            end = next((k for k in range(start + 1, len(lines)) if not lines[k].startswith("  ")), len(lines))
            print("\n".join(lines[start:end]))
    warnings = list(dict.fromkeys(line for line in lines if line.startswith("WARNING")))
    advice = [line for line in warnings if re.search("fsi", line.rpartition(" (")[0] or line, re.I)]  # before the place in the source
    errors = [line for line in lines if line.startswith(("ERROR", "Last input line"))]
    if warnings or errors:
        print(*warnings, *errors, sep="\n")
    ran = found.finished if found else []
    if status:
        if not errors:
            print(*lines[-5:], sep="\n")
        print(f"fsi check: {deck} does not run" if not ran else
              f"fsi check: {deck} fails after {len(ran)} of its runs were set up; perhaps only because no step was computed")
        return 1
    if not ran:
        print(f"fsi check: {deck} has no run")
        return 1
    print(f"fsi check: {ran[0].atoms} particles{length(lines, found)}; "
          + (f"{len(advice)} warning{'s' * (len(advice) > 1)}" if advice else "nothing to warn of")
          + (f" (and {len(warnings) - len(advice)} of LAMMPS' own)" if len(warnings) > len(advice) else ""))
    return 1 if advice else 0
