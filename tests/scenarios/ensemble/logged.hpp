#pragma once

#include "scenarios/stream/logged_lines.hpp"

#include <filesystem>
#include <memory>

namespace bris::testing {

/// The lines of a file, after those of a log, in which they are logged.
inline std::unique_ptr<Lines> logged(const std::filesystem::path& stream,
                                     const std::filesystem::path& log) {
    return std::make_unique<LoggedLines>(
        std::make_unique<LineSource>(stream),
        std::make_shared<StreamLog>(log, LoggedRecords::lines, std::uint64_t{1} << 30));
}

} // namespace bris::testing
