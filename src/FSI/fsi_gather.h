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

// What all ranks have, on each of them.

#ifndef LMP_FSI_GATHER_H
#define LMP_FSI_GATHER_H

#include "atom.h"
#include "exceptions.h"
#include "fmt/format.h"

#include <algorithm>
#include <mpi.h>
#include <set>
#include <type_traits>
#include <vector>

namespace LAMMPS_NS::FSI {

// the elements of all ranks, in the order of the ranks; T: anything without pointers
template <class T> inline std::vector<T> gather(const std::vector<T> &local, MPI_Comm world)
{
  static_assert(std::is_trivially_copyable<T>::value, "elements are sent as bytes");
  int nprocs;
  bigint n = local.size() * sizeof(T), total = 0;
  MPI_Comm_size(world, &nprocs);
  std::vector<bigint> bytes(nprocs);
  MPI_Allgather(&n, 1, MPI_LMP_BIGINT, bytes.data(), 1, MPI_LMP_BIGINT, world);
  std::vector<int> count, first;
  for (const bigint b : bytes) {
    first.push_back((int) total);
    count.push_back((int) b);
    total += b;
  }
  // what grows without end has no place on every rank, and MPI counts in int
  if (total > MAXSMALLINT)
    throw LAMMPSException(fmt::format("Package FSI: {} elements of {} bytes on every rank, more "
                                      "than 2 GB",
                                      total / sizeof(T), sizeof(T)));
  std::vector<T> all(total / sizeof(T));
  MPI_Allgatherv(const_cast<T *>(local.data()), (int) n, MPI_BYTE, all.data(), count.data(),
                 first.data(), MPI_BYTE, world);
  return all;
}

inline std::set<tagint> gather(const std::set<tagint> &local, MPI_Comm world)
{
  const auto all = gather(std::vector<tagint>(local.begin(), local.end()), world);
  return {all.begin(), all.end()};
}

// what the rank has whose key is the least; T: anything without pointers
template <class T> inline T of_least(double key, T local, MPI_Comm world)
{
  static_assert(std::is_trivially_copyable<T>::value, "it is sent as bytes");
  struct {
    double key;
    int rank;
  } here = {key, 0}, least;
  MPI_Comm_rank(world, &here.rank);
  MPI_Allreduce(&here, &least, 1, MPI_DOUBLE_INT, MPI_MINLOC, world);
  MPI_Bcast(&local, sizeof(T), MPI_BYTE, least.rank, world);
  return local;
}

// of numbers on all ranks the sum, the largest or the least, place by place
template <class T> std::vector<T> over_ranks(std::vector<T> numbers, MPI_Op what, MPI_Comm world)
{
  static_assert(std::is_same_v<T, double> || std::is_integral_v<T>);
  const MPI_Datatype type = std::is_same_v<T, double> ? MPI_DOUBLE
      : std::is_same_v<T, bigint>                     ? MPI_LMP_BIGINT
      : std::is_same_v<T, char>                       ? MPI_CHAR
                                                      : MPI_INT;
  MPI_Allreduce(MPI_IN_PLACE, numbers.data(), (int) numbers.size(), type, what, world);
  return numbers;
}
template <class T> T over_ranks(T number, MPI_Op what, MPI_Comm world)
{
  return over_ranks(std::vector<T>{number}, what, world)[0];
}

// is it so on any of them?
inline bool anywhere(bool local, MPI_Comm world)
{
  return over_ranks((int) local, MPI_MAX, world);
}

inline double sum_of(double local, MPI_Comm world)
{
  return over_ranks(local, MPI_SUM, world);
}

inline bigint count_of(bigint local, MPI_Comm world)
{
  return over_ranks(local, MPI_SUM, world);
}

// the largest limit between low and high that at most n keys of all ranks are below
inline double limit_of(const std::vector<double> &key, double n, double low, double high,
                       MPI_Comm world)
{
  for (int k = 0; k < 80; k++) {
    const double middle = 0.5 * (low + high);
    const bigint below = std::count_if(key.begin(), key.end(), [middle](double number) {
      return number < middle;
    });
    (count_of(below, world) > n ? high : low) = middle;
  }
  return low;
}

// how many particles there are that is(i) holds for, and the least of their tags
struct Found {
  bigint count = 0;
  tagint first = MAXTAGINT;
};

inline Found total_of(Found local, MPI_Comm world)
{
  return {count_of(local.count, world), over_ranks(local.first, MPI_MIN, world)};
}

template <class Is> inline Found find_particles(const Atom *atom, MPI_Comm world, Is is)
{
  Found local;
  for (int i = 0; i < atom->nlocal; i++)
    if (is(i)) {
      local.count++;
      local.first = std::min(local.first, atom->tag[i]);
    }
  return total_of(local, world);
}

}    // namespace LAMMPS_NS::FSI

#endif
