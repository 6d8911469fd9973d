// S9: initial states with deep overlaps are refused, or relaxed without an explosion.
#include "scenarios/specimens/check_scene.hpp"
#include "scenarios/specimens/relax.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/broadphase/lists.hpp"
#include "tests/stability/cases.hpp"

#include <fmt/format.h>

#include <cstring>

namespace bris {

namespace {

constexpr double radius = 0.01;

/// Spheres in a row, each overlapping the next one by a fraction of the diameter.
World row_of_spheres(unsigned count, double overlap) {
    World world = make_world(Grains::spheres);
    const auto grain = world.resource<Materials>().add(linear_material(1e5, 3e4, 0.5));
    for (unsigned k = 0; k < count; ++k)
        add_sphere(world, Vec3(2 * radius * (1 - overlap) * k, 0, 0), radius, grain);
    return world;
}

World spheres_in_a_floor() {
    World world = row_of_spheres(3, 0.3);
    add_floor(world, 0); // the centres lie in the plane of the floor
    return world;
}

/// Two clumps. The second one is `ratio` times as large and shifted by `shift` bounding radii.
World clump_in_clump(double ratio, double shift) {
    World world = make_world(Grains::clumps);
    const auto grain = world.resource<Materials>().add(linear_material(1e5, 3e4, 0.5));
    const Clump rock = scaled(small_rock(), 0.03);
    add_clump(world, rock, 0, Vec3::Zero(), Quat::Identity(), grain);
    add_clump(world, scaled(rock, ratio), 0, Vec3(shift * rock.bounding_radius, 0, 0),
              Quat::Identity(), grain);
    return world;
}

std::vector<Vec3> positions(const World& world) {
    const auto column = world.column<Bodies, Position>();
    return {column.begin(), column.end()};
}

bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

bool all_finite(const std::vector<Vec3>& list) {
    return std::ranges::all_of(list, [](const Vec3& x) { return x.allFinite(); });
}

void add_rows(StressRows& rows, const std::string& what, const World& scene) {
    World refused(scene);
    add_lists(refused, LawName::linear);
    const std::string message = refusal_of([&] { check_overlaps(refused); });
    rows.push_back({"S9", what + ": start without relaxation", "refused before the first step",
                    message.empty() ? "accepted" : message, !message.empty()});

    World relaxed(scene), again(scene);
    const Relaxed r = relax(relaxed, LawName::linear);
    relax(again, LawName::linear, {.threads = 3});
    rows.push_back({"S9", what + ": relaxed",
                    fmt::format("overlap <= 1 % of a diameter, speed <= {:.2g} m/s", r.speed_limit),
                    r.done ? fmt::format("{:.2f} %, {:.2g} m/s after {} steps", 100 * r.overlap,
                                         r.speed, r.steps)
                           : r.left,
                    r.done && r.overlap <= 0.01 && r.speed <= r.speed_limit &&
                        all_finite(positions(relaxed))});
    rows.push_back({"S9", what + ": energy during relaxation",
                    "kinetic energy <= initial elastic energy",
                    fmt::format("{:.3g} of {:.3g} J", r.peak_energy, r.stored_energy),
                    r.peak_energy <= r.stored_energy && r.stored_energy > 0});
    const bool same = same_bits(positions(relaxed), positions(again));
    rows.push_back({"S9", what + ": relaxed again on 3 threads", "same bits",
                    same ? "same" : "other positions", same});

    add_lists(relaxed, LawName::linear);
    const std::string still = refusal_of([&] { check_overlaps(relaxed); });
    rows.push_back({"S9", what + ": start after relaxation", "accepted",
                    still.empty() ? "accepted" : still, still.empty()});
}

} // namespace

StressRows stress_deep_overlap(const StressSettings& s) {
    StressRows rows;
    add_rows(rows, "two spheres, 50 % overlap", row_of_spheres(2, 0.5));
    add_rows(rows, "two spheres, 99 % overlap", row_of_spheres(2, 0.99));
    add_rows(rows, "two spheres, same centre", row_of_spheres(2, 1));
    add_rows(rows, fmt::format("{} spheres, same centre", s.full ? 200 : 20),
             row_of_spheres(s.full ? 200 : 20, 1));
    add_rows(rows, "three spheres, centres in a floor", spheres_in_a_floor());
    add_rows(rows, "two identical clumps, same position", clump_in_clump(1, 0));
    add_rows(rows, "a clump inside a larger one", clump_in_clump(0.4, 0.05));
    add_rows(rows, "two clumps, half inside each other", clump_in_clump(1, 0.8));
    return rows;
}

} // namespace bris
