"""fix fsi/report: what it adds up is what happened, by sums of this file's own; and it changes
nothing."""

import re

import numpy as np
import pytest

from decks import go_on, open_box, output_of, total_lagrangian
from redefined import MATERIALS, deck
from scenes import DX, dam_gate, differing, fluid_box, run, watch

from fsi import log

PARTS = ("density", "stress", "force_of_fluid", "force_of_solids", "walls", "communication",
         "neighbor_lists", "output",
         "rest")
AXES = "xyz"


def gate(substeps=3, held=True):
    """The gate in total-Lagrangian form; the upper half of its plate is held."""
    scene = dam_gate(2, sph=f"substeps {substeps}")
    text = total_lagrangian(scene.text()).replace(f"timestep {scene.dt!r}",
                                                  f"timestep {substeps * scene.dt!r}")
    if held:
        text = text.replace("fix sph all", "group plate type 2\n"
                            "region up block INF INF 0.07 INF INF INF\ngroup up region up\n"
                            "group clamp intersect plate up\nvelocity clamp set 0 0 0\n"
                            "group mobile subtract all clamp\nfix sph mobile")
    return scene, text


def reports(result):
    """The reports in a run's log, one per run."""
    return [r.report for r in log.read(result.folder / "log.lammps").runs]


def vector(report, name):
    return np.array([report[f"momentum_{name}_{a}"] for a in AXES])


def momentum(frame, moving=slice(None)):
    return (frame["mass"][:, None] * frame.vector(("vx", "vy", "vz")))[moving].sum(0)


# ---- form ----------------------------------------------------------------------------------------

def test_one_report_per_run_and_the_log_stays_readable(tmp_path):
    scene, text = gate()
    plain = run(tmp_path / "plain", text + "run 100\nrun 50\n", scene_data=scene.data())
    text += "compute e all fsi/energy\nfix report all fsi/report\n"
    done = run(tmp_path / "log", text + "run 100\nrun 50\n", scene_data=scene.data())
    first, second = reports(done)
    # the table; the lines in the log only
    assert done.output.count("\nFSI report: ") == 2 and "FSI report first_step" not in done.output
    assert (first["first_step"], first["last_step"]) == (0, 100) and (
        second["first_step"], second["last_step"]) == (100, 150)
    assert first["particles"] == len(scene.x) and first["lost"] == 0 and first["ranks"] == 1
    assert first["time"] == pytest.approx(100 * 3 * scene.dt, rel=1e-9)
    assert set(first) == set(second)
    a, b = (log.read(r.folder / "log.lammps").runs for r in (plain, done))
    # tables between the thermo output and the loop time disturb neither
    for one, other in zip(a, b):
        assert list(one.thermo) == list(other.thermo) and len(one.thermo["Step"]) == len(
            other.thermo["Step"])
        assert other.steps == one.steps and other.loop_seconds > 0


def test_file(tmp_path):
    scene, text = gate()
    more = "fix report all fsi/report file report.txt\nrun 30\nrun 20 pre no\nrun 0\n"
    done = run(tmp_path, text + more, scene_data=scene.data())
    found = log.reports(tmp_path / "report.txt")
    assert [r["last_step"] for r in found] == [30, 50]  # run 0 does nothing that could be reported
    assert not any(reports(done)) and "ledger is off" in done.output
    assert [r["first_step"] for r in found] == [0, 30] and set(found[0]) == set(found[1])
    assert found[1]["momentum_rest_relative"] < 1e-12 and not any(name.startswith("energy")
                                                                  for name in found[0])


def test_a_report_that_is_gone(tmp_path):
    """unfix: nobody may write into it any more."""
    scene, text = gate()
    done = run(tmp_path, text + "fix report all fsi/report\ncompute s all fsi/surface/atom\n"
               "compute n all reduce sum c_s\nthermo_style custom "
               "step c_n\nrun 5\nunfix report\nrun 5\n", 2, scene_data=scene.data())
    assert done.output.count("FSI report:") == 1


# ---- price ---------------------------------------------------------------------------------------

@pytest.mark.parametrize("ranks", (1, 2))
def test_parts_are_the_whole(tmp_path, ranks):
    scene = fluid_box(2)
    done = run(tmp_path, scene.text() + "fix report all fsi/report\nrun 60\n", ranks,
               scene_data=scene.data())
    report, found = reports(done)[0], log.read(tmp_path / "log.lammps").runs[0]
    seconds = {p: report[f"seconds_{p}"] for p in PARTS}
    # printed with 10 digits here, with 6 and 5 by LAMMPS
    assert sum(seconds.values()) == pytest.approx(report["loop_seconds"], rel=1e-8)
    assert sum(report[f"share_{p}"] for p in PARTS) == pytest.approx(1.0, rel=1e-8)
    assert report["loop_seconds"] == pytest.approx(found.loop_seconds, rel=1e-5)
    assert all(s >= 0.0 for s in seconds.values()) and all(report[f"seconds_max_{p}"] >= s
                                                           * (1 - 1e-9) for p, s in seconds.items())
    assert seconds["stress"] == seconds["force_of_solids"] == 0.0
    for p in ("density", "force_of_fluid", "walls", "neighbor_lists"):
        assert seconds[p] > 0.0, p
    lammps = {name: float(value)
              for name, value in re.findall(r"^(\w+) +\| \S+ +\| (\S+) +\|", done.output, re.M)}
    assert seconds["neighbor_lists"] == pytest.approx(lammps["Neigh"], rel=1e-4)
    assert seconds["output"] == pytest.approx(lammps["Output"], rel=1e-4)
    # what is timed inside a part of LAMMPS is no more than that part
    assert seconds["force_of_fluid"] <= lammps["Pair"] * (1 + 1e-4)
    assert lammps["Comm"] * (1 - 1e-4) <= seconds["communication"] and (
        ranks > 1 or seconds["communication"] <= lammps["Comm"] * (1 + 1e-4))
    assert seconds["density"] + seconds["walls"] <= lammps["Modify"] * (1 + 1e-4)


def test_nothing_is_measured_with_the_timer_off(tmp_path):
    scene = fluid_box(2)
    report = reports(run(tmp_path, scene.text() + "timer off\nfix report all fsi/report\nrun 20\n",
                         scene_data=scene.data()))
    assert (report[0]["seconds_neighbor_lists"] == 0.0 < report[0]["seconds_density"]
            < report[0]["loop_seconds"])


def hints(done):
    """What the report says to change first: [(part, share in per cent, text)]."""
    table = re.search(r"^  what to change first\n((?:    .*\n)+)", done.output, re.M)[1]
    return [(m[1], float(m[2]), m[3])
            for m in re.finditer(r"^    (\S.*?) +([\d.]+)%   (.*)$", table, re.M)]


# per cent
USUAL = {"communication": 25.0, "neighbor lists": 20.0, "output": 10.0, "force of solids": 40.0,
         "density": 30.0, "force of fluid": 30.0}


@pytest.mark.parametrize("case, named", [("calm", ()), ("output", ("output",)),
                                         ("lists", ("neighbor lists",)), ("skin", ()),
                                         ("alone", ("waiting",))])
def test_what_to_change_is_what_took_the_time(tmp_path, case, named):
    """Each part above its usual share, with the share of the table, the dearest first: for what
    takes nearly all the time, and nothing else."""
    scene = fluid_box(2)
    more = {"calm": "", "output": "thermo 1\n"
            + "".join(f"dump {k} all custom 1 d{k} id x y z vx vy vz fx fy fz\n" for k in range(6)),
            # bins so small that lists take three quarters of the time on an idle machine
            "lists": "neigh_modify delay 0 every 1 check no binsize 0.001\n",
            "skin": f"neighbor {2 * DX} bin\n",
            # the other rank has no particle
            "alone": "comm_style brick\nbalance 1.0 x 0.999\n"}[case]
    done = run(tmp_path, scene.text() + more
               + f"fix report all fsi/report\nrun {400 if case == 'alone' else 80}\n",
               2 if case == "alone" else 1, scene_data=scene.data())
    report, found = reports(done)[0], hints(done)
    shares = [share for _, share, _ in found]
    assert shares == sorted(shares, reverse=True)
    assert report["change_first"] == (found[0][0].replace(" ", "_") if found else "nothing")
    for part, share, text in found:
        assert text
        if part != "waiting":
            assert share == pytest.approx(100.0 * report[f"share_{part.replace(' ', '_')}"],
                                          abs=0.051) and share > USUAL[part]
    assert set(named) <= {part for part, _, _ in found}
    if case != "alone":
        for part in ("neighbor lists", "output"):
            assert (part in [p for p, _, _ in found]) == (
                100.0 * report[f"share_{part.replace(' ', '_')}"] > USUAL[part])
    if case == "skin":
        assert (f"a skin of 2 dx: neighbor {0.3 * DX:.2g} bin" in [t for _, _, t in found]) == (
            100.0 * report["share_force_of_fluid"] > USUAL["force of fluid"])
    if case == "lists":
        assert "new ones every 1 steps: a larger skin" in dict(
            (p, t) for p, _, t in found)["neighbor lists"]


# ---- accuracy ------------------------------------------------------------------------------------

def test_vector_is_the_run_so_far(tmp_path):
    scene, text = gate()
    more = ("fix report all fsi/report\nfix push all addforce 3.0 0 0\nthermo 20\n"
            "thermo_style custom step " + " ".join(f"f_report[{k}]" for k in range(1, 4))
            + "\nthermo_modify format float %.12g\nrun 40\n")
    done = run(tmp_path, text + more, scene_data=scene.data())
    report, thermo = reports(done)[0], log.read(tmp_path / "log.lammps").runs[0].thermo
    table = np.array([thermo[f"f_report[{k}]"] for k in range(1, 4)])
    assert table[0, 0] == 0.0 < table[0, 1] < table[0, 2]  # what pushes, by and by
    np.testing.assert_allclose(table[:, -1], vector(report, "rest"), rtol=1e-8)


CASES = {
    "free": ("", ""), "newton off": ("newton off", ""),
    "pushed": ("", "fix push mobile addforce 0.25 0.5 0\n"),
    "held": ("", "fix push clamp addforce 0.25 0.5 0\n"),
    "reflected": ("reflected", "")}


@pytest.mark.parametrize("ranks", (1, 2))
@pytest.mark.parametrize("case", CASES)
def test_momentum(tmp_path, case, ranks):
    """Change from dumped velocities, gravity from masses, walls from their forces, every step;
    nothing is left but what pushes."""
    change, more = CASES[case]
    scene, text = gate()
    if change == "newton off":
        text = text.replace("newton on", "newton off")
    if change == "reflected":
        text = text.replace("velocity 0.1 0 0", "velocity 1 0 0 guard 0.45")
    walls = ["".join(f"$(f_walls[{w}][{d}]:%.17g) " for d in (1, 2)) for w in (1, 2, 3)]
    text += (more + watch(every=60) + "fix report all fsi/report\n"
             f"fix force all print 1 \"{' '.join(walls)}\" file force.txt screen no\nrun 60\n")
    done = run(tmp_path, text, ranks, scene_data=scene.data())
    report, frames, dt = reports(done)[0], done.frames(), 3 * scene.dt
    moving = ~((scene.type == 2) & (scene.x[:, 1] > 0.07))
    m = frames[0]["mass"]
    scale = np.abs(m[:, None] * frames[-1].vector(("vx", "vy"))).sum()
    close = dict(rtol=1e-9, atol=1e-9 * scale)  # printed with ten digits
    np.testing.assert_allclose(vector(report, "change"), momentum(frames[-1], moving)
                               - momentum(frames[0], moving), **close)
    np.testing.assert_allclose(vector(report, "gravity"), [0, -9.81 * m[moving].sum() * 60 * dt, 0],
                               **close)
    # the first is of the setup
    forces = np.loadtxt(tmp_path / "force.txt", comments="#")[1:].reshape(-1, 3, 2).sum(1)
    assert len(forces) == 60
    if case != "reflected":
        np.testing.assert_allclose(vector(report, "walls")[:2], -dt * forces.sum(0), **close)
    else:
        # reflections give momentum, too
        assert abs(vector(report, "walls")[0] + dt * forces.sum(0)[0]) > 1e-3 * scale
    expected = (np.array([0.25, 0.5, 0.0]) * moving.sum() * 60 * dt if case == "pushed"
                else np.zeros(3))
    np.testing.assert_allclose(vector(report, "rest"), expected, atol=1e-12 * scale)
    assert np.abs(vector(report, "held")).max() > 1e-3 * scale  # there was something to sum
    assert ("unaccounted for: fix push, error" in done.output) == (case == "pushed")


def test_stream_is_no_error(tmp_path):
    done = run(tmp_path, deck("stream") + "fix report all fsi/report\nrun 20\n", m_fsi=MATERIALS)
    assert "unaccounted for: fix stream, error" in done.output


def test_ledger(tmp_path):
    scene, text = gate()
    entries = 'print "E ' + " ".join(f"$(c_e[{k}]:%.17g)"
                                     for k in range(1, 15)) + ' $(c_e:%.17g)"\n'
    text += ("compute e all fsi/energy\nthermo_style custom step c_e c_e[1]\n"
             "fix report all fsi/report\nrun 30\n" + entries + "run 40\n" + entries)
    done = run(tmp_path, text, 2, scene_data=scene.data())
    start, end = (np.array(line.split(), float)
                  for line in re.findall(r"^E (.*)$", done.output, re.M))
    report = reports(done)[-1]
    names = [name for name in report if name.startswith("energy_")
             and not name.startswith("energy_change") and name != "energy_drift_relative"]
    assert len(names) == 15
    now = np.array([report[name] for name in names])
    np.testing.assert_allclose(now, end, rtol=1e-9)
    assert names[4] == "energy_artificial_viscosity" and end[4] > start[4] > 0
    # the second run starts with positions and velocities of one time, half a step from where the
    # first ended: only what terms took stays
    changes = np.array([report[name.replace("energy_", "energy_change_")] for name in names[4:-1]])
    np.testing.assert_allclose(changes, (end - start)[4:-1], rtol=1e-7,
                               atol=1e-9 * np.abs(end).max())


@pytest.mark.parametrize("ranks", (1, 2))
def test_changes_nothing(tmp_path, ranks):
    scene, text = gate()
    frames = [run(tmp_path / name, text + line + watch(every=60) + "run 60\n", ranks,
                  scene_data=scene.data()).frames()[-1]
              for name, line in (("without", ""), ("with", "fix report all fsi/report\n"))]
    assert differing(*frames) == []


def test_what_is_lost_takes_its_momentum(tmp_path):
    scene = fluid_box(2)
    scene.v[279] = [0.0, 4.5, 0.0]  # one of the surface
    text = scene.text().replace("lost error", "lost ignore") + watch(
        every=200) + "fix report all fsi/report\nrun 200\n"
    done = run(tmp_path, text, scene_data=scene.data())
    report, frames = reports(done)[0], done.frames()
    gone = ~np.isin(frames[0]["id"], frames[-1]["id"])
    assert (report["lost"] == gone.sum() == 1 and "(1 lost)" in done.output
            and "unaccounted for: lost particles, error" in done.output)
    # it flew off under gravity alone, but for its first steps at the surface: a tenth
    np.testing.assert_allclose(report["momentum_rest_y"], -frames[0]["mass"][gone][0] * 4.5,
                               rtol=0.1)


def test_what_flows_in_is_not_lost(tmp_path):
    """A stream that begins behind an inlet, in two runs."""
    dx, U = 0.1, 1.0
    with open_box((16, 6), dx, 0, f"fix i all fsi/inlet xlo 0 velocity {U} 0 0",
                  f"fix r all fsi/report file {tmp_path / 'report'}", v=(U, 0, 0)) as s:
        came = [0]
        for _ in range(2):
            go_on(s, 60)
            came.append(output_of(s, "i", 2))
    first, second = log.reports(tmp_path / "report")
    assert came[0] < came[1] < came[2]
    assert ([first["particles"], second["particles"]] == [(16 + 5) * 6 + n for n in came[1:]]
            and first["lost"] == second["lost"] == 0)
