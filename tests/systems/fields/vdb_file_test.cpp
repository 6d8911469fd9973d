#include "engine/io/hdf5.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/random.hpp"
#include "systems/fields/image_file.hpp"
#include "systems/fields/initial_fouling.hpp"
#include "systems/fields/vdb_file.hpp"
#include "tests/support.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <fstream>

using namespace bris;
using namespace bris::testing;

namespace {

struct Sample {
    VoxelBlocks blocks;
    VoxelField values, shown;
};

Sample sample(double size = 0.01, int voxels = 20) {
    const Lattice lattice{Vec3(0.1, -0.2, 0.003), size};
    const Box3 box{lattice.origin - Vec3::Constant(3 * size),
                   lattice.origin + Vec3::Constant((voxels - 3) * size)};
    Sample s{VoxelBlocks(lattice, std::span(&box, 1)), {}, {}};
    s.values = VoxelField(s.blocks);
    s.shown = s.values;
    for (std::uint32_t n = 0; n < s.blocks.voxels(); ++n) {
        const Voxel v = s.blocks.voxel(n);
        s.values[n] = Random(2, n).uniform(0, 5);
        s.shown[n] = v.x >= -3 && v.x < voxels - 3 && v.y >= -3 && v.z >= -3 ? 1 : 0;
    }
    return s;
}

} // namespace

TEST_SUITE("fields/vdb_file") {
    TEST_CASE("a grid is read back exactly, in single precision, with its place and its units") {
        const TemporaryDirectory directory;
        const Sample s = sample();
        const auto file = directory / "fields.vdb";
        write_vdb(file, s.blocks,
                  {{"density", "1", "Fraction of solids.", {&s.values}, &s.shown},
                   {"velocity", "m/s", "Mean.", {&s.values, &s.shown, &s.values}, &s.shown}},
                  1.5, {{"run_id", "0123"}});
        const VdbField read = read_vdb(file, "density");
        CHECK(read.units == "1");
        CHECK(read.quantity == "Fraction of solids.");
        CHECK(read.blocks.lattice().size == doctest::Approx(0.01).epsilon(1e-15));
        CHECK((read.blocks.lattice().origin - s.blocks.lattice().origin).norm() < 1e-15);
        std::size_t compared = 0;
        for (std::uint32_t n = 0; n < s.blocks.voxels(); ++n) {
            if (s.shown[n] == 0) continue;
            const std::uint32_t m = read.blocks.number(s.blocks.voxel(n));
            REQUIRE(m != VoxelBlocks::none);
            REQUIRE(read.values[m] == static_cast<double>(static_cast<float>(s.values[n])));
            ++compared;
        }
        CHECK(compared > 4000);
        CHECK(!find_vdb(file, "saturation"));
    }

    TEST_CASE("unknown grids, vectors, other files and truncated ones are refused in one line") {
        const TemporaryDirectory directory;
        const Sample s = sample();
        const auto file = directory / "fields.vdb";
        write_vdb(file, s.blocks,
                  {{"density", "1", "", {&s.values}, &s.shown},
                   {"velocity", "m/s", "", {&s.values, &s.values, &s.values}, &s.shown}},
                  0, {});
        CHECK(refusal_of([&] { (void)read_vdb(file, "fines"); }) ==
              file.string() + ": expected a grid 'fines', found density, velocity");
        CHECK(refusal_of([&] {
                  (void)read_vdb(file, "velocity");
              }).starts_with(file.string() + ": grid velocity: expected numbers, found"));
        const std::string whole = read_whole(file);
        for (const double share : {0.02, 0.3, 0.6, 0.95}) {
            const auto part = directory / "part.vdb";
            std::ofstream(part, std::ios::binary) << whole.substr(
                0, static_cast<std::size_t>(share * static_cast<double>(whole.size())));
            const std::string text = refusal_of([&] { (void)read_vdb(part, "density"); });
            CAPTURE(share);
            CHECK(text.starts_with(part.string()));
            CHECK(text.find('\n') == std::string::npos);
        }
        std::ofstream(directory / "text.vdb") << "x,y\n1,2\n";
        CHECK(refusal_of([&] {
                  (void)read_vdb(directory / "text.vdb", "density");
              }).find("expected a complete .vdb file") != std::string::npos);
        CHECK_THROWS_AS((void)read_vdb(directory / "none.vdb", "density"), OutputError);
        // missing folders are made, as by all writers, but not below a file
        CHECK_THROWS_AS(write_vdb(directory / "text.vdb" / "fields.vdb", s.blocks, {}, 0, {}),
                        OutputError);
    }

    TEST_CASE("an image has the values in the order x, y, z and the place of its first voxel") {
        const TemporaryDirectory directory;
        Sample s = sample();
        s.shown = VoxelField(s.blocks);
        for (int x = 1; x <= 3; ++x)
            for (int y = 2; y <= 3; ++y)
                for (int z = 4; z <= 8; ++z) s.shown[s.blocks.number({x, y, z})] = 1;
        write_image(directory / "f.vtkhdf", s.blocks,
                    {{"porosity", "1", "", {&s.values}, &s.shown}}, 2, {});
        const Hdf5File file = Hdf5File::open(directory / "f.vtkhdf");
        CHECK(file.text_attribute("/VTKHDF", "Type") == "ImageData");
        CHECK(file.attribute<std::int64_t>("/VTKHDF", "WholeExtent") ==
              std::vector<std::int64_t>{0, 2, 0, 1, 0, 4});
        const auto origin = file.attribute<double>("/VTKHDF", "Origin");
        CHECK(origin[0] == doctest::Approx(0.11));
        CHECK(origin[2] == doctest::Approx(0.043));
        CHECK(file.shape("/VTKHDF/PointData/porosity") == Hdf5File::Shape{5, 2, 3});
        const auto values = file.read<float>("/VTKHDF/PointData/porosity");
        CHECK(values[1] == static_cast<float>(s.values[s.blocks.number({2, 2, 4})]));
        CHECK(values[3] == static_cast<float>(s.values[s.blocks.number({1, 3, 4})]));
        CHECK(values[6] == static_cast<float>(s.values[s.blocks.number({1, 2, 5})]));
    }

    TEST_CASE("fines from a file have its mass, and one that does not cover the rocks is refused") {
        const TemporaryDirectory directory;
        World world = bed({.grains = Grains::clumps, .bodies = 40, .seed = 4});
        add_fouling(world, {.voxel = 5e-3, .samples = 2});
        prepare_voids(world);
        const auto write = [&](double kg_per_m3, double wet, double high) {
            const Lattice lattice{Vec3::Constant(0.005), 0.01};
            const Box3 box{Vec3::Constant(-0.1), Vec3(0.3, 0.3, high)};
            const VoxelBlocks blocks(lattice, std::span(&box, 1));
            VoxelField fines(blocks), water(blocks), shown(blocks);
            for (std::uint32_t n = 0; n < blocks.voxels(); ++n) {
                fines[n] = kg_per_m3;
                water[n] = wet;
                shown[n] = lattice.centre(blocks.voxel(n)).z() < high ? 1 : 0;
            }
            write_vdb(directory / "given.vdb", blocks,
                      {{"fines", "kg/m3", "", {&fines}, &shown},
                       {"saturation", "1", "", {&water}, &shown}},
                      0, {});
        };
        InitialFouling initial{.pattern = InitialFouling::Pattern::file,
                               .file = directory / "given.vdb"};
        write(100, 0.25, 0.5);
        fill_with_fines(world, initial);
        const auto& f = world.resource<Fouling>();
        const BodySpheres bodies = spheres_of_bodies(world);
        double low = 1, high = 0;
        for (std::size_t k = 0; k < bodies.bodies(); ++k)
            if (bodies.has_spheres(k)) {
                low = std::min(low, bodies.box[k].low.z());
                high = std::max(high, bodies.box[k].high.z());
            }
        const Box3 inside = Container(world, unbounded()).bounds();
        const double area = (inside.high.x() - inside.low.x()) * (inside.high.y() - inside.low.y());
        CHECK(f.fines.sum() == doctest::Approx(100 * area * (high - low)).epsilon(1e-3));
        CHECK(measure_fouling(world, f).saturation == doctest::Approx(25).epsilon(0.01));
        write(100, 0.25, 0.02);
        CHECK(refusal_of([&] {
                  fill_with_fines(world, initial);
              }).find("expected voxels that cover the rocks") != std::string::npos);
        write(-1, 0.25, 0.5);
        CHECK(refusal_of([&] {
                  fill_with_fines(world, initial);
              }).find("expected kg/m3 of 0 or more, found -1") != std::string::npos);
        write(100, 1.25, 0.5);
        CHECK(refusal_of([&] {
                  fill_with_fines(world, initial);
              }).find("expected values from 0 to 1, found 1.25") != std::string::npos);
    }
}
