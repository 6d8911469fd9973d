// S15: results do not depend on the reference frame: moving, rotated or shifted.
#include "components/boundary.hpp"
#include "engine/random.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/output/quantities.hpp"
#include "tests/stability/cases.hpp"

#include <fmt/format.h>

namespace bris {

namespace {

struct Frame {
    Mat3 turn = Mat3::Identity();
    Vec3 offset = Vec3::Zero(); // m
    Vec3 boost = Vec3::Zero();  // m/s
};

constexpr double dt = 2e-5;

void take_to(World& world, const Frame& f) {
    Table& bodies = world.table<Bodies>();
    const Quat turn = Quat(Eigen::Quaterniond(Eigen::Matrix3d(f.turn)));
    for (Row b = 0; b < bodies.size(); ++b) {
        Vec3& x = bodies.column<Position>()[b];
        Vec3& v = bodies.column<Velocity>()[b];
        x = f.turn * x + f.offset;
        v = f.turn * v + f.boost;
        bodies.column<AngularVelocity>()[b] = f.turn * bodies.column<AngularVelocity>()[b];
        bodies.column<AngularMomentum>()[b] = f.turn * bodies.column<AngularMomentum>()[b];
        if (bodies.has<Orientation>())
            bodies.column<Orientation>()[b] = turn * bodies.column<Orientation>()[b];
        if (bodies.column<MotionOf>()[b] == static_cast<std::uint32_t>(Motion::free)) continue;
        bodies.column<MotionOf>()[b] = static_cast<std::uint32_t>(Motion::prescribed);
        bodies.column<DriveVelocity>()[b] = v;
    }
    for (PlaneShape& p : world.column<Planes, LocalPlane>())
        p = {f.turn * p.point, f.turn * p.normal};
    world.resource<Gravity>().value = f.turn * world.resource<Gravity>().value;
}

/// Positions (m) of the bodies in the axes of the frame, by id. `nudge` (m) is an initial random
/// displacement of every body.
std::vector<Vec3> positions(const Tumble& scene, const Frame& f, unsigned steps, double nudge = 0) {
    World world = tumbling(scene);
    Random random(scene.seed, 15);
    for (EntityId id = 0; id < scene.bodies; ++id)
        value_of<Position>(world, id) += nudge * random.direction();
    take_to(world, f);
    Simulation simulation = begin(std::move(world), {.dt = dt, .law = LawName::linear_viscous});
    simulation.advance(steps);
    std::vector<Vec3> list;
    for (EntityId id = 0; id < scene.bodies; ++id)
        list.push_back(f.turn.transpose() *
                       (value_of<Position>(simulation, id) - f.offset - steps * dt * f.boost));
    return list;
}

double difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    double worst = 0;
    for (std::size_t k = 0; k < a.size(); ++k) worst = std::max(worst, (a[k] - b[k]).norm());
    return worst;
}

/// The 24 rotations of a cube.
std::vector<Mat3> cube_rotations() {
    std::vector<Mat3> list;
    for (int x = 0; x < 3; ++x)
        for (int y = 0; y < 3; ++y)
            for (int signs = 0; signs < 4 && x != y; ++signs) {
                const Vec3 a = (signs & 1 ? -1 : 1) * Vec3(Vec3::Unit(x)),
                           b = (signs & 2 ? -1 : 1) * Vec3(Vec3::Unit(y));
                Mat3 m;
                m.col(0) = a;
                m.col(1) = b;
                m.col(2) = a.cross(b);
                list.push_back(m);
            }
    return list;
}

} // namespace

StressRows stress_frames(const StressSettings& s) {
    StressRows rows;
    const unsigned steps = s.full ? 1000 : 400;
    for (const Grains grains : {Grains::spheres, Grains::clumps}) {
        const Tumble scene{
            .grains = grains, .bodies = grains == Grains::spheres ? 60u : 20u, .seed = s.seed};
        const char* what = grains == Grains::spheres ? "spheres" : "clumps";
        const auto reference = positions(scene, {}, steps);
        const double diameter = 2 * mean_radius(tumbling(scene)), nudge = 1e-9 * diameter;
        const double condition =
            std::max(1.0, difference(reference, positions(scene, {}, steps, nudge)) / nudge);
        // Every step rounds a position of this size by eps, which changes the velocity of a body by
        // k eps size dt / m. n changes of random sign move it by (omega dt)^2 n^1.5 eps size, with
        // omega dt = 0.1 here, and the run amplifies this by its condition. The largest error of 60
        // bodies is three such deviations.
        const double rounding =
            3 * condition * 0.01 * std::pow(steps, 1.5) * std::numeric_limits<double>::epsilon();
        const auto add = [&](const std::string& name, const Frame& f, double size) {
            const double error = difference(reference, positions(scene, f, steps));
            const double allowed = rounding * size;
            rows.push_back({"S15", fmt::format("{}: {}", what, name),
                            fmt::format("same positions within three deviations of rounding x "
                                        "condition {:.0f}: {:.1e} m",
                                        condition, allowed),
                            fmt::format("{:.1e} m", error), error <= allowed});
        };
        double worst = 0;
        for (const Mat3& turn : cube_rotations())
            worst = std::max(worst, difference(reference, positions(scene, {.turn = turn}, steps)));
        const double allowed = rounding * 0.2;
        rows.push_back(
            {"S15", fmt::format("{}: the 24 rotations of a cube", what),
             fmt::format("same positions within three deviations of rounding x condition {:.0f}: "
                         "{:.1e} m",
                         condition, allowed),
             fmt::format("at most {:.1e} m", worst), worst <= allowed});
        add("rotated by 0.3, 0.7, -0.4 rad",
            {.turn = exponential_map(Vec3(0.3, 0.7, -0.4)).toRotationMatrix()}, 0.2);
        add("moving at (3, -2, 1) m/s", {.boost = Vec3(3, -2, 1)}, 0.2);
        add("shifted by 1 km along each axis", {.offset = Vec3(1e3, -1e3, 1e3)}, 1.7e3);
        add("shifted by 1000 km along each axis", {.offset = Vec3(1e6, -1e6, 1e6)}, 1.7e6);
    }
    return rows;
}

} // namespace bris
