#include "scenarios/stream/sensor_payload.hpp"

#include "engine/errors.hpp"
#include "scenarios/sensors/channels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace bris {

namespace {

static_assert(std::endian::native == std::endian::little && std::numeric_limits<float>::is_iec559);

constexpr std::uint8_t version = 1;
constexpr double latest_time = 1e11, longest_interval = 3600; // s

template <class T>
T number_at(std::string_view bytes, std::size_t place) {
    T number;
    std::memcpy(&number, bytes.data() + place, sizeof number);
    return number;
}

template <class T>
void append(std::string& bytes, T number) {
    std::array<char, sizeof number> raw;
    std::memcpy(raw.data(), &number, sizeof number);
    bytes.append(raw.data(), raw.size());
}

} // namespace

std::vector<std::string> SensorPayload::columns() const {
    std::vector<std::string> names;
    for (int bit = 0; bit < 8; ++bit) {
        const auto sent = std::ranges::find(all_channels, bit, &Channel::payload_bit);
        if ((channels >> bit & 1) == 0 || sent == all_channels.end()) continue;
        for (std::size_t k = 0; k < sent->size(); ++k) names.emplace_back(sent->column(k));
    }
    return names;
}

std::size_t SensorPayload::samples() const {
    return channels == 0 ? 0 : numbers.size() / columns().size();
}

SensorPayload parse_sensor_payload(std::string_view bytes) {
    require(bytes.size() >= SensorPayload::header,
            fmt::format("expected a payload of at least {} bytes, found {}", SensorPayload::header,
                        bytes.size()));
    const auto found_version = number_at<std::uint8_t>(bytes, 0);
    require(found_version == version,
            fmt::format("expected version {} of the payload, found {}", version, found_version));
    SensorPayload p;
    p.channels = number_at<std::uint8_t>(bytes, 1);
    require(p.channels != 0, "expected at least one channel, found none");
    const std::size_t samples = number_at<std::uint16_t>(bytes, 2), columns = p.columns().size();
    require(samples >= 1 && samples <= SensorPayload::most_samples,
            fmt::format("expected 1 to {} samples in a message, found {}",
                        SensorPayload::most_samples, samples));
    const std::size_t expected = SensorPayload::header + 4 * samples * columns;
    require(bytes.size() == expected,
            fmt::format("expected {} bytes for {} samples of {} columns, found {}", expected,
                        samples, columns, bytes.size()));
    p.sequence = number_at<std::uint32_t>(bytes, 4);
    p.time = number_at<double>(bytes, 8);
    p.interval = number_at<float>(bytes, 16);
    require(std::abs(p.time) < latest_time, // not a NaN either
            fmt::format("expected a time within {:g} s, found {}", latest_time, p.time));
    require(
        p.interval >= 0 && static_cast<double>(p.interval) <= longest_interval,
        fmt::format("expected an interval of 0 to {:g} s, found {}", longest_interval, p.interval));
    p.numbers.resize(samples * columns);
    std::memcpy(p.numbers.data(), bytes.data() + SensorPayload::header, 4 * p.numbers.size());
    return p;
}

std::string bytes_of(const SensorPayload& p) {
    std::string bytes;
    append(bytes, version);
    append(bytes, p.channels);
    append(bytes, static_cast<std::uint16_t>(p.samples()));
    append(bytes, p.sequence);
    append(bytes, p.time);
    append(bytes, p.interval);
    for (const float number : p.numbers) append(bytes, number);
    return bytes;
}

std::vector<std::string> stream_lines(unsigned id, const SensorPayload& p) {
    const auto columns = p.columns();
    std::vector<std::string> lines;
    for (std::size_t k = 0; k < p.samples(); ++k) {
        std::string line =
            fmt::format("{{\"t\": {}, \"id\": {}, \"seq\": {}",
                        p.time + static_cast<double>(k) * static_cast<double>(p.interval), id,
                        p.sequence + static_cast<std::uint32_t>(k));
        for (std::size_t c = 0; c < columns.size(); ++c)
            if (const float number = p.numbers[k * columns.size() + c]; std::isfinite(number))
                line += fmt::format(", \"{}\": {}", columns[c], number);
        lines.push_back(line + "}");
    }
    return lines;
}

} // namespace bris
