"""Presets of pair fsi/fluid, what fix fsi takes where a script says nothing, fsi/run and
fsi/dump."""

import numpy as np
import pytest
from decks import atoms, materials, start
from scenes import lammps, run

WATER, HEAVY = "fluid rho 1000 viscosity 0.5", "fluid rho 1300 viscosity 0.5"
RUBBER = "solid rho 1100 young 1e5 poisson 0.4"
# preset: what it stands for, in the order of a user who types all of it; kernel in 2D and 3D
MEANS = {
    "splash": ("sound 20 artificial/visc 0.02 0 density/diffusion 0.1", "wendland 1.5"),
    "stream": ("sound 20 background 4000 tension yes laminar/visc density/diffusion 0.1 shift 0.25 "
               "shift/every 4", "quintic 1.0"),
    "closed": ("sound 20 tension yes laminar/visc density/diffusion 0.1 shift 0.5", "quintic 1.0"),
    "waves": ("sound 20 laminar/visc/central density/diffusion 0.1", "quintic 1.0"),
}


def water(style, fix, dim=2, end="run 8", before="", named="water", types=1):
    """A periodic box of water in which a jet runs."""
    size = "0 0.1 0 0.1" + " 0 0.1" * (dim == 3)
    return (start(dim=dim, boundary="p p p") + atoms(size, 0.01, dim, types, water="")
            + f"variable v atom sin(20*PI*x)*(1+0.2*sin(20*PI*y))\n{before}"
            + f"pair_style fsi/fluid {style}\npair_coeff * * materials.fsi {named}\n{fix}\n"
            + f"velocity all set NULL v_v NULL\ntimestep 1e-5\nneighbor 0.003 bin\n{end}\n"
            + "write_dump all custom end id x y z vx vy vz modify format float %.17g sort id\n")


def state(folder, text, **files):
    result = run(folder, text,
                 **{"materials_fsi": materials(water=WATER, heavy=HEAVY, rubber=RUBBER), **files})
    return np.loadtxt(folder / "end", skiprows=9), result.output


@pytest.mark.parametrize("dim", (2, 3))
@pytest.mark.parametrize("name", MEANS)
def test_a_preset_is_its_keywords(tmp_path, name, dim):
    """Bit for bit, the kernel that fix fsi takes without a name included."""
    style, kernel = MEANS[name]
    if dim == 3:
        kernel = "wendland 1.5"
    short, said = state(tmp_path / "short", water(f"preset {name} 2", "fix 1 all fsi 0.01", dim))
    full, _ = state(tmp_path / "full", water(style, f"fix 1 all fsi 0.01 {kernel}", dim))
    assert np.array_equal(short, full)
    assert f"preset {name} 2: sound 20 " in said


def test_named_keywords_win(tmp_path):
    short, said = state(tmp_path / "short",
                        water("preset stream 2 shift 0.1 background 100", "fix 1 all fsi 0.01"))
    full, _ = state(tmp_path / "full", water("sound 20 background 100 tension yes laminar/visc "
                                             "density/diffusion 0.1 shift 0.1 shift/every 4",
                                             "fix 1 all fsi 0.01 quintic 1.0"))
    assert np.array_equal(short, full) and "given twice" not in said


def test_background_is_that_of_the_densest_fluid(tmp_path):
    """rho U^2, one pressure for all fluids, or they would be pushed apart."""
    two = "group half id 1:50\nset group half type 2\n"
    short, _ = state(tmp_path / "short", water("sound 20 tension yes background/speed 2",
                                               "fix 1 all fsi 0.01", before=two,
                                               named="water heavy", types=2))
    full, _ = state(tmp_path / "full", water("sound 20 tension yes background 5200",
                                             "fix 1 all fsi 0.01", before=two, named="water heavy",
                                             types=2))
    assert np.array_equal(short, full)


def test_a_kernel_that_is_not_the_presets(tmp_path):
    """Fix fsi before the pair style knows no preset: refused, unless it names the kernel."""
    for kernel, word in (("", "takes the one of preset stream"), (" wendland 1.5", None)):
        text = water("preset stream 2", "", before=f"fix 1 all fsi 0.01{kernel}\n")
        result = lammps(tmp_path, text, materials_fsi=materials(water=WATER))
        assert word in result.output if word else result.status == 0


@pytest.mark.parametrize("style, word", [
    ("preset river 1", "Unknown pair_style fsi/fluid preset name river: expected none, splash, "
     "stream, closed or waves"),
    ("preset stream 1 background 10 background/speed 2", "expected one of them")])
def test_errors(tmp_path, style, word):
    assert word in lammps(tmp_path, water(style, "fix 1 all fsi 0.01"),
                          materials_fsi=materials(water=WATER)).output


def test_skin(tmp_path):
    """0.4 spacings in place of LAMMPS' millimeter; what a script names stays."""
    text = water("preset closed 2", "fix 1 all fsi 0.01").replace("neighbor 0.003 bin\n", "")
    first, said = state(tmp_path / "unset", text)
    assert "neighbor skin 0.004" in said
    named, said = state(tmp_path / "set", text.replace("fix 1", "neighbor 0.002 bin\nfix 1"))
    assert "neighbor skin" not in said
    np.testing.assert_allclose(first[:, 1:7], named[:, 1:7], rtol=0, atol=1e-12)


def test_mass_of_a_body_is_that_of_its_cells(tmp_path):
    """0.012 m^2 of rubber: 13.2 kg/m. By 1/psi it would be 0.5 % less with this kernel."""
    text = (start() + atoms("-0.1 0.3 -0.1 0.3", 0.01, plate="0 0.2 0 0.06")
            + "pair_style fsi/solid/tl\n"
            "pair_coeff * * materials.fsi rubber\nfix 1 all fsi 0.01\nvariable m equal mass(all)\n"
            "run 0\nprint 'MASS ${m}'\n")
    said = run(tmp_path, text, materials_fsi=materials(rubber=RUBBER)).output
    assert float(said.split("MASS ")[-1].split()[0]) == pytest.approx(13.2, rel=1e-12)


def test_run_until(tmp_path):
    """The end of a run is exact, a second one goes on from it, and both are a run of fix fsi/dt."""
    end = "fsi/run 0.001 cfl 1\nprint 'FIRST $(time) $(step)'\nfsi/run 0.0015"
    two, said = state(tmp_path / "two", water("preset closed 2", "fix 1 all fsi 0.01",
                                              end=end + "\nprint 'LAST $(time)'"))
    assert float(said.split("FIRST ")[-1].split()[0]) == pytest.approx(0.001, rel=1e-12)
    assert float(said.split("LAST ")[-1].split()[0]) == pytest.approx(0.0015, rel=1e-12)
    fixed = ("fix dt all fsi/dt 10 cfl 1 stop 0.001\nrun 100000\n"
             "fix dt all fsi/dt 10 cfl 1 stop 0.0015\nrun 100000")
    old, _ = state(tmp_path / "old", water("preset closed 2", "fix 1 all fsi 0.01", end=fixed))
    # the new fix takes another first step
    np.testing.assert_allclose(two[:, 1:7], old[:, 1:7], rtol=0, atol=1e-7)


@pytest.mark.parametrize("line, word", [
    ("fsi/run", "Illegal fsi/run command: missing argument"),
    ("fsi/run 0", "Fsi/run time 0 must be > 0"),
    ("fix dt all fsi/dt 10\nfsi/run 0.1 cfl 1", "expected no keyword, there is fix dt"),
    ("fix dt all fsi/dt 10 check warn\nfsi/run 0.1", "stop"),
    ("fsi/dump all", "Illegal fsi/dump command: missing argument"),
    ("fsi/dump all x", "Fsi/dump time x is not a number"),
    ("fsi/dump all 1 file", "missing argument"),
    ("fsi/dump all 1 depth", "depth")])
def test_bad_lines(tmp_path, line, word):
    result = lammps(tmp_path, water("preset closed 2", "fix 1 all fsi 0.01", end=line),
                    materials_fsi=materials(water=WATER))
    assert result.status != 0 and word in result.output


@pytest.mark.parametrize("dim", (2, 3))
def test_dump_has_columns_of_these_names(tmp_path, dim):
    end = 'fsi/dump all 0.0005 p shear/rate file "some of it.dump"\nfsi/run 0.001'
    state(tmp_path, water("preset closed 2", "fix 1 all fsi 0.01", dim, end=end))
    lines = (tmp_path / "some of it.dump").read_text().splitlines()
    columns = "id type mol x y" + (" z vx vy vz" if dim == 3 else " vx vy") + " p shear/rate"
    assert lines.count(f"ITEM: ATOMS {columns}") == 3    # at 0, 0.0005 and 0.001
    times = [float(after) for line, after in zip(lines, lines[1:]) if line == "ITEM: TIME"]
    # the first step at or after each
    np.testing.assert_allclose(times, [0, 0.0005, 0.001], rtol=0, atol=2e-5)


@pytest.mark.parametrize("words, said",
                         [("preset stream 2 shift 0", False), ("preset closed 2", False),
                          ("sound 20 laminar/visc", True), ("sound 20 shift/every 4", True)])
def test_what_a_preset_sets_may_be_idle(tmp_path, words, said):
    """Only keywords that the user typed are said to have nothing to act on."""
    text = water(words, "fix sph all fsi 0.01" + (" quintic 1.0" if said else ""), named="clear")
    assert ("nothing to act on" in state(
        tmp_path, text, materials_fsi=materials(clear="fluid rho 1000"))[1]) == said
