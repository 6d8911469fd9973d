#pragma once

#include "engine/rows.hpp"

#include <functional>

namespace bris {

/// The pass over rows of a table that may follow a leading system (`leading`) row by row. The
/// schedule offers it while that system runs.
class Follower {
public:
    static constexpr auto name = "follower";
    using Pass = std::function<void(RowRange)>;

    /// Whether a pass is offered. If so, the leading system must run it over all rows, each once;
    /// otherwise, or if it does not ask, the schedule runs the pass after it.
    bool take() {
        taken_ = pass_ != nullptr;
        return taken_;
    }
    /// Runs the pass over rows that are complete; may be called by several threads.
    void run(RowRange rows) const { (*pass_)(rows); }

    /// Offers a pass until the end of a scope.
    class Offer {
    public:
        Offer(Follower& follower, const Pass& pass) : follower_(follower) {
            follower_.pass_ = &pass;
            follower_.taken_ = false;
        }
        ~Offer() { follower_.pass_ = nullptr; }
        Offer(const Offer&) = delete;
        bool is_taken() const { return follower_.taken_; }

    private:
        Follower& follower_;
    };

private:
    const Pass* pass_ = nullptr;
    bool taken_ = false;
};

} // namespace bris
