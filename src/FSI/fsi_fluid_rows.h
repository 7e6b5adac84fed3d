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

// The rows of the neighbour list that most of a fluid's time goes into, those of one fluid, four pairs at a time: density rate
// and forces of pair_style fsi/fluid, which computes all other rows pair by pair with the same formulas.
// There is no branch on the distance: kernels are zero from their support on. The images of neighbours in a mirror wall without
// extent (fsi_walls.h) are rows of their own: who is not near the wall is too far from its images, too.

#ifndef LMP_FSI_FLUID_ROWS_H
#define LMP_FSI_FLUID_ROWS_H

#include "fsi_density_diffusion.h"
#include "fsi_kernel.h"
#include "fsi_material.h"
#include "fsi_viscosity_artificial.h"
#include "fsi_viscosity_laminar.h"
#include "fsi_walls.h"

#include <array>
#include <vector>

namespace LAMMPS_NS {
namespace FSI {

  // What a loop needs of a particle, side by side (in 2D a cache line).
  template <int D> struct Point {
    double x[D], v[D], rho, vol;
    double p, pv2;    // force loop: pressure, p V^2; rate loop: whether there is pressure, hydrostatic part of the density
    std::array<double, 3> position(const double *atom_x) const { return {x[0], x[1], D == 3 ? x[D - 1] : atom_x[2]}; }
  };

  // Rows of a neighbour list: with newton on, so that each pair is in one of them, and without special bonds in its entries.
  struct Rows {
    const std::vector<int> &i;
    const int *numneigh;
    int **firstneigh;
  };

#if FSI_PACKS
  template <int D> struct PackOfPoints {
    Pack x[D], v[D], rho, vol, p, pv2;

    FSI_INLINE explicit PackOfPoints(const Point<D> &a)
    {
      for (int d = 0; d < D; d++) {
        x[d] = a.x[d];
        v[d] = a.v[d];
      }
      rho = a.rho;
      vol = a.vol;
      p = a.p;
      pv2 = a.pv2;
    }
    FSI_INLINE PackOfPoints(const Point<D> *point, const int *j)
    {
      const Point<D> &a = point[j[0]], &b = point[j[1]], &c = point[j[2]], &d = point[j[3]];
      Pack one[4], two[4];
      Pack::columns(a.x, b.x, c.x, d.x, one);
      Pack::columns(a.x + 4, b.x + 4, c.x + 4, d.x + 4, two);
      x[0] = one[0];
      x[1] = one[1];
      if constexpr (D == 2) {
        v[0] = one[2];
        v[1] = one[3];
        rho = two[0];
        vol = two[1];
        p = two[2];
        pv2 = two[3];
      } else {
        x[2] = one[2];
        v[0] = one[3];
        v[1] = two[0];
        v[2] = two[1];
        rho = two[2];
        vol = two[3];
        Pack::columns(&a.p, &b.p, &c.p, &d.p, p, pv2);
      }
    }
    FSI_INLINE void reflect(const Mirror &mirror)
    {
      for (int d = 0; d < D; d++) {
        x[d] = mirror.x[d] + mirror.sign[d] * x[d];
        v[d] = mirror.v[d] + mirror.sign[d] * v[d];
      }
    }
  };

  template <int D> FSI_INLINE Pack product(const Pack (&a)[D], const Pack (&b)[D])
  {
    Pack s = a[0] * b[0];
    for (int d = 1; d < D; d++) s += a[d] * b[d];
    return s;
  }
  // c = a - b; returns its square
  template <int D> FSI_INLINE Pack difference(const Pack (&a)[D], const Pack (&b)[D], Pack (&c)[D])
  {
    for (int d = 0; d < D; d++) c[d] = a[d] - b[d];
    return product(c, c);
  }

  // Calls pairs(j, live) with four neighbours of row i at a time. Places that are left over hold i itself, with live = 0, the others
  // with 1: what i adds to sums of its own is zero where no formula divides by the distance, but it has a kernel and images.
  template <class Pairs> FSI_INLINE void for_packs(const Rows &rows, int i, Pairs pairs)
  {
    const int *const list = rows.firstneigh[i];
    const int n = rows.numneigh[i], full = n & ~(Pack::WIDTH - 1);
    for (int jj = 0; jj < full; jj += Pack::WIDTH) pairs(list + jj, Pack(1.0));
    if (full == n) return;
    int j[Pack::WIDTH];
    for (int k = 0; k < Pack::WIDTH; k++) j[k] = full + k < n ? list[full + k] : i;
    pairs(j, Pack(1.0, full + 1 < n ? 1.0 : 0.0, full + 2 < n ? 1.0 : 0.0, full + 3 < n ? 1.0 : 0.0));
  }

  // sum_j W_ij into psi
  template <class K> FSI_AVX2 void density_rows(const Rows &rows, const K kernel, const double (*const x)[3], double *const psi)
  {
    constexpr int D = K::DIM;
    for (const int i : rows.i) {
      Pack sum = 0.0;
      for_packs(rows, i, [&](const int *j, const Pack &live) __attribute__((always_inline)) {
        Pack rsq = 0.0;
        for (int d = 0; d < D; d++) {
          const Pack r = x[i][d] - Pack(x[j[0]][d], x[j[1]][d], x[j[2]][d], x[j[3]][d]);
          rsq += r * r;
        }
        const Pack w = live * kernel.W(root(rsq));
        sum += w;
        for (int k = 0; k < Pack::WIDTH; k++) psi[j[k]] += w.v[k];
      });
      psi[i] += sum.sum();
    }
  }

  // m_i dpsi_i/dt into rate, with density diffusion: see PairFSIFluid::rate_pairs. What is constant comes by value: stores to the
  // sums could change what is behind a reference.
  template <class K, bool DIFFUSION, bool IMAGES>
  FSI_AVX2 void rate_rows(const Rows &rows, const Mirror mirror, const K kernel, const DensityDiffusion diffusion,
                          const Point<K::DIM> *const point, double *const rate)
  {
    constexpr int D = K::DIM;
    for (const int i : rows.i) {
      const PackOfPoints<D> pi(point[i]);
      Pack sum = 0.0, flux = 0.0;
      for_packs(rows, i, [&](const int *j, const Pack &live) __attribute__((always_inline)) {
        PackOfPoints<D> pj(point, j);
        if (IMAGES) pj.reflect(mirror);
        Pack x[D], v[D];
        const Pack rsq = difference(pi.x, pj.x, x), vdotx = (difference(pi.v, pj.v, v), product(v, x));
        const Pack g = IMAGES ? live * kernel.gradient(root(rsq)) : kernel.gradient(root(rsq));
        const Pack s = g * vdotx;
        sum += s;
        Pack rate_j = pj.rho * pj.vol * s;
        if (DIFFUSION) {
          const Pack k = diffusion(pi.rho, pj.rho, greater(pi.p, pj.p) * (pi.pv2 - pj.pv2), g);
          flux += k * pj.vol;
          rate_j -= k * pi.vol;
        }
        for (int k = 0; k < Pack::WIDTH; k++) rate[j[k]] += rate_j.v[k];
      });
      rate[i] += point[i].rho * point[i].vol * sum.sum() + flux.sum();
    }
  }

  // doubles from the forces on a particle to those on the next: as in atom->f; in 3D four, which a register holds
  constexpr int row_of_forces(int dim) { return dim == 3 ? 4 : 3; }

  // pressure and viscosity into f: see PairFSIFluid::force_pairs; the forces on the rows' particles are added to total. No
  // laminar viscosity of images: at a no-slip wall it has velocities of its own.
  template <class K, bool ARTIFICIAL, bool LAMINAR, bool IMAGES>
  FSI_AVX2 void force_rows(const Rows &rows, const Mirror mirror, const K kernel, const ArtificialViscosity artificial, const double c,
                           const LaminarViscosity<K::DIM> viscous, const State *const state, const int *const type,
                           const Point<K::DIM> *const point, double (*const f)[row_of_forces(K::DIM)], double *const total)
  {
    constexpr int D = K::DIM;
    for (const int i : rows.i) {
      const PackOfPoints<D> pi(point[i]);
      const double visc = LAMINAR ? 2.0 * state[type[i]].viscosity : 0.0;
      Pack sum[D];
      for (int d = 0; d < D; d++) sum[d] = 0.0;
      for_packs(rows, i, [&](const int *j, const Pack &live) __attribute__((always_inline)) {
        PackOfPoints<D> pj(point, j);
        if (IMAGES) pj.reflect(mirror);
        Pack x[D], v[D], force[D];    // force on j
        const Pack rsq = difference(pi.x, pj.x, x), vdotx = (difference(pi.v, pj.v, v), product(v, x));
        const Pack g = IMAGES ? live * kernel.gradient(root(rsq)) : kernel.gradient(root(rsq));
        Pack p = pi.pv2 + pj.pv2;
        if (ARTIFICIAL) p += artificial(vdotx, rsq, 0.5 * (pi.rho + pj.rho), c, pi.vol * pj.vol);
        p = p * g;
        for (int d = 0; d < D; d++) force[d] = p * x[d];
        if (LAMINAR) {
          for (int d = 0; d < D; d++) v[d] = -v[d];
          viscous(g, rsq, visc, pi.vol * pj.vol, x, v, force);
        }
        for (int d = 0; d < D; d++) {
          sum[d] += force[d];
          if (IMAGES) force[d] = mirror.sign[d] * force[d];
        }
        if constexpr (D == 3)
          Pack::add_rows(force[0], force[1], force[2], f[j[0]], f[j[1]], f[j[2]], f[j[3]]);
        else
          for (int k = 0; k < Pack::WIDTH; k++)
            for (int d = 0; d < D; d++) f[j[k]][d] += force[d].v[k];
      });
      for (int d = 0; d < D; d++) {
        f[i][d] -= sum[d].sum();
        if (IMAGES) total[d] -= sum[d].sum();
      }
    }
  }
#endif

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
