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
FixStyle(FSI_REFERENCE,FixFSIReference);
// clang-format on
#else

#ifndef LMP_FIX_FSI_REFERENCE_H
#define LMP_FIX_FSI_REFERENCE_H

#include "fix.h"

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {
  class Cells;
  class Images;
  class Swaps;
}    // namespace FSI

// The reference configuration of total-Lagrangian solids: for every particle its bonds to the
// neighbors of its own body, with the gradient's weights. Made by pair_style fsi/solid/tl; taken
// at the start of the first run; travels with its atom between ranks, through restart files and
// from one pair_style command to the next. Memory and messages exist for solid particles only.

class FixFSIReference : public Fix {
  struct Members;
  const std::unique_ptr<Members> members;

 public:
  static constexpr char ID[] = "FSI_REFERENCE";
  FixFSIReference(class LAMMPS *, int, char **);
  ~FixFSIReference() override;
  int setmask() override { return FixConst::POST_NEIGHBOR; }
  void init() override;
  void setup_post_neighbor() override;
  void post_neighbor() override;
  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int i) override { slot[i] = NO_BONDS; }
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int) override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  int size_restart(int) override;
  int maxsize_restart() override { return 3 + maxbond * (nvalue + nwhole()) + nplace(); }
  double memory_usage() override;

  bool any() const;    // bonds, on any rank: all ask together

  bool quadratic;        // gradients exact for quadratic fields, where neighbors suffice
  bool end_corrected;    // volumes of the energy's integral with corrections at faces

  // per bond, 2 D + 2 numbers: G_ij, X_j - X_i, w = V_i V_j W/|X|^2, V_i V_j (grad W)/x_ij
  int nvalue;
  // bonds of local atom i; what fills up its last block has zeros for numbers
  int count(int i) const { return slot[i] < 0 ? 0 : nbond[slot[i]]; }    // 0: a solid only since
  // indices of local and ghost atoms, and of images
  const int *partners(int i) const { return &local[(size_t) slot[i] * maxbond]; }
  // where they are: number_of_bond()
  const double *numbers(int i) const { return &data[(size_t) slot[i] * maxbond * nvalue]; }
  const double *bond(int i, int k) const;
  // sum_j w X_ij (x) X_ij
  const double *moments(int i) const { return &moment[(size_t) slot[i] * nmoment]; }
  // of i in the energy's integral, times its volume
  double weight(int i) const { return quadrature[slot[i]]; }
  // stress: has bonds and is not crushed
  bool bears(int i) const { return count(i) > 0 && weight(i) > 0.0; }

  // removes bonds longer than stretch times their reference length, and makes the gradient anew
  // from those left; a particle whose bonds no longer suffice loses them all. The gradient of those
  // left may be another than that of all: where the energy (per volume, of local atom i) would grow
  // by it, the particle's weight shrinks instead, so that breaking makes no energy. Looks only at
  // particles of which a bond may have become too long since
  typedef std::function<double(int)> Energy;
  // That of a crushed particle is 0: it keeps its bonds, lest contact pushes from nothing.
  // spare: how far its partners may move until it is
  void break_bonds(double stretch, const Energy &energy, const std::function<double(int)> &spare);

  // Contact of a body with itself (fsi_contact.h), if its range, over the spacing, is above 0:
  // pairs as a local particle i sees them, without a bond, or whose bond may have broken by now,
  // that can come within reach before lists are new. Each belongs to i by half: what one rank sees
  // of its own particles, no other needs to know.
  double self_range;
  bool tears;    // keyword damage
  struct SelfPair {
    int i = 0, j = 0;
    double reach = 0.0;
    bool torn = false;    // neighbors in the reference
  };
  std::vector<SelfPair> near_itself;
  bool bonded(int i, int j) const;    // local i with j

  int changes;    // how often bonds, or where their partners are, have changed
  // local solid atoms, and ghosts of solid atoms
  std::vector<int> solids, ghosts;
  FSI::Swaps &swaps;      // those of solids
  FSI::Images &images;    // partners across planes of symmetry

 private:
  class FixFSI *fix_fsi;
  std::string made;    // how the bonds were: keywords of pair_style fsi/solid/tl; empty: none yet
  std::string as_now() const;
  bool has_record;
  bool resting;    // no pair_style fsi/solid/tl
  int *slot;       // per local atom: where its bonds are, or NO_BONDS or FOREIGN
  enum { NO_BONDS = -1, FOREIGN = -2 };    // no bonds yet; no solid when a run began
  int maxbond, nmoment;
  std::vector<int> nbond, local, unused;
  // owner: ID of the slot's atom when its bonds were last looked at
  std::vector<tagint> partner, owner;
  bool keeps_images;           // bodies are bonded across planes
  std::vector<int> through;    // per bond, bits of the planes that its partner is an image in
  std::vector<double> data, moment, quadrature;
  bool keeps_places;            // for contact of a body with itself
  std::vector<double> place;    // D numbers per slot: positions in the reference
  // damage: positions of solids and ghosts at the last look, empty = indices have changed; how far
  // particles have moved apart since indices changed, at most; per slot, how far they may before
  // one of its bonds can be too long
  std::vector<double> seen, slack;
  double apart;
  double *layer;       // of a message to ghosts: while the reference is taken layers to the face
                       // ahead, by direction; places
  bigint next_look;    // for parts of a body that pass through each other; never again once they
                       // were named
  size_t expected;     // slots, while bodies are bonded

  void refuse_other_materials() const;
  void follow_commands();
  void refuse_split_bodies() const;
  void take();
  template <int D> void take_reference(const std::vector<int> &);
  template <int D, class Kernel>
  void find_neighbors(int i, const Kernel &, const FSI::Cells &solids, std::vector<int> &,
                      std::vector<double> &, std::vector<double> &) const;
  template <int D, class Kernel>
  void find_images(int i, const Kernel &, std::vector<int> &near, std::vector<double> &dX,
                   std::vector<double> &w, std::vector<int> &bits) const;
  void find_planes();
  void check_planes(const std::vector<int> &bare) const;
  template <int D, class Kernel>
  void enter_bonds(int i, const Kernel &, const std::vector<int> &, const std::vector<double> &,
                   const std::vector<double> &, const std::vector<int> &bits);
  double volume(int i) const;
  struct Axes {
    tagint body, tag;    // of the particle they were found at
    double e[3][3];      // rows
  };
  bool find_axes(int i, Axes &) const;
  bool fits(int i, const Axes &) const;
  std::map<tagint, Axes> turned_lattices(const std::vector<int> &) const;
  void find_quadrature(const std::vector<int> &);
  void resolve();
  void find_self_pairs();
  void look_for_passing();
  bool is_solid(int i) const;
  bool is_periodic() const;
  template <int D>
  void break_bonds_of_all(double, const Energy &, const std::function<double(int)> &spare);
  template <int D> bool renew(int i);
  template <int D> void move_apart();
  double *bond_in(int s, int k);
  void move_bond(int s, int from, int to);
  void complete(int s);
  template <int D> void complete_as(int s);
  int nplace() const;    // numbers of one
  template <class Call> void each_list(Call);
  void reserve(int n);
  void hold(size_t n);
  int new_slot(int n);
  int nwhole() const { return keeps_images ? 2 : 1; }    // numbers of a bond beside its doubles
  int pack(int, double *) const;
  int unpack(int, const double *);
};

}    // namespace LAMMPS_NS

#endif
#endif
