#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/platen.hpp"
#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "engine/ordering.hpp"
#include "engine/random.hpp"
#include "scenarios/specimens/growth.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/specimens/sphere_cells.hpp"
#include "scenarios/triaxial/specimen_state.hpp"
#include "scenarios/triaxial/triaxial.hpp"
#include "systems/broadphase/lists.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bris {

namespace {

constexpr std::uint64_t growth_block = 20; // steps at one size
// steps after which the limit rises by its first value, for rocks that jam: compaction frees them
constexpr std::uint64_t patience = 20000;
constexpr std::uint64_t placing_stream = 2001;

/// Places the rocks at random positions below the height `lid` (m), with their bounding spheres, at
/// `scale`, clear of each other and of the held sensor rocks.
void place_rocks(World& world, double lid, double scale) {
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    const auto& specimen = world.resource<Specimen>();
    const double wall = membrane_radius(world);
    const auto position = world.column<Bodies, Position>();
    const auto motion = world.column<Bodies, MotionOf>();
    const auto radius = world.column<Bodies, BoundingRadius>();
    std::vector<EntityId> order = specimen.rocks; // largest first
    std::sort(order.begin(), order.end(), [&](EntityId a, EntityId b) {
        return radius[rows[a]] != radius[rows[b]] ? radius[rows[a]] > radius[rows[b]] : a < b;
    });
    double largest = order.empty() ? 0 : scale * radius[rows[order.front()]];
    for (const EntityId id : specimen.smart_rocks) largest = std::max(largest, radius[rows[id]]);
    SphereCells filled(largest);
    for (const EntityId id : specimen.smart_rocks) filled.add(position[rows[id]], radius[rows[id]]);
    for (const EntityId id : order) {
        const Row r = rows[id];
        Random random(specimen.seed, placing_stream + id);
        double size = scale * radius[r];
        for (int attempt = 1;; ++attempt) {
            if (attempt % 500 == 0) size *= 0.97; // little room: bounding spheres may overlap
            const double away = (wall - size) * std::sqrt(random.uniform()),
                         angle = 2 * pi * random.uniform();
            const Vec3 x(away * std::cos(angle), away * std::sin(angle),
                         random.uniform(size, lid - size));
            if (!filled.is_clear(x, size)) continue;
            position[r] = x;
            filled.add(x, size);
            break;
        }
        motion[r] = static_cast<std::uint32_t>(Motion::free);
    }
}

} // namespace

void TriaxialTest::start_filling() {
    World& world = simulation_.world();
    const auto& specimen = world.resource<Specimen>();
    require(!world.has<Nodes>(), "specimen: expected the rings of a mould, found a sleeve");
    set_friction(world, 0);
    world.resource<Gravity>().value.setZero();
    world.resource<LocalDamping>().fraction = settings_.damping;
    forget_lists(world); // bodies know the rows of their spheres from here on
    const double lid = specimen.looseness * specimen.height;
    const auto position = world.column<Bodies, Position>();
    for (std::size_t k = 0; k < specimen.smart_rocks.size(); ++k) {
        const Row r = row_of_body(world, specimen.smart_rocks[k]);
        position[r] =
            specimen.smart_rock_poses[k].position.cwiseProduct(Vec3(1, 1, specimen.looseness));
        world.column<Bodies, DriveVelocity>()[r].setZero(); // led by the platen until now
    }
    place_rocks(world, lid, first_scale);
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    for (const EntityId id : specimen.rocks) world.column<Bodies, Growth>()[rows[id]] = first_scale;
    resize_rocks(world, specimen.rocks);
    stop_rocks(world); // which move if the specimen is poured anew
    position[row_of_body(world, specimen.top)] = Vec3(0, 0, lid);
    world.resource<Platen>().controlled = false;
    world.resource<Platen>().speed = 0;
    rescale();
}

// Rocks grow in place around the held sensor rocks, without friction, in a mould so tall that they
// carry no load at full size. Every block ends by scaling the masses for the next one, which then
// begins from State alone: a resumed run, which has no contacts before its first step, would scale
// them differently.
void TriaxialTest::fill() {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    if (state.phase_steps == 0) start_filling();
    run(growth_block);
    const bool grown =
        grow_rocks(world, world.resource<Specimen>().rocks, largest_overlaps(world),
                   1 + growth_per_step * growth_block,
                   squeezing_limit * static_cast<double>(1 + state.phase_steps / patience));
    if (!grown && state.phase_steps > 10 * settings_.longest_stage)
        throw SimulationError(fmt::format("filling: the mould has no room for its rocks after {} "
                                          "steps; try more rocks (--bodies)",
                                          state.phase_steps));
    if (grown) return start_compression();
    rescale();
}

PhaseProgress TriaxialTest::filling_progress() const {
    const World& world = std::as_const(simulation_).world();
    const auto& rocks = world.resource<Specimen>().rocks;
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    double size = 0; // mean, relative to full size
    for (const EntityId id : rocks) size += world.column<Bodies, Growth>()[rows[id]];
    size /= static_cast<double>(rocks.size());
    return {"filling", (size - first_scale) / (1 - first_scale),
            fmt::format("rocks at {:.0f} % of their size", std::floor(100 * size))};
}

} // namespace bris
