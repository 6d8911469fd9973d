#include "engine/errors.hpp"
#include "scenarios/stream/run_broker.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

using namespace bris;

namespace {

namespace fs = std::filesystem;

void write_history(const fs::path& path, const std::vector<std::string>& payloads) {
    Hdf5File file = Hdf5File::create(path);
    BrokerHistory history(file, 1 << 30);
    for (const std::string& payload : payloads) history.add({1, "smartrock/1/imu", payload});
    history.close();
    file.close();
}

std::vector<std::string> payloads_in(const fs::path& path) {
    std::vector<std::string> found;
    HistoryReader reader(path);
    while (const auto m = reader.next()) found.push_back(m->payload);
    return found;
}

} // namespace

TEST_SUITE("stream/run_broker") {
    TEST_CASE("the history of a resumed run begins with that of the run before") {
        const TemporaryDirectory folder;
        fs::create_directories(folder.path() / "day");
        const fs::path source = folder.path() / "source.h5", run = folder.path() / "day" / "run.h5";
        write_history(source, {"third"});
        write_history(run, {"first", "second"});
        Common common;
        common.scenario = "test";
        common.out = folder.path() / "day";
        CHECK(put_aside_run_file(common, "run.h5").empty()); // no run is resumed
        common.resume = common.out;
        const fs::path earlier = put_aside_run_file(common, "run.h5");
        REQUIRE(fs::exists(earlier));
        CHECK_FALSE(fs::exists(run));
        CHECK(put_aside_run_file(common, "run.h5") == earlier); // killed right after that
        Hdf5File file = Hdf5File::create(run);
        RunBroker broker({}, source, 0, common);
        CHECK(broker.gives_records());
        broker.keep_in(file, earlier);
        CHECK(broker.link().next(0)->payload == "third");
        broker.finish();
        file.close();
        CHECK(payloads_in(run) == std::vector<std::string>{"first", "second", "began", "third"});
        CHECK(broker.report().empty());
    }

    TEST_CASE("a history in the folder of the results is refused, since they would replace it") {
        const TemporaryDirectory folder;
        const fs::path path = folder.path() / "monitor.h5";
        write_history(path, {"one"});
        Common common;
        common.out = folder.path();
        CHECK_THROWS_AS(RunBroker({}, path, 0, common), InputError);
    }
}
