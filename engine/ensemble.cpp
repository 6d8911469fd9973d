#include "engine/ensemble.hpp"

#include <algorithm>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace bris {

namespace {

/// Hands out job numbers and keeps the error of the lowest-numbered job; any thread may call it.
class Queue {
public:
    explicit Queue(std::size_t jobs) : jobs_(jobs) {}

    bool take(std::size_t& job) {
        const std::lock_guard lock(mutex_);
        if (error_ || next_ == jobs_) return false;
        job = next_++;
        return true;
    }
    void fail(std::size_t job, std::exception_ptr error) {
        const std::lock_guard lock(mutex_);
        if (error_ && failed_ < job) return;
        error_ = std::move(error);
        failed_ = job;
    }
    void rethrow() const {
        if (error_) std::rethrow_exception(error_);
    }

private:
    std::mutex mutex_;
    std::size_t jobs_, next_ = 0, failed_ = 0;
    std::exception_ptr error_;
};

} // namespace

void run_ensemble(std::size_t jobs, unsigned at_once,
                  const std::function<void(std::size_t job)>& run) {
    Queue queue(jobs);
    const auto work = [&] {
        for (std::size_t job = 0; queue.take(job);) {
            try {
                run(job);
            } catch (...) {
                queue.fail(job, std::current_exception());
            }
        }
    };
    if (at_once == 0) at_once = std::max(1u, std::thread::hardware_concurrency());
    {
        // joined at the end of the block, also if one of them cannot start
        std::vector<std::jthread> others;
        for (std::size_t i = 1; i < std::min<std::size_t>(jobs, at_once); ++i)
            others.emplace_back(work);
        work();
    }
    queue.rethrow();
}

} // namespace bris
