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

#include "fsi_swaps.h"

#include "comm.h"
#include "fix.h"
#include "fsi_profile.h"
#include "pair.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace FSI;

void Swaps::find(const std::function<bool(int)> &is_chosen)
{
  swaps.clear();
  std::vector<Exchange> exchanges;
  chosen = find_exchanges(comm, exchanges);
  for (const Exchange &e : exchanges) {
    Swap s;
    static_cast<Exchange &>(s) = e;
    std::copy_if(e.list, e.list + e.nsend, std::back_inserter(s.sent), is_chosen);
    for (int i = e.first; i < e.first + e.nrecv; i++) s.arriving += is_chosen(i);
    if (!s.sent.empty() || s.arriving > 0) swaps.push_back(s);
  }
}

// sends n numbers of out to a rank; returns those from another, at most so many
double *Swaps::pass(int to, int n, int from, int most)
{
  if (to == comm->me) return out.data();
  if ((int) in.size() < most) in.resize(most);
  MPI_Request request;
  if (most) MPI_Irecv(in.data(), most, MPI_DOUBLE, from, 0, world, &request);
  if (n) MPI_Send(out.data(), n, MPI_DOUBLE, to, 0, world);
  if (most) MPI_Wait(&request, MPI_STATUS_IGNORE);
  return in.data();
}

template <class Owner> void Swaps::forward(Owner *owner, int size)
{
  if (!chosen) return comm->forward_comm(owner, size);
  if (size == 0) size = owner->comm_forward;
  for (Swap &s : swaps) {
    if (out.size() < s.sent.size() * size) out.resize(s.sent.size() * size);
    const int n = owner->pack_forward_comm(s.sent.size(), s.sent.data(), out.data(), s.flag, s.pbc);
    owner->unpack_forward_comm(s.nrecv, s.first, pass(s.to, n, s.from, s.arriving * size));
  }
}

template <class Owner> void Swaps::reverse(Owner *owner, int size)
{
  if (!chosen) return comm->reverse_comm(owner, size);
  if (size == 0) size = owner->comm_reverse;
  for (auto s = swaps.rbegin(); s != swaps.rend(); ++s) {
    if ((int) out.size() < s->arriving * size) out.resize(s->arriving * size);
    const int n = owner->pack_reverse_comm(s->nrecv, s->first, out.data());
    owner->unpack_reverse_comm(s->sent.size(), s->sent.data(),
                               pass(s->from, n, s->to, s->sent.size() * size));
  }
}

template void Swaps::forward(Pair *, int);
template void Swaps::forward(Fix *, int);
template void Swaps::reverse(Pair *, int);
template void Swaps::reverse(Fix *, int);
