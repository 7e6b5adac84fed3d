"""tools/cost sound: its scenes have what it asks of them, and what is made of the measurements."""

import sys

import pytest

from fsi import paths, scene, sweep

sys.path.insert(0, str(paths.ROOT / "bench"))
import sound  # noqa: E402


@pytest.mark.parametrize("name", sound.SCENES)
def test_decks_have_the_variables(name):
    _, _, variable, value, over, ratios, _ = sound.SCENES[name]
    settings = sound.settings_of(name, 2)
    text, given = sweep.Deck(scene.deck(name)).instance(settings)
    assert ratios[:2] == (1, 2) and (variable in given
                                     or f"variable        {variable} equal {2 * value}" in text)
    assert all(float(settings[k]) == v / 2
               and f"variable        {k} index {v:g}" in scene.deck(name).read_text()
               for k, v in over.items())


def test_changes_and_page():
    found = {1: {"frequency": 2.0, "damping_a_period": 0.01, "cpu_seconds": 3.0},
             2: {"frequency": 2.1, "damping_a_period": 0.01, "cpu_seconds": 6.0}}
    rows = sound.rows_of("ring_annulus", found)
    assert [row["change"] for row in rows] == [None, None, pytest.approx(0.05), 0.0]
    text = sound.page(rows)
    assert ("| frequency [rad/s] | 2 | 2.1 (+5.0 %) | - |" in text
            and "| time of `ring_annulus` [s] | 3 | 6 | - |" in text)
    assert "1 of 2 figures change by less than 3 %" in text
