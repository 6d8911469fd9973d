#pragma once

#include "engine/estimation/leave_one_out_regression.hpp"
#include "scenarios/library/library_score.hpp"
#include "scenarios/library/specimen_library.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// What of the sensor rocks is used to estimate the profile of the rings.
enum class RingSensors {
    none,
    tilt,   ///< rotation about horizontal axes
    tracked ///< displacement outward and upward
};

/// The radial strains of the rings of a membrane at one strain of a test, from what is measured at
/// the same strain: the volumetric strain, and the sensor rocks. The mean profile of a library is
/// scaled so that it encloses the measured volume; a regression over the library tells by how much
/// the rings depart from it where sensor rocks have moved otherwise.
class RingProfile {
public:
    /// `pressure`: index of the library's pressure; `coarse`: index of the strain (LibraryAxis).
    RingProfile(const SpecimenLibrary& library, std::size_t pressure, std::size_t coarse,
                RingSensors sensors);

    /// The mean profile, scaled to the measured volume.
    Vector scaled_mean(const LibraryTest& measured) const;
    struct Estimate {
        Vector mean, deviation; ///< by ring from below; deviation: of the error
    };
    /// With the departures that the regression predicts.
    Estimate estimate(const LibraryTest& measured) const;
    double freedom() const { return regression_.freedom(); } ///< of the deviations
    /// Correlation of the errors of neighbouring rings, mean over the rings.
    double correlation_of_neighbours() const;

private:
    double mean_radial_strain(const LibraryTest& test) const;
    Vector features(const LibraryTest& test) const;
    Vector rings(const LibraryTest& test) const;
    LeaveOneOutRegression made(const SpecimenLibrary& library, std::size_t pressure) const;

    double strain_;
    std::size_t fine_, coarse_, rings_, sensors_count_;
    RingSensors sensors_;
    Vector mean_;        // of the library, by ring
    double mean_radial_; // mean radial strain of its cylinders
    LeaveOneOutRegression regression_;
};

/// How well ring profiles are estimated, over specimens that the library does not contain.
struct RingScore {
    std::string variant;             ///< "volume", "volume_and_tilt", "volume_and_tracked"
    double pressure = 0, strain = 0; ///< Pa, axial strain
    RatioInterval over_single;       ///< root mean square error over that of single specimens
    RatioInterval over_scaled_mean;  ///< over that of the mean profile scaled by volume
    double inside = 0;               ///< share of the rings that lie in the 90 % band
    double neighbours = 0;           ///< correlation of the errors of neighbouring rings
};

/// Scores all variants at half and at the whole of the library's last strain and at all its
/// pressures: each specimen of the library is estimated from all others.
std::vector<RingScore> score_rings(const SpecimenLibrary& library);

/// Writes the scores as CSV. Throws OutputError.
void write_ring_scores(const std::filesystem::path& csv, const std::vector<RingScore>& scores);

} // namespace bris
