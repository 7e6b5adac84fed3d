"""Looks into what a run left. Usage, as `fsi` where it is installed (pip install ./python), else as `python3 -m fsi`:

    fsi log log.lammps                        what was run, how fast, figures, warnings
    fsi log log.lammps COLUMN ...             columns of the thermo output as CSV
    fsi series FILE [COLUMN ...]              the same of files of fix print (CSV) and fix ave/time
    fsi frequency FILE COLUMN [FROM [TO]]     of the largest peak of a column's spectrum, between two times
    fsi dump particles.dump                   frames, particles, columns and their ranges
    fsi vtk particles.dump [FOLDER]           for ParaView
    fsi animate particles.dump [FILE.mp4]     by ffmpeg
  plot=FILE.png behind log, series or dump draws instead: columns over the first one; snapshots of up to six frames (2D).
"""

import sys
from pathlib import Path

import numpy as np

from . import animate, dump, log, plot, series, vtk


def _columns(table, wanted, source):
    """The wanted columns of {name: array}, by their own names or as LAMMPS variables (v_NAME); all if none is wanted."""
    found = {}
    for name in wanted or table:
        key = next((k for k in (name, f"v_{name}", f"c_{name}", f"f_{name}") if k in table), None)
        if key is None:
            raise ValueError(f"{source} has no column {name}; it has {', '.join(table)}")
        found[name] = table[key]
    return found


def _show(columns, picture):
    """Prints columns as CSV, or draws the others over the first."""
    if picture:
        (first, x), *rest = columns.items()
        colours = [plot.BLUE, plot.ORANGE, plot.GREY]
        plot.lines(picture, first, rest[0][0] if len(rest) == 1 else "", [(x, y, name, colours[k % 3]) for k, (name, y) in enumerate(rest)])
        print(picture)
        return
    print(",".join(columns))
    for row in zip(*columns.values()):
        print(",".join(f"{value:.10g}" for value in row))


def show_log(path, wanted, picture):
    """fsi log"""
    found = log.read(path)
    if wanted or picture:
        names = dict.fromkeys(name for run in found.runs for name in run.thermo)
        table = {name: found.column(name) for name in names}
        if wanted and len({len(c) for c in _columns(table, wanted, path).values()}) > 1:
            raise ValueError(f"{path}: not every run has these columns")
        if not wanted:
            table = {name: values for name, values in table.items() if len(values) == max(map(len, table.values()))}
        return _show(_columns(table, wanted, path), picture)
    print(f"LAMMPS {found.version or 'of unknown version'}, {len(found.runs)} runs, {len(found.finished)} finished")
    for k, run in enumerate(found.finished, start=1):
        print(f"run {k}: {run.atoms} atoms, {run.steps} steps on {run.ranks} ranks in {run.loop_seconds:.4g} s"
              + (f", {run.atoms * run.steps / run.loop_seconds:.3g} particle-steps/s" if run.loop_seconds else ""))
        print("  columns: " + " ".join(run.thermo))
    for name, value in found.values.items():
        print(f"{name} = {value}")
    for line in found.warnings + found.errors:
        print(line)


def show_series(path, wanted, picture):
    """fsi series"""
    table = series.read_any(path).columns
    if any(values.ndim > 1 for values in table.values()):
        table = series.rows(table)
    _show(_columns(table, wanted, path), picture)


def show_frequency(path, wanted, picture):
    """fsi frequency"""
    if picture or not 1 <= len(wanted) <= 3:
        raise ValueError("frequency takes a column and perhaps two times")
    table = series.read_any(path).columns
    (first, time), *_ = table.items()
    column = _columns(table, wanted[:1], path)[wanted[0]]
    low, high = [*map(float, wanted[1:]), *(time[0], time[-1])[len(wanted) - 1:]]
    inside = (time >= low) & (time <= high)
    if inside.sum() < 8:
        raise ValueError(f"{path} has {inside.sum()} rows between {first} = {low:g} and {high:g}")
    print(f"{series.frequency(time[inside], column[inside]):.6g} per unit of {first}")


def show_dump(path, wanted, picture):
    """fsi dump"""
    if wanted:
        raise ValueError("dump takes no columns")
    frames = dump.read(path)
    if not frames:
        raise ValueError(f"{path} has no frames")
    if picture:
        some = [frames[k] for k in sorted({round(k) for k in np.linspace(0, len(frames) - 1, min(6, len(frames)))})]
        fluid, solid = animate.species(frames)
        plot.snapshots(picture, some, animate.spacing(frames[0]), fluid, solid)
        print(picture)
        return
    print(f"{len(frames)} frames from t = {frames[0].time:g} to {frames[-1].time:g}, {len(frames[0])} particles at first, "
          f"{len(frames[-1])} at last")
    for name, values in frames[-1].columns.items():
        print(f"  {name:12} {np.nanmin(values):.6g} to {np.nanmax(values):.6g}")


def main(arguments=None):
    """Command line."""
    arguments = list(sys.argv[1:] if arguments is None else arguments)
    if len(arguments) >= 2 and arguments[0] in ("vtk", "animate"):
        return {"vtk": vtk, "animate": animate}[arguments[0]].main(arguments[1:])
    show = {"log": show_log, "series": show_series, "frequency": show_frequency, "dump": show_dump}.get(arguments[0] if arguments else "")
    if show is None or len(arguments) < 2:
        sys.exit(__doc__)
    picture = next((a.split("=", 1)[1] for a in arguments[2:] if a.startswith("plot=")), None)
    try:
        show(Path(arguments[1]), [a for a in arguments[2:] if not a.startswith("plot=")], picture)
    except (OSError, ValueError) as error:
        sys.exit(f"fsi: {error}")


if __name__ == "__main__":
    main()
