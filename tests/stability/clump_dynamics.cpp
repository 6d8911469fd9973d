// S27: clumps move as the rigid bodies that they represent.
#include "scenarios/specimens/small_scene.hpp"
#include "tests/stability/cases.hpp"

#include <fmt/format.h>

#include <array>

namespace bris {

namespace {

StressRow within_tolerance(const std::string& what, double found, double exact, double tolerance) {
    const double error = std::abs(found / exact - 1);
    return {"S27", what, fmt::format("{:.8g} within {:g} %", exact, 100 * tolerance),
            fmt::format("{:.8g}, error {:.2g} %", found, 100 * error), error < tolerance};
}

// A rocking body (roly-poly): one sphere, whose centre is `rise` above the centre of mass, rocks on
// a floor. Without friction the centre of mass moves only vertically: T = 2 pi sqrt(I / (m g d)).
// With rolling the contact is the pivot, and I + m (R - d)^2 replaces I.
double rocking_period(bool rolls, double dt, double cycles) {
    constexpr double radius = 0.1, rise = 0.03, gravity = 10, angle = 0.01; // m, m, m/s2, rad
    World world = make_world(Grains::clumps);
    const auto material = world.resource<Materials>().add(
        linear_material(1e7, rolls ? 1e7 : 0, rolls ? 1e3 : 0, 1000));
    add_floor(world, material);
    Clump shape;
    shape.balls = {{Vec3(0, 0, rise), radius}};
    shape.volume = 1e-3; // 1 kg
    shape.inertia = 1e-3 * Vec3(4e-3, 4e-3, 3e-3);
    shape.bounding_radius = radius + rise;
    const EntityId body =
        add_clump(world, shape, 0, Vec3::Zero(), exponential_map(Vec3(0, angle, 0)), material);
    value_of<Position>(world, body) =
        Vec3(0, 0, radius - 1 * gravity / 1e7 - rise * std::cos(angle));
    world.add_resource<Gravity>({Vec3(0, 0, -gravity)});
    Simulation simulation =
        begin(std::move(world),
              {.dt = dt, .law = rolls ? LawName::linear : LawName::linear_frictionless});
    // from the first upward zero of the tilt to a later one, interpolated linearly between steps
    double before = angle, first = -1, last = 0, count = 0;
    while (count <= cycles) {
        simulation.advance(1);
        const Quat& q = value_of<Orientation>(simulation, body);
        const double tilt = 2 * q.y() * (q.w() < 0 ? -1 : 1);
        if (before < 0 && tilt >= 0) {
            last = simulation.world().resource<Clock>().time() - dt * tilt / (tilt - before);
            if (first < 0) first = last;
            ++count;
        }
        before = tilt;
    }
    return (last - first) / (count - 1);
}

/// Complete elliptic integral of the first kind, by the arithmetic-geometric mean.
double elliptic_k(double m) {
    double a = 1, b = std::sqrt(1 - m);
    while (std::abs(a - b) > 1e-15 * a) {
        const double mean = 0.5 * (a + b);
        b = std::sqrt(a * b);
        a = mean;
    }
    return pi / (2 * a);
}

// A body that rotates about its middle axis flips periodically (Dzhanibekov effect): the angular
// velocity about that axis is an elliptic sine of period 4 K(m) / p (Landau and Lifshitz,
// Mechanics, section 37; here L^2 < 2 E I2, so that the axes 1 and 3 change roles).
void add_flips(StressRows& rows, double dt, int flips) {
    const Vec3 inertia(1, 2, 3), angular_velocity(0.02, 1, 0);
    World world = make_world(Grains::clumps);
    Clump shape;
    shape.balls = {{Vec3::Zero(), 1}};
    shape.volume = 1;
    shape.inertia = inertia;
    shape.bounding_radius = 1;
    const auto material = world.resource<Materials>().add(linear_material(1, 1, 0, 1));
    const EntityId body = add_clump(world, shape, 0, Vec3::Zero(), Quat::Identity(), material);
    set_angular_velocity(world, body, angular_velocity);
    Simulation simulation = begin(std::move(world), {.dt = dt});
    const double twice_energy = angular_velocity.cwiseAbs2().dot(inertia),
                 momentum2 = angular_velocity.cwiseProduct(inertia).squaredNorm();
    const double i1 = inertia.z(), i2 = inertia.y(), i3 = inertia.x();
    const double p = std::sqrt((i3 - i2) * (momentum2 - twice_energy * i1) / (i1 * i2 * i3));
    const double m =
        (i2 - i1) * (twice_energy * i3 - momentum2) / ((i3 - i2) * (momentum2 - twice_energy * i1));
    const double exact = 2 * elliptic_k(m) / p; // between two flips
    double before = 1, first = -1, last = 0;
    for (int found = 0; found <= flips;) {
        simulation.advance(1);
        const double about = (value_of<Orientation>(simulation, body).conjugate() *
                              value_of<AngularVelocity>(simulation, body))
                                 .y();
        if (before * about < 0) {
            last = simulation.world().resource<Clock>().time() - dt * about / (about - before);
            if (first < 0) first = last;
            ++found;
        }
        before = about;
    }
    rows.push_back(
        within_tolerance(fmt::format("mean time between {} flips about the middle axis, s", flips),
                         (last - first) / flips, exact, 1e-3));
}

// The spheres that touch an ellipsoid (a > b > c) from inside have their centres in its middle
// plane: the sphere at (x, y) has r^2 = c^2 (1 - x^2 / (a^2 - c^2) - y^2 / (b^2 - c^2)). All these
// spheres together fill the ellipsoid.
MassProperties packed_ellipsoid(const Vec3& axes, int rings) {
    const double c = axes.z(), u = std::sqrt(axes.x() * axes.x() - c * c),
                 v = std::sqrt(axes.y() * axes.y() - c * c);
    std::vector<Ball> balls{{Vec3::Zero(), c}};
    for (int k = 1; k < rings; ++k) // the spheres of the last ring would have radius zero
        for (int j = 0; j < 6 * k; ++j) {
            const double s = std::sin(0.5 * pi * k / rings),
                         angle = 2 * pi * (j + 0.5 * (k % 2)) / (6 * k);
            balls.push_back({Vec3(u * s * std::cos(angle), v * s * std::sin(angle), 0),
                             c * std::sqrt(1 - s * s)});
        }
    return union_properties(balls, 400);
}

void add_ellipsoid(StressRows& rows, int rings) {
    const Vec3 axes(1.5, 1.2, 1);
    const double volume = 4 * pi / 3 * axes.prod();
    const MassProperties found = packed_ellipsoid(axes, rings),
                         coarse = packed_ellipsoid(axes, rings / 2);
    const int spheres = 1 + 3 * rings * (rings - 1);
    const auto name = [&](const char* what) {
        return fmt::format("ellipsoid of {} spheres: {}", spheres, what);
    };
    // the error is of second order in the spacing: Richardson extrapolation from two packings
    const auto extrapolated = [](double fine, double rough) { return fine + (fine - rough) / 3; };
    rows.push_back(within_tolerance(name("extrapolated volume, m3"),
                                    extrapolated(found.volume, coarse.volume), volume, 1e-3));
    const Vec3 squares = axes.cwiseAbs2();
    const Vec3 moments =
        volume / 5 *
        Vec3(squares.y() + squares.z(), squares.z() + squares.x(), squares.x() + squares.y());
    const std::array names{"moment of inertia about its longest axis, m5",
                           "moment of inertia about its middle axis, m5",
                           "moment of inertia about its shortest axis, m5"};
    for (int k = 0; k < 3; ++k)
        rows.push_back(within_tolerance(name(names[static_cast<std::size_t>(k)]),
                                        extrapolated(found.inertia(k, k), coarse.inertia(k, k)),
                                        moments[k], 1e-3));
    const double order = std::log2((volume - coarse.volume) / (volume - found.volume));
    rows.push_back({"S27", name("order of the volume in the spacing"), "2 within 0.3",
                    fmt::format("{:.2f}", order), std::abs(order - 2) < 0.3});
}

void add_unions(StressRows& rows) {
    // two unit spheres, centres 1 apart: volume and moments in closed form
    const std::array<Ball, 2> pair{{{Vec3(-0.5, 0, 0), 1}, {Vec3(0.5, 0, 0), 1}}};
    const MassProperties two = union_properties(pair, 1e-6);
    const double lens = 5 * pi / 12;
    rows.push_back(within_tolerance("two unit spheres, 1 m apart: volume, m3", two.volume,
                                    8 * pi / 3 - lens, 1e-5));
    rows.push_back(
        within_tolerance("two unit spheres, 1 m apart: moment of inertia about the axis, m5",
                         two.inertia(0, 0), 3.0041479750, 1e-5));
    rows.push_back(
        within_tolerance("two unit spheres, 1 m apart: moment of inertia across the axis, m5",
                         two.inertia(1, 1), 5.2130803096, 1e-5));
    // three spheres in a row have two separate lenses in common
    const std::array<Ball, 3> row{
        {{Vec3(-1, 0.1, 0), 1}, {Vec3(0, 0.1, 0), 1}, {Vec3(1, 0.1, 0), 1}}};
    rows.push_back(within_tolerance("three unit spheres in a row: volume, m3",
                                    union_properties(row, 1e-6).volume, 4 * pi - 2 * lens, 1e-5));
    const std::array<Ball, 2> inside{{{Vec3::Zero(), 1}, {Vec3(0.2, 0.1, 0), 0.5}}};
    rows.push_back(within_tolerance("unit sphere that contains another sphere: volume, m3",
                                    union_properties(inside, 1e-6).volume, 4 * pi / 3, 1e-5));
}

} // namespace

StressRows stress_clump_dynamics(const StressSettings& s) {
    StressRows rows;
    const double cycles = s.full ? 50 : 2;
    // the amplitude of 0.01 rad changes the period by theta^2/16 = 6e-6; m g d = 0.3 N m, rolling
    // inertia 4e-3 + 0.07^2 kg m2
    rows.push_back(within_tolerance("rocking body (roly-poly) on a smooth floor: period, s",
                                    rocking_period(false, 5e-5, cycles),
                                    2 * pi * std::sqrt(4e-3 / 0.3), 1e-3));
    rows.push_back(within_tolerance("rocking body (roly-poly) that rolls: period, s",
                                    rocking_period(true, 2e-5, cycles),
                                    2 * pi * std::sqrt((4e-3 + 0.07 * 0.07) / 0.3), 1e-3));
    add_flips(rows, 0.01, s.full ? 200 : 20);
    add_ellipsoid(rows, s.full ? 20 : 12);
    add_unions(rows);
    return rows;
}

} // namespace bris
