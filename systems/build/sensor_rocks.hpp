#pragma once

#include "engine/math.hpp"

#include <filesystem>
#include <vector>

namespace bris {

/// A sensor rock's place and attitude before the test. The axis of the specimen is z, its lower platen
/// at z = 0.
struct SmartRockPose {
    Vec3 position; ///< m, of the centre of mass, in a specimen of the wanted height
    Quat orientation;
};

/// The mould that the sensor rocks stand in, and the bounding radius (m) of one of them.
struct SensorRoom {
    double radius, height, bounding_radius;
};

/// Ten sensor rocks at the interfaces of four lifts (inventory T4): at a quarter of the height one in
/// the centre and one beside the membrane; at the half and three quarters one in the centre and
/// three beside the membrane at 120 degrees. Orientations are drawn from the seed. Throws InputError if
/// the mould is too small.
std::vector<SmartRockPose> smart_rock_poses(const SensorRoom& room, std::uint64_t seed);

/// The poses of a CSV file, a line for each sensor rock: x_over_radius, y_over_radius, z_over_height,
/// qw, qx, qy, qz (a unit quaternion, principal axes to world). Throws InputError with file:line.
std::vector<SmartRockPose> read_smart_rock_poses(const std::filesystem::path& csv, const SensorRoom& room);

} // namespace bris
