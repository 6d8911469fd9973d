#pragma once

#include "engine/io/whole_file.hpp"

#include <filesystem>
#include <vector>

namespace bris {

/// Ends a file with its seal and waits until all of it is on the disk. The seal, which HDF5
/// ignores, lists the ranges that whoever reads them checks by hashes of his own (in ascending
/// order), and holds a hash of all other bytes before it. So a file is not read again to be
/// sealed, and ranges may be written and checked by different processes. Throws OutputError.
void seal_file(const std::filesystem::path& path, const std::vector<FileRange>& checked_by_reader);

/// Checks the bytes outside of those ranges. Throws InputError if the file has no seal or another
/// content, OutputError if it cannot be read.
void check_seal(const std::filesystem::path& path);

} // namespace bris
