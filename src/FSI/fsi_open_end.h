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

// An open end of the fluid (fix fsi/inlet): a plane across an axis, of which a part is open, behind
// it a buffer. What is given there and what the fluid has there, and how both are kept together:
// waves leave (Absorber), and mass is that of the room that there is (Fullness).

#ifndef LMP_FSI_OPEN_END_H
#define LMP_FSI_OPEN_END_H

#include "atom.h"
#include "fmt/format.h"
#include "fsi_scene.h"
#include "fsi_value.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace LAMMPS_NS {
class Region;

namespace FSI {
  class OpenEnd : protected Pointers {
   public:
    static constexpr int PRESSURE = 3, NVALUES = 4;    // after the components of the velocity
    static constexpr double AUTO = -1.0;
    // Of rho c^2: a pressure that is not one of a fluid that is hardly compressed. Of the lattice's
    // number density: no fluid to speak of
    static constexpr double FAR = 0.1, LITTLE = 1.0e-3;
    struct Place {    // of a particle near the plane
      int i = 0;
      double inside = 0.0;      // distance from the plane into the fluid
      double pressure = 0.0;    // of fluid before the plane, as if it were at the plane
      double normal = 0.0;      // velocity of the fluid at the plane, along the axis
      bool known = false;       // is there fluid at the plane?
    };
    // sums over the fluid at the plane
    enum Sum {
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
      NSUM
    };

    const std::string command, label, id, name;    // fix fsi/inlet; Fix fsi/inlet; that and its ID
    const bool outlet;
    const int igroup, groupbit;
    int axis = 0;
    double side = 1.0, position = 0.0;    // +1: the fluid is above the plane
    double length = 0.0;                  // of the buffer
    std::string region_id;
    Values given;               // velocity and pressure; the other one is that of the fluid
    bool background = false;    // is the pressure that of the background?
    const Discretization *disc = nullptr;
    std::vector<Place> places;    // of this rank, from one list to the next
    double sum[NSUM] = {};        // of the last step
    // of the ranks that this end is a matter of; null on others
    MPI_Comm ranks = MPI_COMM_NULL;

    OpenEnd(LAMMPS *, const Fix *);
    ~OpenEnd() override { forget_ranks(); }
    void init(const Discretization *, double given_length);
    void match_region() const;    // before places are asked for
    void find_places();
    void renew_ranks(bool has_some);
    void forget_ranks();
    // sums, and where places are
    void measure(const std::vector<std::array<double, 3>> &body_forces, bool pressure_varies);

    bool has_own_velocity() const { return !given.given(0); }    // which is extrapolated
    bool has_own_pressure() const { return !given.given(PRESSURE) && !background; }
    double value(int k, int i) const;                   // which is a number
    double pressure_given(int i) const;                 // which may be none
    double average(int k, int weight = WEIGHT) const    // at the plane; 0 where there is no fluid
    {
      return sum[weight] > 0.0 ? sum[k] / sum[weight] : 0.0;
    }
    double inside(const double *x) const { return side * (x[axis] - position); }
    // before the plane: where slope and room are looked at
    double zone() const { return 2.0 * length; }
    bool in_patch(const double *x) const;
    bool is_fluid(int i) const;
    bool holds(const double *x) const;    // is a place in the buffer?
    // calls f(i, inside) for this rank's fluid from one distance to another, behind and before the
    // part that is open
    template <class F> void for_fluid(double from, double to, F f) const
    {
      for (int i = 0; i < atom->nlocal; i++) {
        const double s = inside(atom->x[i]);
        if (s > from && s < to && is_fluid(i) && in_patch(atom->x[i])) f(i, s);
      }
    }
    const State &softest() const;
    bool is_far(double p) const;
    double slow_rate() const, hat_at(double s, double spacings = 2.0) const;
    double end() const { return position - side * length; }    // of the buffer
    std::string at(double place) const { return fmt::format("{} = {:g}", "xyz"[axis], place); }

   private:
    Region *region = nullptr;
    void find_length(double given_length);
    void check_plane() const;
    void find_region();
  };

  // Sound that leaves meets its own impedance: to a change of the fluid's velocity the pressure at
  // the plane answers with rho c times that, or the velocity to one of its pressure, and goes back
  // to what is given at the rate of absorption. Of the mean over the plane: vortices that pass do
  // not change it. A pressure that is given is that of the plane; along the buffer it goes on as
  // the mean of the fluid does, or the fluid would be pushed by less than its gradient for as long
  // as it sees the buffer. What is slower than sound through the box counts.
  class Absorber : protected Pointers {
   public:
    double absorb = 0.0;    // 1/time; < 0: of the domain's length
    // velocity or pressure over impedance that it adds; the mean from which it has that, and is
    // there one?
    double wave = 0.0, before = 0.0;
    bool has_before = false;
    // of the fluid's pressure beyond that given, into the fluid: mean over the plane and some time
    double gradient = 0.0;
    // added to a given pressure, so that the stress at the plane is that; area of the plane, when
    // the buffer was filled
    double added = 0.0, area = 0.0;

    Absorber(LAMMPS *lmp, const OpenEnd &end) : Pointers(lmp), end(end) {}
    void advance(double dt, bool driven);    // driven: has an open end a given velocity?
    void find_area();
    bool meets_pressure() const;
    void meet_pressure(const double *divergence, double dt);

   private:
    const OpenEnd &end;
  };

  // Is there as much fluid as there is room?
  class Fullness : protected Pointers {
   public:
    static constexpr int LOOK_EVERY = 20;    // steps
    // mass of the fluid near the plane over what its density has room for (0: not known yet); its
    // mean of late
    double now = 0.0, mean = 1.0;
    double column = 1.0;    // spacing along the axis of what comes in, in dx
    bool warned = false;    // in this run

    Fullness(LAMMPS *lmp, const OpenEnd &end) : Pointers(lmp), end(end) {}
    void look(const double *psi);
    void keep(Scene *, double dt);

   private:
    const OpenEnd &end;
    void warn(bool full);
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
