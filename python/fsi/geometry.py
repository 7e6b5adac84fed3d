"""Distances between points, in two or three dimensions."""

from itertools import product

import numpy as np


def min_pair_distance(points, spacing):
    """Smallest distance between any two of `points` (n, d); `spacing` is the usual one."""
    if len(points) < 2:
        return np.inf
    cutoff = 1.5 * spacing
    while True:
        distance = _min_within(points, cutoff)
        if distance <= cutoff:
            return distance
        cutoff *= 2.0


def _min_within(points, cutoff):
    """As above, exact if the answer is at most `cutoff`; infinity if no two points share
    neighbouring cells."""
    return float(min((np.sqrt(((points[i] - points[j]) ** 2).sum(axis=1).min())
                      for i, j in _near(points, cutoff)), default=np.inf))


def _near(points, cutoff):
    """Pairs (i, j), each once, among which are all that are nearer than `cutoff`, in parts."""
    cells = np.floor((points - points.min(axis=0)) / cutoff).astype(np.int64) + 1
    strides = np.cumprod(np.concatenate([[1], cells.max(axis=0)[:-1] + 2]))
    keys = cells @ strides
    order = np.argsort(keys, kind="stable")
    keys = keys[order]
    offsets = [o for o in product((-1, 0, 1), repeat=points.shape[1]) if np.dot(o, strides) >= 0]
    for offset in offsets:
        shift = np.dot(offset, strides)
        # within the own cell only the particles that follow
        first = np.searchsorted(keys, keys + shift) if shift else np.arange(1, len(keys) + 1)
        counts = np.searchsorted(keys, keys + shift, side="right") - first
        i = np.repeat(np.arange(len(keys)), counts)
        j = np.arange(counts.sum()) + np.repeat(first - np.cumsum(counts) + counts, counts)
        if i.size:
            yield order[i], order[j]


def vorticity(x, y, u, v, reach):
    """dv/dx - du/dy at points in the plane, of the differences to the neighbors within `reach`: the
    gradient that fits them best. Zero where there are too few, or all in one line."""
    moments = np.zeros((7, len(x)))  # of xx, xy, yy, x u, y u, x v, y v
    points = np.column_stack([x, y])
    for i, j in _near(points, reach):
        (dx, dy), du, dv = (points[j] - points[i]).T, u[j] - u[i], v[j] - v[i]
        weight = np.maximum(0.0, 1.0 - (dx**2 + dy**2) / reach**2)
        for moment, value in zip(moments,
                                 (dx * dx, dx * dy, dy * dy, dx * du, dy * du, dx * dv, dy * dv)):
            for k in (i, j):  # both differences change their sign
                moment += np.bincount(k, weight * value, len(x))
    xx, xy, yy, xu, yu, xv, yv = moments
    size = xx * yy - xy**2
    enough = size > 1e-3 * (xx + yy)**2
    return np.where(enough, (yy * xv - xy * yv - xx * yu + xy * xu) / np.where(enough, size, 1.0),
                    0.0)


def vorticity_of_levels(water, dx):
    """The same of a frame whose fluid has levels, each of its neighbors within 2.5 spacings of its
    own: type 1 is the coarsest, of spacing dx, type 3 the next, each of 1/sqrt(2) of the one
    before."""
    spin = np.zeros(len(water["x"]))
    for kind in np.unique(water["type"]):
        level = max(0, kind - 2)
        near = vorticity(*(water[name] for name in ("x", "y", "vx", "vy")),
                         2.5 * dx / 2**(level / 2))
        spin = np.where(water["type"] == kind, near, spin)
    return spin


def project_on_polyline(points, line):
    """Nearest points on a polyline in the plane.

    points (n, 2), line (m, 2). Returns the distance (n,), the side (n,) of +1 left of the line's
    direction or
    -1 right of it, and the place (n,) of the nearest point: segment number plus fraction, in [0,
    m-1].
    """
    start, along = line[:-1], np.diff(line, axis=0)
    offset = points[:, None, :] - start[None, :, :]
    fraction = np.clip((offset * along).sum(axis=2) / (along**2).sum(axis=1), 0.0, 1.0)
    apart = offset - fraction[:, :, None] * along
    distance = np.sqrt((apart**2).sum(axis=2))
    segment = np.argmin(distance, axis=1)
    each = np.arange(len(points))
    apart, along, fraction = apart[each, segment], along[segment], fraction[each, segment]
    side = np.where(along[:, 0] * apart[:, 1] - along[:, 1] * apart[:, 0] >= 0.0, 1, -1)
    return distance[each, segment], side, segment + fraction
