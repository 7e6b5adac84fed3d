"""Every command given again between runs, with the same keywords and with others: what it does not concern goes on.

A table of scenes, which together name every style of the package, and of what may be given again in them. Of each command:
  - the same once more, after some steps: the run is the uninterrupted one;
  - another one before any step: the run is that of the other command from the start;
  - another one after some steps: nothing jumps, and the run goes on, or an error names what must not change.
"""

import re

import numpy as np
import pytest

from scenes import lammps, run

MATERIALS = """# DATE: 2026-01-01 UNITS: si CITATION: none
water fluid rho 1000 viscosity 1
oil fluid rho 900 viscosity 2
rubber solid rho 1100 young 2e5 poisson 0.3
stiffer solid rho 1100 young 4e5 poisson 0.3
wall wall rho 1000
"""
# sums in another order: 1e-16 of the largest, which a hundred steps of a shaken lattice do not bring above that
ROUND = 1e-10
STEPS = 20

HEAD = """
units si
dimension 2
boundary {boundary} {boundary} p
atom_style fsi
atom_modify map yes
region box block {lo} {hi} {low} {high} -0.005 0.005 units box
create_box {types} box
lattice sq 0.01 origin 0.5 0.5 0
"""
TANK = {  # name: command; in this order
    "make": """region water block 0 0.12 0 0.12 INF INF units box
region beam block 0.15 0.19 0 0.12 INF INF units box
region piston block -0.04 0 0 0.16 INF INF units box
create_atoms 1 region water
create_atoms 2 region beam
create_atoms 3 region piston
group water type 1
group beam type 2
group piston type 3
set group beam mol 1
region root block INF INF INF 0.02 INF INF units box
group low region root
group root intersect low beam
group moves subtract all root piston
displace_atoms water random 0.0005 0.0005 0 7 units box
velocity moves set 0.2 -0.1 0 units box
velocity root set 0 0 0
variable s equal 0.01*(1-cos(30*time))
variable u equal 0.3*sin(30*time)
variable s2 equal 0.02*(1-cos(30*time))
variable u2 equal 0.6*sin(30*time)""",
    "pair": "pair_style hybrid fsi/fluid sound 10 artificial/visc 0.05 0 density/diffusion 0.1 fsi/solid/tl artificial/visc 0.1 0",
    "coeff": "pair_coeff * * fsi/fluid m.fsi water rubber wall\npair_coeff * * fsi/solid/tl m.fsi NULL rubber NULL",
    "fsi": "fix fsi moves fsi 0.01 wendland 1.5",
    "gravity": "fix gravity all gravity 9.81 vector 0 -1 0",
    "mirror": "fix mirror water fsi/wall/mirror xhi 0.25 ylo 0",
    "particle": "fix particle piston fsi/wall/particle guard 0",
    "move": "fix move piston fsi/move variable v_s NULL NULL v_u v_zero NULL".replace("NULL NULL v_u", "v_zero NULL v_u"),
    "dt": "fix dt all fsi/dt 5 max 1e-4",
    "watch": "fix watch all fsi/watch 10",
    "report": "fix report all fsi/report",
    "energy": "compute energy all fsi/energy",
    "force": "compute force beam fsi/force",
    "probe": "compute probe water fsi/probe point 0.05 0.05 0 p",
    "surface": "compute surface water fsi/surface/atom divergence 0.75",
    "state": "compute state all fsi/atom rho p vonmises",
    "spectrum": "fix spectrum all fsi/spectrum 5 c_energy[1]",
    "settings": "variable zero equal 0\nneighbor 0.003 bin\nneigh_modify every 1 delay 0 check yes\nthermo_modify norm no lost error",
}
UPDATED = {**TANK,
    "pair": "pair_style hybrid fsi/fluid sound 10 artificial/visc 0.05 0 fsi/solid artificial/visc 0.1 0 hourglass 0.1 gradient quadratic",
    "coeff": "pair_coeff * * fsi/fluid m.fsi water rubber wall\npair_coeff * * fsi/solid m.fsi NULL rubber NULL",
    "stress": "fix stress all fsi/stress"}
UPDATED = {k: UPDATED[k] for k in ("make", "pair", "coeff", "fsi", "stress", "gravity", "mirror", "particle", "energy", "state", "settings")}
UPDATED["settings"] += "\ntimestep 1e-4"
OPEN = {
    "make": """region channel block 0 0.2 0 0.1 INF INF units box
create_atoms 1 region channel
group water type 1
displace_atoms water random 0.0005 0.0005 0 7 units box
velocity water set 0.5 0 0 units box""",
    "pair": "pair_style fsi/fluid sound 10 background 500 tension yes density/diffusion 0.1",
    "coeff": "pair_coeff * * m.fsi water",
    "fsi": "fix fsi water fsi 0.01 wendland 1.5",
    "mirror": "fix mirror water fsi/wall/mirror ylo 0 yhi 0.1",
    "inlet": "fix inlet water fsi/inlet xlo 0 velocity 0.5 0 0",
    "outlet": "fix outlet water fsi/outlet xhi 0.2",
    "state": "compute state all fsi/atom rho p vonmises",
    "settings": "timestep 1e-4\nneighbor 0.003 bin\nthermo_modify norm no lost error",
}
STREAM = {
    "make": """region all block 0 0.2 0 0.1 INF INF units box
create_atoms 1 region all
group water type 1
displace_atoms water random 0.0005 0.0005 0 7 units box
region zone block 0 0.1 0 0.1 INF INF units box
region zone2 block 0.05 0.15 0 0.1 INF INF units box
variable u atom 0.5+y
variable u2 atom 1.0+y""",
    "pair": "pair_style fsi/fluid sound 10 background 500 tension yes",
    "coeff": "pair_coeff * * m.fsi water",
    "fsi": "fix fsi water fsi 0.01 wendland 1.5",
    "stream": "fix stream water fsi/stream v_u 0 NULL region zone rate 20",
    "state": "compute state all fsi/atom rho p vonmises",
    "settings": "timestep 1e-4\nneighbor 0.003 bin\nthermo_modify norm no lost error",
}
BOX = {"boundary": "f", "lo": -0.05, "hi": 0.35, "low": -0.05, "high": 0.35, "types": 3}
SCENES = {"tank": (TANK, BOX), "updated": (UPDATED, BOX), "open": (OPEN, {**BOX, "lo": -0.08, "hi": 0.28, "types": 1}),
          "stream": (STREAM, {**BOX, "boundary": "p", "lo": 0, "hi": 0.2, "low": 0, "high": 0.1, "types": 1})}


def part(scene, *names, **other):
    """Lines of these commands, or of all; other: what stands in the place of some"""
    commands = SCENES[scene][0]
    return "\n".join(other.get(n, commands[n]) for n in names or commands) + "\n"


def deck(scene, **other):
    values = SCENES[scene][1]
    # variables before those that name them
    text = part(scene, **other)
    return HEAD.format(**values) + "variable zero equal 0\n" + text.replace("variable zero equal 0\n", "")


def dump(name):
    return f"write_dump all custom {name} id type x y vx vy fx fy c_state[*] modify sort id time yes format float %.17g\n"


def frame(result, name="end"):
    return result.frames(name)[0]


COLUMNS = ("x", "y", "vx", "vy", "fx", "fy", "c_state[1]", "c_state[2]", "c_state[3]")


def differences(a, b, columns=COLUMNS):
    """{column: largest difference over its largest size} of what is not the same"""
    assert np.array_equal(a["id"], b["id"]) and np.array_equal(a["type"], b["type"])
    found = {}
    for c in columns:
        group = [k for k in columns if k.strip("xy") == c.strip("xy")] if "state" not in c else [c]
        size = max(np.abs(a[k]).max() for k in group) or 1.0
        error = np.abs(a[c] - b[c]).max() / size
        if not error < ROUND:
            found[c] = error
    return found


# ---- what is given again -------------------------------------------------------------------------

def again(scene, name, text=None):
    """The command once more; of fixes and computes also after they were taken away"""
    line = text or part(scene, name)
    word = line.split()[0]
    ways = {"": line}
    if word in ("fix", "compute"):
        ways["un"] = f"un{word} {line.split()[1]}\n{line}"
    if word == "compute":
        del ways[""]    # LAMMPS refuses an ID that is there
    if word == "pair_style":
        ways = {"": line + "\n" + part(scene, "coeff")}
    return ways


# commands that are refused where their order is another one, or what they keep would begin anew: an error, or what begins anew
ORDER = {("tank", "un", "fsi"): r"must be defined after fix fsi|cannot|requires"}
KEEPS = {  # a state that begins anew where the fix does: the run is another one
    ("tank", "move"): "the motion begins there", ("tank", "dt"): "the step grows anew", ("open", "inlet"): "the buffer's particles are the new fix's",
    ("open", "outlet"): "likewise", ("updated", "stress"): "the stress is that of the fix", ("tank", "un", "spectrum"): ""}
SAME = [(scene, name, way) for scene, (commands, _) in SCENES.items() for name in commands if name not in ("make", "settings")
        for way in again(scene, name) if (scene, name) not in KEEPS]


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """whole(scene, other, steps): the uninterrupted run, kept"""
    folder, known = tmp_path_factory.mktemp("whole"), {}

    def get(scene, before=STEPS, **other):
        key = (scene, before, *sorted(other.items()))
        if key not in known:
            text = deck(scene, **other) + f"run {before}\nrun {STEPS}\n" + dump("end")
            known[key] = frame(run(folder / str(len(known)), text, m_fsi=MATERIALS))
        return known[key]

    return get


@pytest.mark.parametrize("scene, name, way", SAME, ids=[" ".join(filter(None, s)) for s in SAME])
def test_the_same_again(tmp_path, whole, scene, name, way):
    done = lammps(tmp_path, deck(scene) + f"run {STEPS}\n" + again(scene, name)[way] + f"\nrun {STEPS}\n" + dump("end"), m_fsi=MATERIALS)
    if answered(done, ORDER.get((scene, way, name))):
        return
    assert differences(whole(scene), frame(done)) == {}


# ---- another one ---------------------------------------------------------------------------------

FLUID = "sound 10 artificial/visc 0.05 0 density/diffusion 0.1"
BODY = "fsi/solid/tl artificial/visc 0.1 0"
OLD_KERNEL = "WARNING: Fix fsi: kernel was .* masses of particles and bonds of total-Lagrangian solids are still those of the old one"
OTHER = {  # scene, name: other commands, each with what an error says if it is refused, or a warning if it is not as if from the start
    ("tank", "pair"): {f"pair_style hybrid fsi/fluid {fluid} {body}": refused for fluid, body, refused in [
        (FLUID + " density/surface yes", BODY, ""), (FLUID + " shift 0.1", BODY, ""), (FLUID + " shift 0.1 shift/every 3", BODY, ""),
        (FLUID + " laminar/visc", BODY, ""), (FLUID + " laminar/visc/central solid/slip yes", BODY, ""), (FLUID + " extrapolate yes", BODY, ""),
        (FLUID + " surface 0.7 max", BODY, ""), ("sound 12 eos tait", BODY, ""), (FLUID + " tension yes background 100", BODY, ""),
        (FLUID, BODY + " hourglass 0.2", ""), (FLUID, BODY + " law neohookean", ""), (FLUID, BODY + " plane stress", ""),
        (FLUID, BODY + " damage 0.5", ""), (FLUID, BODY + " contact 1.5", ""),
        (FLUID, BODY + " gradient linear", "bonds of its bodies were made with"), (FLUID, BODY + " volumes plain", "bonds of its bodies were made with"),
        (FLUID, BODY + " law hypo", "requires fix fsi/stress")]},
    ("tank", "coeff"): {"pair_coeff * * fsi/fluid m.fsi oil rubber wall\npair_coeff * * fsi/solid/tl m.fsi NULL rubber NULL": "has the mass of a material of density 1000, but that of its type has 900 now",
                        "pair_coeff * * fsi/fluid m.fsi water stiffer wall\npair_coeff * * fsi/solid/tl m.fsi NULL stiffer NULL": "",
                        "pair_coeff * * fsi/fluid m.fsi water stiffer wall\npair_coeff * * fsi/solid/tl m.fsi NULL rubber NULL": "expected the same"},
    ("tank", "fsi"): {f"fix fsi moves fsi {words}": refused for words, refused in [
        ("0.01 wendland 1.5 substeps 4", ""), ("0.01 wendland 1.5 thin 2", ""), ("0.01 wendland 1.5 thin 3", ""), ("0.01 wendland 1.5 mach off", ""),
        ("0.01 wendland 1.5 surface/every 3", ""), ("0.012 wendland 1.5", "particle spacing was 0.01 in the last run, and is 0.012 now"),
        ("0.01 wendland 1.5 spacing 2 0.005", "spacing was none in the last run, and is 2 0.005 now"),
        ("0.01 wendland 1.5 fluid summation", "density/diffusion requires"), ("0.01 quintic 1.0", OLD_KERNEL)]},
    ("tank", "gravity"): {"fix gravity all gravity 5 vector 1 -1 0": "", "fix gravity water gravity 9.81 vector 0 -1 0": ""},
    ("tank", "mirror"): {"fix mirror water fsi/wall/mirror xhi 0.25 ylo 0 slip no": "", "fix mirror water fsi/wall/mirror xhi 0.30 ylo 0 guard 0": "",
                         "fix mirror water fsi/wall/mirror xhi 0.25 velocity -0.1 0 0 ylo 0": ""},
    ("tank", "particle"): {f"fix particle piston fsi/wall/particle {words}": "" for words in ("guard 0 slip no", "guard 0 pressure linear", "guard 0.3")},
    ("tank", "move"): {"fix move piston fsi/move variable v_s2 v_zero NULL v_u2 v_zero NULL": "", "fix move piston fsi/move linear 0.1 0 0 units box": "",
                       "fix move piston fsi/move wiggle 0.01 0 0 0.2 units box": "", "fix move piston fsi/move linear 0.1 NULL 0 units box": "Write 0 instead of NULL",
                       "fix move piston fsi/move variable v_s v_zero NULL v_zero v_zero NULL": r"displacement v_s changes by \S+ per time, but the velocity v_zero is 0"},
    ("tank", "dt"): {"fix dt all fsi/dt 5 max 5e-5": "", "fix dt all fsi/dt 2 cfl 0.2 max 1e-4 substeps auto": "", "fix dt all fsi/dt 5 check warn": "",
                     "fix dt all fsi/dt 5 max 1e-4 stop 0.01": ""},
    ("tank", "watch"): {"fix watch all fsi/watch 3 distance 0.1 action warn": ""},
    ("tank", "report"): {"fix report all fsi/report every 7": ""},
    ("tank", "spectrum"): {"fix spectrum all fsi/spectrum 2 f_particle[1]": ""},
    ("tank", "force"): {"compute force water fsi/force split yes": ""},
    ("tank", "probe"): {"compute probe water fsi/probe line 0.05 0 0 0.05 0.2 0 level": ""},
    ("updated", "pair"): {f"pair_style hybrid fsi/fluid sound 10 artificial/visc 0.05 0 {words} fsi/solid artificial/visc 0.1 0 {body}": "" for words, body in [
        ("", ""), ("", "gradient corrected"), ("couple full", "gradient plain artificial/stress 0.3"), ("shift 0.1", "hourglass 0.3 gradient quadratic"),
        ("density/surface yes", "hourglass 0.1 gradient quadratic")]},
    ("updated", "fsi"): {"fix fsi moves fsi 0.01 wendland 1.5 fluid ratio solid ratio": "", "fix fsi moves fsi 0.01 wendland 1.5 fluid summation solid summation": "",
                         "fix fsi moves fsi 0.01 cubic 1.3": OLD_KERNEL},
    ("updated", "stress"): {"fix stress all fsi/stress plastic": ""},
    ("open", "pair"): {f"pair_style fsi/fluid sound 10 background 500 tension yes {words}": "" for words in
                       ("shift 0.2", "laminar/visc", "density/diffusion 0.2 artificial/visc 0.1 0", "shift 0.2 shift/every 2")},
    ("open", "fsi"): {"fix fsi water fsi 0.01 wendland 1.5 mach 0.5": "", "fix fsi water fsi 0.01 quintic 1.0": OLD_KERNEL},
    ("open", "mirror"): {"fix mirror water fsi/wall/mirror ylo 0 yhi 0.1 slip no": ""},
    ("stream", "pair"): {f"pair_style fsi/fluid sound 10 background 500 tension yes {words}": "" for words in ("shift 0.2", "density/diffusion 0.1 laminar/visc")},
    ("stream", "stream"): {f"fix stream water fsi/stream {words}": "" for words in
                           ("v_u2 NULL NULL region zone rate 20", "0.5 0 NULL region zone2 rate 10 density 20", "v_u 0 NULL region zone2 rate 20 along y")},
}
CASES = [(scene, name, text, refused, way) for (scene, name), others in OTHER.items() for text, refused in others.items()
         for way in list(again(scene, name, text))[-1:]]    # taken away first, where that is possible: of the same, both are tried
IDS = [f"{scene} {way}{text}".replace("\n", " ") for scene, name, text, refused, way in CASES]


def answered(done, expected):
    """Is it refused, or taken with a warning, as it should?"""
    if not expected:
        assert done.status == 0, done.output[-1500:]
        return False
    assert re.search(expected, done.output) and (done.status == 0) == expected.startswith("WARNING"), done.output[-1500:]
    return True


@pytest.mark.parametrize("scene, name, text, refused, way", CASES, ids=IDS)
def test_another_before_any_step(tmp_path, whole, scene, name, text, refused, way):
    """As if it had been so from the start: after a run of no steps, which all arrays are made in. An error is that of the command itself."""
    done = lammps(tmp_path, deck(scene) + "run 0\n" + again(scene, name, text)[way] + f"\nrun 0\nrun {STEPS}\n" + dump("end"), m_fsi=MATERIALS)
    if answered(done, refused or ORDER.get((scene, way, name))):
        return
    assert differences(whole(scene, 0, **{name: text}), frame(done)) == {}


@pytest.mark.parametrize("scene, name, text, refused, way", CASES, ids=IDS)
def test_another_after_some_steps(tmp_path, scene, name, text, refused, way):
    """No place, velocity, density of a fluid or strain jumps with it, nothing is lost, and the run goes on."""
    done = lammps(tmp_path, deck(scene) + f"run {STEPS}\n" + dump("before") + again(scene, name, text)[way] + "\nrun 0\n" + dump("after")
                  + f"run {STEPS}\n" + dump("end"), m_fsi=MATERIALS)
    answered(done, refused or ORDER.get((scene, way, name)))
    if done.status:
        return
    before, after, end = (frame(done, n) for n in ("before", "after", "end"))
    held = before["type"] == 3    # their density is that of their pressure; their velocity follows the motion at once
    solid, fluid = before["type"] == 2, before["type"] == 1
    for c in ("x", "y"):
        np.testing.assert_array_equal(before[c], after[c])
    for c in ("vx", "vy"):
        np.testing.assert_array_equal(before[c][~held], after[c][~held])
    made_anew = "summation" in text
    if not made_anew:
        np.testing.assert_allclose(after["c_state[1]"][fluid], before["c_state[1]"][fluid], rtol=1e-12)
    if solid.any() and name not in ("coeff", "stress") and "law" not in text and "plane" not in text:
        np.testing.assert_allclose(after["c_state[3]"][solid], before["c_state[3]"][solid], rtol=1e-9, atol=1e-9 * before["c_state[3]"].max())
    # in the next steps nothing moves further than twice what the fastest did
    for c in ("x", "y"):
        assert np.abs(end[c] - after[c])[np.isin(after["id"], end["id"])].max() < 0.01 if len(end) == len(after) else True
    assert all(np.isfinite(end[c]).all() for c in COLUMNS)
