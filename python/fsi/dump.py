"""Reads the text files of LAMMPS' `dump custom`, plain or gzipped."""

import gzip
import io
import os
import warnings
from dataclasses import dataclass
from itertools import islice

import numpy as np

_INTEGERS = ("id", "type", "mol")


@dataclass
class Frame:
    """One snapshot, sorted by id."""

    step: int
    time: float  # [s]
    box: np.ndarray  # (3, 2) lower and upper bounds
    columns: dict  # name -> array (particles,)

    def __len__(self):
        return len(next(iter(self.columns.values())))

    def __getitem__(self, name):
        return self.columns[name]

    def __contains__(self, name):
        return name in self.columns

    def select(self, mask):
        """The frame's particles for which `mask` (particles,) holds."""
        return Frame(self.step, self.time, self.box,
                     {name: values[mask] for name, values in self.columns.items()})

    def of_types(self, *types):
        """The frame's particles of the given atom types."""
        return self.select(np.isin(self["type"], types))

    def vector(self, names="xyz"):
        """(particles, d) array of those of the named columns that the dump has: positions, or
        ("vx", "vy", "vz")."""
        return np.column_stack([self[name] for name in names if name in self])


def frames(path, only=None, progress=None):
    """Yields the frames of a dump one by one, so that a long one need not fit in memory.

    only: numbers of the frames, from 0, that are wanted; progress(share of the file that is read)
    is called before each frame.
    """
    step, time, count, box, number = None, None, None, None, -1
    with open(path, "rb") as raw, io.TextIOWrapper(gzip.open(raw) if str(path).endswith(".gz")
                                                   else raw) as file:
        size = os.fstat(raw.fileno()).st_size
        try:
            for line in file:
                if line.startswith("ITEM: TIMESTEP"):
                    step, number = int(*_take(file, 1)), number + 1
                    if progress:
                        progress(raw.tell() / size)
                elif line.startswith("ITEM: TIME"):
                    time = float(*_take(file, 1))
                elif line.startswith("ITEM: NUMBER"):
                    count = int(*_take(file, 1))
                elif line.startswith("ITEM: BOX"):
                    box = np.array([row.split()[:2] for row in _take(file, 3)], dtype=float)
                elif line.startswith("ITEM: ATOMS"):
                    if time is None:
                        raise ValueError(
                            f"{path} has no times: the deck needs `dump_modify ... time yes`")
                    rows = _take(file, count)
                    if only is None or number in only:
                        yield _frame(step, time, box, line.split()[2:], rows)
        except EOFError:  # of gzip, too: the run still writes, or was killed
            warnings.warn(f"{path}: the last frame is incomplete and left out", stacklevel=2)


def _take(file, count):
    """So many of the next lines"""
    lines = list(islice(file, count))
    if len(lines) < count:
        raise EOFError
    return lines


def some(path, number, progress=None):
    """So many frames, evenly chosen from the first to the last; all if there are fewer. An error if
    there is none."""
    total = 0
    with (gzip.open if str(path).endswith(".gz") else open)(path, "rt") as file:
        try:
            for line in file:
                total += line.startswith("ITEM: ATOMS")
        except EOFError:
            pass
    found = list(frames(path, {round(k) for k in np.linspace(0, total - 1, min(number, total))},
                        progress)) if total else []
    if not found:
        raise ValueError(f"{path} has no frames")
    return found


def read(path):
    """All frames of a dump, as a list."""
    return list(frames(path))


def nearest(found, times, tolerance):
    """The frames nearest to each of `times`, at most `tolerance` away from it; in order, none
    twice."""
    chosen = {}
    for time in times:
        frame = min(found, key=lambda f: abs(f.time - time), default=None)
        if frame is not None and abs(frame.time - time) <= tolerance:
            chosen[frame.step] = frame
    return [chosen[step] for step in sorted(chosen)]


def spacing(frame, samples=200):
    """Distance of nearest neighbours, the median of some particles."""
    x = frame.vector()
    distances = []
    for i in range(0, len(x), max(1, len(x) // samples)):
        rsq = ((x - x[i])**2).sum(axis=1)
        rsq[i] = np.inf
        distances.append(np.sqrt(rsq.min()))
    return float(np.median(distances))


def bodies(frame):
    """What a frame is made of, [(name, particles, sizes in its own spacings, the least first)]:
    solids by molecule ID, all else by type.

    Sizes are those along the axes, or along the principal axes of what lies aslant: a plate's least
    is the particles across it.
    """
    loose = frame["mol"] == 0 if "mol" in frame else np.ones(len(frame), bool)
    kinds = [(f"type {t}", loose & (frame["type"] == t)) for t in np.unique(frame["type"][loose])]
    kinds += [(f"body {m}", frame["mol"] == m)
              for m in np.unique(frame["mol"][~loose])] if "mol" in frame else []
    found = []
    for name, mask in kinds:
        part = frame.select(mask)
        if len(part) < 3:
            found.append((name, len(part), []))
            continue
        x = part.vector()
        x = x[:, np.ptp(x, axis=0) > 0.0]  # in two dimensions there may be a column of zeros
        aslant = x @ np.linalg.eigh(np.atleast_2d(np.cov(x.T)))[1]
        sizes, tight = np.ptp(x, axis=0), np.ptp(aslant, axis=0)
        found.append((name, len(part), sorted(1.0 + (tight if np.prod(tight) < 0.9 * np.prod(sizes)
                                                     else sizes) / spacing(part))))
    return found


def _frame(step, time, box, names, rows):
    """Columns of words, such as `element`, are left out."""
    table = np.fromstring("".join(rows), sep=" ") if _are_numbers(rows[:1]) else np.empty(0)
    if table.size != len(rows) * len(names):
        words = [row.split() for row in rows]
        if len(words[-1]) < len(names):
            raise EOFError
        kept = [k for k in range(len(names)) if _are_numbers(row[k] for row in words)]
        names, table = [names[k] for k in kept], np.array(
            [[row[k] for k in kept] for row in words], dtype=float)
    table = table.reshape(len(rows), len(names))
    if "id" in names:
        table = table[np.argsort(table[:, names.index("id")], kind="stable")]
    columns = {}
    for k, name in enumerate(names):
        columns[name] = table[:, k].astype(np.int64) if name in _INTEGERS else np.ascontiguousarray(
            table[:, k])
    return Frame(step, time, box, columns)


def _are_numbers(texts):
    try:
        return [float(word) for text in texts for word in text.split()] is not None
    except ValueError:
        return False
