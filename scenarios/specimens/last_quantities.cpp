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

const LastQuantities::Values& LastQuantities::updated() {
    const std::uint64_t steps = simulation_.count().steps;
    if (steps != values_.steps) {
        const World& world = simulation_.world();
        values_ = {compute_quantities(world), bris::stable_step(world), steps};
    }
    return values_;
}

void LastQuantities::save(Archive& archive) {
    (void)updated();
    put_fields(archive, path,
               fields_of(std::as_const(values_.quantities), std::as_const(values_.stable_step)));
}

void LastQuantities::load(const Archive& archive) {
    if (archive.find(path) != nullptr) // older checkpoints have none
        get_fields(archive, path, fields_of(values_.quantities, values_.stable_step));
    values_.steps = simulation_.count().steps;
}

} // namespace bris
