#include "systems/loads/rail.hpp"

#include "components/sphere.hpp"
#include "engine/clock.hpp"
#include "engine/errors.hpp"
#include "engine/ordering.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace bris {

namespace {

RailBeam beam_of(const Rail& rail) {
    std::vector<double> at;
    for (const RailSeat& seat : rail.seats) at.push_back(seat.along);
    return {std::move(at), rail.bending};
}

Vec3 arm_of(const RailSeat& seat, const Quat& tie) { return tie * seat.point; }

using RailTies = Rows<Bodies, const RailTie, const Position, const Velocity, const Acceleration,
                      const AngularVelocity, const Orientation, Force, Torque, RailForce>;

/// The rows of the ties. Of all other bodies only the column RailTie is read.
void find_ties(const RailTies& bodies, Rails& rails) {
    const std::uint32_t* number = bodies.column<RailTie>();
    Wrench* total = bodies.column<RailForce>();
    rails.rows.resize(rails.ties.size());
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        if (number[b] == 0) continue;
        rails.rows[number[b] - 1] = b;
        total[b] = {};
    }
}

/// Adds the forces of the rails to the ties, with the deflections and loads at the time of the
/// positions.
void bend_rails(RailTies bodies, Rails& rails, const Clock& clock) {
    find_ties(bodies, rails);
    rails.prepare();
    for (std::size_t k = 0; k < rails.list.size(); ++k) {
        const Rail& rail = rails.list[k];
        const auto n = static_cast<Eigen::Index>(rail.seats.size());
        Eigen::VectorXd deflection(n), speed(n);
        for (Eigen::Index i = 0; i < n; ++i) {
            const RailSeat& seat = rail.seats[static_cast<std::size_t>(i)];
            const Row b = rails.rows[seat.number];
            const Vec3 arm = arm_of(seat, bodies.column<Orientation>()[b]);
            deflection[i] = (bodies.column<Position>()[b] + arm).dot(rail.up) - rail.level;
            speed[i] = point_velocity(bodies, b, arm, clock.dt).dot(rail.up);
        }
        const RailResponse& response = rails.responses[k];
        rails.of_loads[k] = response.of_loads(rail, clock.time());
        rails.of_retardation[k] = rail.retardation * response.of_ties(speed);
        const Eigen::VectorXd force =
            rails.of_loads[k] + rails.of_retardation[k] + response.of_ties(deflection);
        for (Eigen::Index i = 0; i < n; ++i) {
            const RailSeat& seat = rail.seats[static_cast<std::size_t>(i)];
            const Row b = rails.rows[seat.number];
            const Vec3 f = force[i] * rail.up;
            const Vec3 torque = arm_of(seat, bodies.column<Orientation>()[b]).cross(f);
            bodies.column<Force>()[b] += f;
            bodies.column<Torque>()[b] += torque;
            bodies.column<RailForce>()[b].force += f;
            bodies.column<RailForce>()[b].torque += torque;
        }
    }
}

void accumulate_rail_work(
    Rows<Bodies, const Force, const Torque, const Velocity, const AngularMomentum,
         const InertialMass, const InertialInertia, const Orientation, RailWork, RailLoss>
        bodies,
    const Rails& rails, const Clock& clock) {
    for (std::size_t k = 0; k < rails.list.size(); ++k)
        for (std::size_t i = 0; i < rails.list[k].seats.size(); ++i) {
            const RailSeat& seat = rails.list[k].seats[i];
            const Row b = rails.rows[seat.number];
            const MeanMotion mean = mean_motion(bodies, b, clock.dt);
            const Vec3 arm = arm_of(seat, bodies.column<Orientation>()[b]);
            const double moved =
                clock.dt * (mean.velocity + mean.angular_velocity.cross(arm)).dot(rails.list[k].up);
            const auto at = static_cast<Eigen::Index>(i);
            bodies.column<RailWork>()[b] += moved * rails.of_loads[k][at];
            bodies.column<RailLoss>()[b] -= moved * rails.of_retardation[k][at];
        }
}

void check(const World& world, const Rail& rail) {
    const auto expect = [](bool holds, const std::string& what) {
        require(holds, "rail: expected " + what);
    };
    expect(rail.bending > 0 && rail.pad > 0 && rail.retardation >= 0,
           fmt::format("a bending stiffness and a stiffness of the pads above 0 and a retardation "
                       "of at least 0, found {:g} N m2, {:g} N/m and {:g} s",
                       rail.bending, rail.pad, rail.retardation));
    expect(std::abs(rail.up.norm() - 1) < 1e-12 && std::abs(rail.along.norm() - 1) < 1e-12 &&
               std::abs(rail.up.dot(rail.along)) < 1e-12,
           "two directions of length 1 at right angles");
    expect(rail.axle_positions.size() == rail.axle_loads.size(),
           fmt::format("a load for each axle, found {} loads and {} positions",
                       rail.axle_loads.size(), rail.axle_positions.size()));
    expect(rail.seats.size() >= 2, fmt::format("two ties or more, found {}", rail.seats.size()));
    std::vector<EntityId> ties;
    for (const RailSeat& seat : rail.seats) ties.push_back(seat.tie);
    std::ranges::sort(ties);
    for (const EntityId parent : world.column<Spheres, ParentId>())
        if (std::ranges::binary_search(ties, parent))
            expect(false, fmt::format("ties of facets, found body {} of spheres", parent));
}

} // namespace

RailResponse::RailResponse(const Rail& rail) : beam_(beam_of(rail)), pad_(rail.pad) {
    Eigen::SparseMatrix<double> held = beam_.stiffness();
    for (Eigen::Index i = 0; i < beam_.nodes(); ++i) held.coeffRef(2 * i, 2 * i) += pad_;
    held_ = std::make_shared<const Factors>(held);
}

Eigen::VectorXd RailResponse::deflections(const Eigen::VectorXd& at_nodes) const {
    const Eigen::VectorXd all = held_->solve(at_nodes); // with the slopes
    return all(Eigen::seqN(0, beam_.nodes(), 2));
}

Eigen::VectorXd RailResponse::of_loads(const Rail& rail, double time) const {
    Eigen::VectorXd loads = Eigen::VectorXd::Zero(2 * beam_.nodes());
    beam_.add_line_load(-rail.weight, loads);
    for (std::size_t axle = 0; axle < rail.axle_loads.size(); ++axle)
        beam_.add_force(rail.axle_positions[axle] + time * rail.axle_speed, -rail.axle_loads[axle],
                        loads);
    return pad_ * deflections(loads);
}

Eigen::VectorXd RailResponse::of_ties(const Eigen::VectorXd& u) const {
    Eigen::VectorXd pushed = Eigen::VectorXd::Zero(2 * beam_.nodes());
    pushed(Eigen::seqN(0, beam_.nodes(), 2)) = pad_ * u;
    return pad_ * (deflections(pushed) - u);
}

void Rails::prepare() {
    while (responses.size() < list.size()) responses.emplace_back(list[responses.size()]);
    of_loads.resize(list.size());
    of_retardation.resize(list.size());
}

void Rails::save(Archive& archive) const {
    save_elements(archive, "rails", list);
    save_elements(archive, "rail_ties", ties);
}

void Rails::load(const Archive& archive) {
    load_elements(archive, "rails", list);
    load_elements(archive, "rail_ties", ties);
    responses.clear();
}

StepList Rails::force_systems() { return {system("bend_rails", bend_rails)}; }
StepList Rails::work_systems() { return {system("accumulate_rail_work", accumulate_rail_work)}; }

double Rails::energy(const World& world) {
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    const auto& rails = world.resource<Rails>();
    double energy = 0;
    for (std::size_t k = 0; k < rails.list.size(); ++k) {
        const Rail& rail = rails.list[k];
        Eigen::VectorXd u(static_cast<Eigen::Index>(rail.seats.size()));
        for (Eigen::Index i = 0; i < u.size(); ++i) {
            const RailSeat& seat = rail.seats[static_cast<std::size_t>(i)];
            const Row b = rows[seat.tie];
            const Vec3 arm = arm_of(seat, world.column<Bodies, Orientation>()[b]);
            u[i] = (world.column<Bodies, Position>()[b] + arm).dot(rail.up) - rail.level;
        }
        const bool is_known = k < rails.responses.size(); // not before the first step
        energy -= 0.5 * u.dot((is_known ? rails.responses[k] : RailResponse(rail)).of_ties(u));
    }
    return energy;
}

/// A rail gives way, so that it holds a tie by less than the pad does.
void Rails::add_springs(const World& world, std::vector<BodySpring>& springs) {
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    for (const Rail& rail : world.resource<Rails>().list)
        for (const RailSeat& seat : rail.seats) {
            const Row b = rows[seat.tie];
            springs.push_back({b, rail.pad, rail.retardation * rail.pad,
                               arm_of(seat, world.column<Bodies, Orientation>()[b]), rail.up});
        }
}

void add_rail(World& world, Rail rail) {
    check(world, rail);
    Table& bodies = world.table<Bodies>();
    bodies.add<RailTie>();
    bodies.add<RailForce>();
    if (!world.has_resource<Rails>()) world.add_resource<Rails>();
    auto& rails = world.resource<Rails>();
    rail.level = 0;
    for (RailSeat& seat : rail.seats) {
        const Row b = row_of_free_clump(world, seat.tie, "rail");
        const Vec3 at =
            bodies.column<Position>()[b] + arm_of(seat, bodies.column<Orientation>()[b]);
        seat.along = at.dot(rail.along);
        rail.level += at.dot(rail.up) / static_cast<double>(rail.seats.size());
        require(&seat == &rail.seats.front() || (&seat - 1)->along < seat.along,
                fmt::format("rail: expected ties in their order along the rail, found body {} "
                            "behind the one before it",
                            seat.tie));
        std::uint32_t& number = bodies.column<RailTie>()[b];
        if (number == 0) {
            rails.ties.push_back(seat.tie);
            number = static_cast<std::uint32_t>(rails.ties.size());
        }
        seat.number = number - 1;
    }
    rails.list.push_back(std::move(rail));
    rails.responses.clear();
}

} // namespace bris
