#include "scenarios/sensors/channels.hpp"

#include <cmath>
#include <type_traits>

namespace bris {

bool are_finite(std::span<const double> numbers) {
    return std::ranges::all_of(numbers, [](double x) { return std::isfinite(x); });
}

std::vector<ColumnUnit> Channel::column_units() const {
    std::vector<ColumnUnit> all;
    for (const ChannelUnit& u : units)
        if (!u.name.empty()) all.push_back({std::string(u.name), u.scale, u.offset});
    return all;
}

const ChannelUnit& Channel::unit_in(const SensorInfo& info) const {
    if (unit == nullptr) return units.front();
    const auto found = std::ranges::find(units, std::string_view(info.*unit), &ChannelUnit::name);
    return found == units.end() ? units.front() : *found;
}

Vec3 Channel::value_of(const SensorInfo& info, const Vec3& in_file) const {
    const double scale = unit_in(info).scale;
    if (!is(turned)) return scale * in_file;
    return scale * (info.mounting() * in_file);
}

std::size_t Channel::samples(const Recording& recording) const {
    return visit(recording, [](const auto& values) { return values.size(); });
}

std::size_t Channel::without_number(const Recording& recording) const {
    return visit(recording, [&](const auto& values) {
        return static_cast<std::size_t>(std::ranges::count_if(
            values, [&](const auto& value) { return !are_finite(components_of(value)); }));
    });
}

void Channel::append(Recording& recording, const double* components) const {
    const double first = *components;
    const SensorInfo& info = recording.info;
    visit(recording, [&](auto& values) {
        using Value = typename std::remove_cvref_t<decltype(values)>::value_type;
        if constexpr (std::is_same_v<Value, Vec3>)
            values.push_back(value_of(info, Vec3(components)));
        else if constexpr (std::is_same_v<Value, Quat>)
            values.emplace_back(components[0], components[1], components[2], components[3]);
        else if constexpr (std::is_same_v<Value, double>)
            values.push_back(from_file != nullptr ? (info.*from_file)(first)
                                                  : unit_in(info).scale * first);
        else
            values.push_back(static_cast<std::uint64_t>(first));
    });
}

std::array<double, 4> Channel::in_file(const Recording& recording, std::size_t sample) const {
    const SensorInfo& info = recording.info;
    const auto [name, scale, offset, back] = unit_in(info);
    return visit(recording, [&](const auto& values) {
        const auto& value = values[sample];
        using Value = std::remove_cvref_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, Vec3>) {
            const Vec3 along = is(turned) ? Vec3(info.mounting().conjugate() * value) : value;
            return components_of(back > 0 ? Vec3(back * along) : Vec3(along / scale));
        } else if constexpr (std::is_same_v<Value, double>) {
            return components_of(to_file != nullptr ? (info.*to_file)(value) : value / scale);
        } else {
            return components_of(value);
        }
    });
}

const Channel* channel_with(std::string_view column) {
    for (const Channel& channel : all_channels)
        for (std::size_t k = 0; k < channel.size(); ++k)
            if (channel.column(k) == column) return &channel;
    return nullptr;
}

std::string names_of_vectors(std::string_view last_separator) {
    std::string text, last;
    for (const Channel& channel : all_channels) {
        if (channel.size() == 1) continue;
        if (!last.empty()) text += (text.empty() ? "" : ", ") + last;
        last = channel.names.columns;
    }
    return text + std::string(last_separator) + last;
}

} // namespace bris
