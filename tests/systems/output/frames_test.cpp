#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "engine/io/hdf5.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/ordering.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/output/contact_list.hpp"
#include "systems/output/frames.hpp"
#include "tests/about.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <algorithm>

using namespace bris;

namespace {

/// A frame of a file with cells of one kind, read by the rules of the format.
struct Grid {
    Grid(const std::filesystem::path& path, std::size_t number_of_step)
        : file(Hdf5File::open(path)), step(number_of_step) {
        const auto part = static_cast<std::size_t>(number("Steps/PartOffsets"));
        points = at("NumberOfPoints", part);
        cells = at("NumberOfCells", part);
        const auto all = file.read<std::int64_t>("/VTKHDF/Connectivity");
        const auto first = number("Steps/ConnectivityIdOffsets");
        corners.assign(all.begin() + first,
                       all.begin() + first + at("NumberOfConnectivityIds", part));
        const auto kinds = file.read<std::uint8_t>("/VTKHDF/Types");
        const auto cell = number("Steps/CellOffsets");
        types.assign(kinds.begin() + cell, kinds.begin() + cell + cells);
        const auto ends = file.read<std::int64_t>("/VTKHDF/Offsets");
        last_offset =
            ends[static_cast<std::size_t>(cell + static_cast<std::int64_t>(part) + cells)];
    }
    std::int64_t at(const std::string& name, std::size_t row) const {
        return file.read<std::int64_t>("/VTKHDF/" + name)[row];
    }
    std::int64_t number(const std::string& name) const { return at(name, step); }
    template <class T>
    std::vector<T> rows(const std::string& name, std::int64_t first, std::int64_t count) const {
        const auto values = file.read<T>("/VTKHDF/" + name);
        const auto shape = file.shape("/VTKHDF/" + name);
        const auto width = static_cast<std::int64_t>(shape.size() > 1 ? shape[1] : 1);
        REQUIRE((first + count) * width <= static_cast<std::int64_t>(values.size()));
        return {values.begin() + first * width, values.begin() + (first + count) * width};
    }
    template <class T>
    std::vector<T> of_cells(const std::string& name) const {
        return rows<T>("CellData/" + name, number("Steps/CellDataOffsets/" + name), cells);
    }
    template <class T>
    std::vector<T> of_points(const std::string& name) const {
        return rows<T>("PointData/" + name, number("Steps/PointDataOffsets/" + name), points);
    }
    std::vector<Vec3> positions() const {
        const auto x = rows<float>("Points", number("Steps/PointOffsets"), points);
        std::vector<Vec3> list;
        for (std::size_t k = 0; k + 2 < x.size(); k += 3)
            list.emplace_back(x[k], x[k + 1], x[k + 2]);
        return list;
    }

    Hdf5File file;
    std::size_t step;
    std::int64_t points = 0, cells = 0, last_offset = 0;
    std::vector<std::int64_t> corners;
    std::vector<std::uint8_t> types;
};

/// Clumps that fall into a box of planes, with a frame before the first step and at two times.
struct Fall {
    explicit Fall(const std::filesystem::path& path, const Extras& extras)
        : simulation(begin(tumbling({.grains = Grains::clumps, .bodies = 30}),
                           {.dt = 2e-5, .law = LawName::linear_viscous})) {
        FrameWriter frames(path, {{"seed", std::uint64_t{1}}}, extras);
        frames.add(simulation.world());
        for (int k = 0; k < 2; ++k) {
            simulation.advance(4000);
            frames.add(simulation.world());
        }
        frames.file().close();
    }
    Simulation simulation;
};

} // namespace

TEST_SUITE("output/frames") {
    TEST_CASE("contacts are lines whose forces move the bodies, in N") {
        const TemporaryDirectory directory;
        const Fall fall(directory / "fall.vtkhdf", {.contacts = true});
        const World& world = fall.simulation.world();
        const Grid grid(directory / "fall_contacts.vtkhdf", 2);
        const auto contacts = contacts_of(world);
        REQUIRE(grid.cells == static_cast<std::int64_t>(contacts.size()));
        REQUIRE(grid.cells > 30);
        CHECK(grid.points == 2 * grid.cells);
        CHECK(grid.last_offset == grid.points);
        CHECK(std::ranges::count(grid.types, 3) == grid.cells); // VTK_LINE

        const auto owner = grid.of_cells<std::int64_t>("owner"),
                   partner = grid.of_cells<std::int64_t>("partner"),
                   kind = grid.of_cells<std::int64_t>("kind");
        const auto normal = grid.of_cells<float>("normal_force"),
                   shear = grid.of_cells<float>("shear_force"),
                   force = grid.of_cells<float>("force"), point = grid.of_cells<float>("point");
        const auto ends = grid.positions();
        const auto rows = rows_by_id(world.column<Bodies, BodyId>());
        const auto position = world.column<Bodies, Position>();
        std::vector<Vec3> sum(rows.size(), Vec3::Zero());
        double largest = 0;
        for (std::size_t k = 0; k < contacts.size(); ++k) {
            const auto a = static_cast<std::size_t>(owner[k]),
                       b = static_cast<std::size_t>(partner[k]);
            const Vec3 f(force[3 * k], force[3 * k + 1], force[3 * k + 2]),
                x(point[3 * k], point[3 * k + 1], point[3 * k + 2]);
            sum[a] += f;
            sum[b] -= f;
            largest = std::max(largest, f.norm());
            // numbers of 32 bits
            CHECK(std::hypot(normal[k], shear[k]) == about(f.norm()).epsilon(1e-5));
            CHECK(grid.corners[2 * k] == static_cast<std::int64_t>(2 * k));
            const auto from = static_cast<std::size_t>(grid.corners[2 * k]),
                       to = static_cast<std::size_t>(grid.corners[2 * k + 1]);
            CHECK((ends[from] - position[rows[a]]).norm() < 1e-6);
            CHECK((ends[to] - (kind[k] == 0 ? position[rows[b]] : x)).norm() < 1e-6);
        }
        // the force on a free body is its weight and the forces of its contacts
        const auto total = world.column<Bodies, Force>();
        const auto mass = world.column<Bodies, Mass>();
        const auto motion = world.column<Bodies, MotionOf>();
        const Vec3 gravity = world.resource<Gravity>().value;
        for (std::size_t id = 0; id < rows.size(); ++id) {
            if (motion[rows[id]] != static_cast<std::uint32_t>(Motion::free)) continue;
            CAPTURE(id);
            CHECK((total[rows[id]] - mass[rows[id]] * gravity - sum[id]).norm() < 1e-5 * largest);
        }
        CHECK(grid.file.text_attribute("/VTKHDF/CellData/normal_force", "unit") == "N");
        CHECK(grid.file.text_attribute("/VTKHDF/CellData/shear_force", "unit") == "N");
        CHECK(grid.file.attribute<std::uint64_t>("/meta", "seed") == std::vector<std::uint64_t>{1});
    }

    TEST_CASE("a frame without contacts has no lines, and is a frame all the same") {
        const TemporaryDirectory directory;
        const Fall fall(directory / "fall.vtkhdf", {.contacts = true});
        const Grid first(directory / "fall_contacts.vtkhdf", 0);
        CHECK(first.cells == 0);
        CHECK(first.file.attribute<std::int64_t>("/VTKHDF/Steps", "NSteps") ==
              std::vector<std::int64_t>{3});
        CHECK(first.file.read<double>("/VTKHDF/Steps/Values") ==
              Hdf5File::open(directory / "fall.vtkhdf").read<double>("/VTKHDF/Steps/Values"));
    }

    TEST_CASE("surfaces are triangles that move with their rocks") {
        const TemporaryDirectory directory;
        const Fall fall(directory / "fall.vtkhdf", {.surfaces = true});
        const World& world = fall.simulation.world();
        const auto rows = rows_by_id(world.column<Bodies, BodyId>());
        for (const std::size_t step : {std::size_t{0}, std::size_t{2}}) {
            const Grid grid(directory / "fall_surfaces.vtkhdf", step);
            CHECK(grid.cells == 30 * 1280);
            CHECK(grid.points == 30 * 642);
            CHECK(std::ranges::count(grid.types, 5) == grid.cells); // VTK_TRIANGLE
            if (step == 0) continue;
            const auto id = grid.of_points<std::int64_t>("id");
            const auto corners = grid.positions();
            const auto parent = world.column<Spheres, ParentId>();
            const auto ball = world.column<Spheres, LocalBall>();
            for (std::size_t k = 0; k < corners.size(); k += 100) {
                const Row row = rows[static_cast<std::size_t>(id[k])];
                double nearest = 1;
                for (std::size_t s = 0; s < ball.size(); ++s)
                    if (parent[s] == static_cast<EntityId>(id[k])) {
                        const Vec3 centre =
                            world.column<Bodies, Position>()[row] +
                            world.column<Bodies, Orientation>()[row] * ball[s].centre;
                        nearest = std::min(nearest, (corners[k] - centre).norm() - ball[s].radius);
                    }
                CHECK(std::abs(nearest) < 1e-6); // numbers of 32 bits
            }
            for (const std::int64_t corner : grid.corners)
                REQUIRE((corner >= 0 && corner < grid.points));
        }
    }

    TEST_CASE("surfaces and contacts are listed for older programs, and absent if nobody asks") {
        const TemporaryDirectory directory;
        const Fall asked(directory / "asked.vtkhdf", {.surfaces = true, .contacts = true});
        const Fall not_asked(directory / "other.vtkhdf", {});
        const auto there = [&](const char* name) {
            return std::filesystem::exists(directory / name);
        };
        CHECK(there("other.xdmf"));
        for (const char* extra : {"other_surfaces.vtkhdf", "other_surfaces.xdmf",
                                  "other_contacts.vtkhdf", "other_contacts.xdmf"})
            CHECK(!there(extra));
        const std::string lines = read_whole(directory / "asked_contacts.xdmf"),
                          triangles = read_whole(directory / "asked_surfaces.xdmf");
        CHECK(lines.find("TopologyType=\"Polyline\"") != std::string::npos);
        CHECK(lines.find("Name=\"normal_force\" AttributeType=\"Scalar\" Center=\"Cell\"") !=
              std::string::npos);
        CHECK(lines.find("asked_contacts.vtkhdf:/VTKHDF/CellData/shear_force") !=
              std::string::npos);
        CHECK(triangles.find("TopologyType=\"Triangle\"") != std::string::npos);
        CHECK(triangles.find("asked_surfaces.vtkhdf:/VTKHDF/Points") != std::string::npos);
    }
}
