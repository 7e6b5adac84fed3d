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

// Loops over rows, cut among the threads of a rank. The first thread adds to the arrays of the
// caller, the others to their own, which are added in the order of threads: sums depend on the rows
// and on the number of threads alone, and with one thread they are the plain style's.
//
// These pair styles need the compiler's OpenMP, not LAMMPS' package. They do not set Suffix::OMP:
// fix omp takes the last style that does for the one that adds up the forces of all (ThrOMP).

#ifndef LMP_FSI_ROWS_OMP_H
#define LMP_FSI_ROWS_OMP_H

#include "comm.h"
#include "fsi_rows.h"
#include "pointers.h"

#include <algorithm>
#include <climits>
#include <exception>
#include <vector>

namespace LAMMPS_NS::FSI {

// calls f(k) for k below n, each in a thread; what one throws goes on to the caller
template <class F> void in_threads(int n, F f)
{
  std::vector<std::exception_ptr> thrown(n);
#if defined(_OPENMP)
#pragma omp parallel for num_threads(n) schedule(static, 1) if (n > 1)
#endif
  for (int k = 0; k < n; k++) {
    try {
      f(k);
    } catch (...) {
      thrown[k] = std::current_exception();
    }
  }
  for (const auto &what : thrown)
    if (what) std::rethrow_exception(what);
}

inline int threads_of(const Comm *comm)
{
#if defined(_OPENMP)
  return comm->nthreads;
#else
  return comm != nullptr;
#endif
}

// particles [first, last)
struct Span {
  int first, last;
  int size() const { return std::max(0, last - first); }
  void add(const Span &o) { *this = {std::min(first, o.first), std::max(last, o.last)}; }
};
constexpr Span NOTHING = {INT_MAX, 0};

class RowThreads : protected Pointers {
 public:
  // what is added to: so many numbers per particle; null and 0: nothing
  struct Sums {
    double *to;
    int width;
  };

  explicit RowThreads(LAMMPS *lmp) : Pointers(lmp) {}
  int most() const { return threads_of(comm); }
  void forget() { first.clear(); }

  // Calls loop(k, first, last, to) for part k of the rows, to what its sums go to. known: these
  // are the rows of the last call since forget(); else touched(begin, end) has the ranges that
  // rows add to.
  template <class R, size_t N, class Touched, class Loop>
  void run(const R *rows, int nrows, bool known, Touched touched, const Sums (&sums)[N], Loop loop)
  {
    if (!known || first.empty() || asked != most()) cut(rows, nrows, touched);
    const int n = first.size() - 1;
    in_threads(n, [&](int k) {
      double *to[N];
      for (size_t a = 0; a < N; a++) to[a] = k ? parts[k].zeros(a, sums[a]) : sums[a].to;
      loop(k, first[k], first[k + 1], to);
    });
    if (n == 1) return;
    in_threads(n, [&](int s) {
      for (size_t a = 0; a < N; a++)
        if (sums[a].to) add(s, n, a, sums[a]);
    });
  }

  double memory_usage() const
  {
    double numbers = 0.0;
    for (const Part &part : parts)
      for (const auto &own : part.sums) numbers += own.capacity();
    return numbers * sizeof(double);
  }

 private:
  struct Part {
    std::vector<Span> touched;
    std::vector<double> sums[2];
    double *zeros(int a, const Sums &of)
    {
      if (!of.to) return nullptr;
      Span all = NOTHING;
      for (const Span &r : touched) all.add(r);
      if (sums[a].size() < (size_t) of.width * all.last)
        sums[a].resize((size_t) of.width * (all.last + all.last / 8));
      for (const Span &r : touched)
        for (size_t q = (size_t) of.width * r.first; q < (size_t) of.width * r.last; q++)
          sums[a][q] = 0.0;
      return sums[a].data();
    }
  };
  std::vector<int> first;    // row of each part, and the number of rows
  int asked = 0;
  std::vector<Part> parts;

  // Into parts with about as many pairs each, by a sample of the rows; in one where there are few
  // pairs, or where more would be to add up than is in the loops
  template <class R, class Touched> void cut(const R *rows, int nrows, Touched touched)
  {
    static constexpr bigint FEW = 1000, PER_PARTICLE = 4;
    const int every = 1 + nrows / 8192;
    bigint pairs = 0, before = 0, more = 0;
    for (int r = 0; r < nrows; r += every) pairs += every * rows[r].n;
    asked = most();
    const int n = pairs < FEW ? 1 : asked;
    first = {0};
    for (int r = 0; r < nrows; r += every) {
      while ((int) first.size() < n && before * n >= pairs * (bigint) first.size())
        first.push_back(r);
      before += every * rows[r].n;
    }
    first.resize(n, nrows);
    first.push_back(nrows);
    if ((int) parts.size() < n) parts.resize(n);
    if (n == 1) return;
    in_threads(n, [&](int k) {
      if (k) parts[k].touched = touched(rows + first[k], rows + first[k + 1]);
    });
    for (int k = 1; k < n; k++)
      for (const Span &r : parts[k].touched) more += r.size();
    if (PER_PARTICLE * more > pairs) first = {0, nrows};
  }

  // slice s of n of all that is touched
  void add(int s, int n, int a, const Sums &sums) const
  {
    Span all = NOTHING;
    for (int k = 1; k < n; k++)
      for (const Span &r : parts[k].touched) all.add(r);
    const auto cut_at = [&](int of) {
      return all.first + (int) ((bigint) all.size() * of / n);
    };
    const int begin = cut_at(s), end = cut_at(s + 1);
    for (int k = 1; k < n; k++)
      for (const Span &r : parts[k].touched) {
        const size_t last = (size_t) std::min(r.last, end) * sums.width;
        for (size_t q = (size_t) std::max(r.first, begin) * sums.width; q < last; q++)
          sums.to[q] += parts[k].sums[a][q];
      }
  }
};

}    // namespace LAMMPS_NS::FSI

#endif
