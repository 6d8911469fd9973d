#include "engine/team.hpp"

#include "engine/stopwatch.hpp"

#include <algorithm>
#include <thread>
#include <utility>

namespace bris::detail {

namespace {

std::uint64_t packed(std::size_t first, std::size_t last) { return last << 32 | first; }

/// Waits without sleeping: first on the processor, then leaving it to others.
class Patience {
public:
    void wait() {
        constexpr unsigned spins = 1000; // some twenty microseconds
        if (spins_ < spins) {
            ++spins_;
#ifdef __x86_64__
            __builtin_ia32_pause();
#endif
            return;
        }
        if (spins_++ == spins) since_ = this_instant();
        std::this_thread::yield();
        spins_ = spins + 1;
        over_ = seconds_since(since_) > 3e-4;
    }
    bool is_over() const { return over_; }

private:
    unsigned spins_ = 0;
    Instant since_;
    bool over_ = false;
};

} // namespace

void Division::divide(std::size_t chunks) {
    for (std::size_t t = 0; t < threads_; ++t)
        parts_[t].left.store(packed(chunks * t / threads_, chunks * (t + 1) / threads_),
                             std::memory_order_relaxed);
}

bool Division::Part::take(bool from_back, std::size_t& chunk) {
    std::uint64_t now = left.load(std::memory_order_relaxed);
    for (;;) {
        const std::size_t first = now & 0xffffffff, last = now >> 32;
        if (first >= last) return false;
        chunk = from_back ? last - 1 : first;
        const std::uint64_t then = from_back ? packed(first, last - 1) : packed(first + 1, last);
        if (left.compare_exchange_weak(now, then, std::memory_order_relaxed)) return true;
    }
}

void Division::work(unsigned own, ChunkBody body, void* context) {
    for (unsigned k = 0; k < threads_; ++k)
        for (std::size_t chunk = 0; parts_[(own + k) % threads_].take(k > 0, chunk);)
            body(context, chunk);
}

// more threads than processors would only wait for each other
Team::Team(unsigned threads, Call call)
    : seated_(std::min(threads, std::max(2u, std::thread::hardware_concurrency()))),
      call_(std::move(call)), division_(seated_), seats_(new Seat[seated_]) {}

void Team::work(unsigned seat) {
    try {
        division_.work(seat, body_, context_);
    } catch (...) {
        if (!failed_.exchange(true)) error_ = std::current_exception();
    }
}

void Team::help(unsigned seat) {
    Seat& own = seats_[seat];
    std::uint64_t last = 0;
    for (Patience patience; !ends_;) {
        const std::uint64_t now = loop_;
        if (now == last || now % 2 == 0) {
            if (!patience.is_over()) {
                patience.wait();
                continue;
            }
            // the caller opens a loop and then looks who is there; only one of both may miss it
            own.taken = false;
            if (loop_ == now || own.taken.exchange(true)) return;
            patience = {};
            continue;
        }
        // the caller closes a loop and then looks whether anyone is inside
        own.inside = true;
        if (loop_ == now) work(seat);
        own.inside.store(false, std::memory_order_release);
        last = now;
        patience = {};
    }
    own.taken = false;
}

void Team::run(std::size_t chunks, ChunkBody body, void* context) {
    division_.divide(chunks);
    body_ = body;
    context_ = context;
    ++loop_;
    for (unsigned seat = 1; seat < seated_ && seat < chunks; ++seat) {
        if (seats_[seat].taken || seats_[seat].taken.exchange(true)) continue;
        try {
            call_([this, seat] { help(seat); });
        } catch (...) {
            seats_[seat].taken = false; // the loop goes on without this one
        }
    }
    work(0);
    ++loop_;
    for (unsigned seat = 1; seat < seated_; ++seat)
        for (Patience patience; seats_[seat].inside;) patience.wait();
    if (failed_.exchange(false)) std::rethrow_exception(std::exchange(error_, nullptr));
}

} // namespace bris::detail
