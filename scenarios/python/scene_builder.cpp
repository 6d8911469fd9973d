#include "scenarios/python/scene_builder.hpp"

#include "engine/errors.hpp"
#include "scenarios/rocks/clump_library.hpp"
#include "scenarios/specimens/facet_bodies.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/fields/initial_fouling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace bris {

namespace py = pybind11;

namespace {

constexpr std::array<std::pair<const char*, double Material::*>, 19> properties{
    {{"density", &Material::density},
     {"normal_stiffness", &Material::normal_stiffness},
     {"shear_stiffness", &Material::shear_stiffness},
     {"friction", &Material::friction},
     {"normal_damping", &Material::normal_damping},
     {"shear_damping", &Material::shear_damping},
     {"restitution", &Material::restitution},
     {"young_modulus", &Material::young_modulus},
     {"poisson_ratio", &Material::poisson_ratio},
     {"rolling_friction", &Material::rolling_friction},
     {"twisting_friction", &Material::twisting_friction},
     {"contact_strength", &Material::contact_strength},
     {"cone_half_angle", &Material::cone_half_angle},
     {"edge_radius", &Material::edge_radius},
     {"friction_rise", &Material::friction_rise},
     {"friction_half_pressure", &Material::friction_half_pressure},
     {"friction_half_force", &Material::friction_half_force},
     {"couple_arm", &Material::couple_arm},
     {"couple_force", &Material::couple_force}}};

constexpr std::array<std::pair<const char*, double FilterSettings::*>, 9> filter_settings{
    {{"position", &FilterSettings::position},
     {"velocity", &FilterSettings::velocity},
     {"attitude", &FilterSettings::attitude},
     {"angular_velocity", &FilterSettings::angular_velocity},
     {"acceleration_density", &FilterSettings::acceleration_density},
     {"angular_acceleration_density", &FilterSettings::angular_acceleration_density},
     {"drift", &FilterSettings::drift},
     {"turning", &FilterSettings::turning},
     {"gate", &FilterSettings::gate}}};

/// Sets the members of `of` that `given` names. `what`: of which they are, for messages.
void set_members(auto& of, const auto& members, const py::kwargs& given, const char* what) {
    for (const auto& [key, value] : given) {
        const auto name = key.template cast<std::string>();
        std::string names;
        bool found = false;
        for (const auto& [known, member] : members) {
            if (name == known) of.*member = value.template cast<double>();
            found = found || name == known;
            names += (names.empty() ? "" : ", ") + std::string(known);
        }
        require(found, fmt::format("{}: expected one of {}, found {}", what, names, name));
    }
}

Grains grains_named(const std::string& name) {
    require(name == "spheres" || name == "clumps",
            "scene: expected spheres or clumps, found " + name);
    return name == "spheres" ? Grains::spheres : Grains::clumps;
}

Motion motion_named(const std::string& name) {
    if (name == "free") return Motion::free;
    if (name == "fixed") return Motion::fixed;
    if (name == "prescribed") return Motion::prescribed;
    throw InputError("motion: expected free, fixed or prescribed, found " + name);
}

void require_positive(const char* what, double value, const char* unit) {
    require(value > 0 && std::isfinite(value),
            fmt::format("{}: expected a finite number above 0 {}, found {:g}", what, unit, value));
}

void require_finite(const char* what, const Vec3& v, const char* unit) {
    require(v.allFinite(), fmt::format("{}: expected finite numbers ({}), found ({:g}, {:g}, {:g})",
                                       what, unit, v.x(), v.y(), v.z()));
}

/// Of a vector whose direction counts.
void require_direction(const char* what, double norm) {
    constexpr double least = 1e-100, most = 1e100;
    require(norm >= least && norm <= most,
            fmt::format("{}: expected a length from {:g} to {:g}, found {:g}", what, least, most,
                        norm));
}

/// Three or four corners that are a convex plane facet.
void check_facet(const std::vector<Vec3>& corners) {
    constexpr double flat = 1e-6; // of the longest edge
    const std::size_t n = corners.size();
    require(n == 3 || n == 4, fmt::format("facets: expected 3 or 4 corners, found {}", n));
    for (const Vec3& corner : corners) require_finite("facets: corner", corner, "m");
    const Vec3 normal = (corners[1] - corners[0]).cross(corners.back() - corners[0]);
    require(normal.norm() > 0, "facets: expected corners that span a plane, found three on a line");
    if (n == 3) return;
    double longest = 0;
    for (std::size_t k = 0; k < n; ++k)
        longest = std::max(longest, (corners[(k + 1) % n] - corners[k]).norm());
    const double off = std::abs((corners[2] - corners[0]).dot(normal.normalized()));
    require(off <= flat * longest,
            fmt::format("facets: expected four corners in a plane, found the third one {:g} m "
                        "beside it",
                        off));
    for (std::size_t k = 0; k < n; ++k) {
        const Vec3 edge = corners[(k + 1) % n] - corners[k],
                   next = corners[(k + 2) % n] - corners[(k + 1) % n];
        require(edge.cross(next).dot(normal) > 0,
                "facets: expected four corners of a convex facet in their order, found others");
    }
}

} // namespace

SceneBuilder::SceneBuilder(const std::string& grains, double step, const Vec3& gravity)
    : world_(make_world(grains_named(grains))) {
    require_positive("scene: step", step, "s");
    require_finite("scene: gravity", gravity, "m/s2");
    world_.resource<Clock>().dt = step;
    if (gravity != Vec3::Zero()) world_.add_resource<Gravity>({gravity});
}

std::uint32_t SceneBuilder::add_material(const py::kwargs& given) {
    Material material;
    set_members(material, properties, given, "material");
    return world().resource<Materials>().add(material);
}

void SceneBuilder::check(std::uint32_t material) const {
    const std::size_t known = world().resource<Materials>().list.size();
    require(material < known, fmt::format("material: expected an index below {}, the number of "
                                          "materials of the scene, found {}",
                                          known, material));
    require(!world().has_resource<Fouling>(), "scene: expected no body after the fines");
}

EntityId SceneBuilder::add_sphere(const Vec3& position, double radius, std::uint32_t material,
                                  const std::string& motion) {
    World& scene = world();
    check(material);
    require_finite("sphere: position", position, "m");
    require_positive("sphere: radius", radius, "m");
    return bris::add_sphere(scene, position, radius, material, motion_named(motion));
}

EntityId SceneBuilder::add_rock(const std::filesystem::path& clump, double size,
                                const Vec3& position, const Quat& orientation,
                                std::uint32_t material, const std::string& motion) {
    World& scene = world();
    check(material);
    require(scene.table<Bodies>().has<Orientation>(),
            "rock: expected a scene of clumps, found one of spheres");
    require_positive("rock: size", size, "m");
    require_finite("rock: position", position, "m");
    require_direction("rock: orientation", orientation.norm());
    return add_clump(scene, scaled(read_clump(clump), size), 0, position, orientation.normalized(),
                     material, motion_named(motion));
}

EntityId SceneBuilder::add_plane(const Vec3& point, const Vec3& normal, std::uint32_t material,
                                 const std::string& motion) {
    World& scene = world();
    check(material);
    const Motion moved = motion_named(motion);
    require(moved != Motion::free, "plane: expected fixed or prescribed, found free");
    require_finite("plane: point", point, "m");
    require_direction("plane: normal", normal.norm());
    const EntityId host = add_boundary(scene, point, material, moved);
    bris::add_plane(scene, host, Vec3::Zero(), normal);
    return host;
}

EntityId SceneBuilder::add_facets(const std::vector<std::vector<Vec3>>& facets,
                                  std::uint32_t material, const std::string& motion) {
    check(material);
    const Motion moved = motion_named(motion);
    require(moved != Motion::free, "facets: expected fixed or prescribed, found free");
    require(!facets.empty(), "facets: expected at least one, found none");
    Vec3 middle = Vec3::Zero();
    double corners = 0, reach = 0;
    for (const auto& facet : facets) {
        check_facet(facet);
        for (const Vec3& corner : facet) middle += corner;
        corners += static_cast<double>(facet.size());
    }
    middle /= corners;
    for (const auto& facet : facets)
        for (const Vec3& corner : facet) reach = std::max(reach, (corner - middle).norm());
    const EntityId host = add_boundary(world(), middle, material, moved, reach);
    for (const auto& facet : facets)
        add_facet(
            world(), host,
            {{facet[0] - middle, facet[1] - middle, facet[2] - middle, facet.back() - middle}});
    return host;
}

void SceneBuilder::add_membrane(double radius, double height, unsigned rings, unsigned sectors,
                                double pressure, double contact_stiffness, std::uint32_t material) {
    check(material);
    require(!world().has_resource<Membrane>(), "membrane: expected one, found two");
    require_positive("membrane: radius", radius, "m");
    require_positive("membrane: height", height, "m");
    require_positive("membrane: pressure", pressure, "Pa");
    require_positive("membrane: contact_stiffness", contact_stiffness, "N/m");
    require(rings >= 1 && sectors >= 4 && rings <= 1000 && sectors <= 1000,
            fmt::format("membrane: expected 1 to 1000 rings and 4 to 1000 sectors, found {} and {}",
                        rings, sectors));
    add_tube(world(), {rings, sectors, radius, height, pressure, contact_stiffness}, material);
}

void SceneBuilder::set_velocity(EntityId body, const Vec3& velocity) {
    require_finite("set_velocity", velocity, "m/s");
    const auto motion = static_cast<Motion>(value_of<MotionOf>(world(), body));
    require(motion == Motion::free || motion == Motion::prescribed,
            fmt::format("set_velocity: expected a free or prescribed body, found id {}", body));
    value_of<Velocity>(world(), body) = velocity;
    value_of<DriveVelocity>(world(), body) = velocity;
}

void SceneBuilder::add_sensor(EntityId body, const std::vector<double>& times,
                              const std::vector<Vec3>& positions, double deviation) {
    require(times.size() == positions.size(),
            fmt::format("sensor: expected as many positions as times, found {} and {}",
                        positions.size(), times.size()));
    require_positive("sensor: deviation", deviation, "m");
    for (std::size_t k = 0; k < times.size(); ++k)
        require(std::isfinite(times[k]) && positions[k].allFinite(),
                fmt::format("sensor: expected finite times and positions, found others in sample "
                            "{}",
                            k));
    (void)value_of<Position>(world(), body);
    hosts_.push_back(body);
    auto& samples = samples_.emplace_back();
    for (std::size_t k = 0; k < times.size(); ++k) {
        Measured what;
        what.position = positions[k];
        what.position_deviation = deviation;
        samples.push_back({.time = times[k], .what = what});
    }
}

void SceneBuilder::set_filter(const py::kwargs& settings) {
    set_members(filter_, filter_settings, settings, "filter");
}

void SceneBuilder::add_recorder(EntityId body, const std::string& device, double rate,
                                std::uint64_t seed) {
    require_positive("recorder: rate", rate, "Hz");
    ImuModel model = imu_preset(device);
    model.rate = rate;
    const Vec3 gravity =
        world().has_resource<Gravity>() ? world().resource<Gravity>().value : Vec3(Vec3::Zero());
    bris::add_recorder(world(), body, model, gravity, seed);
}

void SceneBuilder::add_fines(double p4, double p200, double saturation, double voxel,
                             const Vec3& low, const Vec3& high) {
    require(!world().has_resource<Fouling>(), "fines: expected them once, found them twice");
    add_fouling(world(), {.voxel = voxel}, {}, {low, high});
    fill_with_fines(world(), {.p4 = p4, .p200 = p200, .saturation = saturation});
}

World SceneBuilder::complete() const {
    World complete = world();
    if (!hosts_.empty()) add_sensors(complete, hosts_, samples_, filter_);
    return complete;
}

void SceneBuilder::close() {
    world_ = {};
    taken_ = true;
}

const World& SceneBuilder::world() const {
    require(!taken_, "scene: expected one that no simulation has taken over");
    return world_;
}

} // namespace bris
