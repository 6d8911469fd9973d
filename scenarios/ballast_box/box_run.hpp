#pragma once

#include "components/load.hpp"
#include "engine/io/series.hpp"
#include "engine/run.hpp"
#include "engine/simulation.hpp"
#include "scenarios/ballast_box/box_scene.hpp"

#include <cstdint>
#include <vector>

namespace bris {

/// The phases of a test in the ballast box: pouring and compaction of the lifts with soft contacts,
/// hardening, placing and seating of the ties, removal of the shoulder where the run asks for it,
/// and the load cycles.
class BoxTestRun {
public:
    BoxTestRun(Simulation& simulation, const BallastBox& box, std::uint64_t seed);

    std::vector<Phase> preparation();
    /// Steps of the load cycles, and of one of them. The dynamic model needs the time step, which
    /// is chosen when the ties are seated, so that it is known in the last phase only.
    std::uint64_t steps_per_cycle() const;
    std::uint64_t loading_steps() const { return steps_per_cycle() * box_.load_cycles(); }
    /// Starts the load cycles.
    void begin_loading(Simulation& simulation) const;
    Phase loading(const Run& run, Series& cycles, const std::function<void()>& frame);

    const BoxSizes& sizes() const { return sizes_; }

private:
    Phase pour(std::size_t course) const;
    Phase compact(std::size_t course) const;
    Phase harden() const;
    Phase seat() const;
    Phase remove_shoulder() const;
    void set_load(World& world, EntityId body, const LoadHistory& history) const;
    /// Mean load and amplitude of the tie with this number, N.
    std::array<double, 2> tie_load(std::size_t tie) const;
    void add_sample(const World& world, Series& cycles) const;
    /// Inertia of a tie under scaled masses before its contacts are known.
    void scale_tie(World& world, EntityId tie) const;

    Simulation& simulation_;
    BallastBox box_;
    BoxSizes sizes_;
    std::uint64_t seed_;
    double hard_step_; ///< s, of contacts at full stiffness
};

/// Reactions of the model's ties (rows) to unit loads of the actuators above them (columns).
std::vector<std::vector<double>> tie_shares(const BallastBox& box);

} // namespace bris
