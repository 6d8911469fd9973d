#include "scenarios/monitoring/logger_passages.hpp"

#include "engine/errors.hpp"
#include "scenarios/monitoring/bursts.hpp"
#include "scenarios/sensors/channels.hpp"
#include "scenarios/sensors/naming.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace bris {

namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t most_bytes = 256 << 20; ///< of files that are kept while others are read

bool is_of_logger(const fs::path& file) {
    std::string kind = file.extension().string(), name = file.filename().string();
    for (char& c : kind) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (kind != ".csv" && kind != ".txt" && kind != ".tsv" && kind != ".log") return false;
    const bool is_metadata = name.starts_with("rock_") && kind == ".txt" && name.size() == 11;
    return !is_metadata && name != "passages.csv" && name != "columns.txt" &&
           name != "machine_columns.txt" && name != "quality_control.txt" &&
           !name.starts_with("README");
}

/// A file by what it is known to hold; its samples are kept if there is room.
struct Logged {
    fs::path path;
    std::set<unsigned> ids;
    double begin = 0, end = 0;
    bool is_absolute = false;
    std::optional<LoggerFile> content = {};
};

/// Files whose recordings are of the same time.
struct Group {
    std::vector<Logged*> files;
    std::map<unsigned, double> ends; ///< s, of each sensor
    double end = 0;

    /// Whether the file is of the same time, and goes on or adds sensors.
    bool takes(const Logged& file) const {
        return file.begin < end && std::ranges::all_of(file.ids, [&](unsigned id) {
                   const auto own = ends.find(id);
                   return own == ends.end() || own->second <= file.begin;
               });
    }
    void add(Logged& file) {
        files.push_back(&file);
        for (const unsigned id : file.ids) ends[id] = file.end;
        end = std::max(end, file.end);
    }
};

/// Adds later samples of the same sensor.
void append(Recording& to, Recording&& more) {
    to.time.insert(to.time.end(), more.time.begin(), more.time.end());
    for (const Channel& channel : all_channels)
        std::visit(
            [&](auto member) {
                auto &own = to.*member, &other = more.*member;
                own.insert(own.end(), other.begin(), other.end());
                if (own.size() != to.size()) own.clear(); // not in both
            },
            channel.series);
    to.sequence.clear(); // it may have begun again
}

/// The samples from begin to end, at times from 0.
Recording cut(const Recording& r, double begin, double end) {
    Recording part;
    part.info = r.info;
    const auto first = std::ranges::lower_bound(r.time, begin) - r.time.begin(),
               last = std::ranges::lower_bound(r.time, end) - r.time.begin();
    for (auto k = first; k < last; ++k)
        part.time.push_back(r.time[static_cast<std::size_t>(k)] - begin);
    for (const Channel& channel : all_channels)
        std::visit(
            [&](auto member) {
                const auto& values = r.*member;
                if (values.size() == r.size())
                    (part.*member).assign(values.begin() + first, values.begin() + last);
            },
            channel.series);
    return part;
}

class LoggedPassages {
public:
    LoggedPassages(const LoggerSettings& settings, const PassageCutting& cutting,
                   std::string option, const std::function<void(Passage&&)>& take,
                   std::vector<std::string>& notes)
        : settings_(settings), cutting_(cutting), option_(std::move(option)), take_(take),
          notes_(notes) {}

    void read(const std::vector<fs::path>& paths) {
        std::uintmax_t bytes = 0;
        for (const fs::path& path : paths) {
            std::error_code error;
            const auto size = fs::file_size(path, error);
            bytes += error ? 0 : size;
            files_.emplace_back().path = path;
            Logged& file = files_.back();
            LoggerFile content = load(path);
            for (const std::string& note : content.notes)
                notes_.push_back(fmt::format("{}: {}", path.filename().string(), note));
            describe(file, content);
            if (bytes < most_bytes) file.content = std::move(content);
        }
        for (const Group& group : groups()) take_group(group);
    }

private:
    LoggerFile load(const fs::path& path) const {
        return naming(option_, [&] { return read_logger_file(path, settings_); });
    }

    static void describe(Logged& file, const LoggerFile& content) {
        file.is_absolute = content.is_absolute;
        file.begin = HUGE_VAL, file.end = -HUGE_VAL;
        for (const Recording& r : content.recordings) {
            file.ids.insert(r.info.id);
            file.begin = std::min(file.begin, r.time.front());
            file.end = std::max(file.end, r.time.back());
        }
    }

    /// Those with dates in their order, then the others in order of name.
    std::vector<Group> groups() {
        std::vector<Logged*> order;
        for (Logged& file : files_) order.push_back(&file);
        std::ranges::stable_sort(order, {}, [](const Logged* file) {
            return file->is_absolute ? file->begin : HUGE_VAL;
        });
        std::vector<Group> all;
        for (Logged* const file : order) {
            const bool is_same = file->is_absolute && !all.empty() && all.back().takes(*file);
            if (!is_same) all.emplace_back();
            all.back().add(*file);
        }
        return all;
    }

    std::string name_of(const fs::path& file) {
        std::string name = file.stem().string();
        if (names_.contains(name) && !file.parent_path().filename().empty())
            name = file.parent_path().filename().string() + "_" + name;
        std::string own = name;
        for (int k = 2; !names_.insert(own).second; ++k) own = fmt::format("{}_{}", name, k);
        return own;
    }

    void take_group(const Group& group) {
        Passage whole{.name = name_of(group.files.front()->path), .recordings = {}};
        for (Logged* const file : group.files) {
            LoggerFile content = file->content ? std::move(*file->content) : load(file->path);
            file->content.reset();
            for (Recording& r : content.recordings) {
                const auto same = std::ranges::find(whole.recordings, r.info.id, id_of);
                if (same == whole.recordings.end())
                    whole.recordings.push_back(std::move(r));
                else
                    append(*same, std::move(r));
            }
        }
        if (group.files.size() > 1)
            notes_.push_back(fmt::format("{}: {} files of {} sensors, of the same time by their "
                                         "dates.",
                                         whole.name, group.files.size(), whole.recordings.size()));
        std::ranges::sort(whole.recordings, {}, id_of);
        take_parts(std::move(whole));
    }
    static unsigned id_of(const Recording& r) { return r.info.id; }

    void take_parts(Passage&& whole) {
        double begin = HUGE_VAL, end = -HUGE_VAL;
        for (const Recording& r : whole.recordings)
            begin = std::min(begin, r.time.front()), end = std::max(end, r.time.back());
        const double after = end + 1; // the last sample is within
        std::vector<Burst> parts{{begin, after}};
        if (!cutting_.every_recording_holds_a_train) {
            const Bursts bursts = bursts_in(whole.recordings, cutting_.quiet);
            const bool is_long = end - begin > cutting_.long_file;
            if (bursts.all.empty())
                notes_.push_back(fmt::format("{}: nothing stands out from its own noise; it is "
                                             "taken as one passage.",
                                             whole.name));
            else if (bursts.all.size() > 1 || is_long)
                parts = bursts.all;
            if (bursts.too_short > 0)
                notes_.push_back(fmt::format("{}: {} bursts shorter than 0.5 s are no trains.",
                                             whole.name, bursts.too_short));
            if (parts.front().end != after)
                notes_.push_back(fmt::format("{}: {} passages in {:.4g} s; the rest is left out.",
                                             whole.name, parts.size(), end - begin));
        }
        const bool is_cut = parts.front().end != after;
        for (std::size_t k = 0; k < parts.size(); ++k) {
            Passage part{.name = is_cut ? fmt::format("{}_{:02}", whole.name, k + 1) : whole.name,
                         .recordings = {}};
            const double from = std::max(begin, parts[k].begin - (is_cut ? cutting_.margin : 0));
            for (const Recording& r : whole.recordings)
                part.recordings.push_back(
                    cut(r, from, parts[k].end + (is_cut ? cutting_.margin : 0)));
            take_(std::move(part));
        }
    }

    const LoggerSettings& settings_;
    const PassageCutting& cutting_;
    std::string option_;
    const std::function<void(Passage&&)>& take_;
    std::vector<std::string>& notes_;
    std::vector<Logged> files_;
    std::set<std::string> names_;
};

} // namespace

std::vector<fs::path> logger_files(const std::vector<fs::path>& files_or_folders,
                                   const std::string& option) {
    std::vector<fs::path> files;
    for (const fs::path& path : files_or_folders) {
        if (!fs::is_directory(path)) {
            files.push_back(path);
            continue;
        }
        std::vector<fs::path> found;
        std::error_code error;
        for (fs::recursive_directory_iterator it(path, error), end; !error && it != end;
             it.increment(error))
            if (it->is_regular_file() && is_of_logger(it->path())) found.push_back(it->path());
        if (error)
            throw OutputError(fmt::format("{}: cannot read folder '{}'", option, path.string()));
        std::ranges::sort(found);
        files.insert(files.end(), found.begin(), found.end());
    }
    std::vector<std::string> names;
    for (const fs::path& path : files_or_folders) names.push_back("'" + path.string() + "'");
    require(!files.empty(), fmt::format("{}: expected files of a logger that end with csv, txt, "
                                        "tsv or log in {}, found none",
                                        option, listed(names)));
    return files;
}

void for_each_logged_passage(const std::vector<fs::path>& files_or_folders,
                             const LoggerSettings& settings, const PassageCutting& cutting,
                             const std::string& option, const std::function<void(Passage&&)>& take,
                             std::vector<std::string>& notes) {
    LoggedPassages(settings, cutting, option, take, notes)
        .read(logger_files(files_or_folders, option));
}

} // namespace bris
