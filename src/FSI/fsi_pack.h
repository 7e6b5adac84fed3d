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

// Four numbers side by side, for loops that take four pairs at a time: a vector register of AVX2,
// two of Arm's.
//
// Formulas are templates over the number, double or Pack, and written once: lesser, greater and
// where are what they use for branches. FSI_INLINE makes them part of the loop that calls them, a
// function marked FSI_TARGET, which on x86 is compiled for a processor that has AVX2 and fused
// multiply-add whatever the rest is compiled for: ask have_packs() before calling it. Sums differ
// from those of other processors by round-off. Where the compiler is another, FSI_PACKS is 0 and
// loops go pair by pair; with the environment variable FSI_PACKS=no they do on any processor. Those
// loops have all effects, with coefficients of zero for what is off: they are for old processors.

#ifndef LMP_FSI_PACK_H
#define LMP_FSI_PACK_H

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <type_traits>

// A source of package KOKKOS, which includes its headers first: pair by pair, for a device.
#if defined(KOKKOS_ENABLE_CUDA) || defined(KOKKOS_ENABLE_HIP) || defined(KOKKOS_ENABLE_SYCL)
#define FSI_PACKS 0
#define FSI_INLINE KOKKOS_FORCEINLINE_FUNCTION
#define FSI_INLINE_LAMBDA
// compilers with EDG's front end (nvc++, icpc) call themselves GNU C without having its vectors
#elif defined(__GNUC__) && (defined(__x86_64__) || defined(__aarch64__)) && !defined(__EDG__) && \
    !defined(__NVCOMPILER) && !defined(__INTEL_COMPILER)
#define FSI_PACKS 1
#define FSI_OUTLINE __attribute__((noinline))
#define FSI_INLINE inline __attribute__((always_inline))
#define FSI_INLINE_LAMBDA __attribute__((always_inline))
#else
#define FSI_PACKS 0
#define FSI_INLINE inline
#define FSI_INLINE_LAMBDA
#endif
#ifndef FSI_OUTLINE
#define FSI_OUTLINE
#endif
#if FSI_PACKS && defined(__x86_64__)
#define FSI_TARGET __attribute__((target("avx2,fma")))
#else
#define FSI_TARGET
#endif

namespace LAMMPS_NS::FSI {

// clang-format off
FSI_INLINE double root(double x) { return std::sqrt(x); }
FSI_INLINE double lesser(double a, double b) { return a < b ? a : b; }
FSI_INLINE double greater(double a, double b) { return a > b ? a : b; }
FSI_INLINE double where(bool condition, double a, double b) { return condition ? a : b; }
FSI_INLINE bool none(bool condition) { return !condition; }  // a way out, if it is worth a branch
// clang-format on

#if FSI_PACKS
struct Pack {
  static constexpr int WIDTH = 4;
  typedef double Vector __attribute__((vector_size(WIDTH * sizeof(double))));
  struct Mask {
    decltype(Vector() < Vector()) m;
  };
  Vector v;

  Pack() = default;
  FSI_INLINE Pack(double x)
  {
#if defined(__clang__) || !defined(__x86_64__)
    v = Vector{x, x, x, x};
#else
    // one instruction, outside loops: gcc 12 takes {x, x, x, x} apart, and valgrind does not know
    // all of what comes of other forms
    asm("vbroadcastsd %1, %0" : "=x"(v) : "x"(x));
#endif
  }
  FSI_INLINE Pack(double a, double b, double c, double d) : v(Vector{a, b, c, d}) {}
  FSI_INLINE double sum() const
  {
    return (v[0] + v[1]) + (v[2] + v[3]);
  }

  // clang-format off
  FSI_INLINE friend Pack operator+(const Pack &a, const Pack &b) { return make(a.v + b.v); }
  FSI_INLINE friend Pack operator-(const Pack &a, const Pack &b) { return make(a.v - b.v); }
  FSI_INLINE friend Pack operator*(const Pack &a, const Pack &b) { return make(a.v * b.v); }
  FSI_INLINE friend Pack operator/(const Pack &a, const Pack &b) { return make(a.v / b.v); }
  FSI_INLINE Pack &operator+=(const Pack &b) { v += b.v; return *this; }
  FSI_INLINE Pack &operator-=(const Pack &b) { v -= b.v; return *this; }
  FSI_INLINE friend Pack operator-(const Pack &a) { return make(-a.v); }
  FSI_INLINE friend Mask operator<(const Pack &a, const Pack &b) { return {a.v < b.v}; }
  FSI_INLINE friend Pack lesser(const Pack &a, const Pack &b)
  { return make(a.v < b.v ? a.v : b.v); }
  FSI_INLINE friend Pack greater(const Pack &a, const Pack &b)
  { return make(a.v > b.v ? a.v : b.v); }
  FSI_INLINE friend Pack where(const Mask &condition, const Pack &a, const Pack &b)
  { return make(condition.m ? a.v : b.v); }
  FSI_INLINE friend bool none(const Mask &) { return false; }
  // clang-format on
  FSI_INLINE friend Pack root(const Pack &a)
  {
    return {__builtin_sqrt(a.v[0]), __builtin_sqrt(a.v[1]), __builtin_sqrt(a.v[2]),
            __builtin_sqrt(a.v[3])};
  }

  // the four doubles at each of a, b, c, d become the columns out[0] to out[3]
  FSI_INLINE static void columns(const double *a, const double *b, const double *c, const double *d,
                                 Pack *out)
  {
    transpose(load(a), load(b), load(c), load(d), out);
  }

  // the inverse: adds the nth numbers of x, y, z, w to the four doubles at a, b, c, d, and their
  // sums to total, or null
  FSI_INLINE static void add_rows(const Pack &x, const Pack &y, const Pack &z, const Pack &w,
                                  double *a, double *b, double *c, double *d, Pack *total)
  {
    Pack row[WIDTH];
    transpose(x, y, z, w, row);
    store(a, load(a) + row[0]);
    store(b, load(b) + row[1]);
    store(c, load(c) + row[2]);
    store(d, load(d) + row[3]);
    if (total) *total += (row[0] + row[1]) + (row[2] + row[3]);
  }

  // adds these four, or the two that both halves are parts of, each times its factor, to numbers
  // at a
  FSI_INLINE void add_times(const double *factors, bool halves, double *a) const
  {
    if (halves)
      add(a, (half<0>(*this) + half<2>(*this)) * load_half(factors));
    else
      store(a, load(a) + *this * load(factors));
  }

  // as of four: x, y to the two doubles at a, b, c, d; of the total to both halves of it
  FSI_INLINE static void add_rows(const Pack &x, const Pack &y, double *a, double *b, double *c,
                                  double *d, Pack *total)
  {
    const Pack low = shuffle<0, 4, 2, 6>(x, y), high = shuffle<1, 5, 3, 7>(x, y);
    add(a, half<0>(low));
    add(b, half<0>(high));
    add(c, half<2>(low));
    add(d, half<2>(high));
    if (total) *total += low + high;
  }

  // the two doubles at each of a, b, c, d
  FSI_INLINE static void columns(const double *a, const double *b, const double *c, const double *d,
                                 Pack &first, Pack &second)
  {
    const Pack A = both(a, c), B = both(b, d);
    first = shuffle<0, 4, 2, 6>(A, B);
    second = shuffle<1, 5, 3, 7>(A, B);
  }

  FSI_INLINE static Pack load(const double *p)
  {
    Pack x;
    __builtin_memcpy(&x.v, p, sizeof(x.v));
    return x;
  }

 private:
  typedef double Half __attribute__((vector_size(2 * sizeof(double))));
  FSI_INLINE static Half load_half(const double *p)
  {
    Half x;
    __builtin_memcpy(&x, p, sizeof(x));
    return x;
  }
  FSI_INLINE static void add(double *p, const Half &x)
  {
    const Half y = load_half(p) + x;
    __builtin_memcpy(p, &y, sizeof(y));
  }
  // the two doubles at p and at q; those of a from number I on: as halves of registers if it can
#if defined(__clang__) || __GNUC__ >= 12
  FSI_INLINE static Pack both(const double *p, const double *q)
  {
    return make(__builtin_shufflevector(load_half(p), load_half(q), 0, 1, 2, 3));
  }
  template <int I> FSI_INLINE static Half half(const Pack &a)
  {
    return __builtin_shufflevector(a.v, a.v, I, I + 1);
  }
#else
  FSI_INLINE static Pack both(const double *p, const double *q)
  {
    return {p[0], p[1], q[0], q[1]};
  }
  template <int I> FSI_INLINE static Half half(const Pack &a)
  {
    return Half{a.v[I], a.v[I + 1]};
  }
#endif
  FSI_INLINE static Pack make(const Vector &x)
  {
    Pack p;
    p.v = x;
    return p;
  }
  FSI_INLINE static void transpose(const Pack &a, const Pack &b, const Pack &c, const Pack &d,
                                   Pack *out)
  {
    const Pack low = shuffle<0, 4, 2, 6>(a, b), high = shuffle<1, 5, 3, 7>(a, b);
    const Pack low2 = shuffle<0, 4, 2, 6>(c, d), high2 = shuffle<1, 5, 3, 7>(c, d);
    out[0] = shuffle<0, 1, 4, 5>(low, low2);
    out[1] = shuffle<0, 1, 4, 5>(high, high2);
    out[2] = shuffle<2, 3, 6, 7>(low, low2);
    out[3] = shuffle<2, 3, 6, 7>(high, high2);
  }
  FSI_INLINE static void store(double *p, const Pack &x)
  {
    __builtin_memcpy(p, &x.v, sizeof(x.v));
  }
  // elements of a (0 to 3) and b (4 to 7)
  template <int I, int J, int K, int L> FSI_INLINE static Pack shuffle(const Pack &a, const Pack &b)
  {
#if defined(__clang__) || __GNUC__ >= 12
    return make(__builtin_shufflevector(a.v, b.v, I, J, K, L));
#else
    typedef long Index __attribute__((vector_size(WIDTH * sizeof(double))));
    return make(__builtin_shuffle(a.v, b.v, Index{I, J, K, L}));
#endif
  }
};

inline bool have_packs()
{
  const char *const wanted = std::getenv("FSI_PACKS");
  const bool refused = wanted && std::strcmp(wanted, "no") == 0;
#if defined(__x86_64__)
  return !refused && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
  return !refused;
#endif
}
#else
typedef double Pack;
inline bool have_packs()
{
  return false;
}
#endif

// What a loop over particles j needs of a number type: how many it takes at a time, and how it
// reads and adds to their entries.
template <class T> struct Lanes;
template <> struct Lanes<double> {
  static constexpr int WIDTH = 1;
  FSI_INLINE static double load(const double *a) { return *a; }
  FSI_INLINE static double read(const double *a, const int *j) { return a[*j]; }
  FSI_INLINE static void add(double x, double *a, const int *j) { a[*j] += x; }
  FSI_INLINE static double sum(double x) { return x; }
  // which places a mask has, the first place's lowest
  FSI_INLINE static int bits(bool mask) { return mask; }
  // appends places without a bit to what ends at `last`, with one to what ends at `others`: room
  // for WIDTH is at both
  FSI_INLINE static void split(int bits, const int *j, int *&last, int **others)
  {
    if (bits == 0)
      *last++ = *j;
    else if (others)
      *(*others)++ = *j;
  }
  // f(k) for place k
  template <class F> FSI_INLINE static double make(F f) { return f(0); }
  // 1 in the first n places, else 0
  FSI_INLINE static double first(int n) { return n; }
  // adds x to the first n numbers of a row of N
  template <int n, int N>
  FSI_INLINE static void add_rows(const double (&x)[n], double (*a)[N], const int *j)
  {
    for (int d = 0; d < n; d++) a[*j][d] += x[d];
  }
  // sums over all places of n numbers, in as many T
  static constexpr int totals(int n) { return n; }
  // add_rows(), and to totals
  template <int n, int N>
  FSI_INLINE static void add_to_all(const double (&x)[n], double (*a)[N], const int *j,
                                    double (&total)[totals(n)])
  {
    for (int d = 0; d < n; d++) {
      a[*j][d] += x[d];
      total[d] += x[d];
    }
  }
  // adds the totals, each times its factor, to the numbers at a; room for fours is at both
  template <int n>
  FSI_INLINE static void add_totals(const double (&total)[totals(n)], const double *factors,
                                    double *a)
  {
    for (int d = 0; d < n; d++) a[d] += factors[d] * total[d];
  }
};
#if FSI_PACKS
template <> struct Lanes<Pack> {
  static constexpr int WIDTH = Pack::WIDTH;
  FSI_INLINE static Pack load(const double *a) { return Pack::load(a); }
  FSI_INLINE static Pack read(const double *a, const int *j)
  {
    return {a[j[0]], a[j[1]], a[j[2]], a[j[3]]};
  }
  FSI_INLINE static void add(const Pack &x, double *a, const int *j)
  {
    for (int k = 0; k < WIDTH; k++) a[j[k]] += x.v[k];
  }
  FSI_INLINE static double sum(const Pack &x) { return x.sum(); }
  template <class F> FSI_INLINE static Pack make(F f) { return {f(0), f(1), f(2), f(3)}; }
  FSI_INLINE static int bits(const Pack::Mask &mask)
  {
    int bits = 0;    // clang takes such operands in functions of this target alone
#if defined(__x86_64__) && !defined(__clang__)
    asm("vmovmskpd %1, %0" : "=r"(bits) : "x"(mask.m));
#else
    for (int k = 0; k < WIDTH; k++) bits |= (mask.m[k] ? 1 : 0) << k;
#endif
    return bits;
  }
  FSI_INLINE static void split(int bits, const int *j, int *&last, int **others)
  {
#if defined(__x86_64__)
    // by bits: the places of those that are not set, then the others
    // clang-format off
    static constexpr int order[16][WIDTH] = {
        {0, 1, 2, 3}, {1, 2, 3, 0}, {0, 2, 3, 1}, {2, 3, 0, 1},
        {0, 1, 3, 2}, {1, 3, 0, 2}, {0, 3, 1, 2}, {3, 0, 1, 2},
        {0, 1, 2, 3}, {1, 2, 0, 3}, {0, 2, 1, 3}, {2, 0, 1, 3},
        {0, 1, 2, 3}, {1, 0, 2, 3}, {0, 1, 2, 3}, {0, 1, 2, 3}};
    // clang-format on
    typedef int Places __attribute__((vector_size(WIDTH * sizeof(int))));
    const int out = __builtin_popcount(bits);
    Places all, sorted;
    __builtin_memcpy(&all, j, sizeof(all));
    asm("vpermilps %2, %1, %0" : "=x"(sorted) : "x"(all), "m"(order[bits]));
    __builtin_memcpy(last, &sorted, sizeof(sorted));
    last += WIDTH - out;
    if (!others) return;
    asm("vpermilps %2, %1, %0" : "=x"(sorted) : "x"(all), "m"(order[bits ^ ((1 << WIDTH) - 1)]));
    __builtin_memcpy(*others, &sorted, sizeof(sorted));
    *others += out;
#else
    int near[WIDTH], far[WIDTH], n = 0, m = 0;
    for (int k = 0; k < WIDTH; k++) (bits >> k & 1 ? far[m++] : near[n++]) = j[k];
    last = std::copy(near, near + n, last);
    if (others) *others = std::copy(far, far + m, *others);
#endif
  }
  FSI_INLINE static Pack first(int n)
  {
    static constexpr double ones[2 * WIDTH] = {1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0};
    return Pack::load(ones + WIDTH - n);
  }
  template <int n, int N>
  FSI_INLINE static void add_rows(const Pack (&x)[n], double (*a)[N], const int *j)
  {
    static_assert(N == 2 || N % 4 == 0, "a row is two or fours of numbers");
    if constexpr (N == 2)
      Pack::add_rows(x[0], x[1], a[j[0]], a[j[1]], a[j[2]], a[j[3]], nullptr);
    else
      add_fours<0>(x, a[j[0]], a[j[1]], a[j[2]], a[j[3]], nullptr);
  }

  static constexpr int totals(int n)
  {
    return (n + 3) / 4;
  }
  template <int n, int N>
  FSI_INLINE static void add_to_all(const Pack (&x)[n], double (*a)[N], const int *j,
                                    Pack (&total)[totals(n)])
  {
    static_assert(N % 4 == 0, "a row is fours of numbers");
    add_fours<0>(x, a[j[0]], a[j[1]], a[j[2]], a[j[3]], total);
  }
  template <int n>
  FSI_INLINE static void add_totals(const Pack (&total)[totals(n)], const double *factors,
                                    double *a)
  {
    for (int k = 0; k < n; k += 4) total[k / 4].add_times(factors + k, k + 2 == n, a + k);
  }

 private:
  // from number K on; what x lacks in its last four is zero
  template <int K, int n>
  FSI_INLINE static void add_fours(const Pack (&x)[n], double *a, double *b, double *c, double *d,
                                   Pack *total)
  {
    const auto at = [&](int k) FSI_INLINE_LAMBDA {
      return k < n ? x[k < n ? k : 0] : Pack(0.0);
    };
    Pack *const own = total ? total + K / 4 : nullptr;
    if constexpr (K + 2 == n)
      Pack::add_rows(x[K], x[K + 1], a + K, b + K, c + K, d + K, own);
    else
      Pack::add_rows(x[K], at(K + 1), at(K + 2), at(K + 3), a + K, b + K, c + K, d + K, own);
    if constexpr (K + 4 < n) add_fours<K + 4>(x, a, b, c, d, total);
  }
};
#endif

// calls f with the flags among ALL that are set, as a constant
template <int ALL, int SET = 0, class F> void with_flags(int flags, F &&f)
{
  if constexpr (ALL == 0)
    f(std::integral_constant<int, SET>());
  else {
    constexpr int LOWEST = ALL & -ALL;
    if (flags & LOWEST)
      with_flags<(ALL & ~LOWEST), (SET | LOWEST)>(flags, f);
    else
      with_flags<(ALL & ~LOWEST), SET>(flags, f);
  }
}

// loop(T()), compiled for a processor that has what T needs
#if FSI_PACKS
template <class Loop> FSI_TARGET inline void run_packed(Loop loop)
{
  loop(Pack());
}
#endif
template <class T, class Loop> void run_loop(Loop loop)
{
#if FSI_PACKS
  if constexpr (std::is_same_v<T, Pack>)
    run_packed(loop);
  else
#endif
    loop(T());
}
// as many side by side as the processor can have
template <class Loop> void run_widest(Loop loop)
{
  have_packs() ? run_loop<Pack>(loop) : run_loop<double>(loop);
}

}    // namespace LAMMPS_NS::FSI

#endif
