#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/rocks/read_mesh.hpp"
#include "scenarios/rocks/winding.hpp"
#include "tests/about.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <string>

using namespace bris;

namespace {

/// A tube of 120 x 120 quadrilaterals about the curve (cos t, sin(turns t) / turns, 0): a circle
/// for one turn, and for two a figure of eight, where the tube passes through itself at right
/// angles.
std::string tube_obj(int turns, double radius) {
    constexpr int n = 120;
    std::string text;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const double t = 2 * pi * i / n, b = 2 * pi * j / n;
            const Vec3 centre(std::cos(t), std::sin(turns * t) / turns, 0),
                along = Vec3(-std::sin(t), std::cos(turns * t), 0).normalized(),
                out(along.y(), -along.x(), 0);
            const Vec3 v = centre + radius * (std::cos(b) * out + std::sin(b) * Vec3::UnitZ());
            text += fmt::format("v {:.9f} {:.9f} {:.9f}\n", v.x(), v.y(), v.z());
        }
    const auto corner = [](int i, int j) { return i % n * n + j % n + 1; };
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            text += fmt::format("f {} {} {} {}\n", corner(i, j), corner(i + 1, j),
                                corner(i + 1, j + 1), corner(i, j + 1));
    return text;
}

} // namespace

TEST_SUITE("rocks/winding") {
    TEST_CASE("a body with a hole is accepted, one whose surface passes through itself is not") {
        const TemporaryDirectory folder;
        const auto path = folder / "tube.obj";
        write_whole(path, tube_obj(1, 0.2));
        const Polyhedron ring = read_mesh(path);
        CHECK(miscounted_share(ring) == 0);
        CHECK(mass_properties(ring).volume == about(2 * pi * pi * 0.04).epsilon(2e-3));
        write_whole(path, tube_obj(2, 0.2));
        CHECK_THROWS_WITH_AS(
            read_mesh(path),
            doctest::Contains("mesh: expected a surface that does not pass through itself"),
            InputError);
    }

    TEST_CASE("the share that is counted several times is that of the closed form") {
        // Two cubes of side 1 that share a corner region and are joined by nothing else are two
        // pieces, which a reader refuses; their winding number is 2 in the common part.
        Polyhedron both = make_cube(1);
        const Polyhedron other = make_cube(1);
        const std::size_t base = both.vertices.size();
        for (const Vec3& v : other.vertices) both.vertices.push_back(v + Vec3(0.5, 0.25, 0.5));
        for (const auto& [i, j, k] : other.triangles)
            both.triangles.push_back({base + i, base + j, base + k});
        const double common = 0.5 * 0.75 * 0.5;
        // the error of 45 x 45 lines: a row of them at each side of the common part
        CHECK(miscounted_share(both) == about(common / (2 - common)).epsilon(0.1));
        CHECK(miscounted_share(make_rock({}, 3, 1)) == 0);
    }

    TEST_CASE("a byte order mark does not hide the first vertex") {
        const TemporaryDirectory folder;
        const auto path = folder / "tube.obj";
        write_whole(path, "\xef\xbb\xbf" + tube_obj(1, 0.2));
        CHECK(read_mesh(path).vertices.size() == 120 * 120);
    }
}
