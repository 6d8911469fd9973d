#include "engine/progress.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
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
std::string printed(unsigned slots, Progress::Style style, Use use) {
    const std::unique_ptr<std::FILE, Close> file(std::tmpfile());
    {
        Progress progress(slots, style, file.get());
        use(progress);
    }
    std::rewind(file.get());
    std::string text;
    for (int c = std::fgetc(file.get()); c != EOF; c = std::fgetc(file.get()))
        text += static_cast<char>(c);
    return text;
}

std::size_t lines(const std::string& text) {
    return static_cast<std::size_t>(std::ranges::count(text, '\n'));
}

} // namespace

TEST_SUITE("engine/progress") {
    TEST_CASE("without a terminal only a few whole lines are printed, also at the end of runs") {
        const std::string text = printed(1, Progress::Style::lines, [](Progress& progress) {
            for (int run = 0; run < 30; ++run) {
                for (int i = 0; i <= 1000; ++i)
                    progress.report(0, {"shear", i / 1000.0, "q 5 kPa"});
                progress.report(0, {});
            }
        });
        CHECK(text == "shear 0 %, q 5 kPa, eta --:--\n");
    }

    TEST_CASE("on a terminal one line is rewritten and finally ended") {
        const std::string text = printed(1, Progress::Style::rewritten, [](Progress& progress) {
            progress.report(0, {"shear", 0.5});
            std::this_thread::sleep_for(std::chrono::milliseconds(600));
            progress.report(0, {"shear", 1});
        });
        CHECK(text == "\rshear 50 %, eta --:--\x1b[K\rshear 100 %\x1b[K\n");
    }

    TEST_CASE("quiet prints nothing") {
        CHECK(printed(1, Progress::Style::quiet, [](Progress& progress) {
                  progress.report(0, {"shear", 0.5});
              }).empty());
    }

    TEST_CASE("the estimated time left is that of the current phase, from its own rate") {
        const auto wait = [] { std::this_thread::sleep_for(std::chrono::milliseconds(300)); };
        const std::string text = printed(1, Progress::Style::rewritten, [&](Progress& progress) {
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
        const std::string text = printed(1, Progress::Style::lines, [](Progress& progress) {
            progress.report(0, {"compaction", -1, "core porosity 0.340"});
        });
        CHECK(text == "compaction, core porosity 0.340\n");
    }

    TEST_CASE(
        "two runs on two threads share one line, and a run that has ended is no longer shown") {
        const std::string text = printed(3, Progress::Style::rewritten, [](Progress& progress) {
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
        CHECK(text.ends_with("\ra 100 % | b 100 %\x1b[K\n"));
        CHECK(lines(text) == 1);
    }
}
