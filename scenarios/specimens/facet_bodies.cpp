#include "scenarios/specimens/facet_bodies.hpp"

#include "components/kinds.hpp"
#include "components/recorder.hpp"
#include "components/settings.hpp"
#include "engine/clock.hpp"
#include "engine/errors.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/recorder/record_motion.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bris {

namespace {

constexpr auto free_motion = static_cast<std::uint32_t>(Motion::free);

void require_clumps(const World& world, const char* what) {
    require(world.table<Bodies>().has<Orientation>(),
            fmt::format("{}: expected a scene of clumps, found one of single spheres, whose bodies "
                        "have no orientation",
                        what));
}

void require_free(const World& world, EntityId body, const char* what) {
    require(world.column<Bodies, MotionOf>()[row_of_body(world, body)] == free_motion,
            fmt::format("{}: expected a free body, found body {}, which is driven", what, body));
}

/// The list of a body in a resource with `of_body`, which the column Number refers to.
template <class Number, class Resource>
auto& list_of(World& world, EntityId body) {
    world.table<Bodies>().add<Number>();
    if (!world.has_resource<Resource>()) world.add_resource<Resource>();
    auto& lists = world.resource<Resource>().of_body;
    std::uint32_t& number = value_of<Number>(world, body);
    if (number == 0) {
        lists.emplace_back();
        number = static_cast<std::uint32_t>(lists.size());
    }
    return lists[number - 1];
}

} // namespace

EntityId add_facet_body(World& world, const Vec3& position, const Quat& orientation, double mass,
                        const Vec3& inertia, std::uint32_t material,
                        std::span<const FacetShape> facets) {
    require_clumps(world, "body of facets");
    require(mass > 0 && inertia.minCoeff() > 0,
            fmt::format("body of facets: expected a mass and moments of inertia above 0, found "
                        "{:g} kg and {:g}, {:g}, {:g} kg m2",
                        mass, inertia.x(), inertia.y(), inertia.z()));
    double reach = 0;
    for (const FacetShape& f : facets)
        for (const Vec3& corner : f.corners) reach = std::max(reach, corner.norm());
    const EntityId body = add_boundary(world, position, material, Motion::free, reach);
    value_of<Mass>(world, body) = value_of<InertialMass>(world, body) = mass;
    value_of<Inertia>(world, body) = value_of<InertialInertia>(world, body) = inertia;
    value_of<Orientation>(world, body) = orientation.normalized();
    for (const FacetShape& f : facets) add_facet(world, body, f);
    return body;
}

std::vector<FacetShape> block_facets(const Vec3& size) {
    std::vector<FacetShape> facets;
    for (int a = 0; a < 3; ++a)
        for (const double side : {-0.5, 0.5}) {
            // u x v points along a
            const Vec3 out = side * size[a] * Vec3::Unit(a),
                       u = 0.5 * size[(a + 1) % 3] * Vec3::Unit((a + 1) % 3),
                       v = 0.5 * size[(a + 2) % 3] * Vec3::Unit((a + 2) % 3);
            if (side > 0)
                facets.push_back({{out - u - v, out + u - v, out + u + v, out - u + v}});
            else
                facets.push_back({{out - u - v, out - u + v, out + u + v, out + u - v}});
        }
    return facets;
}

Vec3 block_inertia(const Vec3& size, double mass) {
    const Vec3 s = size.cwiseAbs2();
    return mass / 12 * Vec3(s.y() + s.z(), s.z() + s.x(), s.x() + s.y());
}

EntityId add_block(World& world, const Vec3& position, const Quat& orientation, const Vec3& size,
                   double mass, std::uint32_t material) {
    require(size.minCoeff() > 0, fmt::format("block: expected sides above 0 m, found {:g} x {:g} x "
                                             "{:g} m",
                                             size.x(), size.y(), size.z()));
    return add_facet_body(world, position, orientation, mass, block_inertia(size, mass), material,
                          block_facets(size));
}

void add_load(World& world, EntityId body, const Load& load) {
    require_clumps(world, "load");
    require_free(world, body, "load");
    const LoadHistory& h = load.history;
    require(h.times.size() == h.values.size() &&
                std::adjacent_find(h.times.begin(), h.times.end(), std::greater_equal<>()) ==
                    h.times.end(),
            "load: expected a table of ascending times with a value for each");
    list_of<LoadOf, Loads>(world, body).push_back(load);
    world.table<Bodies>().add<LoadForce>();
}

void add_patch(World& world, EntityId body, const SpringPatch& patch) {
    require_clumps(world, "spring-dashpot patch");
    require_free(world, body, "spring-dashpot patch");
    require(patch.stiffness >= 0 && patch.damping >= 0 && std::abs(patch.axis.norm() - 1) < 1e-12,
            fmt::format("spring-dashpot patch: expected a stiffness and a damping of at least 0 "
                        "and an axis of length 1, found {:g} N/m, {:g} N s/m and {:g}",
                        patch.stiffness, patch.damping, patch.axis.norm()));
    list_of<PatchesOf, SpringPatches>(world, body).push_back(patch);
    world.table<Bodies>().add<PatchForce>();
}

void add_guide(World& world, EntityId body, const Vec3& point, const Vec3& axis, double stiffness,
               double damping) {
    add_patch(world, body,
              {.point = point,
               .anchor = value_of<Position>(world, body) + point,
               .axis = axis,
               .stiffness = stiffness,
               .damping = damping});
}

void add_recorder(World& world, EntityId body, const ImuModel& model, const Vec3& gravity,
                  std::uint64_t seed) {
    require_clumps(world, "inertial recorder");
    world.table<Bodies>().add<RecorderOf>();
    if (!world.has_resource<InertialRecorders>()) {
        world.add_resource<InertialRecorders>();
        world.add_resource<NotedMotions>();
    }
    auto& list = world.resource<InertialRecorders>().list;
    std::uint32_t& number = value_of<RecorderOf>(world, body);
    require(number == 0, fmt::format("inertial recorder: expected at most one on a body, found "
                                     "another one on body {}",
                                     body));
    list.push_back({.body = body,
                    .device = {Imu(model, gravity, seed, body)},
                    .exact = {Imu(without_errors(model), gravity, seed, body)}});
    world.resource<NotedMotions>().of.resize(list.size());
    number = static_cast<std::uint32_t>(list.size());
}

Vec3 contact_force(const World& world, EntityId body) {
    const Row row = row_of_body(world, body);
    const Table& bodies = world.table<Bodies>();
    const Vec3 outer = bodies.column<LoadForce>()[row].force +
                       bodies.column<Mass>()[row] * world.resource<Gravity>().value;
    return bodies.column<Force>()[row] - bodies.column<PatchForce>()[row].force - outer;
}

void start_recording(World& world) {
    auto& recorders = world.resource<InertialRecorders>();
    const Clock& clock = world.resource<Clock>();
    for (InertialRecorder& r : recorders.list) {
        require(r.device.imu.model().rate * clock.dt <= 1,
                fmt::format("inertial recorder: expected a sampling rate up to {:g} Hz, one sample "
                            "per time step, found {:g} Hz",
                            1 / clock.dt, r.device.imu.model().rate));
        r.device.samples.clear();
        r.exact.samples.clear();
    }
    recorders.start = clock.time();
    recorders.running = true;
}

} // namespace bris
