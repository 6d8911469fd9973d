#include "engine/summary.hpp"

#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/version.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace bris {

namespace {

std::string shown(bool x) { return x ? "yes" : "no"; }
std::string shown(std::int64_t x) { return fmt::format("{}", x); }
std::string shown(std::uint64_t x) { return fmt::format("{}", x); }
std::string shown(double x) { return std::isnan(x) ? "-" : fmt::format("{:.6g}", x); }
std::string shown(const std::string& x) { return x; }

} // namespace

void Summary::add(const NamedValue& entry) {
    const auto found =
        std::find_if(entries_.begin(), entries_.end(),
                     [&](const NamedValue& earlier) { return earlier.key == entry.key; });
    if (found == entries_.end())
        entries_.push_back(entry);
    else
        found->value = entry.value;
}

void Summary::add(const std::vector<NamedValue>& entries) {
    for (const NamedValue& entry : entries) add(entry);
}

std::string Summary::table(const std::string& title) const {
    std::size_t widest = 0;
    for (const NamedValue& entry : entries_) widest = std::max(widest, entry.key.size());
    std::string text = title + "\n";
    for (const NamedValue& entry : entries_)
        text += fmt::format("  {:<{}}  {}\n", entry.key, widest,
                            std::visit([](const auto& x) { return shown(x); }, entry.value));
    return text;
}

std::string Summary::json() const {
    auto object = nlohmann::ordered_json::object();
    for (const NamedValue& entry : entries_)
        std::visit([&](const auto& x) { object[entry.key] = x; }, entry.value);
    // a path may contain any bytes; those that are not valid UTF-8 are replaced
    return object.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

void Summary::print(const std::string& title) const {
    const std::string text = table(title);
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
        throw OutputError(fmt::format("cannot print the results: {}", std::strerror(errno)));
}

void Summary::write(const std::filesystem::path& file) const {
    Summary whole = *this;
    whole.add(version_entries());
    write_whole(file, whole.json());
}

} // namespace bris
