#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <string>
#include <sys/types.h>
#include <vector>

namespace bris {

/// Work in a child process that may take `bytes` of memory beyond what this process has, and
/// `seconds` of processor time; it passes its results through a pipe. For libraries that damaged
/// input can crash. The child has one thread, writes nothing to the terminal and never returns.
class LimitedChild {
public:
    struct Limits {
        std::uint64_t bytes;
        unsigned seconds;
    };
    /// The writing end of the pipe, for the work. Small pieces are collected: each write to a pipe
    /// may cost two changes between the processes.
    class Pipe {
    public:
        explicit Pipe(int descriptor) : descriptor_(descriptor) {}
        void write(const void* data, std::size_t size); ///< throws OutputError
        void flush();                                   ///< throws OutputError

    private:
        int descriptor_;
        std::vector<char> waiting_;
    };

    /// Starts `work(pipe)`. Throws OutputError if the system cannot start a process.
    template <class Work>
    LimitedChild(const Limits& limits, Work&& work) : limits_(limits) {
        const int pipe = start();
        if (pipe < 0) return; // this is the parent
        try {
            Pipe to_parent(pipe);
            work(to_parent);
            to_parent.flush();
        } catch (const std::exception&) {
            end(false);
        }
        end(true);
    }
    LimitedChild(const LimitedChild&) = delete;
    LimitedChild& operator=(const LimitedChild&) = delete;
    ~LimitedChild(); ///< ends the child if it still runs

    /// Waits for the next `size` bytes. Throws OutputError with what ended the child if fewer came.
    void read(void* data, std::size_t size);

private:
    int start(); ///< returns the writing end in the child, and -1 in the parent
    [[noreturn]] static void end(bool well);
    void receive();
    std::string wait_for_reason();

    Limits limits_;
    pid_t id_ = -1;
    int pipe_ = -1; ///< reading end
    std::vector<char> received_;
    std::size_t taken_ = 0; ///< of `received_`
};

} // namespace bris
