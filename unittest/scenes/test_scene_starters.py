"""The starters run as bundled: within their targets, with the pictures that the deck and the
analysis make, and no advice to give."""

import json

import pytest

from fsi import log, scene


@pytest.mark.parametrize("name, figures",
                         [("droplet", {"fall_error", "energy_error"}), ("column", {"energy_error"}),
                          ("beam", {"frequency", "energy_error"})])
def test_starter(tmp_path, name, figures):
    # free fall is exact for the integrator; a slender beam is 0.5 % stiffer than finite elements
    # say, four particles across 1 % softer; energy: what the README says. Twice the gravity in the
    # analysis, or a beam clamped at another particle, fails.
    assert scene.run(name, tmp_path, 1, {}) == 0
    found = {f["name"]: f["met"]
             for f in json.loads((tmp_path / "summary.json").read_text())["figures"]}
    assert all(found[figure] for figure in figures)
    assert not log.read(tmp_path / "log.lammps").warnings
    assert list(tmp_path.glob("*0.png")) and (tmp_path / "snapshots.png").exists()


def test_grains(tmp_path):
    """The bed is pushed 7.65 mm in this time: without pair_style fsi/grain it slumps by 4 mm to the
    other side. One and two ranks agree to 15 digits; a tenth is for other processors."""
    assert scene.run("grains", tmp_path, 1, {"tend": "0.15"}) == 0
    found = {f["name"]: f["value"]
             for f in json.loads((tmp_path / "summary.json").read_text())["figures"]}
    assert found["particles_lost"] == 0
    assert found["bed_moved"] == pytest.approx(7.65e-3, rel=0.1)
