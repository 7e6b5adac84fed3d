"""The elasticity of a fluid's lattice: what fix fsi prints is what its forces do, and standing
water rests or not by it."""

import re

import numpy as np
import pytest
from scenes import Scene, lattice

DX, PRESSURE, N = 0.1, 500.0, 30


def printed(capture):
    return [float(x) for x in re.search(r"modulus of (\S+) p when stretched, (\S+) p in shear",
                                        capture).groups()]


@pytest.mark.parametrize("dim, kernel, hdx", [(2, "wendland", 1.5), (2, "cubic", 1.3),
                                              (2, "quintic", 0.94), (3, "wendland", 1.5),
                                              (3, "cubic", 1.3)])
def test_waves_across_a_lattice_under_pressure(tmp_path, dim, kernel, hdx):
    """Transverse waves of a still lattice, N spacings long, in a periodic box: the force that
    brings particles back, p k^2/rho times displacement and modulus; that of stretching counts a
    quarter in a wave along the diagonal."""
    x = lattice((N, N) if dim == 2 else (N, N, 6), DX)
    size = [N * DX, N * DX, 6 * DX if dim == 3 else 0.0]
    k, amplitude = 2 * np.pi / (N * DX), 1e-4 * DX
    measured = []
    for wave, motion in (([k, k, 0], [np.sqrt(0.5), -np.sqrt(0.5), 0]), ([k, 0, 0], [0, 1, 0])):
        u = amplitude * np.cos(x @ wave)[:, None] * np.array(motion)
        log = tmp_path / "log"
        with Scene(x + u, dim=dim, dx=DX, kernel=kernel, hdx=hdx,
                   fluid=f"tension yes background {PRESSURE}", box=((0, 0, 0), size),
                   boundary="p p p", commands=[f"log {log}"]) as s:
            s.run()
            force, mass = s.get("f"), s.get("rmass")[0]
        omega_sq = -(force * u).sum() / (mass * (u * u).sum())
        measured.append(1000 * omega_sq / (PRESSURE * np.dot(wave, wave)))
    stretch, shear = printed(log.read_text())
    # waves of N spacings differ from infinitely long ones by some (2 pi/N)^2 = 4 %, and three
    # digits are printed
    assert abs(4 * measured[0] - stretch) < 0.04 * abs(stretch) + 1e-3
    assert abs(measured[1] - shear) < 0.04 * abs(shear) + 1e-3
