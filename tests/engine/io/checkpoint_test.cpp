#include "engine/errors.hpp"
#include "engine/io/checkpoint.hpp"
#include "engine/io/hdf5.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/state.hpp"
#include "tests/support.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <csignal>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

using namespace bris;

namespace {

namespace fs = std::filesystem;

/// Numbers of every type, an empty array, and values that differ only in their bits.
Checkpoint sample(std::size_t rows = 50, std::uint64_t step = 7) {
    std::vector<double> reals(rows);
    std::vector<std::uint32_t> ids(rows);
    for (std::size_t i = 0; i < rows; ++i) {
        reals[i] = static_cast<double>(step) + 0.1 * static_cast<double>(i);
        ids[i] = static_cast<std::uint32_t>(i);
    }
    if (rows > 2) {
        reals[0] = -0.0;
        reals[1] = std::nan("7");
    }
    Checkpoint checkpoint{
        "sample",
        step,
        {{"radius_m", 0.01}, {"spheres", 50u}, {"law", "linear"}, {"threads", 2u}},
        {}};
    checkpoint.state.put("z_first", std::span<const std::uint32_t>(ids));
    checkpoint.state.put("bodies/position", std::span<const double>(reals));
    checkpoint.state.put("bodies/none", std::span<const double>());
    checkpoint.state.put("a_last/steps", std::span<const std::uint64_t>(&step, 1));
    return checkpoint;
}

/// The one-line message with which a file is rejected; "" if it is read.
std::string rejection(const fs::path& path) {
    const std::string message = message_of<InputError>([&] { read_checkpoint(path); });
    CHECK(message.find('\n') == std::string::npos);
    return message;
}

std::size_t files_in(const fs::path& directory) {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(directory), fs::directory_iterator()));
}

/// Exit code of a process that writes a checkpoint under a file size limit, which simulates a full
/// disk. A separate process is needed, since the limit holds for a whole process.
int write_with_limit(const fs::path& path, rlim_t bytes) {
    const pid_t child = fork();
    if (child == 0) {
        std::signal(SIGXFSZ, SIG_IGN);
        const rlimit limit{bytes, bytes};
        setrlimit(RLIMIT_FSIZE, &limit);
        int code = 1;
        try {
            write_checkpoint(path, sample(100000, 8));
            code = 0;
        } catch (const OutputError&) {
            code = 4;
        }
        _exit(code);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

} // namespace

TEST_SUITE("engine/io/checkpoint") {
    TEST_CASE("a checkpoint is read back with the same bits in the same order") {
        const TemporaryDirectory directory;
        const auto path = directory / "deep/down/a.ckpt.h5";
        const Checkpoint written = sample();
        write_checkpoint(path, written);
        const Checkpoint read = read_checkpoint(path);
        CHECK(read.scenario == "sample");
        CHECK(read.step == 7);
        CHECK(fingerprint(read.state) == fingerprint(written.state));
        REQUIRE(read.state.arrays().size() == 4);
        CHECK(read.state.arrays()[0].path == "z_first");
        CHECK(read.state.find("bodies/none")->rows() == 0);
        for (std::size_t i = 0; i < 4; ++i) {
            CHECK(read.state.arrays()[i].scalar == written.state.arrays()[i].scalar);
            CHECK(read.state.arrays()[i].scalar_size == written.state.arrays()[i].scalar_size);
        }
        CHECK(files_in(path.parent_path()) == 1);
        // HDF5 can read the file in spite of the seal
        CHECK(Hdf5File::open(path).text_attribute("/settings", "radius_m") == "0.01");
    }

    TEST_CASE("a run continues from a checkpoint as if it had never stopped") {
        using namespace bris::testing;
        for (const Grains grains : {Grains::spheres, Grains::clumps}) {
            const TemporaryDirectory directory;
            const auto path = directory / "a.ckpt.h5";
            const auto make = [&] {
                return begin(bed({.grains = grains, .bodies = 30}),
                             {.dt = 2e-5, .law = LawName::linear_viscous});
            };
            Simulation sim = make();
            sim.advance(400);
            write_checkpoint(path, {"bed", 400, {}, sim.snapshot()});
            sim.advance(300);
            Simulation resumed = make();
            resumed.restore(read_checkpoint(path).state);
            resumed.advance(300);
            CHECK(fingerprint(resumed.snapshot()) == fingerprint(sim.snapshot()));
        }
    }

    TEST_CASE("a checkpoint truncated anywhere is rejected with a one-line message") {
        const TemporaryDirectory directory;
        const auto path = directory / "cut.ckpt.h5";
        write_checkpoint(path, sample());
        const std::string whole = read_whole(path);
        for (std::size_t length = 0; length < whole.size();
             length += length + 40 < whole.size() ? 131u : 1u) {
            write_whole(path, whole.substr(0, length));
            CAPTURE(length);
            CHECK(rejection(path).starts_with("checkpoint '" + path.string() + "': expected "));
        }
        write_whole(path, whole + "x");
        CHECK(rejection(path) != "");
        write_whole(path, whole);
        CHECK(rejection(path) == "");
    }

    TEST_CASE("a flipped bit anywhere in a checkpoint is detected") {
        const TemporaryDirectory directory;
        const auto path = directory / "damaged.ckpt.h5";
        write_checkpoint(path, sample());
        const std::string whole = read_whole(path);
        for (std::size_t at = 0; at < whole.size(); at += 37) {
            std::string damaged = whole;
            damaged[at] = static_cast<char>(damaged[at] ^ (1 << (at % 8)));
            write_whole(path, damaged);
            CAPTURE(at);
            CHECK(rejection(path) != "");
        }
    }

    TEST_CASE("damage in the numbers of a table is reported with the table and its ids") {
        using namespace bris::testing;
        const TemporaryDirectory directory;
        const auto path = directory / "a.ckpt.h5";
        Simulation sim = begin(bed({.bodies = 30}), {.dt = 2e-5, .law = LawName::linear_viscous});
        const Archive state = sim.snapshot();
        write_checkpoint(path, {"bed", 0, {}, state});
        std::string content = read_whole(path);
        const auto& position = *state.find("bodies/position");
        const std::string bytes(reinterpret_cast<const char*>(position.bytes.data()),
                                position.bytes.size());
        const auto at = content.find(bytes);
        REQUIRE(at != std::string::npos);
        content[at + 100] = static_cast<char>(content[at + 100] ^ 1);
        write_whole(path, content);
        CHECK(rejection(path) == "checkpoint '" + path.string() +
                                     "': expected content that matches its hash, found damage in "
                                     "bodies, ids from 0");
    }

    TEST_CASE("a checkpoint of an earlier format is refused as such") {
        const TemporaryDirectory directory;
        const auto path = directory / "old.ckpt.h5";
        std::string old(1000, 'x');
        old += "BRISckp\n12345678"; // the mark of formats 1 to 4 and a hash
        write_whole(path, old);
        CHECK(rejection(path) ==
              "checkpoint '" + path.string() +
                  "': expected format 5, found an earlier one, which this version cannot continue");
    }

    TEST_CASE("a file of another format is an InputError, a missing one an OutputError") {
        const TemporaryDirectory directory;
        const auto path = directory / "foreign.h5";
        Hdf5File file = Hdf5File::create(path);
        file.write<double>("/state/bodies/position", std::vector<double>{1, 2, 3});
        file.close();
        CHECK(rejection(path) != "");
        write_whole(path, "radius,mass\n1,2\n");
        CHECK(rejection(path) != "");
        const std::string message =
            message_of<OutputError>([&] { read_checkpoint(directory / "none.h5"); });
        CHECK(message ==
              "cannot read '" + (directory / "none.h5").string() + "': No such file or directory");
        CHECK_THROWS_AS(read_checkpoint(directory.path()), OutputError);
    }

    TEST_CASE("a full disk leaves the last complete checkpoint and no other file") {
        const TemporaryDirectory directory;
        const auto path = directory / "a.ckpt.h5";
        write_checkpoint(path, sample());
        std::vector<rlim_t> limits{0, 100, 4096, 100000, 500000, 1000000};
        write_checkpoint(directory / "b.ckpt.h5", sample(100000, 8));
        limits.push_back(fs::file_size(directory / "b.ckpt.h5") - 5); // in the middle of the seal
        for (const rlim_t limit : limits) {
            CAPTURE(limit);
            CHECK(write_with_limit(path, limit) == 4);
            CHECK(read_checkpoint(path).step == 7);
            CHECK(files_in(directory.path()) == 2);
        }
        CHECK(write_with_limit(path, RLIM_INFINITY) == 0);
        CHECK(read_checkpoint(path).step == 8);
        CHECK_THROWS_AS(write_checkpoint("/proc/none/a.ckpt.h5", sample()), OutputError);
        CHECK_THROWS_AS(write_checkpoint("/dev/full/a.ckpt.h5", sample()), OutputError);
    }

    TEST_CASE("a process killed while writing leaves a complete checkpoint") {
        const TemporaryDirectory directory;
        const auto path = directory / "a.ckpt.h5";
        write_checkpoint(path, sample(20000, 1));
        std::uint64_t last = 1;
        for (int round = 0; round < 12 || (last == 1 && round < 100); ++round) {
            const pid_t child = fork();
            if (child == 0)
                for (std::uint64_t step = last + 1;; ++step)
                    write_checkpoint(path, sample(20000, step));
            std::this_thread::sleep_for(std::chrono::milliseconds(7 + 5 * round));
            kill(child, SIGKILL);
            waitpid(child, nullptr, 0);
            const Checkpoint found = read_checkpoint(path); // throws if the file is not complete
            CHECK(found.step >= last);
            CHECK(fingerprint(found.state) == fingerprint(sample(20000, found.step).state));
            last = found.step;
        }
        CHECK(last > 1);
    }

    TEST_CASE("the checkpoint of another run is rejected with all settings that differ, as it was "
              "made and as this run asks for") {
        const Checkpoint checkpoint = sample();
        const auto refusal = [&](const std::string& scenario,
                                 const std::vector<NamedValue>& settings) {
            return message_of<InputError>([&] {
                require_same_run("--resume", "a.h5", checkpoint, scenario, settings,
                                 settings_that_may_differ());
            });
        };
        auto settings = checkpoint.settings;
        for (NamedValue& v : settings) v.flag = "--" + v.key.substr(0, v.key.find('_'));
        CHECK(refusal("sample", settings) == "");
        settings[3].value = std::uint64_t{1}; // threads
        CHECK(refusal("sample", settings) == "");
        CHECK(refusal("other", settings) ==
              "--resume a.h5: expected a checkpoint of other, found one of sample");
        settings[0].value = 0.02;
        CHECK(refusal("sample", settings) == "--resume a.h5: the checkpoint was made with --radius "
                                             "0.01; this run asks for --radius 0.02");
        settings[2].value = "hertz";
        settings.emplace_back("new", true);
        settings.erase(settings.begin() + 1);
        CHECK(refusal("sample", settings) ==
              "--resume a.h5: the checkpoint was made with --radius 0.01, --law linear, no new, "
              "spheres 50; this run asks for --radius 0.02, --law hertz, new true, no spheres");
    }

    TEST_CASE(
        "paths that lead to one folder or to files with the same content are equal settings") {
        const TemporaryDirectory directory;
        fs::create_directory(directory / "data");
        write_whole(directory / "data/poses.csv", "id,x\n1,0\n");
        write_whole(directory / "copy.csv", "id,x\n1,0\n");
        write_whole(directory / "other.csv", "id,x\n1,1\n");
        const auto is_refused = [&](const fs::path& before, const fs::path& now) {
            const Checkpoint checkpoint{"sample", 0, {{"poses", before.string()}}, {}};
            return message_of<InputError>([&] {
                       require_same_run("--resume", "a.h5", checkpoint, "sample",
                                        {{"poses", now.string()}}, {});
                   }) != "";
        };
        const fs::path data = directory / "data", poses = data / "poses.csv";
        CHECK_FALSE(is_refused(data, directory / "data/../data/"));
        CHECK_FALSE(is_refused(poses, directory / "copy.csv"));
        CHECK(is_refused(poses, directory / "other.csv"));
        CHECK(is_refused(data, directory.path()));
        CHECK(is_refused(poses, directory / "none.csv"));
    }
}
