#pragma once

#include "engine/system.hpp"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace bris {

/// How the task graph is run; every choice gives the same bits.
struct ScheduleSettings {
    /// Systems that share no data run at once, as tasks of oneTBB. Otherwise they run one after
    /// another, which measurement prefers: the loops of each system then keep all threads busy, and
    /// each thread finds its part of the bodies in its cache.
    bool overlap = false;
    bool fused = true;    ///< runs adjacent row-local systems in one pass over the rows
    bool combined = true; ///< with `fused`: systems may be replaced by one that combines them
    /// Another valid order: of the systems that could run next, the last one runs.
    bool last_order = false;
    bool timed = false; ///< measures the wall time per node
    /// Number of rows of all tables from which on several threads pay; handing work to another
    /// thread takes some microseconds per system.
    std::size_t least_rows = 4000;
    /// Rows per chunk of row-local systems; 0: chosen from the numbers of rows and threads.
    std::size_t grain = 0;
};

/// Turns the step list into a task graph. The order of the list defines the result; two systems are
/// connected by an edge if they access the same data and one of them writes it. A system is left
/// out if the scene lacks data that it needs (absent), if no system reads what it derives
/// (unwanted), and in steps in which it is not due. Adjacent systems that are row-local on the same
/// table become one node. In place of consecutive nodes a system runs that combines exactly theirs.
class Schedule {
public:
    explicit Schedule(StepList steps, ScheduleSettings settings = {});
    ~Schedule();
    Schedule(Schedule&&) noexcept;
    Schedule& operator=(Schedule&&) noexcept;

    /// Binds the systems to a world; called again whenever a table, column or resource has been
    /// added. Throws std::logic_error if a required system lacks a column.
    void prepare(World& world);
    /// Runs one step. Must be called inside Threads::run.
    void run(World& world);

    /// Lists the systems that run, with reads, writes and predecessors, those that are left out and
    /// why, and the graph in DOT format.
    std::string explain() const;
    /// Seconds per node name since prepare(), if timed.
    std::map<std::string, double> seconds() const;

private:
    struct Bound;
    struct Plan;
    Plan& plan_for(std::uint64_t due);
    std::vector<bool> live_systems(std::uint64_t due) const;
    void combine(Plan& plan) const;
    /// Number of nodes from `first` on whose systems are exactly those named; 0: they are not.
    std::size_t combined_nodes(const Plan& plan, std::size_t first,
                               const std::vector<std::string>& names) const;
    void run_node(Plan& plan, std::size_t node, World& world);

    StepList steps_;
    ScheduleSettings settings_;
    std::vector<std::string> missing_;  // per system, empty if present
    std::vector<System::Call> calls_;   // per system, empty if absent
    std::vector<const Table*> chunked_; // per system, table of a row-local one
    std::map<std::uint64_t, std::unique_ptr<Plan>> plans_;
    std::uint64_t last_due_ = 0;
    Plan* last_plan_ = nullptr;
    std::vector<std::size_t> conditional_; // systems with a `due`
};

} // namespace bris
