"""Particle shifting against sums written a second time in numpy, on clouds with free surfaces,
walls and a solid."""

from itertools import product

import numpy as np
import pytest
from decks import WALL
from scenes import KERNELS, RUBBER, WATER, Kernel, Scene, cloud, lattice

C, SOUND, DT = 0.5, 10.0, 2e-3
BOTH = pytest.mark.parametrize("n", [(12, 11), (7, 6, 6)], ids=["2D", "3D"])


def expected(x, volume, moves, kernel, dx, dim, walls, fills):
    """Displacements (n, dim) of one step; walls: axes with a mirror at 0; fills: there is no free
    surface."""
    x = x[:, :dim]
    sums, normal, divergence = np.zeros_like(x), np.zeros_like(x), np.zeros(len(x))
    for reflected in product((False, True), repeat=len(walls)):
        image = x.copy()
        for axis, yes in zip(walls, reflected):
            image[:, axis] *= -1 if yes else 1
        d = x[:, None] - image[None]
        r = np.linalg.norm(d, axis=2)
        if not any(reflected):
            np.fill_diagonal(r, np.inf)
        inside = r < kernel.cut
        g = np.zeros_like(r)
        w = np.zeros_like(r)
        g[inside], w[inside] = kernel.g(r[inside]), kernel.W(r[inside])
        g *= volume[None]
        normal += (g[:, :, None] * d).sum(1)
        weight = 1 + 0.2 * (w / kernel.W(dx))**4
        if fills:
            weight[:, ~moves] = kernel.weight_of_wall(w[:, ~moves] / kernel.W(dx), dx)
        sums += ((g * weight)[:, :, None] * d).sum(1)
        divergence -= np.where(inside, g * np.where(inside, r, 0)**2, 0).sum(1)
    missing = dim - divergence
    share = lambda all_, none: np.clip((none - missing) / (none - all_), 0, 1)
    n = normal / np.linalg.norm(normal, axis=1)[:, None]
    across = (sums * n).sum(1)[:, None] * n
    if not fills:
        sums = share(0.9, 1.0)[:, None] * (sums - (1 - share(0.04, 0.16))[:, None] * across)
    out = -C * SOUND * kernel.h * DT * sums
    size = np.linalg.norm(out, axis=1)
    most = 0.25 * C * SOUND * DT
    out *= np.minimum(1.0, most / np.maximum(size, 1e-300))[:, None]
    out[~moves] = 0.0
    return out, missing, size > most


def change_of_velocity(x, v, volume, fluid, kernel, dim, walls, step):
    """step.grad v of fluid neighbors and their images, by least squares with the weights -V_j g_ij,
    and the determinant of its matrix."""
    x, v, step = x[fluid, :dim], v[fluid, :dim], step[fluid]
    matrix, slopes = np.zeros((2, len(x), dim, dim))
    for reflected in product((False, True), repeat=len(walls)):
        sign = np.ones(dim)
        sign[[axis for axis, yes in zip(walls, reflected) if yes]] = -1
        d, dv = (sign * of[None] - of[:, None] for of in (x, v))
        r = np.linalg.norm(d, axis=2)
        if not any(reflected):
            np.fill_diagonal(r, np.inf)
        weight = np.zeros_like(r)
        weight[r < kernel.cut] = -kernel.g(r[r < kernel.cut])
        weight *= volume[fluid][None]
        matrix += np.einsum("ij,ija,ijb->iab", weight, d, d)
        slopes += np.einsum("ij,ija,ijb->iab", weight, dv, d)
    det = np.linalg.det(matrix)
    change = np.einsum("iab,ibc,ic->ia", slopes, np.linalg.inv(matrix), step)
    return np.clip((det - 0.02) / 0.08, 0, 1)[:, None] * change, det


def one_step(n, kernel, flow, background=0):
    """Two runs of one step, with and without: the fluid's, walls', volumes', kernel's arrays, and
    what is had by each."""
    dim, dx = len(n), 0.1
    x, v = cloud(n, dx, jitter=0.3, vmax=0.1)
    middle = np.argsort(np.linalg.norm(x - x.mean(0), axis=1))[:7]
    x[middle] = 0.5 * x[middle] + 0.5 * x[middle[0]]  # a clump that the bound must hold back
    v = flow(x, v)
    walls = [1, 2][:dim - 1]
    type_ = np.where(x[:, 0] > x[:, 0].max() - 2 * dx, 2, 1)
    commands = ["fix walls all fsi/wall/mirror "
                + " ".join(f"{'xyz'[a]}lo 0 guard 0" for a in walls)]
    got = {}
    for shift in (0, C):
        with Scene(x, v, dim=dim, dx=dx, kernel=kernel, hdx=1.2, type=type_,
                   materials=(WATER, RUBBER), dt=DT,
                   fluid=f"sound {SOUND} tension yes background {background} shift {shift}",
                   commands=commands) as s:
            s.run()
            volume = s.get("rmass") / s.get("rho")
            s.run(1)
            got[shift] = {name: s.get(name) for name in ("x", "v", "rho")}
            support = s.kernel
    difference = {name: got[C][name] - got[0][name] for name in got[0]}
    return x, v, volume, type_ == 1, support, walls, {name: d[:, :dim] if d.ndim == 2 else d
                                                      for name, d in difference.items()}


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("background", [0, 5])
@BOTH
def test_displacement(n, kernel, background):
    """Positions differ by the displacement, velocities in a full box by what the flow has there,
    densities not at all."""
    x, v, volume, fluid, support, walls, difference = one_step(n, kernel, lambda x, v: v,
                                                               background)
    want, missing, bounded = expected(x, volume, fluid, support, 0.1, len(n), walls, background > 0)
    # worth comparing: inside, on surfaces and in corners; bounded and not
    assert (missing > 1).any() and (missing < 0.04).any() and ((missing > 0.16)
                                                               & (missing < 0.9)).any()
    assert bounded.any() and not bounded.all()
    # coordinates of order 1 and displacements of 1e-3: round-off of the difference
    assert np.abs(difference["x"] - want).max() < 1e-13
    change, det = change_of_velocity(x, v, volume, fluid, support, len(n), walls, want)
    assert (det > 0.1).any() and np.abs(change).max() > 1e-3
    assert np.abs(difference["v"][fluid] - (change if background else 0)).max() < 1e-13
    # rates with shifting may add up in another order
    assert not difference["v"][~fluid].any() and np.abs(difference["rho"]).max() < 1e-13 * 1000


@pytest.mark.parametrize("shear", [0, 1])
@BOTH
def test_velocity_is_that_of_the_flow(n, shear):
    """In a flow whose velocity is linear in place particles have exactly that after the step, at
    surfaces and solids, too; at walls that slip if there is no shear."""
    slope = np.array([[0.3, -0.2, 0.1], [0.5, 0.1, -0.4], [-0.3, 0.2, -0.4]]) * np.where(
        np.eye(3), 1, shear)
    slope[:, len(n):] = slope[len(n):] = 0.0
    x, v, volume, fluid, support, walls, difference = one_step(n, "quintic", lambda x, v: x
                                                               @ slope.T, background=5)
    _, det = change_of_velocity(x, v, volume, fluid, support, len(n), walls, difference["x"])
    there = (det > 0.1) & ((x[fluid][:, walls] > support.cut).all(1) | (not shear))
    assert there.sum() > (10 if shear else 0.6 * fluid.sum())
    want = difference["x"] @ slope[:len(n), :len(n)].T
    assert np.abs(want[fluid][there]).max() > 1e-4
    assert np.abs(difference["v"] - want)[fluid][there].max() < 1e-13


@pytest.mark.parametrize("every", [3, 10])
@BOTH
def test_every_few_steps(n, every):
    """Nothing in steps between; then what one of them would do, so many times, but N C c dt at most
    h/2: six times here."""
    dim, dx = len(n), 0.1
    x, v = cloud(n, dx, jitter=0.3, vmax=0.1)
    got = {}
    for shift in ("", f"shift {C} shift/every {every}"):
        with Scene(x, v, dim=dim, dx=dx, kernel="quintic", hdx=1.2, dt=DT,
                   fluid=f"sound {SOUND} tension yes {shift}", commands=[]) as s:
            s.run(every - 1)
            before, volume, support = s.get("x"), s.get("rmass") / s.get("rho"), s.kernel
            s.run(1)
            got[shift] = before, s.get("x")
    (plain, plain_end), (shifted, shifted_end) = got.values()
    assert (plain == shifted).all()
    times = min(every, 0.5 * support.h / (C * SOUND * DT))
    assert times == pytest.approx(min(every, 6))
    want = times * expected(plain, volume, np.ones(len(x), bool), support, dx, dim, [], False)[0]
    assert np.abs(want).max() > 0.1 * C * SOUND * DT
    assert np.abs((shifted_end - plain_end)[:, :dim] - want).max() < 1e-13


def test_gaps_close_where_there_is_no_surface():
    """A hole of four particles in a lattice that fills its box: with a background pressure its rim
    moves into it."""
    n, dx = (20, 20), 0.1
    x = lattice(n, dx)
    hole = (np.abs(x[:, :2] - 1.0) < dx).all(1)
    x = x[~hole]
    inward = {}
    for background in (0, 5):
        with Scene(x, dx=dx, boundary="p p p", box=((0, 0, 0), (2, 2, 2)), dt=DT,
                   fluid=f"sound {SOUND} tension yes background {background} shift {C}",
                   commands=[]) as s:
            s.run(1)
            rim = np.linalg.norm(x[:, :2] - 1.0, axis=1) < 2.2 * dx
            inward[background] = -((s.get("x") - x)[:, :2] * (x[:, :2] - 1.0)).sum(
                1)[rim] / np.linalg.norm(x[:, :2] - 1.0, axis=1)[rim]
    assert inward[5].min() > 0.02 * C * SOUND * DT and np.abs(
        inward[0]).max() < 0.3 * inward[5].min()


@BOTH
def test_lattice_stays(n):
    """Nothing moves on a lattice: walls and the solid count as full, and from a plane surface
    nothing is pulled off."""
    dim, dx = len(n), 0.1
    x = lattice(n, dx)
    type_ = np.where(x[:, 0] > x[:, 0].max() - 3.5 * dx, 2, 1)
    walls = " ".join(f"{a}lo 0 {a}hi {m * dx}" for a, m in zip("xyz", n))
    walls = walls.replace(f"xhi {n[0] * dx}", "").replace(f"yhi {n[1] * dx}", "")
    with Scene(x, dim=dim, dx=dx, type=type_, materials=(WATER, RUBBER), dt=DT,
               fluid=f"sound {SOUND} shift {C}",
               commands=[f"fix walls all fsi/wall/mirror {walls}"]) as s:
        s.run(50)
        x1 = s.get("x")
    # the solid has free sides; next to those, in the corner with the surface, the lattice is not
    # complete
    inner = (type_ == 1) & ((x[:, 0] < x[type_ == 2, 0].min() - 3 * dx)
                            | (x[:, 1] < x[:, 1].max() - 4 * dx))
    assert np.abs(x1 - x)[inner].max() < 1e-12


@pytest.mark.parametrize("n", [(14, 8), (12, 7, 7)], ids=["2D", "3D"])
def test_lattice_stays_between_walls_of_particles(n):
    """The same in a box that the fluid fills, to what the factor of walls leaves of the fourth
    power at two spacings: 1e-5 of the sum."""
    dim, dx = len(n), 0.1
    x = lattice(n, dx)
    wall = np.abs(x[:, 0] - n[0] * dx / 2) > (n[0] / 2 - 3) * dx
    box = (-1, 0, 0), (n[0] * dx + 1, n[1] * dx, n[-1] * dx)
    with Scene(x, dim=dim, dx=dx, boundary="f p p", box=box, type=1 + wall, materials=(WATER, WALL),
               held=wall, dt=DT,
               fluid=f"sound {SOUND} background 5 tension yes shift {C}",
               commands=["fix wall held fsi/wall/particle"]) as s:
        moved = np.abs(s.run(50).get("x") - x).max() / dx
    print(f"after 50 steps particles have moved by at most {moved:.1e} spacings")
    assert moved < 1e-4


def test_evens_out():
    """In a shaken periodic cloud number densities come together: that is what it is for."""
    n, dx = (20, 20), 0.1
    x, _ = cloud(n, dx, jitter=0.3)
    spread = []
    for shift in (0, C):
        with Scene(x, dx=dx, boundary="p p p", box=((0, 0, 0), (2, 2, 2)), dt=DT,
                   fluid=f"sound {SOUND} tension yes shift {shift}",
                   commands=["compute psi all fsi/atom psi"]) as s:
            s.run(200)
            spread.append(np.std(s.compute("psi", columns=False)) / s.kernel.lattice_sum(dx, 2))
    print(f"spread of the number density: {spread[0]:.4f} without, {spread[1]:.4f} with shifting")
    # pressure sees V = m/rho, which knows nothing of the lattice's disorder, and so leaves it
    assert spread[1] < 0.25 * spread[0]


@pytest.mark.slow
@pytest.mark.parametrize("n", [(20, 20), (14, 8, 8)], ids=["2D", "3D"])
def test_density_follows_between_open_ends(n):
    """There rho - m psi is a constant of each particle that moves and is shifted; without them
    shifting alone leaves rho."""
    dx, dim = 0.1, len(n)
    x, v = cloud(n, dx, jitter=0.3, vmax=0.02)
    size = [n[k] * dx if k < dim else 2.0 for k in range(3)]
    lag = {}
    for ends in (False, True):
        low, high = [0.0] * 3, list(size)
        if ends:
            low[0], high[0] = -0.6, size[0] + 0.6
        commands = ["compute psi all fsi/atom psi"]
        commands += ["fix i all fsi/inlet xlo 0 velocity 0 0 0",
                     f"fix o all fsi/outlet xhi {size[0]}"] if ends else []
        with Scene(x, v, dim=dim, dx=dx, boundary="f p p" if ends else "p p p", box=(low, high),
                   dt=0.1 * DT,
                   fluid=f"sound {SOUND} tension yes background 5 shift {C}",
                   commands=commands) as s:
            s.run()
            value = lambda: {i: row for i, *row in zip(s.get("id"), s.get("x")[:, 0],
                                                       s.get("rho"), s.get("rmass")
                                                       * s.compute("psi", columns=False))}
            before = value()
            s.run(250)
            after = value()
        change = np.array([np.subtract(after[i], before[i])[1:] for i in before if i in after
                           and abs(before[i][0] - size[0] / 2) < size[0] / 2 - 4 * dx])
        assert len(change) > 100
        lag[ends] = np.abs(change[:, 0] - change[:, 1]).max() / np.ptp(change[:, 1])
    print(f"rho - m psi has changed by {lag[True]:.4f} of the range in which m psi has, without "
          f"open ends by {lag[False]:.3f}")
    # the displacement of the last step is not in it yet, and gradients of W are those of the middle
    # of a step
    assert lag[True] < 0.02 and lag[False] > 0.2


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("kernel, hdx", [("quintic", 1.0), ("quintic", 0.94), ("wendland", 1.5),
                                         ("wendland", 1.8), ("cubic", 1.3)])
def test_bound_is_below_what_overshoots(kernel, hdx, dim):
    """Plane waves of displacements on a lattice: N C c dt = L turns their part along an eigenvector
    into 1 - L h lambda of it, which grows from L = 2/(h lambda) on. The bound, h/2, has to be less
    for all wave vectors, kernels as they are recommended, in 2D and 3D."""
    k = Kernel(kernel, dim, hdx)
    x = lattice([9] * dim, 1.0, center=True)[:, :dim]
    r = np.linalg.norm(x, axis=1)
    x, r = x[(r > 0) & (r < k.cut)], r[(r > 0) & (r < k.cut)]
    pull = lambda s: k.g(s) * (1 + 0.2 * (k.W(s) / k.W(1.0))**4)
    slope = (pull(r * (1 + 1e-6)) - pull(r * (1 - 1e-6))) / (2e-6 * r)
    gradient = (pull(r)[:, None, None] * np.eye(dim) + (slope / r)[:, None, None] * x[:, :, None]
                * x[:, None, :])
    largest = max(
        np.linalg.eigvalsh(np.einsum("jab,j->ab", gradient, 1 - np.cos(x @ np.array(wave))))[-1]
        for wave in product(np.linspace(0, np.pi, 13), repeat=dim))
    grows_from = 2 / (hdx**2 * largest)
    print(f"{kernel} {hdx} in {dim}D: displacements grow from N C c dt = {grows_from:.2f} h on")
    assert 0.5 < grows_from < 0.9
