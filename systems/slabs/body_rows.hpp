#pragma once

#include "engine/ranks.hpp"
#include "engine/world.hpp"

#include <optional>
#include <span>
#include <vector>

namespace bris::detail {

// Bodies travel between ranks with all that belongs to them: the State columns of their own rows,
// of their spheres, and of those pairs with a history that they own (the pair of two bodies is
// owned by the lower id). The columns are those that the tables have, so that a new component needs
// no code here. `SpheresOf` must be up to date.

/// What belongs to bodies, as bytes for a rank with the same columns.
Ranks::Bytes pack_bodies(const World& world, std::span<const Row> bodies);

/// Appends packed bodies to the tables.
void append_bodies(World& world, const Ranks::Bytes& packed);

/// Removes all bodies with spheres, and what belongs to them, but those of `bodies`. The bodies
/// without spheres remain and become the first rows.
void keep_bodies(World& world, std::span<const Row> bodies);
/// The rows of a table that belong to bodies with spheres; nullopt: it has none of such bodies.
std::optional<std::vector<Row>> rows_of_bodies(const World& world, std::span<const Row> bodies,
                                               const Table& table);
/// Whether the rows of a table are bodies, or belong to them, or are lists of them.
bool is_of_bodies(const Table& table);
/// A world that has these bodies with spheres only, and of its lists nothing.
World copy_of_bodies(const World& whole, std::span<const Row> bodies);

/// Bodies without spheres, and bodies with spheres, by row. They do not need `SpheresOf`.
std::vector<Row> boundaries_of(const World& world);
std::vector<Row> grains_of(const World& world);

} // namespace bris::detail
