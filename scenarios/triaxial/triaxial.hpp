#pragma once

#include "engine/progress.hpp"
#include "engine/simulation.hpp"
#include "scenarios/recordings/triaxial_point.hpp"
#include "scenarios/specimens/specimen.hpp"

#include <string>
#include <tuple>
#include <vector>

namespace bris {

/// Of a stage, in which the platen speeds up and slows down.
inline constexpr unsigned ramp_parts = 12;

/// How a triaxial test is prepared and run; lengths in m, pressures in Pa.
struct TriaxialSettings {
    double confining_pressure = 55e3;
    double stage_strain = 1e-4;
    double final_axial_strain = 0.08;
    double porosity = 0.32; ///< of the core
    double porosity_tolerance = 0.005;
    double friction = 0.7; ///< real one, from consolidation on
    double compaction_friction = 0.0;
    double compaction_pressure = 1e6; ///< of the top platen on the vibrated rocks
    double vibration =
        2.5e-4;              ///< speed of a rock while compacted: of its bounding radius in a step
    double tolerance = 1e-3; ///< unbalanced force ratio of an equilibrium
    double pressure_tolerance = 0.01; ///< of each ring's pressure, relative
    double damping = 0.7;             ///< local, but for compaction
    unsigned lifts = 4;
    unsigned move_steps = 60; ///< over which the platen moves in a stage: a multiple of ramp_parts
    unsigned longest_stage = 100000; ///< steps, beyond which an equilibrium has stalled; a specimen
                                     ///< that slips takes 20 000
    unsigned longest_compaction = 400000; ///< steps, beyond which the porosity is not reached; most
                                          ///< seeds take 30 000 to 100 000, a few twice that
    double safety = 0.9;                  ///< of the stable step in mass scaling
    bool mass_scaling =
        true; ///< from consolidation on; else true masses, and a step that follows the contacts
    bool gravity = false; ///< keep weight during the test
};

enum class TriaxialPhase : std::uint32_t { fill, compact, consolidate, shear, done };

/// Where the test is: enough to go on in the middle of anything.
struct TriaxialState {
    static constexpr auto name = "triaxial_state";
    static constexpr bool is_state = true;

    TriaxialPhase phase = TriaxialPhase::fill;
    std::uint64_t lift = 0, stage = 0;
    std::uint64_t phase_steps = 0; ///< since the phase, lift or stage began
    double height = 0;             ///< m, at the start of shearing
    double volume = 0;             ///< m3, inside membrane and platens, likewise
    double drift =
        0; ///< m, largest of a sensor rock from its given position to the start of shearing
    double core_porosity = 0, global_porosity = 0; ///< at the start of shearing
    double prepared_porosity = 0;                  ///< of the core, at the end of compaction
    double turn = 0;                               ///< rad, largest of a sensor rock, likewise
    std::vector<TriaxialPoint>
        points; ///< one at the start of shearing, one at the end of each stage

    static auto fields(auto& self) {
        return std::tie(self.height, self.volume, self.drift, self.turn, self.core_porosity,
                        self.global_porosity, self.prepared_porosity);
    }
    void save(Archive& archive) const;
    void load(const Archive& archive);
};

/// Runs a triaxial test block by block, so that it can be watched, saved and stopped anywhere.
class TriaxialTest {
public:
    TriaxialTest(Simulation& simulation, TriaxialSettings settings);

    /// One block of steps (25 to 200); returns false when the test is done. Throws SimulationError
    /// when an equilibrium stalls or nothing carries load.
    bool advance();

    /// Leaves out filling and compaction: the rocks stand in the mould already, free, full-grown
    /// and at rest.
    void begin_compacted();

    /// Masses and step anew for the contacts there are; after their properties were changed from
    /// outside.
    void rescale();

    const TriaxialState& state() const;
    PhaseProgress progress() const;

private:
    void start_lift();
    void fill();
    void start_compaction();
    void compact();
    void start_consolidation();
    void consolidate();
    void start_shear();
    void shear();
    void move_platen();
    bool analyse();
    void run(std::uint64_t steps);
    void keep_stable();
    bool is_in_equilibrium() const;
    TriaxialPoint compute_point() const;

    Simulation& simulation_;
    TriaxialSettings settings_;
};

} // namespace bris
