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
#include "fsi_hub.h"
#include "fsi_keywords.h"
#include "fsi_population.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace LAMMPS_NS {
class Region;

namespace FSI {
  class Fields;

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
    // clang-format off
    enum Sum {
      WEIGHT, SPEED, INNER_WEIGHT, INNER_SPEED, MEAN_PRESSURE, OVER_IMPEDANCE, MASS_FLOW,
      VOLUME_FLOW, BUFFER, TOO_FAR, MASS, BEYOND, FIRST, SECOND, SLOPE, NSUM
    };
    // clang-format on

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
    std::string at(double place) const { return fmt::format("{} = {:.10g}", "xyz"[axis], place); }

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
    bool meets_pressure() const
    {
      return !end.has_own_pressure() && end.softest().p0 > 0.0 && area != 0.0;
    }
    void meet_pressure(const double *divergence, double dt);

   private:
    const OpenEnd &end;
  };

  // Is there as much fluid as its density has volume for?
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
    void keep(Ledger &, double dt);

   private:
    const OpenEnd &end;
    void warn(bool full);
  };

  // Sums at the nodes of a lattice in a plane across an axis. A rank has only the nodes that its
  // particles give to and those that they take from. Ranks whose nodes overlap send each other
  // theirs, which each adds in the order of the ranks.
  class Nodes : protected Pointers {
   public:
    struct Box {    // of nodes; along a periodic axis it goes round
      int low[2] = {0, 0}, n[2] = {0, 0};
      int size() const { return n[0] * n[1]; }
    };
    Box given, taken;
    int nlateral = 1, lateral[2] = {};       // axes along the plane
    double distance[2] = {1.0, 1.0};         // of nodes along them
    std::vector<double> sums_given, sums;    // rows of each

    explicit Nodes(LAMMPS *lmp) : Pointers(lmp) {}
    void place(int axis, double spacing);    // as the simulation box is now
    // The nodes within a reach of some places, which stay so until the next lists; together on all
    // ranks of a communicator; null: this rank is none of them
    void share(const std::vector<const double *> &give, double reach,
               const std::vector<const double *> &take, double reach_of_taken, MPI_Comm);
    // rows of some numbers to be summed and some of which the largest counts
    void begin(int to_sum, int largest);
    void add_up();
    int row() const { return nsum + nlargest; }
    double memory_usage() const;

    // calls visit(number in the box, offset from the node) for the nodes within a reach
    template <class Visit> void at(const Box &box, const double *x, double reach, Visit visit) const
    {
      int low[2] = {0, 0}, high[2] = {0, 0};
      for (int k = 0; k < nlateral; k++) {
        low[k] = static_cast<int>(std::ceil((x[lateral[k]] - reach) / distance[k]));
        high[k] = static_cast<int>(std::floor((x[lateral[k]] + reach) / distance[k]));
      }
      for (int b = low[1]; b <= high[1]; b++)
        for (int a = low[0]; a <= high[0]; a++) {
          const int node = number(box, a, b);
          double d[2] = {0.0, 0.0};
          d[0] = x[lateral[0]] - a * distance[0];
          if (nlateral == 2) d[1] = x[lateral[1]] - b * distance[1];
          if (node >= 0) visit(node, d);
        }
    }

   private:
    int first[2] = {}, count[2] = {1, 1};    // all nodes
    bool periodic[2] = {};
    int nsum = 0, nlargest = 0;
    MPI_Comm ranks = MPI_COMM_NULL;
    struct Peer {
      int rank = 0;
      std::vector<int> give, take;    // numbers of the nodes in both of the two ranks' boxes
      std::vector<double> out, in;
    };
    std::vector<Peer> peers;

    int place_in(const Box &box, int k, int a) const    // along an axis, or -1
    {
      int m = a - box.low[k];
      if (periodic[k]) m = (m % count[k] + count[k]) % count[k];
      return m >= 0 && m < box.n[k] ? m : -1;
    }
    int number(const Box &box, int a, int b) const
    {
      const int m = place_in(box, 0, a), n = place_in(box, 1, b);
      return m < 0 || n < 0 ? -1 : n * box.n[0] + m;
    }
    Box around(const std::vector<const double *> &, double reach) const;
    void overlap(const Box &from, const Box &to, bool in_from, std::vector<int> &) const;
    void add(const Peer &, const double *);
  };

  // Pressure or normal velocity of the fluid at the nodes: a fit, quadratic along the plane, of the
  // fluid within the kernel's support, which is on one side only. Terms that the fluid there cannot
  // tell from lower ones are left out. Where pressure is given the profile of the velocity is that
  // of the fluid a buffer's length before the plane, as in a channel that goes on behind it (a
  // mapped inlet: Tabor and Baba-Ahmadi 2010, Comput. Fluids 39, 553), and only its mean is that at
  // the plane: a profile taken there keeps itself (doc/notes/streams.md).
  class PlaneFit : protected Pointers {
   public:
    PlaneFit(LAMMPS *lmp, const OpenEnd &end) : Pointers(lmp), end(end), nodes(lmp) {}
    void share();      // between the ranks of this end, when there are new lists
    void measure();    // after the end has measured where places are
    // fit of a place from the nodes around it: normal velocity, pressure; false: no fluid is near
    bool at(const double *x, double *values) const;
    double memory_usage() const { return nodes.memory_usage(); }

   private:
    const OpenEnd &end;
    // sums over the fluid at the nodes, then values there; then the largest and the negative least
    // velocity
    Nodes nodes;
    int nbounds = 0;
    double reach() const { return 2.0 * std::max(nodes.distance[0], nodes.distance[1]); }
    void fit(int nmoment, int nfit, int nfields);
  };

  // The buffer behind the plane of an open end: particles whose velocity or pressure is prescribed.
  // One that passes the plane inward is fluid from then on; the last of a row that has come a
  // spacing from the buffer's end is followed by another; fluid that passes the plane outward is of
  // the buffer, and deleted at its end.
  class Buffer : protected Pointers {
   public:
    // LAST of a row; FOLLOWED by one that the next list has; NEXT to one that has left, not yet
    // where it is the last
    enum Member { NOT, MEMBER, LAST, FOLLOWED, NEXT_OF_ROW };
    double passed_in = 0.0, passed_out = 0.0, mass_in = 0.0;
    double served = -1.0;    // particles near the plane at first; < 0: not known yet
    double push[4] = {};     // force on it and its power, this rank's part

    Buffer(LAMMPS *lmp, OpenEnd &end) : Pointers(lmp), end(end) {}
    void set_fields(Fields &);
    void init(Ledger &, Population &);
    // before the first run; an empty one with the fluid before it, which goes on
    void populate();
    // when lists are built: what has passed the plane, or the end of the buffer
    void exchange(const std::vector<const OpenEnd *> &all_ends);
    void start_step();
    void follow(int i, double s, double column);
    void add_pulls(double wave, std::vector<StepState::Pull> &);    // to velocities
    void prescribe(double wave);                                    // velocities
    void check_supply();
    int count() const;    // of this rank

   private:
    typedef std::array<double, 2> Column;    // along the plane
    struct Census {
      bigint behind = 0, ahead = 0, beyond = 0, walls_behind = 0, walls_ahead = 0;
    };

    OpenEnd &end;
    Population *population = nullptr;
    Ledger *ledger = nullptr;
    double *members = nullptr;    // per atom: Member, as a number since a field is one
    // of one that is followed: where the next one would be now; its velocity, and the step since
    // when
    double **behind = nullptr, **follower = nullptr;
    // particles behind the plane in the last step; that went between two runs
    double last_count = -1.0, taken = 0.0;
    bool warned_of_stranger = false, warned_of_supply = false;    // in this run

    double velocity_at_end(const OpenEnd::Place &, int d, double wave) const;
    Member member(int i) const { return static_cast<Member>(members[i]); }
    int first_axis() const { return end.axis == 0 ? 1 : 0; }
    Column along(const double *x) const { return {x[first_axis()], x[end.axis == 2 ? 1 : 2]}; }
    // slices of a spacing, counted from the plane
    int number_of_slices() const { return static_cast<int>(std::round(end.length / end.disc->dx)); }
    int slice(double distance) const
    {
      return std::max(0, static_cast<int>(std::ceil(distance / end.disc->dx - 1.0e-6)) - 1);
    }
    template <class Visit>
    void beside(const std::vector<Particle> &sorted, const double *x, Visit) const;
    void sort_along_plane(std::vector<Particle> &) const;
    Census take_census(std::vector<int> &slices, bool &has_some);
    void check_census(const Census &) const;
    void check_levels(bool is_empty) const;
    void check_slices(const std::vector<int> &of_rank) const;
    int find_last_of_rows();
    int full_slices() const, slices_before_bodies() const;
    std::vector<Particle> go_on_behind() const;
    std::vector<int> find_occupied(std::vector<Particle> &copies, bool at_start);
    void make(const std::vector<Particle> &, bool at_start);
    void find_next_of_rows(const std::vector<Particle> &gone);
    void refuse_overlap(int i, const std::vector<const OpenEnd *> &all_ends) const;
    void check_stranger(int i);
    bool find_followers();
  };

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
