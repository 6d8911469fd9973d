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

constexpr auto ties_path = "track/ties", passages_path = "track/passages",
               began_path = "track/began";

/// Numbers of a record, in the order in which they are saved.
auto numbers_of(auto& tie) {
    return std::array{&tie.height,     &tie.now,  &tie.support_now, &tie.deflection,
                      &tie.settlement, &tie.load, &tie.support};
}

void put(Archive& archive, const char* path, const std::vector<TieRecord>& records) {
    std::vector<double> numbers;
    for (TieRecord record : records)
        for (const double* number : numbers_of(record)) numbers.push_back(*number);
    archive.put(path, std::span<const double>(numbers));
}

std::vector<TieRecord> records_in(const Archive& archive, const char* path) {
    const auto numbers = archive.get<double>(path);
    std::vector<TieRecord> records;
    for (auto next = numbers.begin(); next != numbers.end();)
        for (double* number : numbers_of(records.emplace_back())) *number = *next++;
    return records;
}

/// Raises each number to that of another record.
void raise(TieRecord& to, TieRecord by) {
    const auto numbers = numbers_of(to), others = numbers_of(by);
    for (std::size_t k = 0; k < numbers.size(); ++k)
        *numbers[k] = std::max(*numbers[k], *others[k]);
}

} // namespace

void TieRecords::begin(const World& world) {
    if (passages_.empty()) began_ = world.resource<Clock>().time();
    passages_.emplace_back();
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
    TieRecord& largest = passages_.back();
    for (std::size_t k = 0; k < ids.size(); ++k) {
        const Row row = row_of[ids[k]];
        TieRecord& tie = ties_[k];
        tie.now = tie.settlement = tie.height - position[row].z();
        tie.support_now = force[row].z() - outer(row).z();
        tie.deflection = std::max(tie.deflection, tie.now);
        tie.load = std::max(tie.load, -of_rail[row].force.z());
        tie.support = std::max(tie.support, tie.support_now);
        raise(largest, tie);
    }
    // what remains in the end is not the largest of the time
    largest.settlement = std::ranges::max(ties_, {}, &TieRecord::settlement).settlement;
}

void TieRecords::save(Archive& archive) const {
    put(archive, ties_path, ties_);
    put(archive, passages_path, passages_);
    archive.put(began_path, std::span<const double>(&began_, 1));
}

void TieRecords::load(const Archive& archive) {
    ties_ = records_in(archive, ties_path);
    passages_ = records_in(archive, passages_path);
    began_ = archive.get<double>(began_path).at(0);
}

} // namespace bris
