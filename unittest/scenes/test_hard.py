"""The suite of hard cases in short: its cheap cases through tools/run's own path, and that a row
which is missed is an error."""

import json
import re
import sys

import numpy as np
import pytest

from fsi import paths, scene

sys.path.insert(0, str(paths.ROOT / "bench"))
import evidence  # noqa: E402
import hard_pages  # noqa: E402

ROWS, RECIPES = scene.analysis("hard").ROWS, scene.analysis("hard").RECIPES
# rows whose runs take a second or two
GOOD = ("drop", "spin", "spray", "splash", "tear", "locking", "hairpin", "empty", "jump_plate")


def short(*names):
    """Of the bundled cases those called so; a name ends at the recipe."""
    bundled = scene.cases("hard")
    return {name: bundled[name] for name in names}


def run_cases(monkeypatch, folder, cases):
    monkeypatch.setattr(scene, "cases", lambda name: cases)
    status = scene.run_cases("hard", folder)
    return status, {entry["row"]: entry
                    for entry in json.loads((folder / "hard.json").read_text())["rows"]}


def test_every_case_belongs_to_a_row():
    groups = {name.rpartition(".")[0] for name in scene.cases("hard")}
    assert all(any(re.fullmatch(row.groups, group) for row in ROWS.values()) for group in groups)
    best = {name.rpartition(".")[0] for name in scene.cases("hard") if name.endswith(".best")}
    for name, row in ROWS.items():
        assert any(re.fullmatch(row.groups, group)
                   for group in best), f"row {name} has no run of the best recipe"


def test_all_recipes_have_the_same_settings():
    """Of a row that compares; what is not run at all is said to be so. A preset is run alone where
    the row names one."""
    names = set(scene.cases("hard"))
    for name, row in ROWS.items():
        ran = {recipe: {group for group, _, which in (n.rpartition(".") for n in names) if which
                        == recipe and re.fullmatch(row.groups, group)}
               for recipe in (*RECIPES, "preset")}
        if row.scheme:
            assert all(groups in (set(), ran["best"])
                       for groups in ran.values()) and ran["delta"], name
            assert bool(ran["preset"]) == bool(row.alone), name
        else:
            assert not ran["delta"] | ran["classic"] | ran["preset"], name


def test_recipes_differ_in_the_scheme_alone():
    """The same deck, particles, end; still water starts with hydrostatic pressure in each of
    them."""
    scheme = {"mode", "kernel", "hdx", "alpha", "alpha_s", "hourglass", "gradient", "tl", "solid",
              "fix_sph", "ring_gradient", "pair_style", "water", "coupling",
              "ul_solid", "style", "tension", "shift", "shift_every", "surface", "thin", "guard"}
    cases = scene.cases("hard")
    for name, case in cases.items():
        best = cases[name.rpartition(".")[0] + ".best"]
        assert {k: v for k, v in case["variables"].items() if k not in scheme} == {
            k: v for k, v in best["variables"].items() if k not in scheme}, name
        assert (case["deck"], case["ranks"]) == (best["deck"], best["ranks"]), name


def test_short_form(monkeypatch, tmp_path):
    """Best passes what it must; drops tear without shifting, plates of plain gradients break; all
    is told."""
    status, table = run_cases(monkeypatch, tmp_path, short(
        "drop.best", "drop.delta", "drop.classic", "spin.best", "spin.delta", "spin.classic",
        "spray_1.best", "spray_2.best", "spray_3.best", "splash_2.best",
        "tear_serial.best", "tear.best", "lock_4_0.49.best", "hairpin.best", "empty.best",
        "jump_plate.best"))
    assert status == 0 and set(table) == set(GOOD)
    assert all(table[name]["best"]["pass"] for name in GOOD)
    assert (not table["drop"]["classic"]["pass"] and not table["spin"]["classic"]["pass"]
            and not table["drop"]["delta"]["pass"])
    assert table["spin"]["delta"]["pass"] and table["drop"]["classic"]["kept"] == {
        "in_one_piece": True, "distance": False}
    assert (table["drop"]["best"]["worst"]["distance"] > 0.7 > 0.5
            > table["drop"]["classic"]["worst"]["distance"])
    found = json.loads((tmp_path / "hard.json").read_text())
    assert found["runs"] == 16 and found["particle_steps"] > 1e5 and re.fullmatch(
        r"\d{4}-\d\d-\d\d", found["date"])
    # of what is pictured the drop alone ran in all recipes, to 0.0076 s
    assert [(p["group"], {r: round(time, 4) for r, time in p["times"].items()})
            for p in found["pictures"]] == [("drop", dict.fromkeys(RECIPES, 0.0076))]
    for module in (hard_pages, evidence):
        monkeypatch.setattr(module, "HARD", tmp_path)
    page = hard_pages.hard_page()
    assert (
        "**6 of 6 hard cases pass here, 1 of 2 with delta-SPH, 0 of 2 with classic SPH.**" in page
        and "✗" in page)
    # a line for each bound: the value, its unit, whether it is kept
    assert re.search(r"\| stretched drop of water \| closed \| water in one piece >= 99 % \| 100 ✓ "
                     r"\| [\d.]+ ✗ \| 100 ✓ \|\n"
                     r"\|  \|  \| nearest pair > 0.5 dx \| 0.\d+ ✓ \| 0.\d+ ✗ \| 0.\d+ ✗ \|", page)
    assert ("| spray: 1, 2, 3 particles | splash | off the parabola by < 1e-12 m/s | 1.76e-14 ✓ | "
            "not run | not run |" in page)
    assert page.index("## Tests of the software") < page.index(
        "| solid torn between two ranks | pieces == 2 | 2 ✓ |")
    hard_pages.draw_hard(tmp_path / "hard.png")
    assert (tmp_path / "hard.png").stat().st_size > 1000
    assert (tmp_path / "hard.csv").read_text().count("\n") > 15


def test_a_run_that_is_stopped_is_a_result(monkeypatch, tmp_path, capsys):
    """Twenty times the stable step: fix fsi ends the run, it turns the body inside out, its words
    are in the table, the row is missed, so is the suite."""
    cases = short("spin.best")
    cases["spin.best"]["variables"]["cfl"] = "6"
    status, table = run_cases(monkeypatch, tmp_path, cases)
    assert status == 1 and not table["spin"]["best"]["pass"]
    assert "Fix fsi: density" in table["spin"]["best"]["stopped"]
    assert "hard: the best recipe misses spin" in capsys.readouterr().err
    cases["spin.best"]["may_fail"] = False
    monkeypatch.setattr(scene, "cases", lambda name: cases)
    assert scene.run_cases("hard", tmp_path / "strict") != 0 and not (tmp_path / "strict"
                                                                      / "hard.json").exists()


def test_pieces_and_neighbors():
    """Pairs and clusters against all pairs, of random points."""
    module = scene.analysis("hard")
    x = np.random.default_rng(1).uniform(0.0, 1.0, (200, 2))
    apart = np.linalg.norm(x[:, None] - x[None], axis=2)
    i, j, r = module.near(x, 0.05)
    assert sorted(zip(i, j)) == sorted(zip(*np.nonzero((apart < 0.05) & (apart > 0.0))))
    np.testing.assert_allclose(r, apart[i, j], rtol=1e-15)
    reached = apart < 0.05
    for _ in range(8):
        reached = reached @ reached
    assert module.pieces(x, 0.05) == sorted(np.unique(reached, axis=0).sum(1).tolist(),
                                            reverse=True)


@pytest.mark.parametrize("case, message", [
    ({"deck": "still_watr"}, "did you mean 'still_water'"),
    ({"deck": "still_water", "variables": {"dxx": "1"}}, "no variable 'dxx'"),
    ({"deck": "still_water", "variables": {"ring_gradient": "plain"}},
     "the deck has no 'gradient corrected'"),
])
def test_bad_borrowed_decks_are_refused(monkeypatch, tmp_path, case, message):
    for name in paths.examples():
        (tmp_path / name).symlink_to(paths.EXAMPLES / name)
    (tmp_path / "toy").mkdir()
    (tmp_path / "toy" / "in.toy").write_text("print 'toy'\n")
    (tmp_path / "toy" / "cases.json").write_text(json.dumps({"a": case}))
    (tmp_path / "toy" / "edits.json").write_text((paths.folder("hard") / "edits.json").read_text())
    monkeypatch.setattr(paths, "EXAMPLES", tmp_path)
    with pytest.raises(scene.Refusal, match=message):
        scene.cases("toy")
