// Phases of a box from the finished bed to rest under the least loads.
#include "components/fouling.hpp"
#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "scenarios/ballast_box/box_balance.hpp"
#include "scenarios/ballast_box/box_run.hpp"
#include "scenarios/specimens/check_scene.hpp"
#include "scenarios/specimens/facet_bodies.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/output/quantities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr double support_error = 0.01; // of the loads, at rest
constexpr double checks_in_a_row = 3;
constexpr std::uint64_t longest_rest = 200'000; // steps
/// m, height of the space of the fields above the subgrade.
constexpr double fields_height = 0.8;

} // namespace

bool BoxTestRun::is_at_rest(World& world, const char* phase, std::uint64_t waited) const {
    auto& state = world.resource<BoxState>();
    const BoxBalance b = box_balance(world);
    const bool rests =
        b.carries && b.unbalanced_ratio <= box_.rest && std::abs(b.support() - 1) <= support_error;
    state.calm = rests ? state.calm + 1 : 0;
    state.seat_ratio = b.unbalanced_ratio;
    state.seat_support = b.support();
    if (state.calm >= checks_in_a_row) return true;
    if (waited <= longest_rest) return false;
    const auto& clock = world.resource<Clock>();
    const std::string path = b.carries ? "" : ", too few contacts to carry load";
    throw SimulationError(fmt::format(
        "step {}, time {:.6g} s: {}: expected rest, with an unbalanced force ratio of at most {:g} "
        "(--rest) and {:g} to {:g} % of the loads on the ties carried by ballast, found {:.2e} and "
        "{:.2f} % after {} steps{}",
        clock.step, clock.time(), phase, box_.rest, 100 * (1 - support_error),
        100 * (1 + support_error), b.unbalanced_ratio, 100 * b.support(), waited, path));
}

Phase BoxTestRun::until_rest(const char* name, std::uint64_t steps,
                             std::function<void(Simulation&)> begin,
                             void (*end_of_action)(World&)) const {
    return {.advance =
                [this, name, steps, end_of_action](Simulation& s) {
                    World& world = s.world();
                    auto& state = world.resource<BoxState>();
                    s.advance(block);
                    if (box_.is_dynamic()) {
                        adapt_step(world, hard_step_);
                    } else {
                        raise_masses(world);
                        check_stable_step(world);
                    }
                    const auto done = static_cast<std::uint64_t>(++state.stage) * block;
                    if (done < steps) return true;
                    if (done < steps + block && end_of_action != nullptr) end_of_action(world);
                    return !is_at_rest(world, name, done - steps);
                },
            .progress =
                [name, steps](const World& world) {
                    const auto& state = world.resource<BoxState>();
                    const double done =
                        state.stage * static_cast<double>(block) / static_cast<double>(steps);
                    return PhaseProgress{
                        name, done < 1 ? done : -1,
                        done < 1 ? std::string()
                                 : fmt::format("unbalanced {:.1e}, carried {:.1f} %",
                                               state.seat_ratio, 100 * state.seat_support)};
                },
            .begin =
                [begin = std::move(begin)](Simulation& s) {
                    note_beginning(s.world());
                    s.world().resource<BoxState>().stage = 0;
                    s.world().resource<BoxState>().calm = 0;
                    begin(s);
                }};
}

void BoxTestRun::scale_tie(World& world, EntityId tie) const {
    constexpr double contacts = 50; // more than a tie has at first; then the masses are raised
    const double factor = std::pow(world.resource<Clock>().dt / scaling_safety, 2);
    double stiffness = 0, turning = 0;
    for (const SpringPatch& p :
         world.resource<SpringPatches>().of_body[value_of<PatchesOf>(world, tie) - 1]) {
        stiffness += p.stiffness;
        turning += p.stiffness * p.point.cross(p.axis).squaredNorm();
    }
    const double kn = contacts * world.resource<BoxBodies>().hard[0].normal_stiffness;
    const double mass = std::max(value_of<Mass>(world, tie), factor * (stiffness + kn));
    const Vec3& inertia = value_of<Inertia>(world, tie);
    const double ratio =
        std::max(mass / value_of<Mass>(world, tie),
                 factor * (turning + kn * sizes_.tie.squaredNorm() / 4) / inertia.minCoeff());
    value_of<InertialMass>(world, tie) = mass;
    value_of<InertialInertia>(world, tie) = ratio * inertia;
}

// Fines and water lie in the voids of the present rocks: of each lift before its compaction, as far
// as the bed was mixed, and in any case of the finished bed, whose masses are the true ones.
void BoxTestRun::foul(Simulation& simulation) const {
    World& world = simulation.world();
    const FoulingOptions fouling = fouling_of(box_);
    if (!world.has_resource<Fouling>()) add_fields(simulation, box_);
    auto& fields = world.resource<Fouling>();
    fields.settings.refresh = fouling.settings.refresh;
    world.resource<FoulingLaw>() = fouling.law;
    const Vec3& bladder = value_of<Position>(world, world.resource<BoxBodies>().bladder);
    const double half = 0.5 * (sizes_.bladder_top - sizes_.bladder_low);
    if (box_test(box_.run).confined)
        fields.blocked = {{Vec3(-1, bladder.y() - sizes_.bladder_depth / 2, bladder.z() - half),
                           Vec3(sizes_.width + 1, sizes_.across, bladder.z() + half)}};
    fill_with_fines(world, fouling, seed_);
}

double friction_of_stones(const World& world) {
    return world.resource<BoxState>().wet > 0 ? world.resource<BoxBodies>().wet_friction : 1;
}

// While rocks are poured and pressed together, fines need not follow each of their moves. They act
// on friction alone: stiffness is not that of rocks then, and softer lifts do not become dense.
void BoxTestRun::mix_fines(Simulation& simulation) const {
    constexpr double never = 1e6; // voxels
    foul(simulation);
    World& world = simulation.world();
    world.resource<Fouling>().settings.refresh = never;
    auto& law = world.resource<FoulingLaw>();
    law.stiffness_loss = law.dry_cushion = law.wet_cushion = 0;
}

// the dashpots stay as they are
void BoxTestRun::wet_stones(World& world) {
    world.resource<BoxState>().wet = 1;
    auto& materials = world.resource<Materials>();
    const auto& hard = world.resource<BoxBodies>().hard;
    for (std::size_t k = 0; k < hard.size(); ++k)
        materials.list[k].friction = hard[k].friction * friction_of_stones(world);
    materials.mix();
}

void add_fields(Simulation& simulation, const BallastBox& box) {
    const BoxSizes s = box_sizes(box);
    add_fouling(simulation.world(), fouling_of(box));
    simulation.world().resource<Fouling>().box = {Vec3::Zero(),
                                                  Vec3(s.width, s.across, fields_height)};
    simulation.prepare();
}

// the ties are laid on the ballast and loaded as at the beginning of the cycles
void BoxTestRun::place_ties(Simulation& s) const {
    World& world = s.world();
    // to a track in use water comes later
    if (is_wet() && (!box_.is_bay() || is_made_fouled())) wet_stones(world);
    const auto& ties = world.resource<BoxBodies>().ties;
    for (std::size_t k = 0; k < ties.size(); ++k) {
        const Vec3 half = 0.5 * sizes_.tie;
        const double x = sizes_.ties[k];
        const double surface =
            surface_height(world, Vec3(x - half.x(), sizes_.tie_centre() - half.y(), 0),
                           Vec3(x + half.x(), sizes_.tie_end(), 0), 0);
        const double level = box_.tie_level > 0 ? box_.tie_level : surface + 1e-5;
        check_tie(world, sizes_, x, level, surface);
        Vec3 at = value_of<Position>(world, ties[k]);
        at.z() = level + half.z();
        release(world, ties[k], at);
        if (!box_.is_dynamic()) scale_tie(world, ties[k]);
    }
    const double start = world.resource<Clock>().time(),
                 duration = static_cast<double>(ramp_steps()) * world.resource<Clock>().dt;
    for (std::size_t k = 0; k < ties.size(); ++k) {
        const auto [mean, amplitude] = tie_load(k);
        set_load(world, ties[k],
                 {.times = {start, start + duration}, .values = {0, mean + amplitude}});
    }
}

std::uint64_t BoxTestRun::ramp_steps() const { return box_.is_dynamic() ? 10'000 : 3000; }

Phase BoxTestRun::foul_bed() const {
    return {.advance = [](Simulation&) { return false; },
            .progress =
                [](const World&) {
                    return PhaseProgress{"foul the bed", 1, ""};
                },
            .begin = [this](Simulation& s) { foul(s); }};
}

Phase BoxTestRun::foul_track() const {
    constexpr std::uint64_t least = 1000; // steps, within which weaker contacts begin to slide
    return until_rest(
        "foul the track", least,
        [this](Simulation& s) {
            if (is_fouled()) foul(s);
            if (is_wet()) wet_stones(s.world());
        },
        nullptr);
}

Phase BoxTestRun::seat() const {
    return until_rest(
        "seat the ties", ramp_steps(), [this](Simulation& s) { place_ties(s); }, nullptr);
}

// the bladder is drawn back to the wall and no longer supports the ballast
Phase BoxTestRun::remove_shoulder() const {
    constexpr std::uint64_t drawing_steps = 8000;
    return until_rest(
        "remove the shoulder", drawing_steps,
        [this](Simulation& s) {
            World& world = s.world();
            const EntityId bladder = world.resource<BoxBodies>().bladder;
            value_of<MotionOf>(world, bladder) = static_cast<std::uint32_t>(Motion::prescribed);
            value_of<DriveVelocity>(world, bladder) =
                Vec3(0, sizes_.bladder_depth / (drawing_steps * world.resource<Clock>().dt), 0);
            invalidate_lists(world);
        },
        [](World& world) {
            value_of<DriveVelocity>(world, world.resource<BoxBodies>().bladder).setZero();
            invalidate_lists(world);
        });
}

} // namespace bris
