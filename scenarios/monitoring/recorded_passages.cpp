#include "scenarios/monitoring/recorded_passages.hpp"

#include "scenarios/sensors/naming.hpp"

#include <algorithm>

namespace bris {

namespace fs = std::filesystem;

std::vector<fs::path> RecordingsNamed::list() const {
    std::vector<fs::path> all;
    std::string rest = paths;
    while (!rest.empty()) {
        // a name with a comma is meant as it is
        const auto comma = fs::exists(rest) ? std::string::npos : rest.find(',');
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
    const fs::path beside = !paths.empty() && fs::is_directory(paths.front()) ? paths.front()
                            : paths.empty()                                   ? fs::path{}
                                            : paths.front().parent_path();
    const auto causes = naming(named.option, [&] { return read_causes(beside / "passages.csv"); });
    for_each_logged_passage(
        paths, named.logger, named.cutting, named.option,
        [&](Passage&& passage) {
            if (const auto found = causes.find(passage.name); found != causes.end())
                passage.cause = found->second;
            take(std::move(passage));
        },
        notes);
}

std::vector<std::string> with_listed_files(const std::vector<std::string>& words,
                                           const std::vector<std::string>& options) {
    std::vector<std::string> joined;
    bool may_follow = false;
    for (const std::string& word : words) {
        const bool is_option = word.starts_with('-') && word.size() > 1;
        if (may_follow && !is_option && !joined.back().starts_with("--"))
            joined.back() += "," + word;
        else
            joined.push_back(word);
        if (is_option) may_follow = std::ranges::count(options, word) > 0;
    }
    return joined;
}

} // namespace bris
