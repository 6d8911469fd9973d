#pragma once

namespace bris {

// Flow of water through ballast and fines. Water at 20 degrees Celsius.
inline constexpr double water_density = 998.2;    ///< kg/m3
inline constexpr double water_viscosity = 1.0e-3; ///< Pa s
inline constexpr double weight_of_mass = 9.81;    ///< m/s2

/// Hydraulic conductivity (m/s) of grains of size d (m) at porosity n in (0, 1) after Kozeny and
/// Carman: rho g / mu n^3 d^2 / (180 (1 - n)^2). Valid while the Reynolds number of the flow is at
/// most about 1 (`reynolds_number`); for clean ballast it gives metres per second and Reynolds
/// numbers of 1e4 and more, so that filter_velocity must be used.
double kozeny_carman(double porosity, double size);

/// Reynolds number rho q d / mu of a filter velocity q (m/s) between grains of size d (m).
double reynolds_number(double velocity, double size);

/// Filter velocity (m/s) at the hydraulic gradient i >= 0: the solution of Forchheimer's equation
/// i = q / K + b q^2 with K by Kozeny and Carman and the inertial term of Ergun (1952),
/// b = 1.75 (1 - n) / (g n^3 d).
double filter_velocity(double porosity, double size, double gradient);

/// Conductivity (m/s) of ballast with the conductivity kb, whose voids hold fines with kf <= kb up
/// to the void contaminant index VCI (a fraction): kb kf / (kf + VCI (kb - kf)) (Tennakoon,
/// Indraratna et al. 2012).
double fouled_conductivity(double clean, double fines, double contaminant);

} // namespace bris
