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

// Smoothing kernels, the only place where they are written down.
//
// A kernel is W(r) = norm * w(q), q = r/h, zero from q = support on. Its gradient with respect to
// x_i is
//   grad_i W_ij = norm/h^2 * dwq(q) * x_ij,   dwq(q) = (dw/dq)/q,  x_ij = x_i - x_j,
// so that loops never divide by a distance that may vanish. All are finite at q = 0.
// No LAMMPS types here: the header is also compiled alone by unittest/ and can be used on
// accelerators.

#ifndef LMP_FSI_KERNEL_H
#define LMP_FSI_KERNEL_H

#include "fsi_pack.h"
#include "math_const.h"

#include <cmath>
#include <variant>

namespace LAMMPS_NS::FSI {

enum KernelKind { CUBIC, QUINTIC, WENDLAND };

// base: normalization and scaling shared by all shapes
template <int D, class Shape> struct Kernel : Shape {
  static constexpr int DIM = D, dim = D;
  double h, hinv, cut, cutsq;
  double norm;     // W(r) = norm w(q)            [1/length^D]
  double gnorm;    // grad_i W = gnorm dwq(q) x_ij

  explicit Kernel(double h_in) :
      h(h_in), hinv(1.0 / h_in), cut(Shape::support * h_in), cutsq(cut * cut),
      norm(Shape::sigma(D) / (D == 2 ? h_in * h_in : h_in * h_in * h_in)), gnorm(norm * hinv * hinv)
  {
  }
  // T: a number, or several side by side (fsi_pack.h)
  template <class T> FSI_INLINE T W(const T &r) const { return norm * Shape::w(r * hinv); }
  // factor g with grad_i W_ij = g x_ij
  template <class T> FSI_INLINE T gradient(const T &r) const
  {
    return gnorm * Shape::dwq(r * hinv);
  }
  template <class T> FSI_INLINE void both(const T &r, T &w, T &g) const
  {
    const T q = r * hinv;
    g = gnorm * Shape::dwq(q);
    w = norm * Shape::w(q);
  }
  // For neighbors on a lattice finer than that of i (coarser: e < 0), the kernel less its
  // Laplacian times e h^2, and the same factor of its gradient: the mean of it over a cell of i's
  // lattice is what a neighbor in the middle of this cell has (theory.rst). Bounded where they
  // meet.
  template <class T> FSI_INLINE T sharper(const T &r, double e) const
  {
    const T q = r * hinv;
    return norm * (Shape::w(q) - e * (Shape::d2w(q) + (D - 1.0) * Shape::dwq(q)));
  }
  template <class T> FSI_INLINE T sharper_gradient(const T &r, double e) const
  {
    const T q = greater(r * hinv, T(0.1));
    const T laplacian = Shape::d3w(q) + (D - 1.0) * ((Shape::d2w(q) - Shape::dwq(q)) / q);
    return gnorm * (Shape::dwq(r * hinv) - e * (laplacian / q));
  }
  double curvature(double r) const { return gnorm * Shape::d2w(r * hinv); }    // d^2W/dr^2
};

// paper, eq. 10: cubic spline with sigma = 15/(7 pi) in 2D, 3/(2 pi) in 3D
struct CubicShape {
  static constexpr double support = 2.0;
  static double sigma(int dim)
  {
    return dim == 2 ? 15.0 / (7.0 * MathConst::MY_PI) : 3.0 / (2.0 * MathConst::MY_PI);
  }
  template <class T> FSI_INLINE static T w(const T &q)
  {
    const T t = greater(2.0 - q, T(0.0));
    return where(q < T(1.0), 2.0 / 3.0 - q * q + 0.5 * q * q * q, t * t * t * (1.0 / 6.0));
  }
  template <class T> FSI_INLINE static T dwq(const T &q)
  {
    const T t = greater(2.0 - q, T(0.0));
    return where(q < T(1.0), -2.0 + 1.5 * q, -0.5 * t * t / greater(q, T(1.0)));
  }
  template <class T> FSI_INLINE static T d2w(const T &q)
  {
    return where(q < T(1.0), 3.0 * q - 2.0, greater(2.0 - q, T(0.0)));
  }
  template <class T> FSI_INLINE static T d3w(const T &q)
  {
    return where(q < T(1.0), T(3.0), where(q < T(2.0), T(-1.0), T(0.0)));
  }
};

// paper, eq. 11: quintic spline with sigma = 7/(478 pi) in 2D, 1/(120 pi) in 3D
struct QuinticShape {
  static constexpr double support = 3.0;
  static double sigma(int dim)
  {
    return dim == 2 ? 7.0 / (478.0 * MathConst::MY_PI) : 1.0 / (120.0 * MathConst::MY_PI);
  }
  template <class T> FSI_INLINE static T w(const T &q)
  {
    const T a = greater(3.0 - q, T(0.0)), b = greater(2.0 - q, T(0.0)),
            c = greater(1.0 - q, T(0.0));
    return pow4(a) * a - 6.0 * (pow4(b) * b) + 15.0 * (pow4(c) * c);
  }
  template <class T> FSI_INLINE static T dwq(const T &q)
  {
    // the innermost piece in powers of q: the sum of the three has no 1/q left
    const T s = pow4(greater(3.0 - q, T(0.0))) - 6.0 * pow4(greater(2.0 - q, T(0.0)));
    return where(q < T(1.0), -120.0 + q * q * (120.0 - 50.0 * q), -5.0 * s / greater(q, T(1.0)));
  }
  template <class T> FSI_INLINE static T d2w(const T &q)
  {
    const T a = greater(3.0 - q, T(0.0)), b = greater(2.0 - q, T(0.0)),
            c = greater(1.0 - q, T(0.0));
    return 20.0 * (a * a * a - 6.0 * (b * b * b) + 15.0 * (c * c * c));
  }
  template <class T> FSI_INLINE static T d3w(const T &q)
  {
    const T a = greater(3.0 - q, T(0.0)), b = greater(2.0 - q, T(0.0)),
            c = greater(1.0 - q, T(0.0));
    return -60.0 * (a * a - 6.0 * (b * b) + 15.0 * (c * c));
  }

 private:
  template <class T> FSI_INLINE static T pow4(const T &t)
  {
    const T t2 = t * t;
    return t2 * t2;
  }
};

// Wendland (1995) C2 with support 2h, sigma = 7/(4 pi) in 2D, 21/(16 pi) in 3D; does not pair
// under load
struct WendlandShape {
  static constexpr double support = 2.0;
  static double sigma(int dim)
  {
    return dim == 2 ? 7.0 / (4.0 * MathConst::MY_PI) : 21.0 / (16.0 * MathConst::MY_PI);
  }
  template <class T> FSI_INLINE static T w(const T &q)
  {
    const T t = greater(1.0 - 0.5 * q, T(0.0)), t2 = t * t;
    return t2 * t2 * (2.0 * q + 1.0);
  }
  template <class T> FSI_INLINE static T dwq(const T &q)
  {
    const T t = greater(1.0 - 0.5 * q, T(0.0));
    return -5.0 * t * t * t;
  }
  template <class T> FSI_INLINE static T d2w(const T &q)
  {
    const T t = greater(1.0 - 0.5 * q, T(0.0));
    return t * t * (7.5 * q - 5.0 * t);
  }
  template <class T> FSI_INLINE static T d3w(const T &q)
  {
    return greater(1.0 - 0.5 * q, T(0.0)) * (15.0 - 15.0 * q);
  }
};

template <int D> using Cubic = Kernel<D, CubicShape>;
template <int D> using Quintic = Kernel<D, QuinticShape>;
template <int D> using Wendland = Kernel<D, WendlandShape>;

inline double kernel_support(int kind)
{
  return kind == QUINTIC ? QuinticShape::support : 2.0;
}

// Calls f with the kernel object that kind and dim name: the one run-time choice between kernels.
template <class F> auto with_kernel(int kind, int dim, double h, F &&f)
{
  if (dim == 2)
    return kind == CUBIC ? f(Cubic<2>(h)) : kind == QUINTIC ? f(Quintic<2>(h)) : f(Wendland<2>(h));
  return kind == CUBIC ? f(Cubic<3>(h)) : kind == QUINTIC ? f(Quintic<3>(h)) : f(Wendland<3>(h));
}

// A kernel chosen at run time, for sums of which one text is enough. Its functions are not inlined:
// that would be six texts again.
class ChosenKernel {
  using Choice = std::variant<Cubic<2>, Cubic<3>, Quintic<2>, Quintic<3>, Wendland<2>, Wendland<3>>;
  const Choice choice;
  template <class F> double of(F &&f) const { return std::visit(f, choice); }

 public:
  const int dim;
  const double h, hinv, cut, cutsq;

  ChosenKernel(int kind, int dim_in, double h_in) :
      choice(with_kernel(kind, dim_in, h_in,
                         [](const auto &kernel) {
                           return Choice(kernel);
                         })),
      dim(dim_in), h(h_in), hinv(1.0 / h), cut(kernel_support(kind) * h), cutsq(cut * cut)
  {
  }
  FSI_OUTLINE double W(double r) const
  {
    return of([=](const auto &kernel) {
      return kernel.W(r);
    });
  }
  FSI_OUTLINE double gradient(double r) const
  {
    return of([=](const auto &kernel) {
      return kernel.gradient(r);
    });
  }
  FSI_OUTLINE double curvature(double r) const
  {
    return of([=](const auto &kernel) {
      return kernel.curvature(r);
    });
  }
  FSI_OUTLINE double sharper(double r, double e) const
  {
    return of([=](const auto &kernel) {
      return kernel.sharper(r, e);
    });
  }
  FSI_OUTLINE double sharper_gradient(double r, double e) const
  {
    return of([=](const auto &kernel) {
      return kernel.sharper_gradient(r, e);
    });
  }
  void both(double r, double &w, double &g) const
  {
    w = W(r);
    g = gradient(r);
  }
};
// for loops that are compiled by dimension
template <int D> struct ChosenKernelOf : ChosenKernel {
  static constexpr int DIM = D;
  ChosenKernelOf(int kind, double h) : ChosenKernel(kind, D, h) {}
};

// sum_j W_ij of a particle inside an infinite square (2D) or simple cubic (3D) lattice of spacing
// dx, self included
template <class K> double lattice_number_density(const K &kernel, double dx)
{
  const int n = static_cast<int>(kernel.cut / dx) + 1;
  double psi = 0.0;
  for (int k = (kernel.dim == 3 ? -n : 0); k <= (kernel.dim == 3 ? n : 0); k++)
    for (int j = -n; j <= n; j++)
      for (int i = -n; i <= n; i++) psi += kernel.W(dx * std::sqrt(double(i * i + j * j + k * k)));
  return psi;
}

// l^2 of central laminar viscosity (fsi_pair_laws.h), with which a flow along the rows of a
// lattice has the viscosity that is given, in the mean over the places of rows that slide along
// each other
template <class K> double central_length_sq(const K &kernel, double dx)
{
  constexpr int PLACES = 16;
  const int n = static_cast<int>(kernel.cut / dx) + 1, nz = kernel.dim == 3 ? n : 0;
  double sum = 0.0;
  for (int k = -nz; k <= nz; k++)
    for (int j = -n; j <= n; j++)
      for (int i = -n * PLACES; i <= n * PLACES; i++) {
        const double x = i * dx / PLACES, y = j * dx, z = k * dx;
        sum -= kernel.gradient(std::sqrt(x * x + y * y + z * z)) * x * x * y * y;
      }
  return (kernel.dim + 2) * sum / (PLACES * lattice_number_density(kernel, dx));
}

// The elasticity that a lattice of fluid particles has and the fluid has not (doc/notes/fluid.md):
// a strain e that keeps the volume changes the number density, psi(e) = psi (1 + s e^2/2 + ...),
// and the lattice has the modulus s p. On a square or simple cubic one s is a sum over the
// neighbors of second derivatives of W(|F x|), g = W'/r:
//   stretch, F = diag(exp e, exp -e):   sum (W'' - g) (x^2 - y^2)^2/r^2 + 2 g (x^2 + y^2)
//   shear, F = 1 + e x (x) y:           sum (W'' - g) x^2 y^2/r^2 + g y^2
// By symmetry any other strain that keeps the volume is, at small e, a sum of these.
struct LatticeStiffness {
  double stretch = 0.0, shear = 0.0;    // modulus over pressure
};

template <class K> LatticeStiffness lattice_stiffness(const K &kernel, double dx)
{
  const double psi = lattice_number_density(kernel, dx);
  const int n = static_cast<int>(kernel.cut / dx) + 1, nz = kernel.dim == 3 ? n : 0;
  LatticeStiffness s;
  for (int k = -nz; k <= nz; k++)
    for (int j = -n; j <= n; j++)
      for (int i = -n; i <= n; i++) {
        const double rsq = dx * dx * (i * i + j * j + k * k), r = std::sqrt(rsq);
        if (r == 0.0 || r >= kernel.cut) continue;
        const double g = kernel.gradient(r) / psi, q = (kernel.curvature(r) / psi - g) / rsq,
                     xsq = i * dx * (i * dx), ysq = j * dx * (j * dx);
        s.stretch += q * (xsq - ysq) * (xsq - ysq) + 2.0 * g * (xsq + ysq);
        s.shear += q * xsq * ysq + g * ysq;
      }
  return s;
}

// Calls f(level, kernel) for each spacing of fluids with a kernel whose W is multiplied with the
// volume of its particles, that of the coarsest being 1: weights of means over fluids around
template <class Discretization, class F> void for_levels(const Discretization &disc, F &&f)
{
  for (size_t l = 0; l < disc.levels.size(); l++)
    with_kernel(disc.kernel, disc.dim, disc.levels[l].h, [&](auto kernel) {
      const double ratio = disc.levels[l].dx / disc.dx;
      kernel.norm *= disc.dim == 3 ? ratio * ratio * ratio : ratio * ratio;
      f(l, kernel);
    });
}

}    // namespace LAMMPS_NS::FSI

#endif
