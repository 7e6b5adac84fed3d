"""A scene pays for what it names: instructions, memory and messages of effects that are not named,
and warnings for those named in vain.

Instructions are counted by valgrind in the time loop alone, messages around the MPI calls of two
ranks: neither depends on the machine's load.
"""

import re
import sys

import pytest
from decks import box

from fsi import paths

sys.path.insert(0, str(paths.ROOT / "bench"))
import effects  # noqa: E402
import measure  # noqa: E402
import scaling  # noqa: E402

SMALL = (24, 16)
# counts of the same work differ by so much: what MPI does between is not the same every time
SAME = 2e-3
DECKS = {"fluid": effects.fluid, "updated": effects.updated, "total": effects.total}
# every effect of a style that has a size, of size zero, or as it is where nothing is named
ZERO = {
    "fluid": "artificial/visc 0 0 density/diffusion 0 shift 0 surface 0 tension no background 0 "
    "couple wall extrapolate no",
    "updated": "artificial/visc 0 0 artificial/stress 0 hourglass 0 gradient plain",
    "total": "artificial/visc 0 0 hourglass 0.05 damage 0 law svk"}
AWAY = "fix away all fsi/wall/mirror xlo -0.15 xhi 1.15 ylo -0.15 yhi 1.15"  # nobody is near


def deck(name, **settings):
    """A small scene in which nothing moves far enough for another neighbor list."""
    text = effects.write_materials(DECKS[name](*SMALL, **settings))
    return re.sub(r"^timestep .*", "timestep 1e-7", text, flags=re.M)


@pytest.fixture(scope="module")
def counted():
    """{(scene, what is named): {function: instructions a step}}"""
    cases = {(name, "nothing"): deck(name) for name in DECKS}
    cases |= {(name, "zero"): deck(name, style=style) for name, style in ZERO.items()}
    cases |= {("fluid", "walls"): deck("fluid", walls="yes"),
              ("fluid", "walls away"): deck("fluid", commands=AWAY),
              ("fluid", "viscosity"): deck("fluid", style="artificial/visc 0.05 0"),
              ("fluid", "shift"): deck("fluid", style="shift 0.1"),
              ("updated", "stress"): deck("updated", style="artificial/stress 0.3"),
              ("total", "bare"): deck("total", style="hourglass 0"),
              ("total", "damage"): deck("total", style="damage 0.5")}
    found = measure.profiles(list(cases.values()))
    steps = measure.LONG - measure.SHORT
    return {case: {f: (n - a.get(f, 0)) / steps for f, n in b.items()}
            for case, (a, b) in zip(cases, found)}


@pytest.mark.parametrize("name", DECKS)
def test_effects_of_size_zero_cost_no_instruction(counted, name):
    nothing, zero = (sum(counted[name, what].values()) for what in ("nothing", "zero"))
    assert nothing > 1e5  # pairs have been visited
    assert abs(zero / nothing - 1.0) < SAME


@pytest.mark.parametrize("name, what, without, least", [
    ("fluid", "viscosity", "nothing", 0.05), ("fluid", "shift", "nothing", 0.2),
    ("fluid", "walls", "nothing", 0.2),
    ("updated", "stress", "nothing", 0.05), ("total", "nothing", "bare", 0.1)])
def test_an_effect_is_counted(counted, name, what, without, least):
    """What the other tests find absent would be seen; and hourglass control can be taken away."""
    assert sum(counted[name, what].values()) > (1.0 + least) * sum(counted[name, without].values())


def test_damage_looks_where_a_bond_may_break(counted):
    """Each particle's motion, at some 20 instructions, but not its bonds, at some 50 each."""
    more = sum(counted["total", "damage"].values()) - sum(counted["total", "nothing"].values())
    assert 0 < more < 50 * SMALL[0] * SMALL[1]


FOREIGN = {
    "fluid": "Solid|Stress|Reference|Wall|Energy|FSIDt|Watch|Surface|position_divergence|"
             "number_density|displacements",
    "updated": "Fluid|SolidTL|Reference|Wall|Energy|FSIDt|Watch|Surface|hourglass|number_density",
    "total": "Fluid|Wall|FixFSIStress|Energy|FSIDt|Watch|Surface|advance_solids|break_bonds|"
             "number_density"}


@pytest.mark.parametrize("name", DECKS)
def test_no_function_of_what_is_not_named_runs(counted, name):
    """But for a constant number of instructions: what asks, once a step, whether there is anything
    to do."""
    ours = {f: n for f, n in counted[name, "nothing"].items() if "FSI" in f}
    particles = SMALL[0] * SMALL[1]
    assert sum(ours.values()) > 100 * particles
    foreign = {f: n for f, n in ours.items() if re.search(FOREIGN[name], re.sub(r"\(.*", "", f))
               and n > 0.1 * particles}
    assert not foreign


def test_walls_that_nobody_is_near_cost_a_look(counted):
    """Whether each particle is in the box away from all four walls, for the guard and for images,
    at some 20 instructions each, and twice the look at the bits that come of it; pairs cost nothing
    more."""
    more = sum(counted["fluid", "walls away"].values()) - sum(counted["fluid", "nothing"].values())
    assert 0 < more < (2 * 30 + 2 * 10) * SMALL[0] * SMALL[1]


# ---- messages ------------------------------------------------------------------------------------

OWN = 8 * (6 + 3)  # LAMMPS' own for each ghost: positions and velocities out, forces back
SENT = [(name, settings) for name in DECKS
        for settings in [{}, *(s for _, _, s in effects.cases(name))]
        if not settings.get("commands")] + [("total", {"sph": "substeps 4"})]


# Numbers for a ghost of a bare scene: density out and its rate back; with stress out and the
# velocity gradient back; forces of bonds back
BARE = {"fluid": 1 + 1, "updated": 1 + 3 + 4, "total": 1 + 2}
# What an effect adds, in a step: messages, numbers for a ghost. What is not here adds nothing
ADDED = {"shift 0.1": (0, 5), "shift 0.1 shift/every 4": (0, 5 / 4),  # sums of shifting back
         # number density out and back; no rate of a fluid
         "surface 0.9": (1, 2), "fluid summation": (0, 1), "solid summation": (1, 2),
         "solid ratio": (1, 2),
         "gradient corrected": (0, 2 * 5), "gradient quadratic": (0, 46),
         "hourglass 0.5": (2, 4 + 2),
         "substeps 4": (8 - 1, 4 * (2 + 2) - 2)}


@pytest.fixture(scope="module")
def sent():
    return measure.messages([deck(name, **settings) for name, settings in SENT])


@pytest.mark.parametrize("k", range(len(SENT)), ids=[
    f"{n}: {' '.join(map(str, s.values())) or 'nothing'}" for n, s in SENT])
def test_messages_are_those_of_what_is_named(sent, k):
    """Counted by hand; positions and forces are two more messages."""
    name, settings = SENT[k]
    messages, numbers = ADDED.get(" ".join(map(str, settings.values())), (0, 0))
    assert sent[k]["ghosts"] > 0
    assert sent[k]["messages"] == pytest.approx(4 + messages, abs=1e-9)
    assert sent[k]["bytes"] == pytest.approx((OWN + 8 * (BARE[name] + numbers)) * sent[k]["ghosts"],
                                             abs=1e-6)


def test_substeps_send_nothing_where_no_solid_is():
    """The gate, whose plate is one rank's alone: positions out, forces back, density out, its rate
    back, and nothing for sub-steps."""
    found, = measure.messages([re.sub(r"^timestep .*", "timestep 1e-7",
                                      effects.deck("gate", {}, effects.COUNTED["gate"]),
                                      flags=re.M)])
    assert found["ghosts"] > 100
    assert (found["messages"], found["empty"]) == (4, 0)


def test_walls_of_particles_send_nothing_where_none_is():
    """The channel, whose cylinder is one rank's alone, is periodic: its two ranks have two borders
    with each other. At each positions, forces, density and its rate, and nothing for the cylinder's
    pressure and velocity."""
    found, = measure.messages([scaling.still_deck(*scaling.SHARED["channel"])])
    assert found["ghosts"] > 100
    assert (found["messages"], found["empty"]) == (8, 0)


def stream(rows):
    """A stream between open ends that two ranks cut along its middle: rows of particles from side
    to side, 24 along it."""
    return effects.write_materials(box(f"-0.5 1.5 0 {rows / 24!r}", 1 / 24, "processors 1 2 1", boundary="f p p", water="0 1 INF INF") + f"""pair_style fsi/fluid sound 10 tension yes background 1000
pair_coeff * * materials.fsi water
fix sph all fsi {1 / 24!r} wendland 1.5
fix in all fsi/inlet xlo 0.0 velocity 0.3 0 0
fix out all fsi/outlet xhi 1.0
timestep 1e-7
neighbor {0.4 / 24!r} bin
thermo 1000000
""")


def test_open_ends_reduce_no_plane():
    """A step reduces the same few numbers whatever the plane's size: 15 sums of each end, and every
    20th step four. For each end a rank sends the other one message, of the nodes near the line
    between them; every 20th step two more, for both ends, carry the number density and the stress
    home."""
    small, large = measure.messages([stream(24), stream(48)])
    assert (small["reduced"] == pytest.approx(large["reduced"]) and 2 * 15 * 8 <= small["reduced"]
            < 300)
    assert small["bytes"] == pytest.approx(large["bytes"])
    alone = measure.messages([re.sub("^fix (in|out) .*$", "", stream(48), flags=re.M)])[0]
    assert large["messages"] == pytest.approx(alone["messages"] + 2 * (1 + 2 / 20))


# ---- memory --------------------------------------------------------------------------------------

# three rows of particles along each side of the square are near a wall: a row of images each, of
# half their neighbors and themselves
IMAGES = (1 - (119 / 125) ** 2) * (16 + 4 * (12 + 1))
ARRAYS = {"nothing": (0, {}), "shifting": (64, {"style": "shift 0.1"}),
          "walls": (4 + IMAGES, {"walls": "yes"}), "surface": (8, {"style": "surface 0.9"}),
          "surfaces": (16, {"style": "density/surface yes"}),
          "summation": (-16, {"sph": "fluid summation"}),
          "the rest": (0, {"style": "artificial/visc 0.05 0 laminar/visc density/diffusion 0.1 eos "
                           "tait tension yes background 1"})}
SLOTS = 16384  # LAMMPS grows its arrays by so many atoms


def test_memory_of_a_fluid():
    """Beyond a bare LAMMPS with the same particles and lists: position, velocity, density, volume,
    pressure and its factor gathered for the loops, the sums of forces, the density's rate, where
    near pairs were sorted out, rows of 16 bytes, and what an effect adds; no stress, no
    gradient."""
    def text(settings):
        return effects.write_materials(effects.fluid(125, 125, **settings)) + "\nrun 0"
    bare = re.sub(r"^(fix|pair_style|pair_coeff) .*\n", "", text({}), flags=re.M)
    bare = bare.replace("timestep", "pair_style zero 0.024\npair_coeff * *\nset group all mass 1\n"
                        "fix move all nve\ntimestep")
    texts = [bare, *(text(settings) for _, settings in ARRAYS.values())]
    own, *found = [run.bytes_per_rank for run in measure.simulate("\nclear\n".join(texts)).finished]
    gathered = 8 * (2 + 2 + 4 + 2 + 1 + 2) + 16
    for (name, (more, _)), total in zip(ARRAYS.items(), found):
        # the log has four digits
        assert (total - own) / SLOTS == pytest.approx(gathered + more, abs=1.5), name


# ---- named in vain -------------------------------------------------------------------------------

def world(style, of, sph="", commands=""):
    """Particles of type `of` (1 water, 2 plate) in a scene that has materials for both."""
    pairs = {"fluid": "pair_coeff * * materials.fsi water plate",
             "solid": "pair_coeff * * materials.fsi plate plate",
             "both": "pair_coeff * * fsi/fluid materials.fsi water plate\n"
             "pair_coeff * * fsi/solid materials.fsi NULL plate",
             }
    kind = "both" if style.startswith("hybrid") else style[4:].split()[0]
    text = effects.updated(*SMALL).replace("create_box 1", "create_box 2").replace(
        "create_atoms 1", f"create_atoms {of}")
    text = re.sub(r"^pair_style .*\npair_coeff .*", f"pair_style {style}\n{pairs[kind]}", text,
                  flags=re.M)
    text = re.sub(r"^(fix sph .*)", rf"\1 {sph}", text, flags=re.M)
    if kind == "fluid":
        text = re.sub(r"^fix stress .*\n", "", text, flags=re.M)
    return effects.write_materials(text + commands + "\nrun 0")


HYBRID = "hybrid fsi/fluid sound 10 {} fsi/solid {}"
VAIN = {
    "shift without fluid": (world(HYBRID.format("shift 0.1 artificial/visc 0.1 0", ""), 2),
                            ["Pair style fsi/fluid with artificial/visc, shift, couple has nothing "
                             "to act on: no particle is a fluid"]),
    "walls without fluid": (world(HYBRID.format("", ""), 2,
                                  commands="fix walls all fsi/wall/mirror xlo 0"),
                            ["Pair style fsi/fluid",
                             "Fix fsi/wall/mirror has nothing to act on: no particle is a fluid"]),
    "walls without the fluid's style": (
        world("fsi/solid", 2, commands="fix walls all fsi/wall/mirror xlo 0"),
        ["Fix fsi/wall/mirror has nothing to act on: walls mirror fluids"]),
    "artificial stress without solid": (world(HYBRID.format("", "artificial/stress 0.3"), 1),
                                        ["Pair style fsi/solid with gradient, artificial/stress "
                                         "has nothing to act on: no particle is a solid",
                                         "Fix fsi/stress has nothing to act on: no particle is a "
                                         "solid"]),
    "sub-steps without solid": (world("hybrid fsi/fluid sound 10 fsi/solid/tl", 1,
                                      "substeps 4").replace("* fsi/solid m",
                                                            "* fsi/solid/tl m").replace(
        "fix stress all fsi/stress", ""),
                                ["Pair style fsi/solid/tl with law svk, hourglass has nothing",
                                 "Fix fsi substeps has nothing"]),
    "density of fluids without their style": (world("fsi/solid", 2, "fluid summation"),
                                              ["Fix fsi fluid density has nothing to act on"]),
    "density of solids without their style": (world("fsi/fluid sound 10", 1, "solid ratio"),
                                              ["Fix fsi solid density has nothing to act on"]),
    "no-slip walls without viscosity": (
        world("fsi/fluid sound 10", 1, commands="fix walls all fsi/wall/mirror ylo 0 slip no"),
        ["Fix fsi/wall/mirror slip no has nothing to act on: pair_style fsi/fluid has no "
         "laminar/visc"]),
    "extrapolation without solid": (world("fsi/fluid sound 10 extrapolate yes",
                                          1).replace("water plate", "water water"),
                                    ["extrapolate has nothing to act on: there is no solid"]),
    "extrapolation without walls of solid": (world(HYBRID.format("couple full extrapolate yes", ""),
                                                   1, commands="set atom 1 type 2"),
                                             ["extrapolate has nothing to act on: it is for couple "
                                              "wall"]),
    "sub-steps of what has none": (world("fsi/fluid sound 10", 1,
                                         commands="fix dt all fsi/dt 10 substeps auto"),
                                   ["Fix fsi/dt substeps auto has nothing to act on: there is no "
                                    "pair_style fsi/solid/tl"]),
    "watch on nobody": (world("fsi/fluid sound 10", 1, commands="group none type 2\n"
                              "fix watch none fsi/watch 10\nfix dt none fsi/dt 10"),
                        ["Fix fsi/watch has nothing to act on: group none has no fluid and no "
                         "solid",
                         "Fix fsi/dt has nothing to act on: group none is empty"]),
    "nothing in vain": (
        world(HYBRID.format("artificial/visc 0.1 0 extrapolate yes", "artificial/stress 0.3"), 1,
              commands="set atom 1*8 type 2\nset group all mol 1\n"
              "fix walls all fsi/wall/mirror xlo 0"), [])}


@pytest.mark.parametrize("name", VAIN)
def test_what_is_named_in_vain_is_warned_of(name):
    text, expected = VAIN[name]
    warnings = [w for w in measure.simulate(text).warnings if "nothing to act on" in w]
    assert len(warnings) == len(expected), warnings
    for words in expected:
        assert any(words in w for w in warnings), (words, warnings)
