#include "engine/errors.hpp"
#include "engine/progress.hpp"
#include "engine/run.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <vector>

using namespace bris;

namespace {

struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

/// The output of a progress of this style during `use`.
template <class Use>
std::string printed(Progress::Style style, Use use) {
    const std::unique_ptr<std::FILE, Close> file(std::tmpfile());
    {
        Progress progress(style, file.get());
        use(progress);
    }
    std::rewind(file.get());
    std::string text;
    for (int c = std::fgetc(file.get()); c != EOF; c = std::fgetc(file.get()))
        text += static_cast<char>(c);
    return text;
}

} // namespace

TEST_SUITE("engine/progress") {
    TEST_CASE("without a terminal only a few whole lines are printed, also at the end of runs") {
        const std::string text = printed(Progress::Style::lines, [](Progress& progress) {
            for (int run = 0; run < 30; ++run) {
                for (int i = 0; i <= 1000; ++i)
                    progress.report(0, {"shear", i / 1000.0, "q 5 kPa"});
                progress.report(0, {});
            }
        });
        CHECK(text == "shear 0 %, q 5 kPa, eta --:--\n");
    }

    TEST_CASE("on a terminal one line is rewritten, and cleared when the last run has ended") {
        const std::string text = printed(Progress::Style::rewritten, [](Progress& progress) {
            progress.report(0, {"shear", 0.5});
            std::this_thread::sleep_for(std::chrono::milliseconds(600));
            progress.report(0, {"shear", 1});
        });
        CHECK(text == "\rshear 50 %, eta --:--\x1b[K\rshear 100 %\x1b[K\r\x1b[K");
        CHECK(printed(Progress::Style::rewritten, [](Progress& progress) {
                  progress.report(0, {"shear", 0.5});
                  progress.report(0, {});
                  progress.pause(); // nothing is left to clear
              }) == "\rshear 50 %, eta --:--\x1b[K\r\x1b[K");
    }

    TEST_CASE("what does not fit on the terminal is left out: the status of runs, then whole runs; "
              "a single run is cut") {
        // a file has no width: 80 columns, of which the last one stays free
        REQUIRE(unsetenv("COLUMNS") == 0);
        const std::string status = "axial strain 1.20 of 8 %, q 540 kPa, and so on";
        const auto line_of = [&](const std::string& name, unsigned runs) {
            std::string text = printed(Progress::Style::rewritten, [&](Progress& progress) {
                progress.begin_job(1);
                for (unsigned k = 0; k < runs; ++k) progress.report(k, {name, 0.5, status});
                if (runs == 1) return; // the first report is shown at once
                std::this_thread::sleep_for(std::chrono::milliseconds(520));
                progress.report(0, {name, 0.5, status});
            });
            text.resize(text.rfind("\x1b[K\r\x1b[K"));
            return text.substr(text.rfind('\r') + 1);
        };
        const std::string job = "all runs 0 %, eta --:-- | ";
        CHECK(line_of("shear", 1) == job + "shear 50 %, " + status.substr(0, 41));
        CHECK(line_of("shear", 3) == job + "shear 50 % | shear 50 % | shear 50 %");
        CHECK(line_of("a member that shears", 3) == job + "a member that shears 50 % | 2 more");
        setenv("COLUMNS", "200", 1);
        CHECK(line_of("shear", 2) == job + "shear 50 %, " + status + " | shear 50 %, " + status);
        unsetenv("COLUMNS");
    }

    TEST_CASE("the time left of a job is that of all its runs, also of those that do not report") {
        const std::string text = printed(Progress::Style::rewritten, [](Progress& progress) {
            progress.begin_job(100);
            for (int k = 0; k <= 4; ++k) { // 5 units in 0.3 s
                progress.report(0, {"first", 0.5, "", 3.0 * k});
                progress.report(1, {"second", 0.5, "", 2.0 * k});
                std::this_thread::sleep_for(std::chrono::milliseconds(300));
            }
            progress.report(0, {});
            progress.report(1, {});   // 20 units have ended
            progress.job_reached(90); // 70 more were resumed from a checkpoint
            std::this_thread::sleep_for(std::chrono::milliseconds(600));
            progress.report(0, {"fourth", 0.1, "", 5});
        });
        CAPTURE(text);
        // 10 of 100 units in the last 0.6 s: 4.9 s are left
        const auto at = text.find("all runs 18 %, eta 00:");
        REQUIRE(at != std::string::npos);
        const int eta = std::stoi(text.substr(at + 22, 2));
        CHECK(eta >= 5);
        CHECK(eta <= 30); // on a busy machine
        CHECK(text.find("| first 50 % | second 50 %") != std::string::npos);
        CHECK(text.find("all runs 95 %") != std::string::npos);
    }

    TEST_CASE("a run that stops with an error is no longer shown") {
        std::vector<std::string> phases;
        int blocks = 0;
        const auto advance = [&] {
            if (++blocks == 2) throw SimulationError("stopped");
            return true;
        };
        CheckpointTimer timer;
        CHECK_THROWS_AS(run_loop({.advance = advance,
                                  .progress =
                                      [] {
                                          return PhaseProgress{"shear", 0.5};
                                      }},
                                 timer,
                                 [&](const PhaseProgress& now) { phases.push_back(now.phase); }),
                        SimulationError);
        CHECK(phases == std::vector<std::string>{"shear", ""});
    }

    TEST_CASE("quiet prints nothing") {
        CHECK(printed(Progress::Style::quiet, [](Progress& progress) {
                  progress.report(0, {"shear", 0.5});
              }).empty());
    }

    TEST_CASE("the estimated time left is that of the current phase, from its own rate") {
        const auto wait = [] { std::this_thread::sleep_for(std::chrono::milliseconds(300)); };
        const std::string text = printed(Progress::Style::rewritten, [&](Progress& progress) {
            progress.report(0, {"compaction", 0.9}); // gives no information on the next phase
            for (int i = 0; i <= 4; ++i) { // a tenth in 0.6 s, so 4.8 s are left at a fifth
                progress.report(0, {"shear", 0.05 * i});
                wait();
            }
        });
        CAPTURE(text);
        CHECK(text.find("compaction 90 %, eta --:--") != std::string::npos);
        CHECK(text.find("shear 20 %, eta 00:05") != std::string::npos);
    }

    TEST_CASE("a phase of unknown length shows neither a percentage nor a time left") {
        const std::string text = printed(Progress::Style::lines, [](Progress& progress) {
            progress.report(0, {"compaction", -1, "core porosity 0.340"});
        });
        CHECK(text == "compaction, core porosity 0.340\n");
    }

    TEST_CASE(
        "two runs on two threads share one line, and a run that has ended is no longer shown") {
        const std::string text = printed(Progress::Style::rewritten, [](Progress& progress) {
            progress.report(2, {"c", 0.5});
            progress.report(2, {});
            std::vector<std::jthread> runs;
            for (unsigned slot = 0; slot < 2; ++slot)
                runs.emplace_back([&progress, slot] {
                    for (int i = 0; i <= 1000; ++i)
                        progress.report(slot, {slot ? "b" : "a", i / 1000.0});
                });
            runs.clear();
            std::this_thread::sleep_for(std::chrono::milliseconds(600));
            progress.report(0, {"a", 1});
        });
        CHECK(text.ends_with("\ra 100 % | b 100 %\x1b[K\r\x1b[K"));
    }
}
