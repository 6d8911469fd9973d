#pragma once

#include "engine/math.hpp"

#include <cstdint>

namespace bris {

/// Counter-based random numbers: a draw is a pure function of (seed, stream, counter), so that it
/// depends neither on threads nor on the order of insertion. SplitMix64 finaliser (Steele et al.
/// 2014).
class Random {
public:
    Random(std::uint64_t seed, std::uint64_t stream)
        : key_(mix(mix(seed + 0x9e3779b97f4a7c15u) ^ (stream * 0xbf58476d1ce4e5b9u + 1))) {}

    /// Number of draws of 64 bits so far; `continue_at` goes on after as many.
    std::uint64_t draws() const { return counter_; }
    void continue_at(std::uint64_t draws) { counter_ = draws; }

    /// 64 uniformly distributed bits.
    std::uint64_t bits() { return mix(key_ + 0x9e3779b97f4a7c15u * ++counter_); }
    /// Uniform in [0, 1).
    double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
    /// Uniform in [low, high).
    double uniform(double low, double high) { return low + (high - low) * uniform(); }
    /// Standard normal (Box-Muller, using one of the pair).
    double normal() {
        const double radius = std::sqrt(-2 * std::log(1 - uniform()));
        return radius * std::cos(2 * pi * uniform());
    }
    /// Uniform on the unit sphere.
    Vec3 direction() {
        const double z = uniform(-1, 1), angle = 2 * pi * uniform(), s = std::sqrt(1 - z * z);
        return {s * std::cos(angle), s * std::sin(angle), z};
    }
    /// Uniformly distributed rotation (Shoemake 1992).
    Quat rotation() {
        const double u = uniform(), a = 2 * pi * uniform(), b = 2 * pi * uniform();
        const double s = std::sqrt(1 - u), t = std::sqrt(u);
        return {t * std::cos(b), s * std::sin(a), s * std::cos(a), t * std::sin(b)};
    }

private:
    static std::uint64_t mix(std::uint64_t z) {
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }
    std::uint64_t key_;
    std::uint64_t counter_ = 0;
};

} // namespace bris
