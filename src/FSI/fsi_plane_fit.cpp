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

#include "fsi_open_end.h"

#include "domain.h"
#include "fsi_gradient.h"
#include "fsi_hub.h"
#include "fsi_kernel.h"
#include "neighbor.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace FSI;

static constexpr double FIT_INDEPENDENCE = 0.05;    // a monomial is fitted if this part of its norm
                                                    // is orthogonal to the lower ones
static constexpr double NEXT = 1.01;    // in spacings along the plane: rows on both sides of a node

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
  peers.clear();
  if (ranks == MPI_COMM_NULL) return;
  int n;
  MPI_Comm_size(ranks, &n);
  const Box boxes[2] = {given, taken};
  std::vector<Box> all(2 * n);
  MPI_Allgather(const_cast<Box *>(boxes), sizeof(boxes), MPI_BYTE, all.data(), sizeof(boxes),
                MPI_BYTE, ranks);
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

// the row of a fit's inverse that gives its value at the node: terms 1, x, xx; 1, x, y, xx, xy, yy
template <int TERMS> static void value_weights(const double *moment, double *row)
{
  constexpr bool PLANE = TERMS == 6;
  constexpr int degree[] = {0, 1, PLANE ? 1 : 2, 2, 2, 2},
                power_of_y[] = {0, 0, PLANE ? 1 : 0, 0, 1, 2};
  double A[packed_size(TERMS)];
  for (int a = 0, k = 0; a < TERMS; a++)
    for (int b = 0; b <= a; b++, k++) {
      const int n = degree[a] + degree[b];
      A[k] = moment[PLANE ? n * (n + 1) / 2 + power_of_y[a] + power_of_y[b] : n];
    }
  gradient_coefficients<1, TERMS>(A, row, FIT_INDEPENDENCE);
}

// the fields at the nodes, from the sums there; first whether there is fluid at all
void PlaneFit::fit(int nmoment, int nfit, int nfields)
{
  for (int node = 0; node < nodes.taken.size(); node++) {
    double *const c = &nodes.sums[(size_t) node * nodes.row()], *const moment = c, row[6];
    if (moment[0] <= OpenEnd::LITTLE * end.disc->psi_bulk) {
      c[0] = 0.0;
      continue;
    }
    nodes.nlateral == 2 ? value_weights<6>(moment, row) : value_weights<3>(moment, row);
    for (int field = 0; field < nfields; field++) {
      const double *const F = c + nmoment + field * nfit;
      double result = 0.0;
      for (int k = 0; k < nfit; k++) result += row[k] * F[k];
      c[1 + field] = result;
    }
    c[0] = 1.0;
  }
}

void PlaneFit::share()
{
  nodes.place(end.axis, end.disc->dx);
  // until the next lists particles move by half a skin, and a little
  const double moved = 0.5 * neighbor->skin + end.disc->dx;
  std::vector<const double *> before, behind;
  for (const auto &place : end.places) {
    const double *const x = atom->x[place.i];
    if (end.inside(x) > -moved) before.push_back(x);
    if (end.inside(x) < moved) behind.push_back(x);
  }
  nodes.share(before, end.disc->cut + moved, behind, reach() + moved, end.ranks);
}

// f[0] times monomials of y: 1, x, xx, ...; 1, x, y, xx, xy, yy, ...; up to the fourth degree
static void times_monomials(bool plane, const double *y, double *f)
{
  for (int degree = 1, k = 1, before = 0; degree <= 4; degree++) {
    const int from = k;
    for (; k - from < (plane ? degree : 1); k++) f[k] = f[before + k - from] * y[0];
    if (plane) {
      f[k] = f[from - 1] * y[1];
      k++;
    }
    before = from;
  }
}

void PlaneFit::measure()
{
  const Discretization &disc = *end.disc;
  const bool wants_velocity = end.has_own_velocity(), wants_pressure = end.has_own_pressure();
  // monomials of the offset over dx, by their degree: those of the fit, and all that its matrix has
  const bool plane = nodes.nlateral == 2;
  const int nfit = plane ? 6 : 3, nmoment = plane ? 15 : 5;
  nbounds = nmoment + nfit * (wants_velocity + wants_pressure);
  nodes.begin(nbounds, wants_velocity ? 2 : 0);
  with_kernel(disc.kernel, disc.dim, disc.h, [&](const auto &kernel) {
    for (const auto &place : end.places) {
      const double away = wants_pressure ? place.inside : std::fabs(place.inside - end.length);
      if (place.inside <= 0.0 || away >= disc.cut) continue;
      const double u = atom->v[place.i][end.axis], p = place.pressure;
      const auto add_to = [&](int node, const double *d) {
        const double r = std::sqrt(std::min(away * away + d[0] * d[0] + d[1] * d[1], kernel.cutsq)),
                     W = kernel.W(r);
        const double y[] = {d[0] / disc.dx, d[1] / disc.dx};
        double f[15] = {W};
        times_monomials(plane, y, f);
        double *c = &nodes.sums_given[(size_t) node * nodes.row()];
        if (wants_velocity && std::fabs(y[0]) <= NEXT && std::fabs(y[1]) <= NEXT) {
          c[nbounds] = std::max(c[nbounds], u);
          c[nbounds + 1] = std::max(c[nbounds + 1], -u);
        }
        for (int a = 0; a < nmoment; a++) *c++ += f[a];
        if (wants_velocity)
          for (int a = 0; a < nfit; a++) *c++ += f[a] * u;
        if (wants_pressure)
          for (int a = 0; a < nfit; a++) *c++ += f[a] * p;
      };
      nodes.at(nodes.given, atom->x[place.i], std::sqrt(kernel.cutsq - away * away), add_to);
    }
  });
  nodes.add_up();
  fit(nmoment, nfit, wants_velocity + wants_pressure);
}

// exact for quadratics (Keys 1981, IEEE Trans. Acoust. Speech Signal Process. 29, 1153, eq. 15);
// linear interpolation cuts maxima
static double cubic_convolution(double t)
{
  if (t < 1.0) return 1.0 + t * t * (1.5 * t - 2.5);
  return t < 2.0 ? 2.0 - t * (4.0 - t * (2.5 - 0.5 * t)) : 0.0;
}

// The velocity is one that the fluid has there: the first row at a wall would else go back for as
// much as a parabola falls below it, and bring in more and more.
bool PlaneFit::at(const double *x, double *values) const
{
  const bool has_velocity = end.has_own_velocity();
  const int n = has_velocity + end.has_own_pressure();
  double weight = 0.0, most = -HUGE_VAL, least = HUGE_VAL;
  std::fill_n(values, n, 0.0);
  nodes.at(nodes.taken, x, reach(), [&](int node, const double *d) {
    const double *const c = &nodes.sums[(size_t) node * nodes.row()];
    if (c[0] == 0.0) return;
    double w = 1.0;
    for (int k = 0; k < nodes.nlateral; k++)
      w *= cubic_convolution(std::fabs(d[k]) / nodes.distance[k]);
    weight += w;
    for (int k = 0; k < n; k++) values[k] += w * c[1 + k];
    if (!has_velocity) return;
    most = std::max(most, c[nbounds]);
    least = std::min(least, -c[nbounds + 1]);
  });
  if (weight < 0.5) return false;
  for (int k = 0; k < n; k++) values[k] /= weight;
  if (least <= most) values[0] = std::clamp(values[0], least, most);
  return true;
}
