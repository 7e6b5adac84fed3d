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

// The FSI packages as a plugin: every style of src/FSI, src/FSI-CLASSIC and src/OPENMP, for a LAMMPS without.

#include "lammpsplugin.h"

#include "atom.h"
#include "atom_vec_fsi.h"
#include "comm.h"
#include "compute_fsi_atom.h"
#include "compute_fsi_energy.h"
#include "compute_fsi_force.h"
#include "compute_fsi_probe.h"
#include "fix_fsi.h"
#include "fix_fsi_dt.h"
#include "fix_fsi_inlet.h"
#include "fix_fsi_move.h"
#include "fix_fsi_reference.h"
#include "fix_fsi_refine.h"
#include "fix_fsi_report.h"
#include "fix_fsi_spectrum.h"
#include "fix_fsi_stream.h"
#include "fix_fsi_stress.h"
#include "fix_fsi_wall_mirror.h"
#include "fix_fsi_wall_particle.h"
#include "fix_fsi_watch.h"
#include "fsi_commands.h"
#include "lammps.h"
#include "library.h"
#include "pair_fsi_fluid_omp.h"
#include "pair_fsi_grain.h"
#include "pair_fsi_solid.h"
#include "pair_fsi_solid_tl_omp.h"
#include "utils.h"
#include "version.h"

#include <cstring>
#include <string>

using namespace LAMMPS_NS;

namespace {

template <class T> void *create(void *lmp)
{
  return new T((LAMMPS *) lmp);
}

template <class T> void *create_with_arguments(void *lmp, int narg, char **arg)
{
  return new T((LAMMPS *) lmp, narg, arg);
}

AtomVec *create_atom_vec(LAMMPS *lmp)
{
  return new AtomVecFSI(lmp);
}

// Why this plugin cannot work in this LAMMPS; empty if it can. Objects of both are laid out by the same headers, or nothing works.
std::string misfit(LAMMPS *lmp)
{
  static const char built_for[] = LAMMPS_VERSION;
  if (strcmp(built_for, lmp->version) != 0)
    return fmt::format("it was compiled for LAMMPS version {}, this is version {}: compile it with the sources of this LAMMPS",
                       built_for, lmp->version);
  const auto differs = [lmp](const char *type, size_t size) { return lammps_extract_setting(lmp, type) != (int) size; };
  if (differs("bigint", sizeof(bigint)) || differs("tagint", sizeof(tagint)) || differs("imageint", sizeof(imageint)))
    return "it was compiled with integers of other sizes than this LAMMPS: compile it with the same -DLAMMPS_SIZES";
#if defined(MPI_STUBS)
  const int mpi = 0;
#else
  const int mpi = sizeof(MPI_Comm);    // LAMMPS' answer, which also tells Open MPI from MPICH
#endif
  if (lammps_config_has_mpi_support() != mpi)
    return "it was compiled with another MPI than this LAMMPS: compile it with the same MPI, or both without";
  const auto atom_style = lmp->atom->avec_map->find("fsi");
  if (atom_style != lmp->atom->avec_map->end() && atom_style->second != &create_atom_vec)
    return "this LAMMPS has the FSI package compiled in";
  return "";
}

}    // namespace

extern "C" void lammpsplugin_init(void *ptr, void *handle, void *regfunc)
{
  auto *lmp = (LAMMPS *) ptr;
  const std::string why = misfit(lmp);
  if (!why.empty()) {
    if (lmp->comm->me == 0) utils::logmesg(lmp, "FSI plugin not loaded: {}\n", why);
    return;
  }

  // LAMMPS' plugins have no atom styles, but its map of them is open. It is that of this Atom: the command clear makes a new
  // one, and loading the plugin again enters the style again. The library itself stays mapped (linked with -z nodelete).
  (*lmp->atom->avec_map)["fsi"] = &create_atom_vec;

  auto enter = (lammpsplugin_regfunc) regfunc;
  lammpsplugin_t plugin;
  plugin.version = LAMMPS_VERSION;
  plugin.author = "the FSI package";
  plugin.handle = handle;

  const auto one = [&](const char *kind, const char *name, lammpsplugin_factory1 *creator) {
    plugin.style = kind;
    plugin.name = plugin.info = name;
    plugin.creator.v1 = creator;
    enter(&plugin, lmp);
  };
  const auto two = [&](const char *kind, const char *name, lammpsplugin_factory2 *creator) {
    plugin.style = kind;
    plugin.name = plugin.info = name;
    plugin.creator.v2 = creator;
    enter(&plugin, lmp);
  };
  // pair styles first: they are unloaded in this order, and use the fixes until they go
  one("pair", "fsi/fluid", &create<PairFSIFluid>);
  one("pair", "fsi/fluid/omp", &create<PairFSIFluidOMP>);
  one("pair", "fsi/grain", &create<PairFSIGrain>);
  one("pair", "fsi/solid", &create<PairFSISolid>);
  one("pair", "fsi/solid/tl", &create<PairFSISolidTL>);
  one("pair", "fsi/solid/tl/omp", &create<PairFSISolidTLOMP>);
  two("compute", "fsi/atom", &create_with_arguments<ComputeFSIAtom>);
  two("compute", "fsi/energy", &create_with_arguments<ComputeFSIEnergy>);
  two("compute", "fsi/force", &create_with_arguments<ComputeFSIForce>);
  two("compute", "fsi/probe", &create_with_arguments<ComputeFSIProbe>);
  two("compute", "fsi/surface/atom", &create_with_arguments<ComputeFSISurfaceAtom>);
  two("fix", "fsi/spectrum", &create_with_arguments<FixFSISpectrum>);
  two("fix", "fsi/wall/mirror", &create_with_arguments<FixFSIWallMirror>);
  two("fix", "fsi/wall/particle", &create_with_arguments<FixFSIWallParticle>);
  two("fix", "fsi/watch", &create_with_arguments<FixFSIWatch>);
  two("fix", "fsi/dt", &create_with_arguments<FixFSIDt>);
  two("fix", "fsi/inlet", &create_with_arguments<FixFSIInlet>);
  two("fix", "fsi/outlet", &create_with_arguments<FixFSIInlet>);
  two("fix", "fsi/move", &create_with_arguments<FixFSIMove>);
  two("fix", "fsi/stream", &create_with_arguments<FixFSIStream>);
  two("fix", "fsi/refine", &create_with_arguments<FixFSIRefine>);
  two("fix", "fsi/report", &create_with_arguments<FixFSIReport>);
  two("fix", "fsi/stress", &create_with_arguments<FixFSIStress>);
  two("fix", "FSI_REFERENCE", &create_with_arguments<FixFSIReference>);
  two("fix", "FSI_HISTORY", &create_with_arguments<FixFSIHistory>);
  two("fix", "fsi", &create_with_arguments<FixFSI>);
  one("command", "fsi/clamp", &create<FSIClamp>);
  one("command", "fsi/displace", &create<FSIDisplace>);
  one("command", "fsi/dump", &create<FSIDump>);
  one("command", "fsi/material", &create<FSIMaterial>);
  one("command", "fsi/pack", &create<FSIPack>);
  one("command", "fsi/run", &create<FSIRun>);
  one("command", "fsi/set", &create<FSISet>);
}
