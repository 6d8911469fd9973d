#include "scenarios/specimens/scene.hpp"

#include "components/kinds.hpp"
#include "components/sphere.hpp"
#include "engine/errors.hpp"

namespace bris {

namespace {

struct BodyValues {
    Vec3 position;
    std::uint32_t material;
    Motion motion;
    double mass, bounding_radius;
};

Row add_body(World& world, const BodyValues& v) {
    Table& bodies = world.table<Bodies>();
    const auto row = static_cast<Row>(bodies.size());
    bodies.resize(bodies.size() + 1);
    bodies.column<BodyId>()[row] = row; // ids have no gaps; retire_bodies keeps it so
    bodies.column<Position>()[row] = v.position;
    bodies.column<MaterialOf>()[row] = v.material;
    bodies.column<MotionOf>()[row] = static_cast<std::uint32_t>(v.motion);
    bodies.column<Mass>()[row] = bodies.column<InertialMass>()[row] = v.mass;
    bodies.column<BoundingRadius>()[row] = v.bounding_radius;
    return row;
}

void add_ball(World& world, EntityId parent, const Ball& ball) {
    Table& spheres = world.table<Spheres>();
    const auto row = static_cast<Row>(spheres.size());
    spheres.resize(spheres.size() + 1);
    spheres.column<SphereId>()[row] = row;
    spheres.column<ParentId>()[row] = parent;
    spheres.column<LocalBall>()[row] = ball;
}

double density_of(const World& world, std::uint32_t material, Motion motion) {
    const Material& m = world.resource<Materials>().list.at(material);
    require(motion != Motion::free || m.density > 0,
            "material '" + m.name + "': expected a density above 0 kg/m3, found " +
                std::to_string(m.density));
    return m.density;
}

} // namespace

World make_world(Grains grains) {
    World world;
    Table& bodies = world.table<Bodies>();
    bodies.add<BodyId>();
    bodies.add<MotionOf>();
    bodies.add<MaterialOf>();
    bodies.add<Position>();
    bodies.add<Velocity>();
    bodies.add<Acceleration>();
    bodies.add<AngularVelocity>();
    bodies.add<StepAngularVelocity>();
    bodies.add<AngularMomentum>();
    bodies.add<DriveVelocity>();
    bodies.add<Mass>();
    bodies.add<InertialMass>();
    bodies.add<BoundingRadius>();
    if (grains == Grains::spheres) {
        bodies.add<SphereInertia>();
    } else {
        bodies.add<ShapeOf>();
        bodies.add<Orientation>();
        bodies.add<Inertia>();
        bodies.add<InertialInertia>();
    }
    Table& spheres = world.table<Spheres>();
    spheres.add<SphereId>();
    spheres.add<ParentId>();
    spheres.add<LocalBall>();
    world.add_resource<Materials>();
    world.add_resource<Clock>();
    world.add_resource<Limits>();
    world.add_resource<Health>();
    world.add_resource<Alarm>();
    return world;
}

EntityId add_sphere(World& world, const Vec3& position, double radius, std::uint32_t material,
                    Motion motion) {
    require(radius > 0, "sphere: expected a radius above 0 m, found " + std::to_string(radius));
    const double mass = density_of(world, material, motion) * 4 / 3 * pi * radius * radius * radius;
    const Row row = add_body(world, {position, material, motion, mass, radius});
    if (world.table<Bodies>().has<SphereInertia>()) {
        world.column<Bodies, SphereInertia>()[row] = 0.4 * mass * radius * radius;
    } else {
        world.column<Bodies, Orientation>()[row] = Quat::Identity();
        world.column<Bodies, Inertia>()[row] = world.column<Bodies, InertialInertia>()[row] =
            Vec3::Constant(0.4 * mass * radius * radius);
    }
    add_ball(world, row, {Vec3::Zero(), radius});
    return row;
}

EntityId add_clump(World& world, const Clump& clump, std::uint32_t shape, const Vec3& position,
                   const Quat& orientation, std::uint32_t material, Motion motion) {
    const double density = density_of(world, material, motion);
    const Row row = add_body(
        world, {position, material, motion, density * clump.volume, clump.bounding_radius});
    Table& bodies = world.table<Bodies>();
    bodies.column<ShapeOf>()[row] = shape;
    bodies.column<Orientation>()[row] = orientation;
    bodies.column<Inertia>()[row] = bodies.column<InertialInertia>()[row] = density * clump.inertia;
    for (const Ball& ball : clump.balls) add_ball(world, row, ball);
    return row;
}

EntityId add_boundary(World& world, const Vec3& position, std::uint32_t material, Motion motion,
                      double reach) {
    const Row row = add_body(world, {position, material, motion, 0, reach});
    Table& bodies = world.table<Bodies>();
    bodies.column<InertialMass>()[row] = 1; // not used, because the motion is prescribed
    if (bodies.has<SphereInertia>()) {
        bodies.column<SphereInertia>()[row] = 1;
    } else {
        bodies.column<Orientation>()[row] = Quat::Identity();
        bodies.column<InertialInertia>()[row] = Vec3::Ones();
    }
    return row;
}

EntityId add_plane(World& world, EntityId host, const Vec3& point, const Vec3& normal) {
    Table& planes = world.table<Planes>();
    planes.add<PlaneId>();
    planes.add<HostId>();
    planes.add<HostRow>();
    planes.add<LocalPlane>();
    planes.add<PlanePosition>();
    const auto row = static_cast<Row>(planes.size());
    planes.resize(planes.size() + 1);
    planes.column<PlaneId>()[row] = row;
    planes.column<HostId>()[row] = host;
    planes.column<LocalPlane>()[row] = {point, normal.normalized()};
    return row;
}

EntityId add_facet(World& world, EntityId host, const FacetShape& shape) {
    Table& facets = world.table<Facets>();
    facets.add<FacetId>();
    facets.add<HostId>();
    facets.add<HostRow>();
    facets.add<LocalFacet>();
    facets.add<FacetPosition>();
    const auto row = static_cast<Row>(facets.size());
    facets.resize(facets.size() + 1);
    facets.column<FacetId>()[row] = row;
    facets.column<HostId>()[row] = host;
    facets.column<LocalFacet>()[row] = shape;
    return row;
}

void add_membrane(World& world, Membrane membrane, double radius, std::uint32_t material) {
    membrane.body = add_boundary(world, Vec3::Zero(), material, Motion::fixed, 2 * radius);
    membrane.outward.clear();
    for (unsigned sector = 0; sector < membrane.sectors; ++sector) {
        const double angle = 2 * pi * (sector + 0.5) / membrane.sectors;
        membrane.outward.push_back({std::cos(angle), std::sin(angle), 0});
    }
    const std::size_t count = std::size_t{membrane.rings} * membrane.sectors;
    membrane.pressure.assign(membrane.per_element ? count : membrane.rings, 0);
    membrane.stiffness.assign(membrane.pressure.size(), 0);
    Table& elements = world.table<Elements>();
    elements.add<ElementId>();
    elements.add<ElementRadius>();
    elements.add<ElementSpeed>();
    elements.add<ElementPush>();
    elements.add<ElementHold>();
    elements.add<ElementArea>();
    elements.add<PrunedRadius>();
    elements.add<RebuiltRadius>();
    elements.resize(count);
    for (Row e = 0; e < count; ++e) elements.column<ElementId>()[e] = e;
    for (double& r : elements.column<ElementRadius>()) r = radius;
    world.add_resource(std::move(membrane));
}

Row row_of_body(const World& world, EntityId body) {
    const auto ids = world.column<Bodies, BodyId>();
    for (Row r = 0; r < ids.size(); ++r)
        if (ids[r] == body) return r;
    throw InputError("scene: expected a body of the given id, found none with id " +
                     std::to_string(body));
}

Vec3 angular_momentum(const World& world, EntityId body, const Vec3& angular_velocity) {
    const Table& bodies = world.table<Bodies>();
    const Row row = row_of_body(world, body);
    if (bodies.has<SphereInertia>()) return bodies.column<SphereInertia>()[row] * angular_velocity;
    const Quat& q = bodies.column<Orientation>()[row];
    const Vec3 local = q.conjugate() * angular_velocity;
    return q * Vec3(local.cwiseProduct(bodies.column<InertialInertia>()[row]));
}

void set_angular_velocity(World& world, EntityId body, const Vec3& angular_velocity) {
    value_of<AngularVelocity>(world, body) = value_of<StepAngularVelocity>(world, body) =
        angular_velocity;
    value_of<AngularMomentum>(world, body) = angular_momentum(world, body, angular_velocity);
}

EntityId add_floor(World& world, std::uint32_t material) {
    const EntityId host = add_boundary(world, Vec3::Zero(), material);
    add_plane(world, host, Vec3::Zero(), Vec3::UnitZ());
    return host;
}

EntityId add_box(World& world, const Vec3& low, const Vec3& high, std::uint32_t material) {
    const EntityId host = add_boundary(world, Vec3::Zero(), material);
    for (int a = 0; a < 3; ++a) {
        const Vec3 axis = Vec3::Unit(a);
        add_plane(world, host, low[a] * axis, axis);
        add_plane(world, host, high[a] * axis, -axis);
    }
    return host;
}

Material linear_material(double kn, double ks, double friction, double density) {
    Material m;
    m.name = "grain";
    m.density = density;
    m.normal_stiffness = 2 * kn;
    m.shear_stiffness = 2 * ks;
    m.friction = friction;
    return m;
}

Material rigid_material(double friction) {
    Material m;
    m.name = "rigid";
    m.normal_stiffness = m.shear_stiffness = m.young_modulus = 1e30;
    m.friction = friction;
    m.rolling_friction = m.twisting_friction = 1e9;
    return m;
}

} // namespace bris
