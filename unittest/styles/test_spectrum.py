"""fix fsi/spectrum: pure tones, numpy's spectrum, restarts, changing time steps, and the plate's
natural frequency."""

import numpy as np
import pytest

from scenes import lammps, run, run_scene

from fsi import series

EMPTY = """units si
atom_style atomic
atom_modify map array
region box block 0 1 0 1 0 1
create_box 1 box
mass 1 1.0
create_atoms 1 single 0.5 0.5 0.5
pair_style zero 0.1
pair_coeff * *
timestep 0.001
thermo_modify norm no
"""


def tones(*pairs, more="0.3"):
    """Definition of v_s: a sum of sines; pairs (frequency, amplitude)."""
    return "variable time equal time\nvariable s equal " + more + "".join(
        f"+{a!r}*sin({2 * np.pi * f!r}*v_time+{0.4 + k!r})"
                                                  for k, (f, a) in enumerate(pairs)) + "\n"


REPORT = ('print "PEAKS $(f_s[1][1]:%.17g) $(f_s[1][2]:%.17g) $(f_s[2][1]:%.17g) '
          '$(f_s[2][2]:%.17g) $(f_s[1]:%.17g) $(f_s[2]:%.17g) $(f_s)"\n')


def peaks(result, k=-1):
    """Frequency and amplitude of the two largest, and the number of samples; the vector is the
    array's first column."""
    line = [line for line in result.output.splitlines() if line.startswith("PEAKS ")][k]
    f1, a1, f2, a2, v1, v2, n = map(float, line.split()[1:])
    assert (v1, v2) == (f1, f2)
    return f1, a1, f2, a2, n


# ---- exact answers -------------------------------------------------------------------------------

# what the mirror frequency -f leaks at 40 periods: some 1/80, 1/80^3 and 1/80^5 of the amplitude,
# and so much of a bin
LEAK = {"none": 1e-2, "hann": 1e-5, "hann2": 1e-7}


@pytest.mark.parametrize("part", (0.0, 0.13, 0.5, 0.87))
def test_sine(tmp_path, part):
    """Frequency and amplitude of a sine anywhere between two frequencies of the transform; exact
    where it is one of them."""
    n, step = 2000, 0.5  # 2 s
    f = (40 + part) * step
    text = EMPTY + tones((f, 2.0)) + "".join(f"fix {w} all fsi/spectrum 1 v_s window {w} peaks 2\n"
                                             for w in LEAK) + f"run {n - 1}\n"
    result = run(tmp_path, text + "".join(REPORT.replace("f_s", f"f_{w}") for w in LEAK))
    for k, (window, leak) in enumerate(LEAK.items()):
        f1, a1, _, a2, count = peaks(result, k)
        limit = 1e-12 if part == 0.0 else leak
        assert count == n
        assert abs(f1 - f) < limit * step and abs(a1 - 2.0) < 2.0 * limit, window
        assert a2 < (1e-12 if part == 0.0 else 0.1)


def test_two_tones_and_trend(tmp_path):
    """The larger first, each exact to what the other leaks; a slope of 50 tone amplitudes over the
    run is taken out."""
    text = EMPTY + tones((31.3, 0.5), (12.7, 1.5), more="20*v_time")
    text += ("fix s all fsi/spectrum 2 v_s window hann2 detrend linear peaks 2 file s.csv\n"
             "run 3999\n" + REPORT)
    f1, a1, f2, a2, n = peaks(run(tmp_path, text))
    assert n == 2000
    np.testing.assert_allclose([f1, a1, f2, a2], [12.7, 1.5, 31.3, 0.5], rtol=1e-4)


@pytest.mark.parametrize("n", (1000, 1001))
def test_file_is_numpys_spectrum(tmp_path, n):
    """Of a chirp on a slope."""
    cases = [(window, detrend) for window in LEAK for detrend in ("none", "mean", "linear")]
    text = (EMPTY + "variable time equal time\n"
            "variable s equal 0.3+2*v_time+sin(40*v_time)+cos(313.7*v_time*v_time)\n")
    text += "".join(f"fix {w}{d} all fsi/spectrum 1 v_s window {w} detrend {d} file {w}{d}.csv\n"
                    for w, d in cases)
    run(tmp_path, text + f"run {n - 1}\n")
    t = 1e-3 * np.arange(n)
    for window, detrend in cases:
        got = series.read(tmp_path / f"{window}{detrend}.csv")
        y = 0.3 + 2 * t + np.sin(40 * t) + np.cos(313.7 * t * t)
        w = np.sin(np.pi * np.arange(n) / n) ** (2 * list(LEAK).index(window))
        if detrend != "none":
            y = y - np.polyval(np.polyfit(t, y, {"mean": 0, "linear": 1}[detrend], w=np.sqrt(w)), t)
        expected = 2 * np.abs(np.fft.rfft(w * y)) / w.sum()
        expected[[0, -1] if n % 2 == 0 else [0]] /= 2
        # ten digits in the file
        np.testing.assert_allclose(got["amplitude"], expected, rtol=1e-8, atol=1e-9)
        np.testing.assert_allclose(got["frequency"], np.fft.rfftfreq(n, 1e-3), rtol=1e-9)


# ---- runs ----------------------------------------------------------------------------------------

def test_inputs(tmp_path):
    """A variable, a compute's scalar and vector entry and a fix's give the same spectrum; two ranks
    as one."""
    names = ("v_s", "c_one", "c_two[1]", "f_one", "f_two[2]")
    text = EMPTY + tones((31.3, 0.5), (12.7, 1.5)) + """variable same atom v_s
variable twice atom 2*v_s
compute one all reduce sum v_same
compute two all reduce sum v_same v_twice
fix one all ave/time 2 1 2 c_one
fix two all ave/time 2 1 2 c_two[2] c_two[1]
""" + "".join(f"fix s{k} all fsi/spectrum 2 {name} file {k}.csv\n" for k, name in enumerate(names))
    for ranks in (1, 2):
        run(tmp_path, text + "run 400\n", ranks)
        found = [series.read(tmp_path / f"{k}.csv")["amplitude"] for k in range(len(names))]
        assert len(found[0]) == 101
        for other in found[1:]:
            np.testing.assert_allclose(other, found[0], atol=1e-9)


def test_samples_of_several_runs(tmp_path):
    """The last step of a run is the first of the next; `every` analyzes in between, and thermo
    output sees it."""
    text = EMPTY + tones((20.0, 2.0)) + "fix s all fsi/spectrum 1 v_s every 500 peaks 2\n"
    text += "thermo 499\nthermo_style custom step f_s f_s[1] f_s[1][2]\nrun 700\nrun 299\n" + REPORT
    result = run(tmp_path, text)
    rows = [line.split() for line in result.output.splitlines()]
    rows = np.array([row for row in rows if len(row) == 4 and row[0].isdigit()], float)
    assert list(rows[:, 0]) == [0, 499, 700, 700, 998,
                                999] and list(rows[:, 1]) == [1, 500, 701, 701, 999, 1000]
    assert list(rows[0, 2:]) == [0, 0]
    np.testing.assert_allclose(rows[[1, 2, 5], 2:], [[20, 2]] * 3, rtol=1e-5)  # six digits
    np.testing.assert_allclose(peaks(result)[:2], [20.0, 2.0], rtol=1e-12)


def test_restart_goes_on(tmp_path):
    """Bit for bit: samples come back with the restart file, and the next step adds the next one; the
    virial is computed for it."""
    physics = ("compute p all pressure NULL virial\n"
               + tones((31.3, 0.5), (12.7, 1.5), more="0.3+0*c_p")
               + "fix s all fsi/spectrum 3 v_s peaks 2 file {}.csv\n")
    run(tmp_path, EMPTY + physics.format("whole") + "run 501\nwrite_restart half\nrun 500\n"
        + REPORT)
    again = "read_restart half\npair_style zero 0.1\npair_coeff * *\n" + physics.format(
        "again") + "run 500\n" + REPORT
    result = run(tmp_path, again)
    assert (tmp_path / "whole.csv").read_bytes() == (tmp_path / "again.csv").read_bytes()
    assert peaks(result)[4] == 334


@pytest.mark.parametrize("reset, good", [("0", False), ("400 time 0.05", False),
                                         ("400 time 0.1", True)])
def test_restart_at_another_time(tmp_path, reset, good):
    """Samples of a file cannot be followed by earlier ones, which were left out without a word."""
    physics = tones((31.3, 0.5)) + "fix s all fsi/spectrum 1 v_s peaks 2\n"
    run(tmp_path, EMPTY + physics + "run 100\nwrite_restart half\n")
    again = lammps(tmp_path, f"read_restart half\nreset_timestep {reset}\npair_style zero 0.1\n"
                   "pair_coeff * *\n" + physics + "run 50\n" + REPORT)
    if good:
        assert again.status == 0 and peaks(again)[4] == 151
    else:
        assert "is before its last sample, of step 100, time 0.1: no reset_timestep" in again.output


def test_time_steps_that_change(tmp_path):
    """Equal steps are not equal times: samples are interpolated in time. The slowest has 25 per
    period, the fastest 100."""
    text = EMPTY + tones((10.0, 2.0)) + "fix s all fsi/spectrum 1 v_s peaks 2\n"
    text += "run 1000\ntimestep 0.004\nrun 250\ntimestep 0.002\nrun 500\n" + REPORT
    f, a, _, _, n = peaks(run(tmp_path, text))
    assert n == 1751 and abs(f - 10.0) < 1e-3
    assert abs(a - 2.0) < 2.0 * (2 * np.pi / 25) ** 2 / 8  # of a chord


def test_too_few_samples(tmp_path):
    result = run(tmp_path, EMPTY + tones((20.0, 2.0))
                 + "fix s all fsi/spectrum 100 v_s peaks 2 file s.csv\nrun 600\n" + REPORT)
    assert "Fix fsi/spectrum s has 7 samples, no spectrum: it needs at least 8" in result.output
    assert peaks(result) == (0, 0, 0, 0, 7)


@pytest.mark.slow
def test_plate(tmp_path):
    """The natural frequency of the bundled plate: that of its zero crossings, and of finite
    elements."""
    figures = run_scene(tmp_path, "oscillating_plate", n=5)
    # 5.75 swings: a part (2 x 5.75)^-3 of a frequency step, which is 1/5.75 of the frequency, leaks
    # from the mirror frequency
    assert abs(figures["frequency"] * figures["period"] - 1.0) < 2e-4
    # the sweep of doc/cost has it 0.35 % too short at 5 across
    assert abs(1.0 / (0.2553 * figures["frequency"]) - 1.0) < 0.007
    assert (tmp_path / "spectrum.csv").exists()
