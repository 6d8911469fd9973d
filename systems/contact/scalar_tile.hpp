#pragma once

#include "engine/math.hpp"
#include "systems/contact/tile.hpp"

namespace bris::detail {

/// Collects contacts that are found one by one (spheres against facets and membrane) and applies
/// the law to lane_count of them at a time.
template <class Law>
class ScalarTile {
public:
    ScalarTile(const TileTarget& to, const Movers& movers) : to_(to), movers_(movers) {}

    /// Adds the contact of a sphere with a surface at `distance` (m) from its centre along `normal`
    /// (unit, from the surface to the sphere). The surface moves with `velocity` (m/s) at the
    /// contact point and rotates with the angular velocity `turning` (rad/s).
    void add(Row near_row, const Vec3& normal, double distance, const Vec3& velocity,
             const Vec3& turning) {
        const Row slot = to_.near[near_row].owner;
        const SphereRow& p = movers_.sphere_row[slot];
        const std::size_t owner = movers_.body_of(slot);
        const MotionRow& body = movers_.motion[owner];
        const auto k = static_cast<std::size_t>(count_++);
        const double overlap = p.radius - distance, arm = p.radius - 0.5 * overlap;
        const Vec3 centre(p.x, p.y, p.z), omega(body.omega_x, body.omega_y, body.omega_z),
            point = centre - arm * normal;
        Vec3 u = Vec3(body.vx, body.vy, body.vz) - velocity, middle = centre; // of the body
        if (movers_.centre != nullptr) {
            const CentreRow& x = movers_.centre[owner];
            middle = Vec3(x.x, x.y, x.z);
            u += omega.cross(centre - middle);
        }
        rows_[k] = near_row;
        put(k, normal_at, normal);
        put(k, point_at, point);
        values_[overlap_at][k] = overlap;
        values_[inverse_mass_at][k] = body.inverse_mass;
        values_[radius_at][k] = p.radius;
        values_[closing_at][k] = -u.dot(normal);
        if constexpr (Law::has_history) {
            u -= arm * omega.cross(normal);
            values_[twist_at][k] = 0.5 * (omega + turning).dot(normal);
            put(k, sliding_at, u);
        }
        if constexpr (Law::has_dashpots) {
            const KickRow& kick = movers_.kick[owner];
            const Vec3 more(kick.omega_x, kick.omega_y, kick.omega_z);
            put(k, velocity_at, u + Vec3(kick.vx, kick.vy, kick.vz) + more.cross(point - middle));
        }
        if constexpr (Law::has_rolling) put(k, omega_at, omega - turning);
        if (count_ == lane_count) flush();
    }

    /// Applies the law to the contacts collected so far.
    void flush() {
        if (count_ == 0) return;
        // unused lanes repeat the first contact: valid numbers that are never stored
        for (auto k = static_cast<std::size_t>(count_); k < lane_count; ++k) {
            rows_[k] = rows_[0];
            for (auto& field : values_) field[k] = field[0];
        }
        const auto lane = [&](std::size_t i) {
            return *reinterpret_cast<const Lane*>(values_[i].data());
        };
        ContactLanes c{lane(normal_at),  lane(normal_at + 1),   lane(normal_at + 2),
                       lane(overlap_at), lane(inverse_mass_at), lane(radius_at)};
        c.closing = lane(closing_at);
        if constexpr (Law::has_history) {
            c.ux = lane(sliding_at);
            c.uy = lane(sliding_at + 1);
            c.uz = lane(sliding_at + 2);
            c.twist = lane(twist_at);
        }
        if constexpr (Law::has_dashpots) {
            c.vx = lane(velocity_at);
            c.vy = lane(velocity_at + 1);
            c.vz = lane(velocity_at + 2);
        }
        if constexpr (Law::has_rolling) {
            c.wx = lane(omega_at);
            c.wy = lane(omega_at + 1);
            c.wz = lane(omega_at + 2);
        }
        apply_law<Law>(to_, rows_.data(), count_, c, lane(point_at), lane(point_at + 1),
                       lane(point_at + 2));
        count_ = 0;
    }

private:
    // rows of values_; vectors take three rows
    enum : std::size_t {
        normal_at = 0,
        point_at = 3,
        sliding_at = 6,
        velocity_at = 9,
        omega_at = 12,
        overlap_at = 15,
        inverse_mass_at,
        radius_at,
        closing_at,
        twist_at,
        fields
    };
    void put(std::size_t lane, std::size_t at, const Vec3& v) {
        for (int i = 0; i < 3; ++i) values_[at + static_cast<std::size_t>(i)][lane] = v[i];
    }

    TileTarget to_;
    Movers movers_;
    int count_ = 0;
    std::array<Row, lane_count> rows_{};
    alignas(64) std::array<std::array<double, lane_count>, fields> values_{};
};

/// Records which near rows of a group of eight touch now, and clears the springs of those that have
/// separated.
template <class Pairs>
void write_touching(const TileTarget& to, NearIndex<Pairs>& index, std::size_t group,
                    unsigned now) {
    std::uint8_t& flags = index.touching[group / 8];
    forget(to, static_cast<Row>(group), flags & ~now);
    flags = static_cast<std::uint8_t>(now);
}

} // namespace bris::detail
