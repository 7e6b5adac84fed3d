/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   Copyright (2003) Sandia Corporation.  Under the terms of Contract
   DE-AC04-94AL85000 with Sandia Corporation, the U.S. Government retains
   certain rights in this software.  This software is distributed under
   the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fix_fsi_spectrum.h"

#include "comm.h"
#include "error.h"
#include "fsi_keywords.h"
#include "fsi_record.h"
#include "input.h"
#include "math_const.h"
#include "modify.h"
#include "update.h"
#include "variable.h"

#include <algorithm>
#include <cmath>

// FSI_FFTW3: of this package's CMake files, which found FFTW; in a LAMMPS tree that of KSPACE
#if defined(FSI_FFTW3) || (defined(FFT_FFTW3) && !defined(FFT_SINGLE))
#define FSI_HAS_FFTW
#include <fftw3.h>
#endif

using namespace LAMMPS_NS;
using namespace FSI;

static constexpr int LEAST = 8;            // samples that make a spectrum
static constexpr double ROUND = 1.0e-9;    // of a time

FixFSISpectrum::FixFSISpectrum(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg), last(-1)
{
#if !defined(FSI_HAS_FFTW)
  error->all(FLERR,
             "Fix fsi/spectrum is not in this build, which did not find FFTW3: install it (Debian: "
             "libfftw3-dev) and configure again");
#endif
  int npeaks;
  Keywords keywords(lmp, "fix fsi/spectrum");
  keywords.argument("Nevery").integer(nevery, 1, 1);
  keywords.argument("input").word(argument, "");
  keywords.key("window").choice(order, 1, {"none", "hann", "hann2"});
  keywords.key("detrend").choice(detrend, MEAN, {"none", "mean", "linear"});
  keywords.key("peaks").integer(npeaks, 3, 1, 1000);
  keywords.key("every").integer(analyze_every, 0, 0);
  keywords.key("file").word(file, "");
  keywords.parse(narg - 3, arg + 3);
  peaks.resize(npeaks);
  if (!utils::strmatch(argument, "^[vcf]_"))
    error->all(FLERR,
               "Fix fsi/spectrum input {}: expected v_name of an equal-style variable, or a number "
               "of a compute or fix, c_ID, c_ID[i], f_ID or f_ID[i]",
               argument);
  if (!file.empty() && comm->me == 0) fclose(open("a"));    // not only at the end of the run

  scalar_flag = vector_flag = array_flag = 1;
  extscalar = extvector = extarray = 0;
  size_vector = size_array_rows = peaks.size();
  size_array_cols = 2;
  global_freq = nevery;
  time_depend = 1;
  restart_global = 1;
  modify->addstep_compute_all(((update->ntimestep + nevery - 1) / nevery) * nevery);
}

FILE *FixFSISpectrum::open(const char *mode) const
{
  FILE *const fp = fopen(file.c_str(), mode);
  if (!fp)
    error->one(FLERR, "Cannot open fix fsi/spectrum file {}: {}", file, utils::getsyserror());
  return fp;
}

// what is sampled next must be ready, also where a restart file has the sample of this step
void FixFSISpectrum::setup(int)
{
  end_of_step();
  modify->addstep_compute_all((update->ntimestep / nevery + 1) * nevery);
}

void FixFSISpectrum::end_of_step()
{
  const bigint step = update->ntimestep;
  const double now = FSI::Clock::now(update), before = time.empty() ? -HUGE_VAL : time.back();
  // after read_restart; to a fix that is there LAMMPS refuses it
  if (step < last || now < before - ROUND * std::fabs(before))
    error->all(FLERR,
               "Fix fsi/spectrum {}: step {}, time {:.8g} is before its last sample, of step {}, "
               "time {:.8g}: no reset_timestep, or give it another ID to begin anew",
               id, step, now, last, before);
  // the last step of a run is the first of the next
  if (step % nevery || step == last || now <= before) return;
  last = step;
  modify->clearstep_compute();
  value.push_back(input->variable->compute_equal(argument));    // as in a formula
  time.push_back(now);
  modify->addstep_compute(step + nevery);
  if (analyze_every && value.size() % analyze_every == 0) analyze();
}

void FixFSISpectrum::post_run()
{
  if ((int) value.size() < LEAST && update->nsteps && comm->me == 0)
    error->warning(FLERR, "Fix fsi/spectrum {} has {} samples, no spectrum: it needs at least {}",
                   id, value.size(), LEAST);
  analyze();
}

// samples equally spaced in time (interpolated where fix fsi/dt has changed their distance),
// without trend, times the window; area: sum of the window
std::vector<double> FixFSISpectrum::prepare(double &area) const
{
  const int n = value.size();
  const double dt = (time[n - 1] - time[0]) / (n - 1);
  std::vector<double> y(value), w(n);
  for (int k = 1, m = 0; k < n - 1; k++) {
    const double t = time[0] + k * dt;
    if (std::fabs(time[k] - t) < 1.0e-6 * dt) continue;
    while (time[m + 1] < t) m++;
    y[k] = value[m] + (value[m + 1] - value[m]) * (t - time[m]) / (time[m + 1] - time[m]);
  }

  area = 0.0;
  double s1 = 0.0, s2 = 0.0, sy = 0.0, s1y = 0.0;
  for (int k = 0; k < n; k++) {
    const double s = std::sin(MathConst::MY_PI * k / n), x = k - 0.5 * n;
    w[k] = order == 0 ? 1.0 : order == 1 ? s * s : s * s * s * s;
    area += w[k];
    s1 += w[k] * x;
    s2 += w[k] * x * x;
    sy += w[k] * y[k];
    s1y += w[k] * x * y[k];
  }
  // weighted least squares, so that nothing is left at frequency 0
  const double slope = detrend == LINEAR ? (area * s1y - s1 * sy) / (area * s2 - s1 * s1) : 0.0;
  const double level = detrend == UNCHANGED ? 0.0 : (sy - slope * s1) / area;
  for (int k = 0; k < n; k++) y[k] = w[k] * (y[k] - level - slope * (k - 0.5 * n));
  return y;
}

// Amplitudes A_k = 2 |X_k|/sum of w at k/(n dt). A sine whose frequency lies the part d of the
// distance to the next frequency beyond k has, with the window sin^2m and many periods, the ratio
// of its two largest amplitudes
//   a = A_k+1/A_k = (m + d)/(m + 1 - d)
// (m = 0, 1: Rife & Vincent 1970, Grandke 1983), and A_k = amplitude sin(pi d)/(pi d)/prod_j=1..m
// (1 - d^2/j^2).
std::vector<FixFSISpectrum::Peak> FixFSISpectrum::peaks_of(const std::vector<double> &A,
                                                           double df) const
{
  std::vector<Peak> found;
  for (size_t k = 1; k + 1 < A.size(); k++) {
    if (A[k] <= A[k - 1] || A[k] < A[k + 1]) continue;
    const bool up = A[k + 1] > A[k - 1];
    const double a = (up ? A[k + 1] : A[k - 1]) / A[k];
    const double d = std::max(0.0, ((order + 1) * a - order) / (a + 1.0));
    double amplitude = A[k];
    if (d > 0.0) amplitude *= MathConst::MY_PI * d / std::sin(MathConst::MY_PI * d);
    for (int j = 1; j <= order; j++) amplitude *= 1.0 - d * d / (j * j);
    found.push_back({(up ? k + d : k - d) * df, amplitude});
  }
  std::stable_sort(found.begin(), found.end(), [](const Peak &p, const Peak &q) {
    return p.amplitude > q.amplitude;
  });
  return found;
}

void FixFSISpectrum::analyze()
{
  std::fill(peaks.begin(), peaks.end(), Peak{0.0, 0.0});
  const int n = value.size();
  if (n < LEAST) return;
#if defined(FSI_HAS_FFTW)
  if (comm->me == 0) {
    double area;
    std::vector<double> y = prepare(area), A(n / 2 + 1);
    auto *X = (fftw_complex *) fftw_malloc(sizeof(fftw_complex) * A.size());
    fftw_plan plan = fftw_plan_dft_r2c_1d(n, y.data(), X, FFTW_ESTIMATE);
    fftw_execute(plan);
    for (int k = 0; k <= n / 2; k++)
      A[k] = (k == 0 || 2 * k == n ? 1.0 : 2.0) * std::hypot(X[k][0], X[k][1]) / area;
    fftw_destroy_plan(plan);
    fftw_free(X);
    const double df = (n - 1) / (n * (time[n - 1] - time[0]));
    const auto found = peaks_of(A, df);
    std::copy_n(found.begin(), std::min(found.size(), peaks.size()), peaks.begin());

    if (!file.empty()) {
      FILE *const fp = open("w");
      utils::print(fp, "frequency,amplitude\n");
      for (int k = 0; k <= n / 2; k++) utils::print(fp, "{:.10g},{:.10g}\n", k * df, A[k]);
      if (ferror(fp) + fclose(fp))
        error->one(FLERR, "Cannot write fix fsi/spectrum file {}: {}", file, utils::getsyserror());
    }
  }
#endif
  MPI_Bcast((double *) peaks.data(), 2 * static_cast<int>(peaks.size()), MPI_DOUBLE, 0, world);
}

// restart: the samples
void FixFSISpectrum::write_restart(FILE *fp)
{
  Record record(lmp, "fix fsi/spectrum");
  record.add("input", argument);
  record.add("Nevery", std::to_string(nevery));
  record.add("last", std::to_string(last));
  record.add("times", time);
  record.add("values", value);
  record.write(fp);
}

void FixFSISpectrum::restart(char *buf)
{
  const Record record(lmp, "fix fsi/spectrum", buf);
  if (record.value("input") != argument)
    error->all(FLERR,
               "Fix fsi/spectrum {} is of {}, the restart file has samples of {}: give it another "
               "ID to begin anew",
               id, argument, record.value("input"));
  if (record.has("Nevery") && record.value("Nevery") != std::to_string(nevery) && comm->me == 0)
    error->warning(FLERR,
                   "Fix fsi/spectrum: Nevery was {} {}, and is {} now: between samples of the file "
                   "it is interpolated",
                   record.value("Nevery"), Keywords::OF_RESTART, nevery);
  last = std::stoll(record.value("last"));
  time = record.numbers("times");
  value = record.numbers("values");
}

double FixFSISpectrum::memory_usage()
{
  return (double) (time.capacity() + value.capacity()) * sizeof(double);
}
