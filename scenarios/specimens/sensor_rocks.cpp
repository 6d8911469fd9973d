#include "scenarios/specimens/sensor_rocks.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/random.hpp"

#include <fmt/format.h>

#include <array>

namespace bris {

namespace {

constexpr std::uint64_t orientation_stream = 1001;

/// Distance from the axis of the sensor rocks beside the membrane, m.
double places_beside(const SensorRoom& room) { return room.radius - 1.02 * room.bounding_radius; }

} // namespace

std::size_t smart_rock_count(const SensorRoom& room) {
    // a rock fills its bounding sphere along its longest axis only, so that a distance of 1.8 of
    // its bounding radius keeps two rocks apart
    const double beside = places_beside(room);
    return beside >= 1.8 * room.bounding_radius                    ? 10
           : std::sqrt(3.0) * beside >= 1.8 * room.bounding_radius ? 7
                                                                   : 3;
}

std::vector<SmartRockPose> smart_rock_poses(const SensorRoom& room, std::uint64_t seed,
                                            std::size_t count) {
    std::vector<SmartRockPose> poses;
    Random random(seed, orientation_stream);
    const double beside = places_beside(room);
    const bool in_the_centre = count != 7, at_the_membrane = count != 3;
    const auto put = [&](double height, unsigned around) {
        if (in_the_centre) poses.push_back({{0, 0, height * room.height}, random.rotation()});
        for (unsigned k = 0; at_the_membrane && k < around; ++k) {
            const double angle = 2 * pi * k / 3;
            poses.push_back(
                {{beside * std::cos(angle), beside * std::sin(angle), height * room.height},
                 random.rotation()});
        }
    };
    put(0.25, 1);
    put(0.5, 3);
    put(0.75, 3);
    return poses;
}

std::vector<GivenPose> read_sensor_poses(const std::filesystem::path& csv) {
    const CsvTable table = read_csv(csv);
    std::array<std::vector<double>, 7> columns;
    const std::array<const char*, 7> names{
        "x_over_radius", "y_over_radius", "z_over_height", "qw", "qx", "qy", "qz"};
    for (std::size_t c = 0; c < columns.size(); ++c) columns[c] = table.column(names[c]);
    require(!table.rows.empty(),
            csv.string() + ": expected a line for each sensor rock, found none");
    std::vector<GivenPose> poses;
    for (std::size_t r = 0; r < table.rows.size(); ++r)
        poses.push_back(
            {.position = Vec3(columns[0][r], columns[1][r], columns[2][r]),
             .orientation = Quat(columns[3][r], columns[4][r], columns[5][r], columns[6][r]),
             .where = fmt::format("{}:{}", csv.string(), table.lines[r])});
    return poses;
}

namespace {

/// m, in this mould.
Vec3 position_in(const SensorRoom& room, const GivenPose& g) {
    return g.is_relative ? Vec3(g.position.x() * room.radius, g.position.y() * room.radius,
                                g.position.z() * room.height)
                         : g.position;
}

std::string placing_problem(const SensorRoom& room, const std::vector<GivenPose>& given,
                            std::size_t k) {
    const Vec3 x = position_in(room, given[k]);
    if (!(std::hypot(x.x(), x.y()) + 0.9 * room.bounding_radius <= room.radius && x.z() > 0 &&
          x.z() < room.height))
        return fmt::format("expected a sensor rock inside the mould (radius {:g} m, height {:g} "
                           "m), found one of radius {:g} m at ({:g}, {:g}, {:g}) m",
                           room.radius, room.height, room.bounding_radius, x.x(), x.y(), x.z());
    if (const double norm = given[k].orientation.norm(); !(std::abs(norm - 1) < 1e-3))
        return fmt::format("expected a unit quaternion, found one of length {:g}", norm);
    for (std::size_t other = 0; other < k; ++other)
        if (const double apart = (position_in(room, given[other]) - x).norm();
            apart < 1.6 * room.bounding_radius)
            return fmt::format(
                "expected sensor rocks clear of each other, found it {:g} m from that of {}", apart,
                given[other].where);
    return {};
}

} // namespace

std::vector<std::string> placing_problems(const SensorRoom& room,
                                          const std::vector<GivenPose>& given) {
    std::vector<std::string> problems;
    for (std::size_t k = 0; k < given.size(); ++k)
        problems.push_back(placing_problem(room, given, k));
    return problems;
}

std::vector<SmartRockPose> placed_in(const SensorRoom& room, const std::vector<GivenPose>& given) {
    std::vector<SmartRockPose> poses;
    for (std::size_t k = 0; k < given.size(); ++k) {
        const std::string problem = placing_problem(room, given, k);
        require(problem.empty(), fmt::format("{}: {}", given[k].where, problem));
        poses.push_back({position_in(room, given[k]), given[k].orientation.normalized()});
    }
    return poses;
}

} // namespace bris
