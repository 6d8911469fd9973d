#include "scenarios/field_tests/grains.hpp"

#include "components/kinds.hpp"
#include "components/sphere.hpp"
#include "engine/errors.hpp"
#include "engine/ordering.hpp"
#include "engine/random_vector.hpp"
#include "scenarios/field_tests/rock_bed.hpp"
#include "scenarios/specimens/growth.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/specimens/sphere_cells.hpp"
#include "systems/broadphase/lists.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr std::uint64_t stream = 8101;
constexpr int most_attempts = 100'000; // of one grain
constexpr double most_grains = 1e6;
// of growth
constexpr std::uint64_t growth_block = 10, most_steps = 200'000;

/// The spheres of all rocks, in the order of their ids.
SphereCells occupied(const World& world, double radius) {
    const auto balls = world.column<Spheres, LocalBall>();
    const auto parents = world.column<Spheres, ParentId>();
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    double largest = radius;
    for (const Ball& ball : balls) largest = std::max(largest, ball.radius);
    SphereCells cells(largest);
    for (const Row k : in_order_of_ids(world.column<Spheres, SphereId>())) {
        const Row b = rows[parents[k]];
        cells.add(world.column<Bodies, Position>()[b] +
                      world.column<Bodies, Orientation>()[b] * balls[k].centre,
                  balls[k].radius);
    }
    return cells;
}

} // namespace

std::size_t add_grains(World& world, const GrainsOfFines& grains, std::uint64_t seed) {
    const double r = 0.5 * grains.size, small = first_scale * r;
    const double wanted = std::round(grains.solid_volume / (4 * pi / 3 * r * r * r));
    require(wanted <= most_grains,
            fmt::format("--fines-size: expected a size that makes at most {:g} grains, found "
                        "{:g} m, which makes {:g}",
                        most_grains, grains.size, wanted));
    SphereCells cells = occupied(world, small);
    const Vec3 low = grains.low + Vec3::Constant(r), high = grains.high - Vec3::Constant(r);
    const auto count = static_cast<std::size_t>(wanted);
    for (std::size_t k = 0; k < count; ++k) {
        Random random(seed, stream + k);
        for (int attempt = 0;; ++attempt) {
            require(attempt < most_attempts,
                    fmt::format("--fines-size: expected grains for which the voids have room, "
                                "found {:g} m, of which {} of {} were placed",
                                grains.size, k, count));
            const Vec3 at = place_in_box(random, low, high);
            if (!cells.is_clear(at, small)) continue;
            cells.add(at, small);
            const EntityId id = add_sphere(world, at, r, grains.material);
            value_of<Growth>(world, id) = first_scale;
            world.column<Spheres, LocalBall>().back().radius = small;
            break;
        }
    }
    forget_lists(world);
    return count;
}

std::size_t grains_in(const World& world) {
    return world.table<Bodies>().size() - world.resource<RockBed>().first_grain;
}

namespace {

/// Returns true when all grains have their full size.
bool grow(World& world, double size) {
    const auto squeezed = largest_overlaps(world);
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    const auto growth = world.column<Bodies, Growth>();
    const auto run = world.column<Bodies, SpheresOf>();
    const auto ball = world.column<Spheres, LocalBall>();
    constexpr double factor = 1 + growth_per_step * static_cast<double>(growth_block);
    bool all = true;
    for (auto id = world.resource<RockBed>().first_grain; id < rows.size(); ++id) {
        const Row r = rows[id];
        if (growth[r] < 1 && squeezed[r] < squeezing_limit * 0.5 * size)
            growth[r] = std::min(1.0, factor * growth[r]);
        ball[run[r].first].radius = growth[r] * 0.5 * size;
        all = all && growth[r] == 1;
    }
    invalidate_lists(world);
    return all;
}

} // namespace

Phase grow_grains(double size, double safety) {
    return {.advance =
                [size, safety](Simulation& s) {
                    World& world = s.world();
                    if (grains_in(world) == 0) return false;
                    s.advance(growth_block);
                    auto& state = world.resource<RockBedState>();
                    state.steps += static_cast<double>(growth_block);
                    const bool grown = grow(world, size);
                    if (!grown && state.steps > static_cast<double>(most_steps))
                        throw SimulationError(
                            fmt::format("fines: the voids have no room for grains of {:g} m after "
                                        "{:.0f} steps of growth",
                                        size, state.steps));
                    rescale_masses(world, safety);
                    return !grown;
                },
            .progress =
                [](const World&) {
                    return PhaseProgress{"grow the grains", -1, ""};
                },
            .begin =
                [safety](Simulation& s) {
                    s.world().resource<RockBedState>().steps = 0;
                    rescale_masses(s.world(), safety);
                }};
}

} // namespace bris
