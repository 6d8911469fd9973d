#include "scenarios/python/scene_builder.hpp"

#include "engine/errors.hpp"
#include "scenarios/rocks/clump_library.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

namespace bris {

namespace py = pybind11;

namespace {

constexpr std::array<std::pair<const char*, double Material::*>, 11> properties{
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
     {"twisting_friction", &Material::twisting_friction}}};

double Material::*property_named(const std::string& name) {
    std::string names;
    for (const auto& [known, member] : properties) {
        if (name == known) return member;
        names += (names.empty() ? "" : ", ") + std::string(known);
    }
    throw InputError("material: expected one of " + names + ", found " + name);
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

} // namespace

SceneBuilder::SceneBuilder(const std::string& grains, double step, const Vec3& gravity)
    : world_(make_world(grains_named(grains))) {
    world_.resource<Clock>().dt = step;
    if (gravity != Vec3::Zero()) world_.add_resource<Gravity>({gravity});
}

std::uint32_t SceneBuilder::add_material(const py::kwargs& given) {
    Material material;
    for (const auto& [key, value] : given)
        material.*property_named(key.cast<std::string>()) = value.cast<double>();
    return world().resource<Materials>().add(material);
}

void SceneBuilder::check(std::uint32_t material) const {
    const std::size_t known = world_.resource<Materials>().list.size();
    require(material < known, fmt::format("material: expected an index below {}, the number of "
                                          "materials of the scene, found {}",
                                          known, material));
}

EntityId SceneBuilder::add_sphere(const Vec3& position, double radius, std::uint32_t material,
                                  const std::string& motion) {
    World& scene = world();
    check(material);
    return bris::add_sphere(scene, position, radius, material, motion_named(motion));
}

EntityId SceneBuilder::add_rock(const std::filesystem::path& clump, double size,
                                const Vec3& position, const Quat& orientation,
                                std::uint32_t material, const std::string& motion) {
    World& scene = world();
    check(material);
    require(scene.table<Bodies>().has<Orientation>(),
            "rock: expected a scene of clumps, found one of spheres");
    require(size > 0, fmt::format("rock: expected a size above 0 m, found {:g}", size));
    return add_clump(scene, scaled(read_clump(clump), size), 0, position, orientation.normalized(),
                     material, motion_named(motion));
}

EntityId SceneBuilder::add_plane(const Vec3& point, const Vec3& normal, std::uint32_t material,
                                 const std::string& motion) {
    World& scene = world();
    check(material);
    const Motion moved = motion_named(motion);
    require(moved != Motion::free, "plane: expected fixed or prescribed, found free");
    require(normal.norm() > 0, "plane: expected a normal longer than 0, found 0");
    const EntityId host = add_boundary(scene, point, material, moved);
    bris::add_plane(scene, host, Vec3::Zero(), normal);
    return host;
}

void SceneBuilder::set_velocity(EntityId body, const Vec3& velocity) {
    value_of<Velocity>(world(), body) = velocity;
    value_of<DriveVelocity>(world(), body) = velocity;
}

World SceneBuilder::take() {
    World result = std::move(world());
    taken_ = true;
    return result;
}

World& SceneBuilder::world() {
    require(!taken_, "scene: expected one that no simulation has taken over");
    return world_;
}

} // namespace bris
