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

#include "fsi_nodes.h"

#include "domain.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace FSI;

Nodes::Nodes(LAMMPS *lmp) :
    Pointers(lmp),
    nlateral(1), lateral{0, 0}, distance{1.0, 1.0}, first{0, 0}, count{1, 1}, periodic{false,
                                                                                       false},
    nsum(0), nlargest(0), ranks(MPI_COMM_NULL)
{
}

void Nodes::place(int axis, double spacing)
{
  nlateral = 0;
  first[1] = 0;    // in 2D
  count[1] = 1;
  periodic[1] = false;
  for (int d = 0; d < domain->dimension; d++) {
    if (d == axis) continue;
    const int k = nlateral++;
    lateral[k] = d;
    periodic[k] = domain->periodicity[d];
    if (periodic[k]) {
      count[k] = std::max(1, static_cast<int>(std::round(domain->prd[d] / spacing)));
      distance[k] = domain->prd[d] / count[k];
      first[k] = 0;
    } else {
      distance[k] = spacing;
      first[k] = static_cast<int>(std::floor(domain->boxlo[d] / spacing)) - 1;
      count[k] = static_cast<int>(std::ceil(domain->boxhi[d] / spacing)) + 2 - first[k];
    }
  }
  if (nlateral == 1) distance[1] = distance[0];
}

Nodes::Box Nodes::around(const std::vector<const double *> &places, double reach) const
{
  Box box;
  if (places.empty()) return box;
  box.n[1] = 1;
  for (int k = 0; k < nlateral; k++) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const double *x : places) {
      low = std::min(low, x[lateral[k]]);
      high = std::max(high, x[lateral[k]]);
    }
    int from = static_cast<int>(std::floor((low - reach) / distance[k])),
        to = static_cast<int>(std::ceil((high + reach) / distance[k]));
    if (periodic[k] && to - from + 1 >= count[k]) {
      from = 0;
      to = count[k] - 1;
    } else if (!periodic[k]) {
      from = std::max(from, first[k]);
      to = std::min(to, first[k] + count[k] - 1);
    }
    box.low[k] = from;
    box.n[k] = std::max(0, to - from + 1);
  }
  return box;
}

// the numbers of the nodes that are in both boxes, in one of the two: in the order of the first
void Nodes::overlap(const Box &from, const Box &to, bool in_from, std::vector<int> &found) const
{
  found.clear();
  for (int b = 0; b < from.n[1]; b++) {
    if (place_in(to, 1, from.low[1] + b) < 0) continue;
    for (int a = 0; a < from.n[0]; a++) {
      const int node = number(to, from.low[0] + a, from.low[1] + b);
      if (node >= 0) found.push_back(in_from ? b * from.n[0] + a : node);
    }
  }
}

void Nodes::share(const std::vector<const double *> &give, double reach,
                  const std::vector<const double *> &take, double reach_of_taken, MPI_Comm comm)
{
  given = around(give, reach);
  taken = around(take, reach_of_taken);
  ranks = comm;
  int me, n;
  MPI_Comm_rank(ranks, &me);
  MPI_Comm_size(ranks, &n);
  const Box own[2] = {given, taken};
  std::vector<Box> all(2 * n);
  MPI_Allgather(const_cast<Box *>(own), sizeof(own), MPI_BYTE, all.data(), sizeof(own), MPI_BYTE,
                ranks);
  peers.clear();
  for (int r = 0; r < n; r++) {
    Peer peer;
    peer.rank = r;
    overlap(given, all[2 * r + 1], true, peer.give);
    overlap(all[2 * r], taken, false, peer.take);
    if (!peer.give.empty() || !peer.take.empty()) peers.push_back(std::move(peer));
  }
}

void Nodes::begin(int to_sum, int largest)
{
  nsum = to_sum;
  nlargest = largest;
  for (const auto &part : {std::make_pair(&given, &sums_given), std::make_pair(&taken, &sums)}) {
    part.second->assign((size_t) part.first->size() * row(), 0.0);
    for (size_t k = nsum; nlargest && k < part.second->size(); k += row())
      std::fill_n(part.second->begin() + k, nlargest, -HUGE_VAL);
  }
}

void Nodes::add(const Peer &peer, const double *from)
{
  for (const int node : peer.take) {
    double *const to = &sums[(size_t) node * row()];
    for (int k = 0; k < nsum; k++) to[k] += from[k];
    for (int k = nsum; k < row(); k++) to[k] = std::max(to[k], from[k]);
    from += row();
  }
}

void Nodes::add_up()
{
  if (ranks == MPI_COMM_NULL) return;
  int me;
  MPI_Comm_rank(ranks, &me);
  std::vector<MPI_Request> requests;
  for (auto &peer : peers) {
    peer.in.resize(peer.take.size() * row());
    if (peer.rank == me || peer.take.empty()) continue;
    requests.emplace_back();
    MPI_Irecv(peer.in.data(), (int) peer.in.size(), MPI_DOUBLE, peer.rank, 0, ranks,
              &requests.back());
  }
  for (auto &peer : peers) {
    peer.out.clear();
    for (const int node : peer.give)
      peer.out.insert(peer.out.end(), &sums_given[(size_t) node * row()],
                      &sums_given[(size_t) node * row()] + row());
    if (peer.rank == me || peer.give.empty()) continue;
    requests.emplace_back();
    MPI_Isend(peer.out.data(), (int) peer.out.size(), MPI_DOUBLE, peer.rank, 0, ranks,
              &requests.back());
  }
  std::vector<MPI_Status> status(requests.size());
  MPI_Waitall((int) requests.size(), requests.data(), status.data());
  for (const auto &peer : peers) add(peer, (peer.rank == me ? peer.out : peer.in).data());
}

double Nodes::memory_usage() const
{
  size_t numbers = sums_given.capacity() + sums.capacity(), nodes = 0;
  for (const auto &peer : peers) {
    numbers += peer.out.capacity() + peer.in.capacity();
    nodes += peer.give.capacity() + peer.take.capacity();
  }
  return (double) numbers * sizeof(double) + (double) nodes * sizeof(int);
}
