"""Short form of the flow between plates."""

import pytest
from scenes import run_scene


@pytest.mark.parametrize("wall", ["mirror", "particle", "solid"])
def test_poiseuille_converges_with_second_order(tmp_path, wall):
    # 10 and 20 particles: 0.45 % is the viscosity of the lattice (README), what falls beyond does so by 4, to a tenth: 1.3 and 0.33 %
    coarse, fine = (run_scene(tmp_path / str(n), "couette_poiseuille", flow="poiseuille", wall=wall, n=n, tend=0.45)["error_end"] for n in (10, 20))
    assert fine < 0.009
    assert 3.4 < (coarse - 0.0045) / (fine - 0.0045) < 4.6


@pytest.mark.parametrize("wall", ["mirror", "particle", "solid"])
def test_couette(tmp_path, wall):
    # the target of 1 % is met with 10 particles
    figures = run_scene(tmp_path, "couette_poiseuille", wall=wall, n=10, tend=0.45)
    assert figures["error_start"] < 0.01
