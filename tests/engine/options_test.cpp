#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/options.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <limits>

using namespace bris;

namespace {

struct Test {
    double confining_pressure = 55e3;
    double friction = 0.5;
    unsigned bodies = 4000;
    std::uint64_t seed = 1;
    bool membrane = true;
    std::string law = "linear";
    std::vector<double> stages{0, 0.08};
    std::filesystem::path config;

    void declare_options(auto& option) {
        option("confining_pressure", confining_pressure, "Pa", "Pressure on the membrane.",
               above(0));
        option("friction", friction, "-", "Friction coefficient of the rocks.", within(0, 1));
        option("bodies", bodies, "", "Number of rocks. Default: as many as fit.", at_least(1));
        option("seed", seed, "", "Seed of every random draw.");
        option("membrane", membrane, "", "Surround the specimen by a membrane.");
        option("law", law, "", "Contact law.", {"linear", "hertz"});
        option("stages", stages, "-",
               "Axial strains of the stages, each of which ends in an equilibrium before the next "
               "one begins.",
               within(0, 1));
        option("config", config, "", "File with settings.");
    }
    bool parse(const std::vector<std::string>& arguments) {
        Options options;
        declare_options(options);
        return options.parse(arguments) == Options::Request::run;
    }
};

std::string complaint(const std::vector<std::string>& arguments) {
    return message_of<InputError>([&] { Test().parse(arguments); });
}

enum class Shape { sphere, clump };

const std::vector<std::string>& texts_of(Shape) {
    static const std::vector<std::string> texts{"sphere", "clump"};
    return texts;
}

} // namespace

TEST_SUITE("engine/options") {
    TEST_CASE("an option may be one of an enumeration, whose texts are what a user sees") {
        Shape shape = Shape::clump;
        Options options;
        options("shape", shape, "", "Shape of the grains.");
        CHECK(options.values().front().text() == "clump");
        CHECK(
            options.help("a", "").find("--shape <name>\n      Shape of the grains. One of sphere, "
                                       "clump. Default: clump.") != std::string::npos);
        (void)options.parse({"--shape", "sphere"});
        CHECK(shape == Shape::sphere);
        CHECK(options.values().front().text() == "sphere");
        CHECK(message_of<InputError>([&] {
                  (void)options.parse({"--shape", "cube"});
              }) == "--shape: expected one of sphere, clump, found \"cube\"");
        CHECK(shape == Shape::sphere);
        options.take({{"shape", std::string("clump")}}, "settings");
        CHECK(shape == Shape::clump);
    }

    TEST_CASE("flags set the members they name") {
        Test test;
        CHECK(test.parse({"--confining-pressure", "110e3", "--bodies=7", "--membrane", "false",
                          "--law", "hertz", "--stages", "0.1,0.2,0.3", "--seed",
                          "18446744073709551615", "--friction", "+.25"}));
        CHECK(test.confining_pressure == 110e3);
        CHECK(test.bodies == 7);
        CHECK_FALSE(test.membrane);
        CHECK(test.law == "hertz");
        CHECK(test.stages == std::vector<double>{0.1, 0.2, 0.3});
        CHECK(test.seed == std::numeric_limits<std::uint64_t>::max());
        CHECK(test.friction == 0.25);
        CHECK(test.parse({"--membrane"}));
        CHECK(test.membrane);
    }

    TEST_CASE("what is not accepted is said in one line with option, expected and found") {
        CHECK(complaint({"--confining-pressure", "-5"}) ==
              "--confining-pressure: expected a number above 0 (Pa), found \"-5\"");
        CHECK(complaint({"--confining-pressure", "nan"}) ==
              "--confining-pressure: expected a number above 0 (Pa), found \"nan\"");
        CHECK(complaint({"--confining-pressure", "1e3x"}) ==
              "--confining-pressure: expected a number above 0 (Pa), found \"1e3x\"");
        CHECK(complaint({"--friction", "inf"}) ==
              "--friction: expected a number from 0 to 1, found \"inf\"");
        CHECK(complaint({"--bodies", "-3"}) ==
              "--bodies: expected a whole number of at least 1, found \"-3\"");
        CHECK(complaint({"--bodies", "4294967296"}) ==
              "--bodies: expected a whole number of at least 1, found \"4294967296\"");
        CHECK(complaint({"--law", "cubic"}) ==
              "--law: expected one of linear, hertz, found \"cubic\"");
        CHECK(complaint({"--stages", "0.1,2"}) ==
              "--stages: expected numbers from 0 to 1 separated by commas, found \"0.1,2\"");
        CHECK(complaint({"--membrane=maybe"}) ==
              "--membrane: expected true or false, found \"maybe\"");
        CHECK(complaint({"--bodies"}) == "--bodies: expected a value, found nothing");
        CHECK(complaint({"--bodies="}) == "--bodies: expected a value, found nothing");
        CHECK(complaint({"--bodies", "--membrane"}) == "--bodies: expected a value, found nothing");
        CHECK(complaint({"--membrane", "word"}) ==
              "--membrane: expected true or false, found \"word\"");
        CHECK(complaint({"--seed", "18446744073709551616"}) ==
              "--seed: expected a whole number from 0 to 18446744073709551615, found "
              "\"18446744073709551616\"");
        CHECK(complaint({"--bodies", std::string(3'000'000, '1')}).size() < 300);
        CHECK(complaint({"--bodies", "1", "--bodies", "2"}) ==
              "--bodies: expected once, found 2 times");
    }

    TEST_CASE("an unknown name comes with the nearest known one") {
        CHECK(complaint({"--confining_presure", "3"}) ==
              "expected an option, found \"--confining_presure\"; did you mean "
              "--confining-pressure?");
        CHECK(complaint({"--bodys=3"}) ==
              "expected an option, found \"--bodys=3\"; did you mean --bodies?");
        CHECK(complaint({"--xyzzy"}) ==
              "expected an option, found \"--xyzzy\" (--help lists the options)");
        CHECK(complaint({"word"}) ==
              "expected an option, found \"word\" (--help lists the options)");
        CHECK(complaint({"--bodies", "3", "4"}) ==
              "expected an option, found \"4\" (--help lists the options)");
        CHECK(complaint({"-x"}) == "expected an option, found \"-x\" (--help lists the options)");
        CHECK(complaint({"--"}) == "expected an option, found \"--\" (--help lists the options)");
    }

    TEST_CASE("a config file is overruled by flags") {
        const TemporaryDirectory directory;
        const std::string file = (directory / "a.toml").string();
        write_whole(file, "# comment\nconfining_pressure = 110e3 # Pa\n\nlaw = \"hertz\"\n"
                          "stages = [0.1, 0.2]\nmembrane = false\n");
        Test test;
        CHECK(test.parse({"--law", "linear", "--config", file}));
        CHECK(test.confining_pressure == 110e3);
        CHECK(test.law == "linear");
        CHECK(test.stages == std::vector<double>{0.1, 0.2});
        CHECK_FALSE(test.membrane);
    }

    TEST_CASE("an error in a config file has file and line") {
        const TemporaryDirectory directory;
        const std::string file = (directory / "a.toml").string();
        const auto in_file = [&](std::string_view content) {
            write_whole(file, content);
            const std::string message = complaint({"--config", file});
            return message.starts_with(file) ? message.substr(file.size()) : message;
        };
        CHECK(in_file("bodies = 3\nfriction = abc\n") ==
              ":2: friction: expected a number from 0 to 1, found \"abc\"");
        CHECK(in_file("bodys = 3\n") == ":1: expected an option such as bodies, found \"bodys\"");
        CHECK(in_file("bodies = 3\nbodies = 4\n") ==
              ":2: bodies: expected once, found on line 1 already");
        CHECK(in_file("[section]\n") == ":1: expected a line `name = value`, found \"[section]\"");
        CHECK_THROWS_AS(Test().parse({"--config", (directory / "none").string()}), OutputError);
    }

    TEST_CASE("a value may begin with a dash, a flag with two") {
        double shift = 0;
        std::string stream;
        Options options;
        options("shift", shift, "m", "Shift along x.");
        options("stream", stream, "", "Where records come from.");
        CHECK(options.parse({"--shift", "-1.5e-3", "--stream", "-"}) == Options::Request::run);
        CHECK(shift == -1.5e-3);
        CHECK(stream == "-");
        CHECK(options.parse({"--stream=--a=b"}) == Options::Request::run);
        CHECK(stream == "--a=b");
    }

    TEST_CASE("--help and --version change nothing, wherever they stand") {
        Test test;
        Options options;
        test.declare_options(options);
        CHECK(options.parse({"--bodies", "3", "--help"}) == Options::Request::help);
        CHECK(options.parse({"--xyzzy", "-h"}) == Options::Request::help);
        CHECK(options.parse({"--version", "--bodies", "3"}) == Options::Request::version);
        CHECK(test.bodies == 4000);
    }

    TEST_CASE("--help has the sentences of each option, its unit, range, choices and default") {
        Test test;
        Options options;
        options.group("specimen");
        test.declare_options(options);
        const std::string help = options.help("triaxial", "A test.");
        CHECK(help.starts_with(
            "A test.\n\nUsage: triaxial [--option value]...\n\nSpecimen:\n"
            "  --confining-pressure <Pa>\n"
            "      Pressure on the membrane. Above 0. Default: 55000.\n"
            "  --friction <number>\n"
            "      Friction coefficient of the rocks. From 0 to 1. Default: 0.5.\n"
            "  --bodies <integer>\n"
            "      Number of rocks. Default: as many as fit. At least 1.\n"
            "  --seed <integer>\n"
            "      Seed of every random draw. Default: 1.\n"
            "  --membrane\n"
            "      Surround the specimen by a membrane. Default: true.\n"
            "  --law <name>\n"
            "      Contact law. One of linear, hertz. Default: linear.\n"
            "  --stages <number,...>\n"
            "      Axial strains of the stages, each of which ends in an equilibrium before the "
            "next one begins.\n"
            "      From 0 to 1. Default: 0,0.08.\n"
            "  --config <path>\n"
            "      File with settings. Default: none.\n"
            "  --help, -h\n"));
    }

    TEST_CASE("ranges are described with their ends") {
        double x = 0.5;
        const auto expected = [&](const Range& range) {
            Options options;
            options("x", x, "", "A number.", range);
            return message_of<InputError>([&] { options.parse({"--x", "1e300"}); });
        };
        CHECK(expected(above(0, 1)) ==
              "--x: expected a number above 0 and at most 1, found \"1e300\"");
        CHECK(expected(half_open(0, 90)) ==
              "--x: expected a number of at least 0 and below 90, found \"1e300\"");
        CHECK(expected(between(0, 1)) ==
              "--x: expected a number above 0 and below 1, found \"1e300\"");
        CHECK(expected(at_most(3)) == "--x: expected a number of at most 3, found \"1e300\"");
        CHECK(expected(below(3)) == "--x: expected a number below 3, found \"1e300\"");
    }

    TEST_CASE(
        "an unusual value is accepted with a warning that asks whether another unit is meant") {
        const auto warnings_of = [](const std::vector<std::string>& words) {
            double pressure = 55e3, friction = 0.7, off = 0;
            std::vector<double> pressures{55e3};
            Options options;
            options("pressure", pressure, "Pa", "Pressure.", above(0, 1e9).usually(1e3, 1e7));
            options("pressures", pressures, "Pa", "Pressures.", above(0, 1e9).usually(1e3, 1e7));
            options("friction", friction, "", "Friction.", within(0, 100).usually(0, 2));
            options("off", off, "Pa", "0: off.", within(0, 1e9).usually(1e3, 1e7));
            options.parse(words);
            return options.warnings();
        };
        CHECK(warnings_of({}).empty()); // a default is not judged
        CHECK(warnings_of({"--pressure", "1e3", "--pressures", "1e7,55e3", "--friction", "2"})
                  .empty());
        CHECK(warnings_of({"--pressure", "55"}) ==
              std::vector<std::string>{
                  "--pressure: expected usually 1000 to 1e+07 Pa, found 55: 55e3?"});
        CHECK(warnings_of({"--pressures", "110e3,0.055"}) ==
              std::vector<std::string>{
                  "--pressures: expected usually 1000 to 1e+07 Pa, found 0.055: 0.055e6?"});
        CHECK(warnings_of({"--pressure", "5e8"}) ==
              std::vector<std::string>{
                  "--pressure: expected usually 1000 to 1e+07 Pa, found 5e+08: 500000000e-3?"});
        CHECK(warnings_of({"--friction", "35"}) ==
              std::vector<std::string>{"--friction: expected usually 0 to 2, found 35"});
    }

    TEST_CASE("settings are listed with their units") {
        Test test;
        Options options;
        test.declare_options(options);
        options.parse({"--friction", "0.1"});
        const auto values = options.values();
        REQUIRE(values.size() == 8);
        CHECK(values[0].key == "confining_pressure_Pa");
        CHECK(std::get<double>(values[0].value) == 55e3);
        CHECK(values[1].key == "friction");
        CHECK(std::get<double>(values[1].value) == 0.1);
        CHECK(std::get<std::uint64_t>(values[3].value) == 1);
        CHECK(std::get<bool>(values[4].value));
        CHECK(std::get<std::string>(values[6].value) == "0,0.08");
        CHECK(key_with_unit("rate", "1/s") == "rate_per_s");
        CHECK(key_with_unit("density", "kg/m3") == "density_kg_per_m3");
    }
}
