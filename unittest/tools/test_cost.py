"""Sweeps of accuracy and cost: what they make of made-up numbers, and short ones of two scenes and
of a deck of one's own.

Times are not asserted: only what is certain, that finer costs more work and that these errors fall.
"""

import csv
import json
import re
import sys

import numpy as np
import pytest

from fsi import log, paths, precision, scene, series, sweep

sys.path.insert(0, str(paths.ROOT / "bench"))
import accuracy_cost  # noqa: E402
import cost_report  # noqa: E402
import open_ends  # noqa: E402
from tool import figures_of, left  # noqa: E402

H = np.array([0.1, 0.05, 0.025, 0.0125])


def test_order_of_a_power_law():
    slope, interval, constant = precision.order(H, -3.0 * H**1.7)
    assert slope == pytest.approx(1.7) and constant == pytest.approx(3.0) and interval < 1e-6
    # an error that is off the line by a quarter must widen the interval so that it still holds the
    # slope
    slope, interval, _ = precision.order(H, 3.0 * H**1.7 * np.array([1.0, 1.25, 0.8, 1.0]))
    assert 0.1 < interval < 2.0 and abs(slope - 1.7) < interval
    assert precision.order(H[:2], H[:2]) is None


def test_extrapolation_finds_the_limit():
    limit, power, uncertainty = precision.extrapolate(H, 2.0 - 5.0 * H**1.5)
    assert power == pytest.approx(1.5, abs=0.02) and limit == pytest.approx(2.0, abs=1e-3) and abs(
        limit - 2.0) <= uncertainty
    assert precision.extrapolate(H, [1.0, 1.1, 1.05, 1.12]) is None  # to and fro
    assert precision.extrapolate(H, [1.0, 1.1, 1.3, 1.7]) is None  # ever larger steps
    assert precision.extrapolate(H[:2], [1.0, 1.1]) is None
    # a coarse run far off, then hardly any change: with and without it the limits differ by more
    # than the last step
    assert precision.extrapolate([2.5, 1.667, 1.25, 1.0], [30.97, 36.32, 36.75, 37.07]) is None
    # three runs, the coarsest far off: order 5.5 is no order of a scheme, and of order 2 the limit
    # would be 0.66 further
    limit, power, uncertainty = precision.extrapolate([2.5, 5 / 3, 1.25], [37.40, 44.087, 44.734])
    assert power > 5.0 and uncertainty == pytest.approx(44.734 + 0.647 / ((4 / 3)**2 - 1.0) - limit,
                                                        rel=1e-6) and uncertainty > 0.6


def test_front_bounds_and_changes_of_sign():
    assert precision.pareto([1.0, 2.0, 2.0, 3.0, 4.0], [5.0, 3.0, 4.0, 3.0, np.nan]) == [0, 1]
    # one coarser run within the bound by chance does not count
    assert precision.reach([0.3, 0.04, 0.06, 0.01], 0.05) == 3
    assert precision.reach([0.04, -0.03, 0.01], 0.05) == 0
    assert precision.reach([0.04, 0.03, 0.06], 0.05) is None
    assert precision.crossings([0.2, 0.01, -0.05, -0.04]).tolist() == [False, True, False, False]


def small(name, methods, values, **changes):
    """A scene's own definition, cut down to some of its methods at a few resolutions."""
    definition = accuracy_cost.load(name, {})
    chosen = {m: {**definition["methods"][m], "at": values} for m in methods}
    return definition | {"methods": chosen, "knobs": [], "effects": [], "corners": {}} | changes


def store_of(folder, name, definition):
    return sweep.Store(folder, sweep.Deck(scene.deck(name), definition.get("edits")),
                       accuracy_cost.analysed(name), repeats=2)


def made(tmp_path, name, definition):
    """Sweeps and reports; returns (summary, rows of points.csv by label, store, jobs)."""
    wanted = accuracy_cost.points(definition)
    store = store_of(tmp_path / "points", name, definition)
    jobs = [(p["label"], p["settings"], accuracy_cost.work(definition, p["settings"]))
            for p in wanted]
    assert sweep.sweep(store, jobs, lambda _: None)
    for point in wanted:
        point["run"] = store.get(point["settings"])
    cost_report.write(tmp_path, name, definition, wanted, store.source)
    # an interrupted sweep is drawn, too, when it has got no further than its first points
    cost_report.write(tmp_path / "part", name, definition, wanted[:2], store.source)
    with (tmp_path / "points.csv").open() as file:
        assert re.fullmatch(r"# tools/cost \w+; commit ([0-9a-f]+\+?|unknown), \d{4}-\d\d-\d\d\n",
                            next(file))
        rows = {row["label"]: row for row in csv.DictReader(file)}
    return json.loads((tmp_path / "summary.json").read_text()), rows, store, jobs


@pytest.fixture(scope="module")
def plate(tmp_path_factory):
    knob = [{"name": "Courant number", "variable": "cfl", "of": "TL linear", "at": 3,
             "values": [0.25, 2.0]}]
    effects = [{"of": "TL linear", "at": 3, "cases": {"no hourglass control": {"hourglass": 0}}}]
    folder = tmp_path_factory.mktemp("plate")
    definition = small("oscillating_plate", ["TL linear", "TL quadratic"], [3, 4, 5], knobs=knob,
                       effects=effects)
    # one swing, of the softest, too
    definition["common"] = {**definition["common"], "periods": "1.7"}
    return folder, *made(folder, "oscillating_plate", definition)


def test_plate_finer_costs_more_and_errs_less(plate):
    _, summary, rows, _, _ = plate
    for method in ("TL linear", "TL quadratic"):
        curve = [rows[f"{method}, n = {n}"] for n in (3, 4, 5)]
        for name in ("particles", "steps", "particle_steps", "pair_visits"):
            assert np.all(np.diff([float(r[name]) for r in curve]) > 0.0), name
        errors = [abs(float(r["error"])) for r in curve]
        if method == "TL linear":
            assert np.all(np.diff(errors) < 0.0)
        else:    # 4 across is the odd one of quadratic gradients (doc/src/theory.rst)
            assert max(errors[1:]) < 0.7 * errors[0]
        assert summary["methods"][method]["order"] > 0.0
    # bending is a quadratic displacement: gradients exact for it err far less, by a factor of 3 at
    # the least at three across
    assert abs(float(rows["TL quadratic, n = 3"]["error"])) < abs(
        float(rows["TL linear, n = 3"]["error"])) / 3.0


def test_plate_unstable_run_is_a_point_too(plate):
    folder, summary, rows, _, _ = plate
    # eight times the rule of the time step: explicit schemes are not that stable
    failed = rows["Courant number = 2.0"]
    assert failed["status"] == "failed" and failed["why"] and not failed["error"]
    assert summary["failed"] == 1
    assert "1 stopped or do not count" in (folder / "page.md").read_text()


@pytest.mark.parametrize("sizes, thinnest", [((4, 4, 5), {"2": 4.0, "3": 5.0}),
                                             ((4, 8, 5), {})])
def test_thickness_is_that_of_all_methods(sizes, thinnest):
    rows = [{"role": "curve", "x": x, "point": {"bodies": [("body 1", 0, [n, 20])]}}
            for x, n in zip((2, 2, 3), sizes)]
    assert cost_report._thinnest(rows) == thinnest    # pylint: disable=protected-access


def test_plate_leaves_picture_and_page(plate):
    folder, summary, rows, _, _ = plate
    assert (folder / "work.png").read_bytes().startswith(b"\x89PNG")
    text = (folder / "page.md").read_text()
    assert text.count("![") == 1 and text.count("\n|---|") == 1 and "0.2553" in text
    for method, found in summary["methods"].items():
        cells = [cost_report.cell(found["bounds"].get(bound)) for bound in ("10", "5", "2", "1")]
        assert re.search(rf"^\| {method} \| [^|]* \| {' [|] '.join(map(re.escape, cells))} \| "
                         r"(\d+|-) \|$", text, re.M)
    assert summary["reference"]["kind"] == "outside" and re.fullmatch(r"\d{4}-\d\d-\d\d",
                                                                      summary["date"])
    assert summary["thinnest"] == {"3": 3.0, "4": 4.0, "5": 5.0}
    assert sum(row["front"] == "True" for row in rows.values()) >= 1


def test_nothing_is_run_twice(plate, monkeypatch):
    *_, store, jobs = plate
    monkeypatch.setattr(sweep.Store, "_simulate", lambda *_: pytest.fail("ran again"))
    assert sweep.sweep(store, jobs, lambda _: None)
    label, settings, _ = jobs[0]
    # the deck's own default
    assert store.path({**settings, "vf": "0.01"}) == store.path(settings), label
    assert store.path({**settings, "vf": "0.02"}) != store.path(settings)
    store.source = "another"
    assert store.get(settings) is None


def test_cases_of_the_scene_are_taken(plate, tmp_path, monkeypatch):
    """A run that tools/run left as a case is the point of a sweep, cost and figures alike; one of
    another commit or with other settings is run."""
    _, _, _, store, jobs = plate
    settings = next(settings for label, settings, _ in jobs if label == "TL linear, n = 3")
    monkeypatch.setattr(paths, "RESULTS", tmp_path)
    monkeypatch.setattr(scene, "cases", lambda _: {"three": {"variables": settings, "ranks": 1,
                                                             "deck": None, "may_fail": False}})
    monkeypatch.setattr(scene, "commit", lambda: "0123456789")
    assert scene.run("oscillating_plate", tmp_path / "oscillating_plate" / "three", 1, settings,
                     "three") == 0
    found = sweep.Store(tmp_path / "points", store.deck, store.measure)
    # the deck's own default
    there = left(store.deck, "oscillating_plate", {**settings, "vf": "0.01"})
    found.take(settings, there, figures_of(there))
    monkeypatch.setattr(sweep.Store, "_simulate", lambda *_: pytest.fail("ran again"))
    taken, own = found.make(settings), sweep.Store(store.folder, store.deck,
                                                   store.measure).get(settings)
    of_run = {"cpu_seconds": 0, "particle_steps_per_second": 0, "bytes_per_particle": 0}
    assert taken["figures"] | of_run == pytest.approx(own["figures"] | of_run)
    for name in ("settings", "source", "status", "dx", "particles", "steps", "particle_steps",
                 "pair_visits"):
        assert taken[name] == own[name], name
    assert left(store.deck, "oscillating_plate", {**settings, "vf": "0.02"}) is None
    monkeypatch.setattr(scene, "commit", lambda: "9876543210")
    assert left(store.deck, "oscillating_plate", settings) is None


def test_defaults_that_a_recipe_changes_are_given():
    """The plate's kernel is one by default and another with mode=paper, so that a setting equal to
    the former must not be dropped."""
    deck = sweep.Deck(scene.deck("oscillating_plate"))
    assert deck.instance({"mode": "paper", "kernel": "wendland", "vf": "0.01"})[1] == {
        "mode": "paper", "kernel": "wendland"}


def test_instructions_are_those_of_the_time_loop(plate, tmp_path):
    # twice the steps, twice the instructions, with 10 % for what a run does once; the start of
    # LAMMPS alone takes more than either
    *_, store, jobs = plate
    # pylint: disable-next=protected-access
    counted = [store._simulate(tmp_path, jobs[0][1], steps) for steps in (40, 80)]
    assert counted[0]["steps"] == 40 and counted[1]["instructions"] == pytest.approx(
        2 * counted[0]["instructions"], rel=0.1)
    # a pair takes tens of instructions: a kernel, a stress times a gradient; thousands would be
    # something else
    assert 10 < counted[0]["instructions"] / counted[0]["pair_visits"] < 1000


LOG = """LAMMPS (4 Feb 2025)
fix sph mobile fsi 0.0025 wendland 1.5 substeps 8
  fsi/solid/tl: reference of 100 particles taken, 9.5 bonds each
Per MPI rank memory allocation (min/avg/max) = 8 | 8 | 8 Mbytes
Loop time of 2 on 1 procs for 50 steps with {atoms} atoms
{half}FullNghs:          31950 ave       31950 max       31950 min
Total # of neighbors = 31950
"""


@pytest.mark.parametrize("atoms, half, visits", [
    # half of what the full list has beyond the solid, and sub-steps over its bonds
    (1000, "", 50 * (0.5 * (31950 - 950) + 8 * 950)),
    (1000, "Neighs:  0 ave 0 max 0 min\n", 50 * (0.5 * (31950 - 950) + 8 * 950)),
    (1000, "Neighs:  20000 ave 20000 max 20000 min\n", 50 * (20000 + 8 * 950)),
    (100, "Neighs:  0 ave 0 max 0 min\n", 50 * 8 * 950)])  # one solid and nothing else: no list
def test_pair_visits(tmp_path, atoms, half, visits):
    (tmp_path / "log.lammps").write_text(LOG.format(atoms=atoms, half=half))
    found = log.read(tmp_path / "log.lammps")
    assert found.pair_visits() == visits and (found.solid_particles, found.substeps) == (100, 8)


def test_substeps_that_fix_dt_chooses(tmp_path):
    text = LOG.format(atoms=1000, half="").replace(" substeps 8", "").replace(
        "  fsi/solid", "fix dt all fsi/dt 10 cfl 1 substeps auto stop 0.4\n  fsi/solid")
    (tmp_path / "log.lammps").write_text(
        text.replace("Mbytes\n", "Mbytes\n Step f_dt[7]\n 0 7\n 50 9\n"))
    assert log.read(tmp_path / "log.lammps").pair_visits() == 50 * (0.5 * (31950 - 950) + 8 * 950)


def test_runs_that_do_not_count():
    run = {"status": "ok", "figures": {"period": 2.0, "scatter": 0.03}}
    for limits, value in (([], 2.0), (["scatter"], None), (["stopped"], 2.0),
                          ({"scatter": 0.02}, None), ({"scatter": 0.04}, 2.0)):
        assert cost_report._value({"figure": "period", "failed_if": limits}, run) == value


def entry(seconds, error, kind="run"):
    return {"at": 3, "error": error, "cpu_seconds": seconds, "kind": kind}


def test_cells_of_bounds():
    assert [cost_report.cell(entry(0.123, 0.01, kind)) for kind in (
        "run", "coarsest run", "extrapolated")] == ["0.12 s (3)", "< 0.12 s (3)", "*0.12 s (3)*"]
    assert cost_report.cell(None) == "-"


def test_names_of_curves_do_not_overlap(tmp_path):
    """Five curves that end together: their names are apart by the height of a line and in the order
    of their ends."""
    with cost_report.plot.picture(tmp_path / "a.png") as figure:
        axes = figure.add_subplot()
        axes.set(xscale="log", yscale="log", xlim=(1, 10), ylim=(0.1, 10))
        cost_report.names_at_ends(axes, [(5.0, 1.0 + 0.01 * k, str(k), "black") for k in range(5)])
        places = [text.xyann[1] for text in axes.texts]
        height = axes.get_position().height * figure.get_size_inches()[1] * 72.0
        assert [text.get_text() for text in axes.texts] == list("01234") and np.diff(
            places).min() * height > 7.5


def test_sweep_goes_on_where_it_stopped(tmp_path):
    definition = small("standing_wave", ["quintic 1.0"], [0.1, 0.05])
    jobs = [(p["label"], p["settings"], accuracy_cost.work(definition, p["settings"]))
            for p in accuracy_cost.points(definition)]
    store, said = store_of(tmp_path, "standing_wave", definition), []
    assert not sweep.sweep(store, jobs, said.append, budget=1e-6)
    assert sum(store.get(job[1]) is not None for job in jobs) == 1 and "1 points left" in said[-1]
    coarse = store.get(jobs[0][1])
    assert sweep.sweep(store, jobs, said.append)
    assert store.get(jobs[0][1])["figures"] == coarse["figures"] and len(
        store.get(jobs[0][1])["cpu_seconds"]) == 2
    assert "cost: 2 points, 1 to run" in said
    fine = store.get(jobs[1][1])
    assert fine["particle_steps"] > 4 * coarse["particle_steps"]
    # linear theory; 5 particles over the depth are within 10 %
    assert fine["figures"]["period"] == pytest.approx(fine["figures"]["period reference"], rel=0.1)


DECK = """# value = 1 + 3 h^2 for the default kernel, printed without any physics
variable h index 0.5
variable kind index a
variable offset equal 0
units lj
region box block 0 $(2/v_h) 0 2 0 2
lattice sc 1
create_box 1 box
create_atoms 1 box
mass 1 1
pair_style zero 1.0
pair_coeff * *
if "${kind} == b" then "variable slope equal 6" else "variable slope equal 3"
variable value equal 1+v_slope*v_h^2+v_offset
thermo_style custom step v_value
thermo 1
run 1
"""


def test_deck_of_ones_own(tmp_path, monkeypatch, capsys):
    deck, out = tmp_path / "mine.in", tmp_path / "out"
    deck.write_text(DECK)
    monkeypatch.setattr(scene, "build", lambda: True)
    monkeypatch.setattr(sweep, "count", lambda *_: None)  # instructions are another test's
    words = [str(deck), "--vary", "h=0.1,0.5,0.25,0.125", "--vary", "kind=a,b", "--measure",
             "value", f"out={out}", "repeats=1"]
    assert accuracy_cost.main(words) == 0
    summary = json.loads((out / "summary.json").read_text())
    assert (summary["reference"]["kind"] == "extrapolated" and summary["reference"]["value"]
            == pytest.approx(1.0, abs=1e-3))
    assert summary["methods"]["kind a"]["order"] == pytest.approx(2.0, abs=0.1)
    assert set(summary["methods"]) == {"kind a", "kind b"}
    # two resolutions allow no extrapolation: the finer one is the reference, and has no error of
    # its own
    assert accuracy_cost.main([*words[:2], "h=0.5,0.25", *words[3:]]) == 0
    summary = json.loads((out / "summary.json").read_text())
    assert summary["reference"]["kind"] == "finest" and not summary["failed"]
    assert summary["methods"]["kind a"]["bounds"] == {} and "reference" in (
        out / "points.csv").read_text()
    with (out / "points.csv").open() as file:
        rows = {row["label"]: row
                for row in csv.DictReader(line for line in file if not line.startswith("#"))}
    assert (rows["kind a, h = 0.25"]["status"], rows["kind a, h = 0.25"]["value"],
            rows["kind a, h = 0.25"]["error"]) == ("reference", "1.1875", "")
    assert float(rows["kind a, h = 0.5"]["value"]) == 1.75 and float(
        rows["kind a, h = 0.5"]["error"]) == pytest.approx(1.75 / 1.1875 - 1)
    assert "Reference: the finest run of 'kind a', 1.1875. It is not an independent reference." in (
        out / "page.md").read_text()
    # a formula of the deck can be replaced; points are others, so nothing is mixed up
    assert accuracy_cost.main([*words, "offset=1"]) == 0
    assert json.loads((out / "summary.json").read_text())["reference"]["value"] == pytest.approx(
        2.0, abs=1e-3)
    assert "8 points, 8 to run" in capsys.readouterr().out


def test_deck_of_ones_own_that_has_not_swung(tmp_path, monkeypatch, capsys):
    """An eighth of the beam's period: its tip still falls. Over more than half a period it has been
    down and comes back."""
    monkeypatch.setattr(scene, "build", lambda: True)
    monkeypatch.setattr(sweep, "count", lambda *_: None)  # instructions are another test's
    (tmp_path / "own.in").write_text((paths.EXAMPLES / "beam" / "in.beam").read_text().replace(
        "thermo          2000", "thermo 20"))
    words = [str(tmp_path / "own.in"), "--vary", "across=2,3", "--measure", "tip", "repeats=1"]
    assert accuracy_cost.main([*words, "tend=0.03", f"out={tmp_path / 'short'}"]) == 0
    assert "cost: warning: tip has not yet swung in deck, across = 2 (" in capsys.readouterr().out
    page = (tmp_path / "short" / "page.md").read_text()
    assert "**Warning**: tip has not yet swung" in page
    assert "The thinnest body has" not in page
    assert accuracy_cost.main([*words, "tend=0.18", f"out={tmp_path / 'long'}"]) == 0
    assert "warning" not in capsys.readouterr().out and "Warning" not in (tmp_path / "long"
                                                                          / "page.md").read_text()


def test_decks_have_a_folder_each():
    """Those of this manual are called in.NAME."""
    assert [accuracy_cost.name_of(accuracy_cost.Path(deck)) for deck in (
        "a/in.flap", "in.flap.fine", "flap.in", "flap")] == ["flap", "flap.fine", "flap", "flap"]


def test_what_still_moves():
    time = np.linspace(0.0, 1.0, 101)
    # a straight rise: a tenth in the last tenth
    assert series.still_moving(time, time) == pytest.approx(0.1)
    assert series.still_moving(time, np.sin(np.pi * time)) is None  # has been up and is back
    assert series.still_moving(time, 1.0 - np.exp(-10.0 * time)) is None  # has come to rest
    assert series.still_moving(time, 1.0 - np.exp(-time)) == pytest.approx(
        (np.exp(-0.9) - np.exp(-1.0)) / (1.0 - np.exp(-1.0)))
    assert series.still_moving(time, 0.0 * time) is None


@pytest.mark.parametrize("words, says", [
    (["nothing"], "neither a scene nor a file"),
    (["still_water", "--measure", "p"], "deck of your own"),
    (["oscillating_plate", "nn=3", "draw=only"], "no variable 'nn'"),
    (["oscillating_plate", "draw"], "NAME=VALUE"),
    (["oscillating_plate", "budget=much"], "a number"),
    (["oscillating_plate", "source=0"], "draw=only"),
    (["oscillating_plate", "--vary"], "needs a value")])
def test_mistakes_are_told(words, says):
    with pytest.raises(scene.Refusal, match=says):
        accuracy_cost.main(words)


def test_definitions_of_all_scenes_fit_their_decks():
    for path in sorted(paths.EXAMPLES.glob("*/cost.json")):
        name = path.parent.name
        definition = accuracy_cost.load(name, {})
        deck = sweep.Deck(scene.deck(name), definition.get("edits"))
        for point in accuracy_cost.points(definition):
            deck.instance(point["settings"])  # refuses what the deck does not have


def test_open_ends_counts_what_is_lost(monkeypatch, capsys):
    """A short channel, and the same with a particle taken out of the count; test_inlet.py has the
    ranks."""
    runs, run = [], open_ends.run
    monkeypatch.setattr(open_ends, "run", lambda *words: runs.append(run(*words)) or runs[-1])
    assert open_ends.main(["times=1"]) == 0
    told = capsys.readouterr().out
    came, left = map(int, re.search(r"(\d+) came, (\d+) left, 0 lost", told).groups())
    # 100 come in a second of mean flow, for 3 s; the inflow rises as 1 - exp(-t/0.5)
    assert abs(came / 250 - 1) < 0.1 and abs(left / 250 - 1) < 0.1
    found, = runs
    found["inside"][-1] -= 1
    monkeypatch.setattr(open_ends, "run", lambda *_: found)
    assert open_ends.main([]) == 1 and "1 lost" in capsys.readouterr().out
