"""Processors without AVX2: they go pair by pair, and never into a function that is compiled for
it."""

import re
import sys

import numpy as np
import pytest
from scenes import RUBBER, WATER, Scene, cloud

from fsi import paths

sys.path.insert(0, str(paths.ROOT / "bench"))
import effects  # noqa: E402
import measure  # noqa: E402

COMPILED_FOR_AVX2 = {name for file in paths.sources().values()
                     for name in re.findall(r"\bFSI_TARGET\s+(?:static\s+|inline\s+)?\w+\s+(\w+)\(",
                                            file.read_text())}
DECKS = {"water": {"style": "artificial/visc 0.05 0 laminar/visc density/diffusion 0.1",
                   "walls": "yes"},
         "number density": {"sph": "fluid summation"}, "bare": {},
         "watched": {"commands": "fix watch all fsi/watch 1"}}


def entered():
    """The functions compiled for AVX2 that some scenes run through, with what is left of their
    names."""
    found = set()
    for _, counts in measure.profiles([effects.write_materials(effects.fluid(12, 8, **deck))
                                       for deck in DECKS.values()]):
        found |= {name for name in COMPILED_FOR_AVX2 for function in counts
                  if re.search(rf"\b{name}\b", function)}
    return found


@pytest.mark.slow
def test_without_avx2_nothing_compiled_for_it_is_entered(monkeypatch):
    """FSI_PACKS=no is what a processor without it says; there one instruction of such a function
    ends the run, in a loop over nothing, too."""
    assert COMPILED_FOR_AVX2
    assert entered() == COMPILED_FOR_AVX2  # they would be seen
    monkeypatch.setenv("FSI_PACKS", "no")
    assert not entered()


def runs_both_ways(monkeypatch, run):
    """What run() gives with packs and pair by pair: not the same to the last bit, so two ways they
    are."""
    found = []
    for packs in ("yes", "no"):
        monkeypatch.setenv("FSI_PACKS", packs)
        found.append(run())
    assert np.any(found[0] != found[1])
    return found


@pytest.mark.parametrize("n", [(12, 10), (6, 5, 5)])
def test_both_ways_agree(monkeypatch, n):
    """Sums of some 30 pairs in another order, over 20 steps of a cloud in which round-off does not
    grow yet."""
    x, v = cloud(n, 0.1, seed=4, vmax=1.0)
    kind = np.where(x[:, 0] > 0.9 * x[:, 0].max(), 2, 1)

    def run():
        with Scene(x, v, dim=len(n), dx=0.1, type=kind, materials=(WATER, RUBBER),
                   fluid="artificial/visc 0.1 0.1 density/diffusion 0.1", dt=1e-4,
                   solid_style="fsi/solid/tl",
                   commands=["fix w all fsi/wall/mirror ylo -0.1",
                             "fix g all gravity 9.81 vector 0 -1 0"]) as s:
            s.run(20)
            return np.hstack([s.get("x"), s.get("v"), s.get("rho")[:, None] / 1000.0])

    np.testing.assert_allclose(*runs_both_ways(monkeypatch, run), rtol=0, atol=1e-11)


@pytest.mark.parametrize("n", [(13, 9), (6, 5, 5)])
@pytest.mark.parametrize("kernel", ["cubic", "quintic", "wendland"])
@pytest.mark.parametrize("solid", ["gradient plain", "gradient plain artificial/visc 0.1 0.1",
                                   "gradient plain artificial/stress 0.3",
                                   "gradient corrected hourglass 0.5", "gradient corrected "
                                   "artificial/visc 0.1 0.1 artificial/stress 0.3",
                                   "gradient quadratic hourglass 0.5 artificial/visc 0.1 0.1"])
def test_both_ways_agree_for_updated_lagrangian_solids(monkeypatch, n, kernel, solid):
    """Two bodies that touch: sums of some 30 pairs in another order, over 20 steps."""
    x, v = cloud(n, 0.1, seed=4, vmax=1.0)
    body = np.where(x[:, 0] > 0.5 * x[:, 0].max(), 2, 1)

    def run():
        with Scene(x, v, dim=len(n), dx=0.1, hdx=1.2, kernel=kernel, mol=body, materials=(RUBBER,),
                   solid=solid, dt=1e-4) as s:
            s.run(20)
            return np.hstack([s.get("x"), s.get("v"), s.get("rho")[:, None] / 1000.0])

    np.testing.assert_allclose(*runs_both_ways(monkeypatch, run), rtol=0, atol=1e-11)
