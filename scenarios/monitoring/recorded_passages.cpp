#include "scenarios/monitoring/recorded_passages.hpp"

#include "engine/errors.hpp"
#include "scenarios/sensors/naming.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

namespace bris {

namespace fs = std::filesystem;

namespace {

/// The name in passages.csv of a passage, which may be a part of a file, as NAME_01, or be written
/// with the extension of its file; empty: it is not there.
std::string key_in(const std::map<std::string, PassageCause>& causes, const std::string& passage) {
    const bool is_part = passage.size() > 3 && passage[passage.size() - 3] == '_';
    for (const std::string& name :
         {passage, is_part ? passage.substr(0, passage.size() - 3) : passage})
        for (const char* extension : {"", ".csv", ".txt", ".tsv", ".log"})
            if (causes.contains(name + extension)) return name + extension;
    return {};
}

/// Between files whose names have commas.
constexpr char separator = '\n';

} // namespace

std::vector<fs::path> RecordingsNamed::list() const {
    std::vector<fs::path> all;
    std::string rest = paths;
    const char between = rest.find(separator) == std::string::npos ? ',' : separator;
    while (!rest.empty()) {
        // a name with a comma is meant as it is
        const auto comma = fs::exists(rest) ? std::string::npos : rest.find(between);
        all.emplace_back(rest.substr(0, comma));
        rest = comma == std::string::npos ? "" : rest.substr(comma + 1);
    }
    return all;
}

bool RecordingsNamed::is_own_folder() const {
    const auto named = list();
    if (named.size() != 1 || !fs::is_directory(named.front())) return false;
    const auto is_own = [](const fs::path& folder) {
        return std::ranges::any_of(fs::directory_iterator(folder), [](const auto& entry) {
            const std::string name = entry.path().filename().string();
            return name == "recordings.h5" || name == "recordings.csv" ||
                   (name.starts_with("rock_") && entry.path().extension() == ".txt");
        });
    };
    return is_own(named.front()) ||
           std::ranges::any_of(fs::directory_iterator(named.front()), [&](const auto& entry) {
               return entry.is_directory() && is_own(entry.path());
           });
}

void for_each_passage(const RecordingsNamed& named, const std::function<void(Passage&&)>& take,
                      std::vector<std::string>& notes) {
    const auto paths = named.list();
    if (named.is_own_folder())
        return for_each_passage(paths.front(), named.logger.columns, named.option, take);
    std::map<std::string, PassageCause> causes;
    for (const fs::path& path : paths) {
        const fs::path beside = fs::is_directory(path) ? path : path.parent_path();
        causes.merge(naming(named.option, [&] { return read_causes(beside / "passages.csv"); }));
    }
    std::set<std::string> used;
    for_each_logged_passage(
        paths, named.logger, named.cutting, named.option,
        [&](Passage&& passage) {
            const std::string key = key_in(causes, passage.name);
            if (!key.empty()) {
                passage.cause = causes.at(key);
                used.insert(key);
            }
            take(std::move(passage));
        },
        notes);
    if (causes.empty()) return;
    require(
        !used.empty(),
        fmt::format("{}: passages.csv: expected names of passages, which are those of the files "
                    "without their extension, found '{}', which none has",
                    named.option, causes.begin()->first));
    if (used.size() < causes.size())
        notes.push_back(fmt::format("passages.csv: {} of {} rows name no passage that was read.",
                                    causes.size() - used.size(), causes.size()));
}

std::vector<std::string> with_listed_files(const std::vector<std::string>& words,
                                           const std::vector<std::string>& options) {
    std::vector<std::string> joined;
    bool may_follow = false;
    for (const std::string& word : words) {
        const bool is_option = word.starts_with('-') && word.size() > 1;
        if (may_follow && !is_option && !joined.back().starts_with("--"))
            joined.back() += separator + word;
        else
            joined.push_back(word);
        if (is_option) may_follow = std::ranges::count(options, word) > 0;
    }
    for (std::string& word : joined) // commas, which people read, if no name has one
        if (word.find(',') == std::string::npos) std::ranges::replace(word, separator, ',');
    return joined;
}

} // namespace bris
