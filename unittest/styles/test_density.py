"""Density modes against sums written a second time in numpy."""

import numpy as np
import pytest
from decks import deck
from scenes import (KERNELS, RUBBER, WATER, Kernel, Scene, close, cloud, dam_gate, differing,
                    lattice, pairs, run, sum_over, watch)

ROUND_OFF = 1e-12    # sums of about 20 to 120 terms of one sign
BOTH = pytest.mark.parametrize("n", [(9, 9), (6, 6, 6)], ids=["2D", "3D"])


def psi_of(x, kernel, with_whom=None):
    """number density; with_whom(i, j): which pairs count"""
    i, j, _, r = pairs(x, kernel.cut)
    w = kernel.W(r)
    if with_whom is not None:
        w = w * with_whom(i, j)
    return kernel.W(0.0) + sum_over(i, w, len(x))


def species(n, x):
    """fluid on the left, two solid bodies on the right: (types, molecules)"""
    solid = x[:, 0] > x[:, 0].mean()
    return np.where(solid, 2, 1), np.where(solid, np.where(x[:, 1] > x[:, 1].mean(), 3, 2), 1)


@BOTH
@pytest.mark.parametrize("kernel", KERNELS)
def test_summation(n, kernel):
    x, _ = cloud(n, 0.1)
    with Scene(x, dim=len(n), dx=0.1, kernel=kernel, hdx=1.2, density="fluid summation",
               fluid="tension yes") as s:
        rho = s.run().get("rho")
        close(rho, s.get("rmass") * psi_of(x, s.kernel), ROUND_OFF)
        close(s.p, 100.0 * (rho - 1000.0), ROUND_OFF)


@BOTH
def test_psi_of_a_run(n):
    """Of where particles are at the end of a step, half a step on from where sums of density are:
    4 % here."""
    x, v = cloud(n, 0.1, vmax=3.0)
    with Scene(x, v, dim=len(n), dx=0.1, dt=2e-3, commands=["compute psi all fsi/atom psi"]) as s:
        psi = s.run(3).compute("psi", columns=False)
        close(psi, psi_of(s.get("x"), s.kernel), ROUND_OFF)
        assert np.abs(psi / psi_of(s.get("x") - 1e-3 * s.get("v"), s.kernel) - 1).max() > 0.02


@BOTH
def test_whose_neighbors_count(n):
    """Fluids sum over all neighbors; solids over their own body, or over all in mode summation."""
    x, _ = cloud(n, 0.1, seed=2)
    type_, mol = species(n, x)
    fluid = type_ == 1
    for mode in ("summation", "ratio", "continuity"):
        with Scene(x, dim=len(n), dx=0.1, hdx=1.3, type=type_, mol=mol, materials=(WATER, RUBBER),
                   fluid="tension yes",
                   density=f"fluid summation solid {mode}",
                   commands=["compute psi all fsi/atom psi"]) as s:
            s.run()
            own = lambda i, j: fluid[i] | (mol[i] == mol[j])
            expected = psi_of(x, s.kernel, None if mode == "summation" else own)
            close(s.compute("psi", columns=False), expected, ROUND_OFF)
            rho = s.get("rho")
            close(rho[fluid], (s.get("rmass") * expected)[fluid], ROUND_OFF)
            solid_rho = (s.get("rmass") * expected)[~fluid] if mode == "summation" else np.full(
                (~fluid).sum(), 1000.0)
            close(rho[~fluid], solid_rho, ROUND_OFF)


@BOTH
def test_ratio(n):
    """rho = rho_start psi/psi_start of a solid, whatever psi_start is."""
    x, _ = cloud(n, 0.1, seed=3)
    x2, _ = cloud(n, 0.1, seed=4)
    type_, mol = species(n, x)
    start = np.random.default_rng(5).uniform(900, 1100, len(x))
    with Scene(x, dim=len(n), dx=0.1, type=type_, mol=mol, materials=(WATER, RUBBER),
               density="fluid continuity solid ratio") as s:
        s.put("rho", start)
        s.run_lines("run 0 post no")
        close(s.get("rho"), start, 1e-15)
        s.put("x", x2)
        own = lambda i, j: (type_[i] == 1) | (mol[i] == mol[j])
        expected = start * np.where(type_ == 1, 1.0, psi_of(x2, s.kernel, own)
                                    / psi_of(x, s.kernel, own))
        close(s.run().get("rho"), expected, ROUND_OFF)


@BOTH
@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("delta", [0.0, 0.1])
def test_continuity_rate(n, kernel, delta):
    """One step: rho += dt m_i sum_j v_ij.g_ij, over fluid and solid neighbors, plus diffusion
    within a fluid."""
    x, v = cloud(n, 0.1, seed=6, vmax=1.0)
    dim, dt, h = len(n), 2e-3, 0.12
    type_, mol = species(n, x)
    rho = np.random.default_rng(7).uniform(990, 1010, len(x))
    fluid = f"tension yes density/diffusion {delta}" if delta else "tension yes"
    with Scene(x, v, dim=dim, dx=0.1, kernel=kernel, hdx=1.2, type=type_, mol=mol,
               materials=(WATER, RUBBER), dt=dt,
               fluid=fluid, commands=["fix g all gravity 9.81 vector 1 2 0"]) as s:
        s.run()
        s.put("rho", rho)
        m, g = s.get("rmass"), 9.81 * np.array([1, 2, 0]) / np.sqrt(5)
        i, j, d, r = pairs(x, s.kernel.cut)
        grad = s.kernel.g(r)
        rate = sum_over(i, m[i] * grad * ((v[i] - v[j]) * d).sum(1), len(x))
        # 2 delta h c sum_j V_j (rho_j - rho_i + rho0 g.x_ij/c^2) x_ji.grad W/r^2, x_ji.grad W/r^2 =
        # -g
        same = (type_[i] == 1) & (type_[j] == 1)
        rate += sum_over(i, same * 2 * delta * h * 10 * (m / rho)[j]
                         * (rho[j] - rho[i] + 1000 / 100 * d @ g) * -grad,
                         len(x))
        got = (s.run(1).get("rho") - rho) / dt
    # rho of size 1000 changes by 10: its last bit, 1e-13, is 1e-14 of the change; positions of time
    # n are recovered from those of n+1/2 to 1e-17
    close(got[type_ == 1], rate[type_ == 1], 1e-12)


@BOTH
def test_diffusion_needs_pressure_on_both_sides(n):
    """Without tension, where density is at most that of rest there is no pressure: spray takes
    nothing from what it leaves."""
    x, _ = cloud(n, 0.1, seed=8)
    rho = np.random.default_rng(9).uniform(980, 1020, len(x))
    rho[::3] = np.linspace(500, 900, len(rho[::3]))
    with Scene(x, dim=len(n), dx=0.1, hdx=1.2, dt=2e-3, fluid="density/diffusion 0.1") as s:
        s.run()
        s.put("rho", rho)
        m = s.get("rmass")
        i, j, _, r = pairs(x, s.kernel.cut)
        wet = rho > 1000
        rate = sum_over(i, wet[i] * wet[j] * 2 * 0.1 * 0.12 * 10 * (m / rho)[j] * (rho[j] - rho[i])
                        * -s.kernel.g(r), len(x))
        got = (s.run(1).get("rho") - rho) / 2e-3
    assert np.abs(rate).max() > 100 and np.all(got[~wet] == 0)
    # particles at rest at the start of the step: what pressure moves them in it does not count yet
    close(got, rate, 1e-12)


def test_diffusion_without_pressure_is_none(tmp_path):
    """Water that begins without pressure beside a plate: the last bit of its density decides
    nothing, so a factor on all densities and moduli changes no motion."""
    v = []
    for factor in (1.0, 0.1, 10.0):
        named = {"water": f"fluid rho {1000 * factor!r}",
                 "rubber": f"solid rho {1100 * factor!r} young {1e5 * factor!r} poisson 0.3"}
        text = deck("-0.05 0.45 -0.05 0.45", 0.01, named,
                    "fix walls water fsi/wall/mirror xlo 0 xhi 0.4 ylo 0",
                    "fix g all gravity 9.81 vector 0 -1 0",
                    made="region low block INF INF INF 0.03 INF INF units box\ngroup low region "
                    "low\ngroup root intersect low plate\ngroup moves subtract all root",
                    group="moves", fluid="sound 20 density/diffusion 0.1",
                    solid="artificial/visc 0.1 0 contact 2", dt=1e-4, skin=0.4,
                    water="0 0.15 0 0.15", plate="0.15 0.19 0 0.12")
        frame = run(tmp_path / str(factor), text + watch(every=20) + "run 20\n").frames()[-1]
        v.append(np.stack([frame["vx"], frame["vy"]]))
    for other in v[1:]:
        assert np.abs(other - v[0]).max() < 1e-9 * np.abs(v[0]).max()


@BOTH
def test_nobody_is_thinner_than_alone(n):
    """Two that fly apart, one too thin for where it was: its density ends at m W(0)."""
    x = np.array([[0, 0, 0], [0.08, 0, 0]], float)
    with Scene(x, [[-1, 0, 0], [1, 0, 0]], dim=len(n), dx=0.1, hdx=1.5, dt=2e-3) as s:
        s.run()
        alone = s.get("rmass") * s.kernel.W(0.0)
        s.put("rho", alone * np.array([1.02, 3.0]))
        rho = s.run(150).get("rho")
    close(rho[0], alone[0], 1e-14)
    assert rho[1] > 1.5 * alone[1]


def planes(kernel, dim, dx):
    """(s, room) of the layers of a lattice below a plane surface, from the inside: what the planes
    of neighbors that are missing add up to."""
    reach = range(-6, 7)
    rows = [(0.0, 0.0)]
    for z in range(6, 0, -1):
        r = dx * np.sqrt([float(x * x + y * y + z * z) for x in reach
                          for y in (reach if dim == 3 else [0])])
        r = r[r < kernel.cut]
        if r.size:
            rows.append((rows[-1][0] - kernel.h * (kernel.g(r) * z * dx).sum(),
                         rows[-1][1] + kernel.W(r).sum()))
    return np.array(rows).T / kernel.lattice_sum(dx, dim)


@BOTH
def test_density_follows_surfaces(n):
    """Two blocks that meet lose the room that neighbors missed between them, and have it again when
    they part; nothing happens at rest, nor between the steps that look: one in the time 5 h/c."""
    dim, dx = len(n), 0.1
    # of what is at rest, without pressure: as long a step as one likes
    look = 5.001 * 1.5 * dx / 10
    x = lattice(n, dx)
    apart, met = (np.vstack([x, x + [n[0] * dx + gap, 0, 0]]) for gap in (0.5, 0.02))
    with Scene(apart, dim=dim, dx=dx, hdx=1.5, kernel="wendland", dt=1e-7,
               fluid="density/surface yes") as s:
        bulk, m = s.kernel.lattice_sum(dx, dim), None
        layers = planes(s.kernel, dim, dx)

        def seen(x):
            i, j, d, r = pairs(x, s.kernel.cut)
            psi = s.kernel.W(0.0) + sum_over(i, s.kernel.W(r), len(x))
            gradient = np.column_stack([sum_over(i, s.kernel.g(r) * d[:, a], len(x))
                                        for a in range(3)])
            size = s.kernel.h * np.linalg.norm(gradient, axis=1) / bulk
            # as between the last two layers
            beyond = (layers[1, -1] - layers[1, -2]) / (layers[0, -1] - layers[0, -2])
            return 1 - psi / bulk, np.interp(size,
                                             *layers) + beyond * np.maximum(0, size - layers[0, -1])

        s.run()
        m = s.get("rmass")
        room, plane = seen(apart)
        edge = np.where(plane > 0, np.maximum(1, room / np.where(plane > 0, plane, 1)), 1)
        assert np.abs(s.run(1, look).get("rho") - 1000).max() < 1e-9    # at rest
        s.put("x", met)
        assert np.abs(s.run(9, 0.1 * look).get("rho") - 1000).max() < 1e-9
        left = np.minimum(room, edge * seen(met)[1])
        expected = np.maximum(1000 * (1 + left - room), m * s.kernel.W(0.0))
        assert expected.min() < 800 and np.sum(expected > 999.9) > len(x) / 4
        close(s.run(1, 0.2 * look).get("rho"), expected, 1e-9)
        s.put("x", apart)
        close(s.run(1, look).get("rho"), np.full(len(apart), 1000.0), 1e-9)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("kernel", KERNELS)
def test_lattice_is_stress_free(dim, kernel):
    """Masses make the lattice stress-free in every mode: m psi_bulk = rho0, p = 0, f = 0."""
    n, dx = [6] * dim, 0.1
    x = lattice(n, dx)
    for species, material in (("fluid", WATER), ("solid", RUBBER)):
        for mode in ("summation", "continuity") if species == "fluid" else ("summation", "ratio",
                                                                            "continuity"):
            with Scene(x, dim=dim, dx=dx, kernel=kernel, hdx=1.2, materials=(material,),
                       boundary="p p p", skin=0.1,
                       box=((0, 0, 0), (0.6, 0.6, 0.6)), fluid="tension yes",
                       density=f"{species} {mode}") as s:
                s.run()
                close(s.get("rmass"), 1000.0 / Kernel(kernel, dim, 0.12).lattice_sum(dx, dim),
                      1e-13)
                # scale: K = rho0 c^2 >= 1e5 (also about that of the rubber), force K dx^(d-1)
                assert np.abs(s.p).max() < 1e-12 * 1e5
                assert np.abs(s.get("f")).max() < 1e-12 * 1e5 * dx**(dim - 1)
                s.run(20)
                assert np.abs(s.get("x") - x).max() < 1e-12 * dx


@pytest.mark.parametrize("eos", ["linear", "tait"])
def test_fsi_set(eos):
    x = lattice((6, 10), 0.1)
    with Scene(x, fluid=f"sound 20 eos {eos} tension yes", dx=0.1,
               commands=["fix g all gravity 9.81 vector 0 -1 0"]) as s:
        s.run()
        m = s.get("rmass")
        s.run_lines("fsi/set all hydrostatic 0.8")
        depth = np.maximum(0.8 - x[:, 1], 0)
        # p from rho - rho0: 7 of 16 digits are lost where p is small
        close(s.run().p, 1000 * 9.81 * depth, 1e-10)
        rho = s.get("rho")
        ratio = 9.81 * depth / 400
        close(rho, 1000 * ((1 + ratio) if eos == "linear" else (1 + 7 * ratio)**(1 / 7)), 1e-13)
        close(s.get("rmass") / rho, m / 1000, 1e-14)     # the volume stays that of the lattice
        s.run_lines("group part id 1:5", "fsi/set part density 1234")
        assert np.all(s.get("rho")[:5] == 1234) and np.all(s.get("rho")[5:] == rho[5:])


@pytest.mark.parametrize("eos", ("linear", "tait"))
def test_fsi_set_pressure(eos):
    """A pressure that varies, by an atom-style variable; and one number for all."""
    x = lattice((6, 10), 0.1)
    with Scene(x, fluid=f"sound 20 eos {eos} tension yes background 50", dx=0.1) as s:
        s.run_lines("variable p atom 1000*x-200*y", "fsi/set all pressure v_p")
        want = 1000 * x[:, 0] - 200 * x[:, 1]
        # p from rho - rho0: 7 of 16 digits are lost
        assert np.abs(s.run().p - want).max() < 1e-8
        s.run_lines("variable r atom 1000+x", "fsi/set all density v_r")
        close(s.run().get("rho"), 1000 + x[:, 0], 1e-14)
        s.run_lines("fsi/set all pressure 70")
        assert np.abs(s.run().p - 70).max() < 1e-8


@pytest.mark.parametrize("later", [False, True])
@pytest.mark.parametrize("command", ["set group moving mass 30", "set group moving density 1000",
                                     "set group held mass 5", "set group held type 3"])
def test_masses_of_no_material(command, later):
    """The mass of a cell, 10, times three; a density that LAMMPS takes for a mass; the type of
    another wall. Fsi/set volume gives what it says."""
    x = lattice((4, 8), 0.1)
    wall = x[:, 1] < 0.4
    with Scene(x, fluid="sound 20", dx=0.1, materials=(WATER, "wall rho 1000", "wall rho 3000"),
               type=1 + wall, held=wall, commands=["fix w held fsi/wall/particle"]) as s:
        s.run(int(later))
        s.run_lines(command)
        with pytest.raises(Exception, match=r"Atom \d+ of type \d has the mass \S+, a volume of"):
            s.run()
        s.run_lines("fsi/set all volume 0.03")
        s.run().run(1)
        close(s.get("rmass"), np.where(wall & ("type" in command), 90, 30), 1e-12)


@pytest.mark.parametrize("dim", [2, 3])
def test_article_is_its_settings(tmp_path, dim):
    """Scheme article is the six settings that its page lists, bit for bit; what a style says itself
    is kept."""
    def end(name, density, fluid="", solid=""):
        scene = dam_gate(dim, kernel="cubic 1.3", density=density,
                         fluid=f"sound 10 tension yes artificial/visc 0.1 0 {fluid}",
                         solid=f"artificial/visc 0.1 0 {solid}", sph="mach off")
        return run(tmp_path / name, scene.text() + watch(every=40) + "run 40\n",
                   scene_data=scene.data()).frames()[-1]
    word = end("word", "scheme article")
    assert differing(word, end("settings", "fluid summation solid ratio", "surface 0.9 couple full",
                               "artificial/stress 0.3 gradient plain")) == []
    for k, other in enumerate((("", "artificial/stress 0.1"), ("surface 0.99",))):
        assert "vx" in differing(word, end(f"other{k}", "scheme article", *other))
