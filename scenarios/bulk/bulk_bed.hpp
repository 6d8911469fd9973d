#pragma once

#include "engine/archive.hpp"
#include "engine/options.hpp"
#include "engine/progress.hpp"
#include "engine/simulation.hpp"

#include <string>
#include <tuple>

namespace bris {

// Beds of the bulk cases of Dosta et al. (2024), Comput. Phys. Commun. 296:109066: their materials,
// and the procedure that makes a bed at rest, since the initial states of the paper are not at
// hand.

/// Numbers of the materials in a scene.
struct BulkMaterials {
    std::uint32_t m1 = 0, m2 = 1, steel = 2;
};

/// Adds M1 (1 GPa, 2500 kg/m3), M2 (0.5 GPa, 2000) and steel (210 GPa, 7200), Poisson's ratio 0.2,
/// with the restitution and friction that the paper gives each pair.
BulkMaterials add_bulk_materials(World& world);

/// How hard contacts are now, and how they rub.
struct BulkContacts {
    double stiffness = 1; ///< of Young's moduli
    double friction = 1;  ///< of the pairs' coefficients
    double most_restitution = 1;
};
void set_bulk_contacts(World& world, const BulkContacts& contacts);

enum class BedPhase : std::uint32_t {
    pour,   ///< soft grains fall from a shaken lattice until they hardly move
    harden, ///< stiffness rises stage by stage, slowly enough for the bed as a whole to follow
    rest,   ///< with the law of the run, until the bed is at rest
    ready   ///< the run has begun or may begin
};

/// Where the making of a bed is: State, so that it goes on from a checkpoint.
struct BedState {
    static constexpr auto name = "bed";
    static constexpr bool is_state = true;
    BedPhase phase = BedPhase::pour;
    unsigned stage = 0;       ///< of hardening
    double phase_began = 0;   ///< s
    double kinetic_ratio = 0; ///< when last looked at, see BedSettings
    double unbalanced_ratio = 1;
    double coordination = 0;
    std::uint64_t steps = 0; ///< that it took, when ready
    double time = 0;         ///< s, likewise

    void save(Archive& archive) const;
    void load(const Archive& archive);
};

struct BedSettings {
    double step = 0;             ///< s, of the run
    double stiffness = 1;        ///< of the run, of Young's moduli
    double friction = 1;         ///< of the run, of the pairs' coefficients
    double fill_friction = 1;    ///< while the bed is made, before it rests
    double softness = 0.01;      ///< while pouring, of true Young's moduli; (0, 1]
    double least_pour = 0.1;     ///< s
    double longest_pour = 1.5;   ///< s
    unsigned harden_steps = 300; ///< of a stage, in which stiffness rises by a tenth
    double longest_rest = 0.15;  ///< s
    double kinetic_ratio =
        1e-5; ///< kinetic energy over weight times mean radius, summed over grains, at rest
    double unbalanced_ratio = 0.02; ///< mean unbalanced force over mean force, at rest

    void describe(auto& option);
};

/// Makes the bed in a simulation whose world holds a BedState and grains on a lattice.
class BedMaker {
public:
    BedMaker(Simulation& simulation, const BedSettings& settings);
    /// Some steps; false when the bed is ready.
    bool advance();
    PhaseProgress progress() const;
    /// Whether the bed, as last looked at, rests as its settings say; one that took too long is
    /// used as it is.
    bool at_rest() const;
    /// Sets contacts to those of the phase and of the settings.
    void apply_phase();

private:
    BedState& state();
    const BedState& state() const;
    void enter(BedPhase phase, unsigned stage);
    double stage_stiffness() const;
    void check_state();

    Simulation& simulation_;
    BedSettings settings_;
};

/// Begins the run: time 0 is now, with a step (s).
void start_clock(World& world, double step);

void BedSettings::describe(auto& option) {
    option("stiffness_factor", stiffness, "", "of all Young's moduli; the paper's is 1",
           Range{.low = 0, .high = 1, .low_accepted = false});
    option("friction_factor", friction, "",
           "of all friction coefficients; 0 is the negative control", within(0, 10));
    option("fill_friction_factor", fill_friction, "",
           "likewise, while the bed is poured: more makes it looser", within(0, 100));
    option("fill_softness", softness, "", "of all Young's moduli, while the bed is poured",
           within(1e-4, 1));
    option("longest_rest", longest_rest, "s",
           "that a bed may take to come to rest with the law of the run", at_least(0));
    option("rest_kinetic_ratio", kinetic_ratio, "",
           "kinetic energy over weight times mean radius, at which a bed rests", above(0));
    option("rest_unbalanced_ratio", unbalanced_ratio, "",
           "mean unbalanced over mean force, at which a bed rests", above(0));
}

} // namespace bris
