#include "tests/verification/fine_steps.hpp"

#include "engine/errors.hpp"

#include <algorithm>
#include <cmath>

namespace bris::detail {

namespace {

/// Tangential force (N) after the surfaces have slid by `slid` (m) and the tangential stiffness has
/// changed from `before` to `now` (N/m).
double spring_force(ShearHistory history, double force, double slid, double before, double now) {
    double kept = 1;
    if (history == ShearHistory::total) kept = before > 0 ? now / before : 0;
    if (history == ShearHistory::rescaled) kept = before > now ? now / before : 1;
    return kept * force - 0.5 * (before + now) * slid;
}

} // namespace

ImpactResult integrate_finely(const Impact& s, Arm arm, double steps) {
    require(is_hertz(s.law) && s.target == Target::plane,
            "fine integration: expected a Hertz law and a plane as target");
    const NormalContact c = normal_contact(s);
    const Material& m = s.material;
    const double shear = m.young_modulus / (2 * (1 + m.poisson_ratio) * (2 - m.poisson_ratio)),
                 inertia = 0.4 * c.mass * s.radius * s.radius;
    const double beta = damping_ratio(m.restitution, s.policy.tension), h = c.time() / steps;
    double x = 0, in = c.speed, along = s.speed * std::sin(s.angle), omega = s.angular_velocity.y(),
           friction = 0, stiffness = 0;
    const auto energy = [&] {
        return 0.5 * (c.mass * (in * in + along * along) + inertia * omega * omega);
    };
    ImpactResult r;
    r.energy_before = energy();
    r.slip_before = along - s.radius * omega;
    const double along_before = along;
    do {
        // half a drift, a kick, half a drift; the dashpot uses the velocity before the kick, the
        // spring the mean displacement
        const double lever = arm == Arm::surface ? s.radius : s.radius - 0.5 * x,
                     slip = along - lever * omega;
        x += 0.5 * h * in;
        const double now = 8 * shear * std::sqrt(s.radius * std::max(x, 0.0)),
                     normal_stiffness = 1.5 * c.stiffness * std::sqrt(std::max(x, 0.0));
        double force = c.stiffness * std::pow(std::max(x, 0.0), 1.5) +
                       2 * std::sqrt(5.0 / 6) * beta * std::sqrt(normal_stiffness * c.mass) * in;
        if (s.policy.tension != Tension::allowed) force = std::max(force, 0.0);
        const double limit = m.friction * std::max(force, 0.0);
        friction =
            std::clamp(spring_force(s.policy.shear_history, friction, h * slip, stiffness, now),
                       -limit, limit);
        stiffness = now;
        in -= h * force / c.mass;
        along += h * friction / c.mass;
        omega -= h * lever * friction / inertia;
        x += 0.5 * h * in;
    } while (x > 0);
    r.normal_restitution = -in / c.speed;
    r.tangential_restitution = along / along_before;
    r.angular_velocity = Vec3(0, omega, 0);
    r.slip = along - s.radius * omega;
    r.rebound_angle = std::atan2(r.slip, -in);
    r.energy_change = energy() / r.energy_before - 1;
    return r;
}

} // namespace bris::detail
