"""The film on the front page: three bundled scenes, one after the other. The command line of
tools/film, which says what it does."""

import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.colors import Normalize, to_rgba
from PIL import Image, ImageDraw, ImageFont
from tool import say

from fsi import dump, launch, paint, paths, plot, scene
from fsi.command import Refusal, split, start
from fsi.plot import INK, NIGHT, STRESS, WATER
from fsi.progress import Progress

TARGET = paths.ROOT / "doc" / "film.webp"
SIZE, HEADER, MARGIN = (800, 450), 60, 18  # [pixel]
RATE, LARGEST = 15, 1_200_000  # [1/s], [byte]
DIM, FLOOR, WALL = "#7d8ba3", "#16223b", "#9aa5b8"


@dataclass
class Scene:
    """What is run of a deck and how it is shown. Lengths in m, times in s, colors in m/s and Pa."""

    title: str
    variables: dict
    times: tuple  # from, to, step
    spacing: float
    limits: tuple  # of the picture's plane
    speed: float
    stress: float
    solid: tuple
    wall: tuple = ()
    fine: tuple = ()  # types that have half the spacing
    view: str = ""  # as of fsi animate, in three dimensions
    edges: tuple = ()  # lines of the tank, in the scene's coordinates
    cut: float = np.inf  # in three dimensions water with a larger z is left out


def tank(length, width):
    """The edges of a floor."""
    return (((0, 0, 0), (length, 0, 0), (length, 0, width), (0, 0, width), (0, 0, 0)),)


SCENES = {
    "dam_break_elastic": Scene("Dam break on an elastic plate", {"dx": "0.004"}, (0.0, 0.38, 0.01),
                               0.004, ((-0.035, 0.6), (-0.065, 0.3)), 3.0, 9e4,
                               (2, 3), view="14,14,y", edges=tank(0.584, 0.08), cut=0.04),
    "turek_hron_fsi": Scene("Elastic flag in the wake of a cylinder", {"across": "2"},
                            (8.0, 9.0, 0.02), 0.01, ((0.0, 1.0), (0.0, 0.41)), 2.2, 6e4, (3,),
                            (2, 4), (3,)),
    "elastic_gate": Scene("Water breaks through a rubber gate", {"dx": "0.001"}, (0.0, 0.36, 0.008),
                          0.001, ((-0.01, 0.3), (-0.008, 0.16)), 2.0, 4e5,
                          (2,), (3,), edges=(((0, 0.17), (0, 0), (1, 0)),)),
}


def deck(name):
    """The bundled deck of a scene with a dump of its own in place of the deck's: from the first
    time on."""
    first, last, step = SCENES[name].times
    lines = scene_lines(name)
    go = next((line.split("#")[0].split() for line in lines if line.startswith("fsi/run ")), None)
    if not go:
        raise Refusal(f"{name}: its deck has no fsi/run")
    keywords = " ".join(["", *go[2:]])
    axes = "xy" if any(re.match(r"dimension\s+2", line) for line in lines) else "xyz"
    kept = [line for line in lines if not re.match(r"(fsi/dump|fsi/run)\s", line)]
    columns = " ".join(["id type", *axes, *(f"v{axis}" for axis in axes), "c_film"])
    return "\n".join([*kept, *([f"fsi/run {first}{keywords}"] if first else []),
                      "compute film all fsi/atom vonmises",
                      f"dump film all custom 1 film.dump {columns}", "dump_modify film every/time "
                      f"{step} sort id time yes colname c_film vonmises",
                      f"fsi/run {last}" + ("" if first else keywords)]) + "\n"


def scene_lines(name):
    """Lines of the plain deck, continued ones joined."""
    return (paths.EXAMPLES / name / f"in.{name}").read_text().replace("&\n", " ").splitlines()


def run(name, folder):
    """Runs a scene's deck in folder, unless it has been run there with this text."""
    text = deck(name)
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "in.film"
    if (folder / "done").exists() and path.read_text() == text:
        return
    (folder / "done").unlink(missing_ok=True)
    path.write_text(text)
    for other in (paths.EXAMPLES / name).glob("*.in"):
        (folder / other.name).write_text(other.read_text())
    say(f"film: running {name}")
    with open(folder / "out", "w", encoding="utf-8") as out:
        if subprocess.run(launch.lammps("in.film", 1, SCENES[name].variables), cwd=folder,
                          env=launch.environment(), stdin=subprocess.DEVNULL,
                          stdout=out, stderr=subprocess.STDOUT, check=False).returncode:
            raise Refusal(f"{name} stopped: {folder / 'out'}")
    (folder / "done").touch()


def font(size, bold=False):
    """Matplotlib's own, which is wherever matplotlib is."""
    return ImageFont.truetype(str(Path(matplotlib.get_data_path()) / "fonts" / "ttf"
                                  / f"DejaVuSans{'-Bold' if bold else ''}.ttf"), size)


class Stage:
    """Where a scene's frames are drawn: as large as fits below the header, in the middle."""

    def __init__(self, shown):
        self.shown = shown
        (xlo, xhi), (ylo, yhi) = shown.limits
        room = SIZE[0] - 2 * MARGIN, SIZE[1] - HEADER - MARGIN
        scale = min(room[0] / (xhi - xlo), room[1] / (yhi - ylo))
        self.size = round(scale * (xhi - xlo)), round(scale * (yhi - ylo))
        self.corner = (SIZE[0] - self.size[0]) // 2, HEADER + (room[1] - self.size[1]) // 2
        self.scale = self.size[0] / (xhi - xlo)

    def draw(self, frame):
        """One frame as a picture."""
        shown = self.shown
        if shown.view:
            frame = frame.select((frame["y"] > 0.0)
                                 & (np.isin(frame["type"], shown.solid) | (frame["z"] < shown.cut)))
        picture = Image.new("RGB", SIZE, NIGHT)
        pen = ImageDraw.Draw(picture)
        self._head(pen, picture, frame.time)
        inside = Image.new("RGB", (2 * self.size[0], 2 * self.size[1]), NIGHT)
        self._edges(ImageDraw.Draw(inside))
        inside = inside.resize(self.size, Image.Resampling.BOX)
        colours = np.tile(to_rgba(WALL), (len(frame), 1))
        solid, wall = (np.isin(frame["type"], types) for types in (shown.solid, shown.wall))
        speed = np.linalg.norm(frame.vector(("vx", "vy", "vz")), axis=1)
        fluid = ~(solid | wall)
        colours[fluid] = WATER(Normalize(0.0, shown.speed)(speed[fluid]))
        colours[solid] = STRESS(Normalize(0.0, shown.stress)(frame["vonmises"][solid]))
        if shown.view:
            frame = plot.seen([frame], shown.view)[0][0]
        radius = (plot.ROUND if shown.view else plot.FLAT) * shown.spacing * np.where(
            np.isin(frame["type"], shown.fine), 0.5, 1.0)
        # what is not water lies above it
        for part in [slice(None)] if shown.view else [fluid, solid, wall]:
            layer = Image.fromarray(paint.discs(self.size, shown.limits, frame["x"][part],
                                                frame["y"][part], radius[part], colours[part],
                                                frame["depth"] if shown.view else None))
            inside.paste(layer, (0, 0), layer)
        picture.paste(inside, self.corner)
        return picture

    def _edges(self, pen):
        (xlo, _), (_, yhi) = self.shown.limits
        for line in self.shown.edges:
            points = np.array(line, float)
            if self.shown.view:
                frame = dump.Frame(0, 0.0, None, dict(zip("xyz", points.T)))
                turned = plot.seen([frame], self.shown.view)[0][0]
                points = np.column_stack([turned["x"], turned["y"]])
            corners = [tuple(p) for p in 2.0 * (points - (xlo, yhi)) * (self.scale, -self.scale)]
            if self.shown.view:
                pen.polygon(corners, fill=FLOOR)
            pen.line(corners, fill=DIM, width=2)

    def _head(self, pen, picture, time):
        """Title and time, and what the colors mean."""
        pen.text((MARGIN, 14), self.shown.title, font=font(17, bold=True), fill=INK)
        pen.text((MARGIN, 37), f"t = {time:.2f} s", font=font(15), fill=INK)
        large = self.shown.stress >= 1e6
        for k, (colours, label) in enumerate(((WATER, f"speed, 0 to {self.shown.speed:g} m/s"),
                                              (STRESS, "stress, 0 to "
                                               f"{self.shown.stress / (1e6 if large else 1e3):g} "
                                               f"{'MPa' if large else 'kPa'}"))):
            strip = (255 * colours(np.linspace(0.0, 1.0, 150))[None, :, :3]).astype(
                np.uint8).repeat(8, axis=0)
            left = SIZE[0] - MARGIN - 320 + 170 * k
            picture.paste(Image.fromarray(strip), (left, 18))
            pen.text((left, 33), label, font=font(13), fill=INK)


def write(path, pictures):
    """An animated WebP below LARGEST bytes."""
    for quality in (80, 70, 60, 50, 40, 30):
        pictures[0].save(path, "WEBP", save_all=True, append_images=pictures[1:],
                         duration=round(1000 / RATE), loop=0, quality=quality, method=4)
        if path.stat().st_size <= LARGEST:
            return quality
    raise Refusal(f"{path} has {path.stat().st_size} bytes, more than {LARGEST}")


def main(arguments):
    """tools/film"""
    options, _ = split(arguments, ("out", "film"), "out=FOLDER or film=FILE.webp", more=False)
    folder, target = Path(options.get("out", paths.RESULTS / "film")).resolve(), Path(
        options.get("film", TARGET))
    if not scene.build():
        return 1
    pictures = []
    for name, shown in SCENES.items():
        run(name, folder / name)
        stage = Stage(shown)
        pictures += [stage.draw(frame) for frame in dump.frames(
            folder / name / "film.dump", progress=Progress(f"film: drawing {name}"))]
    quality = write(target, pictures)
    say(f"film: {target}, {len(pictures)} pictures, quality {quality}, {target.stat().st_size} "
        "bytes")
    return 0


if __name__ == "__main__":
    start("film", main)
