#pragma once

#include <array>
#include <cstddef>
#include <string>

namespace bris {

/// A quantity of a test: its name in files, its SI unit, and what it is. Its address identifies it.
struct Quantity {
    const char *name, *unit, *meaning;
};

/// All quantities of triaxial tests. Compression is positive. A name with {} stands for several
/// columns, numbered from 1.
namespace quantity {

inline constexpr Quantity axial_strain{"axial_strain", "",
                                       "displacement of the platen / height before shearing"},
    volumetric_strain{"volumetric_strain", "", "of the volume within the polygon of the membrane"},
    axial_stress{"axial_stress", "Pa", "mean force on the platens / (volume / height)"},
    radial_stress{"radial_stress", "Pa", "mean of the rings, weighted by their areas"},
    deviatoric_stress{"deviatoric_stress", "Pa", "axial minus radial stress"},
    smoothed_q{"smoothed_q", "Pa", "mean deviatoric stress over a window of strain"},
    boundary_stress_axial{"boundary_stress_axial", "Pa", "boundary forces * positions / volume"},
    boundary_stress_radial{"boundary_stress_radial", "Pa", "boundary forces * positions / volume"},
    contact_stress_axial{"contact_stress_axial", "Pa", "Love-Weber: forces * branches / volume"},
    contact_stress_radial{"contact_stress_radial", "Pa", "Love-Weber: forces * branches / volume"},
    unbalanced_ratio{"unbalanced_ratio", "", "unbalanced force ratio"},
    mean_ring_error{"mean_ring_error", "", "mean relative error of the pressures of the rings"},
    worst_ring_error{"worst_ring_error", "", "largest relative error of the pressure of a ring"},
    coordination_number{"coordination_number", "", "touching rocks per rock"},
    inertial_number{"inertial_number", "", "rate * size * sqrt(scaled density / mean stress)"},
    boundary_work{"boundary_work", "J", "since the start of the specimen"},
    stored_energy{"stored_energy", "J", "elastic, with gravitational energy if gravity acts"},
    friction_work{"friction_work", "J", "of contacts, since the start of the specimen"},
    damping_work{"damping_work", "J", "since the start of the specimen"},
    scaling_work{"scaling_work", "J", "since the start of the specimen"},
    kinetic_energy{"kinetic_energy", "J", "of the rocks"},
    steps{"steps", "", "number of time steps of this stage"},
    ring_radius{"ring_{}_radius", "m", "mean of the elements of each ring, from below"},
    radial_strain{"ring_{}_radial_strain", "", "of each ring, from below; widening is positive"},
    sensor_motion{"sensor_motion_{}", "", "of a library (LibraryTest::sensors)"},
    displacement_field{"displacement_field_{}", "m", "of a library (LibraryTest::field)"};

/// What a simulated test states at the end of each stage, in the order of files, besides the rings.
inline constexpr std::array of_stage{
    &axial_strain,           &volumetric_strain,    &axial_stress,
    &radial_stress,          &deviatoric_stress,    &boundary_stress_axial,
    &boundary_stress_radial, &contact_stress_axial, &contact_stress_radial,
    &unbalanced_ratio,       &mean_ring_error,      &worst_ring_error,
    &coordination_number,    &inertial_number,      &boundary_work,
    &stored_energy,          &friction_work,        &damping_work,
    &scaling_work,           &kinetic_energy,       &steps};

} // namespace quantity

/// Title of a column in files: name with unit, as deviatoric_stress_Pa or ring_1_radius_m. `part`:
/// which of several; `end`: of the name, as _low.
std::string title_of(const Quantity& quantity, std::size_t part = 0, const char* end = "");

} // namespace bris
