"""An animation of a 2D dump (.mp4, .gif), by ffmpeg: fluid coloured by pressure, solids by von Mises stress.

    python3 -m fsi.animate particles.dump [animation.mp4] [rate=25] [solid=TYPES]      solid=2,3; default: types with a molecule ID

Without ffmpeg the pictures are left in a folder beside the animation's place.
"""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from . import dump, plot


def spacing(frame, samples=200):
    """Distance of nearest neighbours, the median of some particles."""
    x = frame.vector()
    nearest = []
    for i in range(0, len(x), max(1, len(x) // samples)):
        rsq = ((x - x[i])**2).sum(axis=1)
        rsq[i] = np.inf
        nearest.append(np.sqrt(rsq.min()))
    return float(np.median(nearest))


def species(frames, solid=None):
    """(types of fluids, types of solids); solid is what has a molecule ID, unless given."""
    if not any("p" in frame or "vonmises" in frame for frame in frames):
        raise ValueError("the dump has neither column p nor vonmises: dump_modify ... colname c_ID[1] p colname c_ID[2] vonmises, "
                         "with ID that of compute fsi/atom p vonmises")
    types = sorted({int(t) for frame in frames for t in np.unique(frame["type"])})
    if solid is None:
        bodies = [frame["type"][frame["mol"] != 0] for frame in frames if "mol" in frame]
        solid = {int(t) for part in bodies for t in np.unique(part)}
    return tuple(t for t in types if t not in solid), tuple(t for t in types if t in solid)


def pictures(frames, folder, solid=None):
    """One picture per frame, all with the same colours and limits; returns their number."""
    fluid, solid = species(frames, solid)
    plot.movie(Path(folder), frames, spacing(frames[0]), fluid, solid)
    return len(frames)


def animate(path, out=None, rate=25, solid=None):
    """Returns where the animation is, or without ffmpeg the folder of pictures."""
    out = Path(out or Path(path).with_suffix(".mp4"))
    frames = dump.read(path)
    if not frames:
        raise ValueError(f"{path} has no frames")
    ffmpeg = shutil.which("ffmpeg")
    if ffmpeg is None:
        folder = out.with_suffix("")
        folder.mkdir(parents=True, exist_ok=True)
        print(f"fsi.animate: ffmpeg is not here (Debian: apt-get install ffmpeg); {pictures(frames, folder, solid)} pictures", file=sys.stderr)
        return folder
    with tempfile.TemporaryDirectory() as folder:
        pictures(frames, folder, solid)
        # even numbers of pixels, and colours that every player knows
        mp4 = ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"] if out.suffix == ".mp4" else []
        command = [ffmpeg, "-y", "-loglevel", "error", "-framerate", str(rate), "-i", str(Path(folder) / "%05d.png"), *mp4, str(out)]
        subprocess.run(command, stdin=subprocess.DEVNULL, check=True)
    return out


def main(arguments):
    """Command line."""
    options = dict(a.split("=", 1) for a in arguments if "=" in a)
    files = [a for a in arguments if "=" not in a]
    if not 1 <= len(files) <= 2 or files[0].startswith("-") or set(options) - {"rate", "solid"}:
        sys.exit(__doc__)
    solid = {int(t) for t in options["solid"].split(",")} if "solid" in options else None
    try:
        print(animate(*files, rate=float(options.get("rate", 25)), solid=solid))
    except (OSError, ValueError, subprocess.CalledProcessError) as error:
        sys.exit(f"fsi.animate: {error}")


if __name__ == "__main__":
    main(sys.argv[1:])
