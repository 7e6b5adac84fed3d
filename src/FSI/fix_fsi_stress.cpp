/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   Copyright (2003) Sandia Corporation.  Under the terms of Contract
   DE-AC04-94AL85000 with Sandia Corporation, the U.S. Government retains
   certain rights in this software.  This software is distributed under
   the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

#include "fix_fsi_stress.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_fsi.h"
#include "force.h"
#include "memory.h"
#include "modify.h"
#include "pair_fsi_solid.h"
#include "update.h"

#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

FixFSIStress::FixFSIStress(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), stress(nullptr), hourglass(false), keywords(lmp, "fix fsi/stress"),
    ns(domain->dimension == 2 ? 3 : 6), n(ns), dim(domain->dimension)
{
  if (!atom->style_match("fsi")) error->all(FLERR, "Fix fsi/stress requires atom_style fsi");

  keywords.key("plane").choice(plane_stress, 0, {"strain", "stress"});
  keywords.key("plastic").set(plastic, 1);
  keywords.parse(narg - 3, arg + 3);
  if (plane_stress && domain->dimension == 3) error->all(FLERR, "Fix fsi/stress plane is for dimension 2 only");
  if (plastic && plane_stress) error->all(FLERR, "Fix fsi/stress plastic requires plane strain in 2D");
  hourglass = wants_hourglass(force);
  n = ns + (plastic ? 1 : 0) + (hourglass ? dim : 0);

  restart_peratom = 1;
  create_attribute = 1;
  grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
  atom->add_callback(Atom::RESTART);
  for (int i = 0; i < atom->nlocal; i++) set_arrays(i);
}

/* ---------------------------------------------------------------------- */

bool FixFSIStress::wants_hourglass(Force *force)
{
  if (!force->pair) return false;
  const auto *pair = dynamic_cast<PairFSISolid *>(force->pair_match("^fsi/solid$", 0));
  return pair && pair->has_hourglass();
}

/* ---------------------------------------------------------------------- */

FixFSIStress::~FixFSIStress()
{
  if (modify->get_fix_by_id(id)) {
    atom->delete_callback(id, Atom::GROW);
    atom->delete_callback(id, Atom::RESTART);
  }
  memory->destroy(stress);
}

/* ---------------------------------------------------------------------- */

void FixFSIStress::init()
{
  const FixFSI *hub = FixFSI::find(lmp, "Fix fsi/stress");
  if (hourglass != wants_hourglass(force))
    error->all(FLERR, "Fix fsi/stress must be defined after the pair_style command that says whether there is hourglass control");
  // what had a stress keeps it, what had none never gets the right one
  for (int i = 0; i < atom->nlocal && update->whichflag == 1; i++) {
    double &first = stress[i][0];
    const bool solid = hub->state[atom->type[i]].species == FSI::SOLID;
    if (solid ? first == FOREIGN : first != FOREIGN && first != 0.0)
      error->one(FLERR, "Atom {} of type {} is {} solid{} when a run began: delete it and create another in its place", atom->tag[i],
                 atom->type[i], solid ? "a" : "no", solid ? " now and was none" : " any more, as it was");
    if (!solid) first = FOREIGN;
  }
  bool yields = false;
  for (const auto &s : hub->state) yields = yields || s.yield > 0.0;
  if (comm->me == 0 && plastic && !yields)
    error->warning(FLERR, "Fix fsi/stress plastic has nothing to act on: no material has a yield stress");
  if (comm->me == 0 && yields && !plastic)
    error->warning(FLERR, "A material has a yield stress, but stays elastic: fix fsi/stress lacks keyword plastic");
}

/* ----------------------------------------------------------------------
   sigma_zz of plane strain is -p - (S_xx + S_yy), of plane stress 0
------------------------------------------------------------------------- */

double FixFSIStress::von_mises(int i, double p) const
{
  const double *s = stress[i];
  if (ns == 6) return sqrt(1.5 * FSI::Sym<3>::load(s).squared());
  double szz = -(s[0] + s[1]), mean = 0.0;
  if (plane_stress) {
    szz = p;    // deviator about the in-plane mean -p
    mean = p / 3.0;
  }
  const double a = s[0] - mean, b = s[1] - mean, c = szz - mean;
  return sqrt(1.5 * (a * a + b * b + c * c + 2.0 * s[2] * s[2]));
}

/* ---------------------------------------------------------------------- */

void FixFSIStress::grow_arrays(int nmax)
{
  memory->grow(stress, nmax, n, "fsi/stress:stress");
}

void FixFSIStress::copy_arrays(int i, int j, int)
{
  memcpy(stress[j], stress[i], n * sizeof(double));
}

void FixFSIStress::set_arrays(int i)
{
  memset(stress[i], 0, n * sizeof(double));
}

int FixFSIStress::pack_exchange(int i, double *buf)
{
  memcpy(buf, stress[i], n * sizeof(double));
  return n;
}

int FixFSIStress::unpack_exchange(int i, double *buf)
{
  memcpy(stress[i], buf, n * sizeof(double));
  return n;
}

int FixFSIStress::pack_restart(int i, double *buf)
{
  buf[0] = n + 1;
  memcpy(buf + 1, stress[i], n * sizeof(double));
  return n + 1;
}

void FixFSIStress::unpack_restart(int i, int nth)
{
  memcpy(stress[i], FixFSI::restart_values(atom->extra[i], nth), n * sizeof(double));
}

int FixFSIStress::size_restart(int)
{
  return n + 1;
}

int FixFSIStress::maxsize_restart()
{
  return n + 1;
}

double FixFSIStress::memory_usage()
{
  return (double) atom->nmax * n * sizeof(double);
}
