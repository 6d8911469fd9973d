#pragma once

#include "engine/state_source.hpp"
#include "engine/world.hpp"

#include <string>
#include <vector>

namespace bris {

/// The State of a world: every State column in the order of the table's key, then the resources.
/// The bits depend neither on the order of the rows in memory nor on how the world is divided.
class StateOfWorld final : public StateSource {
public:
    /// Rows of a table that this rank has to give of its part of a world.
    using RowsOfPart = std::vector<Row> (*)(const World& part, const Table& table);

    /// Of a whole world, which must remain as it is.
    explicit StateOfWorld(const World& whole) : part_(whole), whole_(whole) {}
    /// Of a world of which each rank has a part, and `whole` those resources that parts do not
    /// change.
    StateOfWorld(const World& part, const World& whole, RowsOfPart rows_of)
        : part_(part), whole_(whole), rows_of_(rows_of) {}

    void for_pieces(const Visit& visit) const override;

private:
    const World &part_, &whole_;
    RowsOfPart rows_of_ = nullptr; ///< null: the world is not divided
};

/// The key column of a table whose rows are State. Null if they have no key, or no other State
/// (candidate pairs without history).
const Column* key_of_state(const Table& table);

/// The name of a column's array: "bodies/position".
std::string path_in_state(const Table& table, const Column& column);

} // namespace bris
