#include "tests/verification/top.hpp"

#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "scenarios/collision/peak.hpp"
#include "scenarios/specimens/small_scene.hpp"

#include <array>
#include <cmath>

namespace bris {

namespace {

struct Elliptic {
    double sn, cn, dn;
};

/// Jacobi's functions by descending Landen steps (Abramowitz and Stegun 16.4), 0 <= m < 1.
Elliptic jacobi(double u, double m) {
    std::array<double, 16> a{1}, c{std::sqrt(m)};
    double b = std::sqrt(1 - m);
    std::size_t n = 0;
    while (std::abs(c[n]) > 1e-16 && n + 1 < a.size()) {
        a[n + 1] = 0.5 * (a[n] + b);
        c[n + 1] = 0.5 * (a[n] - b);
        b = std::sqrt(a[n] * b);
        ++n;
    }
    double angle = std::ldexp(a[n] * u, static_cast<int>(n));
    for (; n > 0; --n) angle = 0.5 * (angle + std::asin(c[n] / a[n] * std::sin(angle)));
    const double sn = std::sin(angle), cn = std::cos(angle);
    return {sn, cn, std::sqrt(1 - m * sn * sn)};
}

double angle_between(const Quat& a, const Quat& b) {
    const Quat d = a.conjugate() * b;
    return 2 * std::atan2(d.vec().norm(), std::abs(d.w()));
}

Clump shape_of(const Ball& ball, const Vec3& inertia, double reach) {
    Clump shape;
    shape.balls = {ball};
    shape.volume = 1;
    shape.inertia = inertia;
    shape.bounding_radius = reach;
    return shape;
}

} // namespace

FreeTop::FreeTop(const Vec3& inertia, const Vec3& angular_velocity) {
    const double i1 = inertia.x(), i2 = inertia.y(), i3 = inertia.z();
    require(i1 > 0 && i1 <= i2 && i2 <= i3 && i1 < i3,
            "top: expected ascending principal moments above 0 kg m2, not all equal");
    const Vec3 squares = angular_velocity.cwiseAbs2();
    const double energy = squares.dot(inertia),
                 momentum = squares.dot(inertia.cwiseAbs2()); // 2 T and L^2
    circled_ = momentum > energy * i2 ? 2 : 0;
    const double high = energy * i3 - momentum, low = momentum - energy * i1,
                 split = momentum - energy * i2;
    require(std::abs(split) > 1e-12 * momentum,
            "top: expected an angular velocity off the separatrix, on which the motion has no "
            "period");
    require(high > 1e-14 * momentum && low > 1e-14 * momentum,
            "top: expected an angular velocity about more than one axis");
    const double a1 = std::sqrt(high / (i1 * (i3 - i1))), a3 = std::sqrt(low / (i3 * (i3 - i1)));
    double a2 = 0;
    if (circled_ == 2) {
        a2 = std::sqrt(high / (i2 * (i3 - i2)));
        rate_ = std::sqrt((i3 - i2) * low / (i1 * i2 * i3));
        m_ = (i2 - i1) * high / ((i3 - i2) * low);
    } else {
        a2 = std::sqrt(low / (i2 * (i2 - i1)));
        rate_ = std::sqrt((i2 - i1) * high / (i1 * i2 * i3));
        m_ = (i3 - i2) * low / ((i2 - i1) * high);
    }
    // the component along the circled axis keeps its sign, and I2 w2' = (I3 - I1) w3 w1 gives the
    // sign of the second component
    const double sign = angular_velocity[circled_] < 0 ? -1 : 1;
    amplitude_ = circled_ == 2 ? Vec3(a1, sign * a2, sign * a3) : Vec3(sign * a1, sign * a2, a3);
    begin_ = std::ellint_1(std::sqrt(m_),
                           std::atan2(angular_velocity.y() / amplitude_.y(),
                                      angular_velocity[2 - circled_] / amplitude_[2 - circled_]));
}

Vec3 FreeTop::angular_velocity(double time) const {
    const Elliptic e = jacobi(begin_ + rate_ * time, m_);
    return circled_ == 2
               ? Vec3(amplitude_.x() * e.cn, amplitude_.y() * e.sn, amplitude_.z() * e.dn)
               : Vec3(amplitude_.x() * e.dn, amplitude_.y() * e.sn, amplitude_.z() * e.cn);
}

Quat FreeTop::attitude(double time, int steps) const {
    Quat q(1, 0, 0, 0);
    const double h = time / steps, gauss = std::sqrt(3.0) / 6;
    for (int k = 0; k < steps; ++k) {
        const double middle = (k + 0.5) * h;
        const Vec3 a = angular_velocity(middle - gauss * h),
                   b = angular_velocity(middle + gauss * h);
        q = q * exponential_map(0.5 * h * (a + b) + std::sqrt(3.0) / 12 * h * h * a.cross(b));
    }
    return q.normalized();
}

double FreeTop::period() const { return 4 * std::comp_ellint_1(std::sqrt(m_)) / rate_; }

void check(const Top& s) {
    require(s.angle_per_step > 0 && s.duration > 0, "top: expected a step and a duration above 0");
    (void)FreeTop(s.inertia, s.angular_velocity);
}

TopResult run_experiment(const Top& s) {
    check(s);
    const FreeTop exact(s.inertia, s.angular_velocity);
    TopResult r;
    r.steps = static_cast<std::uint64_t>(
        std::ceil(s.duration * s.angular_velocity.norm() / s.angle_per_step));
    r.dt = s.duration / static_cast<double>(r.steps);

    World world = make_world(Grains::clumps);
    Material m;
    m.density = m.normal_stiffness = 1;
    const auto material = world.resource<Materials>().add(m);
    const EntityId body = add_clump(world, shape_of({Vec3::Zero(), 1}, s.inertia, 1), 0,
                                    Vec3::Zero(), Quat(Quat::Identity()), material);
    set_angular_velocity(world, body, s.angular_velocity);
    const Vec3 momentum = value_of<AngularMomentum>(world, body);
    const double energy = s.angular_velocity.cwiseAbs2().dot(s.inertia);
    Simulation sim = begin(std::move(world),
                           {.dt = r.dt, .law = LawName::linear_frictionless, .unlimited = true});
    const std::uint64_t samples = std::min<std::uint64_t>(r.steps, 1000);
    for (std::uint64_t k = 1; k <= samples; ++k) {
        sim.advance(r.steps * k / samples - sim.world().resource<Clock>().step);
        r.attitude = value_of<Orientation>(sim, body);
        r.angular_velocity = r.attitude.conjugate() * value_of<AngularVelocity>(sim, body);
        r.energy_drift = std::max(
            r.energy_drift, std::abs(r.angular_velocity.cwiseAbs2().dot(s.inertia) / energy - 1));
        r.norm_drift = std::max(r.norm_drift, std::abs(r.attitude.norm() - 1));
    }
    r.angular_velocity_error = (r.angular_velocity - exact.angular_velocity(s.duration)).norm();
    const double angle = s.duration * s.angular_velocity.norm();
    r.attitude_error =
        angle < 1000 ? angle_between(r.attitude,
                                     exact.attitude(s.duration, static_cast<int>(200 * angle) + 1))
                     : std::nan("");
    r.momentum_drift = (value_of<AngularMomentum>(sim, body) - momentum).norm() / momentum.norm();
    return r;
}

void check(const Pendulum& s) {
    require(s.amplitude > 0 && s.amplitude < pi / 4,
            "pendulum: expected an amplitude above 0 and below pi/4 rad, so that both planes carry "
            "load");
}

PendulumResult run_experiment(const Pendulum& s) {
    check(s);
    World world = make_world(Grains::clumps);
    const double weight = s.mass * s.gravity, k = s.stiffness_ratio * weight / s.arm,
                 dt = s.step_share * std::sqrt(s.mass / k);
    const auto material = world.resource<Materials>().add(linear_material(k, 0, 0, s.mass));
    const EntityId groove = add_boundary(world, Vec3::Zero(), material);
    for (const double side : {-1.0, 1.0}) add_plane(world, groove, Vec3::Zero(), Vec3(side, 0, 1));
    // at rest each plane carries weight / sqrt 2
    const double pivot = std::sqrt(2.0) * s.radius - weight / k;
    const Quat tilt = exponential_map(Vec3(0, s.amplitude, 0));
    const Vec3 to_ball(0, 0, s.arm);
    const EntityId body =
        add_clump(world, shape_of({to_ball, s.radius}, s.inertia / s.mass, s.arm + s.radius), 0,
                  Vec3(0, 0, pivot) - tilt * to_ball, tilt, material);
    world.add_resource<Gravity>({Vec3(0, 0, -s.gravity)});
    Simulation sim =
        begin(std::move(world), {.dt = dt, .law = LawName::linear_frictionless, .unlimited = true});

    PendulumResult r;
    const double turning = s.inertia.y() + s.mass * s.arm * s.arm;
    r.exact_period =
        4 * std::sqrt(turning / (weight * s.arm)) * std::comp_ellint_1(std::sin(0.5 * s.amplitude));
    const auto limit = static_cast<std::uint64_t>((s.swings + 2) * r.exact_period / dt);
    double before = s.amplitude, first = 0, last = 0;
    unsigned crossings = 0; // downwards
    Peak turning_point;
    while (crossings <= s.swings && sim.world().resource<Clock>().step < limit) {
        sim.advance();
        const Quat& q = value_of<Orientation>(sim, body);
        const double angle = 2 * std::atan2(q.y(), q.w());
        r.pivot_travel = std::max(
            r.pivot_travel,
            (value_of<Position>(sim, body) + q * to_ball - Vec3(0, 0, pivot)).norm() / s.arm);
        if (before <= 0 && angle > 0) turning_point = {};
        turning_point.add(angle);
        if (before > 0 && angle <= 0) {
            last = sim.world().resource<Clock>().time() - dt * angle / (angle - before);
            if (crossings == 0) first = last;
            r.amplitude_drift = turning_point.value() / s.amplitude - 1;
            ++crossings;
        }
        before = angle;
    }
    r.steps = sim.world().resource<Clock>().step;
    if (crossings <= s.swings) throw SimulationError("pendulum: expected full swings, found fewer");
    r.period = (last - first) / s.swings;
    return r;
}

} // namespace bris
