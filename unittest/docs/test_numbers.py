"""Numbers that pages quote are those of the data that commands wrote."""

import csv
import json
import re
import sys
from functools import partial

import pytest

from fsi import paths, results

ROOT = paths.ROOT
sys.path.insert(0, str(ROOT / "bench"))
from typed_numbers import changed, data_of, here, in_prose, in_tables, spread  # noqa: E402


def rows(name):
    with open(ROOT / "doc/cost" / f"{name}.csv", encoding="utf-8", newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def effect(scene, name):
    """Instructions that naming an effect adds, in per cent."""
    row, = (row for row in rows("effects") if (row["scene"], row["effect"]) == (scene, name))
    return 100 * float(row["instructions"])


def curve(scene, method, *at):
    """[error in per cent, its size] of a method's runs; method: how its name begins."""
    found = {float(row["x"]): row for row in rows(scene) if row["role"] == "curve"
             and re.match(method, row["group"])}
    return [100 * abs(float(found[x]["error"])) for x in at]


def seconds(scene, method, *at):
    found = {float(row["x"]): row for row in rows(scene) if row["role"] == "curve"
             and re.match(method, row["group"])}
    return [float(found[x]["cpu_seconds"]) for x in at]


def run_of(scene, label):
    """[error in per cent] of a run of a sweep, by its label."""
    row, = (row for row in rows(scene) if row["label"] == label)
    return [100 * abs(float(row["error"]))]


def fails(scene, knob):
    """The lowest setting of a keyword with which a sweep's runs failed."""
    return min(float(row["x"]) for row in rows(scene) if row["group"] == knob and row["status"]
               == "failed")


def sound(scene, *names):
    """[value at 10, 20 and, where it was run, 40 times the speed of the flow, for each name]"""
    found = {(row["times"], row["figure"]): float(row["value"]) for row in rows("sound")
             if row["scene"] == scene}
    return [found[times, name] for times in ("10", "20", "40") if (times, names[0]) in found
            for name in names]


def hard(run):
    """[value in per cent] of a hard case's run."""
    with open(ROOT / "doc/hard/hard.csv", encoding="utf-8", newline="") as file:
        return [100 * float(row["value"])
                for row in csv.DictReader(line for line in file if not line.startswith("#"))
                if (row["run"], row["recipe"]) == (run, "best")]


def summary_of(scene):
    return json.loads(
        (ROOT / "doc/results/results.json").read_text(encoding="utf-8"))["scenes"][scene]["summary"]


def figures(scene, *names):
    """[error in per cent, its size; of a figure that is an error itself the value] in
    doc/results."""
    found = {f["name"]: f for f in summary_of(scene)["figures"]}
    return [100 * abs(found[n]["value"] / found[n]["reference"] - 1 if found[n]["reference"]
                      else found[n]["value"]) for n in names]


def sizes(scene, *names):
    """[size of a figure, in its unit] in doc/results."""
    found = {f["name"]: f for f in summary_of(scene)["figures"]}
    return [abs(found[n]["value"]) for n in names]


def reference(scene, name):
    return next(f["reference"] for f in summary_of(scene)["figures"] if f["name"] == name)


def minutes(scene, *names):
    """[processor time of a case] in doc/results."""
    return [summary_of(scene)["cases"][n]["cpu_seconds"] / 60 for n in names]


def mixed(scene, *names):
    """[size, error in per cent, size, error ...] of figures."""
    return [x for n in names for x in sizes(scene, n) + figures(scene, n)]


def timed(scene, method, *at):
    """[error in per cent, seconds, ...] of a method's runs, each pair of one run."""
    return [x for pair in zip(curve(scene, method, *at), seconds(scene, method, *at)) for x in pair]


def timed_cases(scene, pairs, per_minute):
    """The same of cases in doc/results: pairs of a figure and its case."""
    return [x for name, case in pairs
            for x in (*figures(scene, name), per_minute * minutes(scene, case)[0])]


TL = r"TL quadratic, "    # with a column held
WATER = ("fluid", "shifting"), ("fluid", "shifting, every 4 steps")
# page, the words around the numbers ({} stands for one), the numbers
QUOTED = [
    *(("doc/choosing.md", words, partial(timed, *of)) for words, *of in (
        ("through the thickness: {} % in {} s; 5: {} % in {} s; 10: {} % in {} s",
         "oscillating_plate", TL, 3, 5, 10),
        ("deflection, 3 particles: {} % in {} s; 5: {} % in {} s, where the error changes its "
         "sign; 6: {} % in {} s", "hydrostatic_plate", "quadratic$", 3, 5, 6),
        ("peak, 2 particles: {} % in {} s; 3: {} % in {} s; 4: {} % in {} s", "elastic_gate", "TL$",
         0.0025, 0.00166666667, 0.00125),
        ("peak, 3 particles: {} % in {} s, where the error changes its sign; 4: {} % in {} s",
         "elastic_gate", "TL, water twice", 0.00166666667, 0.00125),
        ("along a side: {} % in {} s; 40: {} % in {} s", "taylor_green", "shifting, quintic", 0.04,
         0.025),
        ("period, 10 rows deep: {} % in {} s; 20: {} % in {} s", "standing_wave", "quintic 1.0",
         0.05, 0.025),
        ("pressure, 10 rows deep: {} % in {} s; 20: {} % in {} s", "still_water", "waves", 0.05,
         0.025),
        ("period, 5 particles: {} % in {} s; 10: {} % in {} s; 3 fails", "oscillating_plate",
         r"UL quadratic, hourglass, ", 5, 10))),
    ("doc/choosing.md", "the experiment is {} % off",
     lambda: figures("elastic_gate", "12MPa_tip_x_peak")),
    *(("doc/choosing.md", words, partial(timed_cases, scene, pairs, unit))
      for words, scene, pairs, unit in (
        ("amplitude, 10 particles per diameter: {} % in {} min", "turek_hron_fsi",
         [("uy_amplitude_fsi2_2", "fsi2_2")], 1),
        ("drag, 14 per diameter: {} % in {} min; 20: {} % in {} min; 28: {} % in {} min",
         "cylinder_channel",
         [(f"drag_max_re_100_{n}", f"re_100_{n}") for n in (14, 20, 28)], 1),
        ("there: amplitude {} % in {} min", "turek_hron_fsi",
         [("uy_amplitude_fsi2_2_to_8", "fsi2_2_to_8")], 1),
        ("drag of the cylinder {} % in {} min", "cylinder_channel",
         [("drag_max_re_100_14_to_40", "re_100_14_to_40")], 1),
        ("front, 20 rows high: {} % in {} s; 40: {} % in {} s; 80: {} % in {} s", "dam_break",
         [("front_error_code_20", "best_20"), ("front_error_code_40", "best_40_serial"),
          ("front_error_code_80", "best")], 60),
        ("over the diameter: {} % in {} s; 6: {} % in {} s; 8: {} % in {} s", "taylor_bar",
         [(f"final_length_{n}_across", f"{n}_across") for n in (4, 6, 8)], 60))),
    ("doc/choosing.md", "experiments differ by {} to {} %", lambda: figures(
        "dam_break", "front_error_experiment_koshizuka_oka_dualsphysics",
        "front_error_experiment_martin_moyce_29mm")),
    ("README.md", "a sphere is {} % off with 16", lambda: figures("sphere", "drag_16_levels")),
    ("README.md", "a plate by {} % in its period",
     lambda: figures("oscillating_plate", "period_5_cut_10")),
    ("doc/choosing.md", "linear ones err by {} %",
     lambda: curve("oscillating_plate", "TL linear, ", 5)),
    ("doc/choosing.md", "gate: {} % change of the peak with water 2.5 times coarser",
     lambda: figures("elastic_gate", "12MPa_water_2.5_times_coarser_tip_x_peak")),
    ("doc/src/tutorial_gate.rst", "is the same to {} %, in a third of the time",
     lambda: figures("elastic_gate", "12MPa_water_2.5_times_coarser_tip_x_peak")),
    ("doc/src/tutorial_gate.rst", "In plane stress the peak is {} mm, as with",
     lambda: sizes("elastic_gate", "12MPa_plane_stress_tip_x_peak_in_codes")),
    ("doc/src/tutorial_gate.rst", "the peak is within {} % of the finest run",
     lambda: [max(curve("elastic_gate", "TL$", 0.00166666667, 0.00125))]),
    ("doc/src/tutorial_gate.rst", "The largest displacement of the tip is {} mm",
     lambda: sizes("elastic_gate", "12MPa_tip_x_peak")),
    ("doc/src/pair_fsi_fluid.rst", "with it the volume is right to {} % in 2D",
     lambda: hard("settle_2d")),
    ("doc/src/tutorial_gate.rst", "The peak grows by {} mm",
     lambda: [sizes("elastic_gate", "10MPa_tip_x_peak")[0]
              - sizes("elastic_gate", "12MPa_tip_x_peak")[0]]),
    ("doc/choosing.md", "the gate bends {} % too little with 2",
     lambda: curve("elastic_gate", "TL$", 0.0025)),
    ("doc/choosing.md", "+{} % instructions of a solid alone, +{} % of the gate",
     lambda: [effect("total", "hourglass control"), effect("gate", "hourglass control")]),
    ("doc/choosing.md", "0.7 % become 3.3 %; +{} % instructions", lambda: [effect(*WATER[0])]),
    ("doc/choosing.md", "+{} % instructions, every 4 steps +{} %",
     lambda: [effect(*WATER[0]), effect(*WATER[1])]),
    ("doc/src/pair_fsi_fluid.rst",
     "it adds {} % to the instructions of plain water instead of {} %",
     lambda: [effect(*WATER[1]), effect(*WATER[0])]),
    ("doc/src/pair_fsi_solid_tl.rst", "a solid alone takes {} times",
     lambda: [1 + effect("total", "hourglass control") / 100]),
    ("doc/src/pair_fsi_solid_tl.rst", "its water {} times",
     lambda: [1 + effect("gate", "hourglass control") / 100]),
    ("doc/choosing.md", "| {} % become {} % at 5 particles",
     lambda: curve("oscillating_plate", "TL quadratic$", 5) + curve("oscillating_plate", TL, 5)),
    ("doc/choosing.md", "four particles through the thickness errs by {} %",
     lambda: curve("oscillating_plate", TL, 4)),
    ("doc/choosing.md", "volume error of {} % after a fall", lambda: hard("settle_3d")),
    ("doc/choosing.md", "Taylor-Green: {} % at 2, {} to {} % from 5 to 10, {} % at 40",
     lambda: [x for c in (2, 7, 5, 40)
              for x in run_of("taylor_green", f"sound speed over U = {c}")]),
    ("doc/choosing.md", "Taylor-Green: {} % at 0.25, 0.5, and 1; fails at {}", lambda: [
        *run_of("taylor_green", "Courant number = 0.5"), fails("taylor_green", "Courant number")]),
    ("doc/choosing.md", "to 0.7, fails at {}; gate: fails at {} |", lambda: [
        fails("oscillating_plate", "Courant number, TL"),
        fails("elastic_gate", "Courant number of the rubber")]),
    ("doc/choosing.md", "bends {} % off at 0.49 and {} % at 0.499", lambda: hard("lock_4_0.49")
     + hard("lock_4_0.499")),
    ("doc/choosing.md",
     "still water: {} %; without diffusion {} %, by summation {} %; +{} % instructions",
     lambda: [*curve("still_water", "quintic 1.0", 0.05),
              *run_of("still_water", "no density diffusion"),
              *run_of("still_water", "density by summation"),
              effect("fluid", "density diffusion")]),
    ("doc/choosing.md", "Taylor-Green: {} % become {} %; wave: {} % become {} %",
     lambda: [*run_of("taylor_green", "no shifting"),
              *curve("taylor_green", "shifting, quintic", 0.025),
              *curve("standing_wave", "quintic 1.0", 0.05),
              *run_of("standing_wave", "shifting 0.5")]),
    ("doc/choosing.md", "displacement [mm]; its time [s] | {}; {} | {}; {} | {}; {} |",
     lambda: sound("elastic_gate", "tip_x_peak", "tip_x_peak_time")),
    ("doc/choosing.md", "frequency [rad/s] | {} | {} | {} |",
     lambda: sound("ring_annulus", "frequency")),
    ("doc/choosing.md", "peak pressure / (rho V^2/2) | {}; {} | {}; {} | {}; {} |",
     lambda: sound("wedge_entry", "force", "peak_pressure")),
    ("doc/choosing.md", "first pulse [mm^2]; distance of the tips [mm] | {}; {} | {}; {} | - |",
     lambda: sound("valve", "forward_1", "opening_1")),
    ("doc/choosing.md", "flag (FSI2), 10 per diameter: amplitude [mm] | {} | {} | - |",
     lambda: sound("turek_hron_fsi", "uy_amplitude")),
    ("doc/choosing.md",
     "errs by {} % with 20 and by {} % with 10.\nWith 20 and the *shift* of 10 it errs by {} %",
     lambda: [
        100 * (a / reference("turek_hron_fsi", "uy_amplitude_fsi2_2") - 1.0)
        for a in sound("turek_hron_fsi", "uy_amplitude")[::-1]] +
        run_of("turek_hron_fsi", "sound speed over the largest inflow = 20")),
    ("README.md", "drag is {} % and lift {} % off",
     lambda: figures("cylinder_free", "drag_re_200", "lift_re_200")),
    ("doc/src/Howto_peers.rst",
     "here {} % with 40 particles per diameter at the flag, {} % with 20, and {} % with 10",
     lambda: figures("turek_hron_fsi", *(f"uy_amplitude_fsi3_{n}" for n in ("2_to_8", "4", "2")))),
    ("unittest/hard/README.md", "obstacle is {} % off", lambda: hard("obstacle")[-1:]),
    ("examples/oscillating_plate/README.md", "Without it, it is too soft by {} % with 5 particles",
     lambda: run_of("oscillating_plate", "hourglass control, TL = 0")),
]


# The same of the scenes' own pages: scene, words, what the numbers are, the figures
SCENES = [
    ("bending_column", "displacement | {} m (+{} %) | {} m (+{} %)", mixed, ["peak_6", "peak_10"]),
    ("bending_column", "zero | {} s (+{} %) | {} s (+{} %)", mixed,
     ["zero_crossing_6", "zero_crossing_10"]),
    *((("cylinder_channel", f"| {n} | {{}} ({sign}{{}} %) | {{}} | {{}} | {{}} |",
        lambda scene, drag, *more: mixed(scene, drag) + sizes(scene, *more),
        [f"drag_{n}_across", f"drag_scatter_{n}_across", f"lift_{n}_across",
         f"lift_scatter_{n}_across"])) for n, sign in ((10, "-"), (14, "+"), (20, "-"))),
    *((("cylinder_channel", f"| {n} | {{}} (+{{}} %) | {{}} (+{{}} %) | {{}} (-{{}} %) | {{}} min",
        lambda scene, *names: mixed(scene, *names[:3]) + minutes(scene, names[3]),
        [f"drag_max_re_100_{n}", f"lift_max_re_100_{n}", f"strouhal_re_100_{n}", f"re_100_{n}"]))
      for n in (14, 20, 28)),
    ("cylinder_channel", "| 14, 40 around the cylinder | {} (+{} %) | {} (+{} %) | {} (-{} %) |",
     mixed,
     [f"{name}_re_100_14_to_40" for name in ("drag_max", "lift_max", "strouhal")]),
    ("cylinder_free", "28 around the cylinder | mean drag, lift, Strouhal number | {}, {}, {} |",
     sizes, [f"{name}_7_to_28" for name in ("drag", "lift", "strouhal")]),
    ("cylinder_free",
     "lift is {} % and drag {} % too large, and the Strouhal number is right to {} %", figures,
     ["lift_7_to_28", "drag_7_to_28", "strouhal_7_to_28"]),
    ("cylinder_free", "Re = 100, 10 per diameter | mean drag | {} |", sizes, ["drag_10_across"]),
    ("cylinder_free", "Re = 200, 10 per diameter | mean drag | {} |", sizes, ["drag_re_200"]),
    ("dam_break_3d", "mean pressure at P1 | {} |", sizes, ["P1_steady"]),
    ("dam_break_3d", "mean pressure at P3 | {} |", sizes, ["P3_steady"]),
    ("dam_break_elastic", "full width: peak of the tip | {} mm", sizes, ["full_width_tip_x_peak"]),
    ("dam_break_elastic", "full width: time of the peak | {} s", sizes,
     ["full_width_tip_x_peak_time"]),
    ("dam_break_elastic", "peak of the tip | {} mm at {} s", sizes,
     ["tip_x_peak", "tip_x_peak_time"]),
    ("dam_break_elastic", "through walls, in the plate | {}, {} |", sizes,
     ["particles_leaked", "particles_inside_plate"]),
    ("dam_break_elastic", "twice as coarse: peak of the tip | {} mm | {} mm | +{} %",
     lambda scene, *names: sizes(scene, *names) + figures(scene, names[0]),
     ["coarse_water_tip_x_peak", "tip_x_peak"]),
    ("dam_break_elastic", "two sides | {} % of the peak", figures, ["sides_differ_to_peak"]),
    ("elastic_gate", "coarser [mm] | - | - | {} |", sizes,
     ["12MPa_water_2.5_times_coarser_tip_x_peak"]),
    *(("flexible_plate", f"{words} | {{}} +- {{}} (+{{}} %) | {{}} +- {{}} (+{{}} %)",
       lambda scene, name: [x for case in ("uniform", "levels")
                            for x in (*sizes(scene, f"{name}_{case}", f"{name}_scatter_{case}"),
                                      *figures(scene, f"{name}_{case}"))], [name])
      for words, name in (("drag coefficient", "drag"), ("along the stream [b]", "dx"),
                          ("downward [b]", "dz"))),
    ("open_channel", "drag | {} (+{} %) | {} (+{} %) | {} (+{} %)", mixed,
     ["drag_re_20", "drag_re_100", "drag_re_100_short"]),
    ("open_channel", "lift amplitude | - | {} (-{} %) | {} (-{} %)", mixed,
     ["lift_amplitude_re_100", "lift_amplitude_re_100_short"]),
    ("open_channel", "mass flow out | {} | {} | {} |", sizes,
     ["out_re_20", "out_re_100", "out_re_100_short"]),
    ("plate_damping", "cubic, 1.5 | x | x | {} |", sizes, ["a5_a1_cubic_1.5_a0.05"]),
    ("plate_damping", "no artificial stress | {} |", sizes, ["a5_a1_nostress_1.3_a0"]),
    ("rolling_tank", "2 particles through the thickness | -{} mm at {} s", sizes,
     ["tip_left_baffle_2_across", "tip_left_time_baffle_2_across"]),
    ("rolling_tank", "the same, 3 particles | -{} mm", sizes, ["tip_left_baffle"]),
    ("rolling_tank", "the same, 4 particles | -{} mm", sizes, ["tip_left_baffle_4_across"]),
    ("rolling_tank", "oil at 2 mm | -{} mm | -{} mm", sizes,
     ["tip_left_baffle_coarse_oil", "tip_left_baffle"]),
    *((("turek_hron_fsi", f"| uy | {lead}{{}} +- {{}} [{{}}] (amplitude {signs[0]}{{}} %) | {{}} "
        f"+- {{}} [{{}}] ({signs[1]}{{}} %) | {{}} +- {{}} [{{}}] ({signs[2]}{{}} %) |",
        lambda scene, *runs: [x for n in runs for x in (
            *sizes(scene, f"uy_mean_{n}", f"uy_amplitude_{n}", f"frequency_{n}"),
            *figures(scene, f"uy_amplitude_{n}"))],
        [f"{kind}_{n}" for n in ("2", "4", "2_to_8")]))
      for kind, lead, signs in (("fsi2", "", "+++"), ("fsi3", "-", "-++"))),
    ("turek_hron_fsi",
     "| lift | -{} +- {} (amplitude +{} %) | -{} +- {} (+{} %) | {} +- {} (+{} %) |",
     lambda scene, *runs: [x for n in runs for x in (*sizes(scene, f"lift_mean_{n}"),
                                                     *mixed(scene, f"lift_amplitude_{n}"))],
     ["fsi3_2", "fsi3_4", "fsi3_2_to_8"]),
    ("twisting_column", "top | {} turns", sizes, ["largest_twist"]),
    ("twisting_column", "over the first | {} |", sizes, ["twist_the_other_way"]),
    *((("vortex_induced", f"| {u} | {{}} (-{{}} %) | {{}} (-{{}} %) | {{}} ({sign}{{}} %) |", mixed,
        [f"amplitude_{u}_{n}" for n in ("8", "12", "7_to_28")]))
      for u, sign in ((4, "+"), (6, "+"))),
    ("vortex_induced", "| 5 | {} (-{} %) | - |", mixed, ["amplitude_5_8"]),
    ("vortex_induced", "| 7 | {} (-{} %) | - | {} (-{} %) |", mixed,
     ["amplitude_7_8", "amplitude_7_7_to_28"]),
    *((("vortex_induced", f"| {u} | {{}} (", sizes, [f"amplitude_{u}_8"])) for u in (3, 8)),
    ("vortex_induced", "it is {} D over the last 20 D/U and {} D over the 20 D/U before", sizes,
     ["amplitude_8_8", "amplitude_before_8_8"]),
    *((("wedge_entry", f"{beta} degrees | force / (rho V^3 t) | {{}} | {{}} | {{}} (-{{}} %)",
        lambda scene, *names: sizes(scene, *names[:2]) + mixed(scene, names[2]),
        [f"force_{beta}_{n}" for n in (16, 25, 50)])) for beta in (30, 40)),
    *((("wedge_entry", f"| {{}} | {{}} | {{}} (-{{}} %) | {reference} |",
        lambda scene, *names: sizes(scene, *names[:2]) + mixed(scene, names[2]),
        [f"peak_pressure_{beta}_{n}" for n in (16, 25, 50)]))
      for beta, reference in ((30, "6.927"), (40, "3.266"))),
    ("wedge_entry", "standard deviation) | {} % | {} % | {} %", figures,
     [f"force_scatter_30_{n}" for n in (16, 25, 50)]),
    ("wedge_entry", "water's lattice | +{} % | {} %", figures,
     ["force_30_25_lattice", "force_scatter_30_25_lattice"]),
    ("wedge_entry", "the default | -{} % | {} %", figures,
     ["force_30_25_guard_0.9", "force_scatter_30_25_guard_0.9"]),
    ("wedge_entry", "through the plate: {}, {}, {} mm. Reference: {} mm",
     lambda scene, *names: sizes(scene, *names) + [9.92503],
     [f"deflection_elastic_{n}" for n in (4, 8, 16)]),
    ("wedge_entry", "120 particles over half of the width | {} % | {} %", figures,
     ["velocity_error_experiment_free_120", "velocity_error_code_free_120"]),
]
QUOTED += [(f"examples/{scene}/README.md", words, partial(kind, scene, *names))
           for scene, words, kind, names in SCENES]


@pytest.mark.parametrize("page, words, numbers", QUOTED,
                         ids=[f"{page}-{words[:40]}" for page, words, _ in QUOTED])
def test_quoted(page, words, numbers):
    """Each number is that of the data, rounded to the digits that the page gives."""
    pattern = re.escape(words).replace(r"\{\}", r"(\d+(?:\.\d+)?)").replace(r"\ ", r"\s+").replace(
        "\\\n", r"\s+")
    found = re.search(pattern, (ROOT / page).read_text(encoding="utf-8"))
    assert found, f"{page} has no '{words}'"
    for said, value in zip(found.groups(), numbers(), strict=True):
        digits = len(said.partition(".")[2])
        assert (abs(float(said) - value) <= 0.501
                * 10.0 ** -digits), f"{page} says {said} in '{words}', the data {value:.4g}"


@pytest.mark.parametrize("scene, knob, lowest, highest, apart",
                         [("taylor_green", "Courant number", 0.25, 1.0, 0.07),
                          ("oscillating_plate", "Courant number, TL", 0.1, 0.7, 0.05),
                                                               ("taylor_green", "neighbour skin",
                                                                0.05, 1.0, 1e-6)])
def test_settings_said_to_be_alike_are(scene, knob, lowest, highest, apart):
    """doc/choosing.md, "By keyword": the figure is the same over the range."""
    figures = [float(row["value"]) for row in rows(scene) if row["group"] == knob and lowest
               <= float(row["x"]) <= highest]
    assert len(figures) > 2 and max(figures) < (1 + apart) * min(figures)


def test_rings_remain_symmetric():
    """doc/choosing.md, contact: 1e-9 dx."""
    assert all(size < 1e-9 for size in sizes("colliding_rings", "asymmetry_slow", "asymmetry_fast",
                                             "asymmetry_slow_ul"))


# ---- no number without a command ----

# Numbers in the text of results and deviations that are no figures of a run: settings, lengths,
# places; closed forms and what others computed; what tests or reference data give; what follows
# from numbers of the page. Nothing compares these.
NOT_COMPARED = {
    "beam": "1.7", "cylinder_free": "7", "dam_break": "0.267", "flexible_plate": "0.1",
    "floating_flap": "1.4", "gate_static": "0.8",
    "lid_driven_cavity": "0.9063", "plate_crossflow": "14.7", "plate_damping": "0.04",
    "ring_annulus": "1.5 0.1", "rolling_tank": "1.4 0.8 1.5",
    "settling_disc": "2", "standing_wave": "3.6", "submerged_plate": "1.4 5.5 0.8",
    "turek_hron_csm": "1.0948 0.005 1.094", "twisting_column": "4",
    "valve": "3 0.5", "wedge_entry": "1.97 8.96"}
RAN = json.loads((ROOT / "doc/results/results.json").read_text(encoding="utf-8"))["scenes"]
# one that is new waits for its run
PAGES = sorted(path.parent.name for path in ROOT.glob("examples/*/README.md")
               if path.parent.name in RAN)


def page(scene):
    return (ROOT / "examples" / scene / "README.md").read_text(encoding="utf-8")


def unknown(number, data):
    """Whether it is no value of the data, nor the deviation of two numbers of its row from each
    other [per cent]"""
    if any(number.fits(kind, value) for _, kind, value in data):
        return False
    n, off = spread(number.text)
    pairs = ((spread(a), spread(b)) for a in number.beside for b in number.beside if number.share
             and a != b)
    return not any(abs(n - 100 * abs(a / b - 1)) <= off + 100 * a / b * (da / a + db / b)
                   for (a, da), (b, db) in pairs if a and b)


@pytest.mark.parametrize("scene", PAGES)
def test_numbers_have_a_command(scene):
    """Each figure in a table of results, and each per cent and decimal in the text, is one of those
    that commands wrote."""
    data = data_of(scene, here) + (data_of("gate_static", here) if scene == "elastic_gate" else [])
    wrong = [(n.line, n.text, n.row) for n in in_tables(page(scene)) if unknown(n, data)]
    assert not wrong, f"no command made these numbers: {wrong}"
    strange = [n.text for n in in_prose(page(scene)) if unknown(n, data)]
    assert strange == NOT_COMPARED.get(
        scene, "").split(), f"no command made those of {strange} that are not in NOT_COMPARED"


TABLE = ("## Results\n| quantity | computed | reference | CPU |\n|---|---|---|---|\n"
         "| drag | 1.511 (+4.4 %) | 1.45 | 7 s |\n| lift | 0.512 | 0.61 | 65 s |\n")
DRAG = [("drag", "value", 1.5111), ("drag", "share", 0.0436), ("all cases", "time", 7.2),
        ("mean", "value", 64.9)]


def test_a_number_without_a_command_is_seen():
    """A wrong figure, a time that is another figure, and what the text says."""
    text = (TABLE + "\nThe scatter is 3.3 %, of 16 particles.\n\n## Deviations\n"
            "Drag is 4.4 % too large, lift by 2.5 b.\n\n## References\nA 12.5 (1994).\n")
    assert [n.text for n in in_tables(text) if unknown(n, DRAG)] == ["0.512", "65"]
    assert [n.text for n in in_prose(text) if unknown(n, DRAG)] == ["3.3", "2.5"]


def test_numbers_that_data_have_changed_are_named():
    """bench/typed_numbers.py lists what a renewal of the data makes of numbers that are typed; what
    rounds to the same is not named."""
    new = [("drag", "value", 1.5138), ("drag", "share", 0.0437), ("all cases", "time", 9.0),
           ("mean", "value", 64.9)]
    assert [(n.line, n.text, says) for n, says in changed(TABLE, DRAG, new)] == [
        (4, "1.511", {"1.514": {"drag"}}), (4, "7", {"9": {"all cases"}})]
    assert changed(TABLE, DRAG, DRAG) == [] and changed(TABLE, DRAG, [])[0][1] == {"gone": {"drag"}}


@pytest.mark.parametrize("scene", PAGES)
def test_times_of_commands_are_renewed(scene):
    """Each time behind a command of a page is one that tools/renew writes anew; of a case that is
    new once it has run."""
    cases = ROOT / "examples" / scene / "cases.json"
    names = json.loads(cases.read_text()) if cases.exists() else ()
    ran = {"cpu_seconds": 54321.0, "ranks": 1,
           "cases": {case: {"cpu_seconds": 54321.0, "ranks": 1} for case in names}}
    lines = page(scene).splitlines()
    after = results.run_times(page(scene), scene, ran).splitlines()
    typed = [line for line, new in zip(lines, after) if line.startswith(("tools/", "lmp "))
             and re.search(r"\b[\d.]+ (?:s|min)\b", line) and line == new]
    assert not typed, f"tools/renew does not find the times of {typed}"
