#pragma once

#include "systems/fields/fouling.hpp"

namespace bris {

/// Moves fines and water by themselves for `duration` (s >= 0), with steps that are stable
/// (migration_step). What leaves one voxel enters the next, as multiples of the units of the
/// fields, so both are conserved to the last bit; water that leaves through the base is counted as
/// drained. No voxel receives more than it can hold, and none gives more than it has.
///
/// Fines: flux per area of -D grad c + w c e_z, where c (kg/m3) is the mass per volume of voids, D
/// the diffusivity, w the speed of pumping and the open area of a face the smaller of the void
/// fractions on its sides. Central differences for D, upwind for w.
///
/// Water: flows down under its weight (unit gradient) at the filter velocity K s^3.5 (Averjanov
/// 1950) with the saturation s above and K the conductivity of the fouled ballast
/// (fouled_conductivity of filter_velocity for the ballast and kozeny_carman for the fines).
void move_fines_and_water(Fouling& fouling, double duration);

/// Largest stable step (s) of the above: half of that at which a voxel would give all it has.
double migration_step(const Fouling& fouling);

/// Conductivity (m/s) of ballast with fines of void contaminant index VCI (a fraction), for the
/// porosity of the ballast without fines.
double conductivity(const FoulingSettings& settings, double porosity, double contaminant);

} // namespace bris
