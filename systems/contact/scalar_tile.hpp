#pragma once

#include "engine/math.hpp"
#include "systems/contact/tile.hpp"

namespace bris::detail {

/// A surface at a contact point: its velocity there and those of the body that it belongs to.
struct SurfaceAt {
    Vec3 velocity;         ///< m/s, at the contact point
    Vec3 angular_velocity; ///< rad/s, of the host
    Vec3 centre;           ///< m, about which torques on the host are taken
    /// Row of a host that forces move, whose velocity is that at the contact point and whose mass
    /// counts; no_row: the host is driven.
    Row free_host = no_row;
};

/// Collects contacts that are found one by one (spheres against facets and membrane) and applies
/// the law to lane_count of them at a time. `reader` is then called with their near rows, their
/// number and their forces.
template <class Law, class Reader = NoReader>
class ScalarTile {
public:
    /// `deepest`: largest overlap accepted, over the radius. `beyond_limit` receives a near row
    /// beyond this limit or that of the force.
    ScalarTile(const TileTarget& to, const Movers& movers, double deepest, Row& beyond_limit,
               Reader reader = {})
        : to_(to), movers_(movers), deepest_(deepest), beyond_limit_(beyond_limit),
          reader_(reader) {}

    /// Adds the contact of a sphere with a surface at `distance` (m) from its centre along `normal`
    /// (unit, from the surface to the sphere).
    void add(Row near_row, const Vec3& normal, double distance, const SurfaceAt& surface) {
        const Row slot = to_.near[near_row].owner;
        const SphereRow& p = movers_.sphere_row[slot];
        const std::size_t owner = movers_.body_of(slot);
        const MotionRow& body = movers_.motion[owner];
        const auto k = static_cast<std::size_t>(count_++);
        const double overlap = p.radius - distance, arm = p.radius - 0.5 * overlap;
        const Vec3 centre(p.x, p.y, p.z), omega(body.omega_x, body.omega_y, body.omega_z),
            point = centre - arm * normal;
        const bool is_free = surface.free_host != no_row;
        const Vec3 of_surface = is_free ? velocity_of(surface, point) : surface.velocity;
        Vec3 u = Vec3(body.vx, body.vy, body.vz) - of_surface, middle = centre; // of the body
        if (movers_.centre != nullptr) {
            const CentreRow& x = movers_.centre[owner];
            middle = Vec3(x.x, x.y, x.z);
            u += omega.cross(centre - middle);
        }
        rows_[k] = near_row;
        own_[k] = owner;
        put(k, normal_at, normal);
        put(k, point_at, point);
        put(k, own_arm_at, point - middle);
        put(k, partner_arm_at, point - surface.centre);
        values_[overlap_at][k] = overlap;
        values_[inverse_mass_at][k] =
            is_free ? body.inverse_mass + movers_.motion[surface.free_host].inverse_mass
                    : body.inverse_mass;
        values_[radius_at][k] = p.radius;
        values_[closing_at][k] = -u.dot(normal);
        if constexpr (Law::has_history) {
            u -= arm * omega.cross(normal);
            values_[twist_at][k] = 0.5 * (omega + surface.angular_velocity).dot(normal);
            put(k, sliding_at, u);
        }
        if constexpr (Law::has_dashpots) {
            const KickRow& kick = movers_.kick[owner];
            const Vec3 more(kick.omega_x, kick.omega_y, kick.omega_z);
            Vec3 v = u + 0.5 * to_.step.dt * Vec3(kick.ax, kick.ay, kick.az) +
                     more.cross(point - middle);
            if (is_free) v -= kick_of(surface, point);
            put(k, velocity_at, v);
        }
        if constexpr (Law::has_rolling) put(k, omega_at, omega - surface.angular_velocity);
        if (count_ == lane_count) flush();
    }

    /// Applies the law to the contacts collected so far.
    void flush() {
        if (count_ == 0) return;
        // unused lanes repeat the first contact: valid numbers that are never stored
        for (auto k = static_cast<std::size_t>(count_); k < lane_count; ++k) {
            rows_[k] = rows_[0];
            own_[k] = own_[0];
            for (auto& field : values_) field[k] = field[0];
        }
        const auto lane = [&](std::size_t i) {
            return *reinterpret_cast<const Lane*>(values_[i].data());
        };
        const auto vector = [&](std::size_t i) {
            return Vec3Lanes{lane(i), lane(i + 1), lane(i + 2)};
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
        const unsigned beyond =
            apply_law<Law>(to_, rows_.data(), {own_.data(), own_.data()}, count_, c,
                           Levers{vector(point_at), vector(own_arm_at), vector(partner_arm_at)},
                           c.overlap > deepest_ * c.radius, reader_);
        if (beyond != 0) beyond_limit_ = rows_[static_cast<std::size_t>(__builtin_ctz(beyond))];
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
        own_arm_at = 15,
        partner_arm_at = 18,
        overlap_at = 21,
        inverse_mass_at,
        radius_at,
        closing_at,
        twist_at,
        fields
    };
    /// Velocity (m/s) of a point of a free host over the last step, and its increment to the
    /// present time.
    Vec3 velocity_of(const SurfaceAt& surface, const Vec3& point) const {
        const MotionRow& m = movers_.motion[surface.free_host];
        return Vec3(m.vx, m.vy, m.vz) +
               Vec3(m.omega_x, m.omega_y, m.omega_z).cross(point - surface.centre);
    }
    Vec3 kick_of(const SurfaceAt& surface, const Vec3& point) const {
        const KickRow& m = movers_.kick[surface.free_host];
        return 0.5 * to_.step.dt * Vec3(m.ax, m.ay, m.az) +
               Vec3(m.omega_x, m.omega_y, m.omega_z).cross(point - surface.centre);
    }
    void put(std::size_t lane, std::size_t at, const Vec3& v) {
        for (int i = 0; i < 3; ++i) values_[at + static_cast<std::size_t>(i)][lane] = v[i];
    }

    TileTarget to_;
    Movers movers_;
    double deepest_;
    Row& beyond_limit_;
    Reader reader_;
    int count_ = 0;
    std::array<Row, lane_count> rows_{};
    std::array<std::size_t, lane_count> own_{};
    alignas(64) std::array<std::array<double, lane_count>, fields> values_{};
};

} // namespace bris::detail
