"""Reference logs, pictures and the gallery: what is committed is complete, small and of no machine;
how logs are made."""

import hashlib
import io
import re
import subprocess

import numpy as np

import pytest

from fsi import gallery, log, paths, plot, scene

SCENES = gallery.short()


def test_settings_are_the_decks():
    for name, variables in SCENES.items():
        scene.check(name, variables)


@pytest.mark.parametrize("name", SCENES)
def test_reference_logs(name):
    """Both rank counts ran to their end with the settings of the short form and the deck of today,
    and agree where they start."""
    # what the short form jumps over is not in its log
    text = re.sub(r'(?s)(\nif [^\n]* then "jump SELF (\w+)"\n).*?(\nlabel +\2\n)', r"\1",
                  scene.deck(name).read_text())
    deck = [line.rstrip("& ") for line in text.splitlines()]
    runs = []
    for ranks in gallery.RANKS:
        path, = (paths.EXAMPLES / name).glob(f"log.*.{name}.{ranks}")
        found, text = log.read(path), path.read_text()
        assert not [line for line in deck
                    if line not in text], f"the deck has changed since: tools/gallery {name}"
        assert found.finished and not found.errors and found.finished[-1].ranks == ranks
        assert path.name.split(".")[1] == gallery.date(found.version)
        assert path.stat().st_size < 35e3
        assert not re.search(r"(?<![\w.>])/(home|root|tmp|usr|work|build)\b", text)
        runs.append(found.finished[-1])
    assert runs[0].atoms == runs[1].atoms and runs[0].steps == runs[1].steps
    columns = [[run.thermo[c][0] for c in run.thermo if c.startswith(("v_", "c_"))
                and "cpu" not in c.lower()] for run in runs]
    assert columns[0] == pytest.approx(columns[1], rel=1e-6, abs=1e-6)


def test_page_has_every_scene_and_its_picture():
    text = (paths.ROOT / "doc/src/gallery.rst").read_text()
    for name in SCENES:
        assert f"(``{name}``)" in text and not re.search(r"[\d.]+ s on \d", text)
        assert list((paths.EXAMPLES / name).glob("*.png")) and f"examples/{name}/" in text
    for picture in re.findall(r"image:: \.\./\.\./(\S+)", text):
        assert (paths.ROOT / picture).exists()


def files():
    """What is in the repository."""
    named = subprocess.run(["git", "-C", paths.ROOT, "ls-files", "-z"], capture_output=True,
                           text=True, check=True).stdout.split("\0")
    return [paths.ROOT / name for name in named if name and (paths.ROOT / name).is_file()]


def test_pictures_are_small_and_each_once():
    """Whoever clones loads all of it; 140 kB is what plot.picture keeps to, 300 kB what nothing
    exceeds."""
    found = files()
    pictures = [path for path in found if path.suffix in (".png", ".gif", ".webp", ".jpg", ".svg")]
    assert len(pictures) > 90
    assert not [path for path in pictures if path.stat().st_size
                > (2_000_000 if path.suffix in (".gif", ".webp") else 300_000)]
    by_content = {}
    for path in pictures:
        by_content.setdefault(hashlib.sha1(path.read_bytes()).hexdigest(), []).append(path)
    assert not [twins for twins in by_content.values() if len(twins) > 1]
    assert sum(path.stat().st_size for path in found) < 12_000_000


def test_a_picture_is_packed_without_a_visible_change(tmp_path):
    """A smooth map of all colors, with a rare one: within 16 of 255 of the original, below the
    bound, and no larger than half the pixels ask for."""
    y, x = np.mgrid[0:100, 0:150]
    whole = np.stack([x * 255 // 149, y * 255 // 99, (x + y) * 255 // 248], -1).astype(np.uint8)
    whole[10:14, 10:14] = (255, 0, 255)
    file = io.BytesIO()
    plot.Image.fromarray(whole).save(file, "PNG")
    small = np.asarray(plot.Image.open(io.BytesIO(plot.packed(file))).convert("RGB")).astype(int)
    assert small.shape == whole.shape and np.abs(small[12, 12] - (255, 0, 255)).max() <= 30
    assert np.abs(small - whole).mean() < 16
    noise = np.random.default_rng(1).integers(0, 256, (100, 150, 3), dtype=np.uint8)
    file = io.BytesIO()
    plot.Image.fromarray(noise).save(file, "PNG")
    packed = plot.packed(file, 7_000)
    assert len(packed) <= 7_000 and plot.Image.open(io.BytesIO(packed)).size >= (75, 50)
    with plot.picture(tmp_path / "a.png") as figure:
        figure.add_subplot().plot([0, 1])
    assert plot.Image.open(tmp_path / "a.png").mode == "P"


def test_every_deck_shows_the_time_that_remains():
    for name in scene.scenes():
        assert re.search(r"thermo_style.*cpuremain",
                         scene.deck(name).read_text().replace("&\n", "")), name


def test_scrubbed():
    text = (f"read {paths.ROOT}/examples/a/in.a (/opt/lmp/src/fix.cpp:3) 1.5/2 f_3[1]/f_4 a/b "
            f"${{t}}/dt/${{n}} (a)/2/b\n")
    assert gallery.scrubbed(
        text) == "read examples/a/in.a (fix.cpp:3) 1.5/2 f_3[1]/f_4 a/b ${t}/dt/${n} (a)/2/b\n"
    assert gallery.scrubbed("run 1\n\nCITE-CITE\n\n@Misc{FSI,\n}\n\nCITE-CITE\n\nSetting up  \n"
                            "Histogram: 1 0\n") == "run 1\nSetting up\n"


def test_date():
    assert (gallery.date("4 Feb 2025"),
            gallery.date("29 Aug 2024 - Update 1")) == ("4Feb25", "29Aug24")


def test_logs_of_one_scene(tmp_path, monkeypatch):
    """A scene without a deck of particles: both logs, old ones replaced."""
    folder = tmp_path / "toy"
    folder.mkdir()
    (folder / "in.toy").write_text('variable a index 1\nregion b block 0 1 0 1 0 1\n'
                                   'create_box 1 b\nmass 1 1\npair_style zero 1\npair_coeff * *\n'
                                   'print "a is ${a}"\nrun 0\n')
    (folder / "log.1Jan20.toy.2").write_text("old")
    (tmp_path / gallery.SHORT).write_text('{"toy": {"a": 7}}')
    monkeypatch.setattr(paths, "EXAMPLES", tmp_path)
    assert gallery.reference_logs("toy")
    names = sorted(path.name for path in folder.glob("log*"))
    assert len(names) == 2 and names[0].endswith(".toy.1") and names[1].endswith(".toy.2")
    assert all("a is 7" in (folder / name).read_text() for name in names)
