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

// The buffer behind the plane of an open end: particles whose velocity or pressure is prescribed.
// One that passes the plane inward is fluid from then on; the last of a row that has come a spacing
// from the buffer's end is followed by another; fluid that passes it outward is of the buffer, and
// deleted at its end.

#ifndef LMP_FSI_BUFFER_H
#define LMP_FSI_BUFFER_H

#include "fsi_open_end.h"
#include "fsi_population.h"

namespace LAMMPS_NS {
class FixFSI;

namespace FSI {
  class Fields;

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
    void init(FixFSI *);
    void fill();    // before the first run; an empty one with the fluid before it, which goes on
    // when lists are built: what has passed the plane, or the end of the buffer
    void exchange(const std::vector<const OpenEnd *> &all_ends);
    void start_step();
    void follow(int i, double s, double column);
    void prescribe(double wave);    // velocities
    void check_supply();
    int count() const;    // of this rank

   private:
    typedef std::array<double, 2> Column;    // along the plane
    struct Census {
      bigint behind = 0, ahead = 0, beyond = 0, walls_behind = 0, walls_ahead = 0;
    };

    OpenEnd &end;
    FixFSI *fix_fsi = nullptr;
    Population *population = nullptr;
    const Discretization *disc = nullptr;
    double *members = nullptr;    // per atom: Member, as a number since a field is one
    // of one that is followed: where the next one would be now; its velocity, and the step since
    // when
    double **behind = nullptr, **follower = nullptr;
    // particles behind the plane in the last step; that went between two runs
    double last_count = -1.0, taken = 0.0;
    bool warned_of_stranger = false, warned_of_supply = false;    // in this run

    Member member(int i) const { return static_cast<Member>(members[i]); }
    int first_axis() const { return end.axis == 0 ? 1 : 0; }
    Column along(const double *x) const { return {x[first_axis()], x[end.axis == 2 ? 1 : 2]}; }
    // slices of a spacing, counted from the plane
    int number_of_slices() const { return static_cast<int>(std::round(end.length / disc->dx)); }
    int slice(double distance) const
    {
      return std::max(0, static_cast<int>(std::ceil(distance / disc->dx - 1.0e-6)) - 1);
    }
    template <class Visit>
    void beside(const std::vector<Particle> &sorted, const double *x, Visit) const;
    void sort_along_plane(std::vector<Particle> &) const;
    Census take_census(std::vector<int> &slices, bool &has_some);
    void check_census(const Census &) const;
    void check_levels(bool is_empty) const;
    void check_slices(const std::vector<int> &rank_local) const;
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
