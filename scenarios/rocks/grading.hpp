#pragma once

#include "components/clump.hpp"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace bris {

/// One sieve of a grading: size (m) and the limits of the share of the mass that passes it, 0 to 1.
struct Sieve {
    double size, lower, upper;
    double middle() const { return 0.5 * (lower + upper); }
};

/// A grading band. Its middle curve is linear in the logarithm of the size between the sieves that
/// have limits, as on the usual semi-logarithmic sheet, and falls to zero at half the finest of
/// them (the next sieve of the series).
struct Grading {
    std::string name;
    std::vector<Sieve> sieves; ///< coarsest first; only those with limits

    /// Share of the mass that passes size `size` (m) on the middle curve, 0 to 1.
    double passing(double size) const;
    /// Size (m) that a share `share` of the mass passes on the middle curve; the inverse of
    /// passing.
    double size_at(double share) const;
};

/// Reads a band: columns sieve_mm, lower_percent, upper_percent; "-" where the specification sets
/// no limit. Throws InputError with file:line unless sizes fall, 0 <= lower <= upper <= 100, limits
/// do not rise as sizes fall, the coarsest passes 100 % and at least two sieves have limits.
Grading read_grading(const std::filesystem::path& path);

/// A rock: which clump of the library, at which sieve size (m).
struct RockChoice {
    std::size_t clump;
    double sieve;
};

struct RockSample {
    std::vector<RockChoice> rocks; ///< in random order
    double solid_volume = 0;       ///< m³, of all rocks
    double smallest_size = 0;      ///< m, where the fine tail was cut
    double truncated_fraction = 0; ///< share of the mass of the full grading that is finer
};

/// `count` rocks of the middle curve, cut at `smallest_size` (m; 0: the finest sieve with limits).
/// By mass: the rocks are laid end to end from coarse to fine, each as long as its mass, and each
/// has the size of the curve at its own middle; so the mass on every sieve is that of the curve to
/// within half a rock. Each clump is used equally often, in an order drawn from the seed. Densities
/// are taken as equal. Throws InputError for no clumps, no rocks, a size at which nothing is left,
/// or where the curve is flat, for a number that no volume of rocks has.
RockSample sample_rocks(const Grading& grading, std::span<const Clump> clumps, std::size_t count,
                        std::uint64_t seed, double smallest_size = 0);

struct SieveResult {
    double size;         ///< m
    double passing;      ///< share of the mass of these rocks
    double with_tail;    ///< the same with the truncated tail put back, to be held against the band
    double lower, upper; ///< the band
    bool within;         ///< with_tail inside the band, with 0.1 % for the last rock
};

struct SieveReport {
    std::vector<SieveResult> sieves; ///< coarsest first
    bool within = true;              ///< all of them
};

/// Sieves a specimen: each rock passes the sieves larger than its size. `truncated_fraction` is
/// that of the sample, 0 if nothing was cut. Throws InputError for an unknown clump or no rocks.
SieveReport sieve_back(std::span<const RockChoice> rocks, std::span<const Clump> clumps,
                       const Grading& grading, double truncated_fraction = 0);

/// Several lines for people: the truncated tail, and a line for each sieve against its band.
std::string describe(const RockSample& sample, const SieveReport& report);

} // namespace bris
