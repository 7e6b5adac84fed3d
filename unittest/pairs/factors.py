"""What may meet in a scene: factors and their levels, pairs that are not drawn or are refused, and
rows in which every allowed pair of levels is.

To add a feature, add one line to FACTORS. A level is a dict of what it puts into the deck of
scene.py (see SLOTS there): text for the commands that are always there, lines of its own, or
settings of the scene. The first level of a factor is that of scenes that do without. Numbers along
x stand in marks, by which a deck is mirrored: <v> a coordinate or velocity, [a b] an extent, <xlo>
a face. The spacing is 0.01 m.
"""

import collections
import itertools
import random

from allpairspy import AllPairs

FACTORS = {
    "dimension": {"2D": {"dim": 2}, "3D": {"dim": 3}},
    "kernel": {"wendland": {"kernel": "wendland 1.5"}, "quintic": {"kernel": "quintic 1.0"},
               "cubic": {"kernel": "cubic 1.3"}},
    "state": {"linear": {}, "tait": {"fluid": "eos tait"},
              "tension": {"fluid": "tension yes", "full": True},
              "background": {"fluid": "background 500 tension yes", "full": True}},
    "viscosity": {"inviscid": {}, "artificial": {"fluid": "artificial/visc 0.1 0.1"},
                  "laminar": {"fluid": "laminar/visc"},
                  "central": {"fluid": "laminar/visc/central"},
                  "solid slip": {"fluid": "laminar/visc solid/slip yes"},
                  "shear thinning": {"fluid": "laminar/visc",
                                     "water": "power 0.5 0.6 viscosity/limits 0.05 20"},
                  "eddies": {"fluid": "laminar/visc smagorinsky 0.15"},
                  "yield stress": {"fluid": "laminar/visc laminar/implicit yes",
                                   "water": "herschel/bulkley 1 0.5 1 20"}},
    "diffusion": {"undiffused": {}, "diffused": {"fluid": "density/diffusion 0.1"}},
    "shifting": {"unshifted": {}, "shift": {"fluid": "shift 0.2"},
                 "shift every 3": {"fluid": "shift 0.2 shift/every 3"}},
    "surface": {"no surface rule": {}, "surface rule": {"fluid": "density/surface yes"}},
    "pressure on solids": {"as the fluid's": {}, "extrapolated": {"fluid": "extrapolate yes"},
                           "no guard": {"fluid": "solid/guard 0"}},
    "walls": {
        "no walls": {},
        "mirrors": {"ground": "", "sides": ""},
        "no-slip mirrors": {"ground": "slip no", "sides": "slip no"},
        "moving mirror": {"ground": "slip no velocity <0.3> 0.05 0", "sides": ""},
        "segment": {"ground": "", "sides": "",
                    "mirror": "<xhi> <-0.01> range y 0.04 INF <xlo> <-0.01> range y 0.04 INF",
                    "settings": {"thick": 0}},
        "still particles": {"floor": "slip no"},
        "moving particles": {"floor": "", "lines":
                                 "fix move floor fsi/move wiggle <0.002> 0.001 0 0.05 units box"},
        "driven particles": {"floor": "slip no", "regions": "variable s equal 0.001*sin(100*time)\n"
                             "variable u equal 0.1*cos(100*time)\nvariable zero equal 0",
                             "lines": "fix move floor fsi/move variable v_zero v_s {still} v_zero "
                             "v_u {still}"},
        "linear particles": {"floor": "slip no pressure linear guard 0.5"},
        "thin particles": {"floor": "slip no", "fsi": "thin 3", "settings": {"thick": 1}},
    },
    "solid": {
        "no solid": {},
        "svk": {"body": "fsi/solid/tl", "solid": "artificial/visc 0.1 0"},
        "neo-hookean": {"body": "fsi/solid/tl", "solid": "law neohookean hourglass 0.1"},
        "viscoelastic": {"body": "fsi/solid/tl", "solid": "law viscoelastic",
                         "material": "prony 0.3 0.002 0.2 0.01"},
        "plastic": {"body": "fsi/solid/tl", "solid": "law hypo artificial/visc 0.1 0",
                    "stress": "plastic", "material": "yield 200 hardening 1e4"},
        "damage": {"body": "fsi/solid/tl",
                   "solid": "gradient linear damage 0.01 artificial/visc 0.1 0"},
        "hypo updated": {"body": "fsi/solid", "solid": "gradient corrected artificial/visc 0.1 0 "
                         "artificial/stress 0.3 hourglass 0.1", "stress": " "},
        "paper": {"body": "fsi/solid", "solid": "artificial/visc 1 0 artificial/stress 0.3",
                  "stress": " "},
        "quadratic updated": {"body": "fsi/solid",
                              "solid": "gradient quadratic artificial/visc 0.1 0", "stress": " "},
        "plane stress": {"body": "fsi/solid/tl",
                         "solid": "plane stress volumes plain volumetric local gradient linear"},
        "hypo total": {"body": "fsi/solid/tl", "solid": "law hypo artificial/visc 0.1 0",
                       "stress": " "},
        "volumetric": {"body": "fsi/solid/tl", "solid": "volumetric smoothed artificial/visc 0.1 0",
                       "material": "poisson 0.45"},
        "thin": {"body": "fsi/solid/tl", "solid": "artificial/visc 0.1 0", "fsi": "thin 2 thin 8",
                 "settings": {"wide": 2}},
        "own spacing": {"body": "fsi/solid/tl", "solid": "artificial/visc 0.1 0",
                        "fsi": "spacing 2 0.008 spacing 8 0.008", "settings": {"own": 0.8}},
    },
    "contact": {"one body": {}, "contact": {"solid": "contact 1.5", "settings": {"bodies": 2}},
                "self": {"solid": "contact 1.5 self yes", "settings": {"hairpin": True}}},
    "body": {
        "free": {},
        "clamped": {"settings": {"held": True}},
        "clamp on a float": {"settings": {"held": True},
                             "lines": "fix root root rigid single{flat}"},
        "rigid": {"settings": {"held": True, "all held": True},
                  "lines": "fix root root rigid single{flat}"},
    },
    "sub-steps": {"no sub-steps": {}, "sub-steps": {"fsi": "substeps 3"}},
    "levels": {
        "one level": {},
        "region": {"refine": "region near",
                   "regions": "region near block [-0.045 0.085] INF INF INF INF units box"},
        "moving region": {"refine": "region near",
                          "regions": "variable place equal <1.0>*time\nregion near block [-0.045 "
                          "0.085] INF INF INF INF move v_place NULL NULL units box"},
        "unsettled": {"refine": "region near settle 0",
                      "regions": "region near block [-0.045 0.085] INF INF INF INF units box"},
        "distance": {"refine": "distance body 0.018"},
    },
    "ends": {
        "no ends": {},
        "inlet and outlet": {"ends": "fix in fluid fsi/inlet <xlo> <-0.12> velocity <0.4> 0 0 "
                             "buffer 0.06\nfix out fluid fsi/outlet <xhi> <0.12> buffer 0.06"},
        "two pressures": {"ends": "fix in fluid fsi/inlet <xlo> <-0.12> pressure {p1} buffer 0.06\n"
                          "fix out fluid fsi/outlet <xhi> <0.12> pressure {p0} buffer 0.06"},
        "absorbing ends": {"ends": "fix in fluid fsi/inlet <xlo> <-0.12> velocity <0.4> 0 0 absorb "
                           "auto buffer 0.06\nfix out fluid fsi/outlet <xhi> <0.12> pressure free "
                           "buffer 0.06"},
        "stream": {"regions": "region zone block [-0.11 -0.02] INF INF INF INF units box",
                   "lines": "fix stream fluid fsi/stream <0.4> 0 NULL region zone rate 50 density "
                   "20 along x", "settings": {"stream": True}},
    },
    "float": {"no float": {},
              "floating": {"settings": {"buoy": True}, "lines": "fix buoy buoy rigid single{flat}"},
              "two floats": {"settings": {"buoy": True, "floats": 2},
                             "before": "atom_modify map yes",
                             "lines": "fix buoy buoy rigid/small molecule"}},
    "grains": {"no grains": {}, "grains": {"settings": {"grains": 6}}},
    "gravity": {"no gravity": {}, "gravity": {"gravity": True},
                "gravity of water": {"gravity": "water"}},
    "step": {"fixed step": {}, "adaptive step": {"lines": "fix dt all fsi/dt 4 cfl 0.3"},
             "checked step": {"lines": "fix dt all fsi/dt 4 check warn"},
             "adaptive sub-steps": {"lines": "fix dt all fsi/dt 4 cfl/fluid 0.3 substeps auto"}},
    "between runs": {
        "nothing": {},
        "reset_atoms": {"between": "reset_atoms id sort yes"},
        "delete_atoms": {"between": "delete_atoms group spot", "settings": {"spot": True}},
        "delete, no compress": {"between": "delete_atoms group spot compress no",
                                "settings": {"spot": True}},
        "fsi/set": {"between": "fsi/set water density 1000.5"},
        "redefined": {"between": "{again}"},
        "timestep": {"stays": "timestep 1.3e-4"},
        "write_restart": {"between": "write_restart between.restart"},
    },
    "command": {
        "no command": {},
        "velocity": {"between": "velocity moves set <0.05> 0.02 NULL sum yes units box"},
        "displace_atoms": {"between": "displace_atoms moves move <0.0006> 0 0 units box"},
        "create_atoms": {"settings": {"spot": True}, "between": "delete_atoms group spot compress "
                         "no\ngroup old union all\nlattice {lattice} 0.01 origin 0.5 0.5 {z}\n"
                         "create_atoms 1 region refill\ngroup spot subtract all old\ngroup fluid "
                         "type 1 5 7\ngroup water type 1 5\ngroup moves union moves spot\n"
                         "velocity spot set <0.3> 0.05 0 units box\nrun 0"},
        "reset_timestep": {"between": "reset_timestep 5 time $(time:%.17g)"},
        "change_box": {"between": "{wider}"},
        "given again": {"between": "{all again}"},
        "neighbor": {"stays": "neighbor 0.006 bin\nneigh_modify delay 0 every 1 page 200000 one "
                     "4000"},
    },
    "density": {"continuity": {}, "article": {"fsi": "scheme article"},
                "summation": {"fsi": "fluid summation"}, "ratio": {"fsi": "solid ratio"}},
    "symmetry": {"no plane": {}, "symmetry plane": {"settings": {"plane": True}}},
    "fluids": {"one fluid": {}, "oil beside": {"settings": {"oil": "beside"}},
               "oil above": {"settings": {"oil": "above"}}, "drop": {"settings": {"oil": "drop"}}},
    "lattice": {"even": {}, "unequal masses": {"settings": {"uneven": 0.1}},
                "turned body": {"settings": {"turn": 0.3}},
                "two materials": {"settings": {"soft": True}}},
    "packing": {"as cut": {}, "packed": {"settings": {"packed": True}}},
    "setup": {"usual setup": {}, "boundary m": {"settings": {"edge": "m"}},
              "far ghosts": {"regions": "comm_modify cutoff 0.065"},
              "slabs": {"before": "atom_modify map hash sort 0 0.0\nprocessors 1 * *"}},
    "other fix": {
        "no other fix": {},
        "addforce": {"lines": "fix push fluid addforce <0.005> 0.001 0"},
        "setforce": {"lines": "fix guide body setforce NULL 0 NULL"},
        "spring": {"lines": "fix tie body spring tether 5 <0.03> 0.07 NULL 0.01"},
        "viscous": {"lines": "fix damp fluid viscous 0.05"},
        "momentum": {"lines": "fix rest water momentum 5 linear 1 1 0"},
    },
}
FACTOR_OF = {level: factor for factor, levels in FACTORS.items() for level in levels}
FIRST = {factor: next(iter(levels)) for factor, levels in FACTORS.items()}


def all_of(factor, *but):
    return [level for level in FACTORS[factor] if level not in (FIRST[factor], *but)]


UPDATED = ("hypo updated", "quadratic updated", "paper")
TOTAL = all_of("solid", *UPDATED)

# {reason: pairs of levels, each a level or several}: what makes no sense, or is not what the level
# is for
NOT_DRAWN = {
    "there is nothing to touch, hold, or take sub-steps": [("no solid", all_of("contact") + all_of(
        "body") + ["sub-steps", "adaptive sub-steps", "distance", "extrapolated", "no guard",
                   "solid slip", "turned body", "two materials", "packed", "setforce", "spring"])],
    "sub-steps are those of fix fsi or those of fix fsi/dt": [("sub-steps", "adaptive sub-steps")],
    "what is bonded to its image ends at the plane, along it": [("symmetry plane", "turned body")],
    "a group has one hole": [("create_atoms", ("delete_atoms", "delete, no compress"))],
    "LAMMPS' fix momentum takes the mass of a run's start": [
        ("momentum", all_of("ends", "stream"))],
    "self-contact is of one body, of which one end is held": [
        ("self", ("rigid", "thin", "own spacing"))],
}

# {(level, level): (message, further levels)}: what the code refuses, and in which words
REFUSED = {
    ("surface rule", "tension"): (r"density/surface does not go with tension yes or background",
                                  {}),
    ("surface rule", "background"): (r"density/surface does not go with tension yes or background",
                                     {}),
    **{("surface rule", levels): (r"requires pair_style fsi/fluid (without )?density/surface", {})
       for levels in all_of("levels")},
    **{("grains", law): (r"requires fluids of constant viscosity", {})
       for law in ("shear thinning", "yield stress")},
    ("self", "symmetry plane"): (r"self yes does not go with symmetry yes", {}),
    **{(solid, "sub-steps"): (r"substeps requires pair_style fsi/solid/tl", {})
       for solid in UPDATED},
    **{(mode, level): (r"requires density by continuity", {}) for mode in ("article", "summation")
       for level in ("diffused", "shift", "shift every 3", "surface rule", "thin particles",
                     *all_of("levels"), *all_of("ends"))},
    ("summation", "thin"): (r"requires density by continuity", {}),
    **{("ratio", level): (r"requires density by continuity", {"solid": "paper"})
       for level in ("shift", "shift every 3")},
    ("ratio", "thin particles"): (r"requires density by continuity", {"solid": "paper"}),
    **{(mode, solid): (r"does not go with pair_style fsi/solid/tl", {})
       for mode in ("article", "ratio") for solid in TOTAL},
    **{("article", solid): (r"requires pair_style fsi/solid gradient plain", {})
       for solid in UPDATED if solid != "paper"},
    **{(mode, "sub-steps"): (r"substeps requires pair_style fsi/solid/tl", {"solid": "paper"})
       for mode in ("article", "ratio")},
    ("plane stress", "3D"): (r"plane stress requires dimension 2", {}),
    **{("reset_atoms", solid): (r"reset_atoms id", {}) for solid in TOTAL},
    **{("setforce", level): (r"does not go with fix guide", {"solid": "svk"})
       for level in ("sub-steps", "adaptive sub-steps")},
    **{("reset_timestep", level): (r"[Cc]annot reset timestep", {}) for level in (
        "moving particles", "driven particles", "adaptive step", "adaptive sub-steps")},
    ("reset_atoms", "two floats"): (r"reset_atoms id", {}),
    ("delete_atoms", "two floats"): (r"style rigid/small\) knows a body by the ID", {}),
    ("reset_atoms", "sub-steps"): (r"reset_atoms id", {"solid": "svk"}),
}


def _pairs():
    found = set(map(frozenset, REFUSED))
    listed = lambda a: [a] if isinstance(a, str) else a    # noqa: E731
    for pairs in NOT_DRAWN.values():
        for a, b in pairs:
            found |= {frozenset(p) for p in itertools.product(listed(a), listed(b))}
    unknown = {level for pair in found for level in pair} - set(FACTOR_OF)
    assert not unknown, f"levels that are in no factor: {unknown}"
    return found


EXCLUDED = _pairs()


def allowed(levels, but=()):
    """Is no pair of these excluded, but those?"""
    return all(pair in but or pair not in EXCLUDED
               for pair in map(frozenset, itertools.combinations(levels, 2)))


def complete(some, rng, but=(), wanted=()):
    """A row with these levels, the others drawn, those that meet pairs still wanted first; None if
    there is none."""
    chosen = {FACTOR_OF[level]: level for level in some}
    rest = [factor for factor in FACTORS if factor not in chosen]
    if not allowed(chosen.values(), but):
        return None
    rng.shuffle(rest)

    def good(factor):
        return [level for level in FACTORS[factor]
                if all(frozenset((level, other)) not in EXCLUDED for other in chosen.values())]

    def fill(rest):
        if not rest:
            return True
        # the one with the fewest left, the first of these
        factor = min(rest, key=lambda f: len(good(f)))
        choice = good(factor)
        rng.shuffle(choice)
        choice.sort(key=lambda level: -sum(frozenset((level, other)) in wanted
                                           for other in chosen.values()))
        for level in choice:
            chosen[factor] = level
            if fill([f for f in rest if f != factor]):
                return True
            del chosen[factor]
        return False

    return [chosen[factor] for factor in FACTORS] if fill(rest) else None


def pairs_of(row):
    return set(map(frozenset, itertools.combinations(row, 2)))


def all_pairs():
    """{pair: is it allowed} of levels of two factors"""
    return {frozenset(p): frozenset(p) not in EXCLUDED
            for f, g in itertools.combinations(FACTORS, 2)
            for p in itertools.product(FACTORS[f], FACTORS[g])}


def balance(found):
    """Where no pair is lost by it, a level makes room for the one of its factor that has come
    least; "no" of it may come twice as often."""
    often = {level: 2 if FIRST[factor] == level and factor != "dimension" else 1
             for level, factor in FACTOR_OF.items()}
    count = collections.Counter(pair for row in found for pair in pairs_of(row))
    used = collections.Counter(level for row in found for level in row)
    for k, factor in enumerate(FACTORS):
        for row in found:
            mine = [frozenset((row[k], other)) for j, other in enumerate(row) if j != k]
            if any(count[pair] == 1 for pair in mine):
                continue
            others = row[:k] + row[k + 1:]
            level = min((level for level in FACTORS[factor] if allowed([level, *others])),
                        key=lambda level: used[level] / often[level])
            if (used[level] + 1) / often[level] < used[row[k]] / often[row[k]]:
                count.subtract(mine)
                used.subtract([row[k]])
                row[k] = level
                count.update(frozenset((level, other)) for other in others)
                used[level] += 1


def rows(seed=0, without=()):
    """Rows of levels, one of each factor: every allowed pair is in one of them. Without: not these
    levels, and only as far as the drawing goes."""
    rng = random.Random(seed)
    values = [[level for level in (rng.sample(list(levels), len(levels)) if seed else levels)
               if level not in without] for levels in FACTORS.values()]
    found = [list(row) for row in AllPairs(values, filter_func=allowed)]
    if without:
        return found
    wanted = {pair for pair, good in all_pairs().items()
              if good} - set().union(*map(pairs_of, found))
    for pair in sorted(wanted, key=sorted):    # what the drawing could not complete
        if pair in wanted:
            row = complete(sorted(pair), rng, wanted=wanted)
            assert row, f"no row has {sorted(pair)}: say why in NOT_DRAWN"
            found.append(row)
            wanted -= pairs_of(row)
    balance(found)
    return found


def simple(levels):
    """The row of these and the first levels of other factors"""
    chosen = {FACTOR_OF[level]: level for level in levels}
    return [chosen.get(factor, FIRST[factor]) for factor in FACTORS]


def refused_rows():
    """[(pair, message, row)] with that one pair that is refused"""
    found = []
    for k, (pair, (message, more)) in enumerate(REFUSED.items()):
        needs = [*pair, *more.values()]
        row = simple(needs) if allowed(simple(needs), pairs_of(needs)) else complete(
            needs, random.Random(k), pairs_of(needs))
        assert row, f"no row has {pair} and no other pair that is not allowed"
        found.append((pair, message, row))
    return found

# {page of doc/src: {file of unittest/styles: words}}: styles and words of their Syntax that are no
# level, and where they are tested
ELSEWHERE = {
    "compute_fsi_force": {"test_force": "fsi/force split yes no"},
    "compute_fsi_probe": {"test_probe": "fsi/probe point patch line level wet extrapolate fill p "
                          "rho vx vy vz ux uy uz yes no"},
    "compute_fsi_surface_atom": {"test_surface": "fsi/surface/atom divergence number/density"},
    "fix_fsi": {"test_density": "continuity", "test_parallel": "mach off",
                "test_bad_input": "standard"},
    "fix_fsi_dt": {"test_dt": "cfl/solid min max growth keep stop no error"},
    "fix_fsi_inlet": {"test_inlet": "region ylo yhi zlo zhi"},
    "fix_fsi_move": {"test_move": "linear rotate transrot lattice"},
    "fix_fsi_refine": {"test_refine": "finest"},
    "fix_fsi_report": {"test_report": "fsi/report file all"},
    "fix_fsi_spectrum": {"test_spectrum": "fsi/spectrum every window none hann hann2 detrend mean "
                         "linear peaks file"},
    "fix_fsi_stream": {"test_stream": "y z"},
    "fix_fsi_stress": {"test_solid": "plane strain"},
    "fix_fsi_wall_mirror": {"test_walls": "guard hydrostatic zlo", "test_inlet": "zhi"},
    "fix_fsi_wall_particle": {"test_wall_particles": "yes mean tension closed",
                              "test_fuzz": "auto"},
    "fix_fsi_watch": {"test_watch": "fsi/watch action density distance energy lost off stop warn"},
    "fsi_displace": {"test_displace": "fsi/displace all"},
    "fsi_clamp": {"test_clamp_command": "fsi/clamp"},
    "fsi_dump": {"test_presets": "fsi/dump file"},
    "fsi_run": {"test_presets": "fsi/run"},
    "fsi_pack": {"test_packing": "stl outline"},
    "fsi_set": {"test_density": "pressure hydrostatic volume"},
    "pair_fsi_fluid": {"test_density": "couple full surface", "test_refine": "levels",
                       "test_shift": "no",
                       "test_presets": "preset none splash stream closed waves background/speed"},
    "pair_fsi_solid": {"test_solid": "plain no"},
    "pair_fsi_solid_tl": {"test_solid_tl": "svk strain quadratic corrected auto no"},
}
