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

// Laws of pairs of particles: viscosity, density diffusion, shifting, contact, drag of spheres.

#ifndef LMP_FSI_PAIR_LAWS_H
#define LMP_FSI_PAIR_LAWS_H

#include "fsi_pack.h"
#include "fsi_tensor.h"
#include "math_const.h"

#include <algorithm>
#include <cmath>

namespace LAMMPS_NS::FSI {

// Artificial viscosity (Monaghan 1992), paper eq. 14: damps approach only, never separation.
//   F_ij = -Q_ij grad_i W_ij,  Q_ij = rho_ij V_i V_j (-alpha c_ij mu + beta mu^2),  mu = h
//     v_ij.x_ij/(r^2 + 0.01 h^2) < 0
struct ArtificialViscosity {
  double alpha, beta, h, eta;    // eta = 0.01 h^2
  FSI_INLINE ArtificialViscosity(double alpha_in, double beta_in, double h_in) :
      alpha(alpha_in), beta(beta_in), h(h_in), eta(0.01 * h_in * h_in)
  {
  }
  // vdotx = v_ij.x_ij; rho, c: means of the pair; vv = V_i V_j; T: double or Pack, C, too
  template <class T, class C>
  FSI_INLINE T operator()(const T &vdotx, const T &rsq, const T &rho, const C &c, const T &vv) const
  {
    if (none(vdotx < T(0.0))) return T(0.0);
    const T mu = h * lesser(vdotx, T(0.0)) / (rsq + eta);
    return rho * vv * mu * (beta * mu - alpha * c);
  }
};

// Laminar viscosity, with V = m/rho and in both forms the mean viscosity of two fluids:
//   plain (Morris, Fox and Zhu 1997, eq. 22):
//     F_ij = V_i V_j (eta_i + eta_j) (x_ij.grad_i W_ij)/r^2 v_ij
//   central, along the line of centers, as Monaghan and Gingold 1983 with Monaghan's 2005 factor
//   2(d+2), but l^2, a constant (central_length_sq), in the place of r^2:
//     F_ij = V_i V_j (d + 2)(eta_i + eta_j) (v_ij.x_ij)/l^2 grad_i W_ij
// With r^2 sums on a lattice depend on the direction of shear; 0.01 h^2 beside it, as in both
// papers, makes the viscosity smaller, and nothing is singular here: grad_i W_ij = g x_ij, g is
// finite (doc/notes/fluid.md, Viscosity). Only the central one is right at a free surface and keeps
// angular momentum; the plain one is quieter in shear.
template <int D> struct LaminarViscosity {
  double along;    // (d + 2)/l^2; 0: the plain form
  FSI_INLINE explicit LaminarViscosity(double length_sq) :
      along(length_sq > 0.0 ? (D + 2) / length_sq : 0.0)
  {
  }
  // adds F_ij to f and returns the power it takes; g: grad_i W_ij = g x_ij; visc: eta_i + eta_j;
  // vv = V_i V_j; T: double or Pack, C, too
  template <class T, class C>
  FSI_INLINE T operator()(const T &g, const C &visc, const T &vv, const T *x_ij, const T *v_ij,
                          T *f) const
  {
    const T k = vv * visc * g;
    T power = 0.0;
    if (along > 0.0) {
      T vx = 0.0;
      for (int d = 0; d < D; d++) vx += v_ij[d] * x_ij[d];
      const T push = along * k * vx;
      for (int d = 0; d < D; d++) f[d] += push * x_ij[d];
      power = push * vx;
    } else
      for (int d = 0; d < D; d++) {
        f[d] += k * v_ij[d];
        power += k * v_ij[d] * v_ij[d];
      }
    return -power;
  }
};

// Density diffusion (delta-SPH: Molteni and Colagrossi 2009) with the hydrostatic part of the
// density difference taken out (Fourtakas et al. 2019), so that still water does not drift:
//   d rho_i/dt += 2 delta h c sum_j V_j (rho_j - rho_i + rho0/c^2 b.x_ij) x_ji.grad_i W_ij / r^2,
//     b: body force per mass

struct DensityDiffusion {
  double scale;    // 2 delta h c
  FSI_INLINE DensityDiffusion(double delta, double h, double c) : scale(2.0 * delta * h * c) {}
  // hydrostatic part of the density at x, but for a constant
  FSI_INLINE static double hydrostatic(const double *gravity, const double *x, double rho0_over_csq)
  {
    return rho0_over_csq * (gravity[0] * x[0] + gravity[1] * x[1] + gravity[2] * x[2]);
  }
  // flux k: d rho_i/dt += k V_j, d rho_j/dt -= k V_i; hydro: difference i - j of the hydrostatic
  // parts at the particles themselves, also where g, with grad_i W_ij = g x_ij, belongs to an
  // image; T: double or Pack
  template <class T>
  FSI_INLINE T operator()(const T &rho_i, const T &rho_j, const T &hydro, const T &g) const
  {
    return -scale * g * (rho_j - rho_i + hydro);
  }
};

// What two particles are in the sums that the gradient of the velocity comes of: V x (x) g by its
// components, then V v (x) g. Times V_i it is the same for both. v_ij: v_i - v_j
template <int D, class T>
FSI_INLINE void slopes_of_pair(T *part, const T &g, const T *x_ij, const T *v_ij)
{
  for (int a = 0; a < D; a++) {
    const T gx = g * x_ij[a], gv = g * v_ij[a];
    for (int b = a; b < D; b++) part[Sym<D>::id(a, b)] = gx * x_ij[b];
    for (int b = 0; b < D; b++) part[Sym<D>::N + a * D + b] = gv * x_ij[b];
  }
}

// Particle shifting (delta-plus-SPH: Sun, Colagrossi, Marrone and Zhang 2017, Comput. Methods
// Appl. Mech. Eng. 315, 25):
//   delta r_i = -C c h dt sum_j V_j [1 + 0.2 (W_ij/W(dx))^4] grad_i W_ij,
//     |delta r_i| <= C c dt/4
// Particles move from where they are dense to where they are not; the sum vanishes on a lattice.
// Sun et al. have C = 2 Ma, Ma = 0.1 the largest expected speed U over c: the bound is their U/2.
//
// Where kernels are cut off by a free surface the sum points out of the fluid. There the part
// along the normal n ~ sum_j V_j grad_i W_ij is taken out, and nothing is left on edges, in jets
// and drops. What tells is how much of the divergence of position is missing, d - sum_j V_j
// x_ji.grad_i W_ij: 0 inside, 0.7 to 0.8 in the first row of a plane surface and 0.1 to 0.4 in
// the second, 1.3 on a straight edge, in 2D and 3D. Walls (images) and solids count as full. A
// fluid that fills its box has no surface: what is missing there is a gap, which the whole sum
// closes.
//
// The flow does not move with the particles: where a particle comes to it takes the velocity of
// the flow there (Sun, Colagrossi, Marrone, Antuono and Zhang 2019, Comput. Methods Appl. Mech.
// Eng. 348, 912, have it as a term of the rate):
//   delta v_i = delta r_i.grad v,  g_ij = grad_i W_ij,
//     grad v = [sum_j V_j v_ji (x) g_ij] [sum_j V_j x_ji (x) g_ij]^-1,
// of fluid neighbors alone, exact for linear fields wherever they are, and of their images in
// walls that slip, which are planes of symmetry of the flow. This does not keep momentum, so it is
// done where the fluid fills its box. Density goes along unchanged; between open ends alone its
// rate has the velocity v + delta r/dt of the step before. Why, and what each of these is worth:
// doc/notes/shifting.md. The energy ledger knows nothing of shifting.

// Of a fluid that fills its box neighbors in walls and solids have the factor
//   1 + a max(0, W_ij - W(2 dx))/W(dx),
// where a lets a lattice that goes on beyond their face rest. The steep power would hold fluid to
// their places one by one, which the force of pressure does not know: drag that is not there.
struct WallShift {
  double share = 0.0, least = 0.0;    // a, W(2 dx)/W(dx)
};

template <int D> struct Shift {
  // Sums of a particle. Where the fluid may have a surface: the weighted and the plain sum of V_j
  // grad_i W_ij, and the divergence. Where it fills its box: the weighted sum and, of fluid
  // neighbors, those of x (x) g and v (x) g.
  static constexpr int EDGES = 2 * D + 1, SLOPES = D + Sym<D>::N + D * D;
  static constexpr int sums(bool fills) { return fills ? SLOPES : EDGES; }
  // Numbers from one particle to the next: the sums, and the neighbors' rate of density, which
  // saves them an addition of their own; fours are added at once
  static constexpr int row(bool fills) { return (sums(fills) + 1 + 3) / 4 * 4; }

  double inv_wdx;    // 1/W(dx)
  WallShift walls;
  FSI_INLINE Shift(double wdx, const WallShift &w) : inv_wdx(1.0 / wdx), walls(w) {}

  // of W_ij: what grad_i W_ij is multiplied with
  template <class T> FSI_INLINE T weight(const T &w) const
  {
    const T q = w * inv_wdx, qq = q * q;
    return 1.0 + 0.2 * (qq * qq);
  }
  // The same of neighbors in walls and solids
  template <class T> FSI_INLINE T weight_of_wall(const T &w) const
  {
    return 1.0 + walls.share * greater(w * inv_wdx - walls.least, T(0.0));
  }
  template <class K> static WallShift find_walls(const K &kernel, double dx)
  {
    const double wdx = kernel.W(dx), least = kernel.W(2.0 * dx) / wdx;
    const Shift law(wdx, {1.0, least});
    const int n = static_cast<int>(kernel.cut / dx) + 1, nz = D == 3 ? n : 0;
    double steep = 0.0, even = 0.0;
    for (int k = -nz; k <= nz; k++)
      for (int j = -n; j <= n; j++)
        for (int i = 1; i <= n; i++) {
          const double r = dx * std::sqrt(i * i + j * j + k * k);
          if (r >= kernel.cut) continue;
          const double pull = i * kernel.gradient(r), w = kernel.W(r);
          steep += pull * (law.weight(w) - 1.0);
          even += pull * (law.weight_of_wall(w) - 1.0);
        }
    return {steep / even, least};
  }

  // Loops find sums times -V_i: then what a pair is in them is the same for both, but for the
  // sign of vectors. This is that of j; g: V_i V_j W'/r; T: double or Pack
  template <bool WITH_EDGES, class T>
  FSI_INLINE static void of_pair(T *part, const T &g, const T &weight, const T &rsq, const T *x_ij)
  {
    const T weighted = g * weight;
    for (int d = 0; d < D; d++) part[d] = weighted * x_ij[d];
    if (!WITH_EDGES) return;
    for (int d = 0; d < D; d++) part[D + d] = g * x_ij[d];
    part[2 * D] = g * rsq;
  }
  static constexpr bool is_vector(int k, bool with_edges) { return k < (with_edges ? 2 * D : D); }

  // the factors of these sums where what j sees is what i sees under these signs of axes
  static void signs_of_slopes(const double *sign, double *factor)
  {
    for (int a = 0; a < D; a++) {
      for (int b = a; b < D; b++) factor[D + Sym<D>::id(a, b)] = sign[a] * sign[b];
      for (int b = 0; b < D; b++) factor[D + Sym<D>::N + a * D + b] = sign[a] * sign[b];
    }
  }

  // The sums of a particle of volume V become the displacement, in their first D places, and the
  // change of velocity, in the next; FILLS: the fluid has no surface; scale = C c h dt, most =
  // C c dt/4
  template <bool FILLS> static void displacement(double *sum, double vol, double scale, double most)
  {
    const double inverse = -1.0 / vol;
    if (FILLS)
      find_slopes(sum, inverse);
    else
      take_normal_out(sum, inverse);
    for (int d = 0; d < D; d++) sum[d] *= -scale * inverse;
    const double sq = dot(sum, sum);
    if (sq > most * most)
      for (int d = 0; d < D; d++) sum[d] *= most / std::sqrt(sq);
    change_of_velocity(sum, FILLS);
  }

  // Only a part of the displacement along an axis is left, and the change of velocity is that of
  // what is left
  static void reduce(double *sum, bool fills, int axis, double part)
  {
    sum[axis] *= part;
    change_of_velocity(sum, fills);
  }

 private:
  static constexpr int GRADIENT = D + Sym<D>::N;    // the last D^2 sums: of the velocity

  // the sums of v (x) g become the gradient of the velocity: none where neighbors do not span the
  // space
  static void find_slopes(double *sum, double inverse_vol)
  {
    const auto inverse = spanned_inverse(Sym<D>::load(sum + D), inverse_vol);
    for (int a = 0; a < D; a++) {
      double *const row = sum + GRADIENT + a * D;
      double slope[D];
      FSI::dot(inverse, row, slope);
      for (int b = 0; b < D; b++) row[b] = slope[b];
    }
  }

  static void change_of_velocity(double *sum, bool fills)
  {
    for (int a = 0; a < D; a++) sum[D + a] = fills ? dot(sum + GRADIENT + a * D, sum) : 0.0;
  }

  static void take_normal_out(double *sum, double inverse_vol)
  {
    const double missing = D - inverse_vol * sum[2 * D];
    const double *const n = sum + D;
    const double nn = dot(n, n);
    // shares of the tangential and of the normal part: the latter from the second or third row on
    const double along = share(missing, 0.9, 1.0), across = share(missing, 0.04, 0.16);
    const double normal = nn > 0.0 ? (1.0 - across) * dot(sum, n) / nn : 0.0;
    for (int d = 0; d < D; d++) sum[d] = along * (sum[d] - normal * n[d]);
  }

  // m^-1, times the share it has: none where neighbors do not span the space. The determinant of
  // the sums in m, which are m times inverse_vol, is 1 inside, about 1/2 at a face and 1/4 or 1/8
  // in a corner
  static Sym<D> spanned_inverse(const Sym<D> &m, double inverse_vol)
  {
    Sym<D> adjoint;
    if constexpr (D == 2) {
      adjoint(0, 0) = m(1, 1);
      adjoint(1, 1) = m(0, 0);
      adjoint(0, 1) = -m(0, 1);
    } else
      for (int a = 0; a < D; a++)
        for (int b = a; b < D; b++) {
          const int p = (a + 1) % 3, q = (a + 2) % 3, r = (b + 1) % 3, s = (b + 2) % 3;
          adjoint(a, b) = m(p, r) * m(q, s) - m(p, s) * m(q, r);
        }
    double det = 0.0;
    for (int b = 0; b < D; b++) det += m(0, b) * adjoint(0, b);
    double of_sums = det;
    for (int d = 0; d < D; d++) of_sums *= inverse_vol;
    const double spanned = share(-of_sums, -0.1, -0.02);
    return adjoint *= spanned > 0.0 ? spanned / det : 0.0;
  }
  static double dot(const double *a, const double *b)
  {
    double s = 0.0;
    for (int d = 0; d < D; d++) s += a[d] * b[d];
    return s;
  }
  // 1 up to all, 0 from none on
  static double share(double x, double all, double none)
  {
    return x <= all ? 1.0 : x >= none ? 0.0 : (none - x) / (none - all);
  }
};

// Contact of solid bodies: a penalty on particles of different bodies that are nearer than a
// range of R spacings, conservative and without adhesion. Energy per pair s K dx^D/2 (1 - r/(R
// dx))^2, K the harmonic mean of the two bulk moduli. s makes two lattices that face each other
// at a distance of dx as stiff against coming nearer as the bulk: a layer pushed in by e dx
// pushes back with K e. With R = 1, particle against particle, s = 1.
//
// With R = 1 a particle feels one or two of the other body's, and the face is as bumpy as a row
// of balls. With R = 2 or more it feels several, and their bumps average out.

// Contact of a body with itself, of pairs without a bond, does not reach beyond a part of their
// distance in the reference, so that a body that nothing strains has none: 0.9 of it where a bond
// is torn (short-range forces of Silling and Askari, Computers and Structures 83 (2005) 1526), a
// half where there never was one, which leaves a body free to be compressed as much.
inline double reach_within_body(double reach, double distance, bool torn)
{
  return std::min(reach, (torn ? 0.9 : 0.5) * distance);
}

struct Contact {
  double reach, reachsq, scale;    // reach = R dx, scale = s dx^(D-2)/R^2
  FSI_INLINE Contact(int dim, double dx, double R = 1.0) :
      reach(R * dx), reachsq(reach * reach), scale(dim == 3 ? dx : 1.0)
  {
    scale /= stiffness(dim, R);
  }
  // the same, of pairs that feel each other only where they are nearer than that
  Contact within(double r) const
  {
    Contact c = *this;
    c.reach = r;
    c.reachsq = r * r;
    return c;
  }
  // factor f of the force F_i = f x_ij; Ki, Kj: bulk moduli; T: double or Pack
  template <class T> FSI_INLINE T operator()(const T &rsq, double Ki, double Kj) const
  {
    if (none(rsq < T(reachsq))) return T(0.0);
    const double k = 2.0 * Ki * Kj / (Ki + Kj) * scale;
    return where(rsq < T(reachsq), k * (reach / root(rsq + T(1.0e-18 * reachsq)) - T(1.0)), T(0.0));
  }
  template <class T> FSI_INLINE T stored(const T &rsq, double K) const
  {
    const T gap = reach - root(rsq);
    return where(rsq < T(reachsq), 0.5 * K * scale * gap * gap, T(0.0));
  }
  double energy(double rsq, double Ki, double Kj) const
  {
    return stored(rsq, 2.0 * Ki * Kj / (Ki + Kj));
  }

  // second derivative of the energy (R - r)^2/2 per particle of a face by the distance of the
  // faces, where this is 1 (all lengths over dx): the sum over the other lattice, with n pairs of
  // layers at a distance of n, of 1 - R (r^2 - n^2)/r^3
  static double stiffness(int dim, double R)
  {
    const int m = static_cast<int>(R);
    double sum = 0.0;
    for (int n = 1; n <= m; n++)
      for (int a = -m; a <= m; a++)
        for (int b = (dim == 3 ? -m : 0); b <= (dim == 3 ? m : 0); b++) {
          const double s = a * a + b * b, r = std::sqrt(s + n * n);
          if (r <= R) sum += n * (1.0 - R * s / (r * r * r));
        }
    return sum;
  }
};

// What a fluid does to a sphere in it that is too small for the fluid's particles to resolve.
//
// Drag: Schiller and Naumann (1933), Z. Ver. Dtsch. Ing. 77, 318-320, with Newton's constant for
// fast spheres, as in Clift, Grace and Weber (1978), Bubbles, Drops, and Particles, ch. 5:
//   F = pi/8 rho d^2 C |u - v| (u - v),  C = max(24/Re (1 + 0.15 Re^0.687), 0.44),
//   Re = rho d |u - v|/eta
// Pressure: -V grad p, what the fluid that was there would feel (Maxey and Riley 1983, Phys.
// Fluids 26, 883-889). Of a sphere that a free surface cuts, p = 0 there, only the cap below
// counts.

// k, with F = k (u - v); speed: |u - v|
inline double drag_of_sphere(double rho, double eta, double d, double speed)
{
  const double fast = 0.44 / 8.0 * MathConst::MY_PI * rho * d * d * speed;
  if (eta <= 0.0) return fast;
  const double Re = rho * d * speed / eta;
  return std::max(3.0 * MathConst::MY_PI * eta * d * (1.0 + 0.15 * std::pow(Re, 0.687)), fast);
}

// part of the volume of a sphere of radius r that is where p > 0; p: at its center, g: |grad p|
inline double immersed_part(double p, double g, double r)
{
  if (p >= g * r) return 1.0;
  if (p <= -g * r) return 0.0;
  const double s = p / (g * r);
  return 0.25 * (2.0 + s * (3.0 - s * s));
}

}    // namespace LAMMPS_NS::FSI

#endif
