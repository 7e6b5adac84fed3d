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

#ifdef COMPUTE_CLASS
// clang-format off
ComputeStyle(fsi/probe,ComputeFSIProbe);
// clang-format on
#else

#ifndef LMP_COMPUTE_FSI_PROBE_H
#define LMP_COMPUTE_FSI_PROBE_H

#include "compute.h"
#include "fsi_part.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {
  struct Discretization;
  struct StepState;
  struct Walls;
}    // namespace FSI

// Gauges: the fluid's fields interpolated at points and over patches, and its level along lines.
// Each rank sums over its own particles, a reduction does the rest; particles near a place are
// listed as seldom as neighbors are. Displacements are those of points of solids, by linear fits.

class ComputeFSIProbe : public Compute, public FSI::Part {
 public:
  ComputeFSIProbe(class LAMMPS *, int, char **);
  ~ComputeFSIProbe() override;
  void init() override;
  void find_idle(const Census &, const Idle &) const override;
  void setup() override;
  void set_arrays(int i) override;
  double compute_scalar() override;
  void compute_vector() override;
  void compute_array() override;
  double memory_usage() override;

 private:
  enum Quantity { P, RHO, VX, VY, VZ, FILL, LEVEL, WET, UX, UY, UZ, SAMPLED };
  static bool of_body(int q) { return q >= UX && q < SAMPLED; }
  std::vector<int> quantity;    // from SAMPLED on: the index of a per-atom compute among these
  struct Sampled {
    std::string id;
    int column;    // 0: a vector
    Compute *compute = nullptr;
  };
  std::vector<Sampled> sampled;
  void read_sampled(const std::string &word);
  void find_sampled();
  bool extrapolate = false;

  struct Particle {
    int i = 0;
    double shift[3] = {};    // to the periodic image that is near
  };
  // points of an orthogonal grid: one, along a line, or all over a patch
  struct Place {
    bool line = false;
    double from[3] = {}, to[3] = {};
    int n[3] = {}, first = 0;    // first: index of its first point among all
    double origin[3] = {}, step[3][3] = {};
    std::vector<std::vector<Particle>> near;    // by level of the scene
    // of a solid, per atom: weight in the fit, 0 of most, and unwrapped place when it was taken
    class FixStoreAtom *kept = nullptr;
    bool taken = false;
    double u[3] = {};

    int size() const { return n[0] * n[1] * n[2]; }
    double along(int d, const double *x) const;    // where x is on grid axis d, in steps
    double distance_sq(const double *x, int dim) const;
    template <class F> void for_points(const double *x, double cut, F) const;
  };
  std::vector<Place> places;
  std::vector<double> points, sums, all;
  int nsums = 0;    // per point: fluid, solid; or fluid and one for each quantity
  bigint listed = -1;

  const FSI::Discretization *disc = nullptr;
  const FSI::StepState *step = nullptr;

  int read_place(const std::string &kind, int narg, char **arg);
  void set_grid(Place &, double dx) const;
  size_t level_of(int type) const;
  void find_near();
  template <class F> void for_images(int i, const Place &, double reach, F) const;
  std::vector<int> walls_near(const FSI::Walls &, std::vector<double> &at) const;
  struct Source;
  void add_level(size_t level, const FSI::Walls &, const std::vector<double> &at,
                 const std::vector<int> &mask);
  void add(const Place &, const Source &, double weight, double head, const double *v, double *sum);
  void sum_up();
  void evaluate(double *result);
  struct Fitted;
  std::vector<Fitted> gather_fit(std::vector<Fitted>) const;
  void take(const Place &);
  void displace(Place &) const;
  double field(const Place &, int k) const;
  double level(const Place &, bool wet) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
