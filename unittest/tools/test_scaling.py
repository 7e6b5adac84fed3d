"""The model of many ranks, and what tools/cost effects, peers, scaling and solids refuse."""

import re
import sys

import numpy as np
import pytest

from fsi import paths, scene
from fsi.command import Refusal

sys.path.insert(0, str(paths.ROOT / "bench"))
import effects  # noqa: E402
import peers  # noqa: E402
import scaling  # noqa: E402
import solid_variants  # noqa: E402

M = {"tau": 1e-6, "bytes": 98.0, "exchanges": 4, "w": 3.0}
FREE = {"latency": 0.0, "bandwidth": np.inf, "ghost": 0.0, "imbalance": 0.0}


def test_ghosts_are_the_shell_around_a_cube():
    axis = np.arange(-3, 13)
    x = np.stack(np.meshgrid(axis, axis, axis), -1).reshape(-1, 3)
    inside = ((x >= 0) & (x < 10)).all(1)
    assert scaling.ghosts(inside.sum(), 3.0) == pytest.approx((~inside).sum())


@pytest.mark.parametrize("ranks", [2, 100, 10000])
def test_a_network_that_costs_nothing(ranks):
    assert scaling.step(1e8, ranks, M, FREE) * ranks == pytest.approx(scaling.step(1e8, 1, M))


@pytest.mark.parametrize("name, value, seconds", [
    ("latency", 1e-6, 1e-6 * (4 * 6 + np.log2(1000))),  # four exchanges with six swaps, one collective call
    ("bandwidth", 1e9, ((100 + 6)**3 - 1e6) * 98 / 1e9), ("ghost", 0.1, 0.1 * ((100 + 6)**3 - 1e6) * 1e-6), ("imbalance", 0.05, 0.05 * 1e6 * 1e-6)])
def test_each_term(name, value, seconds):
    """A million particles on each of 1000 ranks."""
    more = scaling.step(1e9, 1000, M, FREE | {name: value}) - scaling.step(1e9, 1000, M, FREE)
    assert more == pytest.approx(seconds, rel=1e-9)


def test_small_cubes_ask_further_ranks():
    """Two particles along an edge, three spacings of ghosts: two ranks each way, so twice the swaps."""
    small = {**FREE, "latency": 1.0, "collectives": 0}
    assert scaling.step(8 * 1000, 1000, M, small) == pytest.approx(2 * 6 * 4, rel=1e-4)


@pytest.mark.parametrize("word", ["nonsense", "turns=0", "out="])
@pytest.mark.parametrize("program", [effects, peers, scaling, solid_variants])
def test_nonsense_is_refused(program, word, monkeypatch):
    monkeypatch.setattr(scene, "build", lambda: pytest.fail("built"))
    with pytest.raises(Refusal, match=word):
        program.main([word])


@pytest.mark.parametrize("key", [key for key in peers.SPEEDS])
def test_peers_and_package_build_as_many_lists(key):
    """One at the start of a run and then every tenth step: that of the start is the package's alone if the run ends between two."""
    _, both, *sides, _ = peers.SPEEDS[key]
    for name, own in sides:
        every = re.search(r"^neigh_modify +every (\d+) ", peers.deck(name, {**both, **own}), re.M)
        assert both["steps"] % int(every[1]) == 0


def test_pages_hold_their_rows():
    row = {"what": "a style", "ours": 2e6, "peer": 1e6, "ratio": 2.0, "spread": 0.1, "neighbours_ours": 12.0, "neighbours_peer": 13.0}
    text = peers.page([{**row, "target": ">= 3", "met": False}])
    assert "| a style | 2.00 M | 1.00 M | 2 ± 0.1 | 12.0, 13.0 | at least 3 | **missed** |" in text and "{" not in text
    row = {"effect": "shifting", "time": 0.5, "spread": 0.01, "instructions": 0.25, "memory": 40, "messages": 0, "bytes": 8.0, "collectives": 0}
    text = effects.page({"fluid": ([row], {"messages": 4, "bytes": 90.0, "collectives": 0.1})})
    assert "| shifting | +50.0% ± 1.0% | +25.00% | +40 | +0 | +8.0 | +0 |" in text and "{" not in text


def test_the_gates_deck_can_do_without_each_part():
    whole = effects.gate(400, 0)
    for part in ("viscosity", "diffusion", "walls", "rubber viscosity"):
        assert len(effects.gate(400, 0, without=(part,))) < len(whole)
    assert " substeps 8\n" in whole and " substeps 1\n" in effects.gate(400, 0, without=("substeps",))
