"""tools/cost solids: each variant runs, and what is made of the measurements."""

import sys

import pytest

from fsi import paths

sys.path.insert(0, str(paths.ROOT / "bench"))
import measure  # noqa: E402
import solid_variants  # noqa: E402


@pytest.mark.parametrize("dim", [2, 3])
def test_each_variant_runs(dim, monkeypatch):
    monkeypatch.setattr(solid_variants, "SIZE", {2: (8, 7), 3: (6, 5, 5)})
    text = "clear\n".join(f"{solid_variants.deck(dim, *variant)}run 2\n" for variant in solid_variants.VARIANTS.values())
    runs = measure.simulate(text).finished
    assert [(run.atoms, run.steps) for run in runs] == [({2: 56, 3: 150}[dim], 2)] * len(solid_variants.VARIANTS)


def test_times_come_in_pairs(monkeypatch):
    monkeypatch.setattr(solid_variants, "SIZE", {2: (30, 20)})
    found = solid_variants.timed(2, solid_variants.VARIANTS["quadratic gradients"], 2)
    assert len(found.ratios) == 2 and min(found.a + found.b) > 0


def test_page_has_every_variant(tmp_path):
    rows = [{"variant": name, "command": style, "ns": 100.0 * (k + 1), "ratio": 1.5, "spread": 0.1, "instructions": 1000.0, "instruction_ratio": 2.0}
            for k, (name, (style, _)) in enumerate(solid_variants.VARIANTS.items())]
    text = solid_variants.page({2: rows, 3: rows}, 5)
    assert all(f"| {name} | {100 * (k + 1)} | 1.50 ± 0.10 | 1000 | 2.00 |" in text for k, name in enumerate(solid_variants.VARIANTS))
    solid_variants.picture(tmp_path / "solids.png", {2: rows, 3: rows})
    assert (tmp_path / "solids.png").stat().st_size > 0
