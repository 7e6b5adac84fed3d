"""Looks into what a run left, and before it. Usage, as `fsi` where it is installed (pip install
./python), else as `python3 -m fsi`:

    fsi log log.lammps                        what was run, how fast, figures, warnings
    fsi log log.lammps COLUMN ...             columns of the thermo output as CSV
    fsi series FILE [COLUMN ...]              the same of files of fix print (CSV) and fix ave/time
    fsi frequency FILE COLUMN [FROM [TO]]     of a column that swings; mean and amplitude over its
    last periods
    fsi mean FILE ... COLUMN [from=T]         of a column that has settled; with dx= of two runs
    the error of the finer one
    fsi dump particles.dump                   frames, particles, columns and their ranges
    fsi vtk particles.dump [FOLDER]           for ParaView
    fsi animate particles.dump [FILE.mp4]     by ffmpeg
    fsi report [FOLDER]                       one page, report.html, of all that a run left
    fsi check DECK [NAME=VALUE ...]           what the package says about a deck before its first
    step
    fsi fill SURFACE DX OUT.data              particles inside an outline (2D) or an STL surface
    (3D)

plot=FILE.png behind log, series or dump draws instead: columns over time; snapshots. fsi COMMAND
--help says more.
"""

import os
import sys
from pathlib import Path

import numpy as np

from . import animate, check, dump, fill, log, plot, precision, report, series, vtk
from .command import Refusal, number, whole
from .progress import Progress

COLOURS = (plot.BLUE, plot.ORANGE, plot.GREY, plot.GREEN, plot.RED)
MANY = 20  # bodies that are listed
TIME = ("time", "Time", "t")  # names of columns that others are drawn over


def show_log(files, options):
    """fsi log LOG [COLUMN ...] [plot=FILE.png]

    Without columns: runs, speed, figures that the deck printed, warnings. With columns: these as
    CSV, or drawn over the first of them; a single one is drawn over the time if there is a column
    of it, else over Step. v_, c_ and f_ may be left out.
    """
    path, *wanted = files
    found = log.read(path)
    if wanted or options:
        names = dict.fromkeys(name for run in found.runs for name in run.thermo)
        table = {name: found.column(name) for name in names}
        if wanted and len({len(c) for c in _columns(table, wanted, path).values()}) > 1:
            raise ValueError(f"{path}: not every run has these columns")
        if not wanted:
            table = {name: values for name, values in table.items() if len(values)
                     == max(map(len, table.values()))}
        return _show(table, wanted, path, options)
    print(f"LAMMPS {found.version or 'of unknown version'}, {len(found.runs)} runs, "
          f"{len(found.finished)} finished")
    for k, run in enumerate(found.finished, start=1):
        print(f"run {k}: {run.atoms} atoms, {run.steps} steps on {run.ranks} ranks in "
              f"{run.loop_seconds:.4g} s"
              + (f", {run.atoms * run.steps / run.loop_seconds:.3g} particle-steps/s"
                 if run.loop_seconds else ""))
        print("  columns: " + " ".join(run.thermo))
    for name, value in found.values.items():
        print(f"{name} = {value}")
    for line in found.warnings + found.errors:
        print(line)


def show_series(files, options):
    """fsi series FILE [COLUMN ...] [plot=FILE.png]

    FILE is of fix print (CSV with a header line) or of fix ave/time. Its columns as CSV, or drawn
    over the first wanted; a single one is drawn over the first of the file.
    """
    path, *wanted = files
    table = series.read_any(path).columns
    if any(values.ndim > 1 for values in table.values()):
        table = series.rows(table)
    _show(table, wanted, path, options)


def show_frequency(files, options):
    """fsi frequency FILE COLUMN [FROM [TO]] [periods=3] [harmonics=4]

    First the frequency of the largest peak of the column's spectrum between two times. Then, as
    Turek and Hron define them for their benchmark, over the last whole periods: mean = (max+min)/2,
    amplitude = (max-min)/2, frequency = 1/period, each averaged over so many periods, in brackets
    the smallest and largest. Last, mean and amplitude of the harmonics of that frequency that fit
    these periods best: what is between them, such as sound in a force, does not count there. A
    signal that has not settled is said to be so.
    """
    path, *wanted = files
    if not 1 <= len(wanted) <= 3:
        raise ValueError("frequency takes a column and perhaps two times")
    periods = whole("periods", options.get("periods", "3"))
    table = series.read_any(path).columns
    (first, time), *_ = table.items()
    column = _columns(table, wanted[:1], path)[wanted[0]]
    low, high = [*map(float, wanted[1:]), *(time[0], time[-1])[len(wanted) - 1:]]
    inside = (time >= low) & (time <= high)
    if inside.sum() < 8:
        raise ValueError(f"{path} has {inside.sum()} rows between {first} = {low:g} and {high:g}")
    time, column = time[inside], column[inside]
    peak = series.frequency(time, column)
    print(f"{peak:.6g} per unit of {first}")
    found = series.periodic(time, column, periods)
    if found is None:
        print("no whole period, so neither mean nor amplitude")
        return
    print(f"last {len(found['mean'])} of {found.pop('count')} whole periods:")
    for name, values in found.items():
        print(f"  {name:9}  {np.mean(values):.6g}  ({np.min(values):.6g} to {np.max(values):.6g})")
    rate = np.mean(found["frequency"])
    harmonics = whole("harmonics", options.get("harmonics", "4"))
    mean, amplitude = series.swing(time, column, rate, len(found["mean"]), harmonics)
    print(f"by {harmonics} harmonics:\n  mean       {mean:.6g}\n  amplitude  {amplitude:.6g}")
    size = found["amplitude"]
    if np.ptp(size) > 0.05 * np.mean(size):
        print("  not settled: the amplitude changes by more than 5 %")
    if abs(rate - peak) > 0.1 * peak:
        print(f"  not one swing: {rate:.4g} of these periods is not the peak of the spectrum over "
              "all of the time; look at plot= of fsi series, or begin later")


def show_mean(files, options):
    """fsi mean FILE [FILE ...] COLUMN [from=T] [dx=A,B,...]

    Mean of a column over the time from T on (default: the last third), its standard error by means
    of eight blocks, and the change from the first half of that time to the second, which tells
    whether it is steady. With the spacing of each file: the limit that the two finest runs tend to
    if errors are of first and of second order, and so the error of the finest run.
    """
    *paths, name = files
    if not paths:
        raise ValueError("mean takes files and a column")
    spacings = [number("dx", word) for word in options["dx"].split(",")] if "dx" in options else []
    if spacings and (len(spacings) != len(paths) or len(set(spacings)) != len(paths)
                     or min(spacings) <= 0.0):
        raise ValueError(f"dx= takes a different spacing > 0 for each of the {len(paths)} files")
    means = []
    for path in paths:
        table = series.read_any(path).columns
        time = next(iter(table.values()))
        column = _columns(table, [name], path)[name]
        start = number("from", options["from"]) if "from" in options else time[-1] - (
            time[-1] - time[0]) / 3.0
        late = time >= start
        if late.sum() < 16:
            raise ValueError(f"{path} has {late.sum()} rows from {start:g} on")
        mean, error, change = series.steady(time[late], column[late])
        means.append(mean)
        print(f"{path}: {name} = {mean:.4g} +- {error:.1g} from {start:.4g} to {time[-1]:.4g}; "
              f"change {change:+.1g} between the halves"
              + ("" if abs(change) <= max(0.01 * abs(mean), 3.0 * error)
                 else ": not steady, begin later or run longer"))
    if len(spacings) > 1:
        finest = sorted(zip(spacings, means))[:2]
        first, second = precision.between(*zip(*finest))
        value = finest[0][1]
        print(f"limit {second:.4g} to {first:.4g} (errors of second to first order in dx): the run "
              f"with dx = {finest[0][0]:g} is off by "
              f"{value - second:+.2g} to {value - first:+.2g}"
              + (f", {100 * (value / second - 1):+.1f} to {100 * (value / first - 1):+.1f} %"
                 if first and second else ""))


def show_dump(files, options):
    """fsi dump DUMP [plot=FILE.png] [view=...] [color=COLUMN] [types=1,2] [frames=6]

    Without plot: frames, particles of each body or type at first and their extent in spacings (the
    least of a plate: particles through its thickness), columns and their ranges in the last frame.
    plot draws up to six frames (frames=N), colored by pressure and von Mises stress, or by the
    column of color=; color=speed is made of vx, vy, vz. Walls are gray: wall=2,3 names their types,
    by default those without molecule ID that stand still. solid= names those of solids, by default
    with a molecule ID. types= leaves others out. view= is for three dimensions: x, y or z looks
    along that axis; AZIMUTH,ELEVATION (degrees; default 30,20) from there, with z up;
    AZIMUTH,ELEVATION,y with y up.
    """
    path, *rest = files
    if rest:
        raise ValueError("dump takes no columns")
    if "plot" in options:
        some = dump.some(path, whole("frames", options.get("frames", "6")),
                         Progress(f"reading {path}"))
        animate.draw(options["plot"], some, options)
        print(options["plot"])
        return
    if options:
        raise ValueError(f"{', '.join(options)}: only with plot=")
    first, last, count = None, None, 0
    for last in dump.frames(path, progress=Progress(f"reading {path}")):
        first, count = last if first is None else first, count + 1
    if not count:
        raise ValueError(f"{path} has no frames")
    print(f"{count} frames from t = {first.time:g} to {last.time:g}, {len(first)} particles at "
          f"first, {len(last)} at last")
    made_of = dump.bodies(first) if "type" in first and "x" in first else []
    for name, number, size in made_of[:MANY]:
        print(f"  {name}: {number} particles"
              + (f", {' x '.join(f'{s:.3g}' for s in size)} spacings" if size else ""))
    if len(made_of) > MANY:
        print(f"  and {len(made_of) - MANY} more")
    for name, values in last.columns.items() if len(last) else ():
        print(f"  {name:12} {np.nanmin(values):.6g} to {np.nanmax(values):.6g}")


def make_vtk(files, _):
    """fsi vtk DUMP [FOLDER]

    One .vtu file per frame, and a .pvd file that lists them with their times, in a folder named as
    the dump without its ending.
    """
    print(vtk.convert(*files, progress=Progress(f"converting {files[0]}")))


def make_animation(files, options):
    """fsi animate DUMP [FILE.mp4 or FILE.gif] [rate=25] [solid=TYPES] [wall=TYPES] [view=...]
    [color=COLUMN] [types=1,2]

    By ffmpeg; without it the numbered pictures stay, in a folder next to the animation. Fluids are
    colored by pressure, solids by von Mises stress. solid, wall, view, color, types: as for fsi
    dump.
    """
    print(animate.animate(*files, options=options))


def make_report(files, options):
    """fsi report [FOLDER] [log=FILE] [out=FILE.html]

    One page, readable without the folder and without a network: figures, pictures, curves, what the
    run cost, the effects that were on, warnings. FOLDER (default: this one) is what tools/run or
    LAMMPS left: log.lammps, or another log.* if it is the only one or log= names it, and what there
    is of summary.json, *.csv, *.png.
    """
    print(report.write(*files, out=options.get("out"), log_name=options.get("log")))


def make_check(files, options):
    """fsi check DECK [NAME=VALUE ...]

    Reads the whole deck and sets every run up without a step: prints the effects that are on and
    the advice of the package. Then estimates CPU time and memory by some steps of each run.
    NAME=VALUE, or -var NAME VALUE as for lmp. Nothing is overwritten, but by the deck's shell
    commands: it runs in a copy of what it names. Status 1 if there is advice or an error.
    """
    sys.exit(check.main(files[0], options))


# name: (function, fewest and most files and columns, options; None: any)
COMMANDS = {
    "log": (show_log, 1, 99, {"plot"}),
    "series": (show_series, 1, 99, {"plot"}),
    "frequency": (show_frequency, 1, 4, {"periods", "harmonics"}),
    "mean": (show_mean, 2, 99, {"from", "dx"}),
    "dump": (show_dump, 1, 99, {"plot", "frames", *animate.OPTIONS}),
    "vtk": (make_vtk, 1, 2, set()),
    "animate": (make_animation, 1, 2, {"rate", *animate.OPTIONS}),
    "report": (make_report, 0, 1, {"out", "log"}),
    "check": (make_check, 1, 1, None),
}


def _columns(table, wanted, source):
    """The wanted columns of {name: array}, by their own names or as LAMMPS variables (v_NAME); all
    if none is wanted."""
    found = {}
    for name in wanted or table:
        key = _key(table, name)
        if key is None:
            raise ValueError(f"{source} has no column {name}; it has {', '.join(table)}")
        found[name] = table[key]
    return found


def _key(table, name):
    """LAMMPS writes its own column time as Time."""
    return next((k for k in (name, f"v_{name}", f"c_{name}", f"f_{name}", name.capitalize())
                 if k in table), None)


def _show(table, wanted, source, options):
    """Prints columns as CSV, or draws the others over the first; a single one over the time, or
    over the table's first."""
    if "plot" in options and len(wanted) == 1:
        time = next((name for name in TIME if _key(table, name)), next(iter(table)))
        wanted = [time, *wanted]
    columns = _columns(table, wanted, source)
    if "plot" not in options:
        print(",".join(columns))
        for row in zip(*columns.values()):
            print(",".join(f"{value:.10g}" for value in row))
        return
    (first, x), *rest = columns.items()
    if not rest:
        raise ValueError(f"{source} has one column only: there is nothing to draw it over")
    plot.lines(options["plot"], first, rest[0][0] if len(rest) == 1 else "",
               [(x, y, name, COLOURS[k % len(COLOURS)]) for k, (name, y) in enumerate(rest)])
    print(options["plot"])


def main(arguments=None):
    """Command line."""
    arguments = list(sys.argv[1:] if arguments is None else arguments)
    name, *words = arguments or [""]
    if name == "fill":
        try:
            return fill.main(words)
        except OSError as error:
            sys.exit(f"fsi fill: {error}")
    if name in ("-h", "--help", "help"):
        print(__doc__)
        return None
    if name not in COMMANDS:
        sys.exit(__doc__ if not name else f"fsi: there is no command {name}; there are "
                 f"{', '.join([*COMMANDS, 'fill'])}")
    function, fewest, most, known = COMMANDS[name]
    if "-h" in words or "--help" in words:
        print(function.__doc__)
        return None
    while name == "check" and "-var" in words[:-2]:  # as lmp is given them
        k = words.index("-var")
        words[k : k + 3] = ["=".join(words[k + 1 : k + 3])]
    files, options = [], {}
    for word in words:
        key, equals, value = word.partition("=")
        if equals and key.isidentifier() and not Path(word).exists():
            if not value or known is not None and key not in known:
                sys.exit(f"fsi {name}: {word}: "
                         + ("a value is missing" if not value
                            else f"options are {', '.join(sorted(known)) or 'none'}"))
            options[key] = value
        else:
            files.append(word)
    if not fewest <= len(files) <= most:
        sys.exit("Usage: " + function.__doc__.split("\n")[0])
    try:
        result = function(files, options)
        sys.stdout.flush()
        return result
    except BrokenPipeError:  # whoever read has had enough, as head
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return None
    except (OSError, ValueError, Refusal) as error:
        sys.exit(f"fsi {name}: {error}")
