#pragma once

#include "engine/simulation.hpp"
#include "systems/build/specimen.hpp"

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
    double porosity = 0.32;             ///< of the core
    double porosity_tolerance = 0.005;
    double friction = 0.7;              ///< real one, from consolidation on
    double compaction_friction = 0.0;
    double compaction_pressure = 1e6;   ///< of the top platen on the vibrated rocks
    double vibration = 2.5e-4;          ///< speed of a rock while compacted: of its bounding radius in a step
    double tolerance = 1e-3;            ///< unbalanced force ratio of an equilibrium
    double pressure_tolerance = 0.01;   ///< of each ring's pressure, relative
    double damping = 0.7;               ///< local, but for compaction
    unsigned lifts = 4;
    unsigned move_steps = 60;           ///< over which the platen moves in a stage: a multiple of ramp_parts
    unsigned longest_stage = 100000;    ///< steps, beyond which an equilibrium has stalled; a specimen that slips takes 20 000
    unsigned longest_compaction = 400000; ///< steps, beyond which the porosity is not reached; most seeds take 30 000 to 100 000, a few twice that
    double safety = 0.9;                ///< of the stable step in mass scaling
    bool mass_scaling = true;           ///< from consolidation on; else true masses, and a step that follows the contacts
    bool gravity = false;               ///< keep weight during the test
};

enum class TriaxialPhase : std::uint32_t { fill, compact, consolidate, shear, done };

/// What was measured at the end of a stage (or of consolidation). Compression positive.
struct TriaxialPoint {
    double axial_strain = 0;           ///< -, platen travel / height at the start of shearing
    double volumetric_strain = 0;      ///< -, of the polygon's volume
    double axial_stress = 0;           ///< Pa, mean force on the platens / (volume / height)
    double radial_stress = 0;          ///< Pa, of the rings, weighted by their areas
    double deviatoric_stress = 0;      ///< Pa
    double boundary_axial = 0, boundary_radial = 0; ///< Pa, all boundary forces times their places over the volume
    double contact_axial = 0, contact_radial = 0;   ///< Pa, Love-Weber: contact forces times branch vectors
    double unbalanced = 0;             ///< -
    double worst_ring_error = 0;       ///< -, largest relative error of a ring's pressure
    double mean_ring_error = 0;        ///< -
    double coordination = 0;           ///< touching rocks per rock
    double inertial_number = 0;        ///< -, strain rate of the move * mean size * sqrt(density / mean stress), scaled masses
    double boundary_work = 0, friction_work = 0, damping_work = 0, scaling_work = 0; ///< J, since the specimen was begun
    double stored = 0, kinetic = 0;    ///< J, now: elastic, and of weight if it acts
    double steps = 0;                  ///< of this stage
    std::vector<double> ring_radius;   ///< m, mean of the ring's elements

    /// Calls visit(name, unit, number) for each number but the rings'.
    void visit(auto&& visit_one) {
        visit_one("axial_strain", "", axial_strain);
        visit_one("volumetric_strain", "", volumetric_strain);
        visit_one("axial_stress", "Pa", axial_stress);
        visit_one("radial_stress", "Pa", radial_stress);
        visit_one("deviatoric_stress", "Pa", deviatoric_stress);
        visit_one("boundary_stress_axial", "Pa", boundary_axial);
        visit_one("boundary_stress_radial", "Pa", boundary_radial);
        visit_one("contact_stress_axial", "Pa", contact_axial);
        visit_one("contact_stress_radial", "Pa", contact_radial);
        visit_one("unbalanced_ratio", "", unbalanced);
        visit_one("mean_ring_error", "", mean_ring_error);
        visit_one("worst_ring_error", "", worst_ring_error);
        visit_one("coordination_number", "", coordination);
        visit_one("inertial_number", "", inertial_number);
        visit_one("boundary_work", "J", boundary_work);
        visit_one("stored_energy", "J", stored);
        visit_one("friction_work", "J", friction_work);
        visit_one("damping_work", "J", damping_work);
        visit_one("scaling_work", "J", scaling_work);
        visit_one("kinetic_energy", "J", kinetic);
        visit_one("steps", "", steps);
    }
};

void save_points(Archive& archive, const std::string& path, const std::vector<TriaxialPoint>& points);
std::vector<TriaxialPoint> load_points(const Archive& archive, const std::string& path);

/// Where the test is: enough to go on in the middle of anything.
struct TriaxialState {
    static constexpr auto name = "triaxial_state";
    static constexpr bool is_state = true;

    TriaxialPhase phase = TriaxialPhase::fill;
    std::uint64_t lift = 0, stage = 0;
    std::uint64_t phase_steps = 0;    ///< since the phase, lift or stage began
    double height = 0;                ///< m, at the start of shearing
    double volume = 0;                ///< m3, inside membrane and platens, likewise
    double drift = 0;                 ///< m, largest of a sensor rock from its given position to the start of shearing
    double core_porosity = 0, global_porosity = 0; ///< at the start of shearing
    double prepared_porosity = 0;     ///< of the core, at the end of compaction
    double turn = 0;                  ///< rad, largest of a sensor rock, likewise
    std::vector<TriaxialPoint> points; ///< one at the start of shearing, one at the end of each stage

    static auto fields(auto& self) {
        return std::tie(self.height, self.volume, self.drift, self.turn, self.core_porosity, self.global_porosity,
                        self.prepared_porosity);
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

    /// Leaves out filling and compaction: the rocks stand in the mould already, free, full-grown and at rest.
    void begin_compacted();

    /// Masses and step anew for the contacts there are; after their properties were changed from outside.
    void rescale();

    const TriaxialState& state() const;
    /// 0 to 1, and what is going on, for the progress line.
    double fraction() const;
    std::string description() const;

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
    TriaxialPoint measure_point() const;

    Simulation& simulation_;
    TriaxialSettings settings_;
};

} // namespace bris
