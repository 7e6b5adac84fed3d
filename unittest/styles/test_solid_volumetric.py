"""Nearly incompressible total-Lagrangian solids: the smoothed volumetric strain of pair_style
fsi/solid/tl, against numpy and against finite elements (elements.py) that do not lock."""

import numpy as np
import pytest
import solids
from elements import PlaneStrain, brick
from scenes import Scene, close, lattice, run, watch
from solids import DIMS, DX, Reference, angular, block, deformed, entry, files, same_state, solid

RHO, MU = 1000.0, 1.0e5 / 2.6    # the shear modulus of solids.py


def material(nu, rho=RHO):
    return f"solid rho {rho} young {2 * MU * (1 + nu)!r} poisson {nu}"


def lame_of(nu):
    return 2 * MU * nu / (1 - 2 * nu)


LOCAL = lame_of(0.3)    # what stays where it is


# ---- the law, written a second time --------------------------------------------------------------


class Smoothed:
    """sum_i V_i k u(theta_i), theta_i = sum_j w_ij m_j, over particles that move; w by least
    squares."""

    def __init__(self, reference, k, counts, same):
        self.reference, self.counts, self.w = reference, counts, np.zeros(
            (reference.n, reference.n))
        self.k = np.broadcast_to(k, reference.n)
        for i, (j, X, r, _) in enumerate(reference.bonds):
            near = same[j] == same[i]
            j, X, r = np.append(i, j[near]), np.vstack([0 * X[:1], X[near]]), np.append(0, r[near])
            root = np.sqrt(1 - (r / reference.kernel.cut)**2)
            phi = np.column_stack([np.ones(len(j)), X])
            self.w[i, j] = np.linalg.pinv(root[:, None] * phi)[0] * root

    def __call__(self, x, law):
        """Energy, forces, theta"""
        r, d = self.reference, self.reference.dim
        F = r.F(x)
        J = np.linalg.det(F)
        if law == "svk":
            m, dm = ((F**2).sum((1, 2)) - d) / 2, F
        else:
            m, dm = np.log(J), np.linalg.inv(F).transpose(0, 2, 1)
        theta = self.w @ m
        u, slope = (np.exp(theta) - 1 - theta,
                    np.exp(theta) - 1) if law == "hypo" else (theta**2 / 2, theta)
        weight = r.V * r.weight * self.k * self.counts
        P, f = (self.w.T @ (weight * slope))[:, None, None] * dm, np.zeros((r.n, 3))
        for i, (j, _, _, G) in enumerate(r.bonds):
            f[j, :d] -= G @ P[i].T
            f[i, :d] += (G @ P[i].T).sum(0)
        return (weight * u).sum(), f, theta


@DIMS
@pytest.mark.parametrize("law, kernel", [("svk", "wendland"), ("neohookean", "wendland"),
                                         ("neohookean", "quintic")])
def test_forces_and_energy(dim, law, kernel):
    """Shaken bodies, one of two rubbers of different shear modulus in each, some particles held:
    strains are smoothed within a rubber, energy is that of what moves."""
    x, _ = block(dim, jitter=0.1)
    x = np.vstack([x, x + [3.0, 0, 0]])
    mol, kind = np.repeat([1, 2], len(x) // 2), 1 + (np.arange(len(x)) % (len(x) // 2) > len(x)
                                                     // 5)
    held = np.arange(len(x)) % (len(x) // 2) > len(x) * 2 // 5
    soft, stiff = (f"solid rho {RHO} young {2 * MU * s * 1.49!r} poisson 0.49" for s in (1, 3))
    with solid(x, f"law {law} volumes plain hourglass 0", kernel=kernel, hdx=1.5 if kernel
               == "wendland" else 1.0, mol=mol, type=kind, materials=(soft, stiff),
               held=held, commands=["compute e all fsi/energy"]) as s:
        s.run()
        reference = Reference(x, s.kernel, dim, s.get("rmass"), mol)
        y = deformed(x, dim)
        s.put("x", y)
        s.run()
        scale = np.where(kind == 1, 1.0, 3.0)
        smoothed = Smoothed(reference, scale * (lame_of(0.49) - LOCAL), ~held, kind)
        energy, f, theta = smoothed(y, law)
        P, psi = reference.piola(reference.F(y), law, LOCAL)
        energy += (scale * reference.V * psi).sum()
        for i, (j, _, _, G) in enumerate(reference.bonds):
            fj = -scale[i] * reference.V[i] * G @ P[i].T
            f[j, :dim] += fj
            f[i, :dim] -= fj.sum(0)
        close(s.get("f"), f, 1e-11)    # as test_solid_tl's, lambda being 30 times as large
        assert entry(s, 3) == pytest.approx(energy, rel=1e-11)
        # the pressure that is written out has the smoothed strain, of held particles, too
        F = reference.F(y)
        dm = F if law == "svk" else np.linalg.inv(F).transpose(0, 2, 1)
        k = scale * (lame_of(0.49) - LOCAL) * theta
        P, J = scale[:, None, None] * P + k[:, None, None] * dm, np.linalg.det(F)
        sigma = P @ F.transpose(0, 2, 1) / J[:, None, None]
        zz = (lambda lam: lam * (np.trace(F.transpose(0, 2, 1) @ F, axis1=1, axis2=2) - 2) / 2
              if law == "svk" else lam * np.log(J))(scale * LOCAL) + k
        trace = np.trace(sigma, axis1=1, axis2=2) + (zz / J if dim == 2 else 0)
        close(s.p, -trace / 3, 1e-11)


@DIMS
@pytest.mark.parametrize("law", ["svk", "neohookean", "hypo"])
def test_force_is_minus_the_gradient_of_the_energy(dim, law):
    """By central differences of entry 4 of the ledger. Corrected volumes and hourglass control,
    too."""
    x = lattice([6, 5] if dim == 2 else [4, 4, 3], DX)
    with solid(x, f"law {law} hourglass 0.3 volumetric smoothed",
               materials=(material(0.35 if law == "hypo" else 0.499),),
               commands=["compute e all fsi/energy"] + ["fix stress all fsi/stress"]
               * (law == "hypo")) as s:
        s.run()
        y = deformed(x, dim)
        s.put("x", y)
        f = s.run().get("f")
        random = np.random.default_rng(4)
        for _ in range(4):
            u = np.zeros_like(y)
            u[:, :dim] = random.uniform(-1, 1, (len(y), dim))
            step, e = 1e-5 * DX, []
            for sign in (1, -1):
                s.put("x", y + sign * step * u)
                e.append(entry(s.run(), 3))
            # as in test_solid_tl; lambda is 300 times as large
            assert -(e[0] - e[1]) / (2 * step) == pytest.approx((f * u).sum(), rel=1e-5,
                                                                abs=1e-6 * np.abs(f).sum())


@DIMS
@pytest.mark.parametrize("substeps", [1, 5])
def test_momentum_and_angular_momentum(dim, substeps):
    x, v = block(dim, jitter=0.1, vmax=1.0)
    v += np.cross([0, 0, 5.0], x - x.mean(0)) + [0.5, 0, 0]
    with solid(x, "law neohookean hourglass 0.1 artificial/visc 0.1 0", v,
               materials=(material(0.49),), density=f"substeps {substeps}", dt=2e-4) as s:
        s.run()
        size, p, l = np.abs(s.get("rmass")[:, None] * v).sum(), s.momentum(), angular(s)
        s.run(600)
        assert np.abs(s.get("x") - x).max() > 0.5 * DX
        assert np.abs(s.momentum() - p).max() < 1e-13 * size
        assert np.abs(angular(s) - l).max() < 1e-13 * size


@pytest.mark.parametrize("law", ["svk", "neohookean"])
@pytest.mark.parametrize("substeps", [1, 4])
def test_energy_of_large_swings(law, substeps):
    """A clamped plate swings over a fifth of its length: energy is kept, its error falls with dt^2;
    with sub-steps held rows are left out of most."""
    x = lattice([24, 4], DX)
    v, clamp, drift = np.zeros_like(x), x[:, 0] < 4 * DX, []
    v[:, 1] = np.where(clamp, 0, 2.0 * ((x[:, 0] - 0.3) / 2)**2)
    for dt in (4e-4, 2e-4):
        with solid(x, f"law {law}", v, dt=substeps * dt, density=f"substeps {substeps}", held=clamp,
                   materials=(material(0.49),),
                   commands=["compute e all fsi/energy"]) as s:
            start, seen, far = entry(s.run()), [], 0.0
            for _ in range(16):
                s.run(round(0.8 / (16 * substeps * dt)))
                seen.append(entry(s))
                far = max(far, np.abs(s.get("x") - x).max())
        seen = np.array(seen)
        assert far > 0.4 and seen[:, 3].max() > 0.5 * start.sum()
        drift.append(np.abs(seen.sum(1) - start.sum()).max() / start.sum())
    print(f"energy of a plate that swings over {far:.2f} of 2 m, {law}, {substeps} sub-steps: "
          f"{drift[0]:.1e}, {drift[1]:.1e} with half the step")
    assert drift[0] < 2e-3 and drift[1] < 0.4 * drift[0]


# ---- where it is on ------------------------------------------------------------------------------


def forces(nu, keywords="", **more):
    x = lattice([6, 5], DX)
    with solid(x, keywords, materials=(material(nu),), **more) as s:
        s.run()
        s.put("x", deformed(x, 2))
        return s.run().get("f")


def test_off_up_to_a_bound():
    """Up to Poisson's ratio 0.4, in plane stress and with damage nothing changes, to the bit."""
    for nu, words in ((0.3, ""), (0.4, ""), (0.49, "plane stress"),
                      (0.49, "gradient linear damage 0.5")):
        assert np.array_equal(forces(nu, words), forces(nu, words + " volumetric local"))
    for nu, words in ((0.41, ""), (0.49, "law neohookean")):
        local, auto = forces(nu, words + " volumetric local"), forces(nu, words)
        assert np.array_equal(auto, forces(nu, words + " volumetric smoothed")) and np.abs(
            auto - local).max() > 0.01 * np.abs(local).max()
    assert not np.array_equal(forces(0.35), forces(0.35, "volumetric smoothed"))


@pytest.mark.parametrize("words, message",
                         [("plane stress", "does not go with plane stress: it does not lock"),
                          ("damage 0.2", "does not go with damage")])
def test_refused(words, message):
    with pytest.raises(Exception, match=message):
        forces(0.49, words + " volumetric smoothed")


def test_what_is_said(tmp_path):
    for nu, words, said, warned in ((0.49, "", True, False), (0.4, "", False, False),
                                    (0.25, "volumetric smoothed", False, True)):
        box, pair, rest = bodies(2, nu=nu)
        text = box + pair.replace("visc 0.1 0", f"visc 0.1 0 {words}") + rest + "run 0\n"
        output = run(tmp_path / f"{nu}", text, **files(2)).output
        assert ("smoothed volumetric strain of nearly incompressible solids" in output) == said
        assert (
            ("volumetric smoothed has nothing to act on: no Poisson's ratio is above 0.3" in output)
            == warned)


def test_checkerboards_of_volume_cost_energy():
    """Rows that stretch and shrink in turn, J alternating from row to row: never less than with
    Poisson's ratio 0.3 and the same shear modulus."""
    x, energy = lattice([12, 12], DX), {}
    for nu, words in ((0.3, "volumetric local"), (0.499, "")):
        with solid(x, words + " hourglass 0", materials=(material(nu),),
                   commands=["compute e all fsi/energy"]) as s:
            s.run()
            y = x.copy()
            y[:, 0] += 1e-3 * (x[:, 0] - 0.6) * (-1.0)**np.arange(12)[None].repeat(12, 0).ravel()
            s.put("x", y)
            energy[nu] = entry(s.run(), 3)
    # of the moduli lambda + 2 mu of alternating strains of 1e-3 the smoothed one keeps that of 0.3,
    # less what the gradient does not see
    assert energy[0.499] > energy[0.3] > 0.3 * 0.5 * (LOCAL + 2 * MU) * 1e-6 * 1.44


# ---- ranks and restarts --------------------------------------------------------------------------

def bodies(dim, newton="on", grid="* * *", substeps=1, nu=0.49):
    return solids.bodies(dim, newton, grid, substeps, 4e-5, "law neohookean artificial/visc 0.1 0",
                         f"solid rho 1000 young 3e5 poisson {nu}")


def go(tmp_path, dim, ranks, *how):
    text = "".join(bodies(dim, *how)) + watch(every=120) + "run 120\n"
    return run(tmp_path, text, ranks, **files(dim)).frames()


@pytest.mark.parametrize("dim, substeps", [(2, 1), (2, 3), (3, 1)])
def test_ranks(tmp_path, dim, substeps):
    """Two bodies that collide and cross borders of ranks."""
    end = go(tmp_path / "1", dim, 1, "on", "* * *", substeps)[-1]
    for ranks, grid, newton in ((1, "1 1 1", "off"), (2, "2 1 1", "on"), (4, "2 2 1", "off")):
        same_state(end, go(tmp_path / f"{ranks}{newton}", dim, ranks, newton, grid, substeps)[-1],
                   1e-10, np.array([1.2, 1.0, 0.9 if dim == 3 else 0.1]))


@pytest.mark.parametrize("ranks, substeps", [(1, 1), (2, 3)])
def test_restart(tmp_path, ranks, substeps):
    """Bit for bit: weights are made anew from the bonds of the restart file."""
    box, pair, rest = bodies(2, substeps=substeps)
    whole = run(tmp_path, box + pair + rest + watch(every=60) + "restart 60 mid.*\nrun 120\n",
                ranks, **files(2))
    again = run(tmp_path, box.split("processors")[0] + "read_restart mid.60\n" + rest
                + watch("rest.dump", 60) + "restart 60 other.*\nrun 60\n", ranks)
    a, b = whole.frames()[-1], again.frames("rest.dump")[-1]
    assert a.step == b.step == 120
    assert [c for c in a.columns if not np.array_equal(a[c], b[c])] == []


# ---- against methods that do not lock ------------------------------------------------------------


def stiffness_of(s, x, dim, moves=slice(None)):
    """-d force/d position of the particles that `moves` names, by central differences"""
    chosen, step = np.arange(len(x))[moves], 1e-6 * s.dx

    def force(k, a, sign):
        y = x.copy()
        y[k, a] += sign * step
        s.put("x", y)
        return s.run().get("f")[chosen, :dim].ravel()

    return -np.array([(force(k, a, 1) - force(k, a, -1)) / (2 * step) for k in chosen
                      for a in range(dim)])


@pytest.mark.parametrize("n, nu, error", [([18, 3], 0.49, 1.0), ([24, 4], 0.49, 1.0),
                                          ([30, 5], 0.49, 1.0), ([24, 4], 0.45, 1.0),
                                          ([24, 4], 0.499, 1.0),
                                          ([12, 4, 4], 0.49, 3.0)])
def test_free_body_bends_as_it_should(n, nu, error):
    """Lowest frequency of bending, in per cent; without smoothing the plate 4 across is 17 % too
    fast at 0.49 and 81 % at 0.499. The step that it bears is no shorter than the default's
    twice."""
    dim, young, x = len(n), 1.0e5, lattice(n, DX)
    exact = (PlaneStrain(12, 2, lambda s, t: (6 * s, t), 1.0, nu).frequencies()[0] * 6 if dim == 2
             else brick((3, 1, 1), (7, 4, 4), 1.0, nu)[0] * 3)
    with solid(x, materials=(f"solid rho {RHO} young {young} poisson {nu}",)) as s:
        s.run()
        K, mass = stiffness_of(s, x, dim), s.get("rmass")[0]
    omega = np.sqrt(np.maximum(np.linalg.eigvalsh((K + K.T) / 2) / mass, 0))
    rigid = dim * (dim + 1) // 2
    found = omega[rigid] * n[0] * DX / np.sqrt(young / RHO)
    wave = np.sqrt(young * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / RHO)
    bears = 2 / omega[-1] * wave / (1.5 * DX)
    print(f"free body {n}, nu {nu}: {100 * (found / exact - 1):+.2f} %, bears {bears:.3f} h/c_l")
    assert np.abs(K - K.T).max() < 1e-5 * np.abs(K).max() and omega[rigid - 1] < 0.05 * omega[rigid]
    assert found == pytest.approx(exact, rel=error / 100) and bears > 0.5


@pytest.mark.parametrize("n, nu", [(3, 0.49), (4, 0.49), (4, 0.499)])
def test_cantilever_under_its_weight(n, nu):
    """L = 6 H, tip displacement against finite elements, 3 per cent. Without smoothing they bend
    0.93, 0.69 and 0.23 of it."""
    length, young, g = 6.0, 1.0e5, 1e-3
    dx = 1.0 / n
    x = lattice([6 * n + 6, n], dx, origin=[-6 * dx, 0])
    moves = x[:, 0] > dx    # the clamp acts one spacing behind
    elements = PlaneStrain(18, 2, lambda s, t: (length * s**1.5, t), young, nu)
    exact = elements.solve(-RHO * g * elements.load[1], elements.x[:, 0] == 0)[-1, :, 1].mean()
    with solid(x, dx=dx, materials=(f"solid rho {RHO} young {young} poisson {nu}",),
               held=~moves) as s:
        s.run()
        u = np.linalg.solve(stiffness_of(s, x, 2, moves), np.tile([0, -g], moves.sum())
                            * s.get("rmass")[0]).reshape(-1, n, 2)[:, :, 1].mean(1)
    tip = 1.5 * u[-1] - 0.5 * u[-2]
    print(f"cantilever {n} across, nu {nu}: {tip / exact:.4f} of finite elements")
    assert tip == pytest.approx(exact, rel=0.03)


def test_cook_membrane():
    """Cook's membrane in plane strain, 48 by 44 to 16, mu = 80.194, nu = 0.4999, 100 on the free
    end: 8 rows that follow its edges. The middle of the end goes up by 7.70 (elements.py, 14 by
    14). Without smoothing it is 17 % less."""
    rows, columns, mu, nu, force = 8, 14, 80.194, 0.4999, 1e-3
    young, dx = 2 * mu * (1 + nu), 48 / columns
    elements = PlaneStrain(8, 8, lambda s, t: (48 * s, 44 * s * (1 - t) + (44 + 16 * s) * t), young,
                           nu)
    load = np.zeros((*elements.grid, 2))
    for j in range(8):
        load[-1, 2 * j:2 * j + 3, 1] += 100 / 8 * np.array([1, 4, 1]) / 6
    exact = elements.solve(load.ravel(), elements.x[:, 0] == 0)[-1, :, 1].mean()
    along, across = ((np.arange(-6, columns) + 0.5) * dx).repeat(rows), np.tile(
        (np.arange(rows) + 0.5) / rows, columns + 6)
    s = np.maximum(along, 0) / 48
    height = 44 - 28 * s
    x = np.column_stack([along, 44 * s + height * across, 0 * s])
    moves, end = along > dx, np.arange(len(x)) >= len(x) - rows
    with Scene(x, dim=2, dx=dx, solid_style="fsi/solid/tl",
               materials=(f"solid rho {RHO} young {young!r} poisson {nu}",), held=~moves) as scene:
        scene.put("rmass", RHO * dx * height / rows)
        scene.run()
        f = np.zeros((len(x), 2))    # at the face: half a spacing beyond the last column
        f[end, 1], f[np.roll(end, -rows), 1] = 1.5 * force / rows, -0.5 * force / rows
        u = np.zeros((len(x), 2))
        u[moves] = np.linalg.solve(stiffness_of(scene, x, 2, moves),
                                   f[moves].ravel()).reshape(-1, 2) * 100 / force
    tip = 1.5 * u[end, 1].mean() - 0.5 * u[np.roll(end, -rows), 1].mean()
    print(f"Cook's membrane: {tip:.3f}, finite elements {exact:.3f}")
    assert exact == pytest.approx(7.70, rel=0.01) and tip == pytest.approx(exact, rel=0.03)
