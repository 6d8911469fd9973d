#include "engine/run_page.hpp"

#include "engine/io/html_page.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/printable.hpp"
#include "engine/ranks.hpp"
#include "engine/version.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <string_view>
#include <tuple>
#include <utility>

namespace bris {

namespace fs = std::filesystem;

namespace {

constexpr auto page_name = "report.html";
constexpr std::size_t most_pictures = 64, most_files = 100;
constexpr std::size_t most_seen = 10'000; // a folder may be one in which much else lies
constexpr int deepest = 2;                // of subfolders

struct ResultFile {
    std::string name; ///< seen from the folder of the results
    std::uintmax_t bytes;
    bool is_new; ///< written by this run
};

/// The files of the results, by name; those of subfolders behind them, of 55kPa before 110kPa.
std::vector<ResultFile> files_of(const Common& common) {
    // a file system's clock may be a tick behind that of the machine
    const auto since = common.began - std::chrono::seconds(1);
    std::vector<ResultFile> files;
    std::error_code error; // a file that is gone or may not be seen is left out
    const auto options = fs::directory_options::skip_permission_denied;
    for (auto at = fs::recursive_directory_iterator(common.out, options, error);
         !error && at != fs::recursive_directory_iterator() && files.size() < most_seen;
         at.increment(error)) {
        if (at.depth() >= deepest) at.disable_recursion_pending();
        std::error_code gone;
        if (!at->is_regular_file(gone)) continue;
        const std::string name = at->path().lexically_relative(common.out).generic_string();
        const std::uintmax_t bytes = at->file_size(gone);
        const auto written = at->last_write_time(gone);
        if (!gone && name != page_name) files.push_back({name, bytes, written >= since});
    }
    std::ranges::sort(files, {}, [](const ResultFile& file) {
        const std::string folder = file.name.substr(0, file.name.find_last_of('/') + 1);
        return std::tuple(std::ranges::count(folder, '/'), folder.size(), file.name);
    });
    return files;
}

const char* meaning_of(std::string_view name) {
    struct Kind {
        std::string_view ending;
        const char* meaning;
    };
    for (const auto& [ending, meaning] : {Kind{"summary.json", "all numbers and settings"},
                                          {".vtkhdf", "motion, for ParaView"},
                                          {".vdb", "voxels, for ParaView or Blender"},
                                          {".csv", "table"},
                                          {".png", "picture"},
                                          {".html", "page"},
                                          {".xdmf", "motion, for older ParaView"},
                                          {".ckpt.h5", "state, for --resume"},
                                          {".h5", "numbers in HDF5"}})
        if (name.ends_with(ending)) return meaning;
    return "";
}

std::string size_of(std::uintmax_t bytes) {
    const auto size = static_cast<double>(bytes);
    return size < 1e3   ? fmt::format("{} bytes", bytes)
           : size < 1e6 ? fmt::format("{:.3g} kB", size / 1e3)
                        : fmt::format("{:.3g} MB", size / 1e6);
}

/// Whether a number is shown with its band (three_digits).
bool has_band(const Report::Table& table) {
    for (const auto& row : table)
        for (const std::string& cell : row)
            if (cell.find(" to ") < cell.find(')') && cell.find(')') < cell.size()) return true;
    return false;
}

void add_answer(HtmlPage& page, const Report& results) {
    page.heading("The answer");
    const Report::Table parts = results.table_of_parts();
    if (!parts.empty()) page.table(parts);
    Report::Table whole = results.table_of_whole();
    whole.insert(whole.begin(), {"result", "value"});
    if (whole.size() > 1) page.table(whole);
    page.heading("How far to trust it");
    for (const std::string& sentence : results.sentences()) page.paragraph(printable(sentence));
    const bool has_bands = has_band(parts) || has_band(whole);
    if (has_bands) page.paragraph("Numbers in parentheses are the band of the one before them.");
    if (!has_bands && results.sentences().empty())
        page.paragraph("The run states neither a band nor limits of these numbers. One run cannot "
                       "tell how much another --seed would change them.");
}

void add_pictures(HtmlPage& page, const Common& common, const std::vector<ResultFile>& files) {
    std::size_t pictures = 0;
    for (const ResultFile& file : files) {
        if (!file.is_new || !file.name.ends_with(".png") || ++pictures > most_pictures) continue;
        if (pictures == 1) page.heading("Pictures");
        page.picture(printable(file.name), read_whole(common.out / file.name));
    }
    if (pictures > most_pictures)
        page.paragraph(fmt::format("{} more pictures are in the folder of the results.",
                                   pictures - most_pictures));
}

void add_files(HtmlPage& page, const std::vector<ResultFile>& files) {
    page.heading("Files");
    std::vector<std::pair<std::string, std::string>> links;
    for (const ResultFile& file : files) {
        if (links.size() == most_files) break;
        links.emplace_back(file.name,
                           fmt::format("{}{}{}{}", meaning_of(file.name),
                                       *meaning_of(file.name) != 0 ? ", " : "", size_of(file.bytes),
                                       file.is_new ? "" : "; from before this run"));
    }
    page.links(links);
    if (files.size() > most_files)
        page.paragraph(fmt::format("{} more files are in the folder of the results.",
                                   files.size() - most_files));
}

/// A word as a shell reads it.
std::string typed(const std::string& word) {
    constexpr auto plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                           "%+,-./:=@_";
    if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
    std::string text = "'";
    for (const char c : word) text += c == '\'' ? "'\\''" : std::string(1, c);
    return text + "'";
}

void add_changes(HtmlPage& page, const Common& common) {
    page.heading("Settings that differ from the defaults");
    if (common.changes.empty()) return page.paragraph("None.");
    Report::Table rows{{"option", "this run", "default", "meaning (key with its unit)"}};
    const auto shown = [](const std::string& text) {
        return text.empty() ? std::string("-") : printable(text);
    };
    for (const Options::Change& one : common.changes) {
        std::string meaning = one.help.substr(0, one.help.find(". ")); // the first sentence
        if (!meaning.ends_with('.')) meaning += '.';
        std::string name = one.flag.substr(one.flag.find_first_not_of('-'));
        std::ranges::replace(name, '-', '_');
        if (one.key != name) meaning += " (" + one.key + ")";
        rows.push_back({one.flag, shown(one.value), shown(one.initially), meaning});
    }
    page.table(rows);
}

} // namespace

void add_origin(HtmlPage& page, const Common& common) {
    add_changes(page, common);
    page.heading("How to make it again");
    std::string command = "bris run " + common.scenario;
    for (const std::string& word : common.arguments) command += fmt::format(" {}", typed(word));
    page.command(printable(command));
    Report::Table rows{{"part", "version"}};
    rows.push_back({"seed", fmt::format("{}", common.seed)});
    bool is_known = true;
    for (const NamedValue& entry : version_entries()) {
        std::string words = entry.key;
        std::ranges::replace(words, '_', ' ');
        rows.push_back({words, entry.text()});
        if (entry.key == "bris_commit")
            is_known = entry.text() != "unknown" && !entry.text().ends_with("-dirty");
    }
    page.paragraph(
        is_known ? "From a clone of BRIS at this commit it is scenarios/run instead of bris run."
                 : "The sources were not those of a commit, so that another build may differ.");
    page.table(rows);
}

void write_run_page(const Common& common, const Report& results) {
    if (!Ranks::writes()) return;
    HtmlPage page("BRIS: " + common.scenario);
    page.paragraph(common.question);
    const std::vector<ResultFile> files = files_of(common);
    add_answer(page, results);
    add_pictures(page, common, files);
    add_origin(page, common);
    add_files(page, files);
    page.write(common.out / page_name);
}

} // namespace bris
