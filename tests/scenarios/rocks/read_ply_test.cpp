#include "engine/errors.hpp"
#include "scenarios/rocks/read_mesh.hpp"
#include "tests/about.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <fstream>

using namespace bris;

namespace {

const std::string head = "comment a rock\nelement vertex 4\nproperty float x\nproperty float y\n"
                         "property float z\nproperty uchar red\nelement face 4\n"
                         "property float quality\nproperty list uchar int vertex_indices\n"
                         "element edge 1\nproperty list short double weights\nend_header\n";
constexpr float corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
constexpr int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

std::string text_ply() {
    return "ply\nformat ascii 1.0\n" + head +
           "0 0 0 255\n1 0 0 7\n0 1 0 7\n0 0 1 7\n"
           "0.5 3 0 2 1\n0.5 3 0 1 3\n0.5 3 0 3 2\n0.5 3 1 2 3\n2 0.5 0.25\n";
}

std::string binary_ply(bool big) {
    std::string bytes =
        "ply\nformat binary_" + std::string(big ? "big" : "little") + "_endian 1.0\n" + head;
    const auto put = [&](auto number) {
        std::string raw(sizeof number, '\0');
        std::memcpy(raw.data(), &number, sizeof number);
        if (big) std::ranges::reverse(raw);
        bytes += raw;
    };
    for (const auto& corner : corners) {
        for (const float x : corner) put(x);
        put(static_cast<unsigned char>(9));
    }
    for (const auto& face : faces) {
        put(0.5f);
        put(static_cast<unsigned char>(3));
        for (const int index : face) put(index);
    }
    put(static_cast<short>(2));
    put(0.5);
    put(0.25);
    return bytes;
}

} // namespace

TEST_SUITE("rocks/read_ply") {
    TEST_CASE("text and binary PLY files of either byte order give the same tetrahedron, and other "
              "properties and elements are skipped") {
        const TemporaryDirectory folder;
        for (const std::string& content : {text_ply(), binary_ply(false), binary_ply(true)}) {
            const auto path = folder / "rock.PLY";
            std::ofstream(path, std::ios::binary) << content;
            const Polyhedron solid = read_mesh(path);
            CHECK(solid.vertices.size() == 4);
            CHECK(mass_properties(solid).volume == about(1.0 / 6).epsilon(1e-14));
        }
    }

    TEST_CASE("a wrong PLY file is refused with the line, or the row of a binary file") {
        const TemporaryDirectory folder;
        const auto message = [&](const std::string& content) {
            std::ofstream(folder / "rock.ply", std::ios::binary) << content;
            std::string text =
                message_of<InputError>([&] { (void)read_mesh(folder / "rock.ply"); });
            return text.substr(text.find("rock.ply"));
        };
        const auto with = [&](std::string content, const std::string& old, const std::string& now) {
            content.replace(content.find(old), old.size(), now);
            return content;
        };
        CHECK(message("solid\n") == "rock.ply:1: PLY: expected \"ply\", found \"solid\"");
        CHECK(message("ply\nformat ascii 1.0\n") ==
              "rock.ply:2: PLY: expected end_header, found the end of the file");
        CHECK(message("ply\nend_header\n") ==
              "rock.ply:2: PLY: expected a line \"format\" in the header, found none");
        CHECK(message(with(text_ply(), "ascii", "binary"))
                  .starts_with("rock.ply:2: PLY: expected "
                               "format ascii, "));
        CHECK(message(with(text_ply(), "float x", "real x"))
                  .starts_with("rock.ply:5: PLY: expected a type such as float"));
        CHECK(message(with(text_ply(), "vertex 4", "vertex 4000000000"))
                  .starts_with("rock.ply:4: PLY: element vertex: expected at most "));
        CHECK(message(with(text_ply(), "1 0 0 7", "1 0 y 7")) ==
              "rock.ply:16: PLY: expected a number, found \"y\"");
        CHECK(message(with(text_ply(), "3 0 3 2", "3 0 4 2")) ==
              "rock.ply:21: PLY: face: expected an index in 0..3, found 4");
        CHECK(message(with(text_ply(), "3 1 2 3", "2 1 2 3")) ==
              "rock.ply:22: PLY: vertex_indices: expected at least three indices, found 2");
        CHECK(message(binary_ply(true).substr(0, 300 + head.size() - 200))
                  .find("expected more data, found the end of the file") != std::string::npos);
    }
}
