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

// What LAMMPS shows to classes derived from its own only. No other file of this package reads such
// members. There are no accessors for them:
//
//   Modify      which parts of a restart file no fix has taken (fsi_record: IDs that have changed)
//   CommBrick   its exchanges with ghosts (fsi_fields: without those that carry nothing)
//   Comm        whether ghosts are fewer than all neighbors (fsi_check)
//   FixGravity  whether it is disabled, whether it has variables (fsi_hub)
//   Fix         its number (fsi_changes: another one may be at the address of one that is gone)
//   FixRigid, FixRigidSmall
//               state of their bodies, read and written (fsi_clamps: they take the step of all)

#ifndef LMP_FSI_LAMMPS_ACCESS_H
#define LMP_FSI_LAMMPS_ACCESS_H

#include "lmptype.h"

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace LAMMPS_NS {
class Comm;
class Fix;
class FixGravity;
class LAMMPS;
class Modify;

namespace FSI {

  // styles and IDs
  std::vector<std::pair<std::string, std::string>> not_taken_from_restart(const Modify *);

  struct Exchange {
    const int *list = nullptr;    // atoms that are sent
    int nsend = 0, to = 0, from = 0, first = 0, nrecv = 0, flag = 0, *pbc = nullptr;
  };
  // false: comm_style tiled, which has others
  bool find_exchanges(const Comm *, std::vector<Exchange> &);

  bool has_reduced_ghosts(const Comm *);    // comm_modify reduce/multi, group
  bool is_disabled(const FixGravity *), has_variable(const FixGravity *);
  int number_of(const Fix *);

  struct BodyMotion {
    double x[3], v[3], q[4], L[3];
  };
  struct BodyState : BodyMotion {
    tagint id;    // index in fix rigid, tag of an atom in fix rigid/small
    double mass, inertia[3];
  };
  struct BodyNow : BodyState {    // with what follows from the orientation
    double ex[3], ey[3], ez[3], omega[3];
  };

  // One fix rigid or rigid/small. Fix rigid has all bodies on each rank, fix rigid/small has each
  // on the rank of one of its atoms, and copies where others are.
  class RigidBodies {
   public:
    static const int TORQUE;    // bit of flags
    Fix *const fix;
    const bool small;

    RigidBodies(Fix *fix, bool small) : fix(fix), small(small) {}
    virtual ~RigidBodies() = default;
    virtual bool is_early() const = 0;        // when it finds the forces on its bodies
    virtual bool is_thermal() const = 0;      // in a way that others cannot follow
    virtual tagint id_of(int i) const = 0;    // of the body of atom i; -1: of none
    virtual tagint id_by(int i) const = 0;    // of the body whose ID is that of atom i; or -1
    virtual const double *const *displace() const = 0;    // of atoms, in the body's axes
    virtual const imageint *image() const = 0;            // of atoms
    virtual const int *flags() const = 0;                 // of atoms, if some have sizes, or null
    virtual double free(tagint id, int d) const = 0;      // 0: component of force, torque left out
    virtual const double *langevin(tagint id) const = 0;    // force and torque, or null
    virtual const double *gravity() const = 0;              // if that is its own, or null
    std::vector<BodyState> states() const;                  // that this rank has
    void store(const std::function<const BodyNow *(tagint)> &of) const;

   protected:
    struct Entry {
      tagint id;
      double mass, *inertia;
      double *x, *v, *q, *L, *omega, *ex, *ey, *ez;
    };
    virtual std::vector<Entry> entries(bool with_copies) const = 0;
  };
  // none without package RIGID
  std::vector<std::shared_ptr<RigidBodies>> rigid_bodies(LAMMPS *);

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
