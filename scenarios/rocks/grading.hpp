#pragma once

#include "components/clump.hpp"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
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
    /// How the file was read, for people, where it is not in the form of assets/gradings; else "".
    std::string read_as = {};

    /// Mass fraction that passes the size `size` (m) on the mid-range curve, 0 to 1.
    double passing(double size) const;
    /// Size (m) that the mass fraction `share` passes on the mid-range curve; inverse of passing.
    double size_at(double share) const;
};

/// Reads a grading from a table (read_text_table) as laboratories write it. One column has the
/// sizes of the sieves ("sieve", "size", "opening", "aperture" or "diameter" in its title; mm
/// unless the title has another unit), from coarse to fine or from fine to coarse. Either two
/// columns have the limits of what passes ("lower" and "upper", or "min" and "max"; "-" where the
/// specification sets no limit), or one has what passes ("pass" or "finer") or is retained
/// ("retain"; on each sieve, or cumulative), or both, which must then agree. Shares are in percent
/// or fractions of the mass; a row "pan" has what is finer. Where the coarsest sieve retains up to
/// 20 %, the curve goes on straight to the size that all passes, as one more sieve. Throws
/// InputError with file:line unless 0 <= lower <= upper <= 100 %, the shares do not increase
/// towards finer sieves, and at least two sieves have them.
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

/// Number of rocks in a solid volume (m³) of the mid-range curve, truncated below `smallest_size`
/// as in sample_rocks, by integration: nothing is drawn. Throws InputError as sample_rocks does.
double expected_rocks(const Grading& grading, std::span<const Clump> clumps, double solid_volume,
                      double smallest_size = 0);

/// What can be counted on before rocks are drawn: the most rocks that a scene may have.
inline constexpr double most_rocks = 1e6;

/// The finest sieve (m) at which the grading can be truncated so that a solid volume (m³) has at
/// most `most` rocks, and their number; the coarsest sieve that retains something if there are
/// always more.
std::pair<double, double> cut_for(const Grading& grading, std::span<const Clump> clumps,
                                  double solid_volume, double most = most_rocks);

/// Throws InputError, naming the option that truncates the grading and the sieve for it, if a solid
/// volume (m³) has more than most_rocks.
void require_countable(const Grading& grading, std::span<const Clump> clumps, double solid_volume,
                       double smallest_size, const std::string& option);

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
std::string sentence_of(const RockSample& sample, const SieveReport& report);

} // namespace bris
