#include "engine/io/gnuplot.hpp"

#include "engine/child_program.hpp"
#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/message.hpp"
#include "engine/ranks.hpp"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <sys/mman.h>
#include <unistd.h>

namespace bris {

namespace {

/// A file in memory for another program, which may go on when this one is ended: nothing stays.
class FileInMemory {
public:
    FileInMemory() : handle_(memfd_create("gnuplot", MFD_CLOEXEC)) {
        if (handle_ < 0) throw OutputError(std::strerror(errno));
    }
    ~FileInMemory() { close(handle_); }
    FileInMemory(const FileInMemory&) = delete;

    int handle() const { return handle_; }
    void write(std::string_view text) {
        while (!text.empty()) {
            const ssize_t count = ::write(handle_, text.data(), text.size());
            if (count <= 0) throw OutputError(std::strerror(errno));
            text.remove_prefix(static_cast<std::size_t>(count));
        }
    }
    void to_begin() { lseek(handle_, 0, SEEK_SET); }
    std::string content() {
        to_begin();
        std::string text;
        std::array<char, 1 << 14> block{};
        while (true) {
            const ssize_t count = read(handle_, block.data(), block.size());
            if (count <= 0) return text;
            text.append(block.data(), static_cast<std::size_t>(count));
        }
    }

private:
    int handle_;
};

/// Whether the last chunk of a PNG is there: gnuplot does not notice where it cannot write.
bool is_complete(const std::string& png) {
    return png.ends_with(std::string_view{"\0\0\0\0IEND\xae\x42\x60\x82", 12});
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

bool draw_with_gnuplot(const std::filesystem::path& png, unsigned width, unsigned height,
                       std::string_view commands, std::string_view data) {
    if (!Ranks::writes()) return true;
    try {
        FileInMemory input, picture;
        input.write(fmt::format("set encoding utf8\n"
                                "set terminal pngcairo noenhanced size {},{} font 'DejaVu Sans,11' "
                                "background '#ffffff'\n",
                                width, height));
        input.write(commands);
        input.write(data);
        input.to_begin();
        const int code =
            ChildProgram({"gnuplot"},
                         {.input = input.handle(), .output = picture.handle(), .is_silent = true})
                .wait();
        if (code != 0 && interrupted()) return false; // Ctrl-C has ended gnuplot too
        if (code != 0) return complain(png, "gnuplot failed");
        const std::string drawn = picture.content();
        if (!is_complete(drawn)) return complain(png, "cannot write the file");
        write_whole(png, drawn);
        return true;
    } catch (const OutputError& problem) {
        return complain(png, problem.what());
    }
}

} // namespace bris
