"""Pages of tools/cost effects, peers and scaling, and what these and solids refuse."""

import re
import sys

import pytest

from fsi import paths, scene
from fsi.command import Refusal

sys.path.insert(0, str(paths.ROOT / "bench"))
import effects  # noqa: E402
import largest  # noqa: E402
import peers  # noqa: E402
import ranks  # noqa: E402
import scaling  # noqa: E402
import solid_variants  # noqa: E402

@pytest.mark.parametrize("word", ["nonsense", "turns=0", "out="])
@pytest.mark.parametrize("program", [effects, peers, ranks, scaling, solid_variants])
def test_nonsense_is_refused(program, word, monkeypatch):
    monkeypatch.setattr(scene, "build", lambda: pytest.fail("built"))
    with pytest.raises(Refusal, match=word):
        program.main([word])


@pytest.mark.parametrize("key", [key for key in peers.SPEEDS])
def test_peers_and_package_build_as_many_lists(key):
    """One at the start of a run and then every tenth step: that of the start is the package's alone
    if the run ends between two."""
    _, both, *sides = peers.SPEEDS[key]
    for name, own in sides:
        every = re.search(r"^neigh_modify +every (\d+) ", peers.deck(name, {**both, **own}), re.M)
        assert both["steps"] % int(every[1]) == 0


PEER = {"what": "a style", "ours": 2e6, "peer": 1e6, "ratio": 2.0, "spread": 0.1,
        "neighbours_ours": 12.0, "neighbours_peer": 13.0}
ALONE = {"what": "2 ranks over 1, water, by the clock", "ours": None, "peer": None, "ratio": 1.7,
         "spread": 0.1, "neighbours_ours": None, "neighbours_peer": None}


def test_pages_hold_their_rows():
    text = peers.page([PEER, ALONE])
    assert ("| a style | 2.00 | 1.00 | 2 ± 0.1 | 12.0, 13.0 |" in text and "{" not in text
            and "2 ranks" not in text)
    row = {"scene": "fluid", "effect": "shifting", "time": 0.5, "spread": 0.01,
           "instructions": 0.25, "memory": 40, "messages": 0, "bytes": 8.0, "collectives": 0}
    solid = {**row, "scene": "updated", "effect": "artificial stress"}
    counts = {name: 100.0 for name in solid_variants.VARIANTS} | {"+ artificial stress": 150.0}
    variants = [{"dimension": dim, "variant": name, "instructions": n} for dim in (2, 3)
                for name, n in counts.items()]
    text = effects.page([row, solid], variants)
    assert ("| Water | shifting | +25.0% |  | +50% ± 1% | +40 |  | +8.0 |  |" in text
            and "{" not in text)
    # what tools/cost effects shows alone
    assert "| artificial stress | +25.0% |  |" in effects.page([row, solid], [])
    assert "| artificial stress | +25.0% | +50.0% |" in text and text.count("| Solid | ") == len(
        solid_variants.FORMS)
    sizes = [{"what": "compute", "value": 1e-6, "unit": "s"},
             {"what": "bytes", "value": 98.0, "unit": "B"}]
    text = scaling.page(sizes, [PEER, ALONE, {**ALONE, "ratio": None}])
    threads = scaling.page(
        sizes, [ALONE, {**ALONE, "what": "2 threads over 2 ranks, water, by the clock"}])
    assert ("Two ranks are timed" in text and "and two threads" in threads
            and "| 2 threads over 2 ranks, water, by the clock | 1.70 ± 0.10 |" in threads)
    shared = [{"what": f"{label}, {ranks} ranks: ghosts over particles", "value": 0.1 * ranks,
               "unit": ""} for label in ("gate", "dam, 3D") for ranks in (2, 4)]
    ranks = scaling.page([row for n in shared
                          for row in (n, {"what": "messages", "value": 8, "unit": ""},
                                      {"what": "bytes sent", "value": 17920.0, "unit": "B"})], [])
    assert "| gate" not in ranks and "| dam" not in ranks  # these are in the table
    assert "| compute | 1 us |" in text and "| bytes | 98 B |" in text and text.count(
        "2 ranks over 1, water, by the clock | 1.70 ± 0.10 |") == 1


def test_cubes_of_water_have_a_shell_of_ghosts():
    """10^3 particles on each of 8 ranks, a shell of 2 around them: 14^3 - 10^3 ghosts."""
    assert scaling.cubes({"tau": 1e-6, "w": 2, "bytes": 100}, 8e3,
                         8) == pytest.approx((1e-3, 1.744, 174400))


def test_largest_run_keeps_its_log(tmp_path):
    """A small one: 12^3 particles, of which each has its volume in the restart file and 3 steps are
    run."""
    log = tmp_path / "largest.log"
    found = largest.measured(12, log)
    assert (found["particles"] == (1728, "") and "Loop time" in log.read_text() and 0.01
            < found["peak of the memory"][0] < 1)
    # position, velocity, density, type and more, 112 bytes in large ones
    assert 1728 * 80 < found["restart file"][0] * 2**30 < 1728 * 200
    row = [{"what": "particles", "value": 27e6}, {"what": "peak of the memory", "value": 19.0}]
    assert "27 million particles on one rank, 19.0 GB" in largest.line(row)


def test_largest_refuses_nonsense():
    with pytest.raises(Refusal, match="edge=none"):
        largest.main(["edge=none"])


def test_still_decks_move_nothing():
    """No output, no choice of the step, and a step in which nothing moves."""
    for text in (*(scaling.still_deck(*of) for of in scaling.SHARED.values()),
                 scaling.still_water()):
        assert re.findall(r"^timestep .*", text, re.M) == ["timestep 1e-7"]
        assert not re.search(r"^(run|dump|write_restart|fix +balance)|fsi/dt|file |^print ", text,
                             re.M)


def test_no_page_speaks_of_what_was_not_measured():
    """Codes that were not built here."""
    # which says whose scheme it is
    pages = [*(path for path in (paths.ROOT / "doc/cost").glob("*.md") if path.name != "README.md"),
             paths.ROOT / "README.md"]
    assert len(pages) > 5
    for page in pages:
        assert not re.search("DualSPHysics|SPHinXsys", page.read_text()), page


def test_bars_are_cut_and_say_so(tmp_path, monkeypatch):
    """Effects of -10 to +140 %: no bar beyond 100 %, but the number, and an arrow; the dearest
    first."""
    seen = []
    saved = effects.plot.Figure.savefig
    monkeypatch.setattr(effects.plot.Figure, "savefig",
                        lambda figure, *a, **k: (seen.append(figure), saved(figure, *a, **k)))
    rows = [{"scene": name, "effect": str(k), "instructions": 0.1 * k} for name in effects.SCENES
            for k in range(-1, 15)]
    effects.draw(tmp_path / "a.png", rows)
    axes = seen[0].axes[0]
    width = [bar.get_width() for bar in axes.patches]
    assert width == pytest.approx([100.0] * 5 + [10.0 * k for k in range(9, -2, -1)])
    assert [text.get_text().strip()
            for text in axes.texts[:5]] == [f"+{10 * k} →" for k in (14, 13, 12, 11)] + ["+100"]


def test_the_gates_deck_can_do_without_each_part():
    whole = effects.gate(400, 0)
    for part in ("viscosity", "diffusion", "walls", "rubber viscosity"):
        assert len(effects.gate(400, 0, without=(part,))) < len(whole)
    assert " substeps 8\n" in whole and " substeps 1\n" in effects.gate(400, 0,
                                                                        without=("substeps",))
