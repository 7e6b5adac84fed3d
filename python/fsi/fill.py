"""Fills closed surfaces with particles: an STL file in 3D, an outline in 2D.

usage: python -m fsi.fill SURFACE DX OUT.data [--shell N] [--type T] [--mol M] [--scale S] [--origin X Y [Z]] [--box N]

SURFACE is an STL file (ASCII or binary), or a text file of an outline: one point "x y" per line, closed of itself, a blank
line between outlines. Where outlines or surfaces nest, every second one is a hole. OUT.data is a LAMMPS data file of atom style
fsi with particles on the cubic (2D: square) lattice of spacing DX whose cell faces go through the origin. `--shell N` takes,
instead of what is inside, N layers around it: the wall particles of a vessel of this shape. `--box N`: the simulation box ends N spacings
beyond the particles.
"""

import argparse
import struct
import sys
from itertools import product
from pathlib import Path

import numpy as np

# rays of lattice points would meet the vertices of surfaces that fit the lattice: they go so much beside them, in spacings
BESIDE = np.array([3.1e-6, 1.7e-6])


def read_outline(path):
    """Segments (n, 2, 2) of the closed outlines of a text file."""
    segments = []
    for block in Path(path).read_text().replace(",", " ").split("\n\n"):
        lines = [line.split("#")[0].split() for line in block.splitlines()]
        try:
            points = np.array([[float(word) for word in line] for line in lines if line])
        except ValueError as error:
            raise SystemExit(f"{path}: {error}: expected x and y in each line") from None
        if not points.size:
            continue
        if points.ndim != 2 or points.shape[1] != 2 or len(points) < 3:
            raise SystemExit(f"{path}: expected outlines of three or more lines of x and y")
        if np.array_equal(points[0], points[-1]):
            points = points[:-1]
        segments.append(np.stack([points, np.roll(points, -1, axis=0)], axis=1))
    if not segments:
        raise SystemExit(f"{path}: no points")
    return np.concatenate(segments)


def read_stl(path):
    """Triangles (n, 3, 3) of an STL file; an error if an edge does not have two of them."""
    data = Path(path).read_bytes()
    count = struct.unpack_from("<I", data, 80)[0] if len(data) >= 84 else 0
    if len(data) == 84 + 50 * count and count:
        raw = np.frombuffer(data, dtype=np.dtype([("v", "<f4", (4, 3)), ("a", "<u2")]), offset=84)
        triangles = raw["v"][:, 1:].astype(float)
    else:
        words = [line.split()[1:] for line in data.decode(errors="replace").splitlines() if line.strip().startswith("vertex")]
        try:
            triangles = np.array(words, dtype=float).reshape(-1, 3, 3)
        except ValueError:
            raise SystemExit(f"{path}: not an STL file") from None
    if not len(triangles):
        raise SystemExit(f"{path}: not an STL file")
    _, vertex = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    vertex = vertex.reshape(-1, 3)
    edges = np.sort(np.concatenate([vertex[:, [0, 1]], vertex[:, [1, 2]], vertex[:, [2, 0]]]), axis=1)
    edges = edges[edges[:, 0] != edges[:, 1]]
    _, uses = np.unique(edges, axis=0, return_counts=True)
    if (uses % 2).any():
        raise SystemExit(f"{path}: the surface is not closed: {int((uses % 2).sum())} of its edges have an odd number of triangles")
    return triangles


def crossings(simplex, rays, low, dx, counts):
    """Rays along x that meet one simplex: their indices in `rays`' lattice, and x there."""
    across = simplex[:, 1:]
    first = np.maximum(np.ceil((across.min(0) - low[1:]) / dx - 1.0), 0).astype(int)
    last = np.minimum(np.floor((across.max(0) - low[1:]) / dx), np.array(counts[1:]) - 1).astype(int)
    if (first > last).any():
        return np.empty((0, len(first)), int), np.empty(0)
    index = np.stack(np.meshgrid(*[np.arange(a, b + 1) for a, b in zip(first, last)], indexing="ij"), -1).reshape(-1, len(first))
    points = np.stack([rays[k][index[:, k]] for k in range(len(first))], -1)
    edges = (across[1:] - across[0]).T
    if abs(np.linalg.det(edges)) < 1e-300:    # along x
        return index[:0], np.empty(0)
    weights = np.linalg.solve(edges, (points - across[0]).T).T
    hit = (weights >= 0.0).all(1) & (weights.sum(1) < 1.0)
    return index[hit], simplex[0, 0] + weights[hit] @ (simplex[1:, 0] - simplex[0, 0])


def inside(simplices, dx, margin=0):
    """Lattice that covers a closed surface: (coordinates per axis, which points are inside). Cell faces go through the origin."""
    points = simplices.reshape(-1, simplices.shape[-1])
    low = (np.floor(points.min(0) / dx - 1e-9) - margin) * dx
    counts = np.ceil((points.max(0) - low) / dx - 1e-9).astype(int) + margin
    axes = [low[k] + (np.arange(n) + 0.5) * dx for k, n in enumerate(counts)]
    rays = [axis + beside * dx for axis, beside in zip(axes[1:], BESIDE)]
    # a point is inside if the surface is crossed an odd number of times before it
    flips = np.zeros((counts[0] + 1, *counts[1:]), dtype=np.int64)
    for simplex in simplices:
        index, x = crossings(simplex, rays, low, dx, counts)
        place = np.searchsorted(axes[0], x)
        np.add.at(flips, (place, *index.T), 1)
    return axes, np.cumsum(flips, axis=0)[:-1] % 2 == 1


def shell(mask, layers):
    """Points outside of `mask` at most `layers` spacings from one inside. There must be as many layers around it."""
    near = np.zeros_like(mask)
    reach = range(-layers, layers + 1)
    for offset in product(reach, repeat=mask.ndim):
        if 0 < np.dot(offset, offset) <= layers * layers + 1e-9 or max(map(abs, offset)) <= 1:
            near |= np.roll(mask, offset, axis=tuple(range(mask.ndim)))
    return near & ~mask


def fill(simplices, dx, layers=0):
    """Particles (n, 2 or 3) inside a closed surface, or the layers around it."""
    axes, mask = inside(np.asarray(simplices, float), dx, layers + 1)
    if layers:
        mask = shell(mask, layers)
    return np.stack([axis[i] for axis, i in zip(axes, np.nonzero(mask))], axis=-1)


def write(path, points, dx, kind=1, mol=0, box=4.0):
    """A LAMMPS data file of atom style fsi; mass and density 0 are those of the material's lattice."""
    dim = points.shape[1]
    low, high = points.min(0) - (box + 0.5) * dx, points.max(0) + (box + 0.5) * dx
    if dim == 2:
        low, high = np.append(low, -0.5 * dx), np.append(high, 0.5 * dx)
    lines = ["particles of fsi.fill, atom style fsi", "", f"{len(points)} atoms", f"{kind} atom types", ""]
    lines += [f"{a:.10g} {b:.10g} {name}lo {name}hi" for a, b, name in zip(low, high, "xyz")]
    lines += ["", "Atoms # fsi", ""]
    place = " 0" if dim == 2 else ""
    lines += [f"{i} {mol} {kind} 0 0 " + " ".join(f"{x:.10g}" for x in point) + place for i, point in enumerate(points, 1)]
    Path(path).write_text("\n".join(lines) + "\n")


def main(arguments=None):
    """See the top of this file."""
    parser = argparse.ArgumentParser(prog="python -m fsi.fill", description=__doc__.split("\n\n")[0], epilog=__doc__.split("\n\n")[2])
    parser.add_argument("surface")
    parser.add_argument("dx", type=float)
    parser.add_argument("out")
    parser.add_argument("--shell", type=int, default=0)
    parser.add_argument("--type", type=int, default=1)
    parser.add_argument("--mol", type=int, default=0)
    parser.add_argument("--scale", type=float, default=1.0)
    parser.add_argument("--origin", type=float, nargs="+")
    parser.add_argument("--box", type=float, default=4.0)
    given = parser.parse_args(arguments)
    if not given.dx > 0.0 or given.shell < 0 or given.type < 1:
        parser.error("DX must be > 0, --shell >= 0, --type >= 1")
    if not Path(given.surface).is_file():
        parser.error(f"{given.surface} is not a file")
    simplices = given.scale * (read_stl if given.surface.lower().endswith(".stl") else read_outline)(given.surface)
    dim = simplices.shape[-1]
    if given.origin:
        if len(given.origin) != dim:
            parser.error(f"--origin needs {dim} numbers")
        simplices = simplices + given.origin
    points = fill(simplices, given.dx, given.shell)
    if not len(points):
        parser.error(f"no particle fits: the surface is {np.ptp(simplices.reshape(-1, dim), axis=0)} wide, the spacing is {given.dx}")
    write(given.out, points, given.dx, given.type, given.mol, given.box)
    print(f"{len(points)} particles in {given.out}")


if __name__ == "__main__":
    sys.exit(main())
