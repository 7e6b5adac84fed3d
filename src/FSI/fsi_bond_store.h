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

// Bonds of total-Lagrangian solids: of every solid particle those to its neighbors in the
// reference, with what forces need of each. They go with their atom from rank to rank and through
// restart files. Memory and messages exist for solid particles only.

#ifndef LMP_FSI_BOND_STORE_H
#define LMP_FSI_BOND_STORE_H

#include "fix.h"
#include "fsi_bond_rows.h"
#include "fsi_images.h"

#include <vector>

namespace LAMMPS_NS::FSI {
struct Discretization;
class Ghosts;

class BondStore : public Fix {
 public:
  BondStore(LAMMPS *, int, char **);
  ~BondStore() override;
  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int i) override { slot[i] = NO_BONDS; }
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  int pack_restart(int, double *) override;
  int size_restart(int) override;
  int maxsize_restart() override { return 3 + maxbond * (nvalue + nwhole()) + nplace(); }
  double memory_usage() override;

  const Discretization *disc = nullptr;    // from init() on
  Ghosts *messages = nullptr;              // likewise: numbers of all particles
  bool quadratic = true;                   // gradients exact for quadratic fields, where
                                           // neighbors suffice
  // per bond, 2 D + 2 numbers: G_ij, X_j - X_i, w = V_i V_j W/|X|^2, V_i V_j (grad W)/x_ij
  const int nvalue;
  bool keeps_images = false;    // bodies are bonded across planes
  bool keeps_places = false;    // positions in the reference, for contact of a body with itself
  Images images;                // partners across planes of symmetry

  void choose(bool with_images, bool with_places);    // before there are any
  bool any() const;                                   // on any rank: all ask together
  bool is_solid(int i) const;

  // Of local atom i: has it bonds, or had it; 0 bonds: a solid only since
  bool has(int i) const { return slot[i] >= 0; }
  int count(int i) const { return slot[i] < 0 ? 0 : nbond[slot[i]]; }
  // of bonded ones; what fills up the last block has zeros for numbers
  const double *numbers(int i) const { return &data[(size_t) slot[i] * maxbond * nvalue]; }
  double *bond(int i, int k)
  {
    return &data[(size_t) slot[i] * maxbond * nvalue] + number_of_bond(k, nvalue);
  }
  const double *bond(int i, int k) const { return numbers(i) + number_of_bond(k, nvalue); }
  // indices of local and ghost atoms, and of images
  const int *partners(int i) const { return &local[first(i)]; }
  tagint *partner_tags(int i) { return &partner[first(i)]; }
  const tagint *partner_tags(int i) const { return &partner[first(i)]; }
  // bits of the planes that a partner is an image in
  int planes(int i, int k) const { return keeps_images ? through[first(i) + k] : 0; }
  // sum_j w X_ij (x) X_ij
  const double *moments(int i) const { return &moment[(size_t) slot[i] * nmoment]; }
  // in the energy's integral, times its volume
  double weight(int i) const { return quadrature[slot[i]]; }
  double &weight(int i) { return quadrature[slot[i]]; }
  // stress: has bonds and is not crushed
  bool bears(int i) const { return count(i) > 0 && weight(i) > 0.0; }
  tagint &owner(int i) { return tag_of[slot[i]]; }    // its ID when its bonds were last looked at
  const double *place(int i) const { return places.data() + (size_t) slot[i] * nplace(); }
  bool bonded(int i, int j) const;    // with j

  // Takes the reference of local solids that have none: bonds to all neighbors of the same body
  // where they are now. Then what of the energy's integral is whose, of bonded particles
  // (fsi_bond_maker.cpp). All ranks together
  void take(const std::vector<int> &bare);
  void find_weights(const std::vector<int> &of);
  // sites of a lattice at the cutoff weigh nothing: round-off does not choose among them
  static constexpr double WITHIN = 1.0 - 1.0e-9;

  // a slot for n bonds of i, to be entered, then completed
  void make(int i, int n);
  void enter(int i, int k, tagint partner, int planes);
  void enter_place(int i, const double *x);
  void complete(int i);                  // what follows from its bonds
  void move(int i, int from, int to);    // bond number from to the place of another
  void keep_first(int i, int n) { nbond[slot[i]] = n; }
  bool renew(int i);    // the gradient's weights from the bonds that are left; do they suffice?
  void expect(size_t more);    // bodies are large, and lists that grow are there twice meanwhile

  // when a run begins; afterwards a solid that was none is an error
  bool is_foreign(int i) const { return slot[i] == FOREIGN; }
  void end_taking();
  // a restart file, which rank 0 describes, needs the same largest size everywhere
  void reserve_everywhere();
  void resolve();     // where partners are: after atoms or ghosts have changed
  int changes = 0;    // how often bonds, or where their partners are, have changed
  // local solid atoms, and ghosts of solid atoms
  std::vector<int> solids, ghosts;

 protected:
  int unpack(int i, const double *buf);

 private:
  enum { NO_BONDS = -1, FOREIGN = -2 };    // no bonds yet; no solid when a run began
  int *slot = nullptr;                     // per local atom: where its bonds are, or one of these
  int maxbond = 0;    // bonds of each slot: one size, so that a freed one serves any atom
  const int nmoment;
  size_t expected = 0;    // slots, while bodies are bonded
  std::vector<int> nbond, local, unused, through;
  std::vector<tagint> partner, tag_of;
  std::vector<double> data, moment, quadrature, places;

  size_t first(int i) const { return (size_t) slot[i] * maxbond; }
  int nwhole() const { return keeps_images ? 2 : 1; }    // numbers of a bond beside its doubles
  int nplace() const;                                    // numbers of a place
  template <class Call> void each_list(Call);
  void reserve(int n);
  int new_slot(int n);
  int pack(int i, double *buf) const;
  int find_partner(int i, tagint) const;
  int image_at(const double *place, int j) const;
  void follow_long_bonds(int i, int *of_i) const;
  template <int D> bool renew_as(int i);
};

}    // namespace LAMMPS_NS::FSI

#endif
