#pragma once

#include "engine/math.hpp"

#include <array>
#include <bit>
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
    void add(double x) {
        const auto bits = std::bit_cast<std::uint64_t>(x);
        if (bits << 1 == 0) return; // zero
        const std::uint64_t exponent = bits >> (mantissa_bits - 1) & 0x7ff;
        std::uint64_t mantissa = bits & ((std::uint64_t{1} << (mantissa_bits - 1)) - 1);
        if (exponent == 0x7ff) {
            ++words_[words];
            return;
        }
        if (exponent > 0) mantissa |= std::uint64_t{1} << (mantissa_bits - 1);
        const std::uint64_t place = exponent > 0 ? exponent - 1 : 0; // of the lowest bit
        const std::size_t first = place / word_bits, shift = place % word_bits;
        const std::int64_t sign = bits >> 63 != 0 ? -1 : 0;
        const auto add_to = [&](std::size_t word, std::uint64_t part) {
            words_[word] += (static_cast<std::int64_t>(part) ^ sign) - sign;
        };
        add_to(first, mantissa << shift & word_mask);
        add_to(first + 1, mantissa >> 1 >> (word_bits - 1 - shift) & word_mask);
        add_to(first + 2, mantissa >> word_bits >> (word_bits - shift));
        if (++waiting_ >= most_waiting) carry();
    }
    void add(const ExactSum& other);
    /// The double next to the sum; of two that are equally near, the even one.
    double value() const;
    /// Makes each of these the sum of what all ranks have in its place.
    static void add_over_ranks(std::span<ExactSum* const> sums);

private:
    static constexpr unsigned word_bits = 32, mantissa_bits = 53;
    static constexpr std::uint64_t word_mask = 0xffffffff;
    static constexpr std::size_t words = 67; ///< from 2^-1074 to 2^1070
    static constexpr std::uint32_t most_waiting = 1u << 30;
    void carry();

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
    ExactSum& operator[](std::size_t k) { return sums_[k]; }

private:
    std::array<ExactSum, 3> sums_;
};

/// The sum of numbers, rounded once.
double exact_sum(std::span<const double> terms);

} // namespace bris
