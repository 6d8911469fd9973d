#pragma once

#include "engine/archive.hpp"
#include "engine/estimation/inertial_filter.hpp"
#include "engine/estimation/printed_filter.hpp"

#include <optional>
#include <string>
#include <vector>

namespace bris {

/// Which mathematics turns a forecast and a measurement into an estimate.
enum class FilterKind : std::uint32_t {
    printed,  ///< as the report prints it, errors and all
    corrected ///< the same with them mended, as an error state: displacement and velocity,
              ///< attitude, spin (InertialFilter)
};
inline const std::vector<std::string> filter_names{"printed", "corrected"};

struct FilterSettings {
    FilterKind kind = FilterKind::corrected;
    // deviations at the first sample: of placement, of levelling, and of what came since
    double position = 3e-3, velocity = 1e-3;         ///< m, m/s
    double attitude = 0.03, angular_velocity = 1e-2; ///< rad, rad/s
    // what the model may miss: white noise of acceleration, where inertia matters; random walks,
    // where it does not
    double acceleration_density = 1e-4;         ///< (m/s2)2/Hz
    double angular_acceleration_density = 1e-2; ///< (rad/s2)2/Hz
    double drift = 0;                           ///< m2 in a unit of time, or of what stands for it
    double turning = 0;                         ///< rad2, likewise
    double gate = 0.99; ///< probability with which a right measurement is let in; 1: all are
    unsigned lag =
        0; ///< analyses that a late measurement may have been passed by; 0: late ones are refused
};

/// What the simulation says of a body, at the time of a measurement: s, or strain in a test that
/// knows no time.
struct BodyForecast {
    double time = 0;
    RigidState state;
};

/// What was measured of it. NaN: not measured. Deviations hold for each axis.
struct Measured {
    Vec3 position, velocity, angular_velocity;
    Vec3 up; ///< unit vector upwards, in the body's axes: tilt without yaw
    Quat attitude;
    double position_deviation = 1e-4, velocity_deviation = 1e-3, angular_velocity_deviation = 1e-2,
           attitude_deviation = 0.01;
    Measured();
    bool is_empty() const; ///< nothing was
};

/// What a body's motion is to be corrected by.
struct Analysis {
    Vec3 shift = Vec3::Zero(), velocity = Vec3::Zero(), turn = Vec3::Zero(),
         angular_velocity = Vec3::Zero(); ///< m, m/s, rad, rad/s
    unsigned accepted = 0, refused = 0;   ///< vectors measured
    double largest_distance = 0; ///< squared, of an innovation: chi square of three degrees
};

/// What an analysis made of a vector measured, axis by axis. NaN: not measured.
struct AnalysisStatistics {
    Vec3 innovation, gain, deviation;     ///< m or rad; 1; m or rad, after it
    double normalised_innovation_squared; ///< of the innovation: chi square of three degrees
    AnalysisStatistics();
};

/// Where a body was, by all that was measured of it before and since.
struct SmoothedPose {
    double time = 0; ///< s, or strain
    Vec3 position = Vec3::Zero();
    Quat attitude = Quat::Identity();
    Vec3 position_deviation = Vec3::Zero(),
         attitude_deviation = Vec3::Zero(); ///< m and rad, along the world's axes
};

/// The filter of one sensor: a forecast and a measurement in, a correction out. It remembers its
/// last analyses (FilterSettings::lag), and goes back to them for measurements that come late.
class SensorFilter {
public:
    SensorFilter() = default;
    explicit SensorFilter(const FilterSettings& settings);

    Analysis update(const BodyForecast& forecast, const Measured& measured);
    /// Part of the last correction that the body is not given. A filter that remembers goes on from
    /// its own estimate; any other takes the body's motion for its estimate, and knows so much less
    /// of it. `printed` knows of nothing.
    void withhold(const Analysis& part);
    bool remembers() const { return settings_.lag > 0; }

    /// Remembers the simulated motion, without a measurement: late ones of about this time will ask
    /// for it.
    void note(const BodyForecast& now);
    /// Whether an analysis has passed this time.
    bool has_passed(double time) const { return begun_ && time < last_time_; }
    /// Takes a measurement in its place: goes back to the analysis before it, and forward again
    /// over what has been simulated and measured since. The correction is that of the newest
    /// analysis (note() where the body is now). Between two analyses the body is taken to have
    /// moved straight. Nothing: it is later than the filter looks back.
    std::optional<Analysis> update_late(double time, const Measured& measured);
    /// The poses at the analyses that it remembers, by what came after them too (fixed-lag
    /// smoothing).
    std::vector<SmoothedPose> smoothed() const;
    /// What the last analysis made of place and attitude.
    const AnalysisStatistics& position() const { return position_; }
    const AnalysisStatistics& attitude() const { return attitude_; }
    /// Of the error of position, velocity, rotation and spin (12 x 12), after the last analysis.
    Matrix covariance() const { return filter_.covariance().topLeftCorner<12, 12>(); }

    void save(Archive& archive, const std::string& path) const;
    void load(const Archive& archive, const std::string& path);

private:
    /// An analysis, with what it takes to do it again.
    struct Snapshot {
        BodyForecast forecast;
        Measured measured;
        RigidState estimate; // by all that has come since, as far as it is of this time or before
        RigidState given;    // what the simulation went on from
        Matrix root;         // of the error's covariance
    };

    Analysis update_as_printed(const BodyForecast& forecast, const Measured& measured, double dt);
    void move_on(double dt, const RigidState& forecast);
    Analysis observe(const Measured& measured);
    Mat3 covariance_of(InertialFilter::Part part) const;
    AnalysisStatistics analysis_statistics(const Verdict& verdict, InertialFilter::Part part,
                                           const Mat3& before, double noise) const;
    static Analysis difference(const RigidState& a, const RigidState& b);
    static RigidState carried(const RigidState& estimate, const RigidState& given,
                              const RigidState& later, double dt);
    Transition transition(double dt, const Vec3& angular_velocity) const;
    void remember(const Snapshot& snapshot);
    void go_back_to(const Snapshot& snapshot);
    Analysis update_again(std::size_t k);
    void save_window(Archive& archive, const std::string& path) const;
    void load_window(const Archive& archive, const std::string& path);

    FilterSettings settings_;
    InertialFilter filter_; // `corrected` uses its first four parts only
    PrintedFilter printed_;
    AnalysisStatistics position_, attitude_;
    double last_time_ = 0;
    bool begun_ = false;
    std::vector<Snapshot> window_; // in order of time: one more than `lag`
};

} // namespace bris
