"""Pictures of the tree: each is shown by a page, none is large; how particles are painted; the
decks of the film."""

import re
import subprocess
import sys

import numpy as np
import pytest

from fsi import dump, paint, paths, plot, scene

sys.path.insert(0, str(paths.ROOT / "bench"))
import film  # noqa: E402

ENDINGS = (".png", ".gif", ".webp", ".jpg", ".svg")
# of doc/hard/hard.png, which tools/renew draws with it
PARTS = {paths.ROOT / "doc/hard/thumbnails.png"}
RED, BLUE = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)


def tracked():
    named = subprocess.run(["git", "-C", paths.ROOT, "ls-files", "-z"], capture_output=True,
                           text=True, check=True).stdout.split("\0")
    return [paths.ROOT / name for name in named if name and (paths.ROOT / name).is_file()]


def shown(pages):
    """What pages name of pictures, in Markdown, reStructuredText and HTML."""
    found = set()
    for page in pages:
        for name in re.findall(rf"[\w./-]+(?:{'|'.join(map(re.escape, ENDINGS))})\b",
                               page.read_text(encoding="utf-8")):
            found.add((page.parent / name).resolve())
    return found


def test_each_picture_is_shown_and_small():
    """140 kB is what plot.picture keeps to; a film is moving and has 2 MB."""
    files = tracked()
    pictures = {path for path in files if path.suffix in ENDINGS}
    pages = [path for path in files if path.suffix in (".md", ".rst")]
    assert len(pictures) > 80 and film.TARGET in pictures
    assert not {str(path.relative_to(paths.ROOT)) for path in pictures - PARTS - shown(pages)}
    assert not [path for path in pictures if path.stat().st_size
                > (film.LARGEST if path == film.TARGET else plot.LARGEST)]


# ---- discs and spheres ----

def test_discs_share_the_plane():
    """Two discs of radius 0.8 at a distance of 1: each keeps its own half, and nothing is painted
    farther off than the radius."""
    pixels = paint.discs((300, 200), ((-1.0, 2.0), (-1.0, 1.0)), [0.0, 1.0], [0.0, 0.0], 0.8,
                         [RED, BLUE])
    y, x = np.mgrid[0:200, 0:300]
    x, y = -1.0 + (x + 0.5) / 100.0, 1.0 - (y + 0.5) / 100.0
    near = np.minimum(np.hypot(x, y), np.hypot(x - 1.0, y))
    assert np.all(pixels[near < 0.79, 3] == 255) and np.all(pixels[near > 0.81, 3] == 0)
    left, right = (near < 0.79) & (x < 0.49), (near < 0.79) & (x > 0.51)
    assert np.all(pixels[left, 0] == 255) and np.all(pixels[left, 2] == 0) and np.all(
        pixels[right, 2] == 255) and np.all(pixels[right, 0] == 0)
    # pi r^2 less the lens that both would cover, 2 r^2 acos(1/(2r)) - sqrt(r^2 - 1/4)
    area = 2.0 * np.pi * 0.64 - (2.0 * 0.64 * np.arccos(1.0 / 1.6) - np.sqrt(0.64 - 0.25))
    assert pixels[..., 3].sum() / 255.0 / 1e4 == pytest.approx(area, rel=5e-3)


def test_a_square_lattice_has_no_gaps():
    x, y = (a.ravel() for a in np.meshgrid(np.arange(10.0), np.arange(10.0)))
    assert np.all(paint.discs((180, 180), ((0.0, 9.0), (0.0, 9.0)), x, y, plot.FLAT,
                              np.ones((100, 3)))[..., 3] == 255)


@pytest.mark.parametrize("order", [1, -1])
def test_the_nearer_sphere_hides_the_farther(order):
    """Whichever comes first; it is lit from above on the left."""
    depth, colours = np.array([0.0, 1.0])[::order], np.array([RED, BLUE])[::order]
    pixels = paint.discs((100, 100), ((-1.0, 1.0), (-1.0, 1.0)), np.zeros(2), np.zeros(2), 0.9,
                         colours, depth).astype(int)
    assert np.all(pixels[..., 0] == 0) and pixels[50, 50, 2] > 128
    assert pixels[25, 25, 2] > 1.3 * pixels[75, 75, 2]


@pytest.mark.parametrize("depth", [False, True])
def test_few_are_painted_as_many_are(depth):
    """One after the other, as where there are more than places around one: here others lie outside
    of the picture."""
    random = np.random.default_rng(3)
    x, y, near, colours = (random.uniform(-0.2, 1.2, 9), random.uniform(-0.2, 1.2, 9),
                           random.uniform(0, 1, 9), random.uniform(0, 1, (9, 3)))

    def painted(more):
        far = np.full(more, 9.0)
        return paint.discs((60, 60), ((0.0, 1.0), (0.0, 1.0)), np.append(x, far), np.append(y, far),
                           0.15, np.append(colours, np.ones((more, 3)), 0),
                           np.append(near, far) if depth else None)

    few = painted(0)
    assert (few[..., 3] == 255).mean() > 0.2 and np.array_equal(few, painted(2000))


def test_nothing_to_paint():
    assert not paint.discs((20, 10), ((0.0, 2.0), (0.0, 1.0)), [], [], 0.1, np.zeros((0, 3))).any()
    assert not paint.discs((20, 10), ((0.0, 2.0), (0.0, 1.0)), [], [], 0.1, np.zeros((0, 3)),
                           []).any()


# ---- the film ----

@pytest.mark.parametrize("name", film.SCENES)
def test_decks_of_the_film(name):
    """The bundled deck, with one dump of its own that begins at the first time, and stops at the
    last."""
    text, wanted = film.deck(name), film.SCENES[name]
    first, last, step = wanted.times
    scene.check(name, wanted.variables)
    assert re.findall(r"\nfsi/run (\S+)", text) == ([str(first), str(last)] if first
                                                    else [str(last)])
    assert "\nrun " not in text and len(re.findall(r"^(?:dump|fsi/dump) ", text, re.M)) == 1
    assert f"every/time {step} " in text and text.rindex("dump film") > text.rfind(
        f"fsi/run {first}")
    plain = film.scene_lines(name)
    assert sum(line in text.splitlines() for line in plain) > len(plain) - 5


def test_frames_of_the_film(tmp_path):
    """All of one size, water and solids in their colors; packed below the bound."""
    stage = film.Stage(film.SCENES["elastic_gate"])
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(0.0, 0.1, 100), np.linspace(0.0, 0.1, 100)))
    frame = dump.Frame(0, 0.0, None, {"type": np.where(x > 0.08, 2, 1), "x": x, "y": y,
                                      "vx": 0.0 * x, "vy": 0.0 * x, "vonmises": 4e5 + 0.0 * x})
    pictures = [stage.draw(frame) for _ in range(3)]
    assert {picture.size for picture in pictures} == {film.SIZE}
    (left, top), scale = stage.corner, stage.scale

    def at(a, b):
        return np.array(pictures[0].getpixel((round(left + scale * (a + 0.01)),
                                              round(top + scale * (0.16 - b)))))

    assert np.abs(at(0.04, 0.05) - 255 * np.array(plot.WATER(0.0)[:3])).max() <= 2
    assert np.abs(at(0.09, 0.05) - 255 * np.array(plot.STRESS(1.0)[:3])).max() <= 2
    film.write(tmp_path / "a.webp", pictures)
    assert 0 < (tmp_path / "a.webp").stat().st_size < film.LARGEST
