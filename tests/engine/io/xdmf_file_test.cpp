#include "engine/io/run_file.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/io/xdmf_file.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <regex>
#include <sstream>

using namespace bris;

namespace {

/// Writes frames of `bodies` bodies and one quad at whole times.
void write_frames(const std::filesystem::path& path, std::size_t bodies, int from, int to) {
    RunFile run(path);
    std::vector<float> radius(bodies, 1), velocity(3 * bodies, 2);
    run.begin_part(bodies, 1, {}, {{"radius", 1, radius, "m"}});
    for (int time = from; time < to; ++time) {
        std::vector<float> centres;
        for (std::size_t k = 0; k < bodies; ++k) append_vector(centres, Vec3(time, 0, 0));
        run.begin_frame(centres, std::vector<Vec3>(4, Vec3(0, time, 0)));
        run.put_field({"velocity", 3, velocity, "m/s"});
        run.end_frame(time);
    }
    run.close();
}

std::vector<double> times_of(const std::string& list) {
    std::vector<double> times;
    const std::regex pattern("<Time Value=\"([^\"]*)\"/>");
    for (std::sregex_iterator at(list.begin(), list.end(), pattern), end; at != end; ++at)
        times.push_back(std::stod((*at)[1]));
    return times;
}

/// One reference to a block of rows of the HDF5 file.
struct Reference {
    std::string file, dataset;
    std::vector<std::uint64_t> start, count;
};

std::vector<Reference> references_of(const std::string& list) {
    std::vector<Reference> all;
    const std::regex pattern("Format=\"XML\">([^<]*)</DataItem><DataItem [^>]*>([^:<]*):([^<]*)<");
    for (std::sregex_iterator at(list.begin(), list.end(), pattern), end; at != end; ++at) {
        std::istringstream numbers((*at)[1].str());
        std::vector<std::uint64_t> slab;
        for (std::uint64_t n = 0; numbers >> n;) slab.push_back(n);
        const auto rank = static_cast<std::ptrdiff_t>(slab.size() / 3);
        all.push_back({(*at)[2],
                       (*at)[3],
                       {slab.begin(), slab.begin() + rank},
                       {slab.end() - rank, slab.end()}});
    }
    return all;
}

} // namespace

TEST_SUITE("engine/io/xdmf_file") {
    TEST_CASE("every frame of a run file is listed, with rows that the file has") {
        const TemporaryDirectory directory;
        write_frames(directory / "run.vtkhdf", 5, 0, 3);
        const std::string list = read_whole(directory / "run.xdmf");
        CHECK(times_of(list) == std::vector<double>{0, 1, 2});
        const auto references = references_of(list);
        REQUIRE(references.size() == 24); // points, cells and two arrays; two blocks; three frames
        const Hdf5File run = Hdf5File::open(directory / "run.vtkhdf");
        double points = 0;
        for (const Reference& one : references) {
            CAPTURE(one.dataset);
            CHECK(one.file == "run.vtkhdf");
            const auto shape = run.shape(one.dataset);
            REQUIRE(one.start.size() == shape.size());
            for (std::size_t axis = 0; axis < shape.size(); ++axis)
                CHECK(one.start[axis] + one.count[axis] <= shape[axis]);
            if (one.dataset != "/VTKHDF/Points") continue;
            const double x = run.read<float>(one.dataset)[3 * one.start[0]];
            points += x * static_cast<double>(one.count[0]);
        }
        CHECK(points == 5 * (0 + 1 + 2)); // the frames show their own bodies; x of quads is 0
    }

    TEST_CASE("the frames of a resumed run go on with the list of the run, and replace those after "
              "its checkpoint") {
        const TemporaryDirectory directory;
        write_frames(directory / "run.vtkhdf", 5, 0, 4);
        write_frames(directory / "run_from_20.vtkhdf", 5, 2, 5);
        const std::string list = read_whole(directory / "run.xdmf");
        CHECK(times_of(list) == std::vector<double>{0, 1, 2, 3, 4});
        CHECK(references_of(list).front().file == "run.vtkhdf");
        CHECK(references_of(list).back().file == "run_from_20.vtkhdf");
        CHECK(!std::filesystem::exists(directory / "run_from_20.xdmf"));

        // the run was killed while it added a frame
        write_whole(directory / "run.xdmf", list.substr(0, list.size() - 200));
        write_frames(directory / "run_from_40.vtkhdf", 5, 4, 6);
        CHECK(times_of(read_whole(directory / "run.xdmf")) ==
              std::vector<double>{0, 1, 2, 3, 4, 5});
        write_frames(directory / "run.vtkhdf", 5, 0, 1); // a run from the start begins a new list
        CHECK(times_of(read_whole(directory / "run.xdmf")) == std::vector<double>{0});
    }

    TEST_CASE("the name of a run file says which run it belongs to, and since when") {
        const auto parts = [](const char* path) { return name_and_part(path); };
        using Parts = std::pair<std::string, std::string>;
        CHECK(parts("out/settle.vtkhdf") == Parts("settle", ""));
        CHECK(parts("out/settle_from_20.vtkhdf") == Parts("settle", "_from_20"));
        CHECK(parts("triaxial_from_stage_7.vtkhdf") == Parts("triaxial", "_from_stage_7"));
        CHECK(parts("run_2.vtkhdf") == Parts("run_2", ""));
        CHECK(parts("from_2.vtkhdf") == Parts("from_2", ""));
        CHECK(parts("7.vtkhdf") == Parts("7", ""));
    }

    TEST_CASE("the arrays of a run file carry their units") {
        const TemporaryDirectory directory;
        write_frames(directory / "run.vtkhdf", 5, 0, 1);
        const Hdf5File run = Hdf5File::open(directory / "run.vtkhdf");
        CHECK(run.text_attribute("/VTKHDF/Points", "unit") == "m");
        CHECK(run.text_attribute("/VTKHDF/Steps/Values", "unit") == "s");
        CHECK(run.text_attribute("/VTKHDF/PointData/velocity", "unit") == "m/s");
        CHECK(run.text_attribute("/VTKHDF/PointData/radius", "unit") == "m");
    }
}
