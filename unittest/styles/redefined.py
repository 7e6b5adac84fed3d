"""Scenes that together name every style of the package, and what else each of their commands may be
(test_redefine.py, fuzz_runs.py)."""

from decks import box, materials

MATERIALS = materials(water="fluid rho 1000 viscosity 1", oil="fluid rho 900 viscosity 2",
                      rubber="solid rho 1100 young 2e5 poisson 0.3",
                      stiffer="solid rho 1100 young 4e5 poisson 0.3", wall="wall rho 1000")

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
    "pair": "pair_style hybrid fsi/fluid sound 10 artificial/visc 0.05 0 density/diffusion 0.1 "
        "fsi/solid/tl artificial/visc 0.1 0",
    "coeff": "pair_coeff * * fsi/fluid m.fsi water rubber wall\n"
        "pair_coeff * * fsi/solid/tl m.fsi NULL rubber NULL",
    "fsi": "fix fsi moves fsi 0.01 wendland 1.5",
    "gravity": "fix gravity all gravity 9.81 vector 0 -1 0",
    "mirror": "fix mirror water fsi/wall/mirror xhi 0.25 ylo 0",
    "particle": "fix particle piston fsi/wall/particle guard 0",
    "move": "fix move piston fsi/move variable v_s NULL NULL v_u v_zero NULL".replace(
        "NULL NULL v_u", "v_zero NULL v_u"),
    "dt": "fix dt all fsi/dt 5 max 1e-4",
    "watch": "fix watch all fsi/watch 10",
    "report": "fix report all fsi/report",
    "energy": "compute energy all fsi/energy",
    "force": "compute force beam fsi/force",
    "probe": "compute probe water fsi/probe point 0.05 0.05 0 p",
    "surface": "compute surface water fsi/surface/atom divergence 0.75",
    "state": "compute state all fsi/atom rho p vonmises",
    "spectrum": "fix spectrum all fsi/spectrum 5 c_energy[1]",
    "settings": "variable zero equal 0\nneighbor 0.003 bin\n"
        "neigh_modify every 1 delay 0 check yes\nthermo_modify norm no lost error",
}
UPDATED = {**TANK,
    "pair": "pair_style hybrid fsi/fluid sound 10 artificial/visc 0.05 0 fsi/solid artificial/visc "
           "0.1 0 hourglass 0.1 gradient quadratic",
    "coeff": "pair_coeff * * fsi/fluid m.fsi water rubber wall\n"
           "pair_coeff * * fsi/solid m.fsi NULL rubber NULL",
    "stress": "fix stress all fsi/stress"}
UPDATED = {k: UPDATED[k] for k in ("make", "pair", "coeff", "fsi", "stress", "gravity", "mirror",
                                   "particle", "energy", "state", "settings")}
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


def of_size(size, types, boundary="f f p"):
    return box(size, 0.01, "atom_modify map yes", boundary=boundary, types=types)


TANK_BOX = of_size("-0.05 0.35 -0.05 0.35", 3)
SCENES = {"tank": (TANK, TANK_BOX), "updated": (UPDATED, TANK_BOX),
          "open": (OPEN, of_size("-0.08 0.28 -0.05 0.35", 1)),
          "levels": (LEVELS, of_size("-0.08 0.38 -0.05 0.35", 2)),
          "stream": (STREAM, of_size("0 0.2 0 0.1", 1, "p p p"))}


def part(scene, *names, **other):
    """Lines of these commands, or of all; other: what stands in the place of some"""
    commands = SCENES[scene][0]
    return "\n".join(other.get(n, commands[n]) for n in names or commands) + "\n"


def deck(scene, **other):
    # variables before those that name them
    text = part(scene, **other)
    return SCENES[scene][1] + "variable zero equal 0\n" + text.replace("variable zero equal 0\n",
                                                                       "")


FLUID = "sound 10 artificial/visc 0.05 0 density/diffusion 0.1"
BODY = "fsi/solid/tl artificial/visc 0.1 0"
OLD_KERNEL = ("WARNING: Fix fsi: kernel was .* masses of particles and bonds of total-Lagrangian "
              "solids are still those of the old one")
# scene, name: other commands, each with what an error says if it is refused, or a warning if it is
# not as if from the start
OTHER = {
    ("tank", "pair"): {f"pair_style hybrid fsi/fluid {fluid} {body}": refused
                       for fluid, body, refused in [
        (FLUID + " density/surface yes", BODY, ""), (FLUID + " shift 0.1", BODY, ""),
        (FLUID + " shift 0.1 shift/every 3", BODY, ""),
        (FLUID + " laminar/visc", BODY, ""), (FLUID + " laminar/visc/central solid/slip yes", BODY,
                                              ""), (FLUID + " extrapolate yes", BODY, ""),
        (FLUID + " surface 0.7", BODY, ""), ("sound 12 eos tait", BODY, ""),
        (FLUID + " tension yes background 100", BODY, ""),
        (FLUID, BODY + " hourglass 0.2", ""), (FLUID, BODY + " law neohookean", ""),
        (FLUID, BODY + " plane stress", ""),
        (FLUID, BODY + " damage 0.5", ""), (FLUID, BODY + " contact 1.5", ""),
        (FLUID, BODY + " gradient linear", "bonds of its bodies were made with"),
        (FLUID, BODY + " volumes plain", "bonds of its bodies were made with"),
        (FLUID, BODY + " law hypo", "requires fix fsi/stress")]},
    ("tank", "coeff"): {"pair_coeff * * fsi/fluid m.fsi oil rubber wall\n"
                        "pair_coeff * * fsi/solid/tl m.fsi NULL rubber NULL": "has the mass of a "
                        "material of density 1000, but that of its type has 900 now",
                        "pair_coeff * * fsi/fluid m.fsi water stiffer wall\n"
                        "pair_coeff * * fsi/solid/tl m.fsi NULL stiffer NULL": "",
                        "pair_coeff * * fsi/fluid m.fsi water stiffer wall\n"
                        "pair_coeff * * fsi/solid/tl m.fsi NULL rubber NULL": "expected the same"},
    ("tank", "fsi"): {f"fix fsi moves fsi {words}": refused for words, refused in [
        ("0.01 wendland 1.5 substeps 4", ""), ("0.01 wendland 1.5 thin 2", ""),
        ("0.01 wendland 1.5 thin 3", ""), ("0.01 wendland 1.5 mach off", ""),
        ("0.012 wendland 1.5", "particle spacing was 0.01 in the last run, and is 0.012 now"),
        ("0.01 wendland 1.5 spacing 2 0.005",
         "spacing was none in the last run, and is 2 0.005 now"),
        ("0.01 wendland 1.5 fluid summation", "density/diffusion requires"),
        ("0.01 quintic 1.0", OLD_KERNEL)]},
    ("tank", "gravity"): {"fix gravity all gravity 5 vector 1 -1 0": "",
                          "fix gravity water gravity 9.81 vector 0 -1 0": ""},
    ("tank", "mirror"): {"fix mirror water fsi/wall/mirror xhi 0.25 ylo 0 slip no": "",
                         "fix mirror water fsi/wall/mirror xhi 0.30 ylo 0 guard 0": "",
                         "fix mirror water fsi/wall/mirror xhi 0.25 velocity -0.1 0 0 ylo 0": ""},
    ("tank", "particle"): {f"fix particle piston fsi/wall/particle {words}": "" for words in (
        "guard 0 slip no", "guard 0 pressure linear", "guard 0.3")},
    ("tank", "move"): {"fix move piston fsi/move variable v_s2 v_zero NULL v_u2 v_zero NULL": "",
                       "fix move piston fsi/move linear 0.1 0 0 units box": "",
                       "fix move piston fsi/move wiggle 0.01 0 0 0.2 units box": "", "fix move "
                       "piston fsi/move linear 0.1 NULL 0 units box": "Write 0 instead of NULL",
                       "fix move piston fsi/move variable v_s v_zero NULL v_zero v_zero NULL":
                           r"displacement v_s changes by \S+ per time, but the velocity v_zero "
                           r"is 0"},
    ("tank", "dt"): {"fix dt all fsi/dt 5 max 5e-5": "",
                     "fix dt all fsi/dt 2 cfl 0.2 max 1e-4 substeps auto": "",
                     "fix dt all fsi/dt 5 check warn": "",
                     "fix dt all fsi/dt 5 max 1e-4 stop 0.01": ""},
    ("tank", "watch"): {"fix watch all fsi/watch 3 distance 0.1 action warn": ""},
    ("tank", "report"): {"fix report all fsi/report file other.txt": ""},
    ("tank", "spectrum"): {"fix spectrum all fsi/spectrum 2 f_particle[1]": ""},
    ("tank", "force"): {"compute force water fsi/force split yes": ""},
    ("tank", "probe"): {"compute probe water fsi/probe line 0.05 0 0 0.05 0.2 0 level": ""},
    ("updated", "pair"): {f"pair_style hybrid fsi/fluid sound 10 artificial/visc 0.05 0 {words} "
                          f"fsi/solid artificial/visc 0.1 0 {body}": "" for words, body in [
        ("", ""), ("", "gradient corrected"),
        ("couple full", "gradient plain artificial/stress 0.3"),
        ("shift 0.1", "hourglass 0.3 gradient quadratic"),
        ("density/surface yes", "hourglass 0.1 gradient quadratic")]},
    ("updated", "fsi"): {"fix fsi moves fsi 0.01 wendland 1.5 solid ratio": "",
                         "fix fsi moves fsi 0.01 wendland 1.5 fluid summation solid summation": "",
                         "fix fsi moves fsi 0.01 wendland 1.5 scheme article": "requires "
                         "pair_style fsi/solid gradient plain",
                         "fix fsi moves fsi 0.01 cubic 1.3": OLD_KERNEL},
    ("updated", "stress"): {"fix stress all fsi/stress plastic": ""},
    ("open", "pair"): {f"pair_style fsi/fluid sound 10 background 500 tension yes {words}": ""
                       for words in
                       ("shift 0.2", "laminar/visc", "density/diffusion 0.2 artificial/visc 0.1 0",
                        "shift 0.2 shift/every 2")},
    ("open", "fsi"): {"fix fsi water fsi 0.01 wendland 1.5 mach 0.5": "",
                      "fix fsi water fsi 0.01 quintic 1.0": OLD_KERNEL},
    ("open", "mirror"): {"fix mirror water fsi/wall/mirror ylo 0 yhi 0.1 slip no": ""},
    ("levels", "pair"): {f"pair_style fsi/fluid sound 10 background 500 tension yes {words}": ""
                         for words in
                         ("shift 0.2", "laminar/visc",
                          "density/diffusion 0.2 artificial/visc 0.1 0",
                          "shift 0.2 shift/every 2")},
    ("levels", "fsi"): {"fix fsi water fsi 0.01 wendland 1.5 spacing 2 0.0070711 mach 0.5": ""},
    ("levels", "mirror"): {"fix mirror water fsi/wall/mirror ylo 0 yhi 0.1 slip no": ""},
    ("levels", "refine"): {f"fix refine water fsi/refine {words}": "" for words in
                           ("5 types 1 2 region near settle 0", "10 types 1 2 region near",
                            "5 types 1 2 region near2")},
    ("stream", "pair"): {f"pair_style fsi/fluid sound 10 background 500 tension yes {words}": ""
                         for words in ("shift 0.2", "density/diffusion 0.1 laminar/visc")},
    ("stream", "stream"): {f"fix stream water fsi/stream {words}": "" for words in
                           ("v_u2 NULL NULL region zone rate 20",
                            "0.5 0 NULL region zone2 rate 10 density 20",
                            "v_u 0 NULL region zone2 rate 20 along y")},
}
