#!/usr/bin/env python3
"""Figures and pictures of the ring in an annulus.   usage: analyze.py FOLDER

main reads ring.csv, particles.dump and log.lammps of one run and writes summary.json, ring.png and
fields.png beside them; study compares the runs of cases.json, above all the frequency in each fluid
with that of the ring alone.
"""

import shutil
import sys
from dataclasses import replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, log, plot, series  # noqa: E402
from fsi.summary import Summary  # noqa: E402

FLUID, RING, WALL = 1, 2, 3
INNER, OUTER, RIGID = 0.95, 1.05, 1.5  # [m]
YOUNG, POISSON, DENSITY, MODE = 1.0e6, 0.3, 1000.0, 2
THEORY = "elastic ring in a potential flow"
AMPLITUDE = 5e-4  # [m] of the test of solids4foam
# targets: of the frequencies' ratio, of the amplitude lost in a period
RATIO, DAMPING = 0.005, 0.02
COLOURS = (plot.GREY, plot.BLUE, plot.GREEN, plot.ORANGE)


def added_mass(density):
    """Mass per area [kg/m^2] that moves with the ring's face in mode n. Potential flow without flux
    through the wall at b: phi = (r^n + b^2n/r^n) cos n theta; pressure -density dphi/dt over the
    acceleration d(dphi/dr)/dt, at r = R."""
    n, b, r = MODE, RIGID, OUTER
    return density * r / n * (b**(2 * n) + r**(2 * n)) / (b**(2 * n) - r**(2 * n))


def mass_ratio(density):
    """Added mass over that of a thin ring that is not stretched: u_t = -u_r/n takes part in its
    inertia, 1 + 1/n^2 times that of u_r."""
    middle = 0.5 * (INNER + OUTER)
    return MODE**2 / (MODE**2 + 1) * added_mass(density) * OUTER / (DENSITY * (OUTER - INNER)
                                                                    * middle)


def compressible_mass(density, wavenumber):
    """added_mass of a fluid with sound: wavenumber = angular frequency/speed of sound; Helmholtz'
    equation by Runge and Kutta's method."""
    radii = np.linspace(RIGID, OUTER, 201)
    step, state = radii[1] - radii[0], np.array([1.0, 0.0])

    def rate(r, y):
        return np.array([y[1], -y[1] / r + (MODE**2 / r**2 - wavenumber**2) * y[0]])

    for r in radii[:-1]:
        a = rate(r, state)
        b = rate(r + 0.5 * step, state + 0.5 * step * a)
        c = rate(r + 0.5 * step, state + 0.5 * step * b)
        d = rate(r + step, state + step * c)
        state = state + step / 6.0 * (a + 2.0 * b + 2.0 * c + d)
    return -density * state[0] / state[1]


def theory(density=0.0, sound=np.inf, terms=8):
    """Angular frequency [rad/s] of the mode: plane strain without assumptions on the thickness, by
    Ritz' method.

    u_r = U(r) cos n theta, u_t = V(r) sin n theta, both Legendre polynomials in r; the fluid adds
    its mass at the outer face.
    """
    shear, lame = YOUNG / (2.0 * (1.0 + POISSON)), YOUNG * POISSON / ((1.0 + POISSON)
                                                                      * (1.0 - 2.0 * POISSON))
    at, weights = np.polynomial.legendre.leggauss(2 * terms)
    half = 0.5 * (OUTER - INNER)
    r = 0.5 * (OUTER + INNER) + half * at
    basis = [np.polynomial.legendre.Legendre.basis(k) for k in range(terms)]
    value, slope, none = (np.array([p(at) for p in basis]), np.array([p.deriv()(at) for p in basis])
                          / half, np.zeros((terms, len(at))))
    radial = np.vstack([slope, none])
    hoop = np.vstack([value, MODE * value]) / r
    sliding = np.vstack([-MODE * value / r, slope - value / r])
    area = half * weights * r
    stiffness = lame * ((radial + hoop) * area) @ (radial
                                                   + hoop).T + shear * (sliding * area) @ sliding.T
    stiffness += 2.0 * shear * ((radial * area) @ radial.T + (hoop * area) @ hoop.T)
    own = DENSITY * np.kron(np.eye(2), (value * area) @ value.T)
    face = np.append(np.ones(terms), np.zeros(terms))  # U at the outer face
    omega, added = 0.0, added_mass(density)
    for _ in range(6 if np.isfinite(sound) and density else 1):
        mass = own + added * OUTER * np.outer(face, face)
        squares = np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real
        omega = np.sqrt(squares.min())
        added = compressible_mass(density,
                                  omega / sound) if np.isfinite(sound) and density else added
    return omega


def swing(time, values, rate):
    """(angular frequency, decay rate, amplitude, scatter over it) of a decaying sine about a mean,
    by Gauss' and Newton's least squares.

    rate: about the frequency; from 10 % away it is found.
    """
    decay = 0.0
    for _ in range(30):
        wave = np.exp((1j * rate - decay) * time)
        shapes = np.column_stack([wave.real, wave.imag, np.ones_like(time)])
        weights = np.linalg.lstsq(shapes, values, rcond=None)[0]
        # its real part is the sine; slopes with rate and decay
        turned = (weights[0] - 1j * weights[1]) * wave
        slopes = np.column_stack([shapes, time * (1j * turned).real, -time * turned.real])
        change = np.linalg.lstsq(slopes, values - shapes @ weights, rcond=None)[0][3:]
        rate, decay = rate + change[0], decay + change[1]
        if np.abs(change).max() < 1e-12 * rate:
            break
    amplitude = np.hypot(*weights[:2])
    return rate, decay, amplitude, np.sqrt(np.mean((shapes @ weights - values)**2)) / amplitude


def read(folder):
    """(displacement over time, values of the log, what swing() finds, or None if there is less than
    half a period)"""
    ring, values = series.read(Path(folder) / "ring.csv"), log.read(Path(folder)
                                                                    / "log.lammps").values
    expected = theory(values["density"])
    found = swing(ring.time, ring["oval"], expected) if ring.time[-1] * expected > np.pi else None
    return ring, values, found


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    ring, values, found = read(folder)
    if found:
        rate, decay, _, scatter = found
        summary.add("frequency", rate, "rad/s", theory(values["density"]), THEORY)
        summary.add("damping_a_period", 1.0 - np.exp(-2.0 * np.pi * decay / rate),
                    "of the amplitude", target=DAMPING)
        summary.add("scatter", scatter, "of the amplitude", target=0.01)
    summary.add("energy_error", np.abs(ring["energy"] / ring["energy"][0] - 1.0).max(),
                "of the energy at the start")
    picture_curves(folder / "ring.png", [(ring, values)])
    picture_fields(folder / "fields.png", dump.read(folder / "particles.dump"), values)
    return summary.write()


def picture_curves(path, runs, ratios=()):
    """Displacement over time, theory as points; ratios [(across, density, wet over dry)]: of the
    frequencies against the added mass, too."""
    with plot.picture(path, 8.4 if ratios else 6.0, 3.6) as figure:
        panels = figure.subplots(1, 2 if ratios else 1, squeeze=False)[0]
        for (ring, values), colour in zip(runs, COLOURS if ratios else COLOURS[1:]):
            rate, sparse = theory(values["density"]), slice(None, None,
                                                            max(1, len(ring.time) // 24))
            exact = values["speed"] / rate * np.sin(rate * ring.time)
            label = f"{values['density']:g} kg/m$^3$" if values["density"] else "no fluid"
            panels[0].plot(ring.time, 1e6 * ring["oval"], color=colour, label=label)
            panels[0].plot(ring.time[sparse], 1e6 * exact[sparse], "o", markersize=3.5,
                           markerfacecolor="white", color=colour)
        panels[0].set(xlabel="time [s]", ylabel="radial displacement [µm]")
        panels[0].legend(title="circles: theory", loc="upper right")
        if ratios:
            densities = np.geomspace(3.0, 5000.0, 60)
            alone = theory()
            panels[1].plot([mass_ratio(rho) for rho in densities],
                           [theory(rho) / alone for rho in densities], color=plot.GREY,
                           label="theory")
            for across, marker, colour in zip(sorted({a for a, *_ in ratios}), "os^", COLOURS[1:]):
                some = [(mass_ratio(rho), ratio) for a, rho, ratio in ratios if a == across]
                panels[1].plot(*zip(*some), marker, markersize=6, markerfacecolor="none",
                               color=colour, label=f"{across:g} particles through the ring")
            panels[1].set(xscale="log", ylim=(0.0, 1.05), xlabel="added mass over the ring's",
                          ylabel="frequency, wet over dry")
            panels[1].legend(loc="lower left")
        figure.tight_layout()


def picture_fields(path, frames, values):
    """The annulus when the ring is bent most; fields of a linear problem, scaled to the amplitude
    of the test, displacements 100 times that."""
    rate = theory(values["density"])
    scale = AMPLITUDE / (values["speed"] / rate)
    first, drawn = frames[0], []
    for frame in dump.nearest(frames, np.array([0.5, 1.5]) * np.pi / rate, tolerance=np.pi / rate):
        moved = {x: first[x] + 100.0 * scale * (frame[x] - first[x]) for x in "xy"}
        drawn.append(replace(frame, columns={
            **frame.columns, **moved, **{name: scale * frame[name] for name in ("p", "vonmises")}}))
    plot.snapshots(path, drawn, 1.3 * values["dx"], fluid=(FLUID,), solid=(RING,), wall=(WALL,),
                   columns=2, panel_width=3.0)


def study(folder, cases):
    """Frequencies in the fluids over that of the ring alone, at each resolution."""
    folder = Path(folder)
    summary = Summary(folder)
    runs = {(values["across"], values["density"]): (ring, values, found, path)
            for path in cases.values() for ring, values, found in [read(path)] if found}
    ratios = []
    for (across, density), (_, _, (rate, decay, *_), _) in sorted(runs.items()):
        name = f"{density:g}" if density else "dry"
        summary.add(f"frequency_{name}_{across:g}_across", rate, "rad/s", theory(density), THEORY)
        if density and (across, 0.0) in runs:
            ratios.append((across, density, rate / runs[across, 0.0][2][0]))
            summary.add(f"ratio_{name}_{across:g}_across", ratios[-1][2], "",
                        theory(density) / theory(), THEORY, RATIO)
        summary.add(f"damping_{name}_{across:g}_across", 1.0 - np.exp(-2.0 * np.pi * decay / rate),
                    "of the amplitude a period", target=DAMPING)
    finest = max(across for across, _ in runs)
    picture_curves(folder / "ring.png",
                   [run[:2] for (across, _), run in sorted(runs.items()) if across == finest],
                   ratios)
    if (finest, 140.0) in runs:
        shutil.copyfile(Path(runs[finest, 140.0][3]) / "fields.png", folder / "fields.png")
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
