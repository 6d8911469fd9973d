#pragma once

#include "engine/scenario.hpp"
#include "engine/simulation.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// Version of the recipes by which beds are made. To be raised by whoever changes a recipe, or
/// anything else that changes the bits of a bed: the test of this store then fails, since it makes
/// a bed whose fingerprint it knows.
constexpr int bed_version = 1;

/// Beds of ballast that were made before, each a checkpoint whose name holds the hash of its
/// recipe: version, settings and the world as it is before the first step. Nobody makes a bed
/// twice: the second time it costs nothing and has the same bits.
class BedStore {
public:
    /// Looks for the bed in the user's folder, then in that of the assets; a damaged file (its seal
    /// is checked) is said and passed over; on several ranks all or none find it. A run with
    /// --resume looks for none and keeps none. `common`: scenario and settings of the run that
    /// makes the bed, and --beds. `placed`: its simulation before the first step. `kind`: begins
    /// the name of the file. Settings in `may_differ` do not concern the bed. Of files the content
    /// counts, of folders what the world has of it.
    BedStore(const Common& common, const Simulation& placed, const std::string& kind,
             const std::vector<std::string_view>& may_differ = {});

    /// The checkpoint with which the run begins: that of --resume, or of the bed that was found;
    /// empty: the bed has to be made.
    const std::filesystem::path& from() const { return from_; }

    /// Adds the checkpoint of a bed that had to be made to the user's folder; the oldest beds give
    /// way when all together have more than 4 GiB. If --beds cannot be written to, it is said, and
    /// no error.
    void keep(const std::filesystem::path& checkpoint) const;

private:
    std::filesystem::path from_, kept_; ///< kept_: where the bed is kept once made; empty: nowhere
    bool asked_ = false;                ///< for the folder
};

} // namespace bris
