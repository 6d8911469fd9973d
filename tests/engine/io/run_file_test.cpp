#include "engine/errors.hpp"
#include "engine/io/run_file.hpp"
#include "engine/version.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <fcntl.h>
#include <numeric>
#include <sys/file.h>
#include <unistd.h>

using namespace bris;

namespace {

constexpr std::uint8_t vertex = 1, quad = 9;

/// Writes frames of one set of rocks and quads in which every number encodes its time, rock and
/// component.
void write_frames(RunFile& run, std::size_t rocks, std::size_t quads, double from, int count) {
    std::vector<std::int64_t> id(rocks);
    std::iota(id.begin(), id.end(), std::int64_t{100});
    const std::vector<float> radius(rocks, static_cast<float>(rocks));
    run.begin_part(rocks, quads, {{.name = "id", .values = id}},
                   {{.name = "radius", .components = 1, .values = radius}});
    for (int k = 0; k < count; ++k) {
        const double time = from + k;
        const std::vector<Vec3> corners(4 * quads, Vec3(-time, 0, 0));
        std::vector<float> centres, velocity;
        for (std::size_t i = 0; i < rocks; ++i) {
            append_vector(centres, Vec3(time, static_cast<double>(i), 0.5));
            for (const float axis : {0.0f, 0.25f, 0.5f})
                velocity.push_back(static_cast<float>(time) + axis);
        }
        run.begin_frame(centres, corners);
        run.put_field({.name = "velocity", .components = 3, .values = velocity});
        run.end_frame(time);
    }
}

/// Reads a frame by the rules of the format: the starts of its part and its arrays are looked up
/// per step.
struct Reader {
    explicit Reader(const std::filesystem::path& path) : file(Hdf5File::open(path)) {}

    template <class T>
    std::vector<T> all(const std::string& name) const {
        return file.read<T>("/VTKHDF/" + name);
    }
    std::int64_t step_value(const std::string& name, std::size_t step) const {
        return all<std::int64_t>("Steps/" + name)[step];
    }
    template <class T>
    std::vector<T> rows(const std::string& name, std::int64_t start, std::int64_t count) const {
        const auto values = all<T>(name);
        const auto shape = file.shape("/VTKHDF/" + name);
        const auto width = static_cast<std::int64_t>(shape.size() > 1 ? shape[1] : 1);
        REQUIRE((start + count) * width <= static_cast<std::int64_t>(values.size()));
        return {values.begin() + start * width, values.begin() + (start + count) * width};
    }

    void check_frame(std::size_t step, std::size_t rocks, std::size_t quads) const {
        CAPTURE(step);
        const double time = all<double>("Steps/Values")[step];
        CHECK(step_value("NumberOfParts", step) == 1);
        const auto part = step_value("PartOffsets", step);
        const auto at = static_cast<std::size_t>(part);
        const auto points = all<std::int64_t>("NumberOfPoints")[at];
        const auto cells = all<std::int64_t>("NumberOfCells")[at];
        const auto ids = all<std::int64_t>("NumberOfConnectivityIds")[at];
        CHECK(points == static_cast<std::int64_t>(rocks + 4 * quads));
        CHECK(cells == static_cast<std::int64_t>(rocks + quads));

        // each earlier part has one entry more in Offsets than it has cells
        const auto first_cell = step_value("CellOffsets", step);
        const auto offsets = rows<std::int64_t>("Offsets", first_cell + part, cells + 1);
        const auto types = rows<std::uint8_t>("Types", first_cell, cells);
        const auto connectivity =
            rows<std::int64_t>("Connectivity", step_value("ConnectivityIdOffsets", step), ids);
        CHECK(offsets.front() == 0);
        CHECK(offsets.back() == ids);
        for (std::size_t i = 0; i < types.size(); ++i) {
            CHECK(types[i] == (i < rocks ? vertex : quad));
            CHECK(offsets[i + 1] - offsets[i] == (i < rocks ? 1 : 4));
        }
        for (std::size_t i = 0; i < connectivity.size(); ++i)
            CHECK(connectivity[i] == static_cast<std::int64_t>(i));

        const auto x = rows<float>("Points", step_value("PointOffsets", step), points);
        const auto data = [&](const std::string& name) {
            return step_value("PointDataOffsets/" + name, step);
        };
        const auto velocity = rows<float>("PointData/velocity", data("velocity"), points);
        const auto radius = rows<float>("PointData/radius", data("radius"), points);
        const auto id = rows<std::int64_t>("PointData/id", data("id"), points);
        for (std::size_t i = 0; i < static_cast<std::size_t>(points); ++i) {
            const bool rock = i < rocks;
            CHECK(x[3 * i] == static_cast<float>(rock ? time : -time));
            CHECK(velocity[3 * i + 1] == (rock ? static_cast<float>(time) + 0.25f : 0.0f));
            CHECK(radius[i] == (rock ? static_cast<float>(rocks) : 0.0f));
            CHECK(id[i] == (rock ? static_cast<std::int64_t>(100 + i) : -1));
        }
    }

    Hdf5File file;
};

} // namespace

TEST_SUITE("engine/io/run_file") {
    TEST_CASE(
        "every frame is found at the offsets of its step, also when the set of rocks changes") {
        const TemporaryDirectory directory;
        {
            RunFile run(directory / "run.vtkhdf");
            write_frames(run, 50, 6, 0, 3);
            write_frames(run, 70, 6, 3, 2);
            write_frames(run, 40, 0, 5, 1);
            CHECK(run.frames() == 6);
            run.close();
        }
        const Reader reader(directory / "run.vtkhdf");
        CHECK(reader.file.text_attribute("/VTKHDF", "Type") == "UnstructuredGrid");
        CHECK(reader.file.attribute<std::int64_t>("/VTKHDF", "Version") ==
              std::vector<std::int64_t>{2, 0});
        CHECK(reader.file.attribute<std::int64_t>("/VTKHDF/Steps", "NSteps") ==
              std::vector<std::int64_t>{6});
        CHECK(reader.file.shape("/VTKHDF/Steps/CellOffsets") == Hdf5File::Shape{6, 1});
        for (std::size_t step = 0; step < 3; ++step) reader.check_frame(step, 50, 6);
        for (std::size_t step = 3; step < 5; ++step) reader.check_frame(step, 70, 6);
        reader.check_frame(5, 40, 0);
    }

    TEST_CASE("data that do not change are written once per set of rocks") {
        const TemporaryDirectory directory;
        {
            RunFile run(directory / "run.vtkhdf");
            write_frames(run, 10, 1, 0, 5);
        }
        const Reader reader(directory / "run.vtkhdf");
        CHECK(reader.all<float>("PointData/radius").size() == 14);
        CHECK(reader.all<std::int64_t>("Connectivity").size() == 14);
        CHECK(reader.all<float>("Points").size() == 5 * 14 * 3);
        CHECK(reader.all<std::int64_t>("Steps/PartOffsets") == std::vector<std::int64_t>(5, 0));
    }

    TEST_CASE("settings and time series are stored beside the frames") {
        const TemporaryDirectory directory;
        {
            RunFile run(directory / "run.vtkhdf");
            run.add_meta({{"seed", std::uint64_t{7}},
                          {"law", "linear"},
                          {"pressure_Pa", 55e3},
                          {"membrane", true}});
            run.add_track("energy", {{"time", "s"}, {"kinetic", "J"}});
            for (int i = 0; i < 1000; ++i)
                run.add_row("energy", std::vector<double>{0.5 * i, 2.0 * i});
            CHECK_THROWS_AS(run.add_row("energy", std::vector<double>{1}), std::logic_error);
        }
        const Hdf5File file = Hdf5File::open(directory / "run.vtkhdf");
        CHECK(file.attribute<std::uint64_t>("/meta", "seed") == std::vector<std::uint64_t>{7});
        CHECK(file.text_attribute("/meta", "law") == "linear");
        for (const NamedValue& entry : version_entries()) // of every run file, without asking
            CHECK(file.text_attribute("/meta", entry.key) == std::get<std::string>(entry.value));
        CHECK(file.attribute<double>("/meta", "pressure_Pa") == std::vector<double>{55e3});
        CHECK(file.attribute<std::uint8_t>("/meta", "membrane") == std::vector<std::uint8_t>{1});
        const auto kinetic = file.read<double>("/tracks/energy/kinetic");
        REQUIRE(kinetic.size() == 1000);
        CHECK(kinetic[999] == 1998);
        CHECK(file.text_attribute("/tracks/energy/kinetic", "unit") == "J");
    }

    TEST_CASE("all frames so far are on disk while the run continues") {
        const TemporaryDirectory directory;
        RunFile run(directory / "run.vtkhdf");
        write_frames(run, 10, 0, 0, 2);
        // as after a crash: the file is never closed
        std::filesystem::copy_file(directory / "run.vtkhdf", directory / "copy.vtkhdf");
        const Reader reader(directory / "copy.vtkhdf");
        CHECK(reader.file.attribute<std::int64_t>("/VTKHDF/Steps", "NSteps") ==
              std::vector<std::int64_t>{2});
        reader.check_frame(1, 10, 0);
    }

    TEST_CASE("other programs can read a file that is being written, but not write it") {
        const TemporaryDirectory directory;
        RunFile run(directory / "run.vtkhdf");
        // HDF5 locks the files that it opens, for reading or for writing
        const int other = open((directory / "run.vtkhdf").c_str(), O_RDWR);
        REQUIRE(other >= 0);
        CHECK(flock(other, LOCK_SH | LOCK_NB) == 0);
        CHECK(flock(other, LOCK_EX | LOCK_NB) != 0);
        close(other);
    }

    TEST_CASE("a frame that does not match the declared cells or fields is a programming error") {
        const TemporaryDirectory directory;
        RunFile run(directory / "run.vtkhdf");
        const std::vector<float> centres(9), values(3);
        CHECK_THROWS_AS(run.begin_frame(centres, {}), std::logic_error);
        run.begin_part(3, 0, {});
        run.begin_frame(centres, {});
        run.put_field({"speed", 1, values});
        run.end_frame(0);
        CHECK_THROWS_AS(run.end_frame(1), std::logic_error);
        run.begin_frame(centres, {});
        CHECK_THROWS_AS(run.begin_frame(centres, {}), std::logic_error);
        CHECK_THROWS_AS(run.end_frame(1), std::logic_error); // it has no speed
        CHECK_THROWS_AS(run.begin_frame({}, {}), std::logic_error);
        CHECK_THROWS_AS(run.put_field({"speed", 1, centres}), std::logic_error);
        CHECK_THROWS_AS(run.put_field({"spin", 1, values}), std::logic_error);
    }

    TEST_CASE("a path that is not writable gives an OutputError") {
        CHECK_THROWS_AS(RunFile("/proc/none/run.vtkhdf"), OutputError);
    }
}
