"""Short form of the cylinder on a spring in a stream."""

import numpy as np
from scenes import run_scene

from fsi import series


def test_cylinder_swings_as_newton_says(tmp_path):
    # 6 particles per diameter, a narrow box, 35 D/U: still growing and coarse, so it is not the
    # codes' 0.53 to 0.56 that is asked for, but that it
    # swings, locked to the spring. In the codes' range the frequency is within a fifth of that in
    # vacuo.
    figures = run_scene(tmp_path, "vortex_induced", across=6, width=8, tend=35)
    assert 0.2 < figures["amplitude"] < 0.6
    assert 0.8 < 4.0 * figures["frequency"] < 1.2
    # m y'' + k y = lift, times windows g of a period that end smoothly: m int g'' y + k int g y =
    # int g lift. The series has 50 rows in D/U, equally far apart: 2 %
    s = series.read(tmp_path / "series.csv")
    m, omega = 2 * 1000 * 0.1**2, 2 * np.pi * 3.75
    period, sides = 2 * np.pi / omega, []
    for start in np.arange(1.0, s.time[-1] - period, 0.37 * period):
        x = np.pi * (s.time - start) / period
        inside = (x >= 0) & (x <= np.pi)
        g, curvature = np.sin(x) ** 2 * inside, 2 * (np.pi / period) ** 2 * np.cos(2 * x) * inside
        sides.append((np.sum(m * (curvature + omega**2 * g) * s["place"]), np.sum(g * s["lift"])))
    motion, lift = np.transpose(sides)
    assert np.abs(motion - lift).max() < 0.05 * np.abs(lift).max()
