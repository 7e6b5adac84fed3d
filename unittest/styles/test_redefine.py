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
LEVELS = {
    "make": """region channel block 0 0.3 0 0.1 INF INF units box
create_atoms 1 region channel
group water type 1
displace_atoms water random 0.0005 0.0005 0 7 units box
velocity water set 0.5 0 0 units box
region near block 0.13 0.2 -0.01 0.11 INF INF units box
region near2 block 0.1 0.18 -0.01 0.11 INF INF units box""",
    "pair": "pair_style fsi/fluid sound 10 background 500 tension yes density/diffusion 0.1",
    "coeff": "pair_coeff * * m.fsi water water",
    "fsi": "fix fsi water fsi 0.01 wendland 1.5 spacing 2 0.0070711",
    "mirror": "fix mirror water fsi/wall/mirror ylo 0 yhi 0.1",
    "inlet": "fix inlet water fsi/inlet xlo 0 velocity 0.5 0 0",
    "outlet": "fix outlet water fsi/outlet xhi 0.3",
    "refine": "fix refine water fsi/refine 5 types 1 2 region near",
    "energy": "compute energy all fsi/energy",
    "state": "compute state all fsi/atom rho p vonmises",
    "settings": "timestep 1e-4\nneighbor 0.003 bin\nthermo_modify norm no lost error",
}
BOX = {"boundary": "f", "lo": -0.05, "hi": 0.35, "low": -0.05, "high": 0.35, "types": 3}
SCENES = {"tank": (TANK, BOX), "updated": (UPDATED, BOX), "open": (OPEN, {**BOX, "lo": -0.08, "hi": 0.28, "types": 1}),
          "levels": (LEVELS, {**BOX, "lo": -0.08, "hi": 0.38, "types": 2}),
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
ORDER = {("tank", "un", "fsi"): r"after fix fsi|cannot|requires"}
KEEPS = {  # a state that begins anew where the fix does: the run is another one
    ("tank", "move"): "the motion begins there", ("tank", "dt"): "the step grows anew", ("open", "inlet"): "the buffer's particles are the new fix's",
    ("open", "outlet"): "likewise", ("levels", "inlet"): "likewise", ("levels", "outlet"): "likewise", ("updated", "stress"): "the stress is that of the fix", ("tank", "un", "spectrum"): ""}
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
        (FLUID + " surface 0.7", BODY, ""), ("sound 12 eos tait", BODY, ""), (FLUID + " tension yes background 100", BODY, ""),
        (FLUID, BODY + " hourglass 0.2", ""), (FLUID, BODY + " law neohookean", ""), (FLUID, BODY + " plane stress", ""),
        (FLUID, BODY + " damage 0.5", ""), (FLUID, BODY + " contact 1.5", ""),
        (FLUID, BODY + " gradient linear", "bonds of its bodies were made with"), (FLUID, BODY + " volumes plain", "bonds of its bodies were made with"),
        (FLUID, BODY + " law hypo", "requires fix fsi/stress")]},
    ("tank", "coeff"): {"pair_coeff * * fsi/fluid m.fsi oil rubber wall\npair_coeff * * fsi/solid/tl m.fsi NULL rubber NULL": "has the mass of a material of density 1000, but that of its type has 900 now",
                        "pair_coeff * * fsi/fluid m.fsi water stiffer wall\npair_coeff * * fsi/solid/tl m.fsi NULL stiffer NULL": "",
                        "pair_coeff * * fsi/fluid m.fsi water stiffer wall\npair_coeff * * fsi/solid/tl m.fsi NULL rubber NULL": "expected the same"},
    ("tank", "fsi"): {f"fix fsi moves fsi {words}": refused for words, refused in [
        ("0.01 wendland 1.5 substeps 4", ""), ("0.01 wendland 1.5 thin 2", ""), ("0.01 wendland 1.5 thin 3", ""), ("0.01 wendland 1.5 mach off", ""),
        ("0.012 wendland 1.5", "particle spacing was 0.01 in the last run, and is 0.012 now"),
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
    ("tank", "report"): {"fix report all fsi/report file other.txt": ""},
    ("tank", "spectrum"): {"fix spectrum all fsi/spectrum 2 f_particle[1]": ""},
    ("tank", "force"): {"compute force water fsi/force split yes": ""},
    ("tank", "probe"): {"compute probe water fsi/probe line 0.05 0 0 0.05 0.2 0 level": ""},
    ("updated", "pair"): {f"pair_style hybrid fsi/fluid sound 10 artificial/visc 0.05 0 {words} fsi/solid artificial/visc 0.1 0 {body}": "" for words, body in [
        ("", ""), ("", "gradient corrected"), ("couple full", "gradient plain artificial/stress 0.3"), ("shift 0.1", "hourglass 0.3 gradient quadratic"),
        ("density/surface yes", "hourglass 0.1 gradient quadratic")]},
    ("updated", "fsi"): {"fix fsi moves fsi 0.01 wendland 1.5 solid ratio": "", "fix fsi moves fsi 0.01 wendland 1.5 fluid summation solid summation": "", "fix fsi moves fsi 0.01 wendland 1.5 scheme article": "requires pair_style fsi/solid gradient plain",
                         "fix fsi moves fsi 0.01 cubic 1.3": OLD_KERNEL},
    ("updated", "stress"): {"fix stress all fsi/stress plastic": ""},
    ("open", "pair"): {f"pair_style fsi/fluid sound 10 background 500 tension yes {words}": "" for words in
                       ("shift 0.2", "laminar/visc", "density/diffusion 0.2 artificial/visc 0.1 0", "shift 0.2 shift/every 2")},
    ("open", "fsi"): {"fix fsi water fsi 0.01 wendland 1.5 mach 0.5": "", "fix fsi water fsi 0.01 quintic 1.0": OLD_KERNEL},
    ("open", "mirror"): {"fix mirror water fsi/wall/mirror ylo 0 yhi 0.1 slip no": ""},
    ("levels", "pair"): {f"pair_style fsi/fluid sound 10 background 500 tension yes {words}": "" for words in
                         ("shift 0.2", "laminar/visc", "density/diffusion 0.2 artificial/visc 0.1 0", "shift 0.2 shift/every 2")},
    ("levels", "fsi"): {"fix fsi water fsi 0.01 wendland 1.5 spacing 2 0.0070711 mach 0.5": ""},
    ("levels", "mirror"): {"fix mirror water fsi/wall/mirror ylo 0 yhi 0.1 slip no": ""},
    ("levels", "refine"): {f"fix refine water fsi/refine {words}": "" for words in
                           ("5 types 1 2 region near settle 0", "10 types 1 2 region near", "5 types 1 2 region near2")},
    ("stream", "pair"): {f"pair_style fsi/fluid sound 10 background 500 tension yes {words}": "" for words in ("shift 0.2", "density/diffusion 0.1 laminar/visc")},
    ("stream", "stream"): {f"fix stream water fsi/stream {words}": "" for words in
                           ("v_u2 NULL NULL region zone rate 20", "0.5 0 NULL region zone2 rate 10 density 20", "v_u 0 NULL region zone2 rate 20 along y")},
}
CASES = [(scene, name, text, refused, way) for (scene, name), others in OTHER.items() for text, refused in others.items() if name != "refine"    # splits in run 0: fuzz_runs.py has it
         # taken away first, where that is possible: of the same, both are tried
         for way in (list(again(scene, name, text))[-1:] if (scene, "un", name) not in ORDER else [""])]
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
    if answered(done, ORDER.get((scene, way, name)) or refused):
        return
    assert differences(whole(scene, 0, **{name: text}), frame(done)) == {}


@pytest.mark.parametrize("scene, name, text, refused, way", CASES, ids=IDS)
def test_another_after_some_steps(tmp_path, scene, name, text, refused, way):
    """No place, velocity, density of a fluid or strain jumps with it, nothing is lost, and the run goes on."""
    done = lammps(tmp_path, deck(scene) + f"run {STEPS}\n" + dump("before") + again(scene, name, text)[way] + "\nrun 0\n" + dump("after")
                  + f"run {STEPS}\n" + dump("end"), m_fsi=MATERIALS)
    answered(done, ORDER.get((scene, way, name)) or refused)
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


# ---- what else commands between runs change ------------------------------------------------------

AGAIN = {  # scene, what comes between, what is said: an error, or a warning and it goes on
    "a compute that is gone": ("tank", "uncompute force\nrun 2 pre no", "ERROR: Run with pre no: fixes, computes, regions or pair styles are others"),
    "another compute of the same ID": ("tank", "uncompute force\ncompute force beam fsi/force\nrun 2 pre no", "ERROR: Run with pre no"),
    "a fix that is new": ("tank", "fix more all fsi/watch 7\nrun 2 pre no", "ERROR: Run with pre no"),
    **{f"another {name} in its place": (scene, f"{part(scene, name)}run 2 pre no", "ERROR: Run with pre no") for scene, name in
       [("tank", "dt"), ("tank", "move"), ("tank", "pair"), ("open", "mirror"), ("open", "inlet"), ("levels", "refine"), ("stream", "stream")]},
    "another fix fsi": ("stream", "unfix fsi\n" + part("stream", "fsi") + "run 2 pre no", "ERROR: Run with pre no"),
    "a type that is another": ("tank", "region w block 0 0.03 0 0.03 INF INF units box\nset region w type 2\n" + dump("x"), "ERROR: Compute fsi/atom needs a run before it"),
    "as many new atoms as old ones": ("tank", "group g region beam\ndelete_atoms group g compress no\ncreate_atoms 2 region beam\n" + dump("x"),
                                      "ERROR: Compute fsi/atom needs a run before it"),
    "a pair style that has not run": ("tank", part("tank", "pair", "coeff") + dump("x"), "ERROR: Compute fsi/atom needs a run before it"),
    "a law that has no stress yet": ("tank", "pair_style hybrid fsi/fluid sound 10 fsi/solid/tl law hypo\n" + part("tank", "coeff") + dump("x"),
                                     "ERROR: Compute fsi/atom needs a run before it"),
    "a stress that is gone": ("updated", "unfix stress\n" + dump("x"), "ERROR: Compute fsi/atom needs a run before it"),
    "no fix fsi": ("tank", "unfix fsi\nvariable n equal f_dt[7]+f_particle\nprint ${n}\nrun 0", "ERROR: .*requires fix fsi"),
    "no style for bodies": ("tank", "pair_style fsi/fluid sound 10\npair_coeff * * m.fsi water rubber wall\ngroup moves clear\ngroup moves union water",
                            "WARNING: There is no pair_style fsi/solid/tl any more: its bodies lose their reference"),
    "the step's number": ("tank", "reset_timestep 0", "ERROR: Cannot reset timestep with time-dependent fix"),
    "density set in a run": ("updated", "fsi/set water density 1001", "WARNING: Fsi/set water density after 20 steps: masses change with densities"),
    "an integer adapted": ("updated", "variable c equal 1\nfix a all adapt 1 pair fsi/fluid couple * * v_c", "ERROR: .* param couple not supported"),
    "a logical adapted": ("updated", "variable c equal 1\nfix a all adapt 1 pair fsi/solid self * * v_c", "ERROR: .* param self not supported"),
    "a variable that is gone": ("stream", "variable u delete\nrun 5 pre no", "ERROR: Variable u of fix fsi/stream does not exist"),
}


@pytest.mark.parametrize("what", AGAIN)
def test_what_others_point_to(tmp_path, what):
    scene, between, expected = AGAIN[what]
    done = lammps(tmp_path, deck(scene) + f"run {STEPS}\n{between}\nrun 5\n", m_fsi=MATERIALS)
    answered(done, expected)


def test_particles_of_another_spacing_may_be_made(tmp_path):
    """When those of the old one are gone: only their masses hold it."""
    text = deck("stream") + f"""run {STEPS}
delete_atoms group water
unfix stream
unfix fsi
lattice sq 0.02 origin 0.5 0.5 0
create_atoms 1 region all
group water type 1
fix fsi water fsi 0.02 wendland 1.5
neighbor 0.006 bin
run 5
"""
    text = text.replace("region all block 0 0.2 0 0.1", "region all block 0 0.2 0 0.2").replace("0 0.1 -0.005", "0 0.2 -0.005").replace("0.1 0 0.1 INF", "0.1 0 0.2 INF")
    done = run(tmp_path, text.replace("0.15 0 0.1 INF", "0.15 0 0.2 INF") + dump("end"), m_fsi=MATERIALS)
    assert len(frame(done)) == 100


@pytest.mark.parametrize("ranks", (1, 2))
def test_wall_particles_join_a_motion_that_sums_over_ranks(tmp_path, ranks):
    """One rank makes the atom; the variable has a compute, which all of them have to ask."""
    text = deck("tank", move="compute far water reduce max x\nvariable s equal 0*c_far+0.01*(1-cos(30*time))\n"
                             "fix move piston fsi/move variable v_s v_zero NULL v_u v_zero NULL").replace("fsi/spectrum 5", "fsi/spectrum 50")
    text += "region up block -0.035 -0.005 0.2 0.3 -0.001 0.001 units box\nfix drip piston deposit 3 3 5 8765 region up near 0.02 units box id max\n"
    done = run(tmp_path, text + f"run {STEPS}\n" + dump("end"), ranks, m_fsi=MATERIALS)
    plain = run(tmp_path / "plain", deck("tank") + f"run {STEPS}\n" + dump("end"), m_fsi=MATERIALS)
    assert len(frame(done)) == len(frame(plain)) + 3


@pytest.mark.parametrize("thin", (2, 3))
def test_thin_no_more(tmp_path, whole, thin):
    """As if nothing had been thin, before any step; and after some the run goes on."""
    line = part("tank", "fsi").strip()
    text = deck("tank", fsi=f"{line} thin {thin}")
    done = run(tmp_path, text + f"run 0\n{line}\nrun 0\nrun {STEPS}\n" + dump("end"), m_fsi=MATERIALS)
    assert differences(whole("tank", 0), frame(done)) == {}
    run(tmp_path / "later", text + f"run {STEPS}\n{line}\nrun {STEPS}\n", m_fsi=MATERIALS)


MOTIONS = {"linear 0.2 0 0": "linear 0.2 0 0 units box", "wiggle": "wiggle 0.02 0 0 0.2 units box", "variables": "variable v_s2 v_zero NULL v_u2 v_zero NULL"}


@pytest.mark.parametrize("motion", MOTIONS)
def test_another_motion_after_a_restart_begins_there(tmp_path, motion):
    """The wall goes on from where it is, with the velocity of the new motion, and a warning names both."""
    whole_deck = deck("tank", move="fix move piston fsi/move linear 0.1 0 0 units box")
    run(tmp_path, whole_deck + f"run {STEPS}\nwrite_restart half\n", m_fsi=MATERIALS)
    again_lines = "\n".join(line for line in part("tank", "make").splitlines() if line.startswith("variable")) + "\nvariable zero equal 0\n"
    rest = part("tank", *(n for n in TANK if n != "make"), move=f"fix move piston fsi/move {MOTIONS[motion]}")
    if motion == "variables":    # they are functions of time, and 0 where the motion begins
        again_lines += "variable s2 delete\nvariable u2 delete\nvariable s2 equal 0.3*(time-0.0019)\nvariable u2 equal 0.3\n"
    text = "read_restart half\n" + again_lines + rest + dump("start") + f"run {STEPS}\n" + dump("end")
    done = run(tmp_path, text.replace(dump("start"), "run 0\n" + dump("start")), m_fsi=MATERIALS)
    assert re.search("WARNING: Fix fsi/move move: the motion was linear 0.1 0 0 when the restart file was written, and is", done.output)
    held = frame(done, "start")["type"] == 3
    moved = (frame(done)["x"] - frame(done, "start")["x"])[held]
    limit = 1.1 * {"linear 0.2 0 0": 0.2, "wiggle": 0.02 * 2 * np.pi / 0.2, "variables": 0.3}[motion] * STEPS * 1e-4
    assert 0 < moved.min() and moved.max() < limit + (0.001 if motion == "variables" else 0)


def column(tmp_path, extra="", between="", ranks=1, steps=60):
    """A column of water whose density follows surfaces, a perfect lattice: {id: density, forces}"""
    text = HEAD.format(**{**BOX, "types": 1}).replace("atom_modify map yes\n", "atom_modify map yes\n" + extra) + f"""
region water block 0 0.1 0 0.2 INF INF units box
create_atoms 1 region water
reset_atoms id sort yes
group water type 1
pair_style fsi/fluid sound 20 artificial/visc 0.05 0 density/diffusion 0.1 density/surface yes
pair_coeff * * m.fsi water
fix fsi all fsi 0.01 wendland 1.5
fix gravity all gravity 9.81 vector 0 -1 0
fix walls all fsi/wall/mirror xlo 0 xhi 0.3 ylo 0
compute state all fsi/atom rho p vonmises
timestep 1.8e-4
neighbor 0.003 bin
neigh_modify every 1 delay 0 check yes
{between or f'run {steps}'}
"""
    return frame(run(tmp_path, text + dump("end"), ranks, m_fsi=MATERIALS))


def test_density_that_follows_surfaces_has_no_noise(tmp_path):
    """In a perfect lattice the sums that it is made of are round-off inside: their quotients are not kept. Atoms in another order, and on two ranks."""
    want = column(tmp_path)
    for name, got in {"unsorted": column(tmp_path / "1", "atom_modify sort 0 0.0\n"), "ranks": column(tmp_path / "2", ranks=2)}.items():
        assert differences(want, got) == {}, name


def test_surfaces_do_not_know_the_step_number(tmp_path):
    """They are looked at in time: a run whose steps are counted anew is the same one."""
    want = column(tmp_path, between="run 23\nrun 50")
    got = column(tmp_path / "again", between="run 23\nreset_timestep 1000004\nrun 50")
    assert differences(want, got) == {}
