#pragma once

#include "systems/loads/load.hpp"
#include "systems/loads/nudging.hpp"
#include "systems/loads/rail.hpp"
#include "systems/loads/spring_patch.hpp"

#include <concepts>

namespace bris {

/// What a kind of force elements states, with the defaults of ElementDefaults. `Acting`: column of
/// Bodies, in scenes with such elements only, whose values have the `force` (N) that they exert on
/// each body in the step. The State of a kind is in columns of Bodies, which travel between ranks,
/// and in a resource, which all ranks have; elements that join bodies therefore join only bodies
/// without spheres, which all ranks compute.
template <class E>
concept ForceElement = requires(const World& world, std::vector<BodySpring>& springs) {
    E::plural; // for messages
    E::Acting::Value::force;
    typename E::Work;
    typename E::Loss;
    { E::force_systems() } -> std::same_as<StepList>;
    { E::work_systems() } -> std::same_as<StepList>;
    { E::energy(world) } -> std::same_as<double>;
    E::add_springs(world, springs);
    { E::wakes_bodies } -> std::convertible_to<bool>;
    { E::counts_as_weight } -> std::convertible_to<bool>;
};

template <ForceElement... Es>
struct ElementList {};

/// All kinds of force elements, in the order in which they act within a step. A new kind needs its
/// own file and an entry here.
using ForceElements = ElementList<Loads, SpringPatches, Rails, Nudging>;

/// Calls visit.template operator()<E>() for each kind.
template <class Visit>
void for_each_element(Visit&& visit) {
    [&]<class... Es>(ElementList<Es...>) {
        (visit.template operator()<Es>(), ...);
    }(ForceElements{});
}
/// The same for those that a scene has.
template <class Visit>
void for_each_element_of(const World& world, Visit&& visit) {
    for_each_element([&]<class E>() {
        if (world.table<Bodies>().has<typename E::Acting>()) visit.template operator()<E>();
    });
}

/// The systems of all kinds that add their forces, and those that accumulate their work.
StepList force_systems_of_elements();
StepList work_systems_of_elements();

/// Adds the columns of the energy budget.
void add_work_of_elements(World& world);
/// Work (J) that elements have done on bodies since the start, and what their dashpots have taken.
struct ElementWork {
    double done = 0, lost = 0;
};
ElementWork work_of_elements(const World& world);
/// Elastic energy, J, of all elements at the present positions.
double energy_of_elements(const World& world);

/// The springs by which elements hold bodies.
class ElementSprings {
public:
    explicit ElementSprings(const World& world);
    /// Those of the body of a row, in the order of the list of elements.
    std::span<const BodySpring> of(Row body) const;
    std::span<const BodySpring> all() const { return springs_; }

private:
    std::vector<BodySpring> springs_; ///< by row
};

} // namespace bris
