"""Numbers that pages quote are those of the data that commands wrote."""

import csv
import json
import re

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


def figures(scene, *names):
    """[error in per cent, its size; of a figure that is an error itself the value] in doc/results."""
    summary = json.loads((ROOT / "doc/results/results.json").read_text(encoding="utf-8"))["scenes"][scene]["summary"]
    found = {f["name"]: f for f in summary["figures"]}
    return [100 * abs(found[n]["value"] / found[n]["reference"] - 1 if found[n]["reference"] else found[n]["value"]) for n in names]


TL = r"TL quadratic, "    # with a column held
WATER = ("fluid", "shifting"), ("fluid", "shifting, every 4 steps"), ("fluid", "free-surface rule"), ("fluid", "free-surface rule, every 10 steps")
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
    ("doc/choosing.md", "{}, {} % of the speed", lambda: curve("taylor_green", "shifting, quintic", 0.04, 0.025)),
    ("doc/choosing.md", "{}, {} % of the period | 10, 20 rows", lambda: curve("standing_wave", "quintic 1.0", 0.05, 0.025)),
    ("doc/choosing.md", "{}, {} % of the pressure", lambda: curve("still_water", "quintic 0.94", 0.05, 0.025)),
    ("doc/choosing.md", "{}, {}, {} % of the front", lambda: figures("dam_break", "front_error_code_20", "front_error_code_40", "front_error_code_80")),
    ("doc/choosing.md", "{}, {}, {} % of the length", lambda: figures("taylor_bar", *(f"final_length_{n}_across" for n in (4, 6, 8)))),
    ("doc/choosing.md", "{}, {} % of the period | 5, 10; 3 fails", lambda: curve("oscillating_plate", r"UL quadratic, hourglass, ", 5, 10)),
    ("doc/choosing.md", "linear ones err by {} %", lambda: curve("oscillating_plate", "TL linear, ", 5)),
    ("doc/choosing.md", "the gate bends {} % too little with 2", lambda: curve("elastic_gate", "TL$", 0.0025)),
    ("doc/choosing.md", "+{} % instructions of a solid alone, +{} % of the gate", lambda: [effect("total", "hourglass control"), effect("gate", "hourglass control")]),
    ("doc/choosing.md", "0.7 % become 3.9 %; +{} % instructions", lambda: [effect(*WATER[0])]),
    ("doc/choosing.md", "+{} % instructions instead of +{} % |\n| *density/surface*", lambda: [effect(*WATER[1]), effect(*WATER[0])]),
    ("doc/choosing.md", "+{} % instructions instead of +{} % |\n| *spacing*", lambda: [effect(*WATER[3]), effect(*WATER[2])]),
    ("doc/src/fix_fsi.rst", "the rule adds {} % to the instructions of a step\nof plain water instead of {} %", lambda: [effect(*WATER[3]), effect(*WATER[2])]),
    ("doc/src/pair_fsi_fluid.rst", "it adds {} % to the instructions of plain water instead of {} %", lambda: [effect(*WATER[1]), effect(*WATER[0])]),
    ("doc/src/pair_fsi_solid_tl.rst", "a solid alone takes {} times", lambda: [1 + effect("total", "hourglass control") / 100]),
    ("doc/src/pair_fsi_solid_tl.rst", "its water {} times", lambda: [1 + effect("gate", "hourglass control") / 100]),
]


@pytest.mark.parametrize("page, words, numbers", QUOTED, ids=[f"{page}-{words[:40]}" for page, words, _ in QUOTED])
def test_quoted(page, words, numbers):
    """Each number is that of the data, rounded to the digits that the page gives."""
    pattern = re.escape(words).replace(r"\{\}", r"(\d+(?:\.\d+)?)").replace(r"\ ", r"\s+").replace("\\\n", r"\s+")
    found = re.search(pattern, (ROOT / page).read_text(encoding="utf-8"))
    assert found, f"{page} has no '{words}'"
    for said, value in zip(found.groups(), numbers(), strict=True):
        digits = len(said.partition(".")[2])
        assert abs(float(said) - value) <= 0.501 * 10.0 ** -digits, f"{page} says {said} in '{words}', the data {value:.4g}"
