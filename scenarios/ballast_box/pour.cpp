#include "scenarios/ballast_box/pour.hpp"

#include "components/kinds.hpp"
#include "engine/ordering.hpp"
#include "engine/random.hpp"
#include "scenarios/specimens/scene.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace bris {

namespace {

constexpr double filling = 0.3; // of bounding spheres in the column: random places are found soon
constexpr std::uint64_t place_stream = 8001;

struct Placed {
    Vec3 centre;
    double radius;
};

/// Spheres sorted into cells that are as wide as the largest of them, so that only neighbouring
/// cells need to be searched.
class Cells {
public:
    explicit Cells(double side) : side_(side) {}
    void add(const Placed& sphere) { cells_[key(cell(sphere.centre))].push_back(sphere); }
    bool is_clear(const Placed& sphere) const {
        const Eigen::Array3i middle = cell(sphere.centre);
        for (int k = 0; k < 27; ++k) {
            const auto found =
                cells_.find(key(middle + Eigen::Array3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)));
            if (found == cells_.end()) continue;
            for (const Placed& other : found->second) {
                const double apart = other.radius + sphere.radius;
                if ((other.centre - sphere.centre).squaredNorm() < apart * apart) return false;
            }
        }
        return true;
    }

private:
    Eigen::Array3i cell(const Vec3& x) const {
        return Eigen::Array3d(Eigen::Vector3d(x / side_)).floor().cast<int>();
    }
    static std::uint64_t key(const Eigen::Array3i& c) {
        return (static_cast<std::uint64_t>(c[0] + 1024) << 40) |
               (static_cast<std::uint64_t>(c[1] + 1024) << 20) |
               static_cast<std::uint64_t>(c[2] + 1024);
    }
    double side_;
    std::unordered_map<std::uint64_t, std::vector<Placed>> cells_; // looked up, never iterated
};

void lay_sensors(World& world, std::size_t course) {
    const auto& sensors = world.resource<BoxBodies>().sensors;
    for (const BoxSensor& s : sensors) {
        if (course == 0 || s.course + 1 != course) continue;
        const double radius = value_of<BoundingRadius>(world, s.body),
                     y = std::max(s.place.y(), radius);
        const double height = surface_height(world, s.place.x(), y, radius, 0);
        release(world, s.body, Vec3(s.place.x(), y, height + radius));
    }
}

} // namespace

void pour_course(World& world, const BoxSizes& s, std::size_t course, std::uint64_t seed) {
    lay_sensors(world, course);
    const auto& ids = world.resource<BoxBodies>().rocks[course];
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    const auto radius = world.column<Bodies, BoundingRadius>();
    const double depth = course == 0 ? s.across : s.bladder_face();
    double largest = 0, volume = 0;
    for (const EntityId id : ids) {
        largest = std::max(largest, radius[rows[id]]);
        volume += 4 * pi / 3 * std::pow(radius[rows[id]], 3);
    }
    const double low = surface_height(world, Vec3::Zero(), Vec3(s.width, s.across, 0), 0) + 0.002;
    double high = low + 2 * largest + volume / (filling * s.width * depth);
    Cells cells(2 * largest);
    std::vector<EntityId> order = ids; // largest first
    std::ranges::sort(order, [&](EntityId a, EntityId b) {
        return radius[rows[a]] != radius[rows[b]] ? radius[rows[a]] > radius[rows[b]] : a < b;
    });
    for (const EntityId id : order) {
        Random random(seed, place_stream + id);
        const double r = radius[rows[id]];
        for (int attempt = 1;; ++attempt) {
            if (attempt % 200 == 0) high += largest; // little room
            const Placed sphere{Vec3(random.uniform(r, std::max(s.width - r, 1.001 * r)),
                                     random.uniform(r, depth - r),
                                     random.uniform(low + r, high - r)),
                                r};
            if (!cells.is_clear(sphere)) continue;
            cells.add(sphere);
            release(world, id, sphere.centre);
            break;
        }
    }
}

} // namespace bris
