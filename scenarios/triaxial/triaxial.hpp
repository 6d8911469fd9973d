#pragma once

#include "engine/progress.hpp"
#include "engine/simulation.hpp"
#include "scenarios/recordings/triaxial_point.hpp"
#include "scenarios/specimens/specimen.hpp"

#include <string>
#include <tuple>
#include <vector>

namespace bris {

/// Parts of a stage's ramp, over which the platen speeds up and slows down.
inline constexpr unsigned ramp_parts = 12;

/// How a triaxial test is prepared and run; lengths in m, pressures in Pa.
struct TriaxialSettings {
    double confining_pressure = 55e3;
    double stage_strain = 1e-4;
    double final_axial_strain = 0.08;
    double porosity = 0.32; ///< of the core
    double porosity_tolerance = 0.005;
    /// Friction coefficient between rocks and between rock and platen, from consolidation on.
    double friction = 0.7;
    double compaction_friction = 0.0;
    double compaction_pressure = 1e6; ///< of the top platen on the vibrated rocks
    /// Displacement of a rock per step during compaction, as a fraction of its bounding radius.
    double vibration = 2.5e-4;
    double tolerance = 1e-3;          ///< unbalanced force ratio of an equilibrium
    double pressure_tolerance = 0.01; ///< relative, of the pressure of each ring
    double damping = 0.7;             ///< local damping, except during compaction
    unsigned lifts = 4;
    /// Steps over which the platen moves in a stage: a multiple of ramp_parts.
    unsigned move_steps = 60;
    /// Steps after which an equilibrium has stalled; a specimen that slips takes 20 000.
    unsigned longest_stage = 100000;
    /// Steps after which compaction has failed to reach the porosity; most seeds take 30 000 to
    /// 100 000, a few twice that.
    unsigned longest_compaction = 400000;
    double safety = 0.9; ///< time step as a fraction of the stable step
    /// Scale masses from consolidation on; otherwise masses are true and the time step follows the
    /// contacts.
    bool mass_scaling = true;
    bool gravity = false; ///< from consolidation on; while the specimen is made there is none
};

enum class TriaxialPhase : std::uint32_t { fill, compact, consolidate, shear, done };

/// The state of a test, sufficient to resume from any block of steps.
struct TriaxialState {
    static constexpr auto name = "triaxial_state";
    static constexpr bool is_state = true;

    TriaxialPhase phase = TriaxialPhase::fill;
    std::uint64_t lift = 0, stage = 0;
    std::uint64_t phase_steps = 0; ///< since the phase, lift or stage began
    double height = 0;             ///< m, at the start of shearing
    double volume = 0;             ///< m3, inside membrane and platens, at the start of shearing
    /// m, largest displacement of a sensor rock from its given position, at the start of shearing.
    double drift = 0;
    double core_porosity = 0, global_porosity = 0; ///< at the start of shearing
    double prepared_porosity = 0;                  ///< of the core, at the end of compaction
    /// rad, largest rotation of a sensor rock from its given attitude, at the start of shearing.
    double rotation = 0;
    /// One point at the start of shearing, and one at the end of each stage.
    std::vector<TriaxialPoint> points;

    static auto fields(auto& self) {
        return std::tie(self.height, self.volume, self.drift, self.rotation, self.core_porosity,
                        self.global_porosity, self.prepared_porosity);
    }
    void save(Archive& archive) const;
    void load(const Archive& archive);
};

/// Runs a triaxial test block by block, so that it can be observed, saved and stopped after any
/// block. The members are defined by phase in fill.cpp, compact.cpp, consolidate.cpp and shear.cpp.
class TriaxialTest {
public:
    TriaxialTest(Simulation& simulation, TriaxialSettings settings);

    /// Runs one block of about 20 to 200 steps; returns false when the test is done. Throws
    /// SimulationError when an equilibrium stalls or nothing carries load.
    bool advance();

    /// Skips filling and compaction: the rocks already stand in the mould, free, at full size and
    /// at rest.
    void begin_compacted();

    /// Scales masses and time step anew for the present contacts; required after contact properties
    /// were changed from outside.
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
    bool is_in_equilibrium();
    PhaseProgress filling_progress() const;
    std::string compaction_status() const;
    std::string consolidation_status() const;
    TriaxialPoint compute_point() const;

    Simulation& simulation_;
    TriaxialSettings settings_;
    // of the last check of equilibrium, for the progress line
    double unbalanced_ratio_ = 1, pressure_error_ = 1;
};

} // namespace bris
