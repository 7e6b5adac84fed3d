"""Pictures in one style. Nothing here opens a window."""

import io
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, Normalize, to_rgba
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from PIL import Image, ImageChops, ImageStat

from . import dump, paint, series
from .summary import Summary

BLUE, ORANGE, GREY, GREEN, RED = "#1b5e96", "#d1611a", "#555555", "#3a923a", "#c23b3b"
FLUID_COLOURS, SOLID_COLOURS, WALL_COLOUR = "viridis", "inferno", "#a8a8a8"
LABELS = ("x [m]", "y [m]")
LARGEST = 85_000  # bytes of a picture
# radius over spacing: discs leave no gaps where particles are a little apart; spheres have others
# behind them
FLAT, ROUND = 0.8, 0.62
# on a dark ground: dark at rest, light where it is fast or strained
NIGHT, INK = "#0c1424", "#f2f5fa"
WATER = LinearSegmentedColormap.from_list("water",
                                          ("#123a7c", "#1a6fb8", "#2fb0dc", "#9be7f2", "#ffffff"))
STRESS = LinearSegmentedColormap.from_list("stress",
                                           ("#5b2b45", "#b93b3d", "#ee8231", "#ffd65c", "#fff6cf"))
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
DARK = {"figure.facecolor": NIGHT, "axes.facecolor": NIGHT, **dict.fromkeys(
    ("text.color", "axes.labelcolor", "axes.edgecolor", "xtick.color", "ytick.color"), INK)}


@contextmanager
def picture(path, width=6.4, height=4.0, night=False):
    """A figure [inch] in the house style, on a dark ground at `night`, saved to `path`, or to a
    file that is open, at the end of the block."""
    with matplotlib.rc_context(STYLE | (DARK if night else {})):
        figure = Figure(figsize=(width, height))
        yield figure
        drawn = io.BytesIO()
        figure.savefig(drawn, format="png")
    if hasattr(path, "write"):
        path.write(packed(drawn))
    else:
        Path(path).write_bytes(packed(drawn))


def packed(file, largest=LARGEST):
    """A picture as PNG with a palette, and, while it is larger than `largest` bytes, fewer pixels:
    at least half as many each way.

    64 colours, unless that changes it by more than 0.4 of 255 in the mean, as it does to fields;
    then 256.
    """
    whole = Image.open(file).convert("RGB")
    for share in (1.0, 0.85, 0.7, 0.6, 0.5):
        small = whole if share == 1.0 else whole.resize([round(share * n) for n in whole.size],
                                                        Image.Resampling.LANCZOS)
        found = io.BytesIO()
        for colours in (64, 256):
            # colours that cover what there is, not what there is most of: the ends of a colour bar
            # are rare
            drawn = small.quantize(colours, Image.Quantize.MAXCOVERAGE, kmeans=3,
                                   dither=Image.Dither.NONE)
            if (np.mean(ImageStat.Stat(ImageChops.difference(small, drawn.convert("RGB"))).mean)
                < 0.4):
                break
        drawn.save(found, "PNG", optimize=True)
        if found.tell() <= largest:
            break
    return found.getvalue()


def lines(path, time_label, value_label, curves, points=(), log_scale=False, levels=()):
    """Curves against reference points.

    curves: list of (x, y, label, colour); points: list of the same, drawn as markers; log_scale: of
    values, "xy": of both axes; levels: list of (y, label or ""), dashed lines of what a value
    should be.
    """
    with picture(path) as figure:
        axes = figure.add_subplot()
        for x, y, label, colour in curves:
            axes.plot(x, y, color=colour, label=label)
        _beside(axes, points, levels)
        if log_scale:
            axes.set_yscale("log")
        if log_scale == "xy":
            axes.set_xscale("log")
            axes.set_xticks(sorted({k for x, *_ in curves for k in x}), minor=False)
            axes.xaxis.set_major_formatter("{x:g}")
            axes.minorticks_off()
        axes.set_xlabel(time_label)
        axes.set_ylabel(value_label)
        shown = len(curves) + len(points) + len(levels)
        if shown > 3:  # curves that swing leave no room for as many
            axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, fontsize="small")
        elif shown > 1:
            axes.legend()
        figure.tight_layout()


def _beside(axes, points, levels):
    """What curves are compared with, as for lines()."""
    for x, y, label, colour in points:
        axes.plot(x, y, "o", markersize=5, markerfacecolor="white", markeredgewidth=1.3,
                  color=colour, label=label)
    for y, label in levels:
        axes.axhline(y, color=GREY, linestyle="--", linewidth=1.0, label=label or None)


def noisy(path, time_label, panels, window):
    """Curves over time one below the other: light as they are, dark their running means over
    `window`, which the label of the time tells.

    panels: list of (label of the values, curves, points, levels), these as for lines(); times at
    equal steps.
    """
    with picture(path, 7.4, 0.5 + 1.9 * len(panels)) as figure:
        for axes, (value_label, curves, points,
                   levels) in zip(np.ravel(figure.subplots(len(panels), 1, sharex=True)), panels):
            for x, y, _, colour in curves:
                axes.plot(x, y, color=colour, linewidth=0.5, alpha=0.25)
            for x, y, label, colour in curves:
                axes.plot(x, series.smooth(x, y, window), color=colour, label=label, linewidth=1.4)
            _beside(axes, points, levels)
            axes.set_ylabel(value_label)
            if sum(bool(label) for *_, label, _ in curves) + len(points) + sum(
                bool(label) for _, label in levels) > 1:
                axes.legend(loc="lower left", bbox_to_anchor=(0.0, 0.98), ncols=4, fontsize="small")
        axes.set_xlabel(f"{time_label}; dark: running means over {window:.2g}, light: as computed")
        figure.align_ylabels()
        figure.tight_layout()


def errors(path, resolution, label, curves):
    """Sizes of errors over a number of particles, both logarithmic; a filled mark is an error above
    0. curves: list of (n, error, label, colour)."""
    with picture(path, 6.4, 3.6) as figure:
        axes = figure.add_subplot()
        for (n, error, name, colour), mark in zip(curves, "os^vDP"):
            n, error = np.array(n, float), np.array(error, float)
            axes.plot(n, np.abs(error), "-", color=colour, linewidth=1.2)
            for above, fill in ((True, colour), (False, "white")):
                which = (error > 0.0) == above
                axes.plot(n[which], np.abs(error[which]), mark, color=colour, markerfacecolor=fill)
            axes.plot([], [], mark + "-", color=colour, label=name)
        axes.set(xscale="log", yscale="log", xlabel=resolution,
                 ylabel=f"{label}, size;\nhollow: below 0")
        ticks = sorted({n for curve in curves for n in curve[0]})
        axes.set_xticks(ticks, [f"{n:g}" for n in ticks])
        axes.yaxis.set_major_formatter("{x:g}")
        axes.minorticks_off()
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize="small")
        figure.tight_layout()


def deviations(path, depth, value, exact, scale, label, title):
    """One value per particle against depth: what it is off, in per cent of `scale`."""
    with picture(path, 5.2, 3.4) as figure:
        axes = figure.add_subplot()
        axes.plot(depth, 100.0 * (value - exact) / scale, ".", markersize=2.5, color=BLUE,
                  rasterized=True)
        axes.axhline(0.0, color=GREY, linestyle="--", linewidth=1.0)
        axes.set(xlabel="depth [m]", ylabel=label)
        axes.set_title(title, loc="left")
        figure.tight_layout()


def snapshots(path, frames, spacing, fluid=(1,), solid=(), limits=None, columns=3, panel_width=2.6,
              colour=None, labels=LABELS, wall=(),
              night=False):
    """A strip of snapshots: fluid coloured by pressure (column p), solids by von Mises stress
    (column vonmises), or both by column `colour`; walls are grey.

    fluid, solid, wall: atom types; limits ((xlo, xhi), (ylo, yhi)): the part of the plane that is
    shown, by default all particles; panel_width [inch]. Particles are discs that touch, `spacing`
    [m] apart. Colours mean the same in all panels.
    """
    if not frames:
        return
    (xlo, xhi), (ylo, yhi) = limits or _extent(frames, spacing)
    columns = min(columns, len(frames))
    rows = -(-len(frames) // columns)
    panel_height = panel_width * (yhi - ylo) / (xhi - xlo)
    left, bottom, gap, title = *((0.74, 0.42) if labels else (0.14, 0.14)), 0.14, 0.24
    scales = _scales(frames, fluid, solid, colour, night)
    bar_distance = 0.92
    width = left + columns * (panel_width + gap) + bar_distance * len(scales)
    decimals = _decimals(frames)
    height = bottom + rows * (panel_height + title + gap)

    with picture(path, width, height, night) as figure:
        for k, frame in enumerate(frames):
            row, column = divmod(k, columns)
            axes = _axes(figure, left + column * (panel_width + gap), bottom + (rows - 1 - row)
                         * (panel_height + title + gap),
                         panel_width, panel_height)
            _particles(axes, frame, scales, spacing, ((xlo, xhi), (ylo, yhi)), wall)
            axes.set_title(f"t = {frame.time:.{decimals}f} s", loc="left", pad=3)
            if labels is None:
                axes.axis("off")
                continue
            # the last label would run into the next panel's first one
            axes.xaxis.set_major_locator(MaxNLocator(4, prune="upper"))
            axes.yaxis.set_major_locator(MaxNLocator(4))
            axes.tick_params(labelleft=column == 0, labelbottom=row == rows - 1 or k + columns
                             >= len(frames))
            if column == 0:
                axes.set_ylabel(labels[1])
            if row == rows - 1:
                axes.set_xlabel(labels[0])
        for k, scale in enumerate(scales):
            _bar(figure, scale, left + columns * (panel_width + gap) + 0.1 + bar_distance * k,
                 bottom, height - bottom - title - gap)


def bodies(folder, cases, add, draw, every=2, **shown):
    """Figures and pictures of a study of bodies in water, whose last case is judged, or of one run,
    the case "SPH"; returns the summary.

    add(summary, folder, suffix, target) adds the figures of a case, draw(folder, cases) draws their
    curves. Each `every`th picture of the last shows the speed of the water; bodies, type 2, are
    grey. shown: as for snapshots().
    """
    summary = Summary(folder)
    *_, last = cases
    for name, path in cases.items():
        add(summary, path, "" if name == "SPH" else f"_{name}", 0.05 if name == last else None)
    draw(folder, cases)
    frames = dump.read(Path(cases[last]) / "particles.dump")
    for frame in frames:
        frame.columns["speed"] = np.hypot(frame["vx"], frame["vy"])
    snapshots(Path(folder) / "snapshots.png", frames[1::every], dump.spacing(frames[0]),
              colour="speed", wall=(2,), columns=2, labels=None, **shown)
    return summary.write()


def movie(folder, frames, spacing, fluid=(1,), solid=(), width=8.0, colour=None, labels=LABELS,
          progress=None, wall=()):
    """Numbered pictures folder/00000.png ... of all frames, as snapshots in one panel each with the
    same limits and colours."""
    (xlo, xhi), (ylo, yhi) = _extent(frames, spacing)
    scales = _scales(frames, fluid, solid, colour)
    decimals = max(3, _decimals(frames))
    bar = 0.9 * len(scales)
    panel = width - bar - 0.8
    height = max(panel * (yhi - ylo) / (xhi - xlo), 0.8)
    for k, frame in enumerate(frames):
        with picture(folder / f"{k:05d}.png", width, height + 0.75) as figure:
            axes = _axes(figure, 0.7, 0.45, panel, height)
            _particles(axes, frame, scales, spacing, ((xlo, xhi), (ylo, yhi)), wall)
            axes.set_title(f"t = {frame.time:.{decimals}f} s", loc="left", pad=3)
            if labels is None:
                axes.axis("off")
            else:
                axes.set(xlabel=labels[0], ylabel=labels[1])
            for n, scale in enumerate(scales):
                _bar(figure, scale, 0.85 + panel + 0.9 * n, 0.45, height)
        if progress:
            progress((k + 1) / len(frames))


def seen(frames, view):
    """(frames in three dimensions as a picture's plane, labels of its axes or None): columns x and
    y are across and up, `depth` grows towards the eye.

    view: "x", "y" or "z", along that axis; "AZIMUTH,ELEVATION[,UP]" [degrees], UP the axis that
    points up, by default z.
    """
    words = view.split(",")
    try:
        if view in ("x", "y", "z"):
            across, up = {"x": (1, 2), "y": (0, 2), "z": (0, 1)}[view]
            basis = np.zeros((3, 3))
            basis[0, across] = basis[1, up] = 1.0
            labels = tuple(f"{'xyz'[k]} [m]" for k in (across, up))
        else:
            azimuth, elevation = (np.radians(float(word)) for word in words[:2])
            a, b, k = {"x": ((0, 1, 0), (0, 0, 1), (1, 0, 0)),
                       "y": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
                       "z": np.eye(3)}[words[2] if len(words) == 3 else "z"]
            a, b, k = map(np.array, (a, b, k))
            # the eye is in front of -b, turned by the azimuth towards a and raised by the elevation
            ahead = -np.sin(azimuth) * a + np.cos(azimuth) * b
            basis = np.array([np.cos(azimuth) * a + np.sin(azimuth) * b, np.sin(elevation) * ahead
                              + np.cos(elevation) * k, (0, 0, 0)])
            labels = None
        basis[2] = np.cross(basis[0], basis[1])
        if len(words) > 3:
            raise ValueError
    except (KeyError, ValueError):
        raise ValueError(f"view={view}: x, y, z or AZIMUTH,ELEVATION[,y] is needed, such as "
                         "view=30,20") from None
    turned = []
    for frame in frames:
        points = (np.column_stack([frame[a] if a in frame else np.zeros(len(frame)) for a in "xyz"])
                  @ basis.T)
        turned.append(replace(frame, columns={**frame.columns, "x": points[:, 0], "y": points[:, 1],
                                              "depth": points[:, 2]}))
    return turned, labels


def _decimals(frames):
    """Of times in titles, so that neighbouring frames differ."""
    steps = np.diff([frame.time for frame in frames])
    return int(np.clip(np.ceil(-np.log10(np.min(steps[steps > 0.0])) - 1e-6), 2, 9)) if (
        steps > 0.0).any() else 2


def _axes(figure, left, bottom, width, height):
    """Axes at a place [inch]."""
    across, up = figure.get_size_inches()
    return figure.add_axes((left / across, bottom / up, width / across, height / up))


def _particles(axes, frame, scales, spacing, limits, wall=()):
    """A disc for each particle of a frame, coloured by _scales(); a sphere in those that have a
    depth."""
    which = [np.flatnonzero(np.isin(frame["type"], wall))]
    colours = [np.tile(to_rgba(WALL_COLOUR), (len(which[0]), 1))]
    for types, name, cmap, norm, scale, _ in scales:
        part = np.flatnonzero(np.isin(frame["type"], types))
        which.append(part)
        colours.append(matplotlib.colormaps.get_cmap(cmap)(norm(frame[name][part] / scale)))
    which, colours = np.concatenate(which), np.concatenate(colours)
    field(axes, frame["x"][which], frame["y"][which], spacing, colours, limits,
          frame["depth"][which] if "depth" in frame else None)


def field(axes, x, y, spacing, colours, limits, depth=None):
    """Particles as discs that touch, or as spheres where they have a depth, in axes that show
    `limits` of the plane.

    spacing: of all or of each, in the unit of x and y; colours (particles, 3 or 4).
    """
    (xlo, xhi), (ylo, yhi) = limits
    across, up = axes.figure.get_size_inches()
    place = axes.get_position()
    pixels = [max(1, round(STYLE["savefig.dpi"] * n))
              for n in (across * place.width, up * place.height)]
    share = FLAT if depth is None else ROUND
    axes.imshow(paint.discs(pixels, limits, x, y, share * np.asarray(spacing), colours, depth),
                extent=(xlo, xhi, ylo, yhi), aspect="auto", interpolation="nearest")
    axes.set(xlim=(xlo, xhi), ylim=(ylo, yhi), aspect="equal")
    axes.grid(False)


def _bar(figure, scale, left, bottom, height):
    """The colours of one of _scales()."""
    _, _, colours, norm, _, label = scale
    figure.colorbar(ScalarMappable(norm, colours), cax=_axes(figure, left, bottom, 0.13, height),
                    label=label, extend="both" if norm.vmin else "max")


def _extent(frames, spacing):
    """Smallest limits that show all particles of all frames."""
    every = (np.concatenate([frame[name] for frame in frames]) for name in ("x", "y"))
    return [(values.min() - spacing, values.max() + spacing) for values in every]


def _scales(frames, fluid, solid, colour=None, night=False):
    """(types, column, colour map, range, unit's size, label) for each kind of particle, over all
    frames."""
    water, strained = (WATER, STRESS) if night else (FLUID_COLOURS, SOLID_COLOURS)
    if colour:
        values = np.concatenate([frame.of_types(*fluid, *solid)[colour] for frame in frames])
        low, high = np.nanpercentile(values, (0.5, 99.5))
        label = "speed [m/s]" if colour == "speed" else colour
        return [((*fluid, *solid), colour, water, Normalize(low, max(high, low + 1e-30)), 1.0,
                 label)]
    scales = []
    for types, name, colours, title in ((fluid, "p", water, "pressure"),
                                        (solid, "vonmises", strained, "von Mises stress")):
        parts = [frame.of_types(*types) for frame in frames if name in frame]
        if not types or not any(len(part) for part in parts):
            continue
        # single particles far off the rest would leave the picture in one colour
        low, top = np.nanpercentile(np.concatenate([part[name] for part in parts]), (0.5, 99.5))
        # from 0, unless a background keeps all pressures far above it, or suction well below
        low = float(low) if low > 0.3 * top or low < -0.05 * abs(top) else 0.0
        size = max(top, -low)
        unit, scale = ("MPa", 1e6) if size >= 1e6 else ("kPa",
                                                        1e3) if size >= 100.0 else ("Pa", 1.0)
        scales.append((types, name, colours,
                       Normalize(low / scale, max(top / scale, low / scale + 1e-30)), scale,
                       f"{title} [{unit}]"))
    return scales


def clouds(path, panels, spacing, limits, label, extent=None, axis_labels=("x [m]", "y [m]"),
           panel_width=2.6, colours=FLUID_COLOURS, columns=None,
           marks=()):
    """Particles side by side, coloured by any value: panels lists (title, x, y, value), limits as
    for snapshots.

    A fifth entry of a panel is the depth, which grows towards the eye: particles are spheres then,
    otherwise discs that touch, `spacing` apart. extent (lowest, highest): the range of colours, by
    default that of the values; marks: crosses in all panels, (x, y, label).
    """
    (xlo, xhi), (ylo, yhi) = limits
    found = min(p[3].min() for p in panels), max(p[3].max() for p in panels)
    low, high = extent or found
    norm = Normalize(low, high)
    left, bottom, gap, title, bar = 0.74, 0.44, 0.16, 0.26, 1.05
    columns = min(columns or len(panels), len(panels))
    rows = -(-len(panels) // columns)
    panel_height = panel_width * (yhi - ylo) / (xhi - xlo)
    width, height = left + columns * (panel_width + gap) + bar, bottom + rows * (
        panel_height + title)
    with picture(path, width, height) as figure:
        for k, (name, x, y, value, *depth) in enumerate(panels):
            row, column = divmod(k, columns)
            axes = _axes(figure, left + column * (panel_width + gap), bottom + (rows - 1 - row)
                         * (panel_height + title), panel_width, panel_height)
            field(axes, x, y, spacing, matplotlib.colormaps.get_cmap(colours)(norm(value)), limits,
                  *depth)
            axes.set_title(name, loc="left", pad=3)
            axes.xaxis.set_major_locator(MaxNLocator(4, prune="upper"))
            axes.yaxis.set_major_locator(MaxNLocator(4))
            axes.tick_params(labelleft=column == 0, labelbottom=row == rows - 1)
            for across, up, text in marks:
                axes.plot(across, up, "+", color=BLUE, markersize=12, markeredgewidth=1.8,
                          label=text)
                axes.legend(loc="lower left")
            if row == rows - 1:
                axes.set_xlabel(axis_labels[0])
            if column == 0:
                axes.set_ylabel(axis_labels[1])
        axes = _axes(figure, left + columns * (panel_width + gap), bottom, 0.12,
                     height - bottom - title)
        beyond = {(False, False): "neither", (True, False): "min", (False, True): "max",
                  (True, True): "both"}[found[0] < low, found[1] > high]
        figure.colorbar(ScalarMappable(norm, colours), cax=axes, label=label, extend=beyond)
