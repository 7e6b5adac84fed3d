"""Particles of atom_style fsi that LAMMPS' own commands make: molecules, deposits; and what only
some scenes need."""

import pytest
from scenes import Scene, lattice

DX = 0.1
RUBBER = "solid rho 1000 young 1e5 poisson 0.3"
DROP = "# drop\n\n3 atoms\n\nCoords\n\n1 0 0 0\n2 0.1 0 0\n3 0 0.1 0\n\nTypes\n\n1 1\n2 1\n3 1\n"


def scene(**more):
    return Scene(lattice([4, 4], DX), dx=DX, box=((-1, -1, 0), (3, 3, 0)), dt=1e-3, **more)


@pytest.mark.parametrize("masses, expected",
                         [("", None), ("\nMasses\n\n1 7.0\n2 8.0\n3 9.0\n", [7.0, 8.0, 9.0])])
@pytest.mark.parametrize("how", ["create_atoms", "deposit"])
def test_molecules_with_and_without_masses(tmp_path, how, masses, expected):
    """Without, a particle has the lattice's mass and its material's density, as any that
    create_atoms makes."""
    (tmp_path / "drop.mol").write_text(DROP + masses)
    with scene() as s:
        s.run_lines(f"molecule drop {tmp_path / 'drop.mol'}")
        if how == "create_atoms":
            s.run_lines("lattice none 1.0", "create_atoms 0 single 2 2 0 mol drop 4711")
        else:
            s.run_lines(f"region r block 1.5 2.5 1.5 2.5 {-DX / 2} {DX / 2}",
                        "fix d all deposit 1 0 1 4711 region r mol drop")
        s.n += 3
        s.run(1)
        mass = s.get("rmass")
        assert mass[-3:].tolist() == (expected or [mass[0]] * 3) and mass[0] == pytest.approx(
            1000 * DX**2, rel=0.02)
        assert s.get("rho")[-3:] == pytest.approx(1000.0, rel=1e-3)


@pytest.mark.parametrize("group, moved", [("moving", True), ("all", False), ("inlet", False)])
def test_fluid_made_outside_the_group_is_refused(group, moved):
    """Nothing would integrate it; fix deposit gives its particles its own group and all. Here the
    first particle is held."""
    region = f"region r block 1.5 2.5 1.5 2.5 {-DX / 2} {DX / 2}"
    with scene(held=[True] + [False] * 15, commands=[
        "group inlet empty", region, f"fix d {group} deposit 1 1 2 4711 region r"]) as s:
        if moved:
            s.n += 1
            s.run(5)
            assert s.get("x").shape == (17, 3)
        else:
            with pytest.raises(Exception, match="Atom 17 was made during a run and is not in group "
                               "moving of fix sph"):
                s.run(5)


@pytest.mark.parametrize("style, mapped",
                         [("", False), ("fsi/solid", False), ("fsi/solid/tl", True)])
def test_map_of_ids_is_made_for_bonds_only(style, mapped):
    more = {"materials": (RUBBER,), "solid_style": style} if style else {}
    with scene(id_map=False, **more) as s:
        assert (s.run(2).lmp.extract_global("map_style") > 0) == mapped


def test_map_must_come_before_fix_balance():
    with pytest.raises(Exception, match="fsi/solid/tl requires a place before fix balance"):
        with scene(id_map=False) as s:
            s.run_lines("fix b all balance 10 1.1 shift xy 5 1.1", "pair_style fsi/solid/tl")
