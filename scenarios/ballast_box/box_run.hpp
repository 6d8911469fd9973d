#pragma once

#include "engine/run.hpp"
#include "engine/simulation.hpp"
#include "scenarios/ballast_box/box_scene.hpp"
#include "scenarios/ballast_box/cycles.hpp"
#include "systems/loads/load.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace bris {

/// The phases of a test in the ballast box: pouring and compaction of the lifts with soft contacts,
/// hardening, placing and seating of the ties, removal of the shoulder where the run asks for it,
/// and the load cycles.
class BoxTestRun {
public:
    BoxTestRun(Simulation& simulation, const BallastBox& box, std::uint64_t seed);

    /// The bed is made in the same way for all runs of table 1, if it is not mixed with fines.
    std::vector<Phase> making_of_bed() const;
    /// Fines and water are put into the bed, the ties are seated, the shoulder is removed, as far
    /// as the run asks for it.
    std::vector<Phase> seating() const;
    /// Both, and between them `save`.
    std::vector<Phase> preparation(std::optional<Phase> save = {}) const;
    /// The ties are laid on the bed and loaded, until all is at rest.
    Phase seat() const;
    /// The bed of a track with its tie, which is seated: mixed with fines and water if the run asks
    /// for them so, else clean and dry, and with its shoulder.
    std::vector<Phase> bed_of_track() const;
    /// Fines and water, if the bed was not mixed with them, and the loss of the shoulder come to a
    /// track that is in use.
    std::vector<Phase> changes_in_use() const;
    /// Steps of the load cycles, and of one of them. The dynamic model needs the time step, which
    /// is chosen when the ties are seated, so that it is known in the last phase only.
    std::uint64_t steps_per_cycle() const;
    std::uint64_t loading_steps() const;
    /// Starts the load cycles.
    void begin_loading(Simulation& simulation) const;
    /// Notes porosity and heights of the bed, from which deflections are measured.
    void note_bed(World& world) const;
    /// Starts a passage over the tie of a bay: `load` is the force on a whole tie, N, from time 0
    /// on, which is now. Recordings begin anew.
    void begin_passage(World& world, LoadHistory load) const;
    Phase loading(const Run& run, SeriesOf<CycleSample>& cycles,
                  const std::function<void()>& frame);

    const BoxSizes& sizes() const { return sizes_; }

private:
    Phase pour(std::size_t course) const;
    Phase compact(std::size_t course) const;
    Phase harden() const;
    Phase foul_bed() const;
    Phase foul_track() const;
    Phase remove_shoulder() const;
    bool is_fouled() const { return fouling_of(box_).any(); }
    bool is_wet() const { return box_test(box_.run).wet; }
    /// Fines, and with them water, are in the bed when it is made.
    bool is_made_fouled() const { return box_.is_mixed() && is_fouled(); }

    /// Ends the scaling of masses with which the bed is made.
    void take_true_masses(World& world) const;
    static const std::vector<CompactionPlate>& plates_of(const World& world, std::size_t lift);
    /// m, mean height of the lower sides of the plates.
    static double plates_height(const World& world, std::size_t lift);
    void load_plates(World& world, std::size_t lift, const LoadHistory& history) const;
    double plate_force(const World& world, std::size_t lift) const; ///< N, mean, of one plate
    void begin_compaction(World& world, std::size_t lift) const;
    /// Returns false when the lift is compacted.
    bool compact_further(World& world, std::size_t lift) const;
    double porosity_of_lift(const World& world, std::size_t lift) const;
    /// Between two heights (m), a mean radius within them and a mean diameter from all sides.
    double porosity_between(const World& world, double low, double high) const;

    /// A phase in which something is done within `steps`, and which ends when the box has come to
    /// rest after that.
    Phase until_rest(const char* name, std::uint64_t steps, std::function<void(Simulation&)> begin,
                     void (*end_of_action)(World&)) const;
    /// Whether forces balance and the ballast carries the ties. Throws SimulationError that names
    /// what is not met if the box has not come to rest within the longest time.
    bool is_at_rest(World& world, const char* phase, std::uint64_t waited) const;
    std::uint64_t ramp_steps() const; ///< of the load when the ties are seated
    void place_ties(Simulation& simulation) const;
    void foul(Simulation& simulation) const;
    void mix_fines(Simulation& simulation) const; ///< before a lift is compacted
    static void wet_stones(World& world);

    /// Materials, time step and recordings of the loaded box.
    void begin_real_time(World& world) const;
    void set_load(World& world, EntityId body, const LoadHistory& history) const;
    /// Mean load and amplitude of the tie with this number, N.
    std::array<double, 2> tie_load(std::size_t tie) const;
    void add_sample(const World& world, SeriesOf<CycleSample>& cycles) const;
    /// Inertia of a tie under scaled masses before its contacts are known.
    void scale_tie(World& world, EntityId tie) const;

    Simulation& simulation_;
    BallastBox box_;
    BoxSizes sizes_;
    std::uint64_t seed_;
    double hard_step_; ///< s, of contacts at full stiffness
};

/// Saves the finished bed as bed.ckpt.h5, for other runs on it, and then calls `saved`. The run
/// must outlive the phase.
Phase save_bed(const Run& run, const std::function<void()>& saved = {});

/// N, weight on a whole tie of both rails (67 kg/m each) and fastenings along its spacing.
inline constexpr double dead_load = 2 * 67 * 9.81 * tie_spacing;
/// N, of a whole tie.
inline constexpr double weight_of_tie = 9.81 * tie_mass;
/// Steps between checks.
inline constexpr std::uint64_t block = 200;
/// Time step over the stable step of scaled masses without dashpots. A dense bed with the dashpots
/// of a restitution of 0.5 is unstable at 0.8.
inline constexpr double scaling_safety = 0.5;

/// Time (s) since the beginning that was noted last.
double since(const World& world);
void note_beginning(World& world);
/// Time step over the stable step while the bed is made.
inline constexpr double making_fraction = 0.7;
/// Factor on the friction of stones, by water.
double friction_of_stones(const World& world);
/// Follows the stable step of the contacts, which must be known, up to `longest` (s).
void adapt_step(World& world, double longest);
/// Raises scaled masses where contacts need it for the present time step.
void raise_masses(World& world);
/// Materials while the bed is made: soft, with strong dashpots.
MakingMaterials making(double softness, double friction = 1);

/// Adds empty fields of fines and water, bounded by the box, to a simulation of a fouled run.
void add_fields(Simulation& simulation, const BallastBox& box);

/// Reactions of the model's ties (rows) to unit loads of the actuators above them (columns).
std::vector<std::vector<double>> tie_shares(const BallastBox& box);

} // namespace bris
