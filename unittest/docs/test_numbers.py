"""Numbers that pages quote are those of the data that commands wrote."""

import csv
import json
import re
from functools import partial

import pytest

from fsi import paths

ROOT = paths.ROOT


def rows(name):
    with open(ROOT / "doc/cost" / f"{name}.csv", encoding="utf-8", newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def effect(scene, name):
    """Instructions that naming an effect adds, in per cent."""
    row, = (row for row in rows("effects") if (row["scene"], row["effect"]) == (scene, name))
    return 100 * float(row["instructions"])


def curve(scene, method, *at):
    """[error in per cent, its size] of a method's runs; method: how its name begins."""
    found = {float(row["x"]): row for row in rows(scene) if row["role"] == "curve" and re.match(method, row["group"])}
    return [100 * abs(float(found[x]["error"])) for x in at]


def seconds(scene, method, *at):
    found = {float(row["x"]): row for row in rows(scene) if row["role"] == "curve" and re.match(method, row["group"])}
    return [float(found[x]["cpu_seconds"]) for x in at]


def summary_of(scene):
    return json.loads((ROOT / "doc/results/results.json").read_text(encoding="utf-8"))["scenes"][scene]["summary"]


def figures(scene, *names):
    """[error in per cent, its size; of a figure that is an error itself the value] in doc/results."""
    found = {f["name"]: f for f in summary_of(scene)["figures"]}
    return [100 * abs(found[n]["value"] / found[n]["reference"] - 1 if found[n]["reference"] else found[n]["value"]) for n in names]


def sizes(scene, *names):
    """[size of a figure, in its unit] in doc/results."""
    found = {f["name"]: f for f in summary_of(scene)["figures"]}
    return [abs(found[n]["value"]) for n in names]


def minutes(scene, *names):
    """[processor time of a case] in doc/results."""
    return [summary_of(scene)["cases"][n]["cpu_seconds"] / 60 for n in names]


def mixed(scene, *names):
    """[size, error in per cent, size, error ...] of figures."""
    return [x for n in names for x in sizes(scene, n) + figures(scene, n)]


TL = r"TL quadratic, "    # with a column held
WATER = ("fluid", "shifting"), ("fluid", "shifting, every 4 steps")
# page, the words around the numbers ({} stands for one), the numbers
QUOTED = [
    ("doc/choosing.md", "{} %, {} %, {} % of the period | 3, 5, 10", lambda: curve("oscillating_plate", TL, 3, 5, 10)),
    ("doc/choosing.md", "3, 5, 10 particles through the thickness | {}, {}, {} s", lambda: seconds("oscillating_plate", TL, 3, 5, 10)),
    ("doc/choosing.md", "{} %, {} % of the deflection", lambda: curve("hydrostatic_plate", "quadratic$", 3, 5)),
    ("doc/choosing.md", "{}, {}, {} % of the peak | 2, 3, 4", lambda: curve("elastic_gate", "TL$", 0.0025, 0.00166666667, 0.00125)),
    ("doc/choosing.md", "2, 3, 4 | {}, {}, {} s", lambda: seconds("elastic_gate", "TL$", 0.0025, 0.00166666667, 0.00125)),
    ("doc/choosing.md", "{} %, {} % | 3, 4 |", lambda: curve("elastic_gate", "TL, water twice", 0.00166666667, 0.00125)),
    ("doc/choosing.md", "{} % of the amplitude", lambda: curve("turek_hron_fsi", "flag twice", 2)),
    ("doc/choosing.md", "{}, {}, {} % of the drag", lambda: figures("cylinder_channel", "drag_max_re_100_14", "drag_max_re_100_20", "drag_max_re_100_28")),
    ("doc/choosing.md", "14, 20, 28 per diameter | {}, {}, {} min", lambda: minutes("cylinder_channel", "re_100_14", "re_100_20", "re_100_28")),
    ("doc/choosing.md", "{}, {} % of the speed", lambda: curve("taylor_green", "shifting, quintic", 0.04, 0.025)),
    ("doc/choosing.md", "{}, {} % of the period | 10, 20 rows", lambda: curve("standing_wave", "quintic 1.0", 0.05, 0.025)),
    ("doc/choosing.md", "{}, {} % of the pressure", lambda: curve("still_water", "quintic 0.94", 0.05, 0.025)),
    ("doc/choosing.md", "{}, {}, {} % of the front", lambda: figures("dam_break", "front_error_code_20", "front_error_code_40", "front_error_code_80")),
    ("doc/choosing.md", "{}, {}, {} % of the length", lambda: figures("taylor_bar", *(f"final_length_{n}_across" for n in (4, 6, 8)))),
    ("doc/choosing.md", "{}, {} % of the period | 5, 10; 3 fails", lambda: curve("oscillating_plate", r"UL quadratic, hourglass, ", 5, 10)),
    ("doc/choosing.md", "linear ones err by {} %", lambda: curve("oscillating_plate", "TL linear, ", 5)),
    ("doc/choosing.md", "gate: {} % change of the peak with water 2.5 times coarser", lambda: figures("elastic_gate", "12MPa_water_2.5_times_coarser_tip_x_peak")),
    ("doc/src/tutorial_gate.rst", "is the same to {} %, in a third of the time", lambda: figures("elastic_gate", "12MPa_water_2.5_times_coarser_tip_x_peak")),
    ("doc/src/tutorial_gate.rst", "The peak grows by {} mm", lambda: [sizes("elastic_gate", "10MPa_tip_x_peak")[0] - sizes("elastic_gate", "12MPa_tip_x_peak")[0]]),
    ("doc/choosing.md", "the gate bends {} % too little with 2", lambda: curve("elastic_gate", "TL$", 0.0025)),
    ("doc/choosing.md", "+{} % instructions of a solid alone, +{} % of the gate", lambda: [effect("total", "hourglass control"), effect("gate", "hourglass control")]),
    ("doc/choosing.md", "0.7 % become 3.9 %; +{} % instructions", lambda: [effect(*WATER[0])]),
    ("doc/choosing.md", "+{} % instructions instead of +{} % |\n| *density/surface*", lambda: [effect(*WATER[1]), effect(*WATER[0])]),
    ("doc/src/pair_fsi_fluid.rst", "it adds {} % to the instructions of plain water instead of {} %", lambda: [effect(*WATER[1]), effect(*WATER[0])]),
    ("doc/src/pair_fsi_solid_tl.rst", "a solid alone takes {} times", lambda: [1 + effect("total", "hourglass control") / 100]),
    ("doc/src/pair_fsi_solid_tl.rst", "its water {} times", lambda: [1 + effect("gate", "hourglass control") / 100]),
]


# The same of the scenes' own pages: scene, words, what the numbers are, the figures
SCENES = [
    ("bending_column", "displacement | {} m (+{} %) | {} m (+{} %)", mixed, ["peak_6", "peak_10"]),
    ("bending_column", "zero | {} s (+{} %) | {} s (+{} %)", mixed, ["zero_crossing_6", "zero_crossing_10"]),
    *((("cylinder_channel", f"| {n} | {{}} ({sign}{{}} %) | {{}} | {{}} | {{}} |",
        lambda scene, drag, *more: mixed(scene, drag) + sizes(scene, *more),
        [f"drag_{n}_across", f"drag_scatter_{n}_across", f"lift_{n}_across", f"lift_scatter_{n}_across"])) for n, sign in ((10, "+"), (14, ""), (20, "-"))),
    *((("cylinder_channel", f"| {n} | {{}} (+{{}} %) | {{}} ({sign}{{}} %) | {{}} (-{{}} %) | {{}} min",
        lambda scene, *names: mixed(scene, *names[:3]) + minutes(scene, names[3]),
        [f"drag_max_re_100_{n}", f"lift_max_re_100_{n}", f"strouhal_re_100_{n}", f"re_100_{n}"])) for n, sign in ((14, "+"), (20, "+"), (28, "-"))),
    ("cylinder_channel", "| 14, 40 around the cylinder | {} (+{} %) | {} (-{} %) | {} (-{} %) |", mixed,
     [f"{name}_re_100_14_to_40" for name in ("drag_max", "lift_max", "strouhal")]),
    ("cylinder_free", "28 around the cylinder | mean drag, lift, Strouhal number | {}, {}, {} |", sizes, [f"{name}_7_to_28" for name in ("drag", "lift", "strouhal")]),
    ("cylinder_free", "Re = 100, 10 per diameter | mean drag | {} |", sizes, ["drag_10_across"]),
    ("cylinder_free", "Re = 200, 10 per diameter | mean drag | {} |", sizes, ["drag_re_200"]),
    ("dam_break_3d", "mean pressure at P1 | {} |", sizes, ["P1_steady"]),
    ("dam_break_3d", "mean pressure at P3 | {} |", sizes, ["P3_steady"]),
    ("dam_break_elastic", "full width: peak of the tip | {} mm", sizes, ["full_width_tip_x_peak"]),
    ("dam_break_elastic", "full width: time of the peak | {} s", sizes, ["full_width_tip_x_peak_time"]),
    ("dam_break_elastic", "peak of the tip | {} mm at {} s", sizes, ["tip_x_peak", "tip_x_peak_time"]),
    ("dam_break_elastic", "two sides | {} % of the peak", figures, ["sides_differ_to_peak"]),
    ("elastic_gate", "coarser [mm] | - | - | {} |", sizes, ["12MPa_water_2.5_times_coarser_tip_x_peak"]),
    ("flexible_plate", "drag coefficient | {} +- {} |", sizes, ["drag", "drag_scatter"]),
    ("flexible_plate", "along the stream | {} +- {} b", sizes, ["dx", "dx_scatter"]),
    ("flexible_plate", "downward | {} +- {} b", sizes, ["dz", "dz_scatter"]),
    ("open_channel", "drag | {} (+{} %) | {} (+{} %) | {} (+{} %)", mixed, ["drag_re_20", "drag_re_100", "drag_re_100_short"]),
    ("open_channel", "lift amplitude | - | {} (-{} %) | {} (-{} %)", mixed, ["lift_amplitude_re_100", "lift_amplitude_re_100_short"]),
    ("open_channel", "mass flow out | {} | {} | {} |", sizes, ["out_re_20", "out_re_100", "out_re_100_short"]),
    ("plate_damping", "cubic, 1.5 | x | x | {} |", sizes, ["a5_a1_cubic_1.5_a0.05"]),
    ("plate_damping", "no artificial stress | {} |", sizes, ["a5_a1_nostress_1.3_a0"]),
    ("rolling_tank", "2 particles through the thickness | -{} mm at {} s", sizes, ["tip_left_baffle_2_across", "tip_left_time_baffle_2_across"]),
    ("rolling_tank", "the same, 3 particles | -{} mm", sizes, ["tip_left_baffle"]),
    ("rolling_tank", "the same, 4 particles | -{} mm", sizes, ["tip_left_baffle_4_across"]),
    ("rolling_tank", "oil at 2 mm | -{} mm | -{} mm", sizes, ["tip_left_baffle_coarse_oil", "tip_left_baffle"]),
    ("turek_hron_fsi", "(amplitude +{} %) | 1.34 +- {} [{}] (+{} %)",
     lambda scene, coarse, fine, rate: figures(scene, coarse) + sizes(scene, fine, rate) + figures(scene, fine),
     ["uy_amplitude_fsi2_2", "uy_amplitude_fsi2_4", "frequency_fsi2_4"]),
    ("turek_hron_fsi", "| 1.25 +- {} [{}] (+{} %)", lambda scene, size, rate: sizes(scene, size, rate) + figures(scene, size),
     ["uy_amplitude_fsi2_2_to_8", "frequency_fsi2_2_to_8"]),
    ("turek_hron_fsi", "| 2.23 +- {} [{}] (-{} %)", lambda scene, size, rate: sizes(scene, size, rate) + figures(scene, size),
     ["uy_amplitude_fsi3_2_to_8", "frequency_fsi3_2_to_8"]),
    ("turek_hron_fsi", "(amplitude -{} %) | 2.03 +- {} [{}] (+{} %)",
     lambda scene, coarse, fine, rate: figures(scene, coarse) + sizes(scene, fine, rate) + figures(scene, fine),
     ["uy_amplitude_fsi3_2", "uy_amplitude_fsi3_4", "frequency_fsi3_4"]),
    ("turek_hron_fsi", "(amplitude -{} %) | -2.6 +- {} (+{} %)",
     lambda scene, coarse, fine: figures(scene, coarse) + mixed(scene, fine), ["lift_amplitude_fsi3_2", "lift_amplitude_fsi3_4"]),
    ("twisting_column", "top | {} turns", sizes, ["largest_twist"]),
    ("twisting_column", "over the first | {} |", sizes, ["twist_the_other_way"]),
    *((("vortex_induced", f"| {u} | {{}} (-{{}} %) | {{}} (-{{}} %) |", mixed, [f"amplitude_{u}_8", f"amplitude_{u}_12"])) for u in (4, 6)),
    *((("vortex_induced", f"| {u} | {{}} (-{{}} %) | - |", mixed, [f"amplitude_{u}_8"])) for u in (5, 7)),
    *((("vortex_induced", f"| {u} | {{}} (", sizes, [f"amplitude_{u}_8"])) for u in (3, 8)),
    ("vortex_induced", "{} D and {} D in the last two spans", sizes, ["amplitude_8_8", "amplitude_before_8_8"]),
    *((("wedge_entry", f"{beta} degrees | force / (rho V^3 t) | {{}} | {{}} | {{}} (-{{}} %)",
        lambda scene, *names: sizes(scene, *names[:2]) + mixed(scene, names[2]), [f"force_{beta}_{n}" for n in (16, 25, 50)])) for beta in (30, 40)),
    *((("wedge_entry", f"| {{}} | {{}} | {{}} (-{{}} %) | {reference} |",
        lambda scene, *names: sizes(scene, *names[:2]) + mixed(scene, names[2]), [f"peak_pressure_{beta}_{n}" for n in (16, 25, 50)]))
      for beta, reference in ((30, "6.927"), (40, "3.266"))),
    ("wedge_entry", "standard deviation) | {} % | {} % | {} %", figures, [f"force_scatter_30_{n}" for n in (16, 25, 50)]),
    ("wedge_entry", "50 dx everywhere 70 s) | -{} % | {} %", figures, ["force_30_25_to_50", "force_scatter_30_25_to_50"]),
    ("wedge_entry", "water's lattice | +{} % | {} %", figures, ["force_30_25_lattice", "force_scatter_30_25_lattice"]),
    ("wedge_entry", "the default | -{} % | {} %", figures, ["force_30_25_guard_0.9", "force_scatter_30_25_guard_0.9"]),
    ("wedge_entry", "viscosity 0.02 | -{} % | {} %", figures, ["force_30_25_alpha_0.02", "force_scatter_30_25_alpha_0.02"]),
    ("wedge_entry", "120 particles over half of the width | {} % | {} %", figures, ["velocity_error_experiment_free_120", "velocity_error_code_free_120"]),
]
QUOTED += [(f"examples/{scene}/README.md", words, partial(kind, scene, *names)) for scene, words, kind, names in SCENES]


@pytest.mark.parametrize("page, words, numbers", QUOTED, ids=[f"{page}-{words[:40]}" for page, words, _ in QUOTED])
def test_quoted(page, words, numbers):
    """Each number is that of the data, rounded to the digits that the page gives."""
    pattern = re.escape(words).replace(r"\{\}", r"(\d+(?:\.\d+)?)").replace(r"\ ", r"\s+").replace("\\\n", r"\s+")
    found = re.search(pattern, (ROOT / page).read_text(encoding="utf-8"))
    assert found, f"{page} has no '{words}'"
    for said, value in zip(found.groups(), numbers(), strict=True):
        digits = len(said.partition(".")[2])
        assert abs(float(said) - value) <= 0.501 * 10.0 ** -digits, f"{page} says {said} in '{words}', the data {value:.4g}"


# ---- no row without a command ----

# Columns of tables of scenes' pages that hold no figures of a run
ASIDE = re.compile(r"reference|source|bound|published|experiment|code|et al\.|\band [A-Z]|particles along|time \[")
NUMBER = re.compile(r"(?<![\w.])(\d[\d,]*(?:\.\d+)?(?:e-?\d+)?)(?!\w)")
SCALES = (1e-3, 1.0, 1e2, 1e3, 1e6)  # a page may give another prefix of the unit, or per cent
# {scene: {how a row begins: the case that makes it, which the data do not have yet}}
AWAITED = {"turek_hron_fsi": {"| CFD3:": "cfd3_4"}}


def spread(text):
    """(number, how far it may be off for its last digit)"""
    mantissa, _, power = text.replace(",", "").partition("e")
    return float(f"{mantissa}e{power or 0}"), 0.501 * 10.0 ** (int(power or 0) - len(mantissa.partition(".")[2]))


def data_of(scene):
    """All values that commands wrote of a scene: figures, references, errors, particles and times; and those of its sweep."""
    summary = summary_of(scene)
    found = [f[key] for f in summary["figures"] for key in ("value", "reference", "relative_error")]
    for case in [summary, *summary.get("cases", {}).values()]:
        found += [case["particles"], case["cpu_seconds"], case["cpu_seconds"] / 60]
    if (ROOT / "doc/cost" / f"{scene}.csv").exists():
        found += [float(row[key]) for row in rows(scene) for key in ("value", "error") if row[key]]
    return [abs(x) for x in found if x is not None]


def result_rows(text):
    """Rows of the tables of results of a page: (row, [(number of a cell with figures, whether of one with per cents)], all its numbers)"""
    heads = None
    for line in text.split("## Results")[1].split("\n## ")[0].splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")] if line.startswith("|") else None
        if heads and cells and set(line) - set("|-: "):
            own = [(n, "%" in cell) for head, cell in zip(heads[1:], cells[1:]) if not ASIDE.search(head) for n in NUMBER.findall(cell)]
            yield line, own, [n for cell in cells for n in NUMBER.findall(cell)]
        heads = heads if heads and cells else cells


def unknown(numbers, beside, data):
    """Those of a row that are no value of the data, nor the deviation of two of its numbers from each other [per cent]"""
    def known(text, share):
        n, off = spread(text)
        if any(abs(n - scale * value) <= off for value in data for scale in SCALES):
            return True
        pairs = ((spread(a), spread(b)) for a in beside for b in beside if share and a != b)
        return any(abs(n - 100 * abs(a / b - 1)) <= off + 100 * a / b * (da / a + db / b) for (a, da), (b, db) in pairs if a and b)
    return [text for text, share in numbers if not known(text, share)]


RAN = json.loads((ROOT / "doc/results/results.json").read_text(encoding="utf-8"))["scenes"]
PAGES = sorted(path.parent.name for path in ROOT.glob("examples/*/README.md") if path.parent.name in RAN)  # one that is new waits for its run


@pytest.mark.parametrize("scene", PAGES)
def test_rows_have_a_command(scene):
    """Each figure in a table of results is one of those that commands wrote; a row of a case that is new waits for its run."""
    cases = ROOT / "examples" / scene / "cases.json"
    waiting = {start for start, case in AWAITED.get(scene, {}).items()
               if case in json.loads(cases.read_text()) and case not in summary_of(scene)["cases"]}
    data = data_of(scene) + (data_of("gate_static") if scene == "elastic_gate" else [])
    wrong = {row: found for row, *numbers in result_rows((ROOT / "examples" / scene / "README.md").read_text(encoding="utf-8"))
             if not any(row.startswith(start) for start in waiting) and (found := unknown(*numbers, data))}
    assert not wrong, f"no command made these numbers: {wrong}"


def test_a_row_without_a_command_is_seen():
    table = "## Results\n| quantity | computed | reference |\n|---|---|---|\n| drag | 1.511 (+4.4 %) | 1.45 |\n| lift | 0.512 | 0.61 |\n\n## Deviations\n"
    assert [unknown(own, every, [1.5111, 0.0436]) for _, own, every in result_rows(table)] == [[], ["0.512"]]
