#include "scenarios/library/library_sensors.hpp"

#include "scenarios/specimens/sensor_rocks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

/// Whether the sensor rocks were placed as in a library, whose specimens have the usual layout: at
/// the same heights, and in the centre or beside the membrane.
bool stand_as_usual(const std::vector<Recording>& recordings) {
    const SensorRoom room{.radius = 1, .height = 1, .bounding_radius = 0.2};
    const auto usual = smart_rock_poses(room, 1, recordings.size());
    if (usual.size() != recordings.size()) return false;
    constexpr double tolerance = 0.15;
    for (std::size_t k = 0; k < usual.size(); ++k) {
        const SensorInfo& info = recordings[k].info;
        const Vec3& p = usual[k].position;
        if (std::abs(std::hypot(info.placed_x, info.placed_y) - std::hypot(p.x(), p.y())) >
                tolerance ||
            std::abs(info.placed_z - p.z()) > tolerance)
            return false;
    }
    return true;
}

/// Displacement between the neighbouring samples; none if they are more than `step` away.
std::optional<Vec3> displacement_at(const SensorTrajectory& t, double strain, double step) {
    const auto after = static_cast<std::size_t>(std::ranges::lower_bound(t.strain, strain - 1e-9) -
                                                t.strain.begin());
    if (after == t.strain.size() || t.strain[after] > strain + step) return std::nullopt;
    const std::size_t before = after > 0 && t.strain[after] > strain + 1e-9 ? after - 1 : after;
    if (std::abs(strain - t.strain[before]) > step) return std::nullopt;
    const double width = t.strain[after] - t.strain[before],
                 part = width > 0 ? (strain - t.strain[before]) / width : 0;
    const Vec3 u = t.displacement[before] + part * (t.displacement[after] - t.displacement[before]);
    return u.allFinite() ? std::optional(u) : std::nullopt;
}

} // namespace

std::string reason_against_sensors(const SpecimenLibrary& library, const RecordedTest& test) {
    if (library.sensors == 0) return "the library has none";
    if (test.recordings.size() != library.sensors || test.trajectories.size() != library.sensors)
        return fmt::format("expected {} accepted sensors, found {}", library.sensors,
                           test.trajectories.size());
    if (!stand_as_usual(test.recordings)) return "they stand elsewhere than those of the library";
    return "";
}

std::optional<Vec3> recorded_displacement(const SpecimenLibrary& library, const RecordedTest& test,
                                          std::size_t sensor, std::size_t coarse) {
    const auto u = displacement_at(test.trajectories[sensor], library.axis.coarse_strain(coarse),
                                   library.axis.step);
    if (!u) return std::nullopt;
    const SensorInfo& info = test.recordings[sensor].info;
    return polar(*u, {info.x, info.y, info.z});
}

} // namespace bris
