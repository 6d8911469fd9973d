#include "tests/performance/peers/scene.hpp"

#include "components/kinds.hpp"
#include "components/sphere.hpp"
#include "engine/errors.hpp"
#include "engine/ordering.hpp"
#include "scenarios/rocks/mass_properties.hpp"
#include "scenarios/specimens/scene.hpp"
#include "tests/performance/peers/moving_walls.hpp"

#include <algorithm>
#include <array>
#include <span>

namespace bris::peers {

namespace {

void add_rock(World& world, std::span<const Ball> balls, std::uint32_t material) {
    const auto volume_of = [](const Ball& b) {
        return 4.0 / 3 * pi * b.radius * b.radius * b.radius;
    };
    Clump clump;
    Vec3 centre = Vec3::Zero();
    for (const Ball& b : balls) {
        clump.volume += volume_of(b);
        centre += volume_of(b) * b.centre;
    }
    centre /= clump.volume;
    Mat3 inertia = Mat3::Zero();
    for (const Ball& b : balls) {
        const Vec3 arm = b.centre - centre;
        inertia +=
            volume_of(b) * ((0.4 * b.radius * b.radius + arm.squaredNorm()) * Mat3::Identity() -
                            arm * arm.transpose());
    }
    const PrincipalAxes principal = principal_axes(inertia);
    const Quat turn(principal.axes);
    clump.inertia = principal.moments;
    for (const Ball& b : balls) {
        clump.balls.push_back({turn.conjugate() * Vec3(b.centre - centre), b.radius});
        clump.bounding_radius =
            std::max(clump.bounding_radius, (b.centre - centre).norm() + b.radius);
    }
    add_clump(world, clump, 0, centre, turn, material);
}

void add_single(World& world, const Ball& ball, const Scene& scene, std::uint32_t material) {
    const bool held = ball.centre.z()<scene.low, drawn = ball.centre.z()> scene.high;
    const Motion motion = held ? Motion::fixed : drawn ? Motion::prescribed : Motion::free;
    const EntityId id = add_sphere(world, ball.centre, ball.radius, material, motion);
    if (drawn)
        value_of<DriveVelocity>(world, id) = value_of<Velocity>(world, id) =
            Vec3(scene.speed, 0, 0);
}

} // namespace

Scene scene_named(const std::string& name) {
    static const std::array<Scene, 10> scenes{
        {{"settle", 1e6, 5838, 1e-5, 9.81},
         {"fall", 1e6, 5838, 1e-5, 9.81, true},
         {"shear", 1e6, 5838, 1e-5, 9.81},
         {"quiet", 1e6, 5838, 1e-5, 9.81},
         {"poly", 1e5, 20600, 2e-6, 1000},
         {"poly5", 1e5, 20600, 2e-6, 1000},
         {"clumps", 1e6, 1250, 2e-5, 9.81},
         {"drop", 1e6, 1250, 2e-5, 9.81, true},
         {"triaxial", 1e6, 1250, 2e-5, 0, false, true},
         {"triaxial_spheres", 1e6, 5838, 1e-5, 0, false, true}}};
    for (const Scene& scene : scenes)
        if (scene.name == name) return scene;
    throw InputError("--scene: expected settle, fall, shear, quiet, poly, poly5, clumps, drop, "
                     "triaxial or triaxial_spheres, found " +
                     name);
}

LawName law_named(const std::string& name) {
    return name == "hertz" ? LawName::hertz_mindlin_viscous : LawName::linear_viscous;
}

World make_scene(const Bed& bed, const Scene& scene, LawName law) {
    World world = make_world(bed.rocks.empty() ? Grains::spheres : Grains::clumps);
    // two partners act in series, so each has twice the stiffness of the contact
    Material grain{.name = "grain",
                   .density = density,
                   .normal_stiffness = 2 * scene.normal_stiffness,
                   .shear_stiffness = 4.0 / 7 * scene.normal_stiffness,
                   .friction = friction,
                   .young_modulus = young_modulus,
                   .poisson_ratio = poisson_ratio};
    auto& materials = world.resource<Materials>();
    if (is_hertz(law)) {
        grain.restitution = restitution;
        materials.policy.shear_history = ShearHistory::total;
        materials.policy.shear_dashpot = true;
    } else {
        grain.normal_damping = scene.damping_rate;
        grain.shear_damping = scene.damping_rate / 2;
    }
    const std::uint32_t material = materials.add(grain);
    const std::span<const Ball> balls(bed.balls);
    for (std::size_t first = 0, next = 0; first < balls.size(); first = next) {
        ++next;
        if (bed.rocks.empty()) {
            add_single(world, balls[first], scene, material);
        } else {
            while (next < balls.size() && bed.rocks[next] == bed.rocks[first]) ++next;
            add_rock(world, balls.subspan(first, next - first), material);
        }
    }
    if (scene.falls)
        for (Vec3& velocity : world.column<Bodies, Velocity>())
            velocity.z() = 0.5 * scene.step * scene.gravity;
    if (scene.pressed)
        add_moving_box(world, bed.box, material);
    else
        add_box(world, Vec3::Zero(), bed.box, material);
    auto& limits = world.resource<Limits>();
    limits.low = Vec3::Zero();
    limits.high = scene.pressed ? Vec3(1.1 * bed.box) : bed.box;
    if (scene.gravity > 0) world.add_resource<Gravity>({Vec3(0, 0, -scene.gravity)});
    world.resource<Clock>().dt = scene.step;
    return world;
}

std::vector<Ball> balls_now(const World& world) {
    const auto body_rows = rows_by_id(world.column<Bodies, BodyId>());
    const auto position = world.column<Bodies, Position>();
    const auto ids = world.column<Spheres, SphereId>();
    const auto parent = world.column<Spheres, ParentId>();
    const auto local = world.column<Spheres, LocalBall>();
    const bool turned = world.table<Bodies>().has<Orientation>();
    std::vector<Ball> balls(ids.size());
    for (Row r = 0; r < ids.size(); ++r) {
        const Row body = body_rows[parent[r]];
        const Vec3 arm = turned ? Vec3(world.column<Bodies, Orientation>()[body] * local[r].centre)
                                : local[r].centre;
        balls[ids[r]] = {position[body] + arm, local[r].radius};
    }
    return balls;
}

} // namespace bris::peers
