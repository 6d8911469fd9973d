#pragma once

#include "engine/stopwatch.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace bris {

/// Lines as they come: from the standard input ("-"), from a pipe, or from a file that grows. A
/// thread of its own takes them and stamps them with the time; they wait in a queue. When it is
/// full no more is read, so who writes into a pipe waits; nothing is lost.
class LineSource {
public:
    struct Line {
        std::uint64_t number; ///< from 1 on
        std::string text;     ///< without its end
        Instant arrived;
        bool whole = true; ///< false: cut off by the end of the input, or longer than `longest`
    };
    static constexpr std::size_t longest =
        1 << 16; ///< bytes of a line; what follows of it is skipped

    /// Throws OutputError if it cannot be opened.
    explicit LineSource(const std::filesystem::path& path, std::size_t capacity = 100'000);
    ~LineSource();

    /// The next line; waits for it at most `timeout` (s). Nothing: none came, the input has ended,
    /// or the user stops the run.
    std::optional<Line> next(double timeout);
    /// Whether the input has ended and all was taken. A file that grows never ends.
    bool over() const;

private:
    struct Reader;
    std::unique_ptr<Reader> reader_;
};

} // namespace bris
