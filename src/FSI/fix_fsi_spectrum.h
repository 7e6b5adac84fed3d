/* -*- c++ -*- ----------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   Copyright (2003) Sandia Corporation.  Under the terms of Contract
   DE-AC04-94AL85000 with Sandia Corporation, the U.S. Government retains
   certain rights in this software.  This software is distributed under
   the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(fsi/spectrum,FixFSISpectrum);
// clang-format on
#else

#ifndef LMP_FIX_FSI_SPECTRUM_H
#define LMP_FIX_FSI_SPECTRUM_H

#include "fix.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// Amplitude spectrum and dominant frequencies of a scalar that is sampled during a run.

class FixFSISpectrum : public Fix {
 public:
  FixFSISpectrum(class LAMMPS *, int, char **);
  int setmask() override { return FixConst::END_OF_STEP | FixConst::POST_RUN; }
  void setup(int) override;
  void end_of_step() override;
  void post_run() override;
  double compute_scalar() override { return value.size(); }    // of samples
  // frequencies, the largest amplitude first; with amplitudes
  double compute_vector(int i) override { return peaks[i].frequency; }
  double compute_array(int i, int j) override
  {
    return j ? peaks[i].amplitude : peaks[i].frequency;
  }
  void write_restart(FILE *) override;
  void restart(char *) override;
  double memory_usage() override;

 private:
  enum Detrend { UNCHANGED, MEAN, LINEAR };
  struct Peak {
    double frequency = 0.0, amplitude = 0.0;
  };
  std::string argument, file;    // the input as in the script
  int order;                     // of the window sin^(2 order)
  int detrend, analyze_every;
  std::vector<Peak> peaks;
  bigint last;    // step of the last sample
  std::vector<double> time, value;

  FILE *open(const char *mode) const;
  std::vector<Peak> peaks_of(const std::vector<double> &amplitudes, double df) const;
  void analyze();
  std::vector<double> prepare(double &) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
