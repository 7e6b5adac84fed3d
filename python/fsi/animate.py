"""Pictures and animations of dumps: fluid coloured by pressure, solids by von Mises stress, or all
by a column; in 3D seen from somewhere."""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from . import dump, plot
from .dump import spacing
from .progress import Progress

OPTIONS = ("solid", "wall", "view", "color", "types")  # of pictures, as the command line has them


def species(frames, solid=None, wall=None):
    """(types of fluids, of solids, of walls); unless given, solid is what has a molecule ID, and a
    wall what has none and never moves beside what does."""
    types = sorted({int(t) for frame in frames for t in np.unique(frame["type"])})
    if solid is None:
        bodies = [frame["type"][frame["mol"] != 0] for frame in frames if "mol" in frame]
        solid = {int(t) for part in bodies for t in np.unique(part)}
    if wall is None:
        wall = {t for t in types if t not in solid
                and _at_rest([frame.of_types(t) for frame in frames])}
        if wall == set(types) - solid:  # all of it: fluid of a run that has not begun
            wall = set()
    return (tuple(t for t in types if t not in solid | wall),
            tuple(t for t in types if t in solid - wall), tuple(t for t in types if t in wall))


def _at_rest(parts):
    """Whether particles are the same in all frames, at the same places, without velocities. One
    frame does not tell."""
    first, *others = parts
    fixed = [name for name in ("x", "y", "z") if name in first]
    return bool(others) and len(first) > 0 and all(
        len(part) == len(first) and all(np.array_equal(part[name], first[name]) for name in fixed)
        and not any(part[name].any() for name in ("vx", "vy", "vz") if name in part)
        for part in others)


def prepared(frames, options):
    """(frames, arguments of plot's functions) with what `options` say of view, color and types."""
    colour, solid, wall = options.get("color"), _types(options, "solid"), _types(options, "wall")
    wanted, lacks = _types(options, "types"), [n for n in ("type", "x", "y") if n not in frames[0]]
    if lacks:
        raise ValueError(f"the dump has no column {' and no '.join(lacks)}; it has "
                         f"{', '.join(frames[0].columns)}")
    if wanted:
        frames = [frame.of_types(*wanted) for frame in frames]
    if not any(map(len, frames)):
        raise ValueError(f"types={options['types']}: the dump has no such particles" if wanted
                         else "the dump has no particles")
    if colour == "speed":
        for frame in frames:
            frame.columns["speed"] = np.linalg.norm(frame.vector(("vx", "vy", "vz")), axis=1)
    elif colour and not all(colour in frame for frame in frames):
        raise ValueError(f"the dump has no column {colour}; it has {', '.join(frames[0].columns)}")
    elif not colour and not any("p" in frame or "vonmises" in frame for frame in frames):
        raise ValueError("the dump has neither column p nor vonmises: dump_modify ... colname "
                         "c_ID[1] p colname c_ID[2] vonmises, "
                         "with ID that of compute fsi/atom p vonmises; or color=COLUMN")
    fluid, solid, wall = species(frames, solid, wall)
    distance = spacing(next(frame for frame in frames if len(frame)))
    labels = plot.LABELS
    if "view" in options or any("z" in frame and len(frame) and np.ptp(frame["z"]) > 0.0
                                for frame in frames):
        frames, labels = plot.seen(frames, options.get("view", "30,20"))
    return frames, {"spacing": distance, "fluid": fluid, "solid": solid, "wall": wall,
                    "colour": colour, "labels": labels}


def _types(options, name):
    """Atom types of an option, None without it."""
    try:
        return {int(t) for t in options[name].split(",")} if name in options else None
    except ValueError:
        raise ValueError(
            f"{name}={options[name]}: atom types are needed, such as {name}=1,2") from None


def draw(path, frames, options):
    """Snapshots of some frames."""
    frames, how = prepared(frames, options)
    plot.snapshots(path, frames, **how)


def animate(path, out=None, options=None):
    """Returns where the animation is, or without ffmpeg the folder of pictures."""
    options = options or {}
    out = Path(out or Path(path).with_suffix(".mp4"))
    rate = float(options.get("rate", 25))
    frames = list(dump.frames(path, progress=Progress(f"reading {path}")))
    if not frames:
        raise ValueError(f"{path} has no frames")
    frames, how = prepared(frames, options)
    ffmpeg = shutil.which("ffmpeg")
    if ffmpeg is None:
        folder = out.with_suffix("")
        folder.mkdir(parents=True, exist_ok=True)
        plot.movie(folder, frames, progress=Progress("drawing"), **how)
        print(f"fsi animate: ffmpeg is not here (Debian: apt-get install ffmpeg); {len(frames)} "
              "pictures", file=sys.stderr)
        return folder
    with tempfile.TemporaryDirectory() as folder:
        plot.movie(Path(folder), frames, progress=Progress("drawing"), **how)
        # even numbers of pixels, and colours that every player knows
        mp4 = ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt",
               "yuv420p"] if out.suffix == ".mp4" else []
        command = [ffmpeg, "-y", "-loglevel", "error", "-framerate", str(rate), "-i",
                   str(Path(folder) / "%05d.png"), *mp4, str(out)]
        if subprocess.run(command, stdin=subprocess.DEVNULL, check=False).returncode:
            raise ValueError(f"ffmpeg could not make {out}")
    return out
