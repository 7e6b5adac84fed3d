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

#include "comm_brick.h"
#include "fix.h"
#include "fsi_profile.h"
#include "pair.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace FSI;

// LAMMPS shows its exchanges to classes derived from its own only
namespace {
struct Brick : public CommBrick {
  static constexpr auto number = &Brick::nswap;
  static constexpr auto to = &Brick::sendproc, from = &Brick::recvproc, nsend = &Brick::sendnum,
                        nrecv = &Brick::recvnum, first = &Brick::firstrecv, flag = &Brick::pbc_flag;
  static constexpr auto list = &Brick::sendlist, shifts = &Brick::pbc;
};
}    // namespace

void Swaps::find(const std::function<bool(int)> &is_chosen)
{
  swaps.clear();
  const auto *brick = dynamic_cast<const CommBrick *>(comm);
  chosen = brick != nullptr;
  if (!chosen) return;
  for (int k = 0; k < brick->*Brick::number; k++) {
    Swap s;
    const int *const list = (brick->*Brick::list)[k];
    std::copy_if(list, list + (brick->*Brick::nsend)[k], std::back_inserter(s.list), is_chosen);
    s.first = (brick->*Brick::first)[k];
    s.n = (brick->*Brick::nrecv)[k];
    s.arriving = 0;
    for (int i = s.first; i < s.first + s.n; i++) s.arriving += is_chosen(i);
    if (s.list.empty() && s.arriving == 0) continue;
    s.to = (brick->*Brick::to)[k];
    s.from = (brick->*Brick::from)[k];
    s.flag = (brick->*Brick::flag)[k];
    s.pbc = (brick->*Brick::shifts)[k];
    swaps.push_back(s);
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

template <class Who> void Swaps::forward(Who *who)
{
  if (!chosen) return comm->forward_comm(who);
  const int size = who->comm_forward;
  for (Swap &s : swaps) {
    if (out.size() < s.list.size() * size) out.resize(s.list.size() * size);
    const int n = who->pack_forward_comm(s.list.size(), s.list.data(), out.data(), s.flag, s.pbc);
    who->unpack_forward_comm(s.n, s.first, pass(s.to, n, s.from, s.arriving * size));
  }
}

template <class Who> void Swaps::reverse(Who *who)
{
  if (!chosen) return comm->reverse_comm(who);
  const int size = who->comm_reverse;
  for (auto s = swaps.rbegin(); s != swaps.rend(); ++s) {
    if ((int) out.size() < s->arriving * size) out.resize(s->arriving * size);
    const int n = who->pack_reverse_comm(s->n, s->first, out.data());
    who->unpack_reverse_comm(s->list.size(), s->list.data(),
                             pass(s->from, n, s->to, s->list.size() * size));
  }
}

template void Swaps::forward(Pair *);
template void Swaps::forward(Fix *);
template void Swaps::reverse(Pair *);
template void Swaps::reverse(Fix *);
