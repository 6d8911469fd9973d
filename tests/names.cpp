// reads every header and checks that a type has one home: no other header of its namespace defines
// one of the same name

#include "components/kinds.hpp"
#include "systems/output/contact_list.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <string>

namespace fs = std::filesystem;

TEST_SUITE("names") {
    TEST_CASE("no two headers define types of one name, of which a program would take either") {
        const fs::path root = BRIS_SOURCE;
        const std::regex opening("^namespace ([a-z_:]+) \\{"),
            type("^(?:struct|class|enum class) ([A-Z]\\w*)(?: final)?(?: : [^;]*)? \\{");
        std::map<std::string, std::string> home; // header, by the name of the type
        for (const char* folder : {"engine", "components", "systems", "scenarios", "tests"})
            for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
                const std::string file = fs::relative(entry.path(), root).generic_string();
                // benchmarks are programs of their own
                if (!file.ends_with(".hpp") || file.starts_with("tests/performance")) continue;
                std::ifstream in(entry.path());
                std::string space;
                std::smatch found;
                for (std::string line; std::getline(in, line);) {
                    if (std::regex_search(line, found, opening)) space = found[1];
                    if (!std::regex_search(line, found, type)) continue;
                    const std::string name = space + "::" + found[1].str();
                    const auto [at, is_new] = home.emplace(name, file);
                    CHECK_MESSAGE(is_new, file, ": ", name, " is also defined by ", at->second);
                }
            }
        CHECK(home.size() > 500);
    }

    TEST_CASE("every kind of pair has a name in lists of contacts") {
        std::size_t kinds = 0;
        bris::for_each_kind_of_pair([&]<class>() { ++kinds; });
        CHECK(kinds == bris::contact_kinds.size());
    }
}
