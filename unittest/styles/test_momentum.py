"""Momentum of an isolated cloud of fluid and solid."""

import numpy as np
import pytest
from scenes import RUBBER, WATER, Scene, cloud


def build(dim, couple, more="", viscosity=0):
    dx = 0.1
    x, v = cloud([10, 10] if dim == 2 else [6, 6, 6], dx, jitter=0.1, vmax=0.5)
    v[:, 0] += 0.3
    solid = x[:, 0] > x[:, 0].mean()
    return Scene(x, v, dim=dim, dx=dx, hdx=1.3, dt=5e-4, type=1 + solid, mol=1 + solid,
                 materials=(f"{WATER} viscosity {viscosity}", RUBBER),
                 box=((-20,) * 3, (20,) * 3),
                 fluid=f"sound 10 couple {couple} artificial/visc 0.1 0.1 density/diffusion 0.1 "
                 f"{more}",
                 solid="artificial/visc 0.2 0 artificial/stress 0.3 gradient "
                 + ("corrected" if couple == "wall" else "plain"))


def angular(s):
    x = s.get("x")
    return (s.get("rmass")[:, None] * np.cross(x - x.mean(0), s.get("v"))).sum(0)


@pytest.mark.parametrize("couple", ["wall", "full"])
@pytest.mark.parametrize("dim", [2, 3])
def test_kept(dim, couple):
    with build(dim, couple) as s:
        s.run()
        m, v = s.get("rmass")[:, None], s.get("v")
        scale, spin_scale = np.abs(m * v).sum(), (
            m[:, 0] * np.linalg.norm(np.cross(s.get("x") - s.get("x").mean(0), v),
                                                                            axis=1)).sum()
        p0, l0, v0 = s.momentum(), angular(s), s.get("v")
        s.run(1000)
        drift = np.abs(s.momentum() - p0).max() / scale
        spin = np.abs(angular(s) - l0).max() / spin_scale
        print(f"momentum, {dim}D couple {couple}: linear drift {drift:.1e}, angular drift "
              f"{spin:.1e} in 1000 steps")
        assert np.abs(s.get("v") - v0).max() > 0.1            # things did happen
        # round-off: 1e-16 per step and particle, of both signs; measured 1e-16 to 3e-16
        assert drift < 1e-14
        # forces along the line between particles keep it; the shear stress of the solid is not of
        # that kind: measured 0.002 and 0.003 with corrected gradients, which see a rotation as one,
        # 0.02 and 0.04 with plain ones. It is 0.04 in all
        assert spin < (0.005 if couple == "wall" else 0.05)


@pytest.mark.parametrize("dim", [2, 3])
def test_laminar_and_extrapolation_too(dim):
    with build(dim, "wall", "laminar/visc extrapolate yes", viscosity=20) as s:
        s.run()
        scale, p0 = np.abs(s.get("rmass")[:, None] * s.get("v")).sum(), s.momentum()
        s.run(300)
        assert np.abs(s.momentum() - p0).max() < 1e-14 * scale


@pytest.mark.parametrize("form, kept", [("laminar/visc/central", True), ("laminar/visc", False)])
@pytest.mark.parametrize("dim", [2, 3])
def test_angular_momentum_of_a_viscous_fluid(dim, form, kept):
    """Of the two forms of laminar viscosity only the central one keeps it."""
    x, v = cloud([10, 10] if dim == 2 else [6, 6, 6], 0.1, jitter=0.1, vmax=0.5)
    with Scene(x, v, dim=dim, dx=0.1, hdx=1.3, dt=5e-4, box=((-20,) * 3, (20,) * 3),
               materials=("fluid rho 1000 viscosity 20",),
               fluid=f"sound 10 tension yes {form}") as s:
        s.run()
        scale = (s.get("rmass") * np.linalg.norm(np.cross(s.get("x"), s.get("v")), axis=1)).sum()
        start = angular(s)
        s.run(300)
        drift = np.abs(angular(s) - start).max() / scale
    print(f"angular momentum, {dim}D {form}: drift {drift:.1e} in 300 steps")
    assert drift < 1e-13 if kept else drift > 1e-4
