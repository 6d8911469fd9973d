#include "tests/verification/cluster.hpp"

#include "components/settings.hpp"
#include "engine/random.hpp"
#include "scenarios/collision/impact.hpp"
#include "scenarios/specimens/small_scene.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr double radius = 0.01, speed = 1;

Material grain() {
    Material m = linear_material(1e5, 5e4, 0.4);
    m.restitution = 0.7;
    m.young_modulus = 1e8;
    m.poisson_ratio = 0.25;
    m.rolling_friction = m.twisting_friction = 0.05;
    return m;
}

/// Transforms vectors between the plain description and another: x' = length (R M x + offset). A
/// pseudovector changes its sign in a mirror.
struct Frame {
    explicit Frame(const Description& description)
        : d(description), turn(d.rotation.toRotationMatrix()) {
        if (d.mirrored) turn = turn * Vec3(-1, 1, 1).asDiagonal();
    }
    Vec3 transformed(const Vec3& x) const { return d.length * (turn * x + d.offset); }
    Vec3 velocity(const Vec3& v) const { return d.length / d.time * (turn * v + d.boost); }
    Vec3 angular_velocity(const Vec3& w) const {
        return 1 / d.time * (d.mirrored ? -1 : 1) * (turn * w);
    }
    Vec3 transformed_back(const Vec3& x, double time) const {
        return turn.transpose() * (x / d.length - d.offset - time * d.boost);
    }
    Vec3 velocity_back(const Vec3& v) const {
        return turn.transpose() * (d.time / d.length * v - d.boost);
    }
    Material material() const {
        Material m = grain();
        m.density *= d.mass / (d.length * d.length * d.length);
        for (double* k : {&m.normal_stiffness, &m.shear_stiffness})
            *k *= d.mass / (d.time * d.time);
        m.young_modulus *= d.mass / (d.length * d.time * d.time);
        return m;
    }
    Description d;
    Mat3 turn;
};

struct Outcome {
    std::vector<Vec3> positions, velocities; // of each sphere in the plain description
    double contacts = 0;
};

double step_of(const Cluster& s) {
    return like_spheres(grain(), s.law, radius, speed).time() / s.steps_per_contact;
}

Outcome run(const Cluster& s, const Description& d) {
    const Frame frame(d);
    const double dt = step_of(s);
    World world = make_world(Grains::spheres);
    const auto material = world.resource<Materials>().add(frame.material());
    const unsigned count = s.side * s.side * s.side;
    std::vector<EntityId> ids(count);
    const double pitch = 2.02 * radius, half = 0.5 * (s.side - 1);
    for (unsigned made = 0; made < count; ++made) {
        const unsigned i = d.reversed ? count - 1 - made : made;
        Random random(s.seed, i);
        const Vec3 site = pitch * Vec3(i % s.side - half, i / s.side % s.side - half,
                                       i / s.side / s.side + 0.505);
        const Vec3 x = site + 0.004 * radius * random.direction(),
                   v = speed * (Vec3(0, 0, -1) - 0.3 * site / radius) + 0.2 * random.direction();
        ids[i] = add_sphere(world, frame.transformed(x), d.length * radius, material);
        value_of<Velocity>(world, ids[i]) = frame.velocity(v);
        set_angular_velocity(world, ids[i], frame.angular_velocity(30 * random.direction()));
    }
    const EntityId host =
        add_boundary(world, frame.transformed(Vec3::Zero()), material, Motion::prescribed);
    value_of<DriveVelocity>(world, host) = value_of<Velocity>(world, host) =
        frame.velocity(Vec3::Zero());
    add_plane(world, host, Vec3::Zero(), frame.turn * Vec3::UnitZ());
    if (s.local_damping > 0) world.add_resource(LocalDamping{s.local_damping});
    Simulation sim = begin(std::move(world), {.dt = dt * d.time,
                                              .law = s.law,
                                              .threads = d.threads,
                                              .energy_budget = false,
                                              .unlimited = true});
    Outcome r;
    for (unsigned k = 0; k < s.steps; ++k) {
        sim.advance();
        r.contacts += static_cast<double>(touch_of(sim.world()).pairs) / s.steps;
    }
    for (const EntityId id : ids) {
        r.positions.push_back(frame.transformed_back(value_of<Position>(sim, id), dt * s.steps));
        r.velocities.push_back(frame.velocity_back(value_of<Velocity>(sim, id)));
    }
    return r;
}

} // namespace

Difference compare(const Cluster& cluster, const Description& description) {
    const Outcome plain = run(cluster, {}), other = run(cluster, description);
    Difference r;
    r.contacts = plain.contacts;
    for (std::size_t i = 0; i < plain.positions.size(); ++i) {
        r.position_difference = std::max(r.position_difference,
                                         (plain.positions[i] - other.positions[i]).norm() / radius);
        r.motion = std::max(r.motion, (plain.velocities[i] - other.velocities[i]).norm() / speed);
    }
    return r;
}

} // namespace bris
