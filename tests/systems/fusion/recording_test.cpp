#include "engine/errors.hpp"
#include "engine/io/hdf5.hpp"
#include "engine/random.hpp"
#include "systems/fusion/recording.hpp"
#include "tests/about.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

using namespace bris;

namespace {

/// Two rocks, the second with its sensor askew and in other units; the first lacks displacement.
std::vector<Recording> two_recordings() {
    std::vector<Recording> all(2);
    for (unsigned id : {1u, 2u}) {
        Recording& r = all[id - 1];
        Random random(5, id);
        r.info.id = id;
        for (std::size_t k = 0; k < 7; ++k) {
            r.time.push_back(0.1 * static_cast<double>(k));
            r.sequence.push_back(k);
            r.strain.push_back(1e-3 * static_cast<double>(k));
            r.force.push_back(random.normal() * random.direction());
            r.rate.push_back(random.normal() * random.direction());
            r.attitude.push_back(random.rotation());
            if (id == 2) r.displacement.push_back(random.direction());
        }
    }
    const Quat askew = Random(6, 1).rotation();
    SensorInfo& info = all[1].info;
    std::tie(info.mounting_w, info.mounting_x, info.mounting_y, info.mounting_z) = std::tuple(askew.w(), askew.x(), askew.y(), askew.z());
    info.force_unit = std::string("g");
    info.rate_unit = "deg/s";
    return all;
}

double apart(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    REQUIRE(a.size() == b.size());
    double most = 0;
    for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, (a[k] - b[k]).norm());
    return most;
}

} // namespace

TEST_SUITE("systems/fusion/recording") {
    TEST_CASE("recordings come back from HDF5 as they were written, in whatever units and however mounted") {
        const TemporaryDirectory directory;
        const auto written = two_recordings();
        write_recordings_hdf5(directory / "a.h5", written);
        const auto read = read_recordings_hdf5(directory / "a.h5", {written[0].info, written[1].info});
        REQUIRE(read.size() == 2);
        for (std::size_t s = 0; s < 2; ++s) {
            CHECK(read[s].time == written[s].time);
            CHECK(read[s].strain == written[s].strain);
            CHECK(read[s].sequence == written[s].sequence);
            CHECK(apart(read[s].force, written[s].force) < 1e-14);
            CHECK(apart(read[s].rate, written[s].rate) < 1e-14);
            CHECK(apart(read[s].displacement, written[s].displacement) == 0);
            REQUIRE(read[s].attitude.size() == 7);
            CHECK(read[s].attitude[3].coeffs() == written[s].attitude[3].coeffs());
        }
        // in the file: the sensor's own units
        CHECK(Hdf5File::open(directory / "a.h5").text_attribute("/sensors/2", "accel_unit") == "g");
        CHECK(Eigen::Vector3d::Map(Hdf5File::open(directory / "a.h5").read<double>("/sensors/2/accel").data()).norm() ==
              about(written[1].force[0].norm() / standard_gravity));
    }

    TEST_CASE("an HDF5 file with a strange id, another shape or damage is refused, and says where") {
        const TemporaryDirectory directory;
        const auto written = two_recordings();
        const auto path = directory / "b.h5";
        write_recordings_hdf5(path, written);
        CHECK_THROWS_WITH_AS((void)read_recordings_hdf5(path, {written[0].info}), doctest::Contains("/sensors/2: expected the id of a metadata file"), InputError);
        CHECK_THROWS_AS((void)read_recordings_hdf5(path, {written[0].info, written[1].info, written[0].info}), InputError);
        {
            Hdf5File file = Hdf5File::open_to_write(path);
            file.remove("/sensors/1/gyro");
            const std::vector<double> few(9, 0.0);
            file.write("/sensors/1/gyro", std::span<const double>(few), {3, 3});
            file.close();
        }
        CHECK_THROWS_WITH_AS((void)read_recordings_hdf5(path, {written[0].info, written[1].info}), doctest::Contains("expected 7 rows of 3 numbers, found 3 of 3"), InputError);
        std::filesystem::resize_file(path, 1000);
        CHECK_THROWS_AS((void)read_recordings_hdf5(path, {written[0].info, written[1].info}), OutputError);
        // a rock without a group was not recorded: intake says so
        write_recordings_hdf5(path, {written[0]});
        CHECK(read_recordings_hdf5(path, {written[0].info, written[1].info})[1].size() == 0);
    }
}
