"""Linear theory of the floating box against identities that it was not made from, and a short form
of the scene."""

import sys

import numpy as np
import pytest
from scenes import run_scene

from fsi import paths, scene

ANALYSIS = scene.analysis("floating_flap")
theory = sys.modules["theory"]
G = theory.GRAVITY
BOX = (0.11, 0.2, 0.06, 0.19)  # half of the width, depth, draft, center of rotation


@pytest.mark.parametrize("period", [0.8, 1.0, 1.4])
@pytest.mark.parametrize("odd", [False, True])
def test_damping_is_what_waves_carry_off(period, odd):
    """Haskind and Newman: B = |F|^2/(2 rho g c_g), of the radiation and the diffraction problem;
    1e-5: the two are solved apart."""
    box = theory.Box(2 * np.pi / period, *BOX)
    kd = box.k * 0.2
    group = box.omega / box.k / 2 * (1 + 2 * kd / np.sinh(2 * kd))
    assert box.omega**2 == pytest.approx(G * box.k * np.tanh(kd), rel=1e-12)
    assert box.added_mass(odd)[1] == pytest.approx(abs(box.exciting(odd))**2 / (2 * G * group),
                                                   rel=1e-5)


def test_long_waves():
    """Heave is lifted by the waves' own pressure, rho g times the width, and follows them; terms of
    the series have converged to 0.3 %."""
    box = theory.Box(0.2, *BOX)
    assert abs(box.exciting(False)) == pytest.approx(G * 0.22, rel=3e-3)
    heave, _ = theory.response(0.2, 0.22, 0.2, 0.06, 1000.0, 13.2, 0.064, 0.19, 0.19)
    assert abs(heave) == pytest.approx(1.0, abs=1e-3)
    coarse, fine = (theory.Box(2 * np.pi, *BOX, terms=n).added_mass(False)[0] for n in (20, 40))
    assert coarse == pytest.approx(fine, rel=3e-3)


def test_amplitude():
    """Of a sine on a straight line."""
    t = np.linspace(0, 9, 1000)
    found = ANALYSIS.amplitude(t, 0.3 + 0.01 * t + 0.02 * np.cos(2 * np.pi * t + 0.5), 1.0)
    assert abs(found) == pytest.approx(0.02, rel=1e-9)


def test_kicked_float(tmp_path):
    """Momentum to round-off. The first swing lasts some 0.7 s: the float, 0.1 m/s at first, is
    still above its place and moves less than without water."""
    figures = run_scene(tmp_path, "floating_flap", height=0, kick=0.1, tend=0.2, balance="yes",
                        frames=2)
    assert figures["momentum_unaccounted"] < 1e-12
    assert 2.0 < figures["heave_largest"] < 20.0
    assert (tmp_path / "snapshots.png").exists() and not list(
        paths.EXAMPLES.glob("floating_flap/particles.dump"))
