// S1: results have the same bits with any number of threads, any skin and any order of the rows.
#include "engine/ordering.hpp"
#include "engine/random.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/output/quantities.hpp"
#include "tests/stability/cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <thread>

namespace bris {

namespace {

/// Shuffles the rows of the bodies, and those of their spheres in the same way.
void shuffle_rows(World& world, std::uint64_t seed) {
    Table &bodies = world.table<Bodies>(), &spheres = world.table<Spheres>();
    std::vector<Row> order = all_rows(bodies.size());
    Random random(seed, 11);
    for (std::size_t k = order.size(); k > 1; --k)
        std::swap(order[k - 1], order[random.bits() % k]);
    std::vector<Row> sphere_order;
    for (const Row b : order) // before the first step rows are ids
        for (Row s = 0; s < spheres.size(); ++s)
            if (spheres.column<ParentId>()[s] == b) sphere_order.push_back(s);
    bodies.keep(order);
    spheres.keep(sphere_order);
}

struct Variant {
    std::string name;
    SmallSceneSettings setup;
    bool shuffled = false;
};

std::vector<Variant> variants(double diameter, unsigned threads) {
    const SmallSceneSettings plain{
        .dt = 2e-5, .law = LawName::linear_viscous, .schedule = {.grain = 16}};
    std::vector<Variant> list{{"1 thread, automatic skins", plain}, {"1 thread, repeated", plain}};
    for (const unsigned n :
         {2u, 3u, 7u, std::max({threads, std::thread::hardware_concurrency(), 4u})}) {
        list.push_back({fmt::format("{} threads", n), plain});
        list.back().setup.threads = n;
    }
    for (const double percent : {0.3, 1.0, 5.0}) {
        list.push_back({fmt::format("skin {} % of the diameter", percent), plain});
        list.back().setup.lists = {.outer_skin = 2 * percent / 100 * diameter,
                                   .inner_skin = percent / 100 * diameter,
                                   .tune = false};
    }
    list.push_back({"rows shuffled and never sorted", plain, true});
    list.back().setup.lists.sort_every = 0;
    list.push_back({"rows shuffled, sorted at every rebuild", plain, true});
    list.back().setup.lists.sort_every = 1;
    list.push_back({"systems in another valid order", plain});
    list.back().setup.schedule.last_order = true;
    list.push_back({"systems in sequence", plain});
    list.back().setup.schedule = {.fused = false, .grain = 16};
    return list;
}

/// Hashes of the whole state in the course of a run.
std::vector<std::uint64_t> hashes(const Tumble& scene, const Variant& v, unsigned marks,
                                  unsigned each) {
    World world = tumbling(scene);
    if (v.shuffled) shuffle_rows(world, scene.seed);
    Simulation simulation = begin(std::move(world), v.setup);
    std::vector<std::uint64_t> list;
    for (unsigned k = 0; k < marks; ++k) {
        simulation.advance(each);
        list.push_back(fingerprint(simulation.snapshot()));
    }
    return list;
}

} // namespace

StressRows stress_determinism(const StressSettings& s) {
    StressRows rows;
    const unsigned marks = s.full ? 20 : 4, each = s.full ? 1000 : 250;
    for (const Grains grains : {Grains::spheres, Grains::clumps}) {
        const Tumble scene{
            .grains = grains, .bodies = grains == Grains::spheres ? 120u : 40u, .seed = s.seed};
        const double diameter = 2 * mean_radius(tumbling(scene));
        std::vector<std::uint64_t> reference;
        for (const Variant& v : variants(diameter, s.threads)) {
            const auto found = hashes(scene, v, marks, each);
            if (reference.empty()) reference = found;
            const auto [mine, other] = std::ranges::mismatch(found, reference);
            const bool same = mine == found.end();
            rows.push_back(
                {"S1",
                 fmt::format("{}: {}", grains == Grains::spheres ? "spheres" : "clumps", v.name),
                 fmt::format("same hash at {} instants, {} steps apart", marks, each),
                 same ? fmt::format("{:016x} at the end", found.back())
                      : fmt::format("differs at step {}", (mine - found.begin() + 1) * each),
                 same});
        }
    }
    return rows;
}

} // namespace bris
