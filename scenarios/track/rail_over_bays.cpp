#include "scenarios/track/rail_over_bays.hpp"

#include "components/settings.hpp"
#include "engine/clock.hpp"
#include "engine/ordering.hpp"
#include "scenarios/ballast_box/box_run.hpp"
#include "scenarios/specimens/facet_bodies.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/loads/load.hpp"
#include "systems/loads/rail.hpp"
#include "systems/loads/spring_patch.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <vector>

namespace bris {

namespace {

constexpr double share = 0.5;         // of a track that a bay with half a tie models
constexpr double retardation = 4e-4;  // s, of pads: 50 kN s/m with 120 MN/m
constexpr double damping_ratio = 0.2; // of the springs, as that of the subgrade

Vec3 rail_seat(const World& world, EntityId tie) {
    const auto number = world.column<Bodies, LoadOf>()[row_of_body(world, tie)];
    return world.resource<Loads>().of_body[number - 1].front().point;
}

/// A copy of the tie of the bay, at another place along the track, with a spring below it.
void add_tie_on_spring(World& world, EntityId tie, double x, double stiffness) {
    const Row row = row_of_body(world, tie);
    const Vec3 at = world.column<Bodies, Position>()[row], shift(x - at.x(), 0, 0);
    const double mass = world.column<Bodies, Mass>()[row];
    const std::vector<SpringPatch> guides =
        world.resource<SpringPatches>().of_body[world.column<Bodies, PatchesOf>()[row] - 1];
    const EntityId added =
        add_block(world, at + shift, Quat(Quat::Identity()), Vec3(tie_width, 1, tie_height), mass,
                  world.column<Bodies, MaterialOf>()[row]);
    for (SpringPatch guide : guides) {
        guide.anchor += shift;
        add_patch(world, added, guide);
    }
    const Vec3 seat = rail_seat(world, tie);
    const double dead = share * dead_load,
                 weight = -mass * world.resource<Gravity>().value.z() + dead;
    add_load(world, added, {.force = Vec3(0, 0, -1), .point = seat, .history = {.mean = dead}});
    const Vec3 below(seat.x(), seat.y(), -tie_height / 2);
    add_patch(world, added,
              {.point = below,
               .anchor = at + shift + below + Vec3(0, 0, weight / stiffness),
               .stiffness = stiffness,
               .damping = 2 * damping_ratio * std::sqrt(stiffness * mass),
               .one_sided = true});
}

/// N/m, of the one below a tie.
double spring_stiffness(const World& world, Row tie) {
    const std::uint32_t number = world.column<Bodies, PatchesOf>()[tie];
    return world.resource<SpringPatches>().of_body[number - 1].back().stiffness;
}

/// N, of a tie with what of rails and fastenings it carries.
double weight_on(const World& world, Row tie) {
    const auto& loads = world.resource<Loads>().of_body[world.column<Bodies, LoadOf>()[tie] - 1];
    return -world.column<Bodies, Mass>()[tie] * world.resource<Gravity>().value.z() +
           loads.front().history.at(world.resource<Clock>().time());
}

} // namespace

EntityId add_ties_on_springs(World& world, const RailOnTies& rails, unsigned bays) {
    const auto first = static_cast<EntityId>(world.table<Bodies>().size());
    const EntityId tie = world.resource<BoxBodies>().ties.front();
    const double bed = 1 / (1 / rails.tie_support - 1 / rails.pad);
    const auto beyond = static_cast<int>(rails.ties_on_each_side()), n = static_cast<int>(bays);
    for (int k = -beyond; k < n + beyond; ++k)
        if (k < 0 || k >= n) add_tie_on_spring(world, tie, (k + 0.5) * rails.spacing, share * bed);
    auto& limits = world.resource<Limits>();
    limits.low.x() -= (beyond + 1) * rails.spacing;
    limits.high.x() += (beyond + 1) * rails.spacing;
    return first;
}

void lay_rail(World& world, const RailOnTies& rails, EntityId first) {
    const Vec3 seat = rail_seat(world, world.resource<BoxBodies>().ties.front());
    Rail rail{
        .bending = share * rails.bending, .pad = share * rails.pad, .retardation = retardation};
    std::vector<EntityId> ties = world.resource<BoxBodies>().ties;
    const auto beyond = static_cast<EntityId>(2 * rails.ties_on_each_side());
    for (EntityId tie = first; tie < first + beyond; ++tie) ties.push_back(tie);
    const RowIndex row_of(world.column<Bodies, BodyId>());
    const auto position = world.column<Bodies, Position>();
    std::ranges::sort(ties, {}, [&](EntityId tie) { return position[row_of[tie]].x(); });
    for (const EntityId tie : ties) rail.seats.push_back({.tie = tie, .point = seat});
    add_rail(world, std::move(rail));
}

void hang_ties(World& world, double gap) {
    Rail& rail = world.resource<Rails>().list.front();
    const auto& ballast = world.resource<BoxBodies>().ties;
    const RowIndex row_of(world.column<Bodies, BodyId>());
    const auto hangs = [&](const RailSeat& seat) {
        return std::ranges::find(ballast, seat.tie) != ballast.end();
    };
    const RailResponse response(rail);
    const auto n = static_cast<Eigen::Index>(rail.seats.size());
    Eigen::MatrixXd stiffness(n, n); // of the rail, and of the springs below ties
    Eigen::VectorXd force = Eigen::VectorXd::Zero(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const RailSeat& seat = rail.seats[static_cast<std::size_t>(i)];
        const Row row = row_of[seat.tie];
        stiffness.col(i) = -response.of_ties(Eigen::VectorXd::Unit(n, i));
        if (hangs(seat))
            force[i] = -weight_on(world, row);
        else
            stiffness(i, i) += spring_stiffness(world, row);
    }
    const Eigen::VectorXd u = stiffness.ldlt().solve(force); // m, of the seats
    for (Eigen::Index i = 0; i < n; ++i) {
        RailSeat& seat = rail.seats[static_cast<std::size_t>(i)];
        const Row row = row_of[seat.tie];
        double& height = world.column<Bodies, Position>()[row].z();
        const Vec3 arm = world.column<Bodies, Orientation>()[row] * seat.point;
        const double above = height + arm.z() - rail.level - u[i]; // the seat, for now
        world.column<Bodies, Velocity>()[row].setZero();
        world.column<Bodies, AngularMomentum>()[row].setZero();
        if (hangs(seat)) {
            height += gap;
            seat.point.z() -= gap + above;
        } else {
            height -= above;
        }
    }
    invalidate_lists(world);
    show_velocities(world);
}

void begin_train(World& world, const Train& train, double speed) {
    Rail& rail = world.resource<Rails>().list.front();
    const double now = world.resource<Clock>().time();
    rail.axle_positions.clear();
    rail.axle_loads.clear();
    for (const Axle& axle : train.axles) {
        rail.axle_positions.push_back(rail.seats.front().along - axle.behind - speed * now);
        rail.axle_loads.push_back(share * axle.load);
    }
    rail.axle_speed = speed;
}

double time_on_rail(const World& world, const Train& train, double speed) {
    const Rail& rail = world.resource<Rails>().list.front();
    return (rail.seats.back().along - rail.seats.front().along + train.length()) / speed;
}

} // namespace bris
