#pragma once
/// Two doubles at a time, for innermost loops. Only additions, multiplications, divisions and square roots: equal bits
/// on every machine.
#include <cmath>
#include <cstdint>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "core/angles.hpp"

namespace noctule {

using Pair = double __attribute__((vector_size(16)));
using PairMask = std::int64_t __attribute__((vector_size(16)));

/// What templates over double and Pair need.
[[nodiscard]] inline Pair square_root(Pair v) {
#ifdef __SSE2__
  return _mm_sqrt_pd(v);
#else
  return Pair{std::sqrt(v[0]), std::sqrt(v[1])};
#endif
}
[[nodiscard]] inline double square_root(double v) {
  return std::sqrt(v);
}
[[nodiscard]] inline Pair select(PairMask which, Pair yes, Pair no) {
  return which ? yes : no;
}
[[nodiscard]] inline double select(bool which, double yes, double no) {
  return which ? yes : no;
}
[[nodiscard]] inline Pair spread(double v, Pair) {
  return Pair{v, v};
}
[[nodiscard]] inline double spread(double v, double) {
  return v;
}

/// Angle less the nearest multiple of 2 pi, in [-pi, pi] up to rounding; for angles below 1e6.
template <class T>
[[nodiscard]] inline T wrap_near(T angle) {
  constexpr double shift = 0x1.8p52;  // adding it rounds to an integer
  const T turns = (angle * (1.0 / kTwoPi) + shift) - shift;
  return angle - turns * kTwoPi;
}

/// atan2(y, x) to 3e-16, and 0 for (0, 0): argument reduced to [-tan(pi/8), tan(pi/8)], then the rational approximation
/// of the Cephes library (Moshier). Finite arguments only.
template <class T>
[[nodiscard]] inline T fast_atan2(T y, T x) {
  const T zero = spread(0.0, x);
  const T ax = select(x < zero, -x, x), ay = select(y < zero, -y, y);
  const auto steep = ay > ax;
  const T large = select(steep, ay, ax), small = select(steep, ax, ay);
  const auto wide = small > 0.41421356237309503 * large;
  const T above = select(wide, small - large, small);
  const T below = select(wide, small + large, large);
  const T t = above / select(below == zero, spread(1.0, x), below);
  const T z = t * t;
  const T p = ((((-8.750608600031904122785e-1 * z - 1.615753718733365076637e1) * z - 7.500855792314704667340e1) * z -
                1.228866684490136173410e2) *
                   z -
               6.485021904942025371773e1) *
              z;
  const T q = ((((z + 2.485846490142306297962e1) * z + 1.650270098316988542046e2) * z + 4.328810604912902668951e2) * z +
               4.853903996359136964868e2) *
                  z +
              1.945506571482613964425e2;
  T angle = t + t * (p / q);
  angle = select(wide, angle + 0.25 * kPi, angle);
  angle = select(steep, 0.5 * kPi - angle, angle);
  angle = select(x < zero, kPi - angle, angle);
  return select(y < zero, -angle, angle);
}

/// out[i] = atan2(y[i], x[i])
template <std::size_t N>
inline void fast_atan2(const double* y, const double* x, double* out) {
  std::size_t i = 0;
  for (; i + 2 <= N; i += 2) {
    const Pair angle = fast_atan2(Pair{y[i], y[i + 1]}, Pair{x[i], x[i + 1]});
    out[i] = angle[0];
    out[i + 1] = angle[1];
  }
  for (; i < N; ++i) out[i] = fast_atan2(y[i], x[i]);
}

}  // namespace noctule
