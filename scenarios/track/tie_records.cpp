#include "scenarios/track/tie_records.hpp"

#include "components/kinds.hpp"
#include "engine/clock.hpp"
#include "engine/ordering.hpp"
#include "scenarios/ballast_box/box_scene.hpp"
#include "systems/loads/rail.hpp"
#include "systems/output/outer_force.hpp"

#include <algorithm>
#include <array>

namespace bris {

namespace {

constexpr auto path = "track/ties", began_path = "track/began";

/// Numbers of a record, in the order in which they are saved.
auto numbers_of(auto& tie) {
    return std::array{&tie.height,     &tie.now,  &tie.support_now, &tie.deflection,
                      &tie.settlement, &tie.load, &tie.support};
}

} // namespace

void TieRecords::begin(const World& world) {
    began_ = world.resource<Clock>().time();
    const auto position = world.column<Bodies, Position>();
    const RowIndex row_of(world.column<Bodies, BodyId>());
    ties_.clear();
    for (const EntityId tie : world.resource<BoxBodies>().ties)
        ties_.push_back({.height = position[row_of[tie]].z()});
}

void TieRecords::note(const World& world) {
    const auto position = world.column<Bodies, Position>();
    const auto force = world.column<Bodies, Force>();
    const auto of_rail = world.column<Bodies, RailForce>();
    const RowIndex row_of(world.column<Bodies, BodyId>());
    const OuterForces outer(world);
    const auto& ids = world.resource<BoxBodies>().ties;
    for (std::size_t k = 0; k < ids.size(); ++k) {
        const Row row = row_of[ids[k]];
        TieRecord& tie = ties_[k];
        tie.now = tie.settlement = tie.height - position[row].z();
        tie.support_now = force[row].z() - outer(row).z();
        tie.deflection = std::max(tie.deflection, tie.now);
        tie.load = std::max(tie.load, -of_rail[row].force.z());
        tie.support = std::max(tie.support, tie.support_now);
    }
}

TieRecord TieRecords::largest() const {
    TieRecord largest = ties_.front();
    for (TieRecord tie : ties_) {
        const auto to = numbers_of(largest), from = numbers_of(tie);
        for (std::size_t k = 0; k < to.size(); ++k) *to[k] = std::max(*to[k], *from[k]);
    }
    return largest;
}

void TieRecords::save(Archive& archive) const {
    std::vector<double> numbers;
    for (const TieRecord& tie : ties_)
        for (const double* number : numbers_of(tie)) numbers.push_back(*number);
    archive.put(path, std::span<const double>(numbers));
    archive.put(began_path, std::span<const double>(&began_, 1));
}

void TieRecords::load(const Archive& archive) {
    const auto numbers = archive.get<double>(path);
    began_ = archive.get<double>(began_path).at(0);
    ties_.assign(numbers.size() / numbers_of(ties_.emplace_back()).size(), {});
    auto next = numbers.begin();
    for (TieRecord& tie : ties_)
        for (double* number : numbers_of(tie)) *number = *next++;
}

} // namespace bris
