#include "scenarios/specimens/rock_material.hpp"

#include "engine/assets.hpp"
#include "engine/errors.hpp"

#include <fmt/format.h>

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
    const std::filesystem::path known = assets_folder() / "materials" / (name + ".txt");
    const std::filesystem::path path =
        std::filesystem::exists(known) ? known : std::filesystem::path(name);
    require(std::filesystem::is_regular_file(path),
            fmt::format("--material: expected granite, limestone or the path of a material file, "
                        "found '{}'",
                        name));
    RockMaterial rock;
    std::filesystem::path config;
    Options options;
    rock.describe(options);
    options("config", config, "", "The file of the material.");
    (void)options.parse({"--config", path.string()});
    return rock;
}

} // namespace bris
