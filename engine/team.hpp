#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>

namespace bris::detail {

using ChunkBody = void (*)(void* context, std::size_t chunk);

/// The chunks of one loop, divided among threads. Each thread has consecutive chunks of its own and
/// takes them from the front: in all loops over the same bodies nearly the same part, whose rows
/// are then in its cache. A thread that has none left takes those of others, from the back.
class Division {
public:
    explicit Division(unsigned threads) : threads_(threads), parts_(new Part[threads]) {}
    void divide(std::size_t chunks);
    /// Computes chunks as thread `own`, until none is left.
    void work(unsigned own, ChunkBody body, void* context);

private:
    struct alignas(64) Part {
        std::atomic<std::uint64_t> left{0}; ///< first chunk; in the upper half the end
        bool take(bool from_back, std::size_t& chunk);
    };
    unsigned threads_;
    std::unique_ptr<Part[]> parts_;
};

/// Threads that work on one loop after another, no more of them than there are processors or two.
/// Those that help wait for the next loop without sleeping, because a step has many loops and some
/// of them take a few microseconds; after a longer pause they leave, and are called again.
class Team {
public:
    /// Lets help() run on some other thread, now or later.
    using Call = std::function<void(const std::function<void()>& help)>;

    Team(unsigned threads, Call call);
    /// All calls must have come back: leave() first.
    ~Team() = default;
    Team(const Team&) = delete;

    /// Runs all chunks; returns when they are done. Rethrows what a chunk has thrown. To be called
    /// by one thread, not from within a chunk.
    void run(std::size_t chunks, ChunkBody body, void* context);
    /// Lets the others leave.
    void leave() { ends_ = true; }

private:
    struct alignas(64) Seat {
        std::atomic<bool> taken{false}, inside{false};
    };
    void help(unsigned seat);
    void work(unsigned seat);

    unsigned seated_; ///< threads that work
    Call call_;
    Division division_;
    ChunkBody body_ = nullptr;
    void* context_ = nullptr;
    std::exception_ptr error_;
    std::unique_ptr<Seat[]> seats_; ///< the first is the caller's
    std::atomic<bool> ends_{false}, failed_{false};
    alignas(64) std::atomic<std::uint64_t> loop_{0}; ///< odd: loop (n + 1) / 2 is open
};

} // namespace bris::detail
