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

// Making and deleting particles when neighbor lists are built, in pre_exchange(): IDs that no
// particle has, LAMMPS' counts and map, the energy balance. All ranks together:
// begin(); remove(); make(); end().

#ifndef LMP_FSI_POPULATION_H
#define LMP_FSI_POPULATION_H

#include "pointers.h"

#include <string>
#include <vector>

namespace LAMMPS_NS::FSI {
class Record;
struct Discretization;
struct StepState;

struct Particle {    // that is to be made
  double x[3] = {}, v[3] = {}, rho = 0.0, rmass = 0.0;
  tagint parent = 0, molecule = 0;    // parent: of what makes it, for an order of IDs
  int type = 0, mask = 0;
  double since = 0.0;    // a step, likewise
};

class Population : protected Pointers {
 public:
  Population(LAMMPS *lmp, const Discretization &disc, const StepState &step) :
      Pointers(lmp), disc(disc), step(step)
  {
  }
  Particle copy_of(int i) const;
  double energy(int i) const;    // kinetic, potential, compressive

  bigint net = 0;             // particles made less those deleted, since fix fsi is there
  void leave_an_id_free();    // in init() of what makes particles
  void begin();
  // of this rank, in rising order; to an account goes their energy, from it that of new ones.
  // Null: there is none
  void remove(const std::vector<int> &, double *account);
  // The same list on all ranks that the places belong to, an empty one or this on others; IDs go
  // on in its order. Those of this rank are the last of its atoms then. Label: of errors
  void make(const std::vector<Particle> &, const std::string &label, double *account);
  // IDs of particles that are to be made on any rank, the same list on all; first those released
  std::vector<tagint> ids(int n, const std::string &label);
  int copy(int i, tagint id);    // of this rank, with all that fixes know of it; where it is
  void release(const std::vector<tagint> &of_rank);    // IDs of those removed here: for others
  void end();

  void write(Record &) const;
  void read(const Record &);

 private:
  const Discretization &disc;
  const StepState &step;
  tagint last_id = 0;              // the largest that one had which was made or deleted here
  std::vector<tagint> free_ids;    // below that, released; in rising order
  bigint made = 0, removed = 0, wanted = 0;    // since begin(): of this rank; of all
  std::string maker;
  void renew_map();
  std::vector<tagint> new_ids(tagint n, const std::string &label);
  std::vector<char> in_use(const std::vector<tagint> &) const;
};

}    // namespace LAMMPS_NS::FSI

#endif
