#include "scenarios/specimens/rock_material.hpp"

#include "engine/assets.hpp"

namespace bris {

Material RockMaterial::material(const std::string& name) const {
    Material m;
    m.name = name;
    m.density = density;
    m.normal_stiffness = normal_stiffness;
    m.shear_stiffness = shear_stiffness;
    m.friction = friction;
    m.restitution = restitution;
    return m;
}

RockMaterial read_rock_material(const std::string& name) {
    const auto path = asset_or_file("--material", "materials", name, ".txt");
    RockMaterial rock;
    std::filesystem::path config;
    Options options;
    rock.declare_options(options);
    options("config", config, "", "The file of the material.");
    (void)options.parse({"--config", path.string()});
    return rock;
}

} // namespace bris
