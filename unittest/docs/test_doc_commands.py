"""The commands of README.md, doc and the scenes' READMEs, beside those for LAMMPS that test_doc.py
runs.

Each is executed, in short where it is long; or, where executing it is what other tests do
(test_install.py, the suite itself), it is taken by the command line that it is for, up to where the
work would begin.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from decks import FIX, PAIRS, SETUP, STRESS
from scenes import run

from fsi import gallery, launch, paths, scene

sys.path.insert(0, str(paths.ROOT / "bench"))
import accuracy_cost  # noqa: E402
import effects  # noqa: E402
import open_ends  # noqa: E402
import peers  # noqa: E402
import ranks  # noqa: E402
import renew  # noqa: E402
import robustness  # noqa: E402
import largest  # noqa: E402
import scaling  # noqa: E402
import solid_variants  # noqa: E402
import sound  # noqa: E402

NOTES = paths.ROOT / "doc/notes"    # of what was tried at its time
PAGES = [paths.ROOT / "README.md",
         *(page for page in (paths.ROOT / "doc").rglob("*.md") if NOTES not in page.parents),
         *(paths.ROOT / "doc/src").glob("*.rst"),
         *(paths.folder(name) / "README.md" for name in paths.scenes())]
PROGRAMS = (r"tools/\w+|build/lmp|mpirun |fsi |python3? -m |pip install |cmake -|export |cp |git "
            r"|apt(?:-get)? ")
PLACEHOLDERS = {"NAME": "elastic_gate", "SCENE": "elastic_gate", "CASE": "10MPa_3_across",
                "FILE": "unittest/styles/test_dt.py", "R": "2.5", "FOLDER": "results/beam",
                "COMMAND": "log", "0.8": "0.1"}    # the last: a time of the beam's
COST = {"solids": solid_variants, "effects": effects, "peers": peers, "scaling": scaling,
        "ranks": ranks, "largest": largest, "robustness": robustness,
        "open_ends": open_ends, "sound": sound}  # as tools/cost chooses


def fenced(path, text):
    """[(language, content)] of a page's blocks; Markdown's without a language are for the shell."""
    if path.suffix == ".md":
        return [(language or "bash", block)
                for language, block in re.findall(r"^```(\w*)\n(.*?)^```$", text, re.M | re.S)]
    return [(language, re.sub("^   ", "", block, flags=re.M))
            for language, block in re.findall(r"^\.\. code-block:: *(\w+)\n\n((?:   .*\n|\n)+)",
                                              text, re.M)]


def inline(path, text):
    """Commands in the running text; one broken over two lines is one."""
    text = re.sub(r"^```.*?^```$", "", text, flags=re.M | re.S)
    quoted = r"(?<!`)`([^`]+)`(?!`)" if path.suffix == ".md" else r"``([^`]+)``"
    return [" ".join(code.split()) for code in re.findall(quoted, text)
            if re.match(f"(?:[A-Z]+=\\S+ )?(?:{PROGRAMS})", code)]


def sessions():
    """{commands of a block, or one of the text: where it is first}"""
    found = {}
    for path in sorted(PAGES):
        text = path.read_text()
        blocks = [tuple(re.sub(r"\s+#.*", "", line) for line in block.splitlines() if line.strip())
                  for language, block in fenced(path, text) if language in ("bash", "sh")]
        for lines in [*blocks, *((code,) for code in inline(path, text))]:
            found.setdefault(lines, path.relative_to(paths.ROOT))
    return found


SESSIONS = sessions()


class Reached(Exception):
    """A command line came to where it would build: it has taken all of its arguments."""


def shell(text, home, cwd=None, status=0, without=()):
    """Runs commands with bash; their output. without: variables of the environment that the
    commands themselves set."""
    environment = {k: v for k, v in launch.environment().items() if k not in without}
    environment["PATH"] = f"{home}/bin:{environment['PATH']}"
    done = subprocess.run(["bash", "-e", "-c", text], cwd=cwd or home, env=environment,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, errors="replace", check=False)
    assert done.returncode == status, f"{text}\n" + "\n".join(done.stdout.splitlines()[-15:])
    return done.stdout


def fewer_frames(path, left=3):
    """Keeps some frames of a dump, the first and the last among them: a film is a picture for
    each."""
    start = "ITEM: TIME\n"
    frames = path.read_text().split(start)[1:]
    path.write_text("".join(start + frames[round(k * (len(frames) - 1) / (left - 1))]
                            for k in range(left)))


@pytest.fixture(scope="module")
def home(tmp_path_factory):
    """What the reader has around: the repository (links), what two starters left there, a deck and
    an outline of their own, a LAMMPS tree."""
    folder = tmp_path_factory.mktemp("home")
    for entry in paths.ROOT.iterdir():
        if entry.name not in ("results", "build"):
            (folder / entry.name).symlink_to(entry)
    (folder / "build").symlink_to(paths.BUILD)
    deck = (paths.ROOT / "doc/src/in.howto").read_text()
    (folder / "my_script.in").write_text("variable kernel index wendland\n" + deck)
    (folder / "bin").mkdir()
    for name, module in {"python": "", "python3": "", "fsi": "-m fsi"}.items():
        (folder / "bin"
         / name).write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} {module} "$@"\n')
        (folder / "bin" / name).chmod(0o755)
    for name, tend in (("droplet", 0.05), ("beam", 0.3)):
        shell(f"tools/run {name} tend={tend} ranks=1 out=results/{name}", folder)
        fewer_frames(folder / "results" / name / "particles.dump")
    beam = folder / "results/beam"
    shutil.copy(beam / "log.lammps", beam / "log.fine")
    shutil.copy(beam / "tip.csv", beam / "coarse.csv")
    (beam / "outline.csv").write_text("0,0\n0.2,0\n0.2,0.1\n0,0.1\n")
    (beam / "probe.ave").write_text("# Time-averaged data for fix 1\n# TimeStep c_probe\n0 1.5\n"
                                    "100 2.5\n")
    tree = folder / "LAMMPS"
    for name in ("src", "potentials"):
        (tree / name).mkdir(parents=True)
    shutil.copytree(paths.lammps_source() / "cmake", tree / "cmake")
    return folder


@pytest.fixture
def reader(home, monkeypatch):
    """Runs or checks commands, one after the other, as someone in `home` would."""
    monkeypatch.chdir(home)

    def reached(*_):
        raise Reached
    monkeypatch.setattr(scene, "build", reached)
    return Reader(home)


class Reader:
    """One shell's session."""

    def __init__(self, home):
        self.home, self.before, self.set = home, [], []

    def say(self, command):
        """A command of a page."""
        command = re.sub(r"\[(-[^\]]*)\]", r"\1", command)  # what may be left out
        for name, value in {"<where>": f"{self.home}/prefix",
                            "<LAMMPS tree>": f"{self.home}/LAMMPS",
                            "<sources of that LAMMPS>": str(paths.lammps_source()),
                            "<this repository>": f"file://{paths.ROOT}"}.items():
            command = command.replace(name, value)
        for name, value in PLACEHOLDERS.items():
            command = re.sub(rf"\b{name}\b", value, command)
        words = shlex.split(command)
        while re.fullmatch(r"[A-Z]+=.*", words[0]):
            words.pop(0)
        program = words[0]
        if program.startswith("tools/"):
            assert os.access(paths.ROOT / program, os.X_OK), f"there is no {program}"
        what = {"export": "prepare", ".": "prepare", "cp": "execute", "sed": "execute",
                "build/lmp": "mpirun", "python": "python3"}.get(
            program,
            re.sub("^tools/", "tools_", program).replace("tools_lammps-tree", "tools_lammps_tree"))
        handler = getattr(self, what, None)
        assert handler, f"this test does not know what to do with {program}"
        handler(command, words[1:])

    def prepare(self, command, _):
        """What later commands rely on, wherever they run."""
        self.before.append(command.replace("$PWD", shlex.quote(str(self.home))))
        self.set += re.findall(r"(\w+)=", command) if command.startswith("export") else []
        self.execute("true")

    def git(self, command, words):
        """The repository, but for its history."""
        self.execute(command.replace("git clone", "git clone -q --depth 1"))
        assert (self.home / words[-1] / "tools/run").exists()

    def cd(self, _, words):
        assert (self.home / words[0]).is_dir()

    def execute(self, command, _=None, cwd=None, **options):
        there = [f"cd {shlex.quote(str(cwd))}"] if cwd else []
        return shell("\n".join([*self.before, *there, command]), self.home, without=self.set,
                     **options)

    def mpirun(self, command, words):
        """LAMMPS reads the whole deck, but computes no step; without a deck the program is
        there."""
        if "-in" not in words:
            return self.execute(f"{command} true" if command.startswith("mpirun")
                                else f"command -v {command}")
        # in.second goes on from what the one writes; the others are short
        if {"in.first", "doc/src/recipes/in.buoy", "doc/src/recipes/in.slow"} & set(words):
            return self.execute(command)
        # where there is one core
        crowded = ("OMPI_MCA_rmaps_base_oversubscribe=1 "
                   "PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe")
        return self.execute(f"{crowded} {command} -skiprun -log none")

    def mv(self, _, words):
        """What a run left gets another name: `home` has it there already."""
        assert (self.home / "results/beam" / words[1]).exists()

    def lmp(self, _, words):
        """A scene's deck, in its folder: here in a copy, where what it writes is no litter."""
        assert words[0] == "-in" and len(words) == 2
        folder = paths.EXAMPLES / words[1].removeprefix("in.")
        assert (folder / words[1]).exists(), f"there is no {words[1]} in {folder}"
        copy = self.home / "decks" / folder.name
        copy.mkdir(parents=True, exist_ok=True)
        for path in [folder / words[1], *folder.glob("*.in")]:  # what the deck includes
            shutil.copy(path, copy)
        self.execute(
            shlex.join([str(paths.BUILD / "lmp"), "-in", words[1], "-skiprun", "-log", "none"]),
            cwd=copy)

    def fsi(self, command, words):
        """Of files that a run left: in its folder. A command without a file is spoken of, not
        run."""
        if len(shlex.split(command)) == 2:
            command += " --help"
        self.execute(command, cwd=self.home if re.search("results/|doc/", command) else self.home
                     / "results/beam")

    def python3(self, command, words):
        if words[0] == "control.py":  # test_recipes.py runs it
            return self.execute(f"python3 -m py_compile {words[0]}")
        module, arguments = words[1], words[2:]
        assert words[0] == "-m"
        if module.split(".")[0] == "fsi" and not arguments:
            self.execute(f"{command} 2>&1 | grep -i usage")
        elif module == "fsi" and len(arguments) == 1:  # spoken of, not run
            self.execute(f"{command} --help")
        elif module.split(".")[0] == "fsi":
            self.fsi(command, words)
        else:
            text = self.execute(f"python3 -m {module} --help")
            assert all(word in text for word in arguments if word.startswith("-"))

    def pip(self, _, words):
        # test_python.py does it
        assert words[0] == "install" and (self.home / words[1] / "pyproject.toml").exists()

    def cmake(self, command, words):
        """Installs for real; of the others that folders, generator and variables exist.
        test_install.py configures."""
        options = dict(zip(words[::2], words[1::2]))
        if "--install" in options:
            return self.execute(command)
        if "--build" in options:
            assert list(options) == ["--build"] and options["--build"].startswith("build")
            return None
        values = [word for word in words if word.startswith("-D")]
        options = dict(zip(*[iter(word for word in words if word not in values)] * 2))
        assert set(options) <= {"-S", "-B", "-G"}
        lists = self.home / options["-S"] / "CMakeLists.txt"
        known = cmake_variables() | {f"PKG_{name}" for name in re.search(
            r"STANDARD_PACKAGES([^)]*)", lists.read_text() + "STANDARD_PACKAGES")[1].split()}
        assert {value[2:].partition("=")[0] for value in values} <= known
        assert options.get("-G", "Ninja") in self.execute("cmake --help")
        return None

    def tools_run(self, command, words):
        """Takes its arguments; with settings of its own LAMMPS takes them, too."""
        if not words:
            text = self.execute(command)
            assert all(f"  {name} " in text for name in scene.scenes())
            return
        with pytest.raises(Reached):
            scene.main(words)
        _, variables = scene.parse(words[1:])
        # those have run: their logs are in the tree
        if variables and gallery.short().get(words[0]) != variables:
            lammps = launch.lammps(scene.deck(words[0]), 0, variables)
            self.execute(shlex.join([*lammps, "-skiprun"]))

    def tools_cost(self, command, words):
        if not words:
            assert "elastic_gate" in self.execute(command)
            return
        program = COST.get(words[0], accuracy_cost)
        with pytest.raises(Reached):
            program.main(words[words[0] in COST:])

    def tools_renew(self, _, words):
        """What it does is in test_renew.py."""
        assert set(words) <= set(renew.WORDS)
        assert "tools/renew --pages-only" in self.execute("tools/renew --help")

    def tools_gallery(self, _, words):
        if words:
            with pytest.raises(Reached):
                gallery.main(words)

    def tools_pytest(self, _, words):
        """Finds tests. Also what the suite and the coverage hand on to pytest."""
        if words:  # without any found pytest's status is 5
            self.execute(shlex.join([str(paths.ROOT / "tools/pytest"), "--collect-only", "-p",
                                     "no:cacheprovider", *words]), cwd=paths.ROOT)

    def tools_test(self, _, words):
        self.tools_pytest(_, [word for word in words if word != "--quick"])

    tools_coverage = tools_pytest

    def tools_proof(self, _, words):  # test_proof.py looks at what it does
        assert len(words) == 1 and "hashes" in self.execute("python3 -m fsi.proof --help")

    def tools_setup(self, _, words):
        text = self.execute("tools/setup --help")
        assert all(word.partition("=")[0] in text for word in words)

    def tools_kokkos(self, _, words):
        """What it does takes another system: it is run by hand."""
        text = self.execute("tools/kokkos --help")
        assert all(word in text for word in words if word.startswith("--"))

    def tools_lammps_tree(self, command, _):
        self.execute(f"{command}/tree --changes --lammps {shlex.quote(str(paths.lammps_source()))}")

    def tools_film(self, _, words):  # test_pictures.py looks at its scenes
        assert not words and "film" in self.execute("tools/film --help")

    def tools_doc(self, _, words):
        assert len(words) <= 1  # test_doc.py does it


def cmake_variables():
    """Names of all options that the build knows, LAMMPS' as well; the last two where they are
    given."""
    return {*re.findall(r"^(\w+):", (paths.BUILD / "CMakeCache.txt").read_text(), re.M),
            "CMAKE_CXX_STANDARD", "EXTERNAL_KOKKOS"}


@pytest.mark.parametrize("commands", SESSIONS, ids=[f"{path}-{'; '.join(lines)[:60]}"
                                                    for lines, path in SESSIONS.items()])
def test_commands(reader, commands):
    for command in commands:
        reader.say(command)


def test_pages_are_read():
    """Each README of a scene says how it is run; and blocks are of known languages, none is left
    out."""
    assert {path.parent.name for path in SESSIONS.values()
            if path.parts[0] in ("examples", "unittest")} == set(scene.scenes())
    for path in PAGES:
        languages = {language for language, _ in fenced(path, path.read_text())}
        assert languages <= {"bash", "sh", "LAMMPS", "python", "json", "text", "none"}, path


def test_options_of_cmake_exist():
    named = {name for path in PAGES
             for name in re.findall(r"(?<!\S)[`\[]*-D(\w+)=", path.read_text())}
    assert {"FSI_NATIVE", "PKG_VTK", "LAMMPS_SIZES"} <= named <= cmake_variables() | {"PKG_FSI"}


def test_container_and_ci_do_what_the_readme_says():
    """The Dockerfile runs commands of the quick start in a system that the README names; .ci/run
    runs the tests that it names."""
    read = (paths.ROOT / "README.md").read_text()
    quick = next(lines for lines in SESSIONS if lines[0].startswith("git clone"))
    steps = [line.split(maxsplit=1) for line in (paths.ROOT / "Dockerfile").read_text().splitlines()
             if line and not line.startswith("#")]
    assert [word for word, _ in steps] == ["FROM", "COPY", "WORKDIR", "RUN", "ENV", "CMD"]
    said = dict(steps)
    assert said["FROM"] == "debian:bookworm" and "On Debian 12" in read
    assert said["COPY"] == f". {said['WORKDIR']}" and said["RUN"] in quick
    assert f"export {said['ENV'].replace(said['WORKDIR'], '$PWD')}" in quick
    assert not {"build*", "results"} - set((paths.ROOT / ".dockerignore").read_text().split())
    deck = re.search(r"^#.* build/lmp -in (\S+)$", (paths.ROOT / "Dockerfile").read_text(), re.M)[1]
    assert (paths.ROOT / deck).exists()
    suite = re.search(r"/\.\./(tools/\w+)\"$", (paths.ROOT / ".ci/run").read_text(), re.M)[1]
    assert suite in {command.split()[0] for command in quick}


@pytest.mark.parametrize("path", [path for path in PAGES if any(
    language == "python" for language, _ in fenced(path, path.read_text()))],
                         ids=lambda path: path.name)
def test_python(home, monkeypatch, tmp_path, path):
    """The pages' Python, on what the beam left."""
    from fsi.summary import Summary
    shutil.copytree(home / "results/beam", tmp_path / "beam", symlinks=True)
    monkeypatch.chdir(tmp_path / "beam")
    for language, block in fenced(path, path.read_text()):
        if language == "python":
            exec(block, {"Summary": Summary, "folder": Path(".")})  # pylint: disable=exec-used


def test_decks_that_are_no_page_of_a_command(tmp_path):
    """The README's commands and those of the page on output, in a scene of water and plate."""
    page = paths.ROOT / "doc/src/output.rst"
    output = "".join(block for language, block in fenced(page, page.read_text()) if language
                     == "LAMMPS")
    run(tmp_path, SETUP + PAIRS + FIX + STRESS + output + "run 1\n")
    assert (tmp_path / "particles.dump").exists() and list(tmp_path.glob("column.*.png"))
