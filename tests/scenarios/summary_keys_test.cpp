// Compares the keys of summary.json in the user's guide with those in the sources, so that neither
// gets a key that the other does not have.

#include "engine/io/whole_file.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <regex>
#include <set>
#include <string>

using namespace bris;

namespace {

using Keys = std::set<std::string>;

std::string source(const char* path) {
    return read_whole(std::filesystem::path(BRIS_SOURCE) / path);
}

/// Adds `before` + first group + `after` of each match.
void collect(Keys& keys, const std::string& text, const char* pattern,
             const std::string& before = "", const std::string& after = "") {
    const std::regex expression(pattern);
    for (auto match = std::sregex_iterator(text.begin(), text.end(), expression);
         match != std::sregex_iterator(); ++match)
        keys.insert(before + match->str(1) + after);
}

Keys keys_of_sources() {
    Keys keys;
    constexpr auto plain = R"re(\badd\("(\w+)",)re", listed = R"re(\{"(\w+)", [\w:]+[.(])re";
    for (const char* path :
         {"engine/run.cpp", "systems/output/quantities.cpp", "scenarios/settle.cpp",
          "scenarios/triaxial.cpp", "scenarios/specimens/fouling_options.cpp",
          "scenarios/smart_triaxial.cpp", "scenarios/library/smart_results.cpp"})
        collect(keys, source(path), plain);
    for (const char* path :
         {"engine/version.cpp", "scenarios/triaxial/triaxial_results.cpp",
          "scenarios/triaxial/cyclic_results.cpp", "scenarios/ensemble/learning_results.cpp"})
        collect(keys, source(path), listed);
    const std::string smart = source("scenarios/library/smart_results.cpp");
    for (const char* whose : {"DEM_only_rmse_", "fused_rmse_"}) {
        const std::regex pair(R"re(\badd_errors\(to, "(\w+)", "(\w*)",)re");
        for (auto match = std::sregex_iterator(smart.begin(), smart.end(), pair);
             match != std::sregex_iterator(); ++match)
            keys.insert(whose + match->str(1) + match->str(2));
    }
    collect(keys, smart, R"re(\badd_errors\(to, "(\w+)",)re", "error_ratio_");
    return keys;
}

Keys keys_of_guide() {
    const std::string guide = source("scenarios/README.md");
    const auto begin = guide.find("### Keys of summary.json"), end = guide.find("\n### ", begin);
    REQUIRE(begin != std::string::npos);
    Keys rows, keys;
    collect(rows, guide.substr(begin, end - begin), R"re(\n\| (`[^|]*`) \|)re");
    for (const std::string& row : rows) collect(keys, row, R"re(`(\w+)`)re");
    return keys;
}

} // namespace

TEST_SUITE("scenarios/summary_keys") {
    TEST_CASE("the guide explains every key of summary.json of settle, triaxial and the main job, "
              "and no other") {
        const Keys written = keys_of_sources(), explained = keys_of_guide();
        CHECK(written.size() > 60);
        for (const std::string& key : written) {
            INFO("written but not explained: " << key);
            CHECK(explained.contains(key));
        }
        for (const std::string& key : explained) {
            INFO("explained but not written: " << key);
            CHECK(written.contains(key));
        }
    }
}
