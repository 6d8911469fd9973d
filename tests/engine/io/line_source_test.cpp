#include "engine/errors.hpp"
#include "engine/io/line_source.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <fcntl.h>
#include <fstream>
#include <sys/stat.h>
#include <thread>

using namespace bris;

TEST_SUITE("engine/io/line_source") {
    TEST_CASE(
        "lines of a growing file are taken as they arrive, and half a line waits for its end") {
        const TemporaryDirectory folder;
        std::ofstream out(folder / "lines");
        out << "one\ntwo\nthr" << std::flush;
        LineSource lines(folder / "lines");
        const auto one = lines.next(10), two = lines.next(10);
        REQUIRE(one);
        REQUIRE(two);
        CHECK(one->text == "one");
        CHECK(one->number == 1);
        CHECK(two->text == "two");
        CHECK_FALSE(lines.next(0.1));
        CHECK_FALSE(lines.over());
        out << "ee\n" << std::flush;
        const auto three = lines.next(10);
        REQUIRE(three);
        CHECK(three->text == "three");
        CHECK(three->whole);
        CHECK(three->number == 3);
    }

    TEST_CASE(
        "a pipe ends with its writer, which waits while the queue is full, and no line is lost") {
        const TemporaryDirectory folder;
        const auto pipe = folder / "pipe";
        REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
        constexpr int count = 100'000;
        std::atomic<int> written = 0;
        std::thread writer([&] {
            std::ofstream out(pipe);
            for (int k = 0; k < count; ++k, ++written)
                out << "line " << k << " of many, long enough to fill a pipe soon\n";
            out << "cut off";
        });
        LineSource lines(pipe, 10);
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
        CHECK(written < count);
        int taken = 0;
        std::optional<LineSource::Line> last;
        while (auto line = lines.next(10)) {
            if (line->whole)
                CHECK_MESSAGE(line->text == "line " + std::to_string(taken) +
                                                " of many, long enough to fill a pipe soon",
                              taken);
            taken += line->whole ? 1 : 0;
            last = std::move(line);
        }
        writer.join();
        CHECK(taken == count);
        CHECK(lines.over());
        CHECK_FALSE(last->whole);
        CHECK(last->text == "cut off");
    }

    TEST_CASE("a line that is too long is cut, and a source that cannot be read is rejected") {
        const TemporaryDirectory folder;
        std::ofstream(folder / "long") << std::string(200'000, 'x') << "\nnext\n";
        LineSource lines(folder / "long");
        const auto first = lines.next(10), second = lines.next(10);
        REQUIRE(second);
        CHECK_FALSE(first->whole);
        CHECK(first->text.size() == LineSource::longest);
        CHECK(second->text == "next");
        CHECK(message_of<OutputError>([&] {
                  LineSource none(folder / "none");
              }).find("No such file or directory") != std::string::npos);
        CHECK(message_of<OutputError>([&] {
                  LineSource none(folder.path());
              }).find("expected a file or pipe, found a folder") != std::string::npos);
    }
}
