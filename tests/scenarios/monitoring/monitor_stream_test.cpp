// The monitor as a program: a stream with one impossible time stamp, and one through a pipe, with a
// monitor that is stopped and resumed.
#include "engine/io/whole_file.hpp"
#include "tests/scenarios/faults/process.hpp"
#include "tests/scenarios/monitoring/passage_lines.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <string>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

using namespace bris;

namespace {

/// Waits until a file has so many lines; false: after 20 s it has not.
bool has_lines(const std::filesystem::path& path, std::ptrdiff_t count) {
    for (int k = 0; k < 400; ++k) {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        if (!std::filesystem::exists(path)) continue;
        const std::string text = read_whole(path);
        if (std::ranges::count(text, '\n') >= count) return true;
    }
    return false;
}

/// The rows of final verdicts in history.csv, without the names that tell the time.
std::string final_rows(const std::filesystem::path& history) {
    std::ifstream in(history);
    std::string rows;
    for (std::string line; std::getline(in, line);)
        if (line.find(",final,") != std::string::npos)
            rows += line.substr(line.find(",final,")) + "\n";
    return rows;
}

} // namespace

TEST_SUITE("monitoring/stream") {
    TEST_CASE("one impossible time stamp is counted, all sensors go on, and what was not judged is "
              "said: exit code 5 where it is required") {
        const TemporaryDirectory folder;
        const auto in = [&](const char* name) { return (folder.path() / name).string(); };
        REQUIRE(run_process({"monitor", "--write-example", in("ex"), "--example-state", "clean",
                             "--example-sensors", "4", "--example-passages", "1",
                             "--example-duration", "4", "--out", in("made"), "--quiet"})
                    .code == 0);
        std::string text; // as of loggers that send one sample a second
        for (int k = 0; k < 160; ++k) {
            const double t = k == 40 ? 1e9 : k / 4 + 0.3 * (k % 4);
            text +=
                fmt::format("{{\"id\": {}, \"t\": {}, \"ax\": 0.1, \"ay\": 0.0, \"az\": 9.81}}\n",
                            k % 4 + 1, t);
        }
        write_whole(folder.path() / "stream.nd", text + "{\"end\": 1}\n");
        const auto run = [&](const std::string& required) {
            return run_process({"monitor", "--baseline", in("ex/baseline"), "--stream",
                                in("stream.nd"), "--window", "5", "--late", "0", "--require",
                                required, "--out", in("out"), "--quiet"});
        };
        const Outcome ended = run("nothing");
        CAPTURE(ended.err);
        CHECK(ended.code == 0);
        const std::string page = read_whole(in("out/monitor.html"));
        CHECK(page.find("1 record of an impossible time: line 41: sensor 1") != std::string::npos);
        for (const char* what : {"sensor 1: 39 records passed", "sensor 2: 40 records passed",
                                 "sensor 3: 40 records passed", "sensor 4: 40 records passed"})
            CHECK_MESSAGE(page.find(what) != std::string::npos, page);
        const std::string summary = read_whole(in("out/summary.json"));
        CHECK(summary.find("\"verdict\": \"not enough data\"") != std::string::npos);
        CHECK(summary.find("no train passed") != std::string::npos);
        const Outcome required = run("all");
        CHECK(required.code == 5);
        CHECK(is_one_line_of(required.err, "monitor"));
        CHECK(required.err.find("1 of 160 records left out") != std::string::npos);
    }

    TEST_CASE("a monitor of a pipe that is stopped and resumed gives the verdicts of one that goes "
              "on, and its log gives them again, byte for byte") {
        const TemporaryDirectory folder;
        const auto in = [&](const char* name) { return (folder.path() / name).string(); };
        REQUIRE(run_process({"monitor", "--write-example", in("ex"), "--example-sensors", "2",
                             "--example-passages", "3", "--example-duration", "6", "--out",
                             in("made"), "--quiet"})
                    .code == 0);
        const auto lines = testing::lines_of_passages(folder.path() / "ex" / "recordings");
        const auto text_of = [&](std::size_t begin, std::size_t end) {
            std::string text;
            for (std::size_t k = begin; k < end; ++k) text += lines[k] + "\n";
            return text;
        };
        write_whole(in("all.nd"), text_of(0, lines.size()) + "{\"end\": 1}\n");
        const auto words = [&](const std::string& stream, const char* out) {
            return std::vector<std::string>{"monitor", "--baseline", in("ex/baseline"), "--stream",
                                            stream,    "--out",      in(out),           "--quiet"};
        };
        REQUIRE(run_process(words(in("all.nd"), "undisturbed")).code == 0);
        const std::string expected = final_rows(in("undisturbed/history.csv"));
        CHECK(std::ranges::count(expected, '\n') == 6); // two sensors, three passages

        const std::string pipe = in("pipe");
        REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
        const int end = open(pipe.c_str(), O_RDWR | O_CLOEXEC);
        const auto send = [&](const std::string& text) {
            std::size_t sent = 0;
            while (sent < text.size()) {
                const ssize_t n = write(end, text.data() + sent, text.size() - sent);
                if (n <= 0) return false;
                sent += static_cast<std::size_t>(n);
            }
            return true;
        };
        const std::size_t half = lines.size() / 2; // within the second passage
        {
            Process first(words(pipe, "out"));
            REQUIRE(send(text_of(0, half)));
            REQUIRE(has_lines(in("out/stream.ndjson"), static_cast<std::ptrdiff_t>(half)));
            first.send(SIGTERM);
            const Outcome stopped = first.wait(20);
            CAPTURE(stopped.err);
            CHECK(stopped.code == 130);
        }
        auto resumed_words = words(pipe, "out");
        resumed_words.insert(resumed_words.end(), {"--resume", in("out")});
        Process second(resumed_words);
        REQUIRE(send(text_of(half, lines.size()) + "{\"end\": 1}\n"));
        const Outcome ended = second.wait(60);
        close(end);
        CAPTURE(ended.err);
        CHECK(ended.code == 0);
        CHECK(final_rows(in("out/history.csv")) == expected);
        REQUIRE(run_process(words(in("out/stream.ndjson"), "again")).code == 0);
        CHECK(read_whole(in("again/history.csv")) == read_whole(in("out/history.csv")));

        auto nothing_to_resume = words(in("all.nd"), "undisturbed");
        nothing_to_resume.insert(nothing_to_resume.end(), {"--resume", in("ex")});
        const Outcome refused = run_process(nothing_to_resume);
        CHECK(refused.code == 2);
        CHECK(is_one_line_of(refused.err, "monitor"));
    }
}
