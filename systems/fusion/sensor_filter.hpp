#pragma once

#include "engine/archive.hpp"
#include "engine/estimation/motion_filter.hpp"
#include "engine/estimation/printed_filter.hpp"

#include <string>
#include <vector>

namespace bris {

/// Filter that turns a forecast and a measurement into an estimate.
enum class FilterKind : std::uint32_t {
    /// Exactly as printed in the SmartRock report, including its errors.
    printed,
    /// The same with the errors corrected, as an error-state filter of displacement, velocity,
    /// attitude and angular velocity (MotionFilter).
    corrected
};
const std::vector<std::string>& texts_of(FilterKind);

struct FilterSettings {
    FilterKind kind = FilterKind::corrected;
    // Standard deviations at the first sample: of the placement and levelling of the sensor rock
    // and of its motion since then.
    double position = 3e-3, velocity = 1e-3;         ///< m, m/s
    double attitude = 0.03, angular_velocity = 1e-2; ///< rad, rad/s
    // Model errors: white noise of acceleration, where inertia matters; random walks of position
    // and attitude, where it does not.
    double acceleration_density = 1e-4;         ///< (m/s2)2/Hz
    double angular_acceleration_density = 1e-2; ///< (rad/s2)2/Hz
    double drift = 0;                           ///< m2 per unit of time, or of strain
    double turning = 0;                         ///< rad2 per unit of time, or of strain
    /// Probability with which the gate accepts a consistent measurement; 1: it accepts all.
    double gate = 0.99;
};

/// Forecast of a body's state by the simulation at the time of a measurement: s, or strain in a
/// staged test.
struct BodyForecast {
    double time = 0;
    RigidState state;
};

/// Measurement of a body. NaN: not measured. Standard deviations are per axis.
struct Measured {
    Vec3 position, velocity, angular_velocity;
    Vec3 up; ///< upward unit vector in the body's axes: measures tilt but not yaw
    Quat attitude;
    double position_deviation = 1e-4, velocity_deviation = 1e-3, angular_velocity_deviation = 1e-2,
           attitude_deviation = 0.01;
    Measured();
    bool is_empty() const; ///< true if nothing was measured
};

/// Result of an analysis: the correction of a body's motion.
struct Analysis {
    /// m, m/s, rad, rad/s
    Vec3 shift = Vec3::Zero(), velocity = Vec3::Zero(), turn = Vec3::Zero(),
         angular_velocity = Vec3::Zero();
    unsigned accepted = 0, refused = 0; ///< number of measured vectors
    /// Largest normalised innovation squared: chi-squared with three degrees of freedom.
    double largest_distance = 0;
};

/// Statistics of the analysis of one measured vector, axis by axis. NaN: not measured.
struct AnalysisStatistics {
    /// m or rad; dimensionless; m or rad, standard deviation after the analysis.
    Vec3 innovation, gain, deviation;
    double normalised_innovation_squared; ///< chi-squared with three degrees of freedom
    AnalysisStatistics();
};

/// The filter of one sensor, which computes a correction from a forecast and a measurement.
class SensorFilter {
public:
    SensorFilter() = default;
    explicit SensorFilter(const FilterSettings& settings);

    Analysis update(const BodyForecast& forecast, const Measured& measured);
    /// Informs the filter that this part of its last correction is not applied to the body: it
    /// continues from the motion of the body and increases its covariance by the withheld part. The
    /// filter `printed` ignores the call.
    void withhold(const Analysis& part);
    /// Statistics of the last analysis of position and attitude.
    const AnalysisStatistics& position() const { return position_; }
    const AnalysisStatistics& attitude() const { return attitude_; }
    /// Error covariance of position, velocity, rotation and angular velocity (12 x 12) after the
    /// last analysis.
    Matrix covariance() const;

    void save(Archive& archive, const std::string& path) const;
    void load(const Archive& archive, const std::string& path);

private:
    Analysis update_as_printed(const BodyForecast& forecast, const Measured& measured, double dt);
    void move_on(double dt, const RigidState& forecast);
    Analysis observe(const Measured& measured);
    Mat3 covariance_of(MotionFilter::Part part) const;
    AnalysisStatistics analysis_statistics(const ObservationResult& verdict,
                                           MotionFilter::Part part, const Mat3& before,
                                           double noise) const;
    static Analysis difference(const RigidState& a, const RigidState& b);

    FilterSettings settings_;
    MotionFilter filter_;
    PrintedFilter printed_;
    AnalysisStatistics position_, attitude_;
    double last_time_ = 0;
    bool begun_ = false;
};

} // namespace bris
