#pragma once

#include "engine/io/column_map.hpp"
#include "scenarios/sensors/recording.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace bris {

/// A unit of a channel in files: scale * number + offset is the value in the unit of Recording.
struct ChannelUnit {
    std::string_view name = {};
    double scale = 1, offset = 0;
    double back = 0; ///< factor that gives the number again; 0: divided by the scale
};

/// The word of a text whose words are separated by blanks.
constexpr std::string_view word_of(std::string_view text, std::size_t word) {
    for (; word > 0; --word) text.remove_prefix(text.find(' ') + 1);
    return text.substr(0, text.find(' '));
}
constexpr std::size_t words_in(std::string_view text) {
    return 1 + static_cast<std::size_t>(std::ranges::count(text, ' '));
}

/// What a SmartRock records under one name: a vector, a quaternion, a number or a count for each
/// sample. Readers, writers, checks, plots and live streams handle all channels by these rows.
struct Channel {
    /// Words are separated by blanks.
    struct Names {
        std::string_view columns; ///< in CSV files, streams and findings
        std::string_view dataset; ///< in HDF5 files, where the attribute DATASET_unit has the unit
        /// Usual ones of other makes, in small letters without punctuation, of vectors without the
        /// axis.
        std::string_view titles = {};
    };
    using Series =
        std::variant<std::vector<Vec3> Recording::*, std::vector<Quat> Recording::*,
                     std::vector<double> Recording::*, std::vector<std::uint64_t> Recording::*>;
    enum Trait : std::uint8_t {
        turned = 1,       ///< in files along the axes of the sensor
        sparse = 2,       ///< a sample without a number remains useful, and is not refused
        late = 4,         ///< written to CSV files after the others
        unwritten = 8,    ///< written to no file
        of_test = 16,     ///< tells where in the test a sample is
        unmonitored = 32, ///< not read from the live records of rocks under a track
    };
    /// Its panels in plots: "title (unit)", where a title of "" is the name of the column; the
    /// number of the unit is scale times that of Recording.
    struct Panel {
        std::string_view title = {}, unit = {};
        double scale = 1;
    };

    Names names;
    Series series;
    std::string SensorInfo::*unit = nullptr; ///< unit in the files; null: the first
    /// Units that a column map may give, the one of Recording first. Numbers in a unit of scale 1
    /// and offset 0 keep it; others are converted to the first.
    std::array<ChannelUnit, 6> units = {};
    unsigned traits = 0;
    int payload_bit = -1; ///< in SensorPayload; -1: its messages do not have it
    Panel panel = {};
    /// Conversions between the number of a file and that of Recording which a scale and an offset
    /// would round otherwise; null: by the unit.
    double (SensorInfo::*from_file)(double) const = nullptr;
    double (SensorInfo::*to_file)(double) const = nullptr;
    std::size_t place = 0; ///< of the first column among channel_columns

    constexpr bool is(Trait trait) const { return (traits & trait) != 0; }
    constexpr bool is_count() const {
        return std::holds_alternative<std::vector<std::uint64_t> Recording::*>(series);
    }
    /// Number of components, 1 to 4.
    constexpr std::size_t size() const { return words_in(names.columns); }
    /// Name of the column of a component.
    constexpr std::string_view column(std::size_t component) const {
        return word_of(names.columns, component);
    }
    std::vector<ColumnUnit> column_units() const;

    /// visit(series) of a recording: a vector with a Vec3, Quat, double or std::uint64_t for each
    /// sample, or an empty one.
    auto visit(auto& recording, auto&& visit) const {
        return std::visit([&](auto member) { return visit(recording.*member); }, series);
    }
    std::size_t samples(const Recording& recording) const;
    /// Number of samples with a component that is not finite.
    std::size_t without_number(const Recording& recording) const;
    /// Adds a sample with these components, in the units and axes of files.
    void append(Recording& recording, const double* components) const;
    /// Components of a sample in the units and axes of files.
    std::array<double, 4> in_file(const Recording& recording, std::size_t sample) const;
    /// A vector in the unit and the axes of a file as one in those of Recording.
    Vec3 value_of(const SensorInfo& info, const Vec3& in_file) const;

private:
    const ChannelUnit& unit_in(const SensorInfo& info) const;
};

bool are_finite(std::span<const double> numbers);

/// The components of a Vec3, a Quat (w x y z), a number or a count.
std::array<double, 4> components_of(const auto& value) {
    if constexpr (requires { value.vec(); })
        return {value.w(), value.x(), value.y(), value.z()};
    else if constexpr (requires { value.z(); })
        return {value.x(), value.y(), value.z()};
    else
        return {static_cast<double>(value)};
}

/// All channels besides the time, in the order of messages.
inline constexpr auto all_channels = [] {
    constexpr double g = standard_gravity, degree = pi / 180;
    using enum Channel::Trait;
    auto rows = std::to_array<Channel>({
        {.names = {"seq", "sequence",
                   "seq sequence sequencenumber counter samplecounter packet packetcounter"},
         .series = &Recording::sequence},
        {.names = {"flags", "flags", "flags flag status error"},
         .series = &Recording::flags,
         .traits = unwritten},
        {.names = {"strain", "strain", "strain axialstrain"},
         .series = &Recording::strain,
         .units = {{{"1"}, {"%", 0.01}}},
         .traits = sparse | of_test | unmonitored,
         .payload_bit = 3,
         .panel = {"axial strain", "%", 100}},
        {.names = {"phase", "phase", "phase cycle cycles loadcycle"},
         .series = &Recording::phase,
         .units = {{{"cycles"}, {"deg", 1.0 / 360}, {"rad", 0.5 / pi}}},
         .traits = sparse | late | of_test | unmonitored,
         .panel = {"load cycles"}},
        {.names = {"ax ay az", "accel",
                   "a acc accel acceleration accelerometer force specificforce"},
         .series = &Recording::force,
         .unit = &SensorInfo::force_unit,
         .units = {{{"m/s2"}, {"g", g, 0, 1 / g}, {"mg", 1e-3 * g}}},
         .traits = turned,
         .payload_bit = 0,
         .panel = {"", "m/s2"}},
        {.names = {"gx gy gz", "gyro",
                   "g gyr gyro gyroscope w omega rate angrate angularrate angularvelocity "
                   "rotationrate"},
         .series = &Recording::rate,
         .unit = &SensorInfo::rate_unit,
         .units = {{{"rad/s"},
                    {"mrad/s", 1e-3},
                    {"deg/s", degree, 0, 180 / pi},
                    {"mdeg/s", 1e-3 * degree},
                    {"rpm", 6 * degree}}},
         .traits = turned,
         .payload_bit = 1,
         .panel = {"", "rad/s"}},
        {.names = {"mx my mz", "mag", "m mag magn magnetometer magneticfield field"},
         .series = &Recording::field,
         .unit = &SensorInfo::field_unit,
         .units = {{{"T"}, {"mT", 1e-3}, {"uT", 1e-6}, {"nT", 1e-9}, {"G", 1e-4}, {"mG", 1e-7}}},
         .traits = turned | sparse | late,
         .payload_bit = 2,
         .panel = {"", "uT", 1e6}},
        {.names = {"ux uy uz", "displacement", "u disp displacement"},
         .series = &Recording::displacement,
         .units = {{{"m"}, {"mm", 1e-3}, {"um", 1e-6}}},
         .traits = unmonitored,
         .payload_bit = 4,
         .panel = {"", "mm", 1e3}},
        {.names = {"qw qx qy qz", "quat", "q quat quaternion"},
         .series = &Recording::attitude,
         .payload_bit = 5},
        {.names = {"temp", "temperature", "temp temperature"},
         .series = &Recording::temperature,
         .unit = &SensorInfo::temperature_unit,
         .units = {{{"K"}, {"C", 1, zero_celsius}, {"F", 1 / 1.8, zero_celsius - 32 / 1.8}}},
         .traits = sparse | late,
         .payload_bit = 6,
         .from_file = &SensorInfo::temperature_of,
         .to_file = &SensorInfo::recorded_temperature},
        {.names = {"batt", "battery", "batt battery vbat batteryvoltage batterylevel"},
         .series = &Recording::battery,
         .unit = &SensorInfo::battery_unit,
         .units = {{{"V"}, {"mV", 1e-3}, {"%"}}},
         .traits = sparse | late,
         .payload_bit = 7},
    });
    for (std::size_t c = 1; c < rows.size(); ++c)
        rows[c].place = rows[c - 1].place + rows[c - 1].size();
    return rows;
}();

/// The row of a channel.
constexpr const Channel& channel_of(Channel::Series series) {
    return *std::ranges::find(all_channels, series, &Channel::series);
}

constexpr std::size_t place_of(Channel::Series series) { return channel_of(series).place; }

/// Names of the columns of all channels, one after the other.
inline constexpr auto channel_columns = [] {
    std::array<std::string_view, all_channels.back().place + all_channels.back().size()> names;
    for (const Channel& channel : all_channels)
        for (std::size_t k = 0; k < channel.size(); ++k)
            names[channel.place + k] = channel.column(k);
    return names;
}();

/// Vectors first, then quaternions, numbers and counts: the order of HDF5 files and of plots.
inline constexpr auto channels_by_kind = [] {
    std::array<const Channel*, all_channels.size()> all{};
    for (std::size_t c = 0; c < all.size(); ++c) all[c] = &all_channels[c];
    std::ranges::sort(all, {}, [](const Channel* channel) {
        return std::pair(channel->series.index(), channel); // rows of a kind keep their order
    });
    return all;
}();

/// The channel that has a column; null: none has.
const Channel* channel_with(std::string_view column);

/// The columns of the channels with several components, for messages: "ax ay az, gx gy gz and qw
/// qx qy qz".
std::string names_of_vectors(std::string_view last_separator);

} // namespace bris
