#pragma once

#include "engine/interrupt.hpp"

#include <filesystem>

namespace bris {

/// A file that is written under a temporary name beside its own, and put in place when it is
/// complete: a reader finds either the old file or the whole new one. Without `put_in_place` it is
/// removed with the object, and also where a request to stop ends the program. The temporary name
/// contains the process id, because two runs into one folder must not share the unfinished file.
/// Its owner has asked whether this rank writes (Ranks::writes).
class UnfinishedFile {
public:
    /// `name`: of the complete file (file_to_write). Creates missing folders. Throws OutputError.
    explicit UnfinishedFile(const std::filesystem::path& name);
    ~UnfinishedFile();
    UnfinishedFile(const UnfinishedFile&) = delete;

    /// The temporary name, under which the owner writes.
    const std::filesystem::path& path() const { return path_; }
    /// Throws OutputError.
    void put_in_place();

private:
    std::filesystem::path complete_, path_;
    Cleanup cleanup_;
};

} // namespace bris
