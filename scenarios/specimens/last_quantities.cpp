#include "scenarios/specimens/last_quantities.hpp"

#include "systems/contact/stable_step.hpp"

#include <tuple>
#include <utility>

namespace bris {

namespace {

constexpr auto path = "run/last_quantities";

template <class Q, class S>
auto fields_of(Q& q, S& stable_step) {
    return std::tie(q.kinetic_energy, q.elastic_energy, q.coordination, q.contacts, q.body_contacts,
                    q.mean_overlap, q.largest_overlap, q.mean_normal_force, q.unbalanced_ratio,
                    q.boundary_force.x(), q.boundary_force.y(), q.boundary_force.z(), q.weight.x(),
                    q.weight.y(), q.weight.z(), stable_step);
}

} // namespace

bool LastQuantities::is_outdated(std::uint64_t& steps) const {
    if (!simulation_.is_observed()) return false; // the run has failed
    const std::uint64_t before = std::exchange(steps, simulation_.count().steps);
    return before != steps;
}

const Quantities& LastQuantities::quantities() {
    if (is_outdated(steps_of_quantities_)) quantities_ = compute_quantities(simulation_.observed());
    return quantities_;
}

double LastQuantities::stable_step() {
    if (is_outdated(steps_of_stable_step_))
        stable_step_ = bris::stable_step(simulation_.observed());
    return stable_step_;
}

void LastQuantities::save(Archive& archive) {
    const double step = stable_step();
    put_fields(archive, path, fields_of(quantities(), step));
}

void LastQuantities::load(const Archive& archive) {
    if (archive.find(path) != nullptr) // older checkpoints have none
        get_fields(archive, path, fields_of(quantities_, stable_step_));
    steps_of_quantities_ = steps_of_stable_step_ = simulation_.count().steps;
}

} // namespace bris
