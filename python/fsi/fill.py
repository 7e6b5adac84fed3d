"""Fills closed surfaces with particles: an STL file in 3D, an outline in 2D.

SURFACE is an STL file (ASCII or binary), or a text file of an outline: one point "x y" per line,
closed of itself, a blank line between outlines. Where outlines or surfaces nest, every second one
is a hole. OUT.data is a LAMMPS data file of atom style fsi, for read_data, with particles on the
cubic (2D: square) lattice of spacing DX whose cell faces go through the origin. For a round or
slanted body without the steps of a lattice see the LAMMPS command fsi/pack, which takes the same
surfaces.
"""

import argparse
import re
import struct
import sys
from itertools import product
from pathlib import Path

import numpy as np

# rays of lattice points would meet the vertices of surfaces that fit the lattice: they go so much
# beside them, in spacings
BESIDE = np.array([3.1e-6, 1.7e-6])
LARGEST = 2e8  # points of the lattice that covers a surface
LONG = 20.0  # more than that of a unit of length is seldom meant
# corners nearer than this, of the largest extent, are one: programs that write STL round each
# triangle by itself
SAME = 1e-6


def read_outline(path):
    """Segments (n, 2, 2) of the closed outlines of a text file."""
    segments = []
    for block in re.split(r"\n\s*\n", Path(path).read_text().replace(",", " ")):
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
    """Triangles (n, 3, 3) of an STL file, closed; an error if an edge does not have two of them."""
    data = Path(path).read_bytes()
    count = struct.unpack_from("<I", data, 80)[0] if len(data) >= 84 else 0
    if len(data) == 84 + 50 * count and count:
        raw = np.frombuffer(data, dtype=np.dtype([("v", "<f4", (4, 3)), ("a", "<u2")]), offset=84)
        triangles = raw["v"][:, 1:].astype(float)
    else:
        words = [line.split()[1:] for line in data.decode(errors="replace").splitlines()
                 if line.strip().startswith("vertex")]
        try:
            triangles = np.array(words, dtype=float).reshape(-1, 3, 3)
        except ValueError:
            raise SystemExit(f"{path}: not an STL file") from None
    if not len(triangles):
        raise SystemExit(f"{path}: not an STL file")
    corners, vertex = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    vertex = vertex.reshape(-1, 3)
    rim = open_edges(vertex)
    if len(rim):
        vertex = welded(corners, np.unique(rim))[vertex]
        rim = open_edges(vertex)
    if len(rim):
        place = " ".join(f"{x:g}" for x in corners[rim[0]].mean(0))
        raise SystemExit(f"{path}: the surface is not closed: {len(rim)} of its edges have an odd "
                         f"number of triangles, the first near {place}")
    return corners[vertex]


def open_edges(vertex):
    """Edges (n, 2) that have an odd number of triangles."""
    edges = np.sort(np.concatenate([vertex[:, [0, 1]], vertex[:, [1, 2]], vertex[:, [2, 0]]]),
                    axis=1)
    edges, uses = np.unique(edges[edges[:, 0] != edges[:, 1]], axis=0, return_counts=True)
    return edges[uses % 2 == 1]


def welded(corners, rim):
    """Numbers of the corners, where those of `rim` that are as good as at one place have the first
    one's."""
    first = np.arange(len(corners))
    near = SAME * np.ptp(corners, axis=0).max()
    for k, i in enumerate(rim):
        if first[i] == i:
            others = rim[k + 1:]
            first[others[(np.abs(corners[others] - corners[i]) < near).all(1)]] = i
    return first


def crossings(simplex, rays, low, dx, counts):
    """Rays along x that meet one simplex: their indices in `rays`' lattice, and x there."""
    across = simplex[:, 1:]
    first = np.maximum(np.ceil((across.min(0) - low[1:]) / dx - 1.0), 0).astype(int)
    last = np.minimum(np.floor((across.max(0) - low[1:]) / dx),
                      np.array(counts[1:]) - 1).astype(int)
    if (first > last).any():
        return np.empty((0, len(first)), int), np.empty(0)
    index = np.stack(np.meshgrid(*[np.arange(a, b + 1) for a, b in zip(first, last)],
                                 indexing="ij"), -1).reshape(-1, len(first))
    points = np.stack([rays[k][index[:, k]] for k in range(len(first))], -1)
    edges = (across[1:] - across[0]).T
    if abs(np.linalg.det(edges)) < 1e-300:    # along x
        return index[:0], np.empty(0)
    weights = np.linalg.solve(edges, (points - across[0]).T).T
    hit = (weights >= 0.0).all(1) & (weights.sum(1) < 1.0)
    return index[hit], simplex[0, 0] + weights[hit] @ (simplex[1:, 0] - simplex[0, 0])


def inside(simplices, dx, margin=0):
    """Lattice that covers a closed surface: (coordinates per axis, which points are inside). Cell
    faces go through the origin."""
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
    """Points outside of `mask` at most `layers` spacings from one inside. There must be as many
    layers around it."""
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
    """A LAMMPS data file of atom style fsi; mass and density 0 are those of the material's
    lattice."""
    dim = points.shape[1]
    low, high = points.min(0) - (box + 0.5) * dx, points.max(0) + (box + 0.5) * dx
    if dim == 2:
        low, high = np.append(low, -0.5 * dx), np.append(high, 0.5 * dx)
    lines = ["particles of fsi fill, atom style fsi", "", f"{len(points)} atoms",
             f"{kind} atom types", ""]
    lines += [f"{a:.10g} {b:.10g} {name}lo {name}hi" for a, b, name in zip(low, high, "xyz")]
    lines += ["", "Atoms # fsi", ""]
    place = " 0" if dim == 2 else ""
    lines += [f"{i} {mol} {kind} 0 0 " + " ".join(f"{x:.10g}" for x in point) + place
              for i, point in enumerate(points, 1)]
    Path(path).write_text("\n".join(lines) + "\n")


def measure(simplices, dx, given):
    """What is said about the size of a surface in spacings; an error where no computer holds the
    particles, or none fits."""
    extent = np.ptp(simplices.reshape(-1, simplices.shape[-1]), axis=0)
    across = extent / dx
    size = " x ".join(f"{value:.4g}" for value in extent) + ", in spacings " + " x ".join(
        f"{value:.4g}" for value in across)
    if np.prod(np.ceil(across) + 2.0 * given.shell) > LARGEST:
        raise SystemExit(f"{given.surface} is {size}: too many particles. "
                         + _hint(across / 1000.0, given.scale * 1e-3, "in millimeters"))
    if across.max() < 1.0:
        raise SystemExit(f"{given.surface} is {size}: no particle fits. " + _hint(
            across * 1000.0, given.scale * 1e3, "in meters, DX in millimeters"))
    return size, across


def _hint(across, scale, units):
    """What to do about a wrong size: mind the units, if with these it would be a sound one."""
    return f"If it is {units}: --scale {scale:g}" if 1.0 <= across.max() and np.prod(
        np.ceil(across)) < LARGEST else "Mind its units (--scale) and DX"


def main(arguments=None):
    """The command line of `fsi fill`."""
    parser = argparse.ArgumentParser(
        prog="fsi fill", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="fsi fill tank.stl 0.01 tank.data --scale 0.001 --shell 4 --type 2       the walls "
        "of a tank that was drawn in millimeters")
    parser.add_argument("surface", metavar="SURFACE",
                        help="STL file (NAME.stl) or text file of an outline")
    parser.add_argument("dx", metavar="DX", type=float,
                        help="spacing of the particles, that of fix fsi")
    parser.add_argument("out", metavar="OUT.data", help="data file to write")
    parser.add_argument("--scale", metavar="S", type=float, default=1.0, help="factor of the "
                        "surface's coordinates: 0.001 for millimeters in a scene in meters")
    parser.add_argument("--origin", metavar="X", type=float, nargs="+",
                        help="X Y [Z]: moves the surface so far, after scaling")
    parser.add_argument("--turn", metavar="DEGREES", type=float, nargs="+",
                        help="turns the surface about the origin before it is moved: one angle in "
                        "2D, angles about x, y and z, in this order, in 3D")
    parser.add_argument("--shell", metavar="N", type=int, default=0,
                        help="instead of what is inside N layers around it: the wall particles of "
                        "a vessel of this shape")
    parser.add_argument("--type", metavar="T", type=int, default=1, help="atom type (default 1)")
    parser.add_argument("--mol", metavar="M", type=int, default=0, help="molecule ID: that of the "
                        "body (default 0: none, as for fluids and walls)")
    parser.add_argument("--box", metavar="N", type=float, default=4.0,
                        help="the simulation box ends N spacings beyond the particles (default 4)")
    # argparse takes -1e-3 for an option
    arguments = [f"{float(word):.17f}" if re.fullmatch(r"-[\d.]+[eE][-+]?\d+", word) else word
                 for word in (sys.argv[1:] if arguments is None else arguments)]
    given = parser.parse_args(arguments)
    if (not given.dx > 0.0 or given.shell < 0 or given.type < 1 or given.mol < 0 or given.scale
        == 0.0):
        parser.error("DX must be > 0, --shell and --mol >= 0, --type >= 1, --scale not 0")
    if not Path(given.surface).is_file():
        parser.error(f"{given.surface} is not a file")
    simplices = given.scale * (read_stl if given.surface.lower().endswith(".stl")
                               else read_outline)(given.surface)
    dim = simplices.shape[-1]
    for name, wanted in (("origin", dim), ("turn", 1 if dim == 2 else 3)):
        if getattr(given, name) and len(getattr(given, name)) != wanted:
            parser.error(f"--{name} needs {wanted} number{'s' * (wanted > 1)}")
    if given.turn:
        simplices = simplices @ rotation(given.turn).T
    if given.origin:
        simplices = simplices + given.origin
    size, across = measure(simplices, given.dx, given)
    points = fill(simplices, given.dx, given.shell)
    if not len(points):
        raise SystemExit(f"{given.surface} is {size}: no particle fits")
    write(given.out, points, given.dx, given.type, given.mol, given.box)
    print(f"{given.surface} is {size}; {len(points)} particles in {given.out}; lengths are meters "
          "with units si")
    longest = (simplices.reshape(-1, dim).max(0) - simplices.reshape(-1, dim).min(0)).max()
    if longest > LONG:
        print(f"fsi fill: with units si it is {longest:.4g} m long. If it is in millimeters: "
              "--scale 0.001, and DX in meters")
    if not given.shell and across.min() < 3.0:
        print(f"fsi fill: only {across.min():.2g} particles through the thickness: a body or a jet "
              "needs three or more")


def rotation(degrees):
    """The matrix of a turn in the plane (one angle), or about x, then y, then z."""
    if len(degrees) == 1:
        c, s = np.cos(np.radians(degrees[0])), np.sin(np.radians(degrees[0]))
        return np.array([[c, -s], [s, c]])
    matrix = np.eye(3)
    for k, angle in enumerate(degrees):
        one, (i, j) = np.eye(3), ((k + 1) % 3, (k + 2) % 3)
        one[np.ix_((i, j), (i, j))] = rotation([angle])
        matrix = one @ matrix
    return matrix


if __name__ == "__main__":
    sys.exit(main())
