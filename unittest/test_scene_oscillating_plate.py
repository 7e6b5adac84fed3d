"""Short forms of the oscillating plate, judged against finite elements and the mode's own kinematics."""

import json

import pytest

from fsi import scene

PERIOD = 0.2553  # [s] 2D finite elements, plane strain, root face held
TIP_SPEED = 0.01 * 57.009  # [m/s] 0.01 sqrt(K/rho)


def run(tmp_path, **variables):
    """Runs the scene as tools/run does (without building) and returns {figure name: value}."""
    assert scene.run("oscillating_plate", tmp_path, 1, {k: str(v) for k, v in variables.items()}) == 0
    return {f["name"]: f["value"] for f in json.loads((tmp_path / "summary.json").read_text())["figures"]}


@pytest.fixture(scope="module")
def plates(tmp_path_factory):
    """Two swings with 4 and 8 particles across."""
    return {n: run(tmp_path_factory.mktemp(f"plate{n}"), n=n, periods=2.75, ledger="yes") for n in (4, 8)}


def test_period_converges_to_finite_elements(plates):
    # The error is of first order in the spacing: gradients read the bending strain at a free face about 0.6 dx inside the
    # body, which takes 3 * 2 * 0.6/n of the stiffness and half of that in the period, and the clamp is dx/2 behind the first
    # free face, which adds dx/L. Together (1.8 + 0.1)/n at most; softer than that, or stiffer than finite elements, is wrong.
    error = {n: figures["period"] / PERIOD - 1.0 for n, figures in plates.items()}
    for n in error:
        assert 0.0 < error[n] < 1.9 / n
    assert error[8] < 0.7 * error[4]


def test_amplitude_follows_from_the_initial_velocity(plates):
    # a mode's amplitude is its speed at the start over its angular frequency, whatever its stiffness; the start is the thin
    # plate's first mode, of which others take 1 % (finite elements: 22.96 mm, 0.4 % under this product)
    for figures in plates.values():
        assert 1e-3 * figures["amplitude"] == pytest.approx(TIP_SPEED * figures["period"] / 6.28319, rel=0.03)


def test_clamp_is_at_the_last_held_layer(plates):
    # displacements are zero at the centres of the last held particles, half a spacing behind the face
    for figures in plates.values():
        assert -1.0 < figures["clamp_place"] < 0.0


def test_swing_is_not_damped(plates):
    # nothing but artificial viscosity may take energy; 5 % over two swings is the bound
    for figures in plates.values():
        assert figures["mechanical_energy"] == pytest.approx(1.0, abs=0.05)
        assert figures["fractured_at"] is None and figures["stopped_at"] is None


def test_run_without_viscosity_ends_early_and_says_so(tmp_path):
    # the paper: "unstable for alpha = 0"
    figures = run(tmp_path, n=5, mode="paper", alpha=0, periods=2.0)
    assert figures["stopped_at"] is not None
