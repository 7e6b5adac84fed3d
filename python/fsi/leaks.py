"""Counts particles that are where none may be. Every particle counts once, however long it stays
there."""

import numpy as np


class Leaks:
    """Collects offenders frame by frame. `margin` [m]: how far beyond a wall a particle must be to
    count."""

    def __init__(self, margin):
        self.margin = margin
        self.offenders = set()
        self.first = None
        self.last = None

    def beyond_walls(self, frame, walls):
        """Adds particles outside of planes: `walls` lists (column, bound, -1 for a lower or +1 for
        an upper bound)."""
        for name, bound, side in walls:
            self.add(frame, side * (frame[name] - bound) > self.margin)

    def add(self, frame, mask):
        """Adds the particles of a frame for which `mask` (particles,) holds."""
        self.offenders.update(frame["id"][mask].tolist())

    def see(self, frame):
        """Notes who is there, so that lost particles show. Call once per frame."""
        ids = set(frame["id"].tolist())
        if self.first is None:
            self.first = ids
        self.last = ids

    def count(self, log, outflow=0):
        """Number of particles that leaked or were lost; `outflow` of those left where they may,
        which is no loss."""
        lost = max(len(self.first - self.last), _drop(log)) if self.first else _drop(log)
        return len(self.offenders) + max(0, lost - outflow)


def _drop(log):
    atoms = log.column("Atoms")
    if atoms is None:
        atoms = np.array([run.atoms for run in log.finished])
    return int(atoms[0] - atoms[-1]) if atoms.size else 0
