"""Reads tables of numbers over time: comma separated, one header line, `#` starts a comment.

A deck writes one with `fix print ... file tip.csv title "time,tip_x" screen no`.
"""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np


AT_REST = 0.01  # of its range: what changes by less in the last tenth of its time has come to rest


@dataclass
class Series:
    """Columns by name, each an array (rows,); the first one is the time [s]."""

    columns: dict

    def __getitem__(self, name):
        return self.columns[name]

    def __contains__(self, name):
        return name in self.columns

    @property
    def time(self):
        """The first column, [s]."""
        return next(iter(self.columns.values()))

    def at(self, name, times):
        """Column `name` at `times`, interpolated linearly; NaN outside of the series."""
        return np.interp(times, self.time, self[name], left=np.nan, right=np.nan)

    def peak(self, name):
        """(value, time) of the largest entry of a column."""
        k = int(np.argmax(self[name]))
        return float(self[name][k]), float(self.time[k])


def read(path):
    """Reads a series; a last line that was cut off is left out."""
    lines = [line.strip() for line in Path(path).read_text().splitlines()]
    lines = [line for line in lines if line and not line.startswith("#")]
    if len(lines) < 2:
        raise ValueError(f"{path} has no rows")
    names = [name.strip() for name in lines[0].split(",")]
    if re.fullmatch(r"[-+.\deE, ]+", lines[0]):
        raise ValueError(f"{path} begins with numbers: expected names of columns, as fix print "
                         "writes them with its keyword title")
    parts = [[]]
    for line in lines[1:]:
        if line.endswith(lines[0]):  # perhaps behind a line that was cut off
            parts.append([])
        else:
            parts[-1].append(line.split(","))
    tables = []
    for rows in parts:
        if rows and len(rows[-1]) != len(names):
            rows.pop()
        table = np.array(rows, dtype=float).reshape(-1, len(names))
        tables.append({name: table[:, k] for k, name in enumerate(names)})
    return _joined(tables)


def _joined(parts):
    """The parts, {name: values}, of a file that runs have gone on with, each under titles of its
    own: what an earlier run wrote beyond the start of a later one is that one's again."""
    whole = parts[0]
    for part in parts[1:]:
        time, begins = next(iter(whole.values())), next(iter(part.values()))[:1]
        before = time < begins if len(begins) else np.full(len(time), True)
        whole = {name: np.concatenate([values[before], part[name]])
                 for name, values in whole.items()}
    return Series(whole)


def rms_distance(series, name, reference, reference_name, tolerance=1e-3):
    """Root mean square distance of a series to reference points, those beyond the series' end left
    out.

    A point at most `tolerance` [s] outside of the series is compared with its end, since the last
    line of a `fix print` may lie one interval before the end of the run.
    """
    times = reference.time
    inside = (times >= series.time[0] - tolerance) & (times <= series.time[-1] + tolerance)
    if not inside.any():
        return None
    clipped = np.clip(times[inside], series.time[0], series.time[-1])
    return float(
        np.sqrt(np.mean((series.at(name, clipped) - reference[reference_name][inside]) ** 2)))


def smooth(time, values, width):
    """Running mean over `width` [s], for equal steps of time; at the ends the first and last values
    go on."""
    n = max(1, round(width / (time[1] - time[0])))
    return np.convolve(np.pad(values, (n // 2, n - 1 - n // 2), mode="edge"), np.full(n, 1.0 / n),
                       mode="valid")


def frequency(time, values):
    """Where the spectrum is highest: Hann window, mean removed, the peak between the bins; at least
    two periods are needed."""
    n = len(time)
    even = np.linspace(time[0], time[-1], n)
    values = np.interp(even, time, values)
    window = np.hanning(n)
    size = np.abs(np.fft.rfft((values - np.average(values, weights=window)) * window, 16 * n))
    rate = np.fft.rfftfreq(16 * n, (even[-1] - even[0]) / (n - 1))
    # below is the window itself
    k = int(np.argmax(np.where(rate * (even[-1] - even[0]) < 1.5, 0.0, size)))
    if size[k] == 0.0 or k + 1 >= len(size):
        raise ValueError("there is no frequency in a constant")
    a, b, c = np.log(size[k - 1:k + 2])
    return float(rate[k] + 0.5 * (a - c) / (a - 2.0 * b + c) * rate[1])


def periodic(time, values, periods=3):
    """Each of the last whole periods of a signal: {"mean": (max+min)/2, "amplitude": (max-min)/2,
    "frequency", "count": of all whole periods}.

    A period goes from one rise through the middle between the extremes of the end to the next; a
    rise comes from below a quarter of the amplitude under the middle to above a quarter over it, so
    that noise makes none. None if there is no whole period.
    """
    try:
        recent = time >= time[-1] - (periods + 1.0) / frequency(time, values)
    except ValueError:
        return None
    low, high = values[recent].min(), values[recent].max()
    middle, quarter = 0.5 * (low + high), 0.125 * (high - low)
    rises, below = [], None
    for k, value in enumerate(values):
        if value < middle - quarter:
            below = k
        elif value > middle + quarter and below is not None:
            part = slice(below, k + 1)
            # through the middle, perhaps to and fro
            up = np.flatnonzero(np.diff(np.sign(values[part] - middle)))
            i = below + up
            rises.append(np.mean(time[i] + (middle - values[i]) / (values[i + 1] - values[i])
                                 * (time[i + 1] - time[i])))
            below = None
    if len(rises) < 2:
        return None
    found = {"mean": [], "amplitude": [], "frequency": [], "count": len(rises) - 1}
    for start, end in list(zip(rises, rises[1:]))[-periods:]:
        part = values[(time >= start) & (time <= end)]
        found["mean"].append(0.5 * (part.max() + part.min()))
        found["amplitude"].append(0.5 * (part.max() - part.min()))
        found["frequency"].append(1.0 / (end - start))
    return {name: np.array(value) if name != "count" else value for name, value in found.items()}


def swing(time, values, rate, periods=5, harmonics=4):
    """(mean, amplitude) of a noisy periodic signal of known frequency over its last whole periods:
    (max+min)/2 and (max-min)/2 of the harmonics fitted to it by least squares, so that sound
    between them does not count as `periodic` would have it.
    """
    periods = min(periods, int((time[-1] - time[0]) * rate + 1e-9))
    if periods < 1:
        raise ValueError("there is no whole period")
    late = time >= time[-1] - periods / rate
    phase = 2.0 * np.pi * rate * np.outer(np.arange(1, harmonics + 1), time[late])
    shapes = np.vstack([np.ones(late.sum()), np.cos(phase), np.sin(phase)])
    weights = np.gradient(time[late])  # steps of time vary
    fit = np.linalg.lstsq((shapes * np.sqrt(weights)).T, values[late] * np.sqrt(weights),
                          rcond=None)[0]
    phase = 2.0 * np.pi * np.outer(np.arange(1, harmonics + 1), np.linspace(0.0, 1.0, 721))
    curve = fit @ np.vstack([np.ones(721), np.cos(phase), np.sin(phase)])
    return 0.5 * (curve.max() + curve.min()), 0.5 * (curve.max() - curve.min())


def last_rise(time, values, rate, periods):
    """When the last `periods` whole periods of a noisy signal of known frequency begin, where its
    fundamental rises through its mean."""
    late = time >= time[-1] - periods / rate
    phase = 2.0 * np.pi * rate * time[late]
    weights = np.gradient(time[late])
    shapes = np.vstack([np.ones(late.sum()), np.cos(phase), np.sin(phase)])
    _, a, b = np.linalg.lstsq((shapes * np.sqrt(weights)).T, values[late] * np.sqrt(weights),
                              rcond=None)[0]
    rise = -np.arctan2(a, b) / (2.0 * np.pi * rate)
    return float(rise + np.floor((time[-1] - rise) * rate - periods) / rate)


def still_moving(time, values):
    """Share of its range by which a column went on in the last tenth of the time, if it is farthest
    from where it began there: it has neither swung back nor come to rest. None if it has.
    """
    late = np.flatnonzero(time >= time[-1] - 0.1 * (time[-1] - time[0]))
    farthest = int(np.argmax(np.abs(values - values[0])))
    whole = np.ptp(values)
    share = abs(values[farthest] - values[late[0]]) / whole if whole else 0.0
    return float(share) if farthest > late[0] and share > AT_REST else None


def steady(time, values, blocks=8):
    """(mean over time, its standard error by means of blocks, change from the first half to the
    second) of a column at uneven times."""
    edges = np.linspace(time[0], time[-1], blocks + 1)
    whole = np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(time))])
    means = np.diff(np.interp(edges, time, whole)) / np.diff(edges)
    half = blocks // 2
    return float(means.mean()), float(means.std(ddof=1) / np.sqrt(blocks)), float(
        means[half:].mean() - means[:half].mean())


def read_ave(path):
    """Reads a file of fix ave/time: columns over TimeStep, each (steps,); of mode vector (steps,
    rows)."""
    lines = Path(path).read_text().splitlines()
    starts = [k for k, line in enumerate(lines) if line.startswith("# Time-averaged")]
    if not starts or starts[0] != 0:
        raise ValueError(f"{path} is not a file of fix ave/time")
    parts = [_averages(lines[first:last]) for first, last in zip(starts, [*starts[1:], None])]
    parts = [part for part in parts if part]
    if not parts:
        raise ValueError(f"{path} has no rows")
    if any(list(part) != list(parts[0]) for part in parts):
        raise ValueError(f"{path}: its columns change")
    return _joined(parts)


def _averages(lines):
    """{name: values} of the lines of one fix ave/time; {} without rows."""
    titles = [line.lstrip("# ").split() for line in lines if line.startswith("#")]
    data = [[float(word) for word in line.split()] for line in lines
            if line.strip() and not line.startswith("#")]
    if len(titles) < 2 or not data:
        return {}
    if len(titles) == 2:
        names = titles[1]
        if len(data[-1]) != len(names):
            data.pop()  # cut off
        table = np.array(data).reshape(-1, len(names))
        return {name: table[:, k] for k, name in enumerate(names)}
    names, steps, blocks, k = titles[2][1:], [], [], 0
    while k < len(data):
        step, rows = data[k][0], int(data[k][1])
        block = data[k + 1:k + 1 + rows]
        if len(block) < rows or len(block[-1]) != len(names) + 1:
            break
        steps.append(step)
        blocks.append([row[1:] for row in block])
        k += 1 + rows
    table = np.array(blocks)  # (steps, rows, columns)
    return {"TimeStep": np.array(steps),
            **{name: table[:, :, k] for k, name in enumerate(names)}} if blocks else {}


def read_any(path):
    """A file of fix ave/time or of fix print, whichever it is."""
    with open(path, encoding="utf-8", errors="replace") as file:
        averaged = file.readline().startswith("# Time-averaged")
    return read_ave(path) if averaged else read(path)


def rows(columns):
    """Columns of mode vector as one column per row: NAME[1], NAME[2] ..."""
    return {name if values.ndim == 1 else f"{name}[{k + 1}]": values if values.ndim == 1
            else values[:, k]
            for name, values in columns.items()
            for k in range(1 if values.ndim == 1 else values.shape[1])}
