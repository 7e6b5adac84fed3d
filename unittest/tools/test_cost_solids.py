"""tools/cost solids: each variant runs, and what is made of the measurements."""

import sys

import pytest

from fsi import paths

sys.path.insert(0, str(paths.ROOT / "bench"))
import effects  # noqa: E402
import measure  # noqa: E402
import solid_variants  # noqa: E402


@pytest.mark.parametrize("dim", [2, 3])
def test_each_variant_runs(dim, monkeypatch):
    monkeypatch.setattr(solid_variants, "SIZE", {2: (8, 7), 3: (6, 5, 5)})
    text = "clear\n".join(f"{solid_variants.deck(dim, *variant)}run 2\n"
                          for variant in solid_variants.VARIANTS.values())
    runs = measure.simulate(text).finished
    assert [(run.atoms, run.steps) for run in runs] == [({2: 56, 3: 150}[dim], 2)] * len(
        solid_variants.VARIANTS)


def test_times_come_in_pairs(monkeypatch):
    monkeypatch.setattr(solid_variants, "SIZE", {2: (30, 20)})
    found = solid_variants.timed(2, solid_variants.VARIANTS["quadratic gradients"], 2)
    assert len(found.ratios) == 2 and min(found.a + found.b) > 0


def test_what_variants_add():
    """Each comparison of the page is of variants that there are, and its ratio that of their
    instructions; every variant is in the table."""
    names = list(solid_variants.VARIANTS)
    rows = [{"dimension": dim, "variant": name, "command": "x", "ns": 100.0 * (k + 1), "ratio": 1.5,
             "spread": 0.1, "instructions": 1000.0 * dim + k}
            for dim in (2, 3) for k, name in enumerate(names)]
    for pair in [*solid_variants.SAME.values(), *solid_variants.FORMS.values()]:
        for dim in (2, 3):
            expected = (1000.0 * dim + names.index(pair[0])) / (1000.0 * dim + names.index(pair[1]))
            assert solid_variants.ratio(rows, dim, *pair) == pytest.approx(expected)
    scene, effect = next(iter(solid_variants.SAME))
    assert solid_variants.added(rows, 3, scene, effect) == pytest.approx(1.0 / 3000.0)
    assert solid_variants.added(rows, 3, "fluid", "shifting") is None and solid_variants.added(
        [], 3, scene, effect) is None
    assert set(solid_variants.SAME) <= {(name, effect) for name in effects.SCENES
                                        for effect, *_ in effects.cases(name)}
    text = solid_variants.page(rows)
    assert all(
        f"| {dim} | {name} | `x` | {100 * (k + 1)} | 1.50 ± 0.10 | {1000 * dim + k} |" in text
        for dim in (2, 3) for k, name in enumerate(names))
