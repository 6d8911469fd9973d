#include "systems/loads/table.hpp"

#include "engine/exact_sum.hpp"

#include <algorithm>

namespace bris {

namespace {

void append(StepList& list, StepList systems) {
    list.insert(list.end(), systems.begin(), systems.end());
}

} // namespace

StepList force_systems_of_elements() {
    StepList list;
    for_each_element([&]<class E>() { append(list, E::force_systems()); });
    return list;
}

StepList work_systems_of_elements() {
    StepList list;
    for_each_element([&]<class E>() { append(list, E::work_systems()); });
    return list;
}

void add_work_of_elements(World& world) {
    Table& bodies = world.table<Bodies>();
    for_each_element_of(world, [&]<class E>() {
        if constexpr (!std::is_void_v<typename E::Work>) bodies.add<typename E::Work>();
        if constexpr (!std::is_void_v<typename E::Loss>) bodies.add<typename E::Loss>();
    });
}

ElementWork work_of_elements(const World& world) {
    const Table& bodies = world.table<Bodies>();
    ElementWork work;
    for_each_element_of(world, [&]<class E>() {
        if constexpr (!std::is_void_v<typename E::Work>)
            work.done += exact_sum(bodies.column<typename E::Work>());
        if constexpr (!std::is_void_v<typename E::Loss>)
            work.lost += exact_sum(bodies.column<typename E::Loss>());
    });
    return work;
}

double energy_of_elements(const World& world) {
    double energy = 0;
    for_each_element_of(world, [&]<class E>() { energy += E::energy(world); });
    return energy;
}

ElementSprings::ElementSprings(const World& world) {
    for_each_element_of(world, [&]<class E>() { E::add_springs(world, springs_); });
    std::ranges::stable_sort(springs_, {}, &BodySpring::body);
}

std::span<const BodySpring> ElementSprings::of(Row body) const {
    const auto found = std::ranges::equal_range(springs_, body, {}, &BodySpring::body);
    return {found.begin(), found.end()};
}

} // namespace bris
