#include "scenarios/specimens/bed_store.hpp"

#include "engine/archive.hpp"
#include "engine/assets.hpp"
#include "engine/io/checkpoint.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/message.hpp"
#include "engine/ranks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <unistd.h>

namespace bris {

namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t most_bytes = std::uintmax_t{4} << 30; // of all beds of a user

/// The folder of beds in the user's cache; empty if there is none.
fs::path cache_of_user() {
    // the XDG base directory specification asks for absolute paths
    if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache == '/')
        return fs::path(cache) / "bris" / "beds";
    const char* home = std::getenv("HOME");
    return home != nullptr && *home == '/' ? fs::path(home) / ".cache" / "bris" / "beds"
                                           : fs::path();
}

bool concerns_bed(const NamedValue& setting, const std::vector<std::string_view>& may_differ) {
    const auto& always = settings_that_may_differ();
    return std::ranges::count(always, setting.key) + std::ranges::count(may_differ, setting.key) ==
           0;
}

std::uint64_t hash_of(const std::string& text) {
    const std::vector<std::uint8_t> bytes(text.begin(), text.end());
    Archive archive;
    archive.put("text", std::span<const std::uint8_t>(bytes));
    return fingerprint(archive);
}

/// A setting; of a file its content, and nothing of a folder, whose content is in the world.
std::string text_of(const NamedValue& setting) {
    const auto* path = std::get_if<std::string>(&setting.value);
    std::error_code error;
    if (path == nullptr || path->empty() || !fs::exists(*path, error)) return setting.text();
    return fs::is_regular_file(*path, error) ? hexadecimal(hash_of(read_whole(*path))) : "folder";
}

std::uint64_t hash_of_recipe(const Common& common, const Simulation& placed,
                             const std::vector<std::string_view>& may_differ) {
    std::string text = fmt::format("version {}\nscenario {}\nworld {}\n", bed_version,
                                   common.scenario, hexadecimal(fingerprint(placed.snapshot())));
    for (const NamedValue& setting : common.settings)
        if (concerns_bed(setting, may_differ))
            text += fmt::format("{} {}\n", setting.key, text_of(setting));
    return hash_of(text);
}

bool is_whole(const fs::path& bed) {
    std::error_code error;
    if (!fs::exists(bed, error)) return false;
    try {
        (void)read_checkpoint(bed);
        return true;
    } catch (const std::exception& damaged) {
        say(fmt::format("warning: the bed is made again: {}", damaged.what()));
        return false;
    }
}

/// Removes the beds that were used least recently until the rest fits.
void make_room(const fs::path& folder) {
    std::vector<fs::directory_entry> beds;
    std::uintmax_t bytes = 0;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().filename().string().ends_with(".ckpt.h5")) {
            beds.push_back(entry);
            bytes += entry.file_size();
        }
    std::ranges::sort(beds, {}, [](const auto& bed) { return bed.last_write_time(); });
    for (std::size_t k = 0; k < beds.size() && bytes > most_bytes; ++k) {
        bytes -= beds[k].file_size();
        fs::remove(beds[k].path());
    }
}

} // namespace

BedStore::BedStore(const Common& common, const Simulation& placed, const std::string& kind,
                   const std::vector<std::string_view>& may_differ)
    : from_(common.resume), asked_(!common.beds.empty()) {
    if (!from_.empty() || common.beds == "none") return;
    const fs::path folder = common.beds.empty() ? cache_of_user() : common.beds;
    const std::string file =
        fmt::format("{}_{}.ckpt.h5", kind, hexadecimal(hash_of_recipe(common, placed, may_differ)));
    for (const fs::path& place : {folder, assets_folder() / "beds"})
        if (from_.empty() && !place.empty() && is_whole(place / file)) from_ = place / file;
    if (Ranks::any(from_.empty())) {
        from_.clear();
        if (!folder.empty()) kept_ = folder / file;
        return;
    }
    std::error_code error; // of assets that cannot be written to
    fs::last_write_time(from_, fs::file_time_type::clock::now(), error);
}

void BedStore::keep(const fs::path& checkpoint) const {
    if (kept_.empty() || !Ranks::writes()) return;
    const fs::path folder = kept_.parent_path();
    try {
        fs::create_directories(folder);
        const fs::path copy = folder / fmt::format(".{}.{}", getpid(), kept_.filename().string());
        fs::copy_file(checkpoint, copy, fs::copy_options::overwrite_existing);
        fs::rename(copy, kept_);
        make_room(folder);
    } catch (const fs::filesystem_error& error) {
        if (asked_) say(fmt::format("warning: --beds: the bed is not kept: {}", error.what()));
    }
}

} // namespace bris
