#include "engine/progress.hpp"

#include <doctest/doctest.h>

#include <memory>
#include <string>
#include <thread>
#include <vector>

using namespace bris;

namespace {

struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

/// What `use` makes a progress of this style print.
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

} // namespace

TEST_SUITE("engine/progress") {
    TEST_CASE("elsewhere than on a terminal there are whole lines, and few") {
        const std::string text = printed(1, Progress::Style::lines, [](Progress& progress) {
            for (int i = 0; i < 1000; ++i) progress.report(0, i / 1000.0, "shear");
            progress.report(0, 1, "done");
        });
        CHECK(text == "  0 %  shear  eta --:--\n100 %  done  eta 00:00\n");
    }

    TEST_CASE("on a terminal one line is rewritten and ended") {
        const std::string text = printed(1, Progress::Style::rewritten, [](Progress& progress) {
            progress.report(0, 0.5, "shear");
            progress.report(0, 1, "done");
        });
        CHECK(text == "\r 50 %  shear  eta --:--\x1b[K\r100 %  done  eta 00:00\x1b[K\n");
    }

    TEST_CASE("quiet prints nothing") {
        CHECK(printed(1, Progress::Style::quiet, [](Progress& progress) {
                  progress.report(0, 0.5, "shear");
              }).empty());
    }

    TEST_CASE("two worlds on two threads share a line") {
        const std::string text = printed(2, Progress::Style::lines, [](Progress& progress) {
            std::vector<std::jthread> worlds;
            for (unsigned slot = 0; slot < 2; ++slot)
                worlds.emplace_back([&progress, slot] {
                    for (int i = 0; i <= 1000; ++i)
                        progress.report(slot, i / 1000.0, slot ? "b" : "a");
                });
        });
        CHECK(text.ends_with("100 %  a  |  100 %  b  eta 00:00\n"));
    }
}
