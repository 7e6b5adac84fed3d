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

  // loop(k, pairs of part k, to)
  template <size_t N, class Loop>
  void run(const FluidPairs &pairs, const RowThreads::Sums (&sums)[N], Loop loop) const
  {
    const Row *const rows = pairs.rows.first;
    threads.run(rows, pairs.rows.size(), false, reach, sums,
                [&](int k, int first, int last, double *const *to) {
                  FluidPairs part = pairs;
                  part.rows = {rows + first, rows + last};
                  loop(k, part, to);
                });
  }

 public:
  ThreadedLoops(std::shared_ptr<FluidLoops> of, RowThreads &by, const Reach &of_rows, int D) :
      loops(std::move(of)), threads(by), reach(of_rows), dim(D)
  {
  }

  // the first part has the sums of the caller, as it has the arrays
  void rates(const FluidPairs &pairs, const RateLaws &laws, double *rate, double *shift,
             PairSums *sums, std::vector<Row> *near) const override
  {
    std::vector<PairSums> powers(threads.most());
    close.resize(threads.most());
    for (auto &of_part : close) of_part.clear();
    run(pairs, {{rate, 1}, {shift, width_of_shift(laws.fills)}},
        [&](int k, const FluidPairs &part, double *const *to) {
          loops->rates(part, laws, to[0], to[1], k && sums ? &powers[k] : sums,
                       k && near ? &close[k] : near);
        });
    for (const PairSums &one : powers)
      if (sums) sums->add(one);
    for (const auto &of_part : close)
      if (near) near->insert(near->end(), of_part.begin(), of_part.end());
  }

  void forces(const FluidPairs &pairs, const ForceLaws &laws, double *force, double *total,
              PairSums *sums) const override
  {
    std::vector<PairSums> powers(threads.most());
    std::vector<std::array<double, 3>> totals(threads.most(), {0.0, 0.0, 0.0});
    run(pairs, {{force, row_of_forces(dim)}, {laws.taken, row_of_points(dim)}},
        [&](int k, const FluidPairs &part, double *const *to) {
          ForceLaws own = laws;
          own.taken = to[1];
          loops->forces(part, own, to[0], k ? totals[k].data() : total,
                        k && sums ? &powers[k] : sums);
        });
    for (const PairSums &one : powers)
      if (sums) sums->add(one);
    for (const auto &one : totals)
      for (int d = 0; d < dim; d++) total[d] += one[d];
  }

  void shifts(const FluidPairs &pairs, double *shift) const override
  {
    run(pairs, {{shift, width_of_shift(false)}},
        [&](int, const FluidPairs &part, double *const *to) {
          loops->shifts(part, to[0]);
        });
  }

  void distances(const FluidPairs &pairs, bool both, const double (*x)[3], const double *vol,
                 double *sum) const override
  {
    run(pairs, {{sum, 1}}, [&](int, const FluidPairs &part, double *const *to) {
      loops->distances(part, both, x, vol, to[0]);
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
