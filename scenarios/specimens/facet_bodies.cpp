#include "scenarios/specimens/facet_bodies.hpp"

#include "components/kinds.hpp"
#include "components/recorder.hpp"
#include "components/settings.hpp"
#include "engine/clock.hpp"
#include "engine/errors.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/output/outer_force.hpp"
#include "systems/recorder/record_motion.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bris {

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
    return world.column<Bodies, Force>()[row] - OuterForces(world)(row);
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
