#pragma once

#include "engine/estimation/kalman.hpp"

namespace bris {

namespace detail {

/// [a b; c d] for each of the axes of a state [positions; velocities].
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

/// Position and velocity over a time T (s) in which acceleration is white noise of density q,
/// (m/s2)2/Hz, the same for each axis and exact for any T: k times T/k gives the same.
inline Transition white_acceleration(int axes, double T, double q) {
    return {detail::for_each_axis(axes, 1, T, 0, 1),
            detail::for_each_axis(axes, q * T * T * T / 3, q * T * T / 2, q * T * T / 2, q * T)};
}

} // namespace bris
