#include "engine/schedule.hpp"

#include "engine/parallel.hpp"
#include "engine/stopwatch.hpp"

#include <fmt/format.h>

#ifndef BRIS_STD_THREADS
#include <oneapi/tbb/flow_graph.h>
#endif

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace bris {

namespace {

bool conflict(const System& a, const System& b) {
    if (a.whole_world || b.whole_world) return true;
    for (const Access& x : a.accesses)
        for (const Access& y : b.accesses)
            if ((x.writes || y.writes) && same_data(x, y)) return true;
    return false;
}

// two row-local systems may share a pass if all data that they share belong to the row itself, or
// are written in any order
bool may_share_pass(const System& a, const System& b) {
    for (const Access& x : a.accesses)
        for (const Access& y : b.accesses)
            if ((x.writes || y.writes) && same_data(x, y) && x.table != *a.row_local &&
                !(x.commutes && y.commutes))
                return false;
    return true;
}

/// Rows per chunk of row-local systems: as many as stay in the cache from one system to the next,
/// since each call costs some 50 ns. With several threads there are fewer, in multiples of the
/// lanes, so that no thread waits long for another.
std::size_t rows_per_chunk(std::size_t rows) {
    constexpr std::size_t least = 32, most = 2048;
    const std::size_t threads = team_size();
    return threads == 1 ? most : std::clamp(rows / (4 * threads) / 8 * 8, least, most);
}

bool writes_state(const System& s) {
    return s.whole_world || std::any_of(s.accesses.begin(), s.accesses.end(),
                                        [](const Access& a) { return a.writes && a.is_state; });
}

} // namespace

struct Schedule::Plan {
    struct Node {
        std::vector<std::size_t> systems;
        std::vector<std::size_t> predecessors;
        double seconds = 0;
        std::string name;
    };
    std::vector<Node> nodes;
    std::vector<bool> live;
    // no node can run beside another, so a loop suffices
    bool chain = true;
    Schedule* schedule = nullptr; // schedule of the current run: it may be moved between runs
    World* world = nullptr;
#ifndef BRIS_STD_THREADS
    using GraphNode = tbb::flow::continue_node<tbb::flow::continue_msg>;
    std::unique_ptr<tbb::flow::graph> graph;
    std::unique_ptr<tbb::flow::broadcast_node<tbb::flow::continue_msg>> start;
    std::vector<std::unique_ptr<GraphNode>> graph_nodes;
#endif
};

Schedule::Schedule(StepList steps, ScheduleSettings settings)
    : steps_(std::move(steps)), settings_(settings) {}
Schedule::~Schedule() = default;
Schedule::Schedule(Schedule&&) noexcept = default;
Schedule& Schedule::operator=(Schedule&&) noexcept = default;

void Schedule::prepare(World& world) {
    plans_.clear();
    last_plan_ = nullptr;
    missing_.clear();
    calls_.clear();
    chunked_.clear();
    conditional_.clear();
    for (std::size_t i = 0; i < steps_.size(); ++i) {
        const System& s = steps_[i];
        missing_.push_back(s.missing(world));
        if (s.required && !missing_.back().empty() && s.lacks_only_columns(world))
            throw std::logic_error("the scene does not match its step list: " + s.name + " finds " +
                                   missing_.back());
        calls_.push_back(missing_.back().empty() ? s.bind(world) : System::Call());
        chunked_.push_back(s.row_local ? world.find_table(*s.row_local) : nullptr);
        if (s.due != nullptr && missing_.back().empty()) conditional_.push_back(i);
    }
    constexpr std::size_t most = std::numeric_limits<decltype(last_due_)>::digits; // a bit for each
    if (conditional_.size() > most)
        throw std::logic_error(fmt::format("step list: expected at most {} conditional systems, "
                                           "found {}",
                                           most, conditional_.size()));
}

std::vector<bool> Schedule::live_systems(std::uint64_t due) const {
    const auto runs = [&](std::size_t i) {
        if (!missing_[i].empty() || !steps_[i].combines.empty()) return false;
        for (std::size_t k = 0; k < conditional_.size(); ++k)
            if (conditional_[k] == i) return ((due >> k) & 1) != 0;
        return true;
    };
    std::vector<bool> live(steps_.size(), false);
    const auto is_wanted = [&](const Access& a) {
        if (!a.writes) return false;
        // any reader counts, later in this step or early in the next
        for (std::size_t j = 0; j < steps_.size(); ++j)
            if (live[j])
                for (const Access& b : steps_[j].accesses)
                    if (!b.writes && same_data(a, b)) return true;
        return false;
    };
    for (bool changed = true; changed;) {
        changed = false;
        for (std::size_t i = 0; i < steps_.size(); ++i) {
            if (live[i] || !runs(i)) continue;
            const auto& list = steps_[i].accesses;
            if (writes_state(steps_[i]) || std::any_of(list.begin(), list.end(), is_wanted))
                live[i] = changed = true;
        }
    }
    return live;
}

std::size_t Schedule::combined_nodes(const Plan& plan, std::size_t first,
                                     const std::vector<std::string>& names) const {
    std::size_t found = 0;
    for (std::size_t n = first; n < plan.nodes.size() && found < names.size(); ++n)
        for (const std::size_t i : plan.nodes[n].systems) {
            if (found == names.size() || steps_[i].name != names[found]) return 0;
            if (++found == names.size() && i == plan.nodes[n].systems.back()) return n + 1 - first;
        }
    return 0;
}

void Schedule::combine(Plan& plan) const {
    if (!settings_.combined || !settings_.fused) return;
    for (std::size_t i = 0; i < steps_.size(); ++i) {
        if (steps_[i].combines.empty() || !missing_[i].empty()) continue;
        for (std::size_t n = 0; n < plan.nodes.size(); ++n) {
            const std::size_t count = combined_nodes(plan, n, steps_[i].combines);
            if (count == 0) continue;
            plan.nodes[n].systems = {i};
            plan.nodes[n].name = steps_[i].name;
            const auto next = plan.nodes.begin() + static_cast<std::ptrdiff_t>(n) + 1;
            plan.nodes.erase(next, next + static_cast<std::ptrdiff_t>(count - 1));
            plan.live[i] = true;
        }
    }
}

Schedule::Plan& Schedule::plan_for(std::uint64_t due) {
    auto& slot = plans_[due];
    if (slot) return *slot;
    slot = std::make_unique<Plan>();
    Plan& plan = *slot;
    plan.live = live_systems(due);
    for (std::size_t i = 0; i < steps_.size(); ++i) {
        if (!plan.live[i]) continue;
        const System& s = steps_[i];
        bool joined = false;
        if (settings_.fused && s.row_local && !plan.nodes.empty()) {
            auto& last = plan.nodes.back();
            joined = std::all_of(last.systems.begin(), last.systems.end(), [&](std::size_t j) {
                return steps_[j].row_local == s.row_local && may_share_pass(steps_[j], s);
            });
            if (joined) {
                last.systems.push_back(i);
                last.name += " + " + s.name;
            }
        }
        if (!joined) plan.nodes.push_back({{i}, {}, 0, s.name});
    }
    combine(plan);
    // edges to all earlier conflicting nodes, except those implied by other edges
    std::vector<std::vector<bool>> reach(plan.nodes.size());
    for (std::size_t n = 0; n < plan.nodes.size(); ++n) {
        reach[n].assign(plan.nodes.size(), false);
        for (std::size_t m = n; m-- > 0;) {
            bool dependent = false;
            for (const std::size_t a : plan.nodes[m].systems)
                for (const std::size_t b : plan.nodes[n].systems)
                    dependent = dependent || conflict(steps_[a], steps_[b]);
            if (!dependent || reach[n][m]) continue;
            plan.nodes[n].predecessors.push_back(m);
            reach[n][m] = true;
            for (std::size_t k = 0; k < m; ++k)
                if (reach[m][k]) reach[n][k] = true;
        }
        if (n > 0 && !reach[n][n - 1]) plan.chain = false;
    }
    return plan;
}

void Schedule::run_node(Plan& plan, std::size_t node, World&) {
    auto& n = plan.nodes[node];
    const Instant began = settings_.timed ? this_instant() : Instant{};
    if (const Table* table = chunked_[n.systems.front()]) {
        for_chunks(table->size(),
                   settings_.grain != 0 ? settings_.grain : rows_per_chunk(table->size()),
                   [&](std::size_t, std::size_t first, std::size_t last) {
                       if (table->is_idle(first, last)) return;
                       for (const std::size_t i : n.systems)
                           calls_[i](RowRange{static_cast<Row>(first), static_cast<Row>(last)});
                   });
    } else {
        calls_[n.systems.front()](std::nullopt);
    }
    if (settings_.timed) n.seconds += seconds_since(began);
}

void Schedule::run(World& world) {
    std::uint64_t due = 0;
    for (std::size_t k = 0; k < conditional_.size(); ++k) {
        // adjacent systems often share their condition, which is then evaluated once
        const auto asks = steps_[conditional_[k]].due;
        const bool asked = k > 0 && asks == steps_[conditional_[k - 1]].due;
        if (asked ? ((due >> (k - 1)) & 1) != 0 : asks(world)) due |= std::uint64_t{1} << k;
    }
    if (last_plan_ == nullptr || due != last_due_) {
        last_plan_ = &plan_for(due);
        last_due_ = due;
    }
    Plan& plan = *last_plan_;
    if (settings_.last_order) {
        std::vector<bool> done(plan.nodes.size(), false);
        for (std::size_t k = 0; k < plan.nodes.size(); ++k)
            for (std::size_t n = plan.nodes.size(); n-- > 0;) {
                const auto& before = plan.nodes[n].predecessors;
                if (done[n] || !std::all_of(before.begin(), before.end(),
                                            [&](std::size_t m) { return done[m]; }))
                    continue;
                run_node(plan, n, world);
                done[n] = true;
                break;
            }
        return;
    }
#ifndef BRIS_STD_THREADS
    if (settings_.overlap && !plan.chain && team_size() > 1) {
        if (!plan.graph) {
            // built inside the simulation's arena, because a flow graph runs where it was created
            plan.graph = std::make_unique<tbb::flow::graph>();
            plan.start =
                std::make_unique<tbb::flow::broadcast_node<tbb::flow::continue_msg>>(*plan.graph);
            for (std::size_t n = 0; n < plan.nodes.size(); ++n) {
                plan.graph_nodes.push_back(std::make_unique<Plan::GraphNode>(
                    *plan.graph, [&plan, n](const tbb::flow::continue_msg& message) {
                        plan.schedule->run_node(plan, n, *plan.world);
                        return message;
                    }));
                for (const std::size_t m : plan.nodes[n].predecessors)
                    tbb::flow::make_edge(*plan.graph_nodes[m], *plan.graph_nodes[n]);
                if (plan.nodes[n].predecessors.empty())
                    tbb::flow::make_edge(*plan.start, *plan.graph_nodes[n]);
            }
        }
        plan.schedule = this;
        plan.world = &world;
        const ManyLeaders nodes;
        plan.start->try_put(tbb::flow::continue_msg{});
        plan.graph->wait_for_all();
        return;
    }
#endif
    for (std::size_t n = 0; n < plan.nodes.size(); ++n) run_node(plan, n, world);
}

std::map<std::string, double> Schedule::seconds() const {
    std::map<std::string, double> all;
    for (const auto& [due, plan] : plans_)
        for (const auto& node : plan->nodes) all[node.name] += node.seconds;
    return all;
}

std::string Schedule::explain() const {
    auto& plan = const_cast<Schedule*>(this)->plan_for(~std::uint64_t{0});
    std::string text = "systems that run, in order:\n";
    const auto names = [&](const System& s, bool writes) {
        std::string list;
        for (const Access& a : s.accesses)
            if (a.writes == writes) list += (list.empty() ? "" : ", ") + a.name;
        return s.whole_world ? std::string("everything") : list.empty() ? std::string("-") : list;
    };
    for (const auto& node : plan.nodes) {
        std::string after;
        for (const std::size_t m : node.predecessors)
            after += (after.empty() ? "" : "; ") + plan.nodes[m].name;
        for (const std::size_t i : node.systems) {
            const System& s = steps_[i];
            for (std::size_t k = 0; k < s.combines.size(); ++k)
                text += (k == 0 ? "  in place of " : " + ") + s.combines[k];
            if (!s.combines.empty()) text += "\n";
            text +=
                fmt::format("  {}{}\n    reads  {}\n    writes {}\n", s.name,
                            s.due != nullptr ? " (when due)" : "", names(s, false), names(s, true));
        }
        text +=
            fmt::format("    {}after  {}\n", node.systems.size() > 1 ? "one pass over rows, " : "",
                        after.empty() ? "-" : after);
    }
    text += "systems left out:\n";
    for (std::size_t i = 0; i < steps_.size(); ++i)
        if (!missing_[i].empty())
            text += fmt::format("  {}: absent ({})\n", steps_[i].name, missing_[i]);
        else if (!steps_[i].combines.empty() && !plan.live[i])
            text += fmt::format("  {}: not exactly the systems that it combines run one after "
                                "another\n",
                                steps_[i].name);
        else if (!plan.live[i])
            text +=
                fmt::format("  {}: unwanted (no system reads what it derives)\n", steps_[i].name);
    text += "digraph step {\n";
    for (std::size_t n = 0; n < plan.nodes.size(); ++n) {
        text += fmt::format("  n{} [label=\"{}\"];\n", n, plan.nodes[n].name);
        for (const std::size_t m : plan.nodes[n].predecessors)
            text += fmt::format("  n{} -> n{};\n", m, n);
    }
    return text + "}\n";
}

} // namespace bris
