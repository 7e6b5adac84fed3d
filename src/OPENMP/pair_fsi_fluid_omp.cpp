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

#include "atom.h"
#include "fsi_pair_laws.h"
#include "fsi_pair_sets.h"
#include "fsi_rows_omp.h"
#include "modify.h"
#include "neighbor.h"

#if __has_include("fix_omp.h")
#include "fix_omp.h"
#endif

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

// What rows add to, found in advance: looking at all neighbors takes a quarter of the time of a
// loop. From the lowest to the highest local particle, and ghost, by blocks of particles that have
// rows. Loops go over the rows of a set, a part of each, or images of these pairs.
class Reach {
  static constexpr int BLOCK = 64;
  std::vector<std::array<Span, 2>> of_block;

 public:
  // rows: in the order of their particles, those of a block in one thread
  void find(const std::vector<Row> &rows, int nlocal, int nall, int nthreads)
  {
    of_block.assign(nall / BLOCK + 1, {NOTHING, NOTHING});
    const size_t n = rows.size();
    const auto first_of = [&](int k) {
      size_t r = n * k / nthreads;
      while (0 < r && r < n && rows[r].i / BLOCK == rows[r - 1].i / BLOCK) r++;
      return r;
    };
    in_threads(nthreads, [&](int k) {
      for (size_t r = first_of(k), end = first_of(k + 1); r < end; r++) find(rows[r], nlocal);
    });
  }
  std::vector<Span> operator()(const Row *rows, const Row *end) const
  {
    std::array<Span, 2> found = {NOTHING, NOTHING};
    for (int last = -1; rows != end; last = rows++->i / BLOCK)
      for (int k = 0; k < 2 && rows->i / BLOCK != last; k++)
        found[k].add(of_block[rows->i / BLOCK][k]);
    return {found.begin(), found.end()};
  }

 private:
  void find(const Row &row, int nlocal)
  {
    Span here = NOTHING, ghosts = NOTHING;
    const auto touch = [&](int j) {    // without branches
      here.add({j < nlocal ? j : INT_MAX, j < nlocal ? j + 1 : 0});
      ghosts.add({j < nlocal ? INT_MAX : j, j < nlocal ? 0 : j + 1});
    };
    touch(row.i);
    for (int k = 0; k < row.n; k++) touch(row.j[k]);
    of_block[row.i / BLOCK][0].add(here);
    of_block[row.i / BLOCK][1].add(ghosts);
  }
};

// the loops of the plain style, each thread over a part of the rows
class ThreadedLoops : public FluidLoops {
  const std::shared_ptr<FluidLoops> loops;
  RowThreads &threads;
  const Reach &reach;
  const int dim;
  mutable std::vector<std::vector<Row>> close;    // near rows of all parts but the first

  int width_of_shift(bool fills) const
  {
    return dim == 2 ? Shift<2>::row(fills) : Shift<3>::row(fills);
  }

  // loop(k, rows of part k, to)
  template <size_t N, class Loop>
  void run(const RowSpan rows, const RowThreads::Sums (&sums)[N], Loop loop) const
  {
    threads.run(rows.first, rows.size(), false, reach, sums,
                [&](int k, int first, int last, double *const *to) {
                  loop(k, RowSpan(rows.first + first, rows.first + last), to);
                });
  }

 public:
  ThreadedLoops(std::shared_ptr<FluidLoops> of, RowThreads &by, const Reach &of_rows, int D) :
      loops(std::move(of)), threads(by), reach(of_rows), dim(D)
  {
  }

  // the first part has the sums of the caller, as it has the arrays
  void rates(PairKind kind, const RowSpan rows, const Mirror *mirror, const FluidParticles &in,
             const RateLaws &laws, double *rate, double *shift, PairSums *sums,
             std::vector<Row> *near) const override
  {
    std::vector<PairSums> powers(threads.most());
    close.resize(threads.most());
    for (auto &of_part : close) of_part.clear();
    run(rows, {{rate, 1}, {shift, width_of_shift(laws.fills)}},
        [&](int k, const RowSpan part, double *const *to) {
          loops->rates(kind, part, mirror, in, laws, to[0], to[1], k && sums ? &powers[k] : sums,
                       k && near ? &close[k] : near);
        });
    for (const PairSums &one : powers)
      if (sums) add(one, *sums);
    for (const auto &of_part : close)
      if (near) near->insert(near->end(), of_part.begin(), of_part.end());
  }

  void forces(PairKind kind, const RowSpan rows, const Mirror *mirror, const FluidParticles &in,
              const ForceLaws &laws, double *force, double *total, PairSums *sums) const override
  {
    std::vector<PairSums> powers(threads.most());
    std::vector<std::array<double, 3>> totals(threads.most(), {0.0, 0.0, 0.0});
    run(rows, {{force, row_of_forces(dim)}, {mirror ? nullptr : laws.taken, row_of_points(dim)}},
        [&](int k, const RowSpan part, double *const *to) {
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

  void shifts(PairKind kind, const RowSpan rows, const Mirror *mirror, const FluidParticles &in,
              double *shift) const override
  {
    run(rows, {{shift, width_of_shift(false)}}, [&](int, const RowSpan part, double *const *to) {
      loops->shifts(kind, part, mirror, in, to[0]);
    });
  }

  void number_density(PairKind kind, const RowSpan rows, bool both, const Mirror *mirror,
                      const FluidParticles &in, const double (*x)[3], double *sum) const override
  {
    run(rows, {{sum, 1}}, [&](int, const RowSpan part, double *const *to) {
      loops->number_density(kind, part, both, mirror, in, x, to[0]);
    });
  }

  void position_divergence(const RowSpan rows, bool both, const Mirror *mirror,
                           const FluidParticles &in, const double (*x)[3], const double *vol,
                           double *sum) const override
  {
    run(rows, {{sum, 1}}, [&](int, const RowSpan part, double *const *to) {
      loops->position_divergence(part, both, mirror, in, x, vol, to[0]);
    });
  }
};

}    // namespace

struct PairFSIFluidOMP::Members {
  RowThreads threads;
  std::vector<Reach> of_sets;
};

PairFSIFluidOMP::PairFSIFluidOMP(LAMMPS *lmp) :
    PairFSIFluid(lmp), members(new Members{RowThreads(lmp), {}})
{
}

PairFSIFluidOMP::~PairFSIFluidOMP() = default;

void PairFSIFluidOMP::init_style()
{
  PairFSIFluid::init_style();
  members->of_sets.resize(pairs.sets.size());
  for (size_t k = 0; k < pairs.sets.size(); k++)
    for (auto *const loops : {&pairs.sets[k].loops, &pairs.sets[k].of_forces})
      *loops =
          std::make_shared<ThreadedLoops>(*loops, members->threads, members->of_sets[k], disc->dim);
  step->threads = [lmp = lmp](int n, const std::function<void(int, int)> &loop) {
    const int parts = threads_of(lmp->comm);
    in_threads(parts, [&](int k) {
      loop((bigint) n * k / parts, (bigint) n * (k + 1) / parts);
    });
  };
}

// Fix omp, which comes first, did not see the request of the style beside others.
void PairFSIFluidOMP::set_fields(Discretization &of_run)
{
  PairFSIFluid::set_fields(of_run);
#if __has_include("fix_omp.h")
  const auto *const fix = static_cast<FixOMP *>(modify->get_fix_by_id("package_omp"));
  if (fix) neighbor->set_omp_neighbor(fix->get_neighbor());
#endif
}

void PairFSIFluidOMP::begin_state(bool advance)
{
  PairFSIFluid::begin_state(advance);
  if (neighbor->ago) return;
  for (size_t k = 0; k < pairs.sets.size(); k++)
    members->of_sets[k].find(pairs.sets[k].rows.rows, atom->nlocal, atom->nlocal + atom->nghost,
                             members->threads.most());
}

double PairFSIFluidOMP::memory_usage()
{
  return PairFSIFluid::memory_usage() + members->threads.memory_usage();
}
