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
    return std::array{&tie.height,     &tie.now,  &tie.support_now,
                      &tie.deflection, &tie.load, &tie.support};
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

/// What of a tie is the largest of a time.
auto largest_of(auto& tie) { return std::array{&tie.deflection, &tie.load, &tie.support}; }

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
        tie.now = tie.height - position[row].z();
        tie.support_now = force[row].z() - outer(row).z();
        tie.deflection = std::max(tie.deflection, tie.now);
        tie.load = std::max(tie.load, -of_rail[row].force.z());
        tie.support = std::max(tie.support, tie.support_now);
        const auto to = largest_of(largest), by = largest_of(tie);
        for (std::size_t n = 0; n < to.size(); ++n) *to[n] = std::max(*to[n], *by[n]);
    }
    largest.now = std::ranges::max(ties_, {}, &TieRecord::now).now;
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
