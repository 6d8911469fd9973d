#include "scenarios/command/programs.hpp"

#include "engine/child_program.hpp"
#include "engine/errors.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <sstream>
#include <unistd.h>

namespace bris {

namespace fs = std::filesystem;

std::vector<std::string> scenario_names() {
    std::istringstream words(BRIS_SCENARIOS); // of the build
    std::vector<std::string> names;
    for (std::string name; words >> name;) names.push_back(name);
    std::ranges::sort(names);
    return names;
}

fs::path program_of(const std::string& scenario) {
    const fs::path here = this_program().parent_path();
    for (const char* folder : {".", "../libexec/bris", "../lib/bris"})
        if (const fs::path program = (here / folder / scenario).lexically_normal();
            access(program.c_str(), X_OK) == 0)
            return program;
    return {};
}

std::string description_of(const fs::path& program) {
    std::array<int, 2> pipe{};
    if (pipe2(pipe.data(), O_CLOEXEC) != 0) throw OutputError(std::strerror(errno));
    std::string help;
    {
        ChildProgram child({program.string(), "--help"}, {.output = pipe[1], .is_silent = true});
        close(pipe[1]);
        std::array<char, 4096> block{};
        for (ssize_t count = 0; (count = read(pipe[0], block.data(), block.size())) > 0;)
            help.append(block.data(), static_cast<std::size_t>(count));
        close(pipe[0]);
        if (child.wait() != 0) return "its --help fails";
    }
    std::string text = help.substr(0, help.find("\n\n"));
    std::ranges::replace(text, '\n', ' ');
    return text;
}

void become(const std::string& scenario, const std::vector<std::string>& arguments) {
    const std::vector<std::string> names = scenario_names();
    require(std::ranges::find(names, scenario) != names.end(),
            fmt::format("run: expected one of {}, found \"{}\"", fmt::join(names, ", "), scenario));
    const std::string program = program_of(scenario).string();
    if (program.empty())
        throw OutputError(
            fmt::format("run: {0} has not been built: scenarios/build {0}", scenario));
    std::vector<std::string> words{program};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    execv(program.c_str(), pointers.data());
    throw OutputError(fmt::format("run: cannot start '{}': {}", program, std::strerror(errno)));
}

fs::path on_path(const std::string& name) {
    const char* const path = std::getenv("PATH");
    std::istringstream folders(path != nullptr ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');)
        if (const fs::path program = fs::path(folder) / name; access(program.c_str(), X_OK) == 0)
            return program;
    return {};
}

} // namespace bris
