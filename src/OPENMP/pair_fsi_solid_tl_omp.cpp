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

#include "pair_fsi_solid_tl_omp.h"

#include "fsi_bond_rows.h"
#include "fsi_rows_omp.h"

using namespace LAMMPS_NS;
using namespace FSI;

PairFSISolidTLOMP::PairFSISolidTLOMP(LAMMPS *lmp) :
    PairFSISolidTL(lmp), of_all(new RowThreads(lmp)), of_moving(new RowThreads(lmp))
{
}

PairFSISolidTLOMP::~PairFSISolidTLOMP() = default;

void PairFSISolidTLOMP::find_rows()
{
  PairFSISolidTL::find_rows();
  of_all->forget();
  of_moving->forget();
}

// Solids are spread among the fluid: ranges end where a gap begins that costs more than a new one
static std::vector<Span> touched_by(const BondRow *rows, const BondRow *end)
{
  static constexpr int GAP = 8;
  std::vector<char> marked;
  const auto mark = [&](int i) {
    if (i >= (int) marked.size()) marked.resize(2 * i + 1);
    marked[i] = 1;
  };
  for (const BondRow *row = rows; row != end; row++) {
    mark(row->i);
    std::for_each(row->partner, row->partner + whole_blocks(row->n), mark);
  }
  std::vector<Span> found;
  for (int i = 0; i < (int) marked.size(); i++) {
    if (!marked[i]) continue;
    if (found.empty() || i >= found.back().last + GAP) found.push_back({i, i});
    found.back().last = i + 1;
  }
  return found;
}

void PairFSISolidTLOMP::over_rows(int n, double *to, int width, BondSums &sums, const RowLoop &loop)
{
  RowThreads &threads = n == (int) rows.size() ? *of_all : *of_moving;
  std::vector<BondSums> own(threads.most());
  const RowThreads::Sums to_add[] = {{to, width}};
  threads.run(
      rows.data(), n, true,
      [](const BondRow *begin, const BondRow *end) {
        return touched_by(begin, end);
      },
      to_add,
      [&](int k, int first, int last, double *const *part) {
        loop(first, last, part[0], k ? own[k] : sums);
      });
  for (const BondSums &one : own) {
    sums.energy += one.energy;
    sums.artificial += one.artificial;
    for (int d = 0; d < 6; d++) sums.virial[d] += one.virial[d];
    if (one.inverted >= 0) sums.inverted = one.inverted;
  }
}

double PairFSISolidTLOMP::memory_usage()
{
  return PairFSISolidTL::memory_usage() + of_all->memory_usage() + of_moving->memory_usage();
}
