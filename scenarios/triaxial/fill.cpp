#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/platen.hpp"
#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "engine/ordering.hpp"
#include "engine/random.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/triaxial/growth.hpp"
#include "scenarios/triaxial/specimen_state.hpp"
#include "scenarios/triaxial/triaxial.hpp"
#include "systems/broadphase/lists.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bris {

namespace {

// fraction of full size at which rocks are placed at random positions without touching
constexpr double first_scale = 0.45;
constexpr double growth_per_step = 2e-4; // relative, of rocks that have room
// overlap over bounding radius at which a rock stops growing until it has room
constexpr double squeezing_limit = 2e-3;
constexpr std::uint64_t growth_block = 20; // steps at one size
// steps after which the limit rises by its first value, for rocks that jam: compaction frees them
constexpr std::uint64_t patience = 20000;
constexpr std::uint64_t placing_stream = 2001;

std::span<const EntityId> rocks_of_lift(const Specimen& specimen, std::uint64_t lift,
                                        unsigned lifts) {
    const std::size_t n = specimen.rocks.size(), first = n * lift / lifts,
                      last = n * (lift + 1) / lifts;
    return std::span(specimen.rocks).subspan(first, last - first);
}

/// Places the rocks of a lift at random positions between two heights, with their bounding spheres,
/// at `scale`, clear of each other and of the held sensor rocks.
void place_lift(World& world, std::span<const EntityId> lift, double low, double high,
                double scale) {
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    const auto& specimen = world.resource<Specimen>();
    const double wall = membrane_radius(world);
    const auto position = world.column<Bodies, Position>();
    const auto motion = world.column<Bodies, MotionOf>();
    const auto radius = world.column<Bodies, BoundingRadius>();
    const auto run = world.column<Bodies, SpheresOf>();
    struct Filled {
        Vec3 position;
        double radius;
    };
    std::vector<Filled> filled;
    // held sensor rocks and earlier lifts are already there
    for (Row b = 0; b < motion.size(); ++b)
        if (run[b].count > 0 && position[b].z() > 0) filled.push_back({position[b], radius[b]});
    std::vector<EntityId> order(lift.begin(), lift.end());
    std::sort(order.begin(), order.end(), [&](EntityId a, EntityId b) {
        return radius[rows[a]] != radius[rows[b]] ? radius[rows[a]] > radius[rows[b]] : a < b;
    });
    for (const EntityId id : order) {
        const Row r = rows[id];
        Random random(specimen.seed, placing_stream + id);
        double size = scale * radius[r];
        for (int attempt = 1;; ++attempt) {
            if (attempt % 500 == 0) size *= 0.97; // little room: bounding spheres may overlap
            const double away = (wall - size) * std::sqrt(random.uniform()),
                         angle = 2 * pi * random.uniform();
            const Vec3 x(away * std::cos(angle), away * std::sin(angle),
                         random.uniform(low + size, high - size));
            if (std::any_of(filled.begin(), filled.end(), [&](const Filled& p) {
                    return (p.position - x).squaredNorm() < (size + p.radius) * (size + p.radius);
                }))
                continue;
            position[r] = x;
            filled.push_back({x, size});
            break;
        }
        motion[r] = static_cast<std::uint32_t>(Motion::free);
    }
}

} // namespace

// Rocks of a lift grow in place between the lifts below and the top platen, without friction, since
// pouring alone does not reach the porosity.
void TriaxialTest::start_lift() {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    const auto& specimen = world.resource<Specimen>();
    const double height = specimen.looseness * specimen.height;
    if (state.lift == 0) {
        set_friction(world, settings_.compaction_friction);
        world.resource<Gravity>().value.setZero();
        world.resource<LocalDamping>().fraction = settings_.damping;
        forget_lists(world); // bodies know the rows of their spheres from here on
    }
    const double lid = height * static_cast<double>(state.lift + 1) / settings_.lifts;
    const auto lift = rocks_of_lift(specimen, state.lift, settings_.lifts);
    place_lift(world, lift, height * static_cast<double>(state.lift) / settings_.lifts, lid,
               first_scale);
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    for (const EntityId id : lift) world.column<Bodies, Growth>()[rows[id]] = first_scale;
    resize_rocks(world, lift);
    world.column<Bodies, Position>()[row_of_body(world, specimen.top)] = Vec3(0, 0, lid);
    world.resource<Platen>().speed = 0;
    state.phase_steps = 0;
    rescale();
}

// Every block ends by scaling the masses for the next one, which then begins from State alone: a
// resumed run, which has no contacts before its first step, would scale them differently.
void TriaxialTest::fill() {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    if (state.lift == 0 && state.phase_steps == 0) start_lift();
    run(growth_block);
    const bool grown =
        grow_rocks(world, rocks_of_lift(world.resource<Specimen>(), state.lift, settings_.lifts),
                   largest_overlaps(world), 1 + growth_per_step * growth_block,
                   squeezing_limit * static_cast<double>(1 + state.phase_steps / patience));
    if (!grown && state.phase_steps > 10 * settings_.longest_stage)
        throw SimulationError(
            fmt::format("filling: lift {} of {} has no room for its rocks after {} steps; "
                        "try more rocks or a higher initial porosity",
                        state.lift + 1, settings_.lifts, state.phase_steps));
    if (grown) {
        run(200);
        state.phase_steps = 0;
        if (++state.lift < settings_.lifts) return start_lift();
        start_compaction();
    }
    rescale();
}

PhaseProgress TriaxialTest::filling_progress() const {
    const World& world = std::as_const(simulation_).world();
    const std::uint64_t lift = state().lift;
    const auto rocks = rocks_of_lift(world.resource<Specimen>(), lift, settings_.lifts);
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    double size = 0; // mean, relative to full size
    for (const EntityId id : rocks) size += world.column<Bodies, Growth>()[rows[id]];
    size /= static_cast<double>(rocks.size());
    const double grown = (size - first_scale) / (1 - first_scale);
    return {"filling", (static_cast<double>(lift) + grown) / settings_.lifts,
            fmt::format("lift {} of {}, rocks at {:.0f} % of their size", lift + 1, settings_.lifts,
                        std::floor(100 * size))};
}

} // namespace bris
