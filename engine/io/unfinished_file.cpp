#include "engine/io/unfinished_file.hpp"

#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>
#include <unistd.h>

namespace bris {

UnfinishedFile::UnfinishedFile(const std::filesystem::path& name)
    : complete_(file_to_write(name)), path_(temporary_name(complete_)),
      cleanup_([path = path_] { (void)::unlink(path.c_str()); }) {
    std::error_code error;
    if (complete_.has_parent_path())
        std::filesystem::create_directories(complete_.parent_path(), error);
    if (error)
        throw OutputError(
            fmt::format("cannot write '{}': {}", complete_.string(), error.message()));
}

UnfinishedFile::~UnfinishedFile() {
    std::error_code ignored; // after put_in_place there is none
    std::filesystem::remove(path_, ignored);
}

void UnfinishedFile::put_in_place() {
    if (std::rename(path_.c_str(), complete_.c_str()) != 0)
        throw OutputError(
            fmt::format("cannot write '{}': {}", complete_.string(), std::strerror(errno)));
}

} // namespace bris
