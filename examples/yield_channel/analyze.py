#!/usr/bin/env python3
"""Figures and pictures of fluids with a yield stress or a power law in a channel.   usage:
analyze.py FOLDER

main reads flow.csv, particles.dump and run.json of one run; study compares the runs of cases.json.
Half width, density, force: 1.
"""

import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, plot, series  # noqa: E402
from fsi.summary import RUN_FILE, Summary  # noqa: E402

SOURCE, CENTER = "theory", "theory, law with m"  # [(tau_w - tau_y)^2/(2 mu) + tau_y/m]/G
STOPS = "finite differences, law with m"  # stopping()
PARTS = 0.1, 0.01  # of the steady flow
COLORS = (plot.BLUE, plot.ORANGE, plot.GREEN)


def settings(folder):
    """(name of the law, its parameters, rows, when the force ends) of a run"""
    given = json.loads((Path(folder) / RUN_FILE).read_text())["variables"]
    name, *values = given["law"].split()
    return name, [float(x) for x in values if "/" not in x], int(given["rows"]), float(
        given["tend"])


def viscosity(rate, tau, K, n, m):
    """Herschel and Bulkley's law, regularized by Papanastasiou"""
    rate = np.maximum(rate, 1e-12)
    return -tau * np.expm1(-m * rate) / rate + K * rate**(n - 1)


def steady(y, name, p):
    """Velocity at y"""
    if name == "power":
        K, n = p[:2]
        return n / (n + 1) * K**(-1 / n) * (1 - np.abs(y)**((n + 1) / n))
    z = np.linspace(0, 1, 4001)
    # the rate that has the stress z, by bisection
    low, high = np.zeros_like(z), np.full_like(z, 10.0)
    for _ in range(60):
        middle = 0.5 * (low + high)
        less = viscosity(middle, *p) * middle < z
        low, high = np.where(less, middle, low), np.where(less, high, middle)
    u = np.concatenate([[0], np.cumsum((0.5 * (low[1:] + low[:-1]) * np.diff(z))[::-1])])[::-1]
    return np.interp(np.abs(y), z, u)


def stopping(p, parts=PARTS, rows=400, dt=1e-4):
    """When the mean velocity is these parts of the steady one, after the force is turned off:
    implicit in time, half of the channel"""
    y = (np.arange(rows) + 0.5) / rows
    u = steady(y, "", p)
    flow, t, before, found = u.mean(), 0.0, 1.0, []
    while len(found) < len(parts):
        rate = np.abs(np.diff(np.concatenate([[u[0]], u, [-u[-1]]]))) * rows
        k = viscosity(rate, *p) * rows**2 * dt
        k[0] = 0.0  # symmetry in the middle
        lower, upper, diagonal = -k[1:-1], -k[1:-1], 1 + k[:-1] + k[1:]
        diagonal[-1] += k[-1]  # no slip, half a cell away
        u = tridiagonal(lower, diagonal, upper, u)
        t, now = t + dt, u.mean() / flow
        for part in parts[len(found):]:
            if now < part:
                found.append(t - dt * (part - now) / (before - now))
        before = now
    return found


def tridiagonal(lower, diagonal, upper, right):
    """Solution of a system, by elimination"""
    d, r = diagonal.copy(), right.copy()
    for k in range(1, len(d)):
        share = lower[k - 1] / d[k - 1]
        d[k] -= share * upper[k - 1]
        r[k] -= share * r[k - 1]
    r[-1] /= d[-1]
    for k in range(len(d) - 2, -1, -1):
        r[k] = (r[k] - upper[k] * r[k + 1]) / d[k]
    return r


def judge(summary, name, value, unit, reference, source, target):
    """A figure, and the size of its error if it has a target"""
    summary.add(name, value, unit, reference, source)
    if target is not None:
        summary.add(f"error_of_{name}", abs(value / reference - 1), "", None, None, target)


def add(summary, folder, suffix="", judged=True):
    """The figures of one run"""
    name, p, _, tend = settings(folder)
    frame, flow = dump.read(Path(folder) / "particles.dump")[1], series.read(
        Path(folder) / "flow.csv")
    v, exact = frame["vx"], steady(frame["y"], name, p)
    target = 0.01 if judged else None
    error = np.sqrt(np.mean((v - exact)**2) / np.mean(exact**2))
    summary.add("velocity_error" + suffix, error, "", None, None, target if name == "power"
                else None)
    if name == "power":
        judge(summary, "mean_over_largest" + suffix, v.mean() / v.max(), "",
              (p[1] + 1) / (2 * p[1] + 1), SOURCE, target)
        return
    tau, K, n, m = p
    if n == 1:
        judge(summary, "center_velocity" + suffix, v.max(), "m/s", (1 - tau)**2 / (2 * K) + tau / m,
              CENTER, target)
    after = flow.time >= tend
    t, part = flow.time[after] - tend, flow["mean"][after]
    for limit, time in zip(PARTS, stopping(p)):
        if part[-1] < limit * part[0]:
            judge(summary, f"stops_{limit:g}{suffix}", np.interp(-limit, -part / part[0], t), "s",
                  time, STOPS, 0.03 if judged else None)


def draw(folder, cases):
    """Velocity across half of the channel"""
    with plot.picture(Path(folder) / "velocity.png", 4.8, 3.0) as figure:
        axes = figure.add_subplot()
        for (name, path), color in zip(cases.items(), COLORS):
            law, p, *_ = settings(path)
            frame, y = dump.read(Path(path) / "particles.dump")[1], np.linspace(0, 1, 201)
            axes.plot(y, steady(y, law, p), color=color, label=f"{name}, theory")
            rows, first = np.unique(np.round(frame["y"], 6), return_index=True)
            axes.plot(rows[rows > 0][::2], frame["vx"][first][rows > 0][::2], "o", color=color,
                      markersize=4, markerfacecolor="white")
        axes.set(xlabel="y [m]", ylabel="velocity [m/s]")
        axes.legend()
        figure.tight_layout()


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    summary = Summary(folder)
    add(summary, folder)
    draw(folder, {settings(folder)[0]: folder})
    return summary.write()


def study(folder, cases):
    """Figures of all cases"""
    summary = Summary(folder)
    for name, path in cases.items():
        add(summary, path, f"_{name}", "rows" not in name)
    draw(folder, {text: cases[name] for text, name in (("power law, n = 0.25", "power_0.25"),
                                                       ("n = 2", "power_2"), ("Bingham", "0.5_100"))
                  if name in cases})
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
