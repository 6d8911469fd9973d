#pragma once

#include "engine/math.hpp"
#include "scenarios/library/specimen_library.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// Where the sensor rocks of a library may be displaced to at one strain, given the volumetric
/// strain of the specimen at the same strain: a linear regression of the displacement of each rock
/// on the volume, with the covariance of its residuals over the specimens. A recording is suspected
/// only if it is farther from its prediction than every recording of the library is from that by
/// the other specimens.
class SensorPredictive {
public:
    /// `pressure`: index of the library's pressure; `coarse`: index of the strain (LibraryAxis);
    /// `without`: index of a specimen that is left out. Throws InputError for fewer specimens than
    /// `fewest`.
    static constexpr std::size_t none = static_cast<std::size_t>(-1), fewest = 20;
    SensorPredictive(const SpecimenLibrary& library, std::size_t pressure, std::size_t coarse,
                     std::size_t without = none);

    /// Volumetric strain and displacement (m) outward, sideways and upward of a sensor rock.
    struct Motion {
        double volume = 0;
        Vec3 displacement = Vec3::Zero();
    };
    static Motion motion_in(const SpecimenLibrary& library, const LibraryTest& test,
                            std::size_t coarse, std::size_t sensor);
    /// Mean and standard deviation (m) of the displacement at a volumetric strain.
    Vec3 mean(std::size_t sensor, double volume) const { return fits_[sensor].mean(volume); }
    Vec3 deviation(std::size_t sensor) const { return fits_[sensor].deviation; }
    /// Distance from the prediction relative to the largest in the library: above 1 no specimen
    /// excuses it.
    double distance(std::size_t sensor, const Motion& motion) const {
        return fits_[sensor].distance(motion) / largest_;
    }

private:
    /// The regression for one rock.
    struct Fit {
        double count = 0, mean_volume = 0, spread = 0; // spread: sum of squares about the mean
        Vec3 at_mean = Vec3::Zero(), slope = Vec3::Zero(), deviation = Vec3::Zero();
        Mat3 inverse = Mat3::Zero(); // of the covariance of the residuals
        Vec3 mean(double volume) const { return at_mean + (volume - mean_volume) * slope; }
        double distance(const Motion& motion) const;
    };
    static Fit fit(const std::vector<Motion>& motions, std::size_t without);

    double largest_ = 0;
    std::vector<Fit> fits_;
};

/// Shares of the recordings that are suspected, over the specimens of a library, each judged by the
/// others.
struct SuspicionScore {
    std::string fault;               ///< "none", or the fault that all recordings have in turn
    double pressure = 0, strain = 0; ///< Pa, axial strain
    double beside = 0, centre = 0;   ///< of rocks beside the membrane and in the centre
    double tests = 0;                ///< share of the tests with any suspected recording
};
/// At half and at the whole of the library's last strain and at all its pressures. For the usual
/// ten sensor rocks; empty for a library with others.
std::vector<SuspicionScore> score_suspicions(const SpecimenLibrary& library);

/// Writes the scores as CSV. Throws OutputError.
void write_suspicions(const std::filesystem::path& csv, const std::vector<SuspicionScore>& scores);

} // namespace bris
