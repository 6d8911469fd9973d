#pragma once

#include "scenarios/stream/record_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace bris::testing {

/// The records of all passages in a folder, one passage 20 s after the other.
inline std::vector<std::string> lines_of_passages(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        if (entry.path().filename() == "recordings.csv") files.push_back(entry.path());
    std::ranges::sort(files);
    std::vector<std::string> lines;
    for (std::size_t k = 0; k < files.size(); ++k) {
        RecordParser parser;
        std::ifstream in(files[k]);
        for (std::string line; std::getline(in, line);) {
            const auto record = parser.parse({1, line, this_instant(), true});
            if (!record) continue;
            std::string text;
            for (const auto& [name, value] : record->numbers())
                text += fmt::format("{}\"{}\": {}", text.empty() ? "{" : ", ", name,
                                    name == "t" ? value + 20.0 * static_cast<double>(k) : value);
            lines.push_back(text + "}");
        }
    }
    return lines;
}

} // namespace bris::testing
