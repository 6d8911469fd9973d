#include "scenarios/verification/names.hpp"

#include "engine/choice.hpp"
#include "scenarios/specimens/bench.hpp"

namespace bris {

std::vector<std::string> law_choices() {
    auto names = law_names();
    std::erase_if(
        names, [](const std::string& name) { return !traits(law_named(name)).of_pairs.empty(); });
    return names;
}

LawName law_named(const std::string& word) { return named<LawName>(law_names(), word); }

std::string explain_step(LawName law, Grains grains) {
    World world = make_world(grains);
    Material m = linear_material(1e5, 1e5, 0.5);
    m.young_modulus = 1e9;
    const auto material = world.resource<Materials>().add(m);
    add_floor(world, material);
    for (const double x : {0.0, 0.02}) add_sphere(world, Vec3(x, 0, 0.01), 0.01, material);
    return begin(std::move(world), {.dt = 1e-5, .law = law, .unlimited = true})
        .schedule()
        .explain();
}

} // namespace bris
