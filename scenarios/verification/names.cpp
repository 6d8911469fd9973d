#include "scenarios/verification/names.hpp"

#include "engine/errors.hpp"
#include "scenarios/specimens/bench.hpp"

#include <algorithm>

namespace bris {

template <class Enumeration>
Enumeration named(const std::vector<std::string>& names, const std::string& word) {
    const auto found = std::find(names.begin(), names.end(), word);
    require(found != names.end(), "expected a known name, found \"" + word + "\"");
    return static_cast<Enumeration>(found - names.begin());
}
template Tension named(const std::vector<std::string>&, const std::string&);
template ShearHistory named(const std::vector<std::string>&, const std::string&);
template Target named(const std::vector<std::string>&, const std::string&);
template Lattice named(const std::vector<std::string>&, const std::string&);

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
