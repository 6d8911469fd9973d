#include "systems/fusion/sensor_filter.hpp"

#include "engine/errors.hpp"
#include "engine/estimation/chi_squared.hpp"
#include "engine/estimation/constant_velocity.hpp"
#include "engine/signal/attitude.hpp"

#include <fmt/format.h>

#include <limits>

namespace bris {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

Mat3 square(double deviation) { return deviation * deviation * Mat3::Identity(); }

/// A vector or quaternion that is not of unit length, such as all zeros, has no direction.
bool is_unit(const auto& v) { return std::abs(v.norm() - 1) < 1e-3; }

} // namespace

const std::vector<std::string>& texts_of(FilterKind) {
    static const std::vector<std::string> texts{"printed", "corrected"};
    return texts;
}

Measured::Measured()
    : position(Vec3::Constant(unknown)), velocity(position), angular_velocity(position),
      up(position), attitude(unknown, unknown, unknown, unknown) {}

AnalysisStatistics::AnalysisStatistics()
    : innovation(Vec3::Constant(unknown)), gain(innovation), deviation(innovation),
      normalised_innovation_squared(unknown) {}

bool Measured::is_empty() const {
    return !position.allFinite() && !velocity.allFinite() && !angular_velocity.allFinite() &&
           !up.allFinite() && !attitude.coeffs().allFinite();
}

SensorFilter::SensorFilter(const FilterSettings& settings) : settings_(settings) {
    filter_.begin(settings.position, settings.velocity, settings.attitude,
                  settings.angular_velocity);
    filter_.gate = settings.gate < 1 ? chi_squared_quantile(settings.gate, 3) : 0;
}

Analysis SensorFilter::update(const BodyForecast& forecast, const Measured& measured) {
    // the initial deviations are those at the first sample
    const double dt = begun_ ? forecast.time - last_time_ : 0;
    begun_ = true;
    last_time_ = forecast.time;
    if (settings_.kind == FilterKind::printed) return update_as_printed(forecast, measured, dt);
    move_on(dt, forecast.state);
    const Analysis seen = observe(measured);
    Analysis a = difference(filter_.state, forecast.state);
    a.accepted = seen.accepted;
    a.refused = seen.refused;
    a.largest_distance = seen.largest_distance;
    return a;
}

Analysis SensorFilter::difference(const RigidState& a, const RigidState& b) {
    return {.shift = a.position - b.position,
            .velocity = a.velocity - b.velocity,
            .turn = attitude_error(a.orientation, b.orientation),
            .angular_velocity = a.angular_velocity - b.angular_velocity};
}

// The simulation has moved the body; the model error of that motion adds to the covariance.
void SensorFilter::move_on(double dt, const RigidState& forecast) {
    if (dt > 0)
        filter_.advance(dt, settings_.acceleration_density, settings_.angular_acceleration_density);
    Matrix walk = Matrix::Zero(12, 12);
    walk.diagonal().head<3>().setConstant(settings_.drift * dt);
    walk.diagonal().segment<3>(6).setConstant(settings_.turning * dt);
    filter_.move_to(forecast, walk);
}

Mat3 SensorFilter::covariance_of(MotionFilter::Part part) const {
    const auto root = filter_.error().root.middleRows<3>(part);
    return root * root.transpose();
}

// `before`: covariance of the observed quantity before the analysis. A rejected observation has
// gain 0.
AnalysisStatistics SensorFilter::analysis_statistics(const ObservationResult& verdict,
                                                     MotionFilter::Part part, const Mat3& before,
                                                     double noise) const {
    AnalysisStatistics w;
    w.innovation = verdict.innovation;
    w.normalised_innovation_squared = verdict.squared_distance;
    w.gain = verdict.accepted ? Vec3((before * (before + square(noise)).inverse()).diagonal())
                              : Vec3(Vec3::Zero());
    w.deviation = covariance_of(part).diagonal().cwiseSqrt();
    return w;
}

// The returned Analysis holds only the counts and the largest normalised innovation squared.
Analysis SensorFilter::observe(const Measured& measured) {
    Analysis a;
    position_ = attitude_ = {};
    const auto take = [&](const ObservationResult& v) {
        ++(v.accepted ? a.accepted : a.refused);
        a.largest_distance = std::max(a.largest_distance, v.squared_distance);
    };
    if (measured.position.allFinite()) {
        const Mat3 before = covariance_of(MotionFilter::position);
        const ObservationResult v =
            filter_.observe_position(measured.position, square(measured.position_deviation));
        take(v);
        position_ =
            analysis_statistics(v, MotionFilter::position, before, measured.position_deviation);
    }
    if (measured.velocity.allFinite())
        take(filter_.observe_velocity(measured.velocity, square(measured.velocity_deviation)));
    const auto take_attitude = [&](const Quat& q, bool is_one) {
        if (!is_one) return take(ObservationResult{});
        const Mat3 before = covariance_of(MotionFilter::rotation);
        const ObservationResult v =
            filter_.observe_attitude(q, square(measured.attitude_deviation));
        take(v);
        attitude_ =
            analysis_statistics(v, MotionFilter::rotation, before, measured.attitude_deviation);
    };
    if (measured.attitude.coeffs().allFinite())
        take_attitude(measured.attitude, is_unit(measured.attitude));
    // the shortest rotation that aligns the upward vector leaves yaw to the model
    if (measured.up.allFinite()) {
        const Quat now = filter_.state.orientation;
        take_attitude(shortest_rotation(now * measured.up, Vec3::UnitZ()) * now,
                      is_unit(measured.up));
    }
    if (measured.angular_velocity.allFinite())
        take(filter_.observe_angular_velocity(measured.angular_velocity,
                                              square(measured.angular_velocity_deviation)));
    return a;
}

Matrix SensorFilter::covariance() const { return filter_.covariance(); }

void SensorFilter::withhold(const Analysis& part) {
    if (settings_.kind == FilterKind::printed) return;
    RigidState& stays = filter_.state;
    stays.position -= part.shift;
    stays.velocity -= part.velocity;
    stays.orientation = (exponential_map(-part.turn) * stays.orientation).normalized();
    stays.angular_velocity -= part.angular_velocity;
    Gaussian error = filter_.error();
    Vector left(MotionFilter::size);
    left << part.shift, part.velocity, part.turn, part.angular_velocity;
    Matrix roots(left.size(), left.size() + 1);
    roots << error.root, left;
    error.root = triangle_of<double>(roots);
    filter_.restore(error);
}

// Steps 3 to 6 of the SmartRock report. It needs position and velocity together, and has no gate.
Analysis SensorFilter::update_as_printed(const BodyForecast& forecast, const Measured& measured,
                                         double dt) {
    Analysis a;
    position_ = attitude_ = {};
    if (!measured.position.allFinite() || !measured.velocity.allFinite()) return a;
    const Transition t = white_acceleration(3, dt, settings_.acceleration_density);
    printed_.A = t.F;
    printed_.Q = t.Q;
    printed_.R = Matrix::Zero(6, 6);
    printed_.R.diagonal() << Vec3::Constant(measured.position_deviation *
                                            measured.position_deviation),
        Vec3::Constant(measured.velocity_deviation * measured.velocity_deviation);
    Vector simulated(6), seen(6);
    simulated << forecast.state.position, forecast.state.velocity;
    seen << measured.position, measured.velocity;
    const Vector fused = printed_.fuse(simulated, seen);
    a.shift = fused.head<3>() - forecast.state.position;
    a.velocity = fused.tail<3>() - forecast.state.velocity;
    a.accepted = 2;
    position_.innovation = measured.position - forecast.state.position;
    position_.gain = printed_.gain.diagonal().head<3>();
    if (!measured.angular_velocity.allFinite()) return a;
    printed_.q = settings_.angular_acceleration_density * dt * Matrix::Identity(3, 3);
    printed_.r = measured.angular_velocity_deviation * measured.angular_velocity_deviation *
                 Matrix::Identity(3, 3);
    a.angular_velocity =
        printed_.fuse_angular_velocity(forecast.state.angular_velocity, measured.angular_velocity) -
        Vector(forecast.state.angular_velocity);
    ++a.accepted;
    // it corrects the angular velocity, and the attitude is to follow from that
    attitude_.gain = printed_.angular_velocity_gain.diagonal();
    return a;
}

void SensorFilter::save(Archive& archive, const std::string& path) const {
    const auto put = [&](const std::string& name, const Matrix& m) {
        archive.put(path + name,
                    std::span<const double>(m.data(), static_cast<std::size_t>(m.size())));
    };
    put("/root", filter_.error().root);
    put("/COV", printed_.COV);
    put("/cov", printed_.cov);
    // the next forecast is rotated with this angular velocity
    const Vec3& angular_velocity = filter_.state.angular_velocity;
    put_fields(archive, path + "/time",
               std::tie(last_time_, begun_, angular_velocity.x(), angular_velocity.y(),
                        angular_velocity.z()));
}

void SensorFilter::load(const Archive& archive, const std::string& path) {
    const auto get = [&](const std::string& name, Matrix& m) {
        const auto numbers = archive.get<double>(path + name);
        require(static_cast<Eigen::Index>(numbers.size()) == m.size(),
                fmt::format("checkpoint: {}{}: expected {} numbers, found {}", path, name, m.size(),
                            numbers.size()));
        std::copy(numbers.begin(), numbers.end(), m.data());
    };
    Gaussian error = filter_.error();
    get("/root", error.root);
    filter_.restore(error);
    get("/COV", printed_.COV);
    get("/cov", printed_.cov);
    Vec3& angular_velocity = filter_.state.angular_velocity;
    get_fields(archive, path + "/time",
               std::tie(last_time_, begun_, angular_velocity.x(), angular_velocity.y(),
                        angular_velocity.z()));
}

} // namespace bris
