#include "engine/errors.hpp"
#include "engine/io/checkpoint.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/hdf5.hpp"
#include "engine/io/whole_file.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <sys/stat.h>

using namespace bris;

TEST_SUITE("engine/io/whole_file") {
    TEST_CASE("what is written is read, and replaces an older file") {
        const TemporaryDirectory folder;
        const auto file = folder / "a/b";
        for (const std::string& text : {std::string("x\0y\n", 4), std::string()}) {
            write_whole(file, text);
            CHECK(read_whole(file) == text);
        }
    }

    TEST_CASE("a folder or a pipe where a file is expected is refused without waiting") {
        const TemporaryDirectory folder;
        const auto pipe = folder / "pipe";
        REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
        const auto complaint = [](auto&& action) { return message_of<OutputError>(action); };
        CHECK(complaint([&] { (void)read_whole(pipe); }) ==
              "cannot read '" + pipe.string() + "': expected a file, found a pipe");
        CHECK(complaint([&] { (void)read_csv(pipe); }).ends_with("found a pipe"));
        CHECK(complaint([&] { (void)Hdf5File::open(pipe); }).ends_with("found a pipe"));
        CHECK(complaint([&] { (void)read_whole(folder.path()); }).ends_with("found a folder"));
        CHECK(complaint([] { (void)read_whole("/dev/zero"); }).ends_with("found a device"));
        CHECK(complaint([&] {
                  (void)read_whole(folder / "none");
              }).ends_with("No such file or directory"));
    }

    TEST_CASE("nothing but a file is replaced by one, and a link stays one") {
        const TemporaryDirectory folder;
        const auto pipe = folder / "pipe", link = folder / "link", target = folder / "target";
        REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
        const auto complaint = [](auto&& action) { return message_of<OutputError>(action); };
        const std::string refusal =
            "cannot write '" + pipe.string() + "': expected a file, found a pipe";
        CHECK(complaint([&] { write_whole(pipe, "x"); }) == refusal);
        CHECK(complaint([&] { write_checkpoint(pipe, {}); }) == refusal);
        CHECK(complaint([&] { (void)Hdf5File::create(pipe); }) == refusal);
        CHECK(complaint([] { (void)file_to_write("/dev/full"); }).ends_with("found a device"));
        for (const char* text : {"new", "newer"}) { // the target is not there at first
            std::filesystem::remove(link);
            std::filesystem::create_symlink(target, link);
            write_whole(link, text);
            CHECK(std::filesystem::is_symlink(link));
            CHECK(read_whole(target) == text);
        }
    }
}
