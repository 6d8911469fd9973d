#pragma once

#include "engine/archive.hpp"
#include "systems/fields/fouling_coupling.hpp"

#include <concepts>

namespace bris {

/// What a field that acts on contacts states. `Field`: its resource, which is State, changes in
/// whole steps only, and counts in `revision` the changes of what bodies see; a step that
/// `is_checked` looks whether it `is_due`, and then its systems bring it up to date. `Factors`: of
/// the contacts of two bodies, by row, of which the first is a rock.
template <class F>
concept CoupledField = requires(World& world, const typename F::Field& field, Row body) {
    { field.revision } -> std::convertible_to<std::uint64_t>;
    { field.is_checked(std::uint64_t{}) } -> std::same_as<bool>;
    { F::systems() } -> std::same_as<StepList>;
    { F::is_due(world) } -> std::same_as<bool>;
    { typename F::Factors(world).of(body, body, true) } -> std::same_as<ContactFactors>;
    F::saved_as;   // path of what an archive holds if the field belongs to the scene
    F::add(world); // an empty one, whose State is then loaded
};

template <CoupledField... Fs>
struct FieldList {};

/// All fields that act on contacts, in the order in which they are brought up to date and their
/// factors multiplied. A new one needs its own file and an entry here.
using CoupledFields = FieldList<FoulingCoupling>;

/// Calls visit.template operator()<F>() for each field.
template <class Visit>
void for_each_field(Visit&& visit) {
    [&]<class... Fs>(FieldList<Fs...>) { (visit.template operator()<Fs>(), ...); }(CoupledFields{});
}
/// The same for those that a scene has.
template <class Visit>
void for_each_field_of(const World& world, Visit&& visit) {
    for_each_field([&]<class F>() {
        if (world.has_resource<typename F::Field>()) visit.template operator()<F>();
    });
}

/// The systems that bring the fields up to date, at the beginning of a step.
StepList systems_of_fields();
/// Whether any field must be brought up to date in this step, and whether a step looks for it.
bool fields_are_due(const World& world);
bool fields_are_checked(const World& world);
/// Adds empty fields of the kinds that an archive holds.
void add_saved_fields(World& world, const Archive& state);

} // namespace bris
