#pragma once

#include "engine/archive.hpp"

#include <optional>
#include <string>
#include <vector>

namespace bris {

/// State of a triaxial test at the end of a stage (or of consolidation). Compression is positive.
struct TriaxialPoint {
    double axial_strain = 0;      ///< displacement of the platen / height at the start of shearing
    double volumetric_strain = 0; ///< of the volume within the polygon of the membrane
    double axial_stress = 0;      ///< Pa, mean force on the platens / (volume / height)
    double radial_stress = 0;     ///< Pa, mean of the rings, weighted by their areas
    double deviatoric_stress = 0; ///< Pa
    /// All boundary forces times their positions, over the volume, Pa.
    double boundary_axial = 0, boundary_radial = 0;
    /// Love-Weber stress: contact forces times branch vectors, over the volume, Pa.
    double contact_axial = 0, contact_radial = 0;
    double unbalanced = 0;       ///< unbalanced force ratio
    double worst_ring_error = 0; ///< largest relative error of the pressure of a ring
    double mean_ring_error = 0;  ///< mean of these errors
    double coordination = 0;     ///< touching rocks per rock
    /// Strain rate of the stage * mean size * sqrt(density / mean stress), with scaled masses.
    double inertial_number = 0;
    /// Work since the start of the specimen, J.
    double boundary_work = 0, friction_work = 0, damping_work = 0, scaling_work = 0;
    /// Current energies, J: elastic (with gravitational energy if gravity acts) and kinetic.
    double stored = 0, kinetic = 0;
    double steps = 0;                ///< number of time steps of this stage
    std::vector<double> ring_radius; ///< m, mean of the elements of each ring

    /// Calls visit_one(name, unit, number) for each number except the ring radii.
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

/// Stores points in an archive under `path`, and loads them.
void save_points(Archive& archive, const std::string& path,
                 const std::vector<TriaxialPoint>& points);
std::vector<TriaxialPoint> load_points(const Archive& archive, const std::string& path);

/// Index of the stage nearest to an axial strain, within `tolerance`; nothing: there is none.
std::optional<std::size_t> stage_at(const std::vector<TriaxialPoint>& points, double strain,
                                    double tolerance);

/// Name of the folder for the test at this pressure (Pa), such as 55kPa.
std::string folder_of(double pressure);

} // namespace bris
