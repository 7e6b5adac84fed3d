"""Scenes in which every pair of features meets: what must not matter does not, what must be
conserved is, what is refused says why."""

import functools
import math
import re
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fsi import paths
from scenes import run

from . import factors
from .factors import FACTOR_OF, FACTORS, FIRST
from .scene import DT, DX, FLOOR, HALF, PairScene, go, go_on_ranks, other_type, read

REFUSED = factors.refused_rows()
# After 40 steps relative to the scene, its largest velocity, its density: growth of round-off,
# 1e-16, by collisions of perturbed particles. What is missing or counted twice shows at 1e-6 and
# above
ROUND = 1e-9
SKIN = 1e-10    # other neighbor lists have the same pairs in another order


@functools.lru_cache(maxsize=1)
def rows(seed):
    return factors.rows(seed)


def given(scene, *levels):
    return any(level in scene.row for level in levels)


def new_ids(scene):
    """Are IDs given at run time?"""
    return scene.open or bool(scene.has["refine"]) or given(scene, "reset_atoms", "delete_atoms",
                                                            "create_atoms")


@functools.lru_cache(maxsize=1)
def smooth_rows(seed):
    return factors.rows(seed, ROUGH)


class Runs:
    """The runs of a scene; the first is kept for all that is asked of it."""

    def __init__(self, k, row):
        # pylint: disable-next=consider-using-with
        self.scene, self.place = PairScene(row), tempfile.TemporaryDirectory(
            prefix=f"fsi_pairs_{k}_")
        self.folder = Path(self.place.name)

    @functools.cached_property
    def base(self):
        return go(self.scene, self.folder / "base")

    @functools.cached_property
    def counted(self):
        """The same with lists at the end: ends make and count particles when lists are built"""
        return self.other(counted=True) if self.scene.open else self.base

    def alike(self, **changes):
        """The same but for this, with lists at the end in both"""
        same(self.scene, self.counted, self.other(**changes, counted=self.scene.open), SKIN)

    def other(self, **changes):
        return go(replace(self.scene, **changes), self.folder / "_".join(changes))


@functools.lru_cache(maxsize=2)
def runs(seed, k):
    return Runs(k, rows(seed)[k])


def apart(scene, a, b):
    """Difference of positions, through a period where it is shorter."""
    d = a - b
    for axis, (periodic, (lo, hi)) in enumerate(zip(scene.periodic, scene.box)):
        if periodic:
            d[..., axis] -= (hi - lo) * np.round(d[..., axis] / (hi - lo))
    return d


def partners(scene, a, b, ids):
    """For each particle of a its one in b: of the same ID, or the nearest."""
    if ids:
        assert np.array_equal(a.id, b.id)
        return np.arange(len(a.id))
    assert len(a.id) == len(b.id), f"{len(a.id)} and {len(b.id)} particles"
    found = np.array([np.argmin((apart(scene, b.x, x)**2).sum(1)) for x in a.x])
    assert len(set(found)) == len(found), "particles at other places"
    return found


def same(scene, a, b, tolerance, ids=None):
    """Are two states the same to this, relative to the sizes?"""
    which = partners(scene, a, b, not new_ids(scene) if ids is None else ids)
    assert np.array_equal(a.type, b.type[which])
    off = {"x": np.abs(apart(scene, a.x, b.x[which])).max() / np.abs(a.x).max(),
           "v": np.abs(a.v - b.v[which]).max() / np.abs(a.v).max(),
           "rho": np.abs(a.rho - b.rho[which]).max() / 1000,
           "mass": np.abs(a.mass / b.mass[which] - 1).max()}
    assert max(off.values()) <= tolerance, {name: f"{value:.1e}" for name, value in off.items()
                                            if not value <= tolerance}


# ---- invariants: who they are asked of, and what they ask ----------------------------------------

def always(_):
    return True


def finite(r):
    s = r.base
    assert all(np.isfinite(a).all() for a in (s.x, s.v, s.rho, s.mass)) and s.mass.min() > 0
    assert len(set(s.id)) == len(s.id) and s.id.min() > 0
    n = len(r.scene.particles["x"])
    assert n <= 2050 and (r.scene.open or r.scene.has["refine"] or r.scene.setting("spot")
                          or r.scene.setting("packed") or len(s.id) == n)


def keeps_mass(scene):
    return not given(scene, "fsi/set", "packed")


def mass(r):
    """What was there, came in, went out, was deleted"""
    before, s = r.scene.particles["mass"], r.counted
    # not in the buffer of an end
    here = (np.abs(s.x[:, 0]) < HALF * DX) | (not r.scene.open) | (s.type == FLOOR)
    balance = [*s.mass[here], *-before, s.extra["deleted"], -s.extra.get("in mass", 0.0),
               -s.extra.get("out mass", 0.0)]
    # the ends count in sums of their own
    assert abs(math.fsum(balance)) < 1e-14 * math.fsum(before) * (100 if r.scene.open else 1)


def two_ranks(r):
    other = replace(r.scene, newton="off", lists="multi")
    same(r.scene, r.base, go_on_ranks(other, r.folder / "ranks", 2), ROUND)


def four_ranks(r):
    same(r.scene, r.base, go_on_ranks(r.scene, r.folder / "four", 4), ROUND)


def threads(r):
    same(r.scene, r.base, r.other(threads=2), ROUND)


def balanced(r):
    """Lists are built when ranks change, too."""
    other = replace(r.scene, balanced=True, counted=r.scene.open)
    same(r.scene, r.counted, go_on_ranks(other, r.folder / "balanced", 2), ROUND)


def skin(r):
    r.alike(skin=1.0, lists="nsq")


def watched(r):
    """Who looks changes nothing."""
    r.alike(watched=True)


def cut(r):
    """A run in two parts is the run at once. (Delete_atoms numbers by order, which is made
    anew.)"""
    r.alike(cut=True)


def idle(r):
    """What is given again, or added to by nothing, is as it was."""
    r.alike(idle=True)


def no_levels(scene):
    """What splits and merges where there is a choice is decided by IDs."""
    return not scene.has["refine"]


def ordered(scene):
    """LAMMPS gives new IDs by rank or by place, and those decide what levels do."""
    return no_levels(scene) or not given(scene, "reset_atoms", "delete_atoms", "create_atoms")


def numbering(r):
    same(r.scene, r.base, r.other(shuffled=5), ROUND, ids=False)


def mirror(r):
    other = r.other(sign=-1)
    other.x[:, 0] *= -1
    other.v[:, 0] *= -1
    same(r.scene, r.base, other, ROUND)


def other_axes(r):
    """Of other names nothing depends: x and y change places, or all three move on."""
    axes = (1, 0, 2) if r.scene.dim == 2 else (1, 2, 0)
    other = r.other(axes=axes)
    old = np.argsort(axes)
    other.x, other.v = other.x[:, old], other.v[:, old]
    same(r.scene, r.base, other, ROUND)


def any_order(scene):
    """What LAMMPS' fix momentum takes, other fixes see before or after."""
    return ordered(scene) and not given(scene, "momentum")


def backward(r):
    """In which order fixes and types come does not matter."""
    other = r.other(backward=True)
    other.type = other_type(other.type)
    same(r.scene, r.base, other, ROUND)


def restart(r):
    """Bit for bit, but fix rigid computes bodies anew"""
    r.base    # pylint: disable=pointless-statement
    scene = r.scene
    other = go(scene, r.folder / "base", scene.continued(r.folder / "base"))
    same(scene, r.base, other, ROUND if scene.flies or scene.setting("buoy") else 0.0, ids=True)


def restart_on_ranks(r):
    """The restart file of one rank, read by two"""
    r.base    # pylint: disable=pointless-statement
    folder = r.folder / "base"
    run(folder, r.scene.continued(folder), 2)
    same(r.scene, r.base, read(folder), ROUND, ids=True)


def alone(scene):
    """Nothing outside acts. Shifting with a background, hourglass forces of pair_style fsi/solid,
    which turn with particles, a hole and a new density change momentum; with implicit viscosity
    fluids lack a reaction of solids that accelerate in sub-steps (theory.rst)."""
    return not (scene.walled or scene.plane or scene.open or scene.has["gravity"]
                or scene.setting("stream") or given(scene, "clamped", "fsi/set", "background",
                                                    "hypo updated", "velocity", "addforce",
                                                    "setforce", "spring", "viscous", "momentum",
                                                    "packed")
                or scene.setting("spot") or given(scene, "yield stress")
                and given(scene, "sub-steps", "adaptive sub-steps"))


def momentum(r):
    p, s = r.scene.particles, r.base
    size = (p["mass"][:, None] * np.abs(p["v"])).sum()
    change = (s.mass[:, None] * s.v).sum(0) - (p["mass"][:, None] * p["v"]).sum(0)
    assert np.abs(change).max() < 1e-13 * size


def drifts(scene):
    """Nothing outside stands still, and no step depends on speeds."""
    return not (scene.walled or scene.plane or scene.open or scene.setting("stream") or given(
        scene, "clamped", "adaptive step", "adaptive sub-steps", "region", "moving region",
        "unsettled", "create_atoms", "spring", "viscous", "momentum"))


def galilei(r):
    U = 0.2
    other = r.other(frame=U)
    u = np.array([1, 0.5, r.scene.dim == 3]) * U
    other.x -= u * other.time
    other.v -= u
    same(r.scene, r.base, other, ROUND)


INVARIANTS = {"finite": (always, finite), "mass": (keeps_mass, mass), "ranks": (ordered, two_ranks),
              "four ranks": (ordered, four_ranks), "threads": (ordered, threads),
              "balanced": (ordered, balanced), "skin": (always, skin), "watched": (always, watched),
              "cut": (ordered, cut), "idle": (ordered, idle),
              "numbering": (no_levels, numbering), "mirror": (ordered, mirror),
              "axes": (ordered, other_axes), "backward": (any_order, backward),
              "restart": (always, restart), "restart on ranks": (always, restart_on_ranks),
              "momentum": (alone, momentum),
              "frame": (drifts, galilei)}
SAMPLE = {"four ranks": 8, "balanced": 3, "restart on ranks": 8}    # asked of one scene in so many


def pytest_generate_tests(metafunc):
    """Cases of a scene stay on one worker, which keeps its first run."""
    if "invariant" in metafunc.fixturenames:
        seed = metafunc.config.getoption("--pairs-seed")
        metafunc.parametrize("seed, k, invariant", [
            pytest.param(seed, k, name, id=f"{k}-{name}",
                         marks=pytest.mark.xdist_group(f"pairs{k}"))
            for k, row in enumerate(rows(seed)) for name, (asked, _) in INVARIANTS.items()
            if k % SAMPLE.get(name, 1) == 0 and asked(PairScene(row))])


def test_pairs(seed, k, invariant):
    r = runs(seed, k)
    print(" | ".join(level for level in r.scene.row if level != FIRST[FACTOR_OF[level]]))
    INVARIANTS[invariant][1](r)


# What acts from outside, or changes momentum as alone() says: with it hardly a scene of all pairs
# would be asked
OUTSIDE = {*factors.all_of("walls"), *factors.all_of("ends"), *factors.all_of("gravity"),
           *factors.all_of("symmetry"), *factors.all_of("other fix"), "velocity", "create_atoms",
           "packed", "clamped", "fsi/set", "background",
           "hypo updated", "delete_atoms", "delete, no compress"}


@functools.lru_cache(maxsize=1)
def quiet_rows(seed):
    return [row for row in factors.rows(seed, OUTSIDE) if alone(PairScene(row))]


@pytest.mark.parametrize("k", range(30))
def test_alone(request, k):
    """Momentum stays, and a velocity of all changes nothing, in scenes that nothing acts on."""
    of_seed = quiet_rows(request.config.getoption("--pairs-seed"))
    r = Runs(k, of_seed[k * len(of_seed) // 30])
    print(" | ".join(level for level in r.scene.row if level != FIRST[FACTOR_OF[level]]))
    momentum(r)
    if drifts(r.scene):
        galilei(r)


# What the balance of energy does not contain, says its page; what takes other steps as dt falls, or
# is not smooth in time
ROUGH = {"article", "summation", "ratio", "shift", "shift every 3", "surface rule", "damage",
         "hypo updated", "quadratic updated", "delete_atoms", "delete, no compress", "fsi/set",
         "redefined", "given again", "timestep",
         *factors.all_of("command", "reset_timestep", "change_box", "neighbor"),
         *factors.all_of("other fix"), "adaptive step", "adaptive sub-steps",
         *factors.all_of("levels"), *factors.all_of("ends", "stream")}


@pytest.mark.parametrize("k", range(20))
def test_energy(tmp_path, request, k):
    """The sum of energies drifts by the error of the time step, or by less than what corners of
    pressure, contact and guard make."""
    of_seed = smooth_rows(request.config.getoption("--pairs-seed"))
    row = of_seed[k * len(of_seed) // 20]
    print(" | ".join(level for level in row if level != FIRST[FACTOR_OF[level]]))
    def drift(dt):
        s = go(PairScene(row, energy=True, dt=dt), tmp_path)
        return abs(s.extra["drift"] / s.extra["energy"][0])

    # errors of two signs may hide each other at one step: then the next half shows that they fall
    whole, half = drift(DT), drift(DT / 2)
    if half < max(0.8 * whole, 2e-4):
        return
    quarter = drift(DT / 4)
    assert (quarter < 0.85 * half and quarter
            < whole), f"{whole:.1e}, {half:.1e} and {quarter:.1e} of the kinetic energy"


@pytest.mark.parametrize("pair, message, row", REFUSED,
                         ids=["-".join(pair) for pair, _, _ in REFUSED])
def test_refused(tmp_path, pair, message, row):
    with pytest.raises(Exception) as error:
        go(PairScene(row), tmp_path)
    assert re.search(message, str(error.value)), (pair, str(error.value))


# faults that pairs have shown, each in the scene that has these levels and the first ones of other
# factors: what was asked
FOUND = {
    "settling-beside-a-segment": (["3D", "cubic", "segment", "region", "svk", "clamped"], "ranks"),
    "what-a-thin-body-hides-from-either-side": (["3D", "tension", "thin", "clamped", "region"],
                                                "skin"),
    "bonds-longer-than-half-a-period": (["3D", "plastic", "self", "fsi/set"], "skin"),
    "images-that-are-looked-at-before-sub-steps": (["svk", "sub-steps", "moving region",
                                                    "symmetry plane"], "watched"),
    "rigid-body-bonded-to-its-image": (["neo-hookean", "rigid", "sub-steps", "symmetry plane"],
                                       "watched"),
    "end-that-leaves-a-rank": (["3D", "thin particles", "damage", "moving region",
                                "absorbing ends"], "balanced"),
    "bodies-behind-walls-in-fluids-of-varying-viscosity": (
        ["3D", "yield stress", "moving mirror", "neo-hookean", "clamp on a float"], "numbering"),
    "densities-of-walls-when-levels-settle": (["region", "floating", "shift every 3",
                                               "unequal masses", "reset_timestep"], "cut"),
    "densities-of-solids-when-levels-settle": (["paper", "moving region", "ratio"], "cut"),
    "surfaces-of-a-fix-that-is-given-again": (["surface rule"], "idle"),
    "ratios-of-a-fix-that-is-given-again": (["paper", "ratio"], "idle"),
    "shifting-between-ends-of-a-fix-that-is-given-again": (
        ["background", "shift every 3", "absorbing ends"], "idle"),
    "acceleration-of-a-wall-that-is-given-again": (["floating"], "idle"),
    "gradients-that-the-box-had-a-part-in": (["3D", "svk"], "axes"),
    "thickness-of-thin-bodies": (["3D", "quintic", "no walls", "thin", "rigid", "gravity"], "skin"),
}


@pytest.mark.parametrize("name", FOUND)
def test_found(name):
    levels, invariant = FOUND[name]
    INVARIANTS[invariant][1](Runs(name, factors.simple(levels)))


def test_every_allowed_pair_is_in_a_scene(request):
    here = set().union(*map(factors.pairs_of, rows(request.config.getoption("--pairs-seed"))))
    assert here == {pair for pair, good in factors.all_pairs().items() if good}
    assert sum(map(len, FACTORS.values())) == len(FACTOR_OF), "a level of two factors"
    assert len(here) > 2500


def words_of_pages():
    """{page: styles and starred words of its Syntax}"""
    found = {}
    for page in sorted((paths.ROOT / "doc/src").glob("*fsi*.rst")):
        text = page.read_text()
        syntax = re.search(r'\nSyntax\n"+\n(.*?)\nExamples\n"', text, re.S)
        if syntax:
            # "threads" has those with suffix omp, unittest/kokkos those with kk
            styles = {re.sub(r" command$|/omp$|/kk$", "", name).split()[-1]
                      for name in re.findall(r"^\.\. index:: (.*)$", text, re.M)}
            found[page.stem] = styles, set(re.findall(r"\*([a-z][a-z/]*\d?)\*", syntax[1])) | styles
    return found


def test_every_word_of_the_manual_is_a_level():
    """Or is tested elsewhere: whoever adds a style or a keyword says where it meets the others."""
    lines = {line for row in factors.rows()
             for line in PairScene(row, energy=True).text(".").splitlines()}
    tokens = [set(line.split()) for line in lines]
    pages = words_of_pages()
    assert len(pages) > 20 and sum(len(words) for _, words in pages.values()) > 200
    for page, (styles, words) in pages.items():
        drawn = set().union(*(line for line in tokens if line & styles))
        other = {word: file for file, more in factors.ELSEWHERE.get(page, {}).items()
                 for word in more.split()}
        assert words - drawn - set(
            other) == set(), f"{page}.rst: neither a level of FACTORS nor in ELSEWHERE"
        assert (set(other) <= words
                - drawn), f"{page}.rst has no such word, or it is a level: take it out of ELSEWHERE"
        for word, file in other.items():
            text = (paths.ROOT / "unittest/styles" / f"{file}.py").read_text()
            assert re.search(rf"(?<![\w/]){word}(?![\w/])", text), f"{file}.py does not test {word}"
