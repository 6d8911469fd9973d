#pragma once

#include "engine/archive.hpp"
#include "engine/named_value.hpp"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// What it takes to go on with a run: all State, and the settings that the scene was made from.
struct Checkpoint {
    std::string scenario;
    std::uint64_t step = 0;
    std::vector<NamedValue> settings; ///< as read back: every value as text
    Archive state;
};

/// Writes NAME.ckpt.h5: datasets under /state by their paths, settings as attributes of /settings.
/// The file is written beside `path`, synchronised and renamed: whoever looks finds the old one or
/// the whole new one, also after a crash or with a full disk. Its last 16 bytes, which HDF5 does
/// not look at, seal it: a mark and a hash of everything before. Throws OutputError.
void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);

/// Reads it back, `state` to the same bits. Throws OutputError if the file cannot be read, and
/// InputError if it is foreign, cut short or damaged: the seal is checked before anything else.
Checkpoint read_checkpoint(const std::filesystem::path& path);

/// Throws InputError, with the key, unless the checkpoint was made by the scenario of this run with
/// the same settings. Keys in `may_differ` are left out.
void require_same_run(const std::filesystem::path& path, const Checkpoint& checkpoint,
                      const std::string& scenario, const std::vector<NamedValue>& settings,
                      std::span<const std::string_view> may_differ);

/// What may differ between a run and the one that goes on from it, whatever is simulated.
std::span<const std::string_view> settings_that_may_differ();

} // namespace bris
