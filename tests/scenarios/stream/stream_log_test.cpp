#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/random.hpp"
#include "scenarios/stream/stream_log.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <bit>
#include <string>
#include <vector>

using namespace bris;

namespace {

namespace fs = std::filesystem;
using Kind = LogEntry::Kind;

constexpr std::uint64_t no_limit = std::uint64_t{1} << 40;

bool is_same(const LogEntry& a, const LogEntry& b) {
    return a.kind == b.kind &&
           std::bit_cast<std::uint64_t>(a.arrival) == std::bit_cast<std::uint64_t>(b.arrival) &&
           a.topic == b.topic && a.text == b.text && a.whole == b.whole && a.retained == b.retained;
}

std::vector<LogEntry> entries_in(const fs::path& path) {
    std::vector<LogEntry> all;
    StreamLogReader reader(path);
    while (auto entry = reader.next())
        if (entry->kind != Kind::session) all.push_back(std::move(*entry));
    return all;
}

} // namespace

TEST_SUITE("stream/stream_log") {
    TEST_CASE("a log says where its arrivals ended: the anchor of the last session, and what came "
              "last") {
        const TemporaryDirectory folder;
        const fs::path path = folder / "log";
        for (int session = 0; session < 2; ++session) {
            StreamLog log(path, LoggedRecords::lines, no_limit);
            CHECK(log.began() > 0);
            log.add({Kind::line, 100.5 + session, {}, "{}"});
            log.add({Kind::published, 900, "topic", "{}"});
            log.add({Kind::line, no_arrival, {}, "{}"});
        }
        const ArrivalsBefore before = arrivals_in(path);
        CHECK(before.last == 101.5);
        CHECK(before.anchor == arrival_anchor());
        CHECK(before.boot == boot_of_computer());
    }

    TEST_CASE("a log gives back every entry with its bytes, flags and the bits of its arrival") {
        const TemporaryDirectory folder;
        const fs::path path = folder / "log";
        Random random(62, 1);
        std::vector<LogEntry> written;
        const std::string letters = "{\"t\": 1}, \\\n\tüx";
        for (int n = 0; n < 2000; ++n) {
            std::string text;
            for (std::uint64_t k = random.bits() % 40; k > 0; --k)
                text += n % 2 == 0 ? static_cast<char>(random.bits())
                                   : letters[random.bits() % letters.size()];
            const double arrival = random.bits() % 8 == 0 ? no_arrival : random.uniform(0, 2e9);
            switch (random.bits() % 4) {
            case 0:
                written.push_back({Kind::line, arrival, {}, text, random.bits() % 2 == 0});
                break;
            case 1:
                written.push_back({Kind::message, arrival, "smartrock/1/imu", text, true,
                                   random.bits() % 2 == 0});
                break;
            case 2:
                written.push_back({Kind::published, arrival, text, "{}", true, true});
                break;
            default:
                written.push_back({Kind::tick, arrival});
            }
        }
        {
            StreamLog log(path, LoggedRecords::messages, no_limit);
            for (const LogEntry& e : written) log.add(e);
            CHECK(log.left_out() == 0);
        }
        const auto found = entries_in(path);
        REQUIRE(found.size() == written.size());
        for (std::size_t k = 0; k < found.size(); ++k)
            if (!is_same(found[k], written[k])) FAIL("entry " << k << " differs");
        CHECK(records_of_log(path) == LoggedRecords::messages);
        CHECK(read_whole(path).starts_with("{\"format\": \"bris stream log 1\", \"records\": "
                                           "\"messages\", \"arrival\": "));
    }

    TEST_CASE("every entry is in the file at once, and a last line without an end is dropped") {
        const TemporaryDirectory folder;
        const fs::path path = folder / "log";
        StreamLog log(path, LoggedRecords::lines, no_limit);
        log.add({Kind::line, 1.5, {}, "one"});
        CHECK(entries_in(path).size() == 1); // while the log is still written
        log.close();
        log.add({Kind::line, 2.5, {}, "after the end"});
        const std::string whole = read_whole(path);
        for (std::size_t cut = 1; cut <= 12; ++cut) {
            write_whole(path, whole + std::string("{\"arrival\": 3, \"line\"").substr(0, cut));
            CHECK(entries_in(path).size() == 1);
        }
        {
            StreamLog again(path, LoggedRecords::lines, no_limit);
            CHECK(again.earlier_bytes() == whole.size());
            again.add({Kind::line, 3.5, {}, "two"});
        }
        const auto found = entries_in(path);
        REQUIRE(found.size() == 2);
        CHECK(found[1].text == "two");
        StreamLogReader earlier(path, whole.size());
        std::size_t count = 0;
        while (earlier.next()) ++count;
        CHECK(count == 2); // the first session and its line
    }

    TEST_CASE("beyond its largest size a log leaves out all that comes, and counts it") {
        const TemporaryDirectory folder;
        StreamLog log(folder / "log", LoggedRecords::lines, 1000);
        for (int k = 0; k < 10; ++k)
            log.add({Kind::line, 1.0, {}, std::string(k == 8 ? 1 : 200, 'x')});
        const auto found = entries_in(folder / "log");
        CHECK(log.left_out() == 10 - found.size());
        CHECK(found.size() == 3);
        CHECK(fs::file_size(folder / "log") <= 1000);
    }

    TEST_CASE("what is no log is refused in one line that says what is wrong and where") {
        const TemporaryDirectory folder;
        const auto path = folder / "log";
        const auto why = [&](const std::string& text) {
            write_whole(path, text);
            return message_of<InputError>([&] { (void)entries_in(path); });
        };
        const std::string head = "{\"format\": \"bris stream log 1\", \"records\": \"lines\"}\n";
        CHECK(why(head).empty());
        CHECK(why(head + "{\"line\": \"x\", \"later\": [1, {}]}\n").empty());
        const std::string at = path.string() + ":2: ";
        CHECK(why("").find("expected a log of a stream") != std::string::npos);
        CHECK(why("{\"t\": 1}\n").find("expected a log of a stream") != std::string::npos);
        CHECK(why("{\"format\": \"bris stream log 2\"}\n").find("expected a log") !=
              std::string::npos);
        CHECK(why(head + "{}\n") == at + "expected a line, a topic or a tick, found none");
        CHECK(why(head + "{\"line\": 5}\n") == at + "line: expected a text, found 5");
        CHECK(why(head + "{\"line_base64\": \"%\"}\n") ==
              at + "line_base64: expected a text, found \"%\"");
        CHECK(why(head + "{\"tick\": 1, \"arrival\": \"nan\"}\n") ==
              at + "arrival: expected a number, found \"nan\"");
        CHECK(why(head + "junk\n").starts_with(at + "expected an object of JSON"));
        CHECK(why(head + std::string(StreamLogReader::longest, 'x') + "\n")
                  .starts_with(at + "expected a line of less than"));
        write_whole(path, "{\"t\": 1}\n");
        CHECK_FALSE(records_of_log(path));
        CHECK_FALSE(records_of_log(folder / "nothing"));
        CHECK_FALSE(records_of_log(folder.path()));
        CHECK_THROWS_AS(StreamLog(path, LoggedRecords::lines, no_limit), InputError);
        CHECK(read_whole(path) == "{\"t\": 1}\n"); // not touched
        write_whole(path, "\211HDF\r\n\032\n and more");
        CHECK(message_of<InputError>([&] {
                  (void)records_of_log(path);
              }).find("histories in run files of earlier versions are not read any more") !=
              std::string::npos);
    }
}
