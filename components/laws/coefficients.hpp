#pragma once

#include "components/law.hpp"
#include "components/material.hpp"

#include <array>
#include <numbers>

namespace bris::coefficients {

// Coefficients of materials, with the ranges that hold for every law. A law that needs a narrower
// range, for example a stiffness above zero, lists the stricter version.

inline constexpr Coefficient density{
    .name = "density", .unit = "kg/m3", .of_material = &Material::density},
    friction{.name = "friction", .unit = "", .of_material = &Material::friction},
    normal_damping{
        .name = "normal damping", .unit = "1/s", .of_material = &Material::normal_damping},
    shear_damping{.name = "shear damping", .unit = "1/s", .of_material = &Material::shear_damping},
    restitution{
        .name = "restitution", .unit = "", .high = 1, .of_material = &Material::restitution},
    rolling_friction{
        .name = "rolling friction", .unit = "", .of_material = &Material::rolling_friction},
    twisting_friction{
        .name = "twisting friction", .unit = "", .of_material = &Material::twisting_friction},
    poisson_ratio{.name = "Poisson's ratio",
                  .unit = "",
                  .low = -1,
                  .high = 0.5,
                  .low_accepted = false,
                  .of_material = &Material::poisson_ratio},
    young_modulus{.name = "Young's modulus", .unit = "Pa", .of_material = &Material::young_modulus},
    normal_stiffness{
        .name = "normal stiffness", .unit = "N/m", .of_material = &Material::normal_stiffness},
    shear_stiffness{
        .name = "shear stiffness", .unit = "N/m", .of_material = &Material::shear_stiffness},
    contact_strength{
        .name = "contact strength", .unit = "Pa", .of_material = &Material::contact_strength},
    cone_half_angle{.name = "half-angle of the cone",
                    .unit = "rad",
                    .high = std::numbers::pi / 2,
                    .high_accepted = false,
                    .of_material = &Material::cone_half_angle},
    edge_radius{.name = "radius of an edge", .unit = "m", .of_material = &Material::edge_radius},
    friction_rise{
        .name = "rise of the friction", .unit = "", .of_material = &Material::friction_rise},
    friction_half_pressure{.name = "pressure of half the rise of the friction",
                           .unit = "Pa",
                           .of_material = &Material::friction_half_pressure},
    friction_half_force{.name = "force of half the rise of the friction",
                        .unit = "N",
                        .of_material = &Material::friction_half_force},
    couple_arm{.name = "arm of the couple", .unit = "m", .of_material = &Material::couple_arm},
    couple_force{
        .name = "force of the couple", .unit = "N", .of_material = &Material::couple_force};

/// All coefficients of materials.
inline constexpr std::array of_materials{density,
                                         friction,
                                         normal_damping,
                                         shear_damping,
                                         restitution,
                                         rolling_friction,
                                         twisting_friction,
                                         poisson_ratio,
                                         young_modulus,
                                         normal_stiffness,
                                         shear_stiffness,
                                         contact_strength,
                                         cone_half_angle,
                                         edge_radius,
                                         friction_rise,
                                         friction_half_pressure,
                                         friction_half_force,
                                         couple_arm,
                                         couple_force};

/// The same coefficient with its lower bound excluded.
constexpr Coefficient above_zero(Coefficient c) {
    c.low_accepted = false;
    return c;
}

} // namespace bris::coefficients
