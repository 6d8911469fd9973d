#pragma once

#include "engine/report.hpp"
#include "scenarios/library/library_score.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// A variant of what is assimilated, and how well it predicts the tests at one pressure.
struct ScoredVariant {
    std::string name;
    double pressure = 0; ///< Pa, of the predicted tests
    LibraryObservations observed = {};
    std::vector<SpecimenScore> scores = {};
};

/// The variants of a comparison: what is asked for, then single measurements, additions, and the
/// sham. `can_observe_sensors`: the library has sensor rocks before the learned strain.
struct Variant {
    std::string name;
    LibraryObservations observed;
    bool sham = false;
};
std::vector<Variant> compared_variants(const LibraryObservations& asked, bool can_observe_sensors);

/// The scores: for each quantity the ratios of errors to the prior and to single runs with their
/// 95 % intervals, the share of numbers inside the 90 % band, and the ratio of CRPS; and how well
/// friction is estimated.
Report scores_of(const ScoredVariant& scored, double last_strain);

/// Writes all ratios as CSV, one line for each variant, pressure and quantity. Throws OutputError.
void write_scores(const std::filesystem::path& csv, const std::vector<ScoredVariant>& variants,
                  double last_strain);

/// Writes a line for each variant, pressure and specimen, in the order of the file: the distance of
/// its measurements from those of the library, its true and learned friction with its 90 % band,
/// ratios of errors to the prior and shares of numbers inside the 90 % band. Throws OutputError.
void write_specimen_scores(const std::filesystem::path& csv,
                           const std::vector<ScoredVariant>& variants, double last_strain);

/// Draws a median specimen (measured, prior, and predicted with its 90 % band), the ratio of errors
/// by strain, learned against true friction, and the histogram of probabilities.
bool draw_scores(const std::filesystem::path& png, const SpecimenLibrary& library,
                 const LibrarySpecimen& example, const LibraryPrediction& predicted,
                 const LibraryPrediction& prior, std::size_t pressure,
                 const std::vector<SpecimenScore>& scores);

/// Index of the specimen whose ratio of errors of smoothed q is the median.
std::size_t median_specimen(const std::vector<SpecimenScore>& scores);

} // namespace bris
