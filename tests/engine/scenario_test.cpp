#include "engine/assets.hpp"
#include "engine/errors.hpp"
#include "engine/exit_codes.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/scenario.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cctype>
#include <new>

using namespace bris;

namespace {

struct Nothing {
    double height = 1;
    void declare_options(auto& option) {
        option("height", height, "m", "of the specimen", above(0));
    }
};

template <class Run>
int exit_code(std::vector<std::string> arguments, Run run) {
    arguments.insert(arguments.begin(), "scenario");
    std::vector<char*> pointers;
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    return run_scenario<Nothing>(static_cast<int>(pointers.size()), pointers.data(),
                                 {"nothing", "Does nothing."}, run);
}

} // namespace

TEST_SUITE("engine/scenario") {
    TEST_CASE("a scenario receives its settings and the common ones") {
        const TemporaryDirectory directory;
        const std::string out = (directory / "a" / "b").string();
        Common common;
        double height = 0;
        bool is_there = false;
        const int code = exit_code(
            {"--height", "2", "--out", out, "--threads", "3", "--memory", "512", "--quiet"},
            [&](const Nothing& settings, const Common& given) {
                common = given;
                height = settings.height;
                is_there = std::filesystem::is_directory(given.out);
            });
        CHECK(code == 0);
        CHECK(height == 2);
        CHECK(common.scenario == "nothing");
        CHECK(common.threads == 3);
        CHECK(common.memory_limit == std::uint64_t{512} << 30);
        CHECK(common.quiet);
        CHECK(common.seed == 1);
        CHECK(is_there);
        REQUIRE_FALSE(common.settings.empty());
        CHECK(common.settings.front().key == "height_m");
        CHECK(common.arguments.size() == 9);
    }

    TEST_CASE("each kind of error has its exit code") {
        const TemporaryDirectory directory;
        const std::string out = directory.path().string();
        const auto code_after = [&](auto throwing) {
            return exit_code({"--out", out}, [&](const Nothing&, const Common&) { throwing(); });
        };
        CHECK(code_after([] {}) == 0);
        CHECK(code_after([] { throw InputError("message of an input error"); }) == 2);
        CHECK(code_after([] { throw SimulationError("message of a guard"); }) == 3);
        CHECK(code_after([] { throw OutputError("message about files"); }) == 4);
        CHECK(code_after([] { throw Interrupted("message of an interruption"); }) == 130);
        CHECK(code_after([] { throw std::bad_alloc(); }) == 3);
        CHECK(code_after([] { throw std::logic_error("message of a mistake"); }) == 1);
        CHECK(code_after([] { std::filesystem::current_path("/none"); }) == 4);
    }

    TEST_CASE("bad flags end with 2, a directory that cannot be made with 4, --help with 0") {
        bool ran = false;
        const auto run = [&](const Nothing&, const Common&) { ran = true; };
        CHECK(exit_code({"--hight", "2"}, run) == 2);
        CHECK(exit_code({"--height", "-2"}, run) == 2);
        CHECK(exit_code({"--threads", "many"}, run) == 2);
        CHECK(exit_code({"--out", "/proc/none"}, run) == 4);
        CHECK(exit_code({"--help"}, run) == 0);
        CHECK(exit_code({"--version"}, run) == 0);
        CHECK_FALSE(ran);
    }

    TEST_CASE("--help and the user's guide give the same meaning of every exit code, and README "
              "names it") {
        const std::string help = Options().help("nothing", "Does nothing.");
        const auto words = [](std::string text) {
            std::erase_if(text, [](char c) { return c == '`' || std::isspace(c) != 0; });
            return text;
        };
        for (const auto& [code, meaning] : exit_codes) {
            const int number = static_cast<int>(code);
            CAPTURE(number);
            CHECK(words(help).find(words(fmt::format("{} {}", number, meaning))) !=
                  std::string::npos);
            const auto page = [&](const char* name) {
                return read_whole(assets_folder().parent_path() / name);
            };
            CHECK(words(page("scenarios/README.md"))
                      .find(words(fmt::format("| {} | {} |", number, meaning))) !=
                  std::string::npos);
            CHECK(page("README.md").find(fmt::format("`{}` ", number)) != std::string::npos);
        }
    }

    TEST_CASE("a run that fails before it has written anything leaves no folder") {
        const TemporaryDirectory directory;
        const auto out = directory / "a" / "b";
        const auto code_after = [&](auto throwing) {
            return exit_code({"--out", out}, [&](const Nothing&, const Common&) { throwing(); });
        };
        CHECK(code_after([] { throw OutputError("cannot read 'recordings.csv'"); }) == 4);
        CHECK_FALSE(std::filesystem::exists(directory / "a"));
        CHECK(code_after([] { throw SimulationError("message of a guard"); }) == 3);
        CHECK_FALSE(std::filesystem::exists(directory / "a"));
        CHECK(code_after([] {}) == 0); // as after --list
        CHECK_FALSE(std::filesystem::exists(directory / "a"));
    }

    TEST_CASE("a scenario that refuses its input leaves no empty folder, and keeps what it wrote") {
        const TemporaryDirectory directory;
        const auto refuse = [](const Nothing&, const Common&) {
            throw InputError("message of an input error");
        };
        CHECK(exit_code({"--out", directory / "a" / "b" / ""}, refuse) == 2);
        CHECK_FALSE(std::filesystem::exists(directory / "a"));
        CHECK(exit_code({"--out", directory.path()}, refuse) == 2); // made by someone else
        CHECK(std::filesystem::exists(directory.path()));
        CHECK(exit_code({"--out", directory / "a" / "b"}, [&](const Nothing& n, const Common& c) {
                  write_whole(c.out / "quality_control.txt", "why it is refused");
                  refuse(n, c);
              }) == 2);
        CHECK(std::filesystem::exists(directory / "a" / "b" / "quality_control.txt"));
    }

    TEST_CASE(
        "a common flag that a scenario cannot honour is refused by name, before anything runs") {
        const TemporaryDirectory directory;
        const auto out = directory / "results";
        bool ran = false;
        const auto code = [&](std::vector<std::string> flags) {
            flags.insert(flags.begin(), {"scenario", "--out", out.string()});
            std::vector<char*> pointers;
            for (std::string& flag : flags) pointers.push_back(flag.data());
            return run_scenario<Nothing>(
                static_cast<int>(pointers.size()), pointers.data(),
                {"nothing", "Does nothing.", "it takes a moment", "nothing is simulated"},
                [&](const Nothing&, const Common&) { ran = true; });
        };
        CHECK(code({"--resume", directory.path().string()}) == 2);
        CHECK(code({"--explain"}) == 2);
        CHECK_FALSE(ran);
        CHECK_FALSE(std::filesystem::exists(out));
        CHECK(code({}) == 0);
        CHECK(ran);
    }

    TEST_CASE("a checkpoint that is not there ends with 4, and nothing is written") {
        const TemporaryDirectory directory;
        const auto out = directory / "results";
        bool ran = false;
        CHECK(exit_code({"--out", out.string(), "--resume", (directory / "none").string()},
                        [&](const Nothing&, const Common&) { ran = true; }) == 4);
        CHECK_FALSE(ran);
        CHECK_FALSE(std::filesystem::exists(out));
    }

    TEST_CASE("--explain explains and runs nothing, and makes no folder") {
        const TemporaryDirectory directory;
        const auto out = directory / "results";
        std::vector<std::string> flags{"scenario", "--out", out.string(), "--explain"};
        std::vector<char*> pointers;
        for (std::string& flag : flags) pointers.push_back(flag.data());
        bool ran = false, explained = false;
        const int code = run_scenario<Nothing>(
            4, pointers.data(), {"nothing", "Does nothing."},
            [&](const Nothing&, const Common&) { ran = true; },
            [&](const Nothing&, const Common&) {
                explained = true;
                return std::string("a schedule");
            });
        CHECK(code == 0);
        CHECK(explained);
        CHECK_FALSE(ran);
        CHECK_FALSE(std::filesystem::exists(out));
    }
}
