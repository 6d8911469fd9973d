#pragma once

#include "engine/system.hpp"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace bris {

/// How the graph is to be run; every choice gives the same bits.
struct ScheduleSettings {
    bool serial = false;     ///< the list in order, one system after the other
    bool fused = true;       ///< neighbours that work row by row in one pass over the rows
    bool last_order = false; ///< another valid order: of the systems that could be next, the last
    bool timed = false;      ///< wall time per node
    std::size_t least_rows = 4000; ///< of all tables, from which on several threads pay: to hand
                                   ///< work over takes some microseconds a system
    std::size_t grain =
        0; ///< rows a chunk of row-local systems; 0: by the rows and threads that there are
};

/// Turns the step list into what runs. The order of the list is the meaning; an edge joins two
/// systems that touch the same data, one of them writing. Systems are left out when the scene
/// lacks what they need (absent), when nobody reads what they derive (unwanted), and in steps in
/// which they are not due. Neighbours that are row-local on one table become one node.
class Schedule {
public:
    explicit Schedule(StepList steps, ScheduleSettings settings = {});
    ~Schedule();
    Schedule(Schedule&&) noexcept;
    Schedule& operator=(Schedule&&) noexcept;

    /// Binds the systems to a world; again whenever a table, column or resource has appeared.
    /// Throws std::logic_error if a required system lacks a column.
    void prepare(World& world);
    /// One step. Call inside Threads::run.
    void run(World& world);

    /// What runs and what does not and why; reads, writes, predecessors; the graph as DOT.
    std::string explain() const;
    /// Seconds per node name since prepare, if timed.
    std::map<std::string, double> seconds() const;

private:
    struct Bound;
    struct Plan;
    Plan& plan_for(std::uint64_t due);
    std::vector<bool> live_systems(std::uint64_t due) const;
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
