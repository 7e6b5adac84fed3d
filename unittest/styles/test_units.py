"""The same physics in SI, without dimensions (units lj), and in cgs gives the same numbers once
scaled back."""

import numpy as np
import pytest
from scenes import run

from fsi import dump, log

# dam of water against a plate, with every term that has a dimension: sound, viscosities, gravity,
# elasticity, contact, sub-steps
DECK = """units {units}
dimension 2
boundary f f p
atom_style fsi
newton on
region box block {xlo} {xhi} {xlo} {xhi} {zlo} {zhi}
create_box 2 box
lattice sq {a} origin 0.5 0.5 0
region water block 0 {w} 0 {H} INF INF units box
region plate block {w} {w2} 0 {H} INF INF units box
create_atoms 1 region water
create_atoms 2 region plate
set type 2 mol 1
region held block INF INF {top} INF INF INF units box
group held region held
group plate type 2
group held intersect held plate
group mobile subtract all held
pair_style hybrid fsi/fluid sound {c} artificial/visc 0.05 0.1 laminar/visc density/diffusion 0.1 fsi/solid/tl artificial/visc 0.1 0
pair_coeff * * fsi/fluid mine.fsi water plate
pair_coeff * * fsi/solid/tl mine.fsi NULL plate
fix 1 mobile fsi {dx} wendland 1.5 substeps 4
fix 2 all gravity {g} vector 0 -1 0
fix 3 all fsi/wall/mirror xlo 0 ylo 0
compute energy all fsi/energy
compute s all fsi/atom p vonmises
thermo_style custom step ke c_energy f_3[2][2]
thermo_modify norm no
thermo 200
timestep {dt}
neighbor {skin} bin
dump 1 all custom 200 out.dump id type x y vx vy c_s[1] c_s[2]
dump_modify 1 sort id time yes colname c_s[1] p colname c_s[2] vonmises format float %.17g
run 200
"""
MATERIALS = ("# UNITS: {units}\nwater fluid rho {rho} viscosity {mu}\n"
             "plate solid rho {rho} young {E} poisson 0.4\n")
SI = {"lengths": {"xlo": -0.05, "xhi": 0.25, "zlo": -0.005, "zhi": 0.005, "w": 0.1, "w2": 0.14,
                  "H": 0.12, "top": 0.1, "dx": 0.01,
                  "skin": 0.003}, "c": 15.0, "g": 9.81, "dt": 2.0e-4, "rho": 1000.0, "mu": 5.0,
      "E": 2.0e6}


def measured(folder, units, length=1.0, time=1.0, mass=1.0):
    """Runs the scene in units of so many metres, seconds and kilograms; last frame and thermo row,
    in SI again."""
    values = {k: v / length for k, v in SI["lengths"].items()}
    pressure = mass / length / time**2
    # in units lj the scale of a lattice is a reduced density, its number per area
    values["a"] = values["dx"] if units != "lj" else values["dx"]**-2
    values |= {"c": SI["c"] / length * time, "g": SI["g"] / length * time**2, "dt": SI["dt"] / time,
               "units": units}
    material = {"units": units, "rho": SI["rho"] / mass * length**3, "mu": SI["mu"] / pressure
                / time, "E": SI["E"] / pressure}
    exact = {k: repr(v) if isinstance(v, float) else v for k, v in values.items()}
    run(folder, DECK.format(**exact), mine_fsi=MATERIALS.format(
        **{k: repr(v) if isinstance(v, float) else v for k, v in material.items()}))
    frame = dump.read(folder / "out.dump")[-1]
    thermo = log.read(folder / "log.lammps").finished[-1].thermo
    # masses are per length of the third axis, which is a unit of length
    energy, force = mass * length / time**2, mass / time**2
    found = {"x": frame.vector("xy") * length, "v": frame.vector(("vx", "vy")) * length / time,
             "p": frame["p"] * pressure,
             "vonmises": frame["vonmises"] * pressure}
    return found, np.array([thermo["KinEng"][-1] * energy, thermo["c_energy"][-1] * energy,
                            thermo["f_3[2][2]"][-1] * force])


@pytest.fixture(scope="module")
def si(tmp_path_factory):
    return measured(tmp_path_factory.mktemp("si"), "si")


@pytest.mark.parametrize("units, scale", [("lj", {"length": 0.14, "time": 0.12, "mass": 2.0}),
                                          ("cgs", {"length": 0.01, "time": 1.0, "mass": 1.0e-3})])
def test_same_physics(tmp_path, si, units, scale):
    # Round-off grows over 200 steps, 4 sub-steps each, of a flow that has not broken up yet: 1e-16
    # to 1e-11 at most. One factor missing anywhere would be of order 1. Thermo output has 8 digits.
    found, thermo = measured(tmp_path, units, **scale)
    assert np.abs(si[0]["v"]).max() > 0.03 and si[0]["vonmises"].max() > 1e3  # something happens
    for name, values in found.items():
        assert np.abs(values - si[0][name]).max() < 1e-9 * np.abs(si[0][name]).max(), name
    np.testing.assert_allclose(thermo, si[1], rtol=1e-7)


def test_material_file_of_other_units_is_refused(tmp_path):
    with pytest.raises(AssertionError, match="(?i)units"):
        run(tmp_path, "units lj\natom_style fsi\nregion b block 0 1 0 1 0 1\ncreate_box 1 b\n"
            "pair_style fsi/fluid sound 10\n"
                      "pair_coeff * * materials.fsi water\n")


@pytest.mark.parametrize("units", ("real", "metal", "electron"))
def test_units_of_molecules_are_refused(tmp_path, units):
    with pytest.raises(AssertionError, match=f"does not support units {units}, .*expected lj, si, "
                       "cgs, micro or nano"):
        measured(tmp_path, units)
