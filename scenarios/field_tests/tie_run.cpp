// The bed of a tie from its making to the end of the push.
#include "components/body_contacts.hpp"
#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "engine/clock.hpp"
#include "engine/errors.hpp"
#include "engine/ordering.hpp"
#include "scenarios/field_tests/tie_bed.hpp"
#include "scenarios/specimens/check_scene.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/contact/mass_scaling.hpp"
#include "systems/loads/spring_patch.hpp"
#include "systems/output/balance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace bris {

namespace {

constexpr std::uint64_t block = 100, longest_rest = 200'000, least_rest = 2000;
constexpr std::uint64_t push_steps = 10; // between displacements of the spring that pushes
constexpr double whole = 2;              // ties in the model: a half
constexpr double lifted = 1;             // m, of the plate

/// Forces of the rocks on the sides of the tie, as block_facets orders them: -x, x, -y, y, -z, z.
using SideForces = std::array<Vec3, 6>;

SideForces side_forces(const World& world) {
    SideForces sides;
    sides.fill(Vec3::Zero());
    const EntityId tie = world.resource<RockBed>().tie;
    const auto host = world.column<Facets, HostId>();
    const auto id = world.column<Facets, FacetId>();
    EntityId first = nobody; // facet of the tie
    for (std::size_t k = 0; k < id.size(); ++k)
        if (host[k] == tie) first = std::min(first, id[k]);
    const BodyContacts<FacetPairs> contacts(world);
    const auto near = world.column<NearFacets, NearPair>();
    const auto force = world.column<NearFacets, PairForce>();
    const auto names = world.column<FacetPairs, PairKey>();
    contacts.visit(row_of_body(world, tie), [&](Row k, bool as_partner) {
        if (!as_partner) return;
        const auto& f = force[k];
        sides[names[near[k].pair].feature - first] -= Vec3(f.fx, f.fy, f.fz);
    });
    return sides;
}

SpringPatch& pushing_spring(World& world) {
    const EntityId tie = world.resource<RockBed>().tie;
    return world.resource<SpringPatches>().of_body[value_of<PatchesOf>(world, tie) - 1].front();
}

const Vec3& tie_position(const World& world) {
    return world.column<Bodies, Position>()[row_of_body(world, world.resource<RockBed>().tie)];
}

/// Fixes a body far below the bed.
void take_out(World& world, EntityId body, double x, double y) {
    value_of<Position>(world, body) = Vec3(x, y, -lifted);
    value_of<Velocity>(world, body).setZero();
    value_of<Acceleration>(world, body).setZero();
    set_angular_velocity(world, body, Vec3::Zero());
    value_of<MotionOf>(world, body) = static_cast<std::uint32_t>(Motion::fixed);
}

/// Height (m) of the profile of the bed at y, above which there are no rocks' centres.
double profile(const TieBed& bed, const TieTest& test, const Vec3& tie, double y) {
    const double end = tie.y() + 0.5 * bed.tie_length, bottom = tie.z() - 0.5 * bed.tie_height,
                 top = tie.z() + 0.5 * bed.tie_height;
    if (!test.with_shoulder) return y > end ? bottom : top;
    return std::min(top, top - (y - end - bed.shoulder) / bed.slope);
}

void shape_bed(World& world, const TieBed& bed, const TieTest& test) {
    const auto& rocks = world.resource<RockBed>();
    world.resource<TieState>() = {};
    world.resource<Limits>().overlap = Limits{}.overlap;
    value_of<MotionOf>(world, rocks.plate) = static_cast<std::uint32_t>(Motion::fixed);
    value_of<Position>(world, rocks.plate).z() += lifted;
    value_of<Velocity>(world, rocks.plate).setZero();
    press_tie(world, 0);
    const Vec3 tie = tie_position(world);
    double taken = 0;
    for (const EntityId id : rocks.rocks) {
        const Vec3 x = value_of<Position>(world, id);
        if (x.z() <= profile(bed, test, tie, x.y())) continue;
        take_out(world, id, 0.2 * std::fmod(taken, 8), 0.2 * std::floor(taken / 8));
        ++taken;
    }
    invalidate_lists(world);
    rescale_masses(world, bed.safety);
}

Phase come_to_rest(const TieBed& bed, const TieTest& test) {
    return {.advance =
                [&bed](Simulation& s) {
                    World& world = s.world();
                    auto& state = world.resource<TieState>();
                    s.advance(block);
                    state.steps += static_cast<double>(block);
                    (void)scale_masses(world, world.resource<Clock>().dt, bed.safety, true);
                    const double ratio = compute_balance(world).unbalanced_ratio;
                    if (state.steps >= least_rest && ratio < bed.tolerance) return false;
                    if (state.steps > longest_rest)
                        throw SimulationError(fmt::format(
                            "rest before the push: expected an unbalanced force ratio below {:g} "
                            "(--tolerance), found {:.1e} after {:.0f} steps",
                            bed.tolerance, ratio, state.steps));
                    return true;
                },
            .progress =
                [](const World& world) {
                    return PhaseProgress{"rest", -1,
                                         fmt::format("unbalanced force ratio {:.1e}",
                                                     compute_balance(world).unbalanced_ratio)};
                },
            .begin = [&bed, test](Simulation& s) { shape_bed(s.world(), bed, test); }};
}

void add_sample(const World& world, SeriesOf<PushSample>& curve) {
    const auto& state = world.resource<TieState>();
    const SideForces on = side_forces(world);
    Vec3 sum = Vec3::Zero();
    for (const Vec3& f : on) sum += f;
    const Vec3& tie = tie_position(world);
    curve.add({.displacement = tie.y() - state.start_y,
               .force = -whole * sum.y(),
               .base_force = -whole * on[4].y(),
               .crib_force = -whole * (on[0].y() + on[1].y()),
               .end_force = -whole * on[3].y(),
               .other_force = -whole * (on[2].y() + on[5].y()),
               .support = whole * sum.z(),
               .lift = tie.z() - state.z,
               .unbalanced_ratio = compute_balance(world).unbalanced_ratio});
}

Phase push(const TieBed& bed, SeriesOf<PushSample>& curve,
           const std::function<void(const World&)>& frame) {
    const auto samples = static_cast<std::uint64_t>(std::llround(bed.displacement / bed.interval));
    return {.advance =
                [&bed, &curve, frame, samples](Simulation& s) {
                    World& world = s.world();
                    auto& state = world.resource<TieState>();
                    const auto of_next = static_cast<double>(curve.rows()) * bed.interval;
                    const double step =
                        bed.speed * world.resource<Clock>().dt * static_cast<double>(push_steps);
                    while (tie_position(world).y() - state.start_y < of_next) {
                        if (state.pushed > 2 * bed.displacement)
                            throw SimulationError("push: the tie does not follow the spring that "
                                                  "pushes it");
                        pushing_spring(world).anchor.y() += step;
                        state.pushed += step;
                        s.advance(push_steps);
                    }
                    check_stable_step(world);
                    (void)scale_masses(world, world.resource<Clock>().dt, bed.safety, true);
                    add_sample(world, curve);
                    const std::uint64_t done = curve.rows() - 1;
                    if (done * 10 / samples != (done - 1) * 10 / samples) frame(world);
                    return done < samples;
                },
            .progress =
                [&curve, samples](const World&) {
                    return PhaseProgress{"push",
                                         static_cast<double>(curve.rows()) /
                                             static_cast<double>(samples + 1),
                                         fmt::format("{:.1f} mm, {:.1f} kN",
                                                     1e3 * curve[&PushSample::displacement].back(),
                                                     1e-3 * curve[&PushSample::force].back()),
                                         static_cast<double>(curve.rows())};
                },
            .begin =
                [&curve, frame](Simulation& s) {
                    World& world = s.world();
                    auto& state = world.resource<TieState>();
                    state.start_y = tie_position(world).y();
                    state.z = tie_position(world).z();
                    add_sample(world, curve);
                    frame(world);
                }};
}

} // namespace

std::vector<Phase> push_phases(const TieBed& bed, const TieTest& test, SeriesOf<PushSample>& curve,
                               const std::function<void(const World&)>& frame) {
    return {come_to_rest(bed, test), push(bed, curve, frame)};
}

} // namespace bris
