#pragma once

#include "engine/math.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace bris {

/// The sum of doubles without any rounding, as a number of fixed point with all the bits that a
/// double can have: it does not depend on the order of the terms, nor on which thread or rank adds
/// them. (Kulisch, Computer Arithmetic and Validity, 2013, long accumulator; words of 32 bits in
/// 64, so that carries can wait.)
class ExactSum {
public:
    /// Adds a term. One that is not finite makes the value NaN.
    void add(double x);
    void add(const ExactSum& other);
    /// The double next to the sum; of two that are equally near, the even one.
    double value() const;

private:
    static constexpr std::size_t words = 67; ///< from 2^-1074 to 2^1070
    static constexpr std::uint32_t most_waiting = 1u << 30;
    void carry();
    void carry_if_due(std::uint32_t terms);

    std::array<std::int64_t, words + 1> words_{}; ///< the last one counts terms that are not finite
    std::uint32_t waiting_ = 0;                   ///< terms since carries were made
};

/// The same of the components of vectors.
class ExactVector {
public:
    void add(const Vec3& x) {
        for (Eigen::Index k = 0; k < 3; ++k) sums_[static_cast<std::size_t>(k)].add(x[k]);
    }
    Vec3 value() const { return {sums_[0].value(), sums_[1].value(), sums_[2].value()}; }

private:
    std::array<ExactSum, 3> sums_;
};

/// The sum of numbers, rounded once.
double exact_sum(std::span<const double> terms);

} // namespace bris
