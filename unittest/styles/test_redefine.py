"""Every command given again between runs, with the same keywords and with others: what it does not
concern goes on.

Of each command in redefined.py:
  - the same once more, after some steps: the run is the uninterrupted one;
  - another one before any step: the run is that of the other command from the start;
  - another one after some steps: nothing jumps, and the run goes on, or an error names what must
    not change.
"""

import re

import numpy as np
import pytest
from redefined import MATERIALS, OTHER, SCENES, deck, of_size, part
from scenes import lammps, run

# sums in another order: 1e-16 of the largest, which a hundred steps of a shaken lattice do not
# bring above that
ROUND = 1e-10
STEPS = 20


def dump(name):
    return (f"write_dump all custom {name} id type x y vx vy fx fy c_state[*] modify sort id time "
            "yes format float %.17g\n")


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


# commands that are refused where their order is another one, or what they keep would begin anew: an
# error, or what begins anew
ORDER = {("tank", "un", "fsi"): r"after fix fsi|cannot|requires"}
KEEPS = {  # a state that begins anew where the fix does: the run is another one
    ("tank", "move"): "the motion begins there", ("tank", "dt"): "the step grows anew",
         ("updated", "stress"): "the stress is that of the fix", ("tank", "un", "spectrum"): ""}
SAME = [(scene, name, way) for scene, (commands, _) in SCENES.items() for name in commands
        if name not in ("make", "settings")
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
    done = lammps(tmp_path, deck(scene) + f"run {STEPS}\n" + again(scene, name)[way]
                  + f"\nrun {STEPS}\n" + dump("end"), m_fsi=MATERIALS)
    if answered(done, ORDER.get((scene, way, name))):
        return
    assert differences(whole(scene), frame(done)) == {}


@pytest.mark.parametrize("scene, ranks", [("updated", 1), ("updated", 2), ("levels", 1)])
def test_energies_of_fix_fsi_again(tmp_path, scene, ranks):
    """The sum of energies does not jump: what friction and ends have taken is kept."""
    say = 'run 0\nprint "sum $(c_energy:%.17g)"\n'
    done = run(tmp_path, deck(scene) + f"thermo_style custom step c_energy\nrun {STEPS}\n"
               f"{say}{part(scene, 'fsi')}{say}", ranks, m_fsi=MATERIALS)
    before, after = map(float, re.findall(r"^sum (\S+)$", done.output, re.M))
    assert abs(after - before) < 1e-12 * before


# ---- another one ---------------------------------------------------------------------------------

# splits in run 0: fuzz_runs.py has it
CASES = [(scene, name, text, refused, way) for (scene, name), others in OTHER.items()
         for text, refused in others.items() if name != "refine"
         # taken away first, where that is possible: of the same, both are tried
         for way in (list(again(scene, name, text))[-1:] if (scene, "un", name) not in ORDER
                     else [""])]
IDS = [f"{scene} {way}{text}".replace("\n", " ") for scene, name, text, refused, way in CASES]


def answered(done, expected):
    """Is it refused, or taken with a warning, as it should?"""
    if not expected:
        assert done.status == 0, done.output[-1500:]
        return False
    assert re.search(expected, done.output) and (done.status == 0) == expected.startswith(
        "WARNING"), done.output[-1500:]
    return True


@pytest.mark.parametrize("scene, name, text, refused, way", CASES, ids=IDS)
def test_another_before_any_step(tmp_path, whole, scene, name, text, refused, way):
    """As if it had been so from the start: after a run of no steps, which all arrays are made in.
    An error is that of the command itself."""
    done = lammps(tmp_path, deck(scene) + "run 0\n" + again(scene, name, text)[way]
                  + f"\nrun 0\nrun {STEPS}\n" + dump("end"), m_fsi=MATERIALS)
    if answered(done, ORDER.get((scene, way, name)) or refused):
        return
    assert differences(whole(scene, 0, **{name: text}), frame(done)) == {}


@pytest.mark.parametrize("scene, name, text, refused, way", CASES, ids=IDS)
def test_another_after_some_steps(tmp_path, scene, name, text, refused, way):
    """No place, velocity, density of a fluid or strain jumps with it, nothing is lost, and the run
    goes on."""
    done = lammps(tmp_path, deck(scene) + f"run {STEPS}\n" + dump("before")
                  + again(scene, name, text)[way] + "\nrun 0\n" + dump("after")
                  + f"run {STEPS}\n" + dump("end"), m_fsi=MATERIALS)
    answered(done, ORDER.get((scene, way, name)) or refused)
    if done.status:
        return
    before, after, end = (frame(done, n) for n in ("before", "after", "end"))
    # their density is that of their pressure; their velocity follows the motion at once
    held = before["type"] == 3
    # there type 2 is fluid, too
    solid, fluid = (before["type"] == 2) & (scene != "levels"), before["type"] == 1
    for c in ("x", "y"):
        np.testing.assert_array_equal(before[c], after[c])
    for c in ("vx", "vy"):
        np.testing.assert_array_equal(before[c][~held], after[c][~held])
    made_anew = "summation" in text
    if not made_anew:
        np.testing.assert_allclose(after["c_state[1]"][fluid], before["c_state[1]"][fluid],
                                   rtol=1e-12)
    if solid.any() and name not in ("coeff",
                                    "stress") and "law" not in text and "plane" not in text:
        np.testing.assert_allclose(after["c_state[3]"][solid], before["c_state[3]"][solid],
                                   rtol=1e-9, atol=1e-9 * before["c_state[3]"].max())
    # in the next steps nothing moves further than twice what the fastest did
    for c in ("x", "y"):
        assert np.abs(end[c] - after[c])[np.isin(after["id"], end["id"])].max() < 0.01 if len(
            end) == len(after) else True
    assert all(np.isfinite(end[c]).all() for c in COLUMNS)


# ---- what else commands between runs change ------------------------------------------------------

AGAIN = {  # scene, what comes between, what is said: an error, or a warning and it goes on
    "a compute that is gone": ("tank", "uncompute force\nrun 2 pre no", "ERROR: Run with pre no "
                               "does not go with other fixes, computes, regions or pair styles"),
    "another compute of the same ID": ("tank", "uncompute force\ncompute force beam fsi/force\n"
                                       "run 2 pre no", "ERROR: Run with pre no"),
    "a fix that is new": ("tank", "fix more all fsi/watch 7\nrun 2 pre no",
                          "ERROR: Run with pre no"),
    **{f"another {name} in its place": (scene, f"{part(scene, name)}run 2 pre no",
                                        "ERROR: Run with pre no") for scene, name in
       [("tank", "dt"), ("tank", "move"), ("tank", "pair"), ("open", "mirror"), ("open", "inlet"),
        ("levels", "refine"), ("stream", "stream")]},
    "another fix fsi": ("stream", "unfix fsi\n" + part("stream", "fsi") + "run 2 pre no",
                        "ERROR: Run with pre no"),
    "a type that is another": (
        "tank", "region w block 0 0.03 0 0.03 INF INF units box\nset region w type 2\n" + dump("x"),
        "ERROR: Compute fsi/atom needs a run before it"),
    "as many new atoms as old ones": ("tank", "group g region beam\ndelete_atoms group g compress "
                                      "no\ncreate_atoms 2 region beam\n" + dump("x"),
                                      "ERROR: Compute fsi/atom needs a run before it"),
    "a pair style that has not run": ("tank", part("tank", "pair", "coeff") + dump("x"),
                                      "ERROR: Compute fsi/atom needs a run before it"),
    "a law that has no stress yet": ("tank",
                                     "pair_style hybrid fsi/fluid sound 10 fsi/solid/tl law hypo\n"
                                     + part("tank", "coeff") + dump("x"),
                                     "ERROR: Compute fsi/atom needs a run before it"),
    "a stress that is gone": ("updated", "unfix stress\n" + dump("x"),
                              "ERROR: Compute fsi/atom needs a run before it"),
    "no fix fsi": ("tank", "unfix fsi\nvariable n equal f_dt[7]+f_particle\nprint ${n}\nrun 0",
                   "ERROR: .*requires fix fsi"),
    "no style for bodies": ("tank", "pair_style fsi/fluid sound 10\npair_coeff * * m.fsi water "
                            "rubber wall\ngroup moves clear\ngroup moves union water",
                            "WARNING: There is no pair_style fsi/solid/tl any more: its bodies "
                            "lose their reference"),
    "the step's number": ("tank", "reset_timestep 0",
                          "ERROR: Cannot reset timestep with time-dependent fix"),
    "density set in a run": ("updated", "fsi/set water density 1001", "WARNING: Fsi/set water "
                             "density after 20 steps: masses change with densities"),
    "an integer adapted": ("updated",
                           "variable c equal 1\nfix a all adapt 1 pair fsi/fluid couple * * v_c",
                           "ERROR: .* param couple not supported"),
    "a logical adapted": ("updated",
                          "variable c equal 1\nfix a all adapt 1 pair fsi/solid self * * v_c",
                          "ERROR: .* param self not supported"),
    "a variable that is gone": ("stream", "variable u delete\nrun 5 pre no",
                                "ERROR: Variable u of fix fsi/stream does not exist"),
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
    text = text.replace("region all block 0 0.2 0 0.1", "region all block 0 0.2 0 0.2").replace(
        "0 0.1 -0.005", "0 0.2 -0.005").replace("0.1 0 0.1 INF", "0.1 0 0.2 INF")
    done = run(tmp_path, text.replace("0.15 0 0.1 INF", "0.15 0 0.2 INF") + dump("end"),
               m_fsi=MATERIALS)
    assert len(frame(done)) == 100


@pytest.mark.parametrize("ranks", (1, 2))
def test_wall_particles_join_a_motion_that_sums_over_ranks(tmp_path, ranks):
    """One rank makes the atom; the variable has a compute, which all of them have to ask."""
    text = deck("tank", move="compute far water reduce max x\n"
                "variable s equal 0*c_far+0.01*(1-cos(30*time))\n"
                "fix move piston fsi/move variable v_s v_zero NULL v_u v_zero NULL").replace(
                    "fsi/spectrum 5", "fsi/spectrum 50")
    text += ("region up block -0.035 -0.005 0.2 0.3 -0.001 0.001 units box\n"
             "fix drip piston deposit 3 3 5 8765 region up near 0.02 units box id max\n")
    done = run(tmp_path, text + f"run {STEPS}\n" + dump("end"), ranks, m_fsi=MATERIALS)
    plain = run(tmp_path / "plain", deck("tank") + f"run {STEPS}\n" + dump("end"), m_fsi=MATERIALS)
    assert len(frame(done)) == len(frame(plain)) + 3


@pytest.mark.parametrize("ranks", (1, 2))
@pytest.mark.parametrize("ids", ("max", "next"))
def test_atoms_that_another_fix_makes_beside_ends(tmp_path, ids, ranks):
    """Id next counts on from the largest ID that there was when the fix was defined: copies of the
    ends have those."""
    text = (deck("open") + "region up block 0.05 0.15 0.12 0.2 -0.001 0.001 units box\n"
            f"fix rain water deposit 4 1 20 8765 region up near 0.02 units box id {ids}\n")
    done = lammps(tmp_path, text + "run 100\n" + dump("end"), ranks, m_fsi=MATERIALS)
    if answered(done, "ERROR: A fix made atoms with IDs that others have, as .* id max" if ids
                == "next" else ""):
        return
    found = frame(done)["id"]
    assert len(set(found)) == len(found)


@pytest.mark.parametrize("thin", (2, 3))
def test_thin_no_more(tmp_path, whole, thin):
    """As if nothing had been thin, before any step; and after some the run goes on."""
    line = part("tank", "fsi").strip()
    text = deck("tank", fsi=f"{line} thin {thin}")
    done = run(tmp_path, text + f"run 0\n{line}\nrun 0\nrun {STEPS}\n" + dump("end"),
               m_fsi=MATERIALS)
    assert differences(whole("tank", 0), frame(done)) == {}
    run(tmp_path / "later", text + f"run {STEPS}\n{line}\nrun {STEPS}\n", m_fsi=MATERIALS)


MOTIONS = {"linear 0.2 0 0": "linear 0.2 0 0 units box", "wiggle": "wiggle 0.02 0 0 0.2 units box",
           "variables": "variable v_s2 v_zero NULL v_u2 v_zero NULL"}


@pytest.mark.parametrize("motion", MOTIONS)
def test_another_motion_after_a_restart_begins_there(tmp_path, motion):
    """The wall goes on from where it is, with the velocity of the new motion, and a warning names
    both."""
    whole_deck = deck("tank", move="fix move piston fsi/move linear 0.1 0 0 units box")
    run(tmp_path, whole_deck + f"run {STEPS}\nwrite_restart half\n", m_fsi=MATERIALS)
    again_lines = "\n".join(line for line in part("tank", "make").splitlines()
                            if line.startswith("variable")) + "\nvariable zero equal 0\n"
    rest = part("tank", *(n for n in SCENES["tank"][0] if n != "make"),
                move=f"fix move piston fsi/move {MOTIONS[motion]}")
    if motion == "variables":    # they are functions of time, and 0 where the motion begins
        again_lines += ("variable s2 delete\nvariable u2 delete\n"
                        "variable s2 equal 0.3*(time-0.0019)\nvariable u2 equal 0.3\n")
    text = "read_restart half\n" + again_lines + rest + dump("start") + f"run {STEPS}\n" + dump(
        "end")
    done = run(tmp_path, text.replace(dump("start"), "run 0\n" + dump("start")), m_fsi=MATERIALS)
    assert re.search("WARNING: Fix fsi/move move: the motion was linear 0.1 0 0 when the restart "
                     "file was written, and is", done.output)
    held = frame(done, "start")["type"] == 3
    moved = (frame(done)["x"] - frame(done, "start")["x"])[held]
    limit = 1.1 * {"linear 0.2 0 0": 0.2, "wiggle": 0.02 * 2 * np.pi / 0.2,
                   "variables": 0.3}[motion] * STEPS * 1e-4
    assert 0 < moved.min() and moved.max() < limit + (0.001 if motion == "variables" else 0)


def column(tmp_path, extra="", between="", ranks=1, steps=60):
    """A column of water whose density follows surfaces, a perfect lattice: {id: density, forces}"""
    text = of_size("-0.05 0.35 -0.05 0.35", 1).replace("atom_modify map yes\n", "atom_modify map yes\n" + extra) + f"""
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
    """In a perfect lattice the sums that it is made of are round-off inside: their quotients are
    not kept. Atoms in another order, and on two ranks."""
    want = column(tmp_path)
    for name, got in {"unsorted": column(tmp_path / "1", "atom_modify sort 0 0.0\n"),
                      "ranks": column(tmp_path / "2", ranks=2)}.items():
        assert differences(want, got) == {}, name


def test_surfaces_do_not_know_the_step_number(tmp_path):
    """They are looked at in time: a run whose steps are counted anew is the same one."""
    want = column(tmp_path, between="run 23\nrun 50")
    got = column(tmp_path / "again", between="run 23\nreset_timestep 1000004\nrun 50")
    assert differences(want, got) == {}
