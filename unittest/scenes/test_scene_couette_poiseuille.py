"""Short form of the flow between plates."""

import pytest
from scenes import run_scene


@pytest.mark.parametrize("wall", ["mirror", "particle", "solid"])
def test_poiseuille_converges_with_second_order(tmp_path, wall):
    # 10 and 20 particles: 1.23 to 1.34 and 0.27 to 0.33 %; by 4, and a tenth more or less for what
    # is of higher order at 10
    coarse, fine = (run_scene(tmp_path / str(n), "couette_poiseuille", flow="poiseuille", wall=wall,
                              n=n, tend=0.45)["error_end"] for n in (10, 20))
    assert fine < 0.004
    assert 3.5 < coarse / fine < 4.7


@pytest.mark.parametrize("wall", ["mirror", "particle", "solid"])
def test_couette(tmp_path, wall):
    # the target of 1 % is met with 10 particles
    figures = run_scene(tmp_path, "couette_poiseuille", wall=wall, n=10, tend=0.45)
    assert figures["error_start"] < 0.01
