"""Time integration: eqs. 15-18 of the paper, second order, reversible."""

import numpy as np
import pytest
from scenes import RUBBER, WATER, Scene, close, cloud, lattice, pairs, sum_over

DIMS = pytest.mark.parametrize("dim", [2, 3])


@DIMS
def test_one_particle(dim):
    """x += dt/2 v; v += dt a; x += dt/2 v."""
    dt, a = 0.037, np.array([1.5, -9.81, 2.0 if dim == 3 else 0.0])
    x, v = np.zeros((1, 3)), np.array([[0.3, 0.7, -0.2 if dim == 3 else 0.0]])
    size = np.linalg.norm(a)
    box = ((-50, -50, -50), (50, 50, 50))
    gravity = f"fix g all gravity {size!r} vector {a[0]} {a[1]} {a[2]}"
    with Scene(x, v, dim=dim, box=box, dt=dt, commands=[gravity]) as s:
        for _ in range(20):
            x = x + dt / 2 * v
            v = v + dt * a
            x = x + dt / 2 * v
            s.run(1)
            # a is formed as (m a)/m: some bits of 1e-16 per step
            close(s.get("v"), v, 1e-14)
            close(s.get("x"), x, 1e-14)


@DIMS
@pytest.mark.parametrize("mode", ["summation", "continuity"])
def test_whole_scheme(dim, mode):
    """A cloud of fluid follows a second implementation: density half a step ahead, forces at the
    middle of the step."""
    dt, dx, c = 1e-3, 0.1, 10.0
    x, v = cloud([5] * dim, dx, vmax=0.5)
    with Scene(x, v, dim=dim, dx=dx, hdx=1.3, dt=dt, fluid="tension yes",
               density=f"fluid {mode}") as s:
        s.run()
        m, rho, k, n = s.get("rmass"), s.get("rho"), s.kernel, len(x)
        for _ in range(25):
            if mode == "continuity":
                i, j, d, r = pairs(x, k.cut)
                rho = rho + dt * sum_over(i, m[i] * k.g(r) * ((v[i] - v[j]) * d).sum(1), n)
            x = x + dt / 2 * v
            i, j, d, r = pairs(x, k.cut)
            if mode == "summation":
                rho = m * (k.W(0.0) + sum_over(i, k.W(r), n))
            pv2 = c**2 * (rho - 1000) * (m / rho)**2
            v = v - dt * sum_over(i, ((pv2[i] + pv2[j]) * k.g(r))[:, None] * d, n) / m[:, None]
            x = x + dt / 2 * v
        s.run(25)
        # round-off of 25 steps, amplified by collisions of the shaken particles
        close(s.get("x"), x, 1e-11)
        close(s.get("v"), v, 1e-10)
        close(s.get("rho"), rho, 1e-11)


def patch(dim, material, dt, mode="continuity", **more):
    """A free patch at rest, pressed together in the middle."""
    x = lattice([6 if dim == 2 else 4] * dim, 0.1, center=True)
    s = Scene(x, dim=dim, dx=0.1, dt=dt, materials=(material,), fluid="sound 10 tension yes",
              # no fluid has mode ratio
              density=f"solid {mode}" + ("" if mode == "ratio" else f" fluid {mode}"), **more)
    s.run()
    if mode == "continuity":
        s.put("rho", 1000 + 40 * np.exp(-(x**2).sum(1) / 0.04))
    else:
        s.put("x", x * (0.97 + 0.1 * (x**2).sum(1, keepdims=True)))
    return s


@DIMS
@pytest.mark.parametrize("mode,material",
                         [("continuity", WATER), ("summation", WATER), ("continuity", RUBBER),
                          ("ratio", RUBBER)])
def test_second_order(dim, mode, material):
    """Differences of runs with dt, dt/2, dt/4 (Richardson) fall by 4. The patch starts at rest:
    density and stress stand half a step behind the positions, which is the same thing only where
    nothing moves."""
    end = []
    for n in (40, 80, 160):
        with patch(dim, material, 0.04 / n, mode, solid="gradient corrected") as s:
            end.append(s.run(n).get("x"))
    slope = np.log2(np.linalg.norm(end[0] - end[1]) / np.linalg.norm(end[1] - end[2]))
    print(f"order in dt, {dim}D {mode} {material.split()[0]}: {slope:.3f}")
    assert 1.9 < slope < 2.1


@DIMS
def test_start_in_motion(dim):
    """With continuity a start with div v != 0 is of first order, unless rho is given for half a
    step earlier."""
    slope = []
    for back in (False, True):
        end = []
        for n in (40, 80, 160):
            x, dt = lattice([6 if dim == 2 else 4] * dim, 0.1, center=True), 0.04 / n
            v = -0.3 * x
            with Scene(x, v, dim=dim, dx=0.1, dt=dt, fluid="tension yes") as s:
                s.run()
                i, j, d, r = pairs(x, s.kernel.cut)
                rate = sum_over(i, s.get("rmass")[i] * s.kernel.g(r) * ((v[i] - v[j]) * d).sum(1),
                                len(x))
                s.put("rho", 1000 - dt / 2 * rate * back)
                end.append(s.run(n).get("x"))
        slope.append(np.log2(np.linalg.norm(end[0] - end[1]) / np.linalg.norm(end[1] - end[2])))
    print(f"order in dt from a start in motion, {dim}D: {slope[0]:.3f}, with rho of half a step "
          f"before: {slope[1]:.3f}")
    assert 0.9 < slope[0] < 1.1 and 1.9 < slope[1] < 2.1


@DIMS
@pytest.mark.parametrize("mode,material",
                         [("continuity", WATER), ("summation", WATER), ("continuity", RUBBER),
                          ("summation", RUBBER)])
def test_reversible(dim, mode, material):
    """N steps, -v, N steps: back at the start.

    Density and stress are half a step behind x and v. The backward run has to start from those half
    a step ahead in its past, which is the forward run's future: they come from one more forward
    step, whose x and v are undone.
    """
    steps = 100
    with patch(dim, material, 5e-4, mode, solid="gradient corrected") as s:
        x0 = s.get("x")
        s.run(steps)
        x, v, rho = s.get("x"), s.get("v"), s.get("rho")
        moved = np.abs(x - x0).max()
        s.run(1)
        s.put("x", x), s.put("v", -v)
        s.run(steps)
        back = np.abs(s.get("x") - x0).max()
        print(f"reversal, {dim}D {mode} {material.split()[0]}: moved {moved:.2e}, back to "
              f"{back:.1e}")
        assert moved > 1e-4
        # round-off 1e-16 of size 1 per step, amplified little: nothing collides
        assert back < 1e-12
        assert np.abs(s.get("v")).max() < 1e-10
        if mode == "continuity" and material == WATER:
            # without that step the density is off by dt d rho/dt and the way back differs
            s.put("x", x), s.put("v", -v), s.put("rho", rho)
            s.run(steps)
            assert np.abs(s.get("x") - x0).max() > 1e-8


@pytest.mark.parametrize("dim", (2, 3))
def test_neighbors_in_space_are_neighbors_in_memory(dim):
    """IDs that say nothing of places: in cells of dx the next particle is in the same cell or the
    next one, but where a row of cells ends. By ID it would be a third of the box away."""
    n = 24 if dim == 2 else 12
    x = np.random.default_rng(2).permutation(lattice([n] * dim, 0.1))
    with Scene(x, dim=dim, dx=0.1, dt=1e-4) as s:
        s.run(1)
        stored = s.lmp.numpy.extract_atom("x")[:len(x)]
        jump = np.linalg.norm(np.diff(stored, axis=0), axis=1)
    rows = (n + 1)**(dim - 1)
    assert np.sort(jump)[-rows - 1] < (0.2**2 + (dim - 1) * 0.1**2)**0.5 + 1e-9 and len(
        jump) == len(x) - 1


@DIMS
def test_forces_see_who_comes_near_in_the_half_step(dim):
    """In a step the forces are over the pairs that the rates found half a step earlier; at the
    start of a run over the neighbor lists. With particles that cover a sixth of a spacing in half a
    step, toward each other, toward walls, and walls toward them, both are the same."""
    dx, dt, wall = 0.1, 0.01, 1.0
    x, v = cloud((9, 8) if dim == 2 else (6, 6, 5), dx, jitter=0.2, vmax=3.0, seed=4)
    x[:, :dim] += 0.3 * dx  # nobody is behind the walls half a step later
    walls = lambda at: f"fix w all fsi/wall/mirror xlo {at!r} velocity {wall} 0 0 ylo {-0.2 * dx!r}"
    fluid = dict(dim=dim, dx=dx, fluid="sound 20 artificial/visc 0.1 0.1 density/diffusion 0.1")
    start = -0.15 * dx
    with Scene(x, v, dt=dt, commands=[walls(start)], **fluid) as s:
        s.run(1)
        expected, rho = s.get("f"), s.get("rho")
    half = x + 0.5 * dt * v
    with Scene(half, v, dt=dt, commands=[walls(start + 0.5 * dt * wall)], **fluid) as s:
        s.put("rho", rho)
        close(s.run().get("f"), expected, 1e-12)
    # it is such pairs that count: without them the forces would be others
    r, before = (np.linalg.norm(y[:, None] - y[None], axis=2) for y in (half, x))
    assert ((r < 0.97 * 3 * dx) & (before > 3 * dx)).sum() > 10
