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
FixStyle(fsi/inlet,FixFSIInlet);
FixStyle(fsi/outlet,FixFSIInlet);
// clang-format on
#else

#ifndef LMP_FIX_FSI_INLET_H
#define LMP_FIX_FSI_INLET_H

#include "fsi_fields.h"
#include "fsi_part.h"

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {
  class Nodes;
  struct Particle;
  class Values;
}    // namespace FSI

// An open end of the fluid: a plane, and behind it a buffer of particles whose velocity or pressure
// is prescribed, and the other one that of the fluid at the plane. One that passes the plane inward
// is fluid from then on; the last of a row that has come a spacing from the buffer's end is
// followed by another; fluid that passes it outward is of the buffer, and deleted at its end.
// Inlets and outlets are the same but for defaults.

class FixFSIInlet : public FSI::FixFields, public FSI::Part {
 public:
  FixFSIInlet(class LAMMPS *, int, char **);
  ~FixFSIInlet() override;
  int setmask() override { return FixConst::PRE_EXCHANGE; }
  void init() override;
  void setup_pre_exchange() override;
  void pre_exchange() override;
  double compute_scalar() override { return mass_in; }
  double compute_vector(int) override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double memory_usage() override;

  Rank rank() const override { return OPEN_ENDS; }
  void start_step() override;       // places of those who are to be made
  void advance(bool) override;      // density of the buffer, when the fluid has its own
  void end_state(bool) override;    // is there as much fluid as there is room?
  void prescribe() override;        // velocity of the buffer

  bool holds(const double *x) const;    // is a place in the buffer?

 private:
  struct Place {    // of a particle near the plane
    int i = 0;
    double inside = 0.0;    // distance from the plane into the fluid
    double normal = 0.0;    // velocity of the fluid at the plane, along the axis
    bool known = false;     // is there fluid at the plane?
  };
  // sums over the fluid at the plane
  enum {
    WEIGHT,
    SPEED,
    INNER_WEIGHT,
    INNER_SPEED,
    MEAN_PRESSURE,
    OVER_IMPEDANCE,
    MASS_FLOW,
    VOLUME_FLOW,
    BUFFER,
    TOO_FAR,
    MASS,
    BEYOND,
    FIRST,
    SECOND,
    SLOPE,
    NMEAN
  };

  const std::string who, name;    // Fix fsi/inlet; with its ID
  const bool outlet;
  FSI::Keywords keywords;
  int axis;
  double side, position;    // +1: the fluid is above the plane
  std::string words[4], region_id;
  const std::unique_ptr<FSI::Values>
      given;                  // velocity and pressure; the other one is that of the fluid
  bool background = false;    // is the pressure that of the background?
  double absorb;              // 1/time; < 0: of the domain's length
  bool driven;                // has an open end of the scene a given velocity?
  double given_length, length = 0.0;
  // plane and length of its buffer in the last run; is that one of a restart file?
  std::vector<double> made;
  bool of_file = false;
  class Region *region = nullptr;
  class FixFSI *fix_fsi = nullptr;

  // LAST of a row; FOLLOWED by one that the next list has; NEXT to one that has left, not yet where
  // it is the last
  static constexpr double NOT = 0.0, MEMBER = 1.0, LAST = 2.0, FOLLOWED = 3.0, NEXT_OF_ROW = 4.0;
  double *of_buffer = nullptr;    // per atom
  // of one that is followed: where who follows would be now; its velocity, and the step since when
  double **behind = nullptr, **follower = nullptr;
  std::vector<Place> places;

  // sums over the fluid at the nodes of a lattice in the plane, then values there; then the largest
  // and the negative least velocity
  const std::unique_ptr<FSI::Nodes> nodes_held;
  FSI::Nodes &nodes;
  int nbounds = 0;
  double mean[NMEAN] = {};

  // what is kept
  bool filled = false;
  // of absorption: velocity or pressure over impedance that it adds; the mean from which it has
  // that, and is there one?
  double wave = 0.0, before = 0.0;
  bool has_before = false;
  // of the fluid's pressure beyond that given, into the fluid: mean over the plane and some time
  double gradient = 0.0;
  // added to a given pressure, so that the stress at the plane is that; area of the plane, when the
  // buffer was filled
  double added = 0.0, area = 0.0;
  double served = -1.0;    // particles near the plane at first; < 0: not known yet
  double passed_in = 0.0, passed_out = 0.0, mass_in = 0.0;
  // mass of the fluid near the plane over what its density has room for (0: not known yet); its
  // mean of late
  double fill = 0.0, mean_fill = 1.0;
  double column = 1.0;    // spacing along the axis of what comes in, in dx
  // particles behind the plane in the last step; that went between two runs
  double last_buffer = -1.0, taken = 0.0;
  struct {
    bool far, stranger, fill, empty;
  } told = {};                // warnings of this run
  double push_sum[4] = {};    // force on the buffer and its power, this rank's part

  double average(int sum, int weight = WEIGHT) const    // at the plane; 0 where there is no fluid
  {
    return mean[weight] > 0.0 ? mean[sum] / mean[weight] : 0.0;
  }
  double inside(const double *x) const { return side * (x[axis] - position); }
  // before the plane: where slope and room are looked at
  double zone() const { return 2.0 * length; }
  bool in_patch(const double *x) const;
  bool is_fluid(int i) const;
  std::string keywords_name() const { return std::string("fix ") + style; }
  bool has_own_velocity() const, has_own_pressure() const;    // which is extrapolated
  double value(int k, int i) const;                           // which is a number
  void check_plane();
  void find_region();
  std::vector<int> find_occupied(std::vector<FSI::Particle> &copies, bool at_start);
  void fit_nodes(int nmoment, int nfit, int nfields);
  typedef std::array<double, 2> Column;    // along the plane
  int first_axis() const { return axis == 0 ? 1 : 0; }
  Column along(const double *x) const { return {x[first_axis()], x[axis == 2 ? 1 : 2]}; }
  std::string at(double place) const { return fmt::format("{} = {:g}", "xyz"[axis], place); }
  void sort_along_plane(std::vector<FSI::Particle> &) const;
  template <class Visit>
  void beside(const std::vector<FSI::Particle> &sorted, const double *x, Visit) const;
  void check_levels(bool is_empty) const;
  void fill_buffer();
  int number_of_slices() const, slice(double distance) const, full_slices() const;
  void check_slices(std::vector<int> &mine) const;
  int find_last_of_rows();
  std::vector<FSI::Particle> go_on_behind() const;
  std::vector<Column> columns_at_plane() const;
  const FSI::State &softest() const;
  bool is_far(double p) const;
  void stranger(int i);
  void check_supply();
  void warn_of_fill(bool full);
  void keep_full();
  void meet_pressure();
  double slow_rate() const, hat_at(double s, double spacings = 2.0) const;
  void set_density(int i, double rho);
  void make(const std::vector<FSI::Particle> &, bool at_start);
  void find_next_of_rows(const std::vector<FSI::Particle> &gone);
  void follow(int i, double s);
  bool find_followers();
  void find_places();
  MPI_Comm ends = MPI_COMM_NULL;    // of the ranks that this end is a matter of; null on others
  void renew_ends(bool has_some);
  void forget_ends();
  double reach_of_nodes() const;
  void measure();
  void hold_shift(const Place &);
  bool at_plane(const double *x, double *values) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
