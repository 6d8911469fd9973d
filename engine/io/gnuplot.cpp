#include "engine/io/gnuplot.hpp"

#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/message.hpp"

#include <fmt/format.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sys/wait.h>
#include <system_error>

namespace bris {

namespace {

/// A gnuplot process that ends early must not end the simulation.
class IgnorePipeSignal {
public:
    IgnorePipeSignal() {
        struct sigaction ignore {};
        ignore.sa_handler = SIG_IGN;
        sigaction(SIGPIPE, &ignore, &before_);
    }
    ~IgnorePipeSignal() { sigaction(SIGPIPE, &before_, nullptr); }
    IgnorePipeSignal(const IgnorePipeSignal&) = delete;
    IgnorePipeSignal& operator=(const IgnorePipeSignal&) = delete;

private:
    struct sigaction before_ {};
};

bool send(std::FILE* to, std::string_view text) {
    return text.empty() || std::fwrite(text.data(), 1, text.size(), to) == text.size();
}

/// Whether the last chunk of a PNG is there: gnuplot does not notice a full disk.
bool is_complete(const std::filesystem::path& png) {
    constexpr std::string_view end{"\0\0\0\0IEND\xae\x42\x60\x82", 12};
    std::ifstream file(png, std::ios::binary);
    file.seekg(-static_cast<std::streamoff>(end.size()), std::ios::end);
    std::string found(end.size(), ' ');
    file.read(found.data(), static_cast<std::streamsize>(found.size()));
    return file && found == end;
}

bool complain(const std::filesystem::path& png, const char* why) {
    say(fmt::format("cannot draw '{}': {}", png.string(), why));
    return false;
}

} // namespace

std::string gnuplot_quoted(const std::string& text) {
    std::string out = "'";
    for (const char c : text) {
        if (c == '\'')
            out += "''";
        else
            out += c == '\n' ? ' ' : c;
    }
    return out + "'";
}

bool draw_with_gnuplot(const std::filesystem::path& name, unsigned width, unsigned height,
                       std::string_view commands, std::string_view data) {
    if (std::system("command -v gnuplot >/dev/null 2>&1") != 0)
        return complain(name, "gnuplot is not installed (Debian package gnuplot-nox)");
    std::filesystem::path png;
    try {
        png = file_to_write(name);
    } catch (const OutputError& problem) {
        return complain(name, problem.what());
    }
    std::error_code error;
    if (png.has_parent_path()) std::filesystem::create_directories(png.parent_path(), error);
    const std::filesystem::path unfinished = temporary_name(png);
    const IgnorePipeSignal guard;
    std::FILE* const gnuplot = popen("gnuplot >/dev/null 2>&1", "w");
    if (!gnuplot) return complain(png, "cannot start gnuplot");
    const std::string head =
        fmt::format("set encoding utf8\n"
                    "set terminal pngcairo noenhanced size {},{} font 'DejaVu Sans,11' "
                    "background '#ffffff'\nset output {}\n",
                    width, height, gnuplot_quoted(unfinished.string()));
    const bool sent = send(gnuplot, head) && send(gnuplot, commands) && send(gnuplot, data);
    const int status = pclose(gnuplot);
    const bool drawn = sent && WIFEXITED(status) && WEXITSTATUS(status) == 0,
               complete = drawn && is_complete(unfinished);
    if (complete) std::filesystem::rename(unfinished, png, error);
    if (!complete || error) {
        std::error_code ignored;
        std::filesystem::remove(unfinished, ignored);
        return complain(png, drawn ? "cannot write the file" : "gnuplot failed");
    }
    return true;
}

} // namespace bris
