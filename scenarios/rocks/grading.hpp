#pragma once

#include "components/clump.hpp"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace bris {

/// One sieve of a grading: its size (m) and the limits of the mass fraction that passes it, 0 to 1.
struct Sieve {
    double size, lower, upper;
    double middle() const { return 0.5 * (lower + upper); }
};

/// A grading band. Its mid-range curve is linear in the logarithm of the size between the sieves
/// that have limits, as on the usual semi-logarithmic chart. Below the finest of them it falls to
/// zero at half its size (the next sieve of the series).
struct Grading {
    std::string name;
    std::vector<Sieve> sieves; ///< coarsest first; only those with limits

    /// Mass fraction that passes the size `size` (m) on the mid-range curve, 0 to 1.
    double passing(double size) const;
    /// Size (m) that the mass fraction `share` passes on the mid-range curve; inverse of passing.
    double size_at(double share) const;
};

/// Reads a grading band from a CSV file with the columns sieve_mm, lower_percent, upper_percent;
/// "-" where the specification sets no limit. Throws InputError with file:line unless the sizes
/// decrease, 0 <= lower <= upper <= 100, the limits do not increase towards finer sieves, 100 %
/// passes the coarsest sieve, and at least two sieves have limits.
Grading read_grading(const std::filesystem::path& path);

/// A rock: index of its clump in the library, and its sieve size (m).
struct RockChoice {
    std::size_t clump;
    double sieve;
};

/// Rocks drawn from a grading.
struct RockSample {
    std::vector<RockChoice> rocks; ///< in random order
    double solid_volume = 0;       ///< m³, of all rocks
    double smallest_size = 0;      ///< m, size below which the grading was truncated
    double truncated_fraction = 0; ///< mass fraction of the full grading that is finer
};

/// Samples `count` rocks from the mid-range curve, truncated below `smallest_size` (m; 0: the
/// finest sieve with limits). The cumulative mass axis of the curve is divided, from coarse to
/// fine, into intervals that are the masses of the rocks; each rock has the size of the curve at
/// the middle of its interval. The mass on every sieve therefore agrees with the curve to within
/// half a rock. Each clump is used equally often, in an order drawn from the seed. All rocks are
/// taken to have the same density. Throws InputError if there are no clumps or no rocks, if
/// nothing is left above `smallest_size`, or if no volume of rocks gives exactly this count (where
/// the curve is flat).
RockSample sample_rocks(const Grading& grading, std::span<const Clump> clumps, std::size_t count,
                        std::uint64_t seed, double smallest_size = 0);

/// What passes one sieve, as mass fractions from 0 to 1.
struct SieveResult {
    double size;         ///< m
    double passing;      ///< of these rocks
    double with_tail;    ///< of these rocks and the truncated fraction; compared with the band
    double lower, upper; ///< limits of the band
    bool within;         ///< with_tail is inside the band, with a tolerance of 0.1 % for one rock
};

/// Sieve analysis of a specimen.
struct SieveReport {
    std::vector<SieveResult> sieves; ///< coarsest first
    bool within = true;              ///< all sieves are within the band
};

/// Computes the sieve analysis of a specimen: each rock passes the sieves larger than its sieve
/// size. `truncated_fraction`: that of the sample, 0 if the grading was not truncated. Throws
/// InputError for an unknown clump or no rocks.
SieveReport sieve_back(std::span<const RockChoice> rocks, std::span<const Clump> clumps,
                       const Grading& grading, double truncated_fraction = 0);

/// Text for people: the truncated fraction, and for each sieve what passes it and its band.
std::string describe(const RockSample& sample, const SieveReport& report);

} // namespace bris
