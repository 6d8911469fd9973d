#include "engine/assets.hpp"

#include "engine/child_program.hpp"
#include "engine/errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

namespace bris {

namespace fs = std::filesystem;

namespace {

fs::path& given_folder() {
    static fs::path folder; // a fact of the process, like its command line
    return folder;
}

fs::path folder_beside_program() {
    std::error_code error;
    const fs::path folder = this_program().parent_path(), beside = folder / "assets";
    if (!fs::exists(beside, error)) // of PREFIX/bin, and of PREFIX/libexec/bris
        for (const char* shared : {"../share/bris/assets", "../../share/bris/assets"})
            if (fs::exists(folder / shared, error))
                return fs::weakly_canonical(folder / shared, error);
    return fs::weakly_canonical(beside, error);
}

/// Names of the files of one kind, without their ending.
std::vector<std::string> names_of(const fs::path& folder, const std::string& ending) {
    std::vector<std::string> names;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error))
        if (entry.path().extension() == ending && entry.path().stem() != "report") // of clumps
            names.push_back(entry.path().stem().string());
    std::ranges::sort(names);
    return names;
}

} // namespace

fs::path assets_folder() {
    if (!given_folder().empty()) return given_folder();
    static const fs::path found = folder_beside_program();
    return found;
}

void find_assets(int argc, char** argv) {
    constexpr std::string_view flag = "--assets";
    for (int k = 1; k < argc; ++k) {
        const std::string_view word = argv[k];
        if (word == flag && k + 1 < argc)
            given_folder() = argv[k + 1];
        else if (word.starts_with(flag) && word.substr(flag.size()).starts_with('='))
            given_folder() = word.substr(flag.size() + 1);
    }
    require(given_folder().empty() || fs::is_directory(given_folder()),
            fmt::format("--assets: expected a folder, found '{}'", given_folder().string()));
}

fs::path asset_or_file(const std::string& option, const std::string& kind, const std::string& name,
                       const std::string& ending) {
    const fs::path folder = assets_folder() / kind, known = folder / (name + ending);
    std::error_code error;
    if (fs::is_regular_file(known, error)) return known;
    std::string names;
    for (const std::string& one : names_of(folder, ending)) names += one + ", ";
    require(fs::is_regular_file(name, error),
            fmt::format("{}: expected {}or the path of a file, found '{}'", option, names, name));
    return name;
}

} // namespace bris
