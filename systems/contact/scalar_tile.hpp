#pragma once

#include "systems/contact/tile.hpp"

#include "engine/math.hpp"

namespace bris::detail {

/// Collects contacts found one by one (spheres against planes and facets) and hands them to the law
/// lane_count at a time.
template <class Law> class ScalarTile {
public:
    ScalarTile(const TileTarget& to, const Movers& movers) : to_(to), movers_(movers) {}

    /// A sphere touches a surface at `distance` from its centre along `normal` (unit, from the
    /// surface to the sphere); the surface moves with `velocity`.
    void add(Row near_row, const Vec3& normal, double distance, const Vec3& velocity) {
        const Row slot = to_.near[near_row].owner;
        const PlaceRow& p = movers_.place[slot];
        const Row owner = movers_.body[slot];
        const MotionRow& body = movers_.motion[owner];
        const auto k = static_cast<std::size_t>(count_++);
        const double overlap = p.radius - distance, arm = p.radius - 0.5 * overlap;
        const Vec3 centre(p.x, p.y, p.z), spin(body.spin_x, body.spin_y, body.spin_z);
        Vec3 u = Vec3(body.vx, body.vy, body.vz) - velocity;
        if (movers_.centre != nullptr) {
            const CentreRow& x = movers_.centre[owner];
            u += spin.cross(centre - Vec3(x.x, x.y, x.z));
        }
        double twist = 0;
        if constexpr (Law::has_history) {
            u -= arm * spin.cross(normal);
            twist = 0.5 * spin.dot(normal);
        }
        const Vec3 point = centre - arm * normal;
        rows_[k] = near_row;
        const std::array<double, fields> values{normal.x(), normal.y(), normal.z(), overlap, u.x(), u.y(),
                                                u.z(), twist, body.inverse_mass, point.x(), point.y(),
                                                point.z()};
        for (std::size_t i = 0; i < fields; ++i) values_[i][k] = values[i];
        if (count_ == lane_count) flush();
    }

    void flush() {
        if (count_ == 0) return;
        // empty lanes repeat the first contact: valid numbers, never stored
        for (auto k = static_cast<std::size_t>(count_); k < lane_count; ++k) {
            rows_[k] = rows_[0];
            for (auto& field : values_) field[k] = field[0];
        }
        const auto lane = [&](std::size_t i) { return *reinterpret_cast<const Lane*>(values_[i].data()); };
        const ContactLanes c{lane(0), lane(1), lane(2), lane(3), lane(4), lane(5), lane(6), lane(7), lane(8)};
        apply_law<Law>(to_, rows_.data(), count_, c, lane(9), lane(10), lane(11));
        count_ = 0;
    }

private:
    static constexpr std::size_t fields = 12;
    TileTarget to_;
    Movers movers_;
    int count_ = 0;
    std::array<Row, lane_count> rows_{};
    alignas(64) std::array<std::array<double, lane_count>, fields> values_{};
};

/// Books which rows of a chunk touch now; forgets those that have come apart.
template <class Pairs>
void book(const TileTarget& to, NearIndex<Pairs>& index, std::size_t group, unsigned now) {
    std::uint8_t& flags = index.touching[group / 8];
    forget(to, static_cast<Row>(group), flags & ~now);
    flags = static_cast<std::uint8_t>(now);
}

} // namespace bris::detail
