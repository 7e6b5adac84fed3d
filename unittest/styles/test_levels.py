"""Fluid of several spacings (fix fsi spacing of fluid types)."""

import re
from dataclasses import replace

import numpy as np
import pytest
from decks import JUMP, WALL, agree_on_ranks, deck, goes_on_bit_for_bit, levels_gate, near
from scenes import (RUBBER, WATER, Kernel, Scene, close, cloud, difference, lammps, lattice, pairs,
                    run, sum_over, watch)


def beside(dim, ratio=JUMP, n=6, jitter=0.2, vmax=0.5, dx=0.1):
    """A shaken cloud in x < 0 and one `ratio` times finer in x > 0, cells face to face: x, v, which
    are fine"""
    coarse = cloud([n] * dim, dx, jitter=jitter, vmax=vmax)
    fine = cloud([round(ratio * n)] * dim, dx / ratio, seed=2, jitter=jitter, vmax=vmax)
    fine[0][:, 0] += n * dx
    x, v = (np.concatenate(both) for both in zip(coarse, fine))
    return x, v, np.arange(len(x)) >= len(coarse[0])


def levels(ratio=JUMP, dx=0.1, **options):
    return dict(dx=dx, density=f"spacing 2 {dx / ratio!r}",
                **{"materials": (WATER, WATER), **options})


def images(s, x, fine, floor, ratio=JUMP):
    """The same of pairs with images in a mirror at y = floor, the own one included"""
    h = np.where(fine, s.kernel.h / ratio, s.kernel.h)
    image = x * [1, -1, 1] + [0, 2 * floor, 0]
    d = x[:, None] - image[None]
    i, j = np.nonzero(np.linalg.norm(d, axis=2) < s.kernel.cut)
    return i, j, d[i, j], np.linalg.norm(d[i, j], axis=1), Kernel(
        s.kernel.name, s.dim, 0.5 * (h[i] + h[j])), (h[j] / h[i])**s.dim


@pytest.mark.parametrize("kernel", ["wendland", "quintic"])
@pytest.mark.parametrize("dim, ratio", [(2, JUMP), (2, 3), (3, JUMP)])
@pytest.mark.parametrize("fluid",
                         ["", "artificial/visc 0.3 0.5 laminar/visc", "laminar/visc/central"])
def test_pair_law(dim, ratio, fluid, kernel):
    """Masses, forces and number densities against numpy: every pair has the kernel of the mean of
    both spacings, volumes are each particle's own, and pressures count by the volumes of the
    lattices, omega p_i V_i^2 + p_j V_j^2/omega. A floor mirrors both fluids."""
    x, v, fine = beside(dim, ratio, n=6 if dim == 2 else 4)
    floor = x[:, 1].min() - 0.03
    with Scene(x, v, dim=dim, type=1 + fine, fluid=fluid, dt=1e-5, kernel=kernel, hdx=1.2,
               **levels(ratio, materials=(WATER + " viscosity 20",) * 2),
               commands=["compute psi all fsi/atom psi",
                         f"fix w all fsi/wall/mirror ylo {floor!r} guard 0"]) as s:
        s.run()
        m = s.get("rmass")
        assert np.allclose(m[fine] * ratio**dim, m[0], rtol=1e-12)
        rho = np.random.default_rng(9).uniform(1000, 1050, len(x))
        s.put("rho", rho)
        s.run()
        V, p = m / rho, s.p
        force, psi = np.zeros((s.n, 3)), np.zeros(s.n)
        for image, (i, j, d, r, k, omega) in enumerate(
            (near(s, x, fine, ratio), images(s, x, fine, floor, ratio))):
            vj, g = (v[j] * [1, -1, 1] if image else v[j]), k.g(r)
            w = v[i] - vj
            pair = -((omega * p[i] * V[i]**2 + p[j] * V[j]**2 / omega) * g)[:, None] * d
            if "artificial" in fluid:
                mu = np.minimum((w * d).sum(1), 0) * k.h / (r**2 + 0.01 * k.h**2)
                pair -= ((rho[i] + rho[j]) / 2 * V[i] * V[j] * (-0.3 * 10 * mu + 0.5 * mu**2)
                         * g)[:, None] * d
            if "laminar" in fluid:
                pair += (m[i] * m[j] / 1000**2 * 2 * 20 * g)[:, None] * k.rubbing(fluid, 1.2, w, d)
            force += sum_over(i, pair, s.n)
            psi += sum_over(i, omega * k.W(r), s.n)
        close(s.get("f"), force, 1e-12)
        # of finer fluid it is what it would be on the coarse lattice
        psi = ((psi + np.where(fine, Kernel(kernel, dim, s.kernel.h / ratio).W(0), s.kernel.W(0)))
               * np.where(fine, ratio**-dim, 1.0))
        close(s.compute("psi", columns=False), psi, 1e-12)


@pytest.mark.parametrize("same", [True, False])
@pytest.mark.parametrize("delta", [0.0, 0.1])
@pytest.mark.parametrize("dim", [2, 3])
def test_density_rate(dim, delta, same):
    """d rho_i/dt = m_i sum omega v_ij.grad W and, in one fluid, diffusion with V_j, h and W of the
    pair: the change over one step"""
    x, v, fine = beside(dim, n=6 if dim == 2 else 4)
    dt, g = 2e-4, 9.81 * np.array([1, 2, 0]) / np.sqrt(5)
    rho0 = np.where(fine, 1000.0 if same else 900.0, 1000.0)
    rho = rho0 * np.random.default_rng(7).uniform(0.99, 1.01, len(x))
    with Scene(x, v, dim=dim, type=1 + fine, dt=dt, fluid=f"tension yes density/diffusion {delta}",
               **levels(materials=(WATER, f"fluid rho {rho0[-1]}")),
               commands=["fix g all gravity 9.81 vector 1 2 0"]) as s:
        s.run()
        s.put("rho", rho)
        m = s.get("rmass")
        i, j, d, r, k, omega = near(s, x, fine)
        grad = k.g(r)
        rate = sum_over(i, m[i] * omega * grad * ((v[i] - v[j]) * d).sum(1), len(x))
        one = same | (fine[i] == fine[j])
        rate += sum_over(i, one * 2 * delta * k.h * 10 * (m / rho)[j]
                         * (rho[j] - rho[i] + rho0[i] / 100 * (d @ g)) * -grad, len(x))
        got = (s.run(1).get("rho") - rho) / dt
    close(got, rate, 1e-11)    # as in test_density.py, with a step ten times shorter


@pytest.mark.parametrize("dim", [2, 3])
def test_momentum(dim):
    x, v, fine = beside(dim, jitter=0.1, n=6 if dim == 2 else 4)
    with Scene(x, v, dim=dim, type=1 + fine, dt=2e-4, fluid="artificial/visc 0.1 0.1 laminar/visc "
               "density/diffusion 0.1 shift 0.2 shift/every 4",
               **levels(materials=(WATER + " viscosity 1",) * 2)) as s:
        s.run()
        before, size = s.momentum(), (s.get("rmass")[:, None] * np.abs(s.get("v"))).sum()
        s.run(100)
        assert np.abs(s.momentum() - before).max() < 1e-14 * size
        assert np.abs(s.get("v") - v).max() > 0.01


def test_ledger_closes():
    """Energies and what terms took: the error of a column whose lower half is finer is of the time
    step's order"""
    error = []
    for dt in (4e-5, 2e-5, 1e-5):
        x, v, fine = beside(2, n=8, jitter=0.05, vmax=0.3, dx=0.01)
        with Scene(x, v, type=1 + fine, dt=dt,
                   fluid="artificial/visc 0.1 0.1 laminar/visc density/diffusion 0.1 tension yes",
                   **levels(dx=0.01, materials=(WATER + " viscosity 1",) * 2),
                   commands=["fix g all gravity 9.81 vector -1 0 0", "compute e all fsi/energy",
                             "fix w all fsi/wall/mirror xlo 0"]) as s:
            s.run()
            before = s.ledger()
            s.run(round(0.004 / dt))
            after = s.ledger()
            error.append(abs((after - before).sum()) / np.abs(after - before).max())
    print("imbalance over the largest entry", error)
    assert error[-1] < 5e-3 and error[2] < 0.6 * error[1] < 0.36 * error[0]


@pytest.mark.parametrize("dim", [2, 3])
def test_ranks_and_newton(tmp_path, dim):
    agree_on_ranks(tmp_path, levels_gate(dim))


@pytest.mark.parametrize("ranks", [1, 2])
def test_restart_goes_on_bit_for_bit(tmp_path, ranks):
    goes_on_bit_for_bit(tmp_path, levels_gate(2), ranks)


@pytest.mark.parametrize("edit, message", [
    (("density", "fluid summation solid continuity"),
     r"spacing 0\.\d+ of type 2, a fluid, requires density by continuity, as fix fsi scheme "
     r"standard has it: number densities are not smooth"),
    (("fluid", "sound 10 density/surface yes"),
     r"a fluid, requires pair_style fsi/fluid density/surface no"),
    (("sph", "spacing 3 0.018"), r"\d+ fluid particles, the first of them atom \d+, meet a body or "
     r"wall that is more than 2 times coarser"),
], ids=["summation", "surface", "coarse body"])
def test_refused(tmp_path, edit, message):
    key, value = edit
    scene = levels_gate(2, fluid="sound 10 couple wall")
    scene = replace(scene, **{key: f"{scene.sph} {value}" if key == "sph" else value})
    result = lammps(tmp_path, scene.text() + "run 0\n", scene_data=scene.data())
    assert result.status and any(re.search(message, line)
                                 for line in result.errors), result.output[-1000:]


@pytest.mark.parametrize("couple", ["wall", "full"])
def test_couple_full_is_refused(couple):
    x, v, fine = beside(2)
    with Scene(x, v, type=1 + fine, fluid=f"sound 10 couple {couple}", **levels()) as s:
        if couple == "wall":
            s.run()
            return
        with pytest.raises(Exception, match=r"spacing 0\.0714\d+ of type 2, a fluid, requires "
                           r"couple wall in pair_style fsi/fluid"):
            s.run()


def test_inlet_is_for_the_coarsest(tmp_path):
    x, v, fine = beside(2, jitter=0.0, vmax=0.0)
    with Scene(x, v, type=1 + fine, fluid="tension yes background 5", **levels(),
               commands=[f"fix i all fsi/inlet xhi {x[:, 0].max() + 0.036!r} velocity 0 0 0"]) as s:
        with pytest.raises(Exception, match=r"particles of fluid finer than dx, 0\.1, the first of "
                           r"them atom \d+, are wi"):
            s.run()


def test_room_before_a_plane_beside_a_jump():
    """Water at rest, finer from 0.8 on before an outlet's plane: the mass near it, within 1.0, is
    what there is room for. Where two lattices meet number densities are those of neither."""
    x = np.vstack([lattice((8, 5), 0.1), lattice((14, 7), 0.5 / 7) - [1.0, 0, 0]])
    with Scene(x, type=1 + (x[:, 0] < 0), fluid="tension yes background 5", **levels(1.4),
               box=((-1.2, 0), (1.6, 0.5)), boundary="f p p",
               commands=["fix o all fsi/outlet xhi 0.8"]) as s:
        s.run()
        room = s.lmp.extract_fix("o", 0, 1, 10)
        print(f"mass over room: {room}")
        assert abs(room - 1) < 1e-9


@pytest.mark.parametrize("ratio, warned", [(1.4, False), (2, True)])
def test_jump_is_named(tmp_path, ratio, warned):
    scene = levels_gate(2, ratio)
    result = run(tmp_path, scene.text() + "run 0\n", scene_data=scene.data())
    assert bool(re.search(r"WARNING.*fluid particles, the first of them atom \d+, meet fluid more "
                          r"than 1\.45 times finer: pressure is noisy", result.output)) == warned


@pytest.mark.parametrize("kernel", ["wendland", "quintic"])
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("walls", [False, True])
def test_displacement(dim, kernel, walls):
    """Of particle shifting in fluid without a surface: volumes, W and the mean spacing of each
    pair; of the factor 0.2 that is left by which neighbors come and go, more than none and less
    than all on many particles. Of particles of walls, too, as much as is left to the fluid: here
    for the coarse one."""
    C, c, dt = 0.5, 10.0, 2e-3
    x, v, fine = beside(dim, n=7 if dim == 2 else 5, jitter=0.1, vmax=0.03)
    got = {}
    held = np.zeros(len(x), bool)
    held[:np.count_nonzero(~fine):9] = walls
    v[held] = 0
    own = dict(held=held, materials=(WATER, WATER, "wall rho 1000"),
               commands=["fix wp held fsi/wall/particle guard 0"]) if walls else {}
    for shift in (0, C):
        with Scene(x, v, dim=dim, type=np.where(held, 3, 1 + fine), dt=dt, kernel=kernel, hdx=1.2,
                   fluid=f"sound {c} tension yes background 5 shift {shift}", **levels(**own)) as s:
            s.run()
            V = s.get("rmass") / s.get("rho")
            s.run(1)
            got[shift] = s.get("x")
            # at the time of the step's middle, for which the forces are
            i, j, d, r, k, _ = near(s, x + dt / 2 * v, fine)
            u2 = sum_over(i, ~held[j] * V[j] * k.W(r) * ((v[i] - v[j]) * d).sum(1)**2 / r**2, s.n)
            left = np.minimum(1, u2 / (0.003 * c)**2)
            i, j, d, r, k, _ = near(s, x, fine)
            spacing = Kernel(kernel, dim, k.h).W(k.h / 1.2)
            w = k.W(r) / spacing
            factor = np.where(held[j], Kernel(kernel, dim, 1.2).weight_of_wall(w, 1.0) - 1,
                              0.2 * w**4)
            want = sum_over(i, (V[j] * (1 + left[i] * factor) * k.g(r))[:, None] * d, s.n)
            h = np.where(fine, s.kernel.h / JUMP, s.kernel.h)
    want *= -C * c * h[:, None] * dt
    size = np.linalg.norm(want, axis=1)
    want *= np.minimum(1, 0.25 * C * c * dt / size)[:, None]
    assert ((left > 0.1) & (left < 0.9)).sum() > 0.2 * len(x) and (left == 1).any()
    judged = ~held & ~(walls & fine)
    assert np.abs(got[C] - got[0] - want)[judged].max() < 1e-12


def test_still_water():
    """Where 10 rows of 1/21 of the depth meet 8 of 1/15, pressures are within 1 % of rho g H of the
    hydrostatic ones (root mean square, as far as the kernels of both reach), the largest deviation
    within 3 %"""
    df, dc, c = 1 / 21, 1 / 15, 10 * np.sqrt(2)
    face = 10 * df
    H = face + 8 * dc
    x = np.concatenate([lattice([14, 10], df), lattice([10, 8], dc) + [0, face, 0]])
    dt = 0.25 * 1.5 * df / c
    with Scene(x, type=np.repeat([2, 1], [140, 80]), dt=dt,
               fluid=f"sound {c} artificial/visc 0.02 0 density/diffusion 0.1", **levels(1.4, dc),
               commands=["fix g all gravity 1 vector 0 -1 0",
                         f"fix w all fsi/wall/mirror xlo 0 xhi {14 * df!r} ylo 0",
                         f"fsi/set all hydrostatic {H}"]) as s:
        s.run(round(6 / dt))
        y = s.get("x")[:, 1]
        error = s.p / (1000 * H) - (1 - y / H)
    near = np.abs(y - face) < 3 * dc
    print(f"pressure at the jump: {100 * np.sqrt((error[near]**2).mean()):.2f} %, largest "
          f"{100 * np.abs(error[near]).max():.2f} % of rho g H")
    assert np.sqrt((error[near]**2).mean()) < 0.01 and np.abs(error[near]).max() < 0.03


def test_poiseuille():
    """Between fine bands along both walls of a channel, with shifting: the profile keeps within 1 %
    of the largest velocity, scatter about it within 0.5 %"""
    c, nu, rows = 15.0, 0.05, 12
    dc, df = 1 / rows, 1 / rows * 3 / 4    # 3 coarse rows are 4 fine ones
    low = lattice([16, 4], df)
    x = np.concatenate([low, low + [0, 0.75, 0], lattice([12, 6], dc) + [0, 0.25, 0]])
    type_ = np.repeat([2, 1], [128, 72])
    v = np.stack([4 * x[:, 1] * (1 - x[:, 1]), 0 * x[:, 1], 0 * x[:, 1]], 1)
    dt = 0.375 * df / c
    with Scene(x, v, type=type_, dt=dt, boundary="p f p", box=((0, -0.5, 0), (1, 1.5, 0)),
               kernel="quintic", hdx=1.0,
               materials=(f"fluid rho 1000 viscosity {1000 * nu}",) * 2,
               fluid=f"sound {c} background 1000 tension yes laminar/visc density/diffusion 0.1 "
               "shift 0.25 shift/every 4", dx=dc, density=f"spacing 2 {df!r}",
               commands=["fix w all fsi/wall/mirror ylo 0 slip no yhi 1 slip no",
                         f"fix g all gravity {8 * nu} vector 1 0 0"]) as s:
        s.run(round(2 / dt))
        y, u = s.get("x")[:, 1], s.get("v")[:, 0]
        exact = 4 * y * (1 - y)
    fit = np.polyval(np.polyfit(y, u - exact, 6), y)
    print(f"velocity: {100 * np.abs(fit).max():.2f} %, scatter {100 * np.std(u - exact - fit):.3f} "
          "% of the largest")
    assert np.abs(fit).max() < 0.01 and np.std(u - exact - fit) < 0.005


@pytest.mark.parametrize("rule", ["number/density", "divergence"])
@pytest.mark.parametrize("dim", [2, 3])
def test_surface(dim, rule):
    """Of a block of two spacings, five coarse rows to seven fine ones: the first layer, all of it,
    and nobody where the two meet. In layer 1 of one lattice the rules find 0.79 (cubic, h = 1.2
    dx), in layer 2 0.99; where lattices meet it is 0.96 or more. The rule of the equation of state
    agrees."""
    x, v, fine = beside(dim, n=10 if dim == 2 else 5, jitter=0.0, vmax=0.0)
    n = 1.0 if dim == 2 else 0.5
    first = 0.75 * np.where(fine, 0.1 / JUMP, 0.1)[:, None]
    face = ((x < first) | (x > [2 * n, n, n] - first))[:, :dim]
    with Scene(x, type=1 + fine, dim=dim, kernel="cubic", hdx=1.2, fluid="sound 10 surface 0.9",
               **levels()) as s:
        s.run().run_lines("compute psi all fsi/atom psi", "compute surface all fsi/surface/atom "
                          f"{rule} {dict(divergence=0.75).get(rule, 0.9)}")
        s.put("rho", 1001.0)
        found = s.run().compute("surface", columns=False)
        assert np.array_equal(found.astype(bool), face.any(1))
        np.testing.assert_allclose(s.p, np.where(face.any(1), 0.0, 100.0), rtol=1e-12)
        psi = s.compute("psi", columns=False) / s.kernel.lattice_sum(0.1, dim)
        assert psi[~face.any(1)].min() > 0.96 and psi[face.any(1)].max() < 0.82


@pytest.mark.parametrize("kernel", ["wendland", "quintic"])
@pytest.mark.parametrize("dim", [2, 3])
def test_probe(dim, kernel):
    """At points on both sides of a jump, on it, and on a mirror floor: each particle counts with
    the kernel of its own spacing"""
    x, v, fine = beside(dim, n=8 if dim == 2 else 6)
    size, floor = (0.8 if dim == 2 else 0.6), x[:, 1].min() - 0.03
    points = [(size + a, b, 0.3 * (dim == 3)) for a, b in ((-0.25, 0.3), (-0.05, 0.31), (0.0, 0.3),
                                                           (0.07, 0.25), (0.3, 0.3), (0.0, floor))]
    text = " ".join(f"point {a!r} {b!r} {c!r}" for a, b, c in points)
    with Scene(x, v, dim=dim, type=1 + fine, kernel=kernel, hdx=1.2, fluid="tension yes",
               **levels(),
               commands=[f"fix w all fsi/wall/mirror ylo {floor!r} guard 0",
                         f"compute probe all fsi/probe p rho vx vy fill {text}"]) as s:
        s.put("rho", np.random.default_rng(4).uniform(1000, 1050, len(x)))
        s.run()
        got = np.array(s.lmp.numpy.extract_compute("probe", 0, 2))
        V, p, rho = s.get("rmass") / s.get("rho"), s.p, s.get("rho")
        want = []
        for point in points:
            sums = 0.0
            for up in (1, -1):
                r = np.linalg.norm(point - (x * [1, up, 1] + [0, floor * (1 - up), 0]), axis=1)
                W = np.where(fine, Kernel(kernel, dim, s.kernel.h / JUMP).W(r), s.kernel.W(r))
                sums = sums + (V * W) @ np.column_stack([p, rho, v[:, 0], up * v[:, 1],
                                                         np.ones(len(x))])
            want.append(np.append(sums[:4] / sums[4], sums[4]))
        for k in range(5):
            close(got[:, k], np.array(want)[:, k], 1e-11)


@pytest.mark.parametrize("dim", [2, 3])
def test_guard(dim):
    """Of a wall of particles below fluid of two spacings: pairs nearer than d, 0.9 of the mean
    spacing of both, are counted and repel with the energy K d^D (1 - r/d)^2/2, K = rho c^2. Forces
    are those with the guard less those without it."""
    x, v, fine = beside(dim, n=6 if dim == 2 else 4, jitter=0.3)
    wall = lattice([14] + [2 if k == 0 else 6 for k in range(dim - 1)],
                   0.1 / JUMP) - np.eye(3)[1] * 0.11
    both, type_ = np.concatenate([x, wall]), np.repeat([1, 3], [len(x), len(wall)])
    type_[:len(x)] += fine
    got = []
    for guard in (0.9, 0.0):
        with Scene(both, dim=dim, type=type_, held=type_ == 3, fluid="sound 10 tension yes", dx=0.1,
                   density=f"spacing 2*3 {0.1 / JUMP!r}",
                   materials=(WATER, WATER, "wall rho 1000"),
                   commands=[f"fix wp held fsi/wall/particle guard {guard}"]) as s:
            s.run()
            got.append((s.get("f"), s.fix_scalar("wp")))
    own = np.where(type_ == 1, 0.1, 0.1 / JUMP)
    i, j, apart, r = pairs(both, 0.1)
    d = 0.9 * 0.5 * (own[i] + own[j])
    near = ((type_[i] == 3) != (type_[j] == 3)) & (r < d)
    force = sum_over(i[near], (1e5 * d**(dim - 2) * (d / r - 1))[near, None] * apart[near],
                     len(both))
    assert all((near & (type_[i] == t)).sum() >= 3 for t in (1, 2))
    assert got[0][1] == near.sum() / 2 and got[1][1] == 0
    close(got[0][0] - got[1][0], force, 1e-12)


@pytest.mark.parametrize("kind", ["wall", "body"])
def test_hydrostatic_load(kind):
    """Of water that is finer beside a wall of particles or a held body of the fine spacing, over
    the exact one: within 2 %, as on one lattice"""
    df, dc, c = 0.01, 0.014, 20.0
    H, wide = 14 * df, 10 * dc
    fine, coarse, wall = lattice([14, 14], df), lattice([10, 10], dc), lattice([4, 18], df)
    x = np.concatenate([coarse, fine + [wide, 0, 0], wall + [wide + 14 * df, 0, 0]])
    type_ = np.repeat([1, 2, 3], [len(coarse), len(fine), len(wall)])
    rigid = kind == "wall"
    more = dict(materials=(WATER, WATER, "wall rho 1000")) if rigid else dict(
        materials=(WATER, WATER, RUBBER), solid_style="fsi/solid/tl", mol=type_)
    dt = 0.25 * 1.5 * df / c
    with Scene(x, dx=dc, type=type_, held=type_ == 3, dt=dt,
               fluid=f"sound {c} artificial/visc 0.2 0 density/diffusion 0.1",
               density=f"spacing 2*3 {df!r}", **more, commands=[
                   "fix g all gravity 9.81 vector 0 -1 0", "fix w all fsi/wall/mirror xlo 0 ylo 0",
               *(["fix wp held fsi/wall/particle"] if rigid else []),
                   f"fsi/set moving hydrostatic {H}", "compute force held fsi/force"]) as s:
        s.run(round(0.3 / dt))
        load = []
        for _ in range(20):
            s.run(round(0.005 / dt))
            load.append(s.compute_vector("force")[0])
    found = np.mean(load) / (0.5 * 1000 * 9.81 * H**2)
    print(f"load on a {kind} beside fine and coarse water: {found:.4f} of the hydrostatic one")
    assert abs(found - 1) < 0.02


BESIDE = {  # what water of the same spacing flows to, how fast, and a line
    "mirror walls": (WALL, -2.0, "fix wp body fsi/wall/particle"),
    "linear pressure": (WALL, 0.1, "fix wp body fsi/wall/particle pressure linear"),
    "no light body": (RUBBER, 0.1, ""),
    "lines": (WALL, 0.1, "fix wp body fsi/wall/particle\n"
              "compute top water fsi/probe level line 0.29 0.02 0 0.29 0.3 0\n"
              "fix top all ave/time 60 1 60 c_top file top.txt"),
}


@pytest.mark.parametrize("case", BESIDE)
def test_fluid_finer_than_dx(tmp_path, case):
    """Water of one spacing that flows against mirror walls, which reflect some of it, or a body. With a dx four times as large, of a type without particles, it is the same to round-off:
    nothing counts in spacings of a fluid that is not there."""
    dx, (body, speed, line), last = 0.02, BESIDE[case], []
    solid = body == RUBBER
    for coarse in (dx, 4 * dx):
        fix = f"fix sph {'all' if solid else 'water'} fsi "
        text = deck("-0.1 0.6 -0.1 0.6", dx, {"water": WATER, "body": body, "far": WATER},
                    "fix g all gravity 9.81 vector 0 -1 0",
                    "fix w all fsi/wall/mirror xlo 0 ylo 0", line,
                    f"velocity water set {speed} {speed} 0 units box",
                    group=fix.split()[2], water="0 0.3 0 0.2", body="0.3 0.36 0 0.3", dt=2e-4,
                    fluid="sound 10 artificial/visc 0.05 0.1 density/diffusion 0.1",
                    sph=f"{'spacing 1*2 0.02' * (coarse > dx)} {'substeps 4' * solid}")
        assert fix + "0.02 " in text
        result = run(tmp_path / f"{coarse}", text.replace(fix + "0.02 ", f"{fix}{coarse} ")
                     + watch(every=60) + "run 60\nprint '$(f_w) reflected'\n")
        last.append(result)
    frames = [result.frames()[-1] for result in last]
    for quantity in ("x", "v", "rho"):
        assert difference(*frames, quantity) < 1e-10, quantity
    said = [re.findall(r"WARNING.*|.* acts like .*", result.output) for result in last]
    assert said[0] == said[1] and len(said[0]) > 1
    reflected = int(re.search(r"^(\d+) reflected", last[0].output, re.M)[1])
    assert (reflected > 0) == (speed < 0)
    if case == "lines":    # linear between points dx/4 apart: 0.02 dx
        top = [np.loadtxt(result.folder / "top.txt")[0, 1] for result in last]
        print(top)
        assert abs(top[0] - top[1]) < 0.02 * dx
