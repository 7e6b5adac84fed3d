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

#include "pair_fsi_fluid_omp.h"

#include "fsi_pair_laws.h"
#include "fsi_pair_sets.h"
#include "fsi_rows_omp.h"

using namespace LAMMPS_NS;
using namespace FSI;

namespace {

void add(const PairSums &one, PairSums &all)
{
  all.artificial += one.artificial;
  all.laminar += one.laminar;
  all.coupling += one.coupling;
  all.walls += one.walls;
  all.diffusion += one.diffusion;
  all.guard += one.guard;
  for (int d = 0; d < 6; d++) all.virial[d] += one.virial[d];
}

// the loops of the plain style, each thread over a part of the rows
class ThreadedLoops : public FluidLoops {
  using Rows = std::vector<Row>;
  const std::shared_ptr<FluidLoops> loops;
  const std::shared_ptr<RowThreads> threads;
  const int dim;
  mutable std::vector<Rows> parts;

  int width_of_shift(bool fills) const
  {
    return dim == 2 ? Shift<2>::row(fills) : Shift<3>::row(fills);
  }

  // loop(k, rows of part k, to)
  template <size_t N, class Loop>
  void run(const Rows &rows, int nlocal, const RowThreads::Sums (&sums)[N], Loop loop) const
  {
    parts.resize(threads->most());
    const auto touched = [=](const Row *begin, const Row *end) {
      return touched_by(begin, end, nlocal);
    };
    threads->run(rows.data(), rows.size(), false, touched, sums,
                 [&](int k, int first, int last, double *const *to) {
                   const bool all = last - first == (int) rows.size();
                   if (!all) parts[k].assign(rows.begin() + first, rows.begin() + last);
                   loop(k, all ? rows : parts[k], to);
                 });
  }

 public:
  ThreadedLoops(std::shared_ptr<FluidLoops> of, std::shared_ptr<RowThreads> by, int dim_in) :
      loops(std::move(of)), threads(std::move(by)), dim(dim_in)
  {
  }

  // the first part has the sums of the caller, as it has the arrays
  void rates(PairKind kind, const Rows &rows, const Mirror *mirror, const FluidParticles &in,
             const RateLaws &laws, double *rate, double *shift, PairSums *sums,
             Rows *near) const override
  {
    std::vector<PairSums> powers(threads->most());
    std::vector<Rows> close(threads->most());
    run(rows, in.nlocal, {{rate, 1}, {shift, width_of_shift(laws.fills)}},
        [&](int k, const Rows &part, double *const *to) {
          loops->rates(kind, part, mirror, in, laws, to[0], to[1], k && sums ? &powers[k] : sums,
                       k && near ? &close[k] : near);
        });
    for (const PairSums &one : powers)
      if (sums) add(one, *sums);
    for (const Rows &one : close)
      if (near) near->insert(near->end(), one.begin(), one.end());
  }

  void forces(PairKind kind, const Rows &rows, const Mirror *mirror, const FluidParticles &in,
              const ForceLaws &laws, double *force, double *total, PairSums *sums) const override
  {
    std::vector<PairSums> powers(threads->most());
    std::vector<std::array<double, 3>> totals(threads->most(), {0.0, 0.0, 0.0});
    run(rows, in.nlocal,
        {{force, row_of_forces(dim)}, {mirror ? nullptr : laws.taken, row_of_points(dim)}},
        [&](int k, const Rows &part, double *const *to) {
          ForceLaws own = laws;
          own.taken = to[1];
          loops->forces(kind, part, mirror, in, own, to[0], k ? totals[k].data() : total,
                        k && sums ? &powers[k] : sums);
        });
    for (const PairSums &one : powers)
      if (sums) add(one, *sums);
    for (const auto &one : totals)
      for (int d = 0; d < dim && total; d++) total[d] += one[d];
  }

  void shifts(PairKind kind, const Rows &rows, const Mirror *mirror, const FluidParticles &in,
              double wdx, double *shift) const override
  {
    run(rows, in.nlocal, {{shift, width_of_shift(false)}},
        [&](int, const Rows &part, double *const *to) {
          loops->shifts(kind, part, mirror, in, wdx, to[0]);
        });
  }

  void number_density(PairKind kind, const Rows &rows, bool both, const Mirror *mirror,
                      const FluidParticles &in, const double (*x)[3], double *sum) const override
  {
    run(rows, in.nlocal, {{sum, 1}}, [&](int, const Rows &part, double *const *to) {
      loops->number_density(kind, part, both, mirror, in, x, to[0]);
    });
  }

  void position_divergence(const Rows &rows, bool both, const Mirror *mirror,
                           const FluidParticles &in, const double (*x)[3], const double *vol,
                           double *sum) const override
  {
    run(rows, in.nlocal, {{sum, 1}}, [&](int, const Rows &part, double *const *to) {
      loops->position_divergence(part, both, mirror, in, x, vol, to[0]);
    });
  }
};

}    // namespace

PairFSIFluidOMP::PairFSIFluidOMP(LAMMPS *lmp) : PairFSIFluid(lmp), threads(new RowThreads(lmp)) {}

PairFSIFluidOMP::~PairFSIFluidOMP() = default;

void PairFSIFluidOMP::init_style()
{
  PairFSIFluid::init_style();
  for (PairSet &set : pairs.sets)
    for (auto *const loops : {&set.loops, &set.of_forces})
      *loops = std::make_shared<ThreadedLoops>(*loops, threads, disc->dim);
}

double PairFSIFluidOMP::memory_usage()
{
  return PairFSIFluid::memory_usage() + threads->memory_usage();
}
