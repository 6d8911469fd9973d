#pragma once

#include "engine/estimation/kalman.hpp"

namespace bris {

namespace detail {

/// The block [a b; c d] for each axis of a state [positions; velocities].
inline Matrix for_each_axis(int axes, double a, double b, double c, double d) {
    Matrix m = Matrix::Zero(2 * axes, 2 * axes);
    for (int k = 0; k < axes; ++k) {
        m(k, k) = a;
        m(k, axes + k) = b;
        m(axes + k, k) = c;
        m(axes + k, axes + k) = d;
    }
    return m;
}

} // namespace detail

/// Transition of position and velocity over a time T (s) under white-noise acceleration with the
/// spectral density q, (m/s2)2/Hz, the same for each axis. It is exact for any T: k steps of T/k
/// give the same result as one of T.
inline Transition white_acceleration(int axes, double T, double q) {
    return {detail::for_each_axis(axes, 1, T, 0, 1),
            detail::for_each_axis(axes, q * T * T * T / 3, q * T * T / 2, q * T * T / 2, q * T)};
}

} // namespace bris
