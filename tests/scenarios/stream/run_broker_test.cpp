#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/stream/run_broker.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <string>
#include <vector>

using namespace bris;

namespace {

namespace fs = std::filesystem;

void write_log(const fs::path& path, const std::vector<std::string>& payloads) {
    StreamLog log(path, LoggedRecords::messages, 1 << 30);
    for (const std::string& payload : payloads)
        log.add({LogEntry::Kind::message, 1, "smartrock/1/imu", payload});
}

std::vector<std::string> payloads_in(const fs::path& path) {
    std::vector<std::string> found;
    StreamLogReader reader(path);
    while (const auto m = reader.next())
        if (m->kind == LogEntry::Kind::message) found.push_back(m->text);
    return found;
}

Common common_of(const fs::path& out) {
    Common common;
    common.scenario = "test";
    common.out = out;
    return common;
}

} // namespace

TEST_SUITE("stream/run_broker") {
    TEST_CASE("a resumed run gets what it logged before, and goes on with its log") {
        const TemporaryDirectory folder;
        write_log(folder / "source", {"third"});
        for (const bool in_place : {true, false}) {
            const fs::path before = folder / (in_place ? "first" : "second");
            write_log(before / log_name, {"first", "second"});
            Common common = common_of(in_place ? before : folder / "elsewhere");
            fs::create_directories(common.out);
            common.resume = before;
            {
                RunBroker broker({}, folder / "source", 0, common);
                CHECK(broker.gives_records());
                broker.keep_in(begin_log({}, LoggedRecords::messages, folder / "source", common));
                std::vector<std::string> came;
                while (!broker.link().over())
                    if (const auto m = broker.link().next(0);
                        m && m->topic != BrokerLink::own_topic)
                        came.push_back(m->payload);
                CHECK(came == std::vector<std::string>{"first", "second", "third"});
                broker.finish();
            }
            // the source's own beginning is a message of this log
            CHECK(payloads_in(common.out / log_name) ==
                  std::vector<std::string>{"first", "second", "began", "third"});
        }
        CHECK(payloads_in(folder / "second" / log_name).size() == 2); // it was copied
    }

    TEST_CASE("a run that is not resumed keeps an earlier log under another name") {
        const TemporaryDirectory folder;
        const Common common = common_of(folder.path());
        for (int run = 0; run < 3; ++run)
            begin_log({}, LoggedRecords::lines, {}, common)
                ->add({LogEntry::Kind::message, 1, "topic", std::to_string(run)});
        const std::string log = (folder / log_name).string();
        CHECK(payloads_in(log) == std::vector<std::string>{"2"});
        CHECK(payloads_in(log + ".before") == std::vector<std::string>{"0"});
        CHECK(payloads_in(log + ".before.2") == std::vector<std::string>{"1"});
        RunBrokerSettings none;
        none.history = 0;
        CHECK_FALSE(begin_log(none, LoggedRecords::lines, {}, common));
    }

    TEST_CASE("what is beyond the size of the log is counted in the report") {
        const TemporaryDirectory folder;
        RunBrokerSettings settings;
        settings.history = 1e-6; // 1073 bytes
        const auto log = begin_log(settings, LoggedRecords::lines, {}, common_of(folder.path()));
        CHECK(report_on_log(log.get(), settings).empty());
        log->add({LogEntry::Kind::line, 1, {}, std::string(2000, 'x')});
        CHECK(report_on_log(log.get(), settings) ==
              "log: 1 entries left out beyond 1e-06 GiB (--broker-history)\n");
    }

    TEST_CASE("a log cannot be the stream of the run that writes it") {
        const TemporaryDirectory folder;
        write_log(folder / log_name, {"one"});
        const std::string before = read_whole(folder / log_name);
        CHECK_THROWS_AS(
            begin_log({}, LoggedRecords::messages, folder / log_name, common_of(folder.path())),
            InputError);
        CHECK(read_whole(folder / log_name) == before);
    }
}
