#pragma once

#include "engine/archive.hpp"
#include "engine/named_value.hpp"
#include "engine/state_source.hpp"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// Everything needed to continue a run: all State, and the settings from which the scene was made.
struct Checkpoint {
    std::string scenario;
    std::uint64_t step = 0;
    std::vector<NamedValue> settings; ///< after reading, every value is text
    Archive state;
};

/// Writes NAME.ckpt.h5: datasets under /state by their paths, settings as attributes of /settings
/// without those that may differ, so that the same State has the same bytes.
/// The file is written under a temporary name, synchronised and renamed, so that a reader finds
/// either the old file or the complete new one, also after a crash or when the disk is full. Every
/// block of State has a hash (/blocks: index of its first array, ids / 65 536, hash), and a seal at
/// the end of the file guards everything else (seal_file). Only the first rank writes. `state`
/// comes before the State of the checkpoint, and is not null where that has only what belongs to
/// it. Throws OutputError.
void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint,
                      const StateSource* state = nullptr);

/// Reads a checkpoint; `state` has the same bits as when it was written. The seal is checked first,
/// then the blocks.
/// Throws OutputError if the file cannot be read, and InputError if it is not a checkpoint,
/// truncated or damaged.
Checkpoint read_checkpoint(const std::filesystem::path& path);

/// Throws InputError, listing all settings that differ, unless the checkpoint was written by this
/// scenario with the same settings. Settings in `may_differ` are not compared; paths are the same
/// if they lead to one file or folder, or to files with the same content. `option` is the one that
/// names the path, as "--resume".
void require_same_run(const std::string& option, const std::filesystem::path& path,
                      const Checkpoint& checkpoint, const std::string& scenario,
                      const std::vector<NamedValue>& settings,
                      std::span<const std::string_view> may_differ);

/// Settings that may differ between a run and its continuation in every scenario.
std::span<const std::string_view> settings_that_may_differ();

} // namespace bris
