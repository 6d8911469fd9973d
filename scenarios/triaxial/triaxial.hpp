#pragma once

#include "engine/progress.hpp"
#include "engine/simulation.hpp"
#include "scenarios/records/test_curves.hpp"
#include "scenarios/specimens/specimen.hpp"
#include "scenarios/triaxial/load_cycles.hpp"

#include <string>
#include <tuple>
#include <vector>

namespace bris {

/// Parts of a stage's ramp, over which the platen speeds up and slows down.
inline constexpr unsigned ramp_parts = 12;
/// Factor on the guard's limit of overlaps (Limits) while rocks are vibrated and tapped: a large
/// rock may for a moment press a small one into the membrane or a platen by more than is allowed in
/// a test.
inline constexpr double allowance_when_shaken = 2;

/// How a triaxial test is prepared and run; lengths in m, pressures in Pa.
struct TriaxialSettings {
    double confining_pressure = 55e3;
    double stage_strain = 1e-4;
    double final_axial_strain = 0.08;
    std::string preparation = "laboratory"; ///< or "report"
    double porosity = 0;                    ///< of the core; 0: that of the preparation
    double porosity_tolerance = 0.005;      ///< at the start of shearing
    double core_porosity() const {
        return porosity > 0 ? porosity : preparation == "report" ? 0.32 : 0.38;
    }
    /// Friction coefficient between rocks and between rock and platen, from consolidation on.
    double friction = 0.7;
    /// Of the rocks while the specimen is made; below 0: that of the test.
    double preparation_friction = -1;
    unsigned taps = 4;               ///< at least; 0: none
    double preparation_pressure = 0; ///< of the top platen; 0: follows from the stiffness
    /// From all sides, in the trial consolidation that decides on a prepared specimen.
    double trial_pressure = 110e3;
    double tolerance = 1e-3;          ///< unbalanced force ratio of an equilibrium
    double pressure_tolerance = 0.01; ///< relative, of the pressure of each ring
    double damping = 0.7;             ///< local damping, except during vibration
    /// Steps over which the platen moves in a stage: a multiple of ramp_parts.
    unsigned move_steps = 60;
    /// Steps after which an equilibrium has stalled; a specimen that slips takes 20 000.
    unsigned longest_stage = 100000;
    /// Steps of compression, of vibration or of taps after which the preparation has failed.
    unsigned longest_preparation = 400000;
    double safety = 0.9; ///< time step as a fraction of the stable step
    /// Scale masses from consolidation on; otherwise masses are true and the time step follows the
    /// contacts.
    bool mass_scaling = true;
    bool gravity = false;   ///< from consolidation on; while the specimen is made there is none
    LoadCycles cycles = {}; ///< after consolidation, instead of shearing
};

enum class TriaxialPhase : std::uint32_t {
    fill,
    compress,
    vibrate,
    tap,
    consolidate,
    shear,
    done,
    cycle
};

/// The state of a test, sufficient to resume from any block of steps.
struct TriaxialState {
    static constexpr auto name = "triaxial_state";
    static constexpr bool is_state = true;

    TriaxialPhase phase = TriaxialPhase::fill;
    std::uint64_t stage = 0;
    std::uint64_t phase_steps = 0; ///< since the phase or stage began
    double height = 0;             ///< m, at the start of shearing
    double volume = 0;             ///< m3, inside membrane and platens, at the start of shearing
    /// m, largest displacement of a sensor rock from its given position, at the start of shearing.
    double drift = 0;
    double core_porosity = 0, global_porosity = 0; ///< at the start of shearing
    double prepared_porosity = 0; ///< of the core, last measured during preparation
    /// Of the core: as poured, and that at which compression ends and taps begin.
    double poured_porosity = 0, porosity_before_taps = 0;
    double densest_porosity = 1;        ///< during vibration
    double preparation_friction = 0;    ///< now, during compression
    std::uint64_t taps = 0, rounds = 0; ///< taps of this round, rounds of compression and taps
    /// Core porosity at which the preparation aims: the one asked for, minus the change that trial
    /// consolidations have shown.
    double aim = 0;
    std::uint64_t trials = 0; ///< trial consolidations so far
    bool accepted = false;    ///< by the last of them
    /// rad, largest rotation of a sensor rock from its given attitude, at the start of shearing.
    double rotation = 0;
    /// One row at the start of shearing, and one at the end of each stage; of load cycles, of those
    /// that are shown (is_shown_cycle) and the last one, whose number is the stage.
    TestCurves curves;
    CyclicState cyclic;

    static auto fields(auto& self) {
        return std::tie(self.height, self.volume, self.drift, self.rotation, self.core_porosity,
                        self.global_porosity, self.prepared_porosity, self.poured_porosity,
                        self.porosity_before_taps, self.preparation_friction, self.densest_porosity,
                        self.aim);
    }
    void save(Archive& archive) const;
    void load(const Archive& archive);
};

/// Runs a triaxial test block by block, so that it can be observed, saved and stopped after any
/// block. The members are defined by phase in fill.cpp, compress.cpp, vibrate.cpp, tap.cpp,
/// trial.cpp, consolidate.cpp, shear.cpp and cycle.cpp.
class TriaxialTest {
public:
    TriaxialTest(Simulation& simulation, TriaxialSettings settings);

    /// Runs one block of about 20 to 200 steps; returns false when the test is done. Throws
    /// SimulationError when an equilibrium stalls or nothing carries load.
    bool advance();

    /// Skips the preparation: the rocks already stand in the mould, free, at full size and
    /// at rest.
    void begin_compacted();

    /// Of a prepared specimen whose consolidation has not begun: accepts it if the core porosity
    /// after a trial consolidation is the one asked for; otherwise prepares it again, aiming at a
    /// porosity that differs by as much. Throws SimulationError if that does not meet it either,
    /// time after time.
    void judge(double porosity_after_trial);

    /// Scales masses and time step anew for the present contacts; required after contact properties
    /// were changed from outside.
    void rescale();

    const TriaxialState& state() const;
    PhaseProgress progress() const;

private:
    void start_filling();
    void fill();
    double preparation_friction() const;
    void press_platen();
    void start_compression();
    void continue_compression();
    void compress();
    void start_vibration();
    void vibrate();
    void start_taps();
    void tap();
    void prepare_again(double off);
    void return_to_mould();
    void measure_porosity();
    bool rests_under_platen(double unbalanced_ratio) const;
    bool is_late() const;
    void start_consolidation();
    void consolidate();
    void start_shear();
    void shear();
    void start_cycles();
    void cycle();
    void start_half_cycle();
    void end_half_cycle();
    void end_cycle();
    void add_load_point();
    bool masses_are_scaled() const;
    void move_platen();
    bool analyse();
    void add_stage();
    void run(std::uint64_t steps);
    void keep_stable();
    bool is_in_equilibrium();
    PhaseProgress filling_progress() const;
    std::string preparation_status() const;
    std::string consolidation_status() const;
    std::string equilibrium_status() const;
    PhaseProgress cycles_progress() const;

    Simulation& simulation_;
    TriaxialSettings settings_;
    // of the last check of equilibrium, for the progress line
    double unbalanced_ratio_ = 1, pressure_error_ = 1, stress_mismatch_ = 0;
};

} // namespace bris
