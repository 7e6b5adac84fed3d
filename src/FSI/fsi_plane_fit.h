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

// What the fluid has at the plane of an open end: fits at the nodes of a lattice in it.

#ifndef LMP_FSI_PLANE_FIT_H
#define LMP_FSI_PLANE_FIT_H

#include "fsi_open_end.h"

#include <cmath>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {

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
    int nlateral, lateral[2];                // axes along the plane
    double distance[2];                      // of nodes along them
    std::vector<double> sums_given, sums;    // rows of each

    explicit Nodes(LAMMPS *);
    void place(int axis, double spacing);    // as the simulation box is now
    // The nodes within a reach of some places, which stay so until the next lists; together on all
    // ranks of a communicator
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
    int first[2], count[2];    // all nodes
    bool periodic[2];
    int nsum, nlargest;
    MPI_Comm ranks;
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
  // fluid within the kernel's support, which is on one side only. (A linear one takes 12 U
  // sigma^2/2 from Poiseuille's profile, and what does not come in is missing in the pressure,
  // too.) Terms that the fluid there cannot tell from lower ones are left out.
  // Where pressure is given the profile of the velocity is that of the fluid a buffer's length
  // before the plane, as in a channel that goes on behind it (a mapped inlet: Tabor and Baba-Ahmadi
  // 2010, Comput. Fluids 39, 553), and only its mean is that at the plane. A profile taken at the
  // plane keeps itself: jets and vortices that come in grow, and a row of the buffer that pushes
  // the particle before it follows what it pushes. (Half as far away some of it was left.)
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

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
