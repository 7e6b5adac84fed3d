"""Pictures in one style. Nothing here opens a window."""

from contextlib import contextmanager

import matplotlib
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

BLUE, ORANGE, GREY, GREEN, RED = "#1b5e96", "#d1611a", "#555555", "#3a923a", "#c23b3b"
FLUID_COLOURS, SOLID_COLOURS = "viridis", "inferno"
STYLE = {
    "font.size": 9,
    "axes.titlesize": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "lines.linewidth": 1.6,
    "legend.frameon": False,
    "savefig.dpi": 160,
}


@contextmanager
def picture(path, width=6.4, height=4.0):
    """A figure [inch] in the house style, saved to `path` at the end of the block."""
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(width, height))
        yield figure
        figure.savefig(path)


def lines(path, time_label, value_label, curves, points=(), log_scale=False):
    """Curves against reference points.

    curves: list of (x, y, label, colour); points: list of the same, drawn as markers.
    """
    with picture(path) as figure:
        axes = figure.add_subplot()
        for x, y, label, colour in curves:
            axes.plot(x, y, color=colour, label=label)
        for x, y, label, colour in points:
            axes.plot(x, y, "o", markersize=5, markerfacecolor="white", markeredgewidth=1.3, color=colour, label=label)
        if log_scale:
            axes.set_yscale("log")
        axes.set_xlabel(time_label)
        axes.set_ylabel(value_label)
        if len(curves) + len(points) > 1:
            axes.legend()
        figure.tight_layout()


def scatter_against_line(path, x, y, line_x, line_y, labels, axis_labels):
    """One value per particle against the line where it should be. labels: (particles, line)."""
    with picture(path, 5.2, 4.2) as figure:
        axes = figure.add_subplot()
        axes.plot(x, y, ".", markersize=2.5, color=BLUE, label=labels[0], rasterized=True)
        axes.plot(line_x, line_y, color=ORANGE, label=labels[1])
        axes.set_xlabel(axis_labels[0])
        axes.set_ylabel(axis_labels[1])
        axes.legend(markerscale=4)
        figure.tight_layout()


def snapshots(path, frames, spacing, fluid=(1,), solid=(), limits=None, columns=3, panel_width=2.6):
    """A strip of snapshots: fluid coloured by pressure (column p), solids by von Mises stress (column vonmises).

    fluid, solid: atom types; limits ((xlo, xhi), (ylo, yhi)): the part of the plane that is shown, by default all
    particles; panel_width [inch]. Each particle is a square a little wider than `spacing` [m], so that a body has no
    gaps. Colours mean the same in all panels.
    """
    if not frames:
        return
    (xlo, xhi), (ylo, yhi) = limits or _extent(frames, spacing)
    columns = min(columns, len(frames))
    rows = -(-len(frames) // columns)
    panel_height = panel_width * (yhi - ylo) / (xhi - xlo)
    left, bottom, gap, title = 0.74, 0.42, 0.14, 0.24
    scales = _scales(frames, fluid, solid)
    bar_distance = 0.92
    width = left + columns * (panel_width + gap) + bar_distance * len(scales)
    height = bottom + rows * (panel_height + title + gap)

    with picture(path, width, height) as figure:
        for k, frame in enumerate(frames):
            row, column = divmod(k, columns)
            axes = _axes(figure, left + column * (panel_width + gap), bottom + (rows - 1 - row) * (panel_height + title + gap),
                         panel_width, panel_height)
            _particles(axes, frame, scales, 1.3 * spacing * panel_width / (xhi - xlo))
            axes.set(xlim=(xlo, xhi), ylim=(ylo, yhi), aspect="equal")
            axes.set_title(f"t = {frame.time:.2f} s", loc="left", pad=3)
            # the last label would run into the next panel's first one
            axes.xaxis.set_major_locator(MaxNLocator(4, prune="upper"))
            axes.yaxis.set_major_locator(MaxNLocator(4))
            axes.tick_params(labelleft=column == 0, labelbottom=row == rows - 1 or k + columns >= len(frames))
            if column == 0:
                axes.set_ylabel("y [m]")
            if row == rows - 1:
                axes.set_xlabel("x [m]")
        for k, scale in enumerate(scales):
            _bar(figure, scale, left + columns * (panel_width + gap) + 0.1 + bar_distance * k, bottom, height - bottom - title - gap)


def movie(folder, frames, spacing, fluid=(1,), solid=(), width=8.0):
    """Numbered pictures folder/00000.png ... of all frames, as snapshots in one panel each with the same limits and colours."""
    (xlo, xhi), (ylo, yhi) = _extent(frames, spacing)
    scales = _scales(frames, fluid, solid)
    bar = 0.9 * len(scales)
    panel = width - bar - 0.8
    height = max(panel * (yhi - ylo) / (xhi - xlo), 0.8)
    for k, frame in enumerate(frames):
        with picture(folder / f"{k:05d}.png", width, height + 0.75) as figure:
            axes = _axes(figure, 0.7, 0.45, panel, height)
            _particles(axes, frame, scales, 1.3 * spacing * panel / (xhi - xlo))
            axes.set(xlim=(xlo, xhi), ylim=(ylo, yhi), aspect="equal", xlabel="x [m]", ylabel="y [m]")
            axes.set_title(f"t = {frame.time:.3f} s", loc="left", pad=3)
            for n, scale in enumerate(scales):
                _bar(figure, scale, 0.85 + panel + 0.9 * n, 0.45, height)


def _axes(figure, left, bottom, width, height):
    """Axes at a place [inch]."""
    across, up = figure.get_size_inches()
    return figure.add_axes((left / across, bottom / up, width / across, height / up))


def _particles(axes, frame, scales, side):
    """A square of `side` [inch] for each particle of a frame."""
    for types, name, colours, norm, scale, _ in scales:
        part = frame.of_types(*types)
        axes.scatter(part["x"], part["y"], s=(72.0 * side)**2, c=part[name] / scale, marker="s", linewidths=0, cmap=colours, norm=norm)
    axes.grid(False)


def _bar(figure, scale, left, bottom, height):
    """The colours of one of _scales()."""
    _, _, colours, norm, _, label = scale
    figure.colorbar(ScalarMappable(norm, colours), cax=_axes(figure, left, bottom, 0.13, height), label=label, extend="max")


def _extent(frames, spacing):
    """Smallest limits that show all particles of all frames."""
    return [(min(f[name].min() for f in frames) - spacing, max(f[name].max() for f in frames) + spacing)
            for name in ("x", "y")]


def _scales(frames, fluid, solid):
    """(types, column, colour map, range, unit's size, label) for each kind of particle, over all frames."""
    scales = []
    for types, name, colours, title in ((fluid, "p", FLUID_COLOURS, "pressure"),
                                        (solid, "vonmises", SOLID_COLOURS, "von Mises stress")):
        parts = [frame.of_types(*types) for frame in frames if name in frame]
        if not types or not any(len(part) for part in parts):
            continue
        # single particles far off the rest would leave the picture in one colour
        top = float(np.nanpercentile(np.concatenate([part[name] for part in parts]), 99.5))
        unit, scale = ("MPa", 1e6) if top >= 1e6 else ("kPa", 1e3) if top >= 100.0 else ("Pa", 1.0)
        scales.append((types, name, colours, Normalize(0.0, max(top / scale, 1e-30)), scale, f"{title} [{unit}]"))
    return scales


def clouds(path, panels, spacing, limits, label, extent=None, axis_labels=("x [m]", "y [m]"), panel_width=2.6, colours=FLUID_COLOURS):
    """Particles side by side, coloured by any value: panels lists (title, x, y, value), limits as for snapshots.

    extent (lowest, highest): the range of colours, by default that of the values. Particles are discs as wide as `spacing`, so
    that gaps and clumps show.
    """
    (xlo, xhi), (ylo, yhi) = limits
    low, high = extent or (min(p[3].min() for p in panels), max(p[3].max() for p in panels))
    norm = Normalize(low, high)
    left, bottom, gap, title, bar = 0.62, 0.44, 0.16, 0.26, 1.05
    panel_height = panel_width * (yhi - ylo) / (xhi - xlo)
    width, height = left + len(panels) * (panel_width + gap) + bar, bottom + panel_height + title
    with picture(path, width, height) as figure:
        for k, (name, x, y, value) in enumerate(panels):
            axes = _axes(figure, left + k * (panel_width + gap), bottom, panel_width, panel_height)
            axes.scatter(x, y, s=(0.9 * spacing * panel_width * 72.0 / (xhi - xlo))**2, c=value, linewidths=0, cmap=colours,
                         norm=norm, rasterized=True)
            axes.set(xlim=(xlo, xhi), ylim=(ylo, yhi), aspect="equal", xlabel=axis_labels[0])
            axes.set_title(name, loc="left", pad=3)
            axes.grid(False)
            axes.xaxis.set_major_locator(MaxNLocator(4, prune="upper"))
            axes.yaxis.set_major_locator(MaxNLocator(4))
            axes.tick_params(labelleft=k == 0)
            if k == 0:
                axes.set_ylabel(axis_labels[1])
        axes = _axes(figure, left + len(panels) * (panel_width + gap), bottom, 0.12, panel_height)
        figure.colorbar(ScalarMappable(norm, colours), cax=axes, label=label)
