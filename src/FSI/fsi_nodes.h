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

// Sums at the nodes of a lattice in a plane across an axis. A rank has only the nodes that its
// particles give to and those that they take from. Ranks whose nodes overlap send each other
// theirs, which each adds in the order of the ranks.

#ifndef LMP_FSI_NODES_H
#define LMP_FSI_NODES_H

#include "pointers.h"

#include <cmath>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {

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

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
