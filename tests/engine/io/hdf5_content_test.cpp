#include "engine/errors.hpp"
#include "engine/io/hdf5_content.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/random.hpp"
#include "tests/engine/io/foreign_text.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <cstring>
#include <numeric>

using namespace bris;

namespace {

/// A file with a growing table of 777 rows, text and numbers as attributes.
std::string sample(const std::filesystem::path& path) {
    std::vector<double> values(777);
    std::iota(values.begin(), values.end(), 0.5);
    Hdf5File file = Hdf5File::create(path);
    file.make_growing<double>("/sensors/1/time", {}, 100);
    file.append<double>("/sensors/1/time", values);
    file.write<float>("/sensors/1/accel", std::vector<float>{1, 2, 3, 4, 5, 6}, {2, 3});
    file.write<double>("/other/large", std::vector<double>(1000));
    file.set_attribute("/sensors/1", "name", std::string("sample"));
    file.set_attribute<std::uint32_t>("/sensors/1", "id", 1);
    file.close();
    return read_whole(path);
}

std::string message_of(const std::filesystem::path& path) {
    try {
        (void)Hdf5Content::read(path, {"/sensors"}).numbers("/sensors/1/time");
        return {};
    } catch (const OutputError& error) {
        return error.what();
    }
}

} // namespace

TEST_SUITE("engine/io/hdf5_content") {
    TEST_CASE("the groups of a file are given as arrays of numbers, with their attributes") {
        const TemporaryDirectory directory;
        sample(directory / "a.h5");
        const auto content = Hdf5Content::read(directory / "a.h5", {"/sensors", "/missing"});
        CHECK(content.names("/sensors") == std::vector<std::string>{"1"});
        CHECK(content.names("/sensors/1") == std::vector<std::string>{"accel", "time"});
        CHECK(content.numbers("/sensors/1/time").size() == 777);
        CHECK(content.numbers("/sensors/1/time")[776] == 776.5);
        CHECK(content.shape("/sensors/1/accel") == Hdf5File::Shape{2, 3});
        CHECK(content.numbers("/sensors/1/accel")[5] == 6);
        CHECK(content.text_attribute("/sensors/1", "name") == "sample");
        CHECK(content.attribute("/sensors/1", "id") == std::vector<double>{1});
        CHECK(!content.has("/other")); // not asked for
        CHECK(!content.has("/missing"));
        CHECK_THROWS_WITH_AS((void)content.attribute("/sensors/1", "name"),
                             doctest::Contains("cannot read attribute /sensors/1@name"),
                             OutputError);
        const auto names =
            Hdf5Content::read(directory / "a.h5", {"/sensors"}, Hdf5Content::Datasets::left_out);
        CHECK(names.has("/sensors/1/time"));
        CHECK(names.numbers("/sensors/1/time").empty());
    }

    TEST_CASE("texts as other programs write them are read: of variable length, padded with "
              "blanks, of datasets, and empty ones") {
        using testing::ForeignText;
        const TemporaryDirectory directory;
        const auto path = directory / "a.h5";
        sample(path);
        const auto add = [&](const char* object, const char* name, const char* text,
                             ForeignText kind) {
            testing::set_foreign_text(path, object, name, text, kind);
        };
        add("/sensors/1", "force_unit", "m/s\u00b2", ForeignText::variable);
        add("/sensors/1", "none", "", ForeignText::variable);
        add("/sensors/1", "rate_unit", "deg/s", ForeignText::padded);
        add("/sensors/1/time", "units", "seconds", ForeignText::variable);
        const auto content = Hdf5Content::read(path, {"/sensors"});
        CHECK(content.text_attribute("/sensors/1", "force_unit") == "m/s\u00b2");
        CHECK(content.text_attribute("/sensors/1", "none") == "");
        CHECK(content.text_attribute("/sensors/1", "rate_unit") == "deg/s");
        CHECK(content.text_attribute("/sensors/1", "name") == "sample");
        CHECK(content.text_attribute("/sensors/1/time", "units") == "seconds");
        CHECK(content.attribute_names("/sensors/1") ==
              std::vector<std::string>{"force_unit", "id", "name", "none", "rate_unit"});
        CHECK(content.has_text("/sensors/1", "force_unit"));
        CHECK_FALSE(content.has_text("/sensors/1", "id")); // a number
        CHECK(content.names("/sensors/1") == std::vector<std::string>{"accel", "time"});
    }

    TEST_CASE("a file that is missing or none of HDF5 is refused with the reason") {
        const TemporaryDirectory directory;
        CHECK(message_of(directory / "none.h5").find("No such file") != std::string::npos);
        write_whole(directory / "text.h5", "t,id\n");
        CHECK(message_of(directory / "text.h5").find("cannot open") != std::string::npos);
    }

    TEST_CASE("a small file that claims 4 GB of numbers is refused without taking that memory") {
        const TemporaryDirectory directory;
        std::string bytes = sample(directory / "a.h5");
        const std::uint64_t rows = 777, claimed = std::uint64_t{1} << 29;
        const std::string before(reinterpret_cast<const char*>(&rows), sizeof rows),
            after(reinterpret_cast<const char*>(&claimed), sizeof claimed);
        const auto at = bytes.find(before);
        REQUIRE(at != std::string::npos);
        bytes.replace(at, after.size(), after);
        write_whole(directory / "b.h5", bytes);
        REQUIRE(Hdf5File::open(directory / "b.h5").shape("/sensors/1/time")[0] == claimed);
#ifndef __SANITIZE_THREAD__ // whose allocator does not call the child's limit after a fork
        CHECK(message_of(directory / "b.h5").find("it needs more than 64 MiB of memory") !=
              std::string::npos);
#endif
    }

    TEST_CASE("files with damaged bytes are read or refused, whatever the library does") {
        const TemporaryDirectory directory;
        const std::string whole = sample(directory / "a.h5");
        int refused = 0;
        for (std::uint64_t number = 0; number < 400; ++number) {
            Random random(5, number);
            std::string bytes = whole;
            for (int k = 0; k < 4; ++k) // most structures are in the first bytes
                bytes[static_cast<std::size_t>(random.uniform(0, 4000))] =
                    static_cast<char>(random.uniform(0, 256));
            write_whole(directory / "b.h5", bytes);
            refused += message_of(directory / "b.h5").empty() ? 0 : 1;
        }
        CHECK(refused > 40); // otherwise the damage is of no account
        CHECK(refused < 400);
    }
}
