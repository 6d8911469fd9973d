#include "engine/random.hpp"
#include "scenarios/sensors/channels.hpp"
#include "tests/about.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <set>

using namespace bris;

namespace {

/// A recording with one sample of every channel, whose sensor stands askew and uses the unit
/// `number` of each channel, as far as metadata can state it.
Recording recording_of_all(std::size_t number) {
    Recording r;
    r.info.id = 3;
    r.info.force_unit = std::array{"m/s2", "g"}[number % 2];
    r.info.rate_unit = std::array{"rad/s", "deg/s"}[number % 2];
    r.info.field_unit = std::array{"T", "mT", "uT", "nT", "G", "mG"}[number];
    r.info.temperature_unit = std::array{"K", "C", "F"}[number % 3];
    const Quat askew = Random(6, 1).rotation();
    std::tie(r.info.mounting_w, r.info.mounting_x, r.info.mounting_y, r.info.mounting_z) =
        std::tuple(askew.w(), askew.x(), askew.y(), askew.z());
    r.time = {0.5};
    for (const Channel& channel : all_channels)
        channel.append(r, std::array{1.0, 0.25, 0.5, 0.125}.data());
    r.flags = {0}; // else the sample would be left out
    return r;
}

} // namespace

TEST_SUITE("sensors/channels") {
    TEST_CASE("every column has a name of its own, and leads to its channel and place") {
        std::set<std::string_view> names, datasets;
        std::size_t place = 0;
        for (const Channel& channel : all_channels) {
            CHECK(&channel_of(channel.series) == &channel);
            CHECK(channel.place == place);
            CHECK(datasets.insert(channel.names.dataset).second);
            for (std::size_t k = 0; k < channel.size(); ++k) {
                CHECK(channel_columns[place++] == channel.column(k));
                CHECK(channel_with(channel.column(k)) == &channel);
                CHECK(names.insert(channel.column(k)).second);
            }
        }
        CHECK(place == channel_columns.size());
        CHECK(channel_with("a") == nullptr);
        CHECK(channel_with("") == nullptr);
        CHECK(channel_of(&Recording::attitude).column(3) == "qz");
    }

    TEST_CASE("a sample has the same numbers in a file after it was read, in every unit") {
        for (std::size_t number = 0; number < 6; ++number) {
            const Recording r = recording_of_all(number);
            for (const Channel& channel : all_channels) {
                REQUIRE(channel.samples(r) == 1);
                const auto numbers = channel.in_file(r, 0);
                for (std::size_t k = 0; k < channel.size() && !channel.is_count(); ++k)
                    CHECK(numbers[k] == about(std::array{1.0, 0.25, 0.5, 0.125}[k]));
            }
        }
    }

    TEST_CASE("files keep every channel but the flags") {
        const TemporaryDirectory directory;
        const Recording r = recording_of_all(4);
        write_recordings(directory / "a.csv", {r}, {});
        write_recordings_hdf5(directory / "a.h5", {r});
        for (const Recording& read : {read_recordings(directory / "a.csv", {r.info})[0],
                                      read_recordings_hdf5(directory / "a.h5", {r.info})[0]}) {
            CHECK(read.unused.empty());
            for (const Channel& channel : all_channels)
                CHECK(channel.samples(read) == (channel.is(Channel::unwritten) ? 0 : 1));
        }
    }
}
