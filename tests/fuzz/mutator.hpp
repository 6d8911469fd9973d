#pragma once

#include "engine/random.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// Makes hostile inputs from valid ones: bits flipped, bytes, numbers, lines and blocks replaced,
/// removed, repeated and exchanged, ends cut off, and parts of one input put into another. The same
/// seed and number give the same input.
class Mutator {
public:
    /// `in_place`: bytes are only overwritten, or the end cut off.
    Mutator(std::vector<std::string> valid, std::uint64_t seed, bool in_place = false)
        : valid_(std::move(valid)), seed_(seed), in_place_(in_place) {}

    std::string input(std::uint64_t number) const;

private:
    std::vector<std::string> valid_;
    std::uint64_t seed_;
    bool in_place_;
};

} // namespace bris
