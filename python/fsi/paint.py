"""Particles as discs that touch, or as lit spheres in three dimensions, painted into an array of
pixels. No figure, no axes."""

import numpy as np

FINER = 2  # pixels painted each way for one of the picture, so that edges are smooth
LIGHT = np.array((-0.45, 0.65, 0.61))  # from where it comes: from the left, above and in front


def discs(size, limits, x, y, radius, colours, depth=None):
    """(height, width, 4) array of bytes, transparent where no particle is.

    size: (width, height) [pixel]; limits: ((xlo, xhi), (ylo, yhi)), what the picture shows; x, y,
    radius, depth: lengths in one unit; colours: (particles, 3 or 4) from 0 to 1. Where discs
    overlap each keeps what is nearest to its center, so that radii of 0.7 spacings leave no gaps
    and cover no neighbor. With a depth, which grows towards the eye, they are spheres that light
    falls on.
    """
    width, height = (FINER * n for n in size)
    (xlo, xhi), (ylo, yhi) = limits
    scale = width / (xhi - xlo)
    order = slice(None) if depth is None else np.argsort(depth, kind="stable")
    across, up = scale * (np.asarray(x)[order] - xlo), height * (yhi - np.asarray(y)[order]) / (
        yhi - ylo)
    near = np.zeros(len(across)) if depth is None else scale * np.asarray(depth)[order]
    r = np.broadcast_to(np.maximum(scale * np.asarray(radius), 0.5 * FINER), across.shape)[order]
    owner, surface = _nearest(width, height, across, up, near, r)
    seen = owner >= 0
    painted = np.zeros((height, width, 4))
    painted[seen, :3] = np.asarray(colours)[order][owner[seen], :3]
    painted[seen, 3] = 1.0
    if depth is not None:
        painted[..., :3] *= _light(owner, surface, across, up, near, r)[..., None]
    whole = painted.reshape(size[1], FINER, size[0], FINER, 4)
    share = whole[..., 3].mean((1, 3))
    colour = (whole[..., :3] * whole[..., 3:]).sum((1, 3)) / np.maximum(whole[..., 3].sum((1, 3)),
                                                                        1.0)[..., None]
    return (255.0 * np.clip(np.dstack([colour, share]), 0.0, 1.0) + 0.5).astype(np.uint8)


def _nearest(width, height, across, up, near, r):
    """(which particle each pixel shows, -1 for none; how near that place of its sphere is).
    Particles from the farthest to the nearest."""
    owner = np.full(width * height, -1)
    surface = np.full(width * height, -np.inf)
    i, j = np.floor(across).astype(int), np.floor(up).astype(int)
    reach = int(np.ceil(r.max())) if len(r) else 0
    # fewer particles than places around one: one particle after the other
    if len(r) < (2 * reach + 1)**2:
        owner, surface = owner.reshape(height, width), surface.reshape(height, width)
        for k in range(len(r)):
            box = slice(max(0, j[k] - reach), max(0, j[k] + reach + 1)), slice(
                max(0, i[k] - reach), max(0, i[k] + reach + 1))
            rows, columns = np.ogrid[:height, :width]
            off = (columns[:, box[1]] + 0.5 - across[k])**2 + (rows[box[0]] + 0.5 - up[k])**2
            top = near[k] + np.sqrt(np.maximum(r[k]**2 - off, 0.0))
            better = (off < r[k]**2) & (top >= surface[box])
            surface[box][better], owner[box][better] = top[better], k
        return owner, surface
    for dj in range(-reach, reach + 1):
        for di in range(-reach, reach + 1):
            column, row = i + di, j + dj
            off = (column + 0.5 - across)**2 + (row + 0.5 - up)**2
            k = np.flatnonzero((off < r * r) & (column >= 0) & (column < width) & (row >= 0)
                               & (row < height))
            pixel, top = row[k] * width + column[k], near[k] + np.sqrt(r[k]**2 - off[k])
            better = top > surface[pixel]
            # of several with one pixel the last, which is the nearest, stays
            surface[pixel[better]], owner[pixel[better]] = top[better], k[better]
    return owner.reshape(height, width), surface.reshape(height, width)


def _light(owner, surface, across, up, near, r):
    """Brightness of each pixel: of a sphere where light falls on it, darker where its surroundings
    are nearer to the eye."""
    j, i = np.nonzero(owner >= 0)
    k = owner[j, i]
    normal = np.stack([(i + 0.5 - across[k]) / r[k], (up[k] - j - 0.5) / r[k],
                       (surface[j, i] - near[k]) / r[k]])
    bright = np.ones(owner.shape)
    if not len(k):
        return bright
    bright[j, i] = 0.52 + 0.55 * np.clip(LIGHT @ normal, 0.0, 1.0)
    reach = max(3, int(4 * np.median(r)))
    floor = np.where(owner >= 0, surface, surface[j, i].min())
    sunk = np.clip((_blurred(floor, reach) - floor) / (6.0 * np.median(r)), 0.0, 1.0)
    return bright * (1.0 - 0.45 * sunk)


def _blurred(values, reach):
    """Means over squares of 2 reach + 1 pixels, twice."""
    for _ in range(2):
        for axis in (0, 1):
            padded = np.pad(values, [(reach + 1, reach) if a == axis else (0, 0) for a in (0, 1)],
                            mode="edge")
            sums = np.cumsum(padded, axis=axis)
            n = values.shape[axis]
            values = (np.take(sums, range(2 * reach + 1, 2 * reach + 1 + n), axis)
                      - np.take(sums, range(n), axis)) / (2 * reach + 1)
    return values
