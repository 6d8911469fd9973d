#include "engine/summary.hpp"

#include "engine/io/whole_file.hpp"
#include "engine/version.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace bris {

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

std::string Summary::json() const {
    auto object = nlohmann::ordered_json::object();
    for (const NamedValue& entry : entries_)
        std::visit([&](const auto& x) { object[entry.key] = x; }, entry.value);
    // a path may contain any bytes; those that are not valid UTF-8 are replaced
    return object.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

void Summary::write(const std::filesystem::path& file) const {
    Summary whole = *this;
    whole.add(version_entries());
    write_whole(file, whole.json());
}

} // namespace bris
