#include "systems/fields/coupled_fields.hpp"

namespace bris {

StepList systems_of_fields() {
    StepList list;
    for_each_field([&]<class F>() {
        for (System& system : F::systems()) list.push_back(std::move(system));
    });
    return list;
}

bool fields_are_due(const World& world) {
    bool due = false;
    for_each_field_of(world, [&]<class F>() { due = due || F::is_due(world); });
    return due;
}

bool fields_are_checked(const World& world) {
    const std::uint64_t step = world.resource<Clock>().step;
    bool checked = false;
    for_each_field_of(world, [&]<class F>() {
        checked = checked || world.resource<typename F::Field>().is_checked(step);
    });
    return checked;
}

void add_saved_fields(World& world, const Archive& state) {
    for_each_field([&]<class F>() {
        if (state.find(F::saved_as) != nullptr) F::add(world);
    });
}

} // namespace bris
