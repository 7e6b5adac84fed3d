"""Decks of two or three runs with something given again, taken away, restarted, deleted or created
between them, made by chance.

    FSI_FUZZ=1000 tools/pytest -q -n 2 unittest/styles/test_fuzz.py -k runs        a thousand decks
    instead of the suite's

A deck ends well if it ends, or with an error in words; with numbers that are finite, and without
energy that comes from nothing.
"""

import random
import re
import subprocess

from redefined import MATERIALS, OTHER, SCENES, deck, part
from scenes import lammps

LIMIT = 60  # seconds for a deck of a second or less, on a busy machine
# What starts at up to 0.6 m/s under gravity, for a hundred steps of 1e-4 s, at a speed of sound of
# 10 m/s: a kick of the sound is seen
FASTEST = 3.0
WATER = "region spot{0} block {1} {2} {3} {4} INF INF units box"


class Maker:
    """The deck of a seed: text and number of ranks"""

    def __init__(self, seed):
        self.rng = random.Random(seed)
        self.scene = self.rng.choice(("tank", "tank", "updated", "open", "stream", "levels",
                                      "levels"))
        self.now = dict(SCENES[self.scene][0])
        self.types = int(re.search(r"create_box (\d+)", SCENES[self.scene][1])[1])
        # bodies whose density is that of their neighbors are in tension at faces and holes, and
        # tear
        self.others = {name: {t: r for t, r in texts.items() if "solid summation" not in t
                              and "solid ratio" not in t} for (scene, name), texts in OTHER.items()
                       if scene == self.scene}
        self.gone, self.spots, self.files = [], 0, 0
        for name in self.rng.sample(sorted(self.others), self.rng.choice((0, 0, 1, 2))):
            self.choose(name)
        self.lines = [deck(self.scene, **self.now)]
        self.ranks = self.rng.choice((1, 1, 1, 2))
        self.make()

    def choose(self, name):
        """Another command in its place, one that is not refused"""
        good = [text for text, refused in self.others[name].items() if not refused]
        if good:
            self.now[name] = self.rng.choice(good)

    def run(self, steps=None):
        self.lines.append(f"run {self.rng.randrange(5, 30) if steps is None else steps}")

    def make(self):
        self.run(self.rng.choice((None, None, 0)))
        for _ in range(self.rng.choice((1, 2))):
            for _ in range(self.rng.choice((1, 1, 2, 3))):
                self.rng.choice((self.again, self.again, self.again, self.another, self.another,
                                 self.another, self.take_away, self.bring_back, self.restart,
                                 self.delete, self.create, self.set_type, self.look, self.small,
                                 self.small))()
            self.run()
        self.lines.append("variable vmax equal vmax\nvariable fastest atom sqrt(vx*vx+vy*vy)\n"
                          "compute fastest all reduce max v_fastest\n"
                          "compute end all fsi/atom rho\ncompute thin all reduce min c_end\n"
                          "variable fast equal c_fastest\nvariable low equal c_thin\nrun 0\n"
                          'print "END ${fast} ${low}"')

    # ---- what is done between runs ----
    def give(self, name):
        """Its lines, and those that have to follow"""
        lines = self.now[name]
        word = lines.split()
        if word[0] in ("fix", "compute") and (word[0] == "compute" or self.rng.random() < 0.5):
            self.lines.append(f"un{word[0]} {word[1]}")
        self.lines.append(lines)
        if name == "pair":
            self.lines.append(self.now["coeff"])

    def names(self):
        return [n for n in self.now if n not in ("make", "settings", "coeff")
                and n not in self.gone]

    def again(self):
        self.give(self.rng.choice(self.names()))

    def another(self):
        name = self.rng.choice([n for n in self.others if n not in self.gone])
        if self.rng.random() < 0.15:    # one that is to be refused, maybe
            self.now[name] = self.rng.choice(list(self.others[name]))
        else:
            self.choose(name)
        self.give(name)

    def take_away(self):
        names = [n for n in self.names() if n not in ("pair", "fsi")]
        if not names:
            return self.again()
        name = self.rng.choice(names)
        word = self.now[name].split()
        self.lines.append(f"un{word[0]} {word[1]}")
        return self.gone.append(name)

    def bring_back(self):
        if not self.gone:
            return self.again()
        name = self.gone.pop(self.rng.randrange(len(self.gone)))
        return self.lines.append(self.now[name])

    def restart(self):
        file = f"file{self.files}.restart"
        self.files += 1
        commands = [self.now[n] for n in self.now if n not in ("make", "gone")
                    and n not in self.gone]
        variables = "\n".join(line for line in self.now["make"].splitlines()
                              if line.startswith(("variable", "region zone", "region near")))
        style = self.scene in ("tank", "updated")
        self.lines += [f"write_restart {file}", "clear", f"read_restart {file}",
                       variables + "\nvariable zero equal 0", *commands]
        if not style and self.rng.random() < 0.5:
            self.lines.remove(self.now["pair"])
            self.lines.insert(self.lines.index(f"read_restart {file}") + 1, self.now["pair"])

    def spot(self, low=0.0):
        self.spots += 1
        x, y, w = self.rng.uniform(-0.02, 0.2), self.rng.uniform(low,
                                                                 0.12), self.rng.uniform(0.01, 0.06)
        self.lines.append(WATER.format(self.spots, x, x + w, y, y + w))
        return f"spot{self.spots}"

    def delete(self):
        self.lines.append(
            f"delete_atoms region {self.spot()} compress {self.rng.choice(('yes', 'no'))}")

    def create(self):
        kind = self.rng.choice(range(1, self.types + 1))
        spot = self.spot(0.17 if self.rng.random() < 0.7 else 0.0)
        number, seed = self.rng.choice((1, 5, 20)), self.rng.randrange(1, 10000)
        apart = 1.2 if kind == 2 else 0.8    # not squeezed into a body
        self.lines.append(f"lattice sq 0.01 origin 0.5 0.5 0\ncreate_atoms {kind} random {number} "
                          f"{seed} {spot} overlap {apart} maxtry 100")
        if self.rng.random() < 0.5:
            self.lines.append(f"set region {spot} mol {self.rng.choice((0, 1, 7))}")
        groups = {1: "water", 2: "water" if self.scene == "levels" else "beam", 3: "piston"}
        if self.rng.random() < 0.8:
            self.lines.append(f"group {groups[kind]} type {kind}")
            if self.scene in ("tank", "updated") and kind < 3:
                self.lines.append(f"group made region {spot}\ngroup moves union moves made\n"
                                  "group made delete")

    def set_type(self):
        self.lines.append(
            f"set region {self.spot()} type {self.rng.choice(range(1, self.types + 1))}")

    def look(self):
        self.files += 1
        self.lines.append(self.rng.choice((
            f"write_dump all custom look{self.files} id type x y vx c_state[*]", "run 0",
            f"write_data look{self.files}.data", f"write_restart look{self.files}",
            "run 3 pre no", "variable look equal c_energy\nprint ${look}",
            "variable look equal f_particle[1]\nprint ${look}", "info computes fixes",
            "variable look equal f_dt[7]\nprint ${look}",
            "variable look equal c_probe[1]\nprint ${look}", "fsi/set water density 1000")))

    def small(self):
        self.lines.append(self.rng.choice((
            "timestep 5e-5", "reset_timestep 0", "reset_timestep 1000",
            "velocity water set 0.1 0.1 0 units box",
            "displace_atoms water move 0.001 0 0 units box",
            "neigh_modify every 2 delay 0 check yes", "atom_modify sort 5 0.01",
            "balance 1.0 shift xy 5 1.1", "variable s delete", "variable u delete",
            "region zone delete", "region water delete", "neighbor 0.004 bin",
            "comm_modify cutoff 0.06", "newton off", "reset_atoms id",
            "change_box all y final -0.06 0.36 units box",
            "comm_style tiled\nbalance 1.1 rcb", "run 5 every 2 \"variable k equal 1\"",
            "group water clear\ngroup water type 1", "set type 1 mol 0",
            "thermo_style custom step ke c_state[1]", "variable zero delete", "run 5 upto",
            "minimize 0 0 1 1")))

    def text(self):
        return "\n".join(self.lines) + "\n"


def verdict(result):
    """What is wrong with how a deck ended, and a word for the statistics"""
    errors = [line for line in result.output.splitlines() if "ERROR" in line]
    if result.status:
        if not errors or any(w in result.output for w in ("egmentation", "Bus error", "SIGABRT",
                                                          "terminate called", "corrupted",
                                                          "free():")):
            return "crash", f"crash, status {result.status}"
        if re.search(r"nan|inf\b|not finite",
                     errors[0].split("(src")[0]) and not re.search(r"infin", errors[0]):
            return "not finite", errors[0]
        return "error", re.sub(r"-?\d[\d.]*(e[-+]?\d+)?", "#", errors[0].split(" (")[0])[:90]
    end = re.search(r"^END (\S+) (\S+)$", result.output, re.M)
    if not end:
        return "no end", "no numbers"
    fast, low = map(float, end.groups())
    if not fast < FASTEST:
        return "energy", f"{fast} m/s"
    if not low > 100.0:
        return "density", f"{low} kg/m3"
    return "ran", "ran"


def one(folder, seed):
    """How it was made, (verdict, why) and what was printed"""
    maker = Maker(seed)
    try:
        result = lammps(folder, maker.text(), maker.ranks, timeout=LIMIT, m_fsi=MATERIALS)
    except subprocess.TimeoutExpired:
        return maker, ("hang", f"more than {LIMIT} s"), ""
    return maker, verdict(result), result.output


GOOD = ("ran", "error")
