// reads every #include of the project and checks it against the rules for includes between folders

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace {

namespace fs = std::filesystem;

struct Include {
    std::string file; // path relative to the root of the checkout
    int line = 0;
    std::string target; // between the quotes or brackets
    bool quoted = false;
};

bool within(const std::string& path, const std::string& folder) {
    return path.starts_with(folder + "/");
}

std::vector<Include> includes_of(const fs::path& root, const fs::path& file) {
    std::vector<Include> list;
    std::ifstream in(file);
    std::string line;
    for (int number = 1; std::getline(in, line); ++number) {
        const auto hash = line.find_first_not_of(" \t");
        if (hash == std::string::npos || line[hash] != '#') continue;
        const auto word = line.find("include", hash);
        const auto open = line.find_first_of("\"<", hash);
        if (word == std::string::npos || open == std::string::npos || word > open) continue;
        const auto close = line.find_first_of("\">", open + 1);
        list.push_back({.file = fs::relative(file, root).generic_string(),
                        .line = number,
                        .target = line.substr(open + 1, close - open - 1),
                        .quoted = line[open] == '"'});
    }
    return list;
}

std::vector<Include> all_includes(const fs::path& root) {
    std::vector<Include> list;
    for (const char* folder : {"engine", "components", "systems", "scenarios", "tests/verification",
                               "tests/stability"}) {
        if (!fs::exists(root / folder)) continue;
        for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
            const auto extension = entry.path().extension();
            if (extension != ".hpp" && extension != ".cpp") continue;
            const auto found = includes_of(root, entry.path());
            list.insert(list.end(), found.begin(), found.end());
        }
    }
    return list;
}

/// "systems/contact/gather.hpp" -> "contact", "systems/steps.cpp" -> "steps",
/// "scenarios/settle.cpp" -> "settle".
std::string room(const std::string& path) {
    const std::string remaining = path.substr(path.find('/') + 1);
    return remaining.substr(0, remaining.find_first_of("/."));
}

/// The folders of systems/ do not include each other; only the list of steps, and systems in steps/
/// that combine others, include them all. All may include loads/, whose list of force elements is
/// read by whoever must know the forces on bodies.
bool may_include_system(const std::string& file, const std::string& target) {
    return within(file, "scenarios") || within(file, "tests") ||
           (within(file, "systems") &&
            (room(file) == room(target) || room(file) == "steps" || room(target) == "loads"));
}

/// The folders of scenarios/ in order. Each may include those before it; the executables may
/// include all.
constexpr std::array rooms{"rocks",       "sensors",  "records", "specimens",   "collision",
                           "stream",      "triaxial", "bulk",    "ballast_box", "track",
                           "field_tests", "ensemble", "library", "monitoring",  "forecast",
                           "network",     "command",  "python"};

bool may_include_room(const std::string& file, const std::string& target) {
    const auto order = [](const std::string& path) {
        return static_cast<std::size_t>(std::ranges::find(rooms, room(path)) - rooms.begin());
    };
    const auto is_executable = [](const std::string& path) {
        return std::ranges::count(path, '/') == 1;
    };
    if (is_executable(target) || order(target) == rooms.size()) return false;
    return is_executable(file) || within(file, "tests") || order(target) <= order(file);
}

/// Two suites of tests are programs: verify and stress. They stand above the rooms of scenarios/
/// and do not include each other, nor, but in their doctest files, what doctest programs share.
bool may_include_suite(const std::string& file, const std::string& target) {
    const bool is_shared = std::ranges::count(target, '/') == 1;
    return is_shared ? file.ends_with("_test.cpp") : room(file) == room(target);
}

/// engine/io, signal and estimation stand on what is basic in engine/, and do not include each
/// other; what directs a run stands on engine/io. The exceptions are named.
bool may_include_engine(const std::string& file, const std::string& target) {
    static const std::set<std::string> basic{
        "engine/archive.hpp",      "engine/child_program.hpp", "engine/errors.hpp",
        "engine/interrupt.hpp",    "engine/math.hpp",          "engine/message.hpp",
        "engine/named_value.hpp",  "engine/options.hpp",       "engine/printable.hpp",
        "engine/random.hpp",       "engine/random_vector.hpp", "engine/ranks.hpp",
        "engine/state_source.hpp", "engine/stopwatch.hpp",     "engine/version.hpp"};
    static const std::set<std::string> of_the_run{"engine/options.cpp", "engine/resume.hpp",
                                                  "engine/run_page.cpp", "engine/summary.cpp"};
    static const std::set<std::pair<std::string, std::string>> exceptions{
        {"engine/estimation/motion_filter.hpp", "engine/signal/attitude.hpp"},
        {"engine/signal/spectrum.cpp", "engine/estimation/chi_squared.hpp"}};
    const auto part = [](const std::string& path) {
        return std::ranges::count(path, '/') == 1 ? std::string() : room(path);
    };
    if (!within(file, "engine") || part(file) == part(target)) return true;
    if (part(target).empty()) return basic.contains(target);
    if (part(file).empty()) return part(target) == "io" && of_the_run.contains(file);
    return exceptions.contains({file, target});
}

bool may_include_house(const std::string& file, const std::string& target) {
    static const std::set<std::string> for_components{
        "engine/archive.hpp", "engine/clock.hpp",     "engine/health.hpp",
        "engine/entity.hpp",  "engine/math.hpp",      "engine/component.hpp",
        "engine/lanes.hpp",   "engine/lane_math.hpp", "engine/signal/true_motion.hpp",
        "engine/ranks.hpp",   "engine/exact_sum.hpp"};
    if (within(target, "engine"))
        return may_include_engine(file, target) &&
               (!within(file, "components") || for_components.contains(target));
    if (within(target, "components")) return !within(file, "engine");
    if (within(target, "systems")) return may_include_system(file, target);
    if (within(target, "scenarios"))
        return (within(file, "scenarios") || within(file, "tests")) &&
               may_include_room(file, target);
    // or a path that does not start at the root
    return within(target, "tests") && within(file, "tests") && may_include_suite(file, target);
}

struct Library {
    std::vector<std::string> beginnings; // of the paths of its headers
    std::vector<std::string> homes;      // where it may be included: files, or folder/*.cpp
};

bool is_at_home(const std::string& file, const Library& library) {
    return std::any_of(library.homes.begin(), library.homes.end(), [&](const std::string& home) {
        if (!home.ends_with("*.cpp")) return file == home;
        return within(file, home.substr(0, home.size() - 6)) && file.ends_with(".cpp");
    });
}

bool may_include_library(const std::string& file, const std::string& target) {
    static const std::array<Library, 9> libraries{{
        {{"tbb/", "oneapi/"},
         {"engine/parallel.hpp", "engine/parallel.cpp", "engine/schedule.cpp"}},
        {{"hdf5", "H5"}, {"engine/io/hdf5_library.hpp"}},
        {{"nanoflann"}, {"scenarios/rocks/nearest_point.cpp"}},
        {{"openvdb/"}, {"systems/fields/*.cpp", "scenarios/rocks/fill_clump.cpp"}},
        {{"nlohmann/"},
         {"engine/summary.cpp", "engine/io/json_members.cpp", "engine/io/signs_of_life.cpp",
          "scenarios/monitoring/publisher.cpp", "scenarios/monitoring/published_numbers.cpp",
          "scenarios/stream/recording_replay.cpp"}},
        {{"mosquitto", "mqtt_protocol"},
         {"engine/io/broker_client.cpp", "engine/io/mqtt_packets.hpp",
          "engine/io/mqtt_packets.cpp"}},
        {{"boost/"},
         {"engine/estimation/chi_squared.cpp", "engine/estimation/moderated_variance.cpp",
          "engine/estimation/pooled_variance.cpp", "engine/estimation/student_t.cpp",
          "tests/detection.cpp"}},
        {{"unsupported/"}, {"engine/signal/fft.cpp"}},
        {{"mpi"}, {"engine/ranks.cpp"}},
    }};
    return std::none_of(libraries.begin(), libraries.end(), [&](const Library& library) {
        return std::any_of(library.beginnings.begin(), library.beginnings.end(),
                           [&](const std::string& start) { return target.starts_with(start); }) &&
               !is_at_home(file, library);
    });
}

} // namespace

TEST_SUITE("layering") {
    TEST_CASE("every include follows the rules for includes") {
        const fs::path root = BRIS_SOURCE;
        const auto includes = all_includes(root);
        REQUIRE(includes.size() > 100);
        for (const Include& include : includes) {
            const bool allowed = include.quoted ? may_include_house(include.file, include.target)
                                                : may_include_library(include.file, include.target);
            CHECK_MESSAGE(allowed, include.file, ":", include.line, ": may not include ",
                          include.target);
            if (include.quoted)
                CHECK_MESSAGE(fs::exists(root / include.target), include.file, ":", include.line,
                              ": no such file: ", include.target);
        }
    }

    TEST_CASE("the rules allow permitted includes and reject forbidden ones") {
        CHECK(may_include_house("systems/contact/a.cpp", "components/body.hpp"));
        CHECK(may_include_house("systems/steps.cpp", "systems/contact/collide.hpp"));
        CHECK(may_include_house("components/sphere.hpp", "engine/lanes.hpp"));
        CHECK(may_include_house("scenarios/settle.cpp", "systems/output/frames.hpp"));
        CHECK(may_include_house("scenarios/triaxial.cpp", "scenarios/ensemble/misfit.hpp"));
        CHECK(may_include_house("scenarios/specimens/relax.cpp", "systems/steps.hpp"));
        CHECK(
            may_include_house("scenarios/triaxial/shear.cpp", "scenarios/records/test_curves.hpp"));
        CHECK_FALSE(may_include_house("scenarios/sensors/recording.cpp",
                                      "scenarios/triaxial/triaxial.hpp"));
        CHECK_FALSE(
            may_include_house("scenarios/rocks/grading.cpp", "scenarios/specimens/scene.hpp"));
        CHECK_FALSE(may_include_house("scenarios/triaxial/shear.cpp", "scenarios/triaxial.cpp"));
        CHECK_FALSE(may_include_house("systems/contact/a.cpp", "systems/output/frames.hpp"));
        CHECK(may_include_house("systems/contact/a.cpp", "systems/loads/table.hpp"));
        CHECK_FALSE(may_include_house("systems/loads/a.cpp", "systems/contact/stable_step.hpp"));
        CHECK_FALSE(may_include_house("systems/contact/a.cpp", "systems/steps.hpp"));
        CHECK_FALSE(may_include_house("systems/steps.cpp", "scenarios/specimens/scene.hpp"));
        CHECK_FALSE(may_include_house("engine/world.cpp", "components/body.hpp"));
        CHECK(may_include_house("engine/io/csv.cpp", "engine/errors.hpp"));
        CHECK(may_include_house("engine/summary.cpp", "engine/io/whole_file.hpp"));
        CHECK_FALSE(may_include_house("engine/world.cpp", "engine/io/csv.hpp"));
        CHECK_FALSE(may_include_house("engine/io/csv.cpp", "engine/simulation.hpp"));
        CHECK_FALSE(may_include_house("engine/io/csv.cpp", "engine/signal/fft.hpp"));
        CHECK_FALSE(may_include_house("components/body.hpp", "engine/world.hpp"));
        CHECK_FALSE(may_include_house("systems/guard.cpp", "tests/support.hpp"));
        CHECK_FALSE(may_include_house("systems/contact/a.cpp", "collide.hpp"));
        CHECK(may_include_library("systems/fields/porosity.cpp", "openvdb/openvdb.h"));
        CHECK(may_include_library("engine/schedule.cpp", "oneapi/tbb/flow_graph.h"));
        CHECK_FALSE(may_include_library("systems/fields/porosity.hpp", "openvdb/openvdb.h"));
        CHECK_FALSE(may_include_library("systems/steps.cpp", "tbb/parallel_for.h"));
        CHECK_FALSE(may_include_library("engine/io/run_file.cpp", "hdf5.h"));
        CHECK(may_include_library("engine/summary.cpp", "nlohmann/json.hpp"));
        CHECK_FALSE(may_include_library("engine/summary.hpp", "nlohmann/json_fwd.hpp"));
    }
}
