#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace bris {

/// Work in a child process that may take `bytes` of memory beyond what this process has, and
/// `seconds` of processor time; it passes its results through a pipe. For libraries that damaged
/// input can crash. The child has one thread, writes nothing to the terminal and never returns.
///
/// A child may find a lock taken by a thread that only the parent has, and wait for it forever. So
/// a child that has used no processor time for a second, and has sent nothing, is replaced by
/// another one, which does the same work from its beginning. The third one may wait for slow files.
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

    /// What the child does. What it refers to must live as long as the LimitedChild.
    using Work = std::function<void(Pipe&)>;

    /// Starts `work(pipe)`. Throws OutputError if the system cannot start a process.
    LimitedChild(const Limits& limits, Work work);
    LimitedChild(const LimitedChild&) = delete;
    LimitedChild& operator=(const LimitedChild&) = delete;
    ~LimitedChild(); ///< ends the child if it still runs

    /// Waits for the next `size` bytes. Throws OutputError with what ended the child if fewer came.
    void read(void* data, std::size_t size);

private:
    void start();
    void end(); ///< kills the child
    void wait();
    void receive();
    int wait_for_end(); ///< its status, as of waitpid
    std::string reason_of(int status) const;

    Limits limits_;
    Work work_;
    unsigned started_ = 0; ///< number of children
    bool has_sent_ = false;
    pid_t id_ = -1;
    int pipe_ = -1; ///< reading end
    std::vector<char> received_;
    std::size_t taken_ = 0; ///< of `received_`
};

} // namespace bris
