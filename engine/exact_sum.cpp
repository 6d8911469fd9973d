#include "engine/exact_sum.hpp"

#include "engine/ranks.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

namespace bris {

namespace {
constexpr int lowest_exponent = -1074;
} // namespace

double exact_sum(std::span<const double> terms) {
    ExactSum sum;
    for (const double x : terms) sum.add(x);
    return sum.value();
}

void ExactSum::add(const ExactSum& other) {
    for (std::size_t k = 0; k < words_.size(); ++k) words_[k] += other.words_[k];
    waiting_ += other.waiting_ + 1;
    if (waiting_ >= most_waiting) carry();
}

void ExactSum::carry() {
    std::int64_t carried = 0;
    for (std::size_t k = 0; k < words; ++k) {
        const std::int64_t sum = words_[k] + carried;
        carried = k + 1 < words ? sum >> word_bits : 0; // rounds down
        words_[k] = sum - carried * (std::int64_t{1} << word_bits);
    }
    waiting_ = 1;
}

void ExactSum::add_over_ranks(std::span<ExactSum* const> sums) {
    std::vector<std::int64_t> all;
    for (ExactSum* sum : sums) {
        sum->carry(); // so that no word overflows
        all.insert(all.end(), sum->words_.begin(), sum->words_.end());
    }
    Ranks::sum(all);
    const std::int64_t* next = all.data();
    for (ExactSum* sum : sums) {
        std::copy_n(next, sum->words_.size(), sum->words_.begin());
        next += sum->words_.size();
        sum->carry();
    }
}

double ExactSum::value() const {
    if (words_[words] != 0) return std::numeric_limits<double>::quiet_NaN();
    ExactSum sum = *this;
    sum.carry();
    const bool is_negative = sum.words_[words - 1] < 0; // all others are positive
    if (is_negative) {
        for (std::int64_t& word : sum.words_) word = -word;
        sum.carry();
    }
    std::size_t top = words;
    while (top > 0 && sum.words_[top - 1] == 0) --top;
    if (top == 0) return 0;
    const auto word = [&](std::size_t k) { return static_cast<std::uint64_t>(sum.words_[k]); };
    const auto bit = [&](std::size_t k) { return word(k / word_bits) >> (k % word_bits) & 1; };
    const std::size_t end =
        (top - 1) * word_bits + static_cast<std::size_t>(std::bit_width(word(top - 1)));
    const std::size_t first = end > mantissa_bits ? end - mantissa_bits : 0; // bit that is kept
    std::uint64_t mantissa = 0;
    for (std::size_t k = end; k > first; --k) mantissa = mantissa << 1 | bit(k - 1);
    if (first > 0 && bit(first - 1) != 0) { // half or more is lost
        bool is_more = (mantissa & 1) != 0;
        for (std::size_t k = 0; k + 1 < first && !is_more; ++k) is_more = bit(k) != 0;
        mantissa += is_more ? 1 : 0;
    }
    const double size =
        std::ldexp(static_cast<double>(mantissa), static_cast<int>(first) + lowest_exponent);
    return is_negative ? -size : size;
}

} // namespace bris
