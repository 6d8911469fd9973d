#include "engine/summary.hpp"

#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace bris {

namespace {

std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\')
            out += fmt::format("\\{}", c);
        else if (static_cast<unsigned char>(c) < 0x20)
            out += fmt::format("\\u{:04x}", c);
        else
            out += c;
    }
    return out + "\"";
}

std::string json_of(bool x) { return x ? "true" : "false"; }
std::string json_of(std::int64_t x) { return fmt::format("{}", x); }
std::string json_of(std::uint64_t x) { return fmt::format("{}", x); }
std::string json_of(double x) { return std::isfinite(x) ? fmt::format("{}", x) : "null"; }
std::string json_of(const std::string& x) { return quoted(x); }

std::string shown(bool x) { return x ? "yes" : "no"; }
std::string shown(std::int64_t x) { return fmt::format("{}", x); }
std::string shown(std::uint64_t x) { return fmt::format("{}", x); }
std::string shown(double x) { return fmt::format("{:.6g}", x); }
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
    std::string text = "{";
    for (const NamedValue& entry : entries_)
        text += fmt::format("{}\n  {}: {}", text.size() > 1 ? "," : "", quoted(entry.key),
                            std::visit([](const auto& x) { return json_of(x); }, entry.value));
    return text + "\n}\n";
}

void Summary::print(const std::string& title) const {
    const std::string text = table(title);
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
        throw OutputError(fmt::format("cannot print the results: {}", std::strerror(errno)));
}

void Summary::write(const std::filesystem::path& file) const { write_whole(file, json()); }

} // namespace bris
