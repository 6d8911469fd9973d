// Signals, limits of the operating system, folders and disks that take nothing, and pipes among the
// input files: a run ends in time, in one line, with the exit code that the README states.

#include "engine/io/checkpoint.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/stopwatch.hpp"
#include "tests/scenarios/faults/process.hpp"

#include <doctest/doctest.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <fstream>
#include <sched.h>
#include <string>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

using namespace bris;

namespace {

namespace fs = std::filesystem;

using Words = std::vector<std::string>;

Words settle(const fs::path& out, const Words& more) {
    Words words{"settle", "--out", out.string(), "--threads", "1", "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
}
Words endless(const fs::path& out) {
    return settle(out, {"--spheres", "500", "--duration", "1000"});
}

bool limit(int which, rlim_t soft, rlim_t hard) {
    const rlimit limits{soft, hard};
    return setrlimit(which, &limits) == 0;
}

/// Waits until the run has begun its steps: the first frame is written before them.
void wait_for(const fs::path& file) {
    for (int k = 0; k < 2000 && !fs::exists(file); ++k) usleep(10'000);
    usleep(100'000);
}

/// Whether an interrupted run said so, and how to go on, and can go on.
void check_interrupted(const Outcome& outcome, const fs::path& out) {
    CAPTURE(outcome.err);
    CHECK(outcome.code == 130);
    CHECK_FALSE(outcome.hung);
    CHECK(is_one_line_of(outcome.err, "settle"));
    CHECK(outcome.err.find("continue with --resume " + out.string()) != std::string::npos);
    CHECK(read_checkpoint(out / "settle.ckpt.h5").step > 0);
}

void check_failed(const Outcome& outcome, int code, const std::string& program = "settle") {
    CAPTURE(outcome.err);
    CHECK(outcome.code == code);
    CHECK(outcome.signal == 0);
    CHECK_FALSE(outcome.hung);
    CHECK(is_one_line_of(outcome.err, program));
}

/// Puts an empty file system of `bytes` over a folder, which only the process that calls it sees.
bool mount_over(const fs::path& folder, const std::string& options, unsigned long flags = 0) {
    return unshare(CLONE_NEWNS) == 0 &&
           mount("none", "/", nullptr, MS_PRIVATE | MS_REC, nullptr) == 0 &&
           mount("tmpfs", folder.c_str(), "tmpfs", flags, options.c_str()) == 0;
}

bool may_mount() {
    const TemporaryDirectory folder;
    const bool may = geteuid() == 0 && run_process({"settle", "--version"}, [&] {
                                           return mount_over(folder.path(), "size=64k");
                                       }).code == 0;
    if (!may) MESSAGE("skipped: only root may mount a file system, and not in every container");
    return may;
}

} // namespace

TEST_SUITE("faults/limits") {
    TEST_CASE("a run that is interrupted, terminated or out of processor time saves a checkpoint "
              "and ends with 130") {
        for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGXCPU}) {
            CAPTURE(signal);
            const TemporaryDirectory folder;
            const auto out = folder / "out";
            Process run(endless(out), [&] {
                return signal != SIGXCPU || limit(RLIMIT_CPU, 1, 30); // the kernel sends it
            });
            if (signal != SIGXCPU) {
                wait_for(out / "settle.vtkhdf");
                run.send(signal);
            }
            check_interrupted(run.wait(20), out);
        }
    }

    TEST_CASE("a closed or full stderr ends no run and changes no exit code, and a standard output "
              "that takes nothing ends with exit code 4") {
        const TemporaryDirectory folder;
        const auto with = [&](int stream, bool is_full, const Words& words) {
            return run_process(words, [=] {
                if (!is_full) return close(stream) == 0;
                return dup2(open("/dev/full", O_WRONLY), stream) == stream;
            });
        };
        for (const bool is_full : {false, true}) {
            CAPTURE(is_full);
            const Words run{"settle", "--out",      folder / "out", "--spheres",
                            "20",     "--duration", "0.001"};
            CHECK(with(STDERR_FILENO, is_full, run).code == 0);
            CHECK(with(STDERR_FILENO, is_full, {"settle", "--bogus"}).code == 2);
            // what is printed has not gone into a file
            CHECK(read_whole(folder / "out/settle.vtkhdf").find("coordination number 0.") ==
                  std::string::npos);
            Words quiet = run;
            quiet.emplace_back("--quiet");
            check_failed(with(STDOUT_FILENO, is_full, quiet), 4);
            for (const char* flag : {"--explain", "--help", "--version"})
                check_failed(with(STDOUT_FILENO, is_full, {"settle", flag}), 4);
            check_failed(with(STDOUT_FILENO, is_full, {"verify", "--list"}), 4, "verify");
        }
    }

    TEST_CASE("a picture that a full disk cuts off is removed, and the run says so") {
        const TemporaryDirectory folder;
        const Outcome outcome = run_process({"recordings", "--out", folder / "out", "--quiet"},
                                            [] { return limit(RLIMIT_FSIZE, 46'000, 46'000); });
        CHECK(outcome.code == 0);
        CHECK(outcome.err.find("cannot draw '") != std::string::npos);
        for (const auto& entry : fs::recursive_directory_iterator(folder / "out"))
            if (entry.path().extension() == ".png")
                CHECK(read_whole(entry.path()).find("IEND") != std::string::npos);
    }

    TEST_CASE("a second interrupt ends a run at once") {
        const TemporaryDirectory folder;
        const auto out = folder / "out";
        Process run(endless(out));
        wait_for(out / "settle.vtkhdf");
        run.send(SIGINT);
        run.send(SIGINT);
        const auto before = this_instant();
        const Outcome outcome = run.wait(20);
        CHECK(outcome.code == 130);
        CHECK(seconds_since(before) < 2);
    }

    TEST_CASE("a run that needs more memory, open files or file size than it may have fails in "
              "one line") {
        const TemporaryDirectory folder;
        const auto out = folder / "out";
#ifndef BRIS_SANITIZED // shadow memory counts as data
        check_failed(run_process(settle(out, {"--spheres", "300000"}),
                                 [] { return limit(RLIMIT_DATA, 100'000'000, 100'000'000); }),
                     3);
#endif
        const Words small = settle(out, {"--spheres", "20", "--duration", "0.001"});
        // one descriptor beside the standard streams: the second file fails
        check_failed(
            run_process(small, [] { return unsetenv("PATH") == 0 && limit(RLIMIT_NOFILE, 4, 4); }),
            4);
        check_failed(run_process(small, [] { return limit(RLIMIT_FSIZE, 50'000, 50'000); }), 4);
    }

    TEST_CASE("a folder that cannot be written to is named, with exit code 4") {
        const TemporaryDirectory folder;
        const auto out = folder.path();
        const Words small = settle(out, {"--spheres", "20", "--duration", "0.001"});
        Outcome outcome;
        if (geteuid() != 0) {
            fs::permissions(out, fs::perms::owner_read | fs::perms::owner_exec);
            outcome = run_process(small);
            fs::permissions(out, fs::perms::owner_all);
        } else {
            if (!may_mount()) return;
            outcome = run_process(small, [&] { return mount_over(out, "size=64k", MS_RDONLY); });
        }
        check_failed(outcome, 4);
        CHECK(outcome.err.find(out.string()) != std::string::npos);
    }

    TEST_CASE("a run on a disk that becomes full fails in one line with exit code 4, wherever it "
              "happens") {
        if (!may_mount()) return;
        const TemporaryDirectory folder;
        const Words small = settle(folder / "out", {"--spheres", "100", "--duration", "0.004"});
        for (int kilobytes = 40; kilobytes <= 280; kilobytes += 24) {
            CAPTURE(kilobytes);
            check_failed(run_process(small,
                                     [&] {
                                         return mount_over(folder.path(),
                                                           "size=" + std::to_string(kilobytes) +
                                                               "k");
                                     }),
                         4);
        }
    }

    TEST_CASE("a pipe where a file is expected is refused at once instead of waited for") {
        const TemporaryDirectory folder;
        const fs::path pipe = folder / "pipe.stl";
        REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
        const auto out = (folder / "out").string();
        for (const Words& words : std::vector<Words>{{"settle", "--config", pipe.string()},
                                                     {"settle", "--resume", pipe.string()},
                                                     {"clumps", "--mesh", pipe.string()}}) {
            CAPTURE(words[1]);
            Words all = words;
            all.insert(all.end(), {"--out", out});
            const Outcome outcome = run_process(all, {}, 10);
            check_failed(outcome, 4, words[0]);
            CHECK(outcome.err.find("expected a file, found a pipe") != std::string::npos);
        }
    }

    TEST_CASE("a pipe among the recordings is refused at once") {
        const fs::path assets = fs::path(BRIS_SOURCE) / "assets/smartrock";
        for (const char* name : {"110kPa/recordings.csv", "110kPa/test.csv", "rock_03.txt"}) {
            CAPTURE(name);
            const TemporaryDirectory folder;
            fs::copy(assets, folder / "recordings", fs::copy_options::recursive);
            const fs::path pipe = (folder / "recordings") / name;
            fs::remove(pipe);
            REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
            const Outcome outcome =
                run_process({"smart_triaxial", "--recordings", (folder / "recordings").string(),
                             "--out", (folder / "out").string(), "--quiet"},
                            {}, 20);
            check_failed(outcome, 4, "smart_triaxial");
            CHECK(outcome.err.find("found a pipe") != std::string::npos);
        }
    }

    TEST_CASE("a folder where a file is expected is refused by name, never as an internal error") {
        const TemporaryDirectory folder;
        for (const char* name : {"dir.obj", "dir.stl", "dir.ply", "dir.csv", "dir.txt", "dir.h5"})
            fs::create_directory(folder / name);
        const auto at = [&](const char* name) { return (folder / name).string(); };
        for (const Words& words : std::vector<Words>{{"clumps", "--mesh", at("dir.obj")},
                                                     {"clumps", "--mesh", at("dir.stl")},
                                                     {"clumps", "--mesh", at("dir.ply")},
                                                     {"triaxial", "--grading", at("dir.csv")},
                                                     {"triaxial", "--sensor-shape", at("dir.csv")},
                                                     {"triaxial", "--sensor-poses", at("dir.csv")},
                                                     {"triaxial", "--clumps", at("dir.csv")},
                                                     {"ballast_box", "--material", at("dir.txt")},
                                                     {"ballast_box", "--clumps", at("dir.csv")},
                                                     {"settle", "--config", at("dir.txt")},
                                                     {"settle", "--resume", at("dir.h5")},
                                                     {"recordings", "--new", at("dir.csv")},
                                                     {"recordings", at("dir.csv")},
                                                     {"recordings", "--columns", at("dir.txt")}}) {
            CAPTURE(words);
            Words all = words;
            all.insert(all.end(), {"--out", (folder / "out").string()});
            const Outcome outcome = run_process(all, {}, 20);
            CAPTURE(outcome.err);
            CHECK((outcome.code == 2 || outcome.code == 4));
            CHECK(is_one_line_of(outcome.err, words[0]));
            CHECK(outcome.err.find("internal error") == std::string::npos);
            CHECK(outcome.err.find(words.back()) != std::string::npos);
        }
    }

    TEST_CASE("bytes of a file that could control the terminal are shown escaped") {
        const TemporaryDirectory folder;
        const fs::path config = folder / "bad.cfg";
        std::ofstream(config) << "seed = \x1b]0;owned\x07\x1b[2J\xff\n";
        const Outcome outcome = run_process({"settle", "--config", config.string()});
        CHECK(outcome.code == 2);
        // the last byte is a letter of Latin-1, in which such a file is read
        CHECK(outcome.err.ends_with("found \"\\x1b]0;owned\\x07\\x1b[2J\u00ff\"\n"));
    }

    TEST_CASE("a second run into the same folder is refused as long as the first one runs") {
        const TemporaryDirectory folder;
        const auto out = folder / "out";
        Process first(endless(out));
        wait_for(out / "settle.vtkhdf");
        const Words small = settle(out, {"--spheres", "20", "--duration", "0.001"});
        const Outcome second = run_process(small);
        check_failed(second, 4);
        CHECK(second.err.find("--out: expected a folder that no other run uses, found '" +
                              out.string() + "'") != std::string::npos);
        first.send(SIGKILL); // what is left behind is no obstacle
        (void)first.wait(20);
        CHECK(run_process(small).code == 0);
    }

    TEST_CASE("a run that is being prepared can be terminated") {
        const TemporaryDirectory folder;
        const auto out = folder / "out"; // hundreds of thousands of rocks
        Process run({"tie_push", "--rock-scale", "0.25", "--smallest-rock", "0", "--out",
                     out.string(), "--quiet"});
        sleep(2);
        run.send(SIGTERM);
        const Outcome outcome = run.wait(20);
        CHECK_FALSE(outcome.hung);
        CHECK(outcome.code == 130);
        CHECK(is_one_line_of(outcome.err, "tie_push"));
    }

    TEST_CASE("a stream that is the log of its run is refused and kept") {
        const TemporaryDirectory folder;
        const fs::path log = folder / "stream.ndjson";
        write_whole(log, "{\"end\": true}\n");
        const Outcome outcome = run_process(
            {"live_triaxial", "--stream", log.string(), "--out", folder.path().string()});
        check_failed(outcome, 2, "live_triaxial");
        CHECK(read_whole(log) == "{\"end\": true}\n");
    }

    TEST_CASE("a run that waits for a stream can be interrupted") {
        for (const int signal : {SIGINT, SIGTERM}) {
            const TemporaryDirectory folder;
            const fs::path pipe = folder / "stream";
            REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
            Process run({"live_triaxial", "--stream", pipe.string(), "--out",
                         (folder / "out").string(), "--quiet"});
            sleep(2);
            run.send(signal);
            const Outcome outcome = run.wait(20);
            CAPTURE(outcome.err);
            CHECK_FALSE(outcome.hung);
            CHECK(outcome.code == 130);
        }
    }
}
