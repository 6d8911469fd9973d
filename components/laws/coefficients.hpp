#pragma once

#include "components/law.hpp"
#include "components/material.hpp"

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
        .name = "shear stiffness", .unit = "N/m", .of_material = &Material::shear_stiffness};

/// All coefficients of materials.
inline constexpr std::array of_materials{density,           friction,       normal_damping,
                                         shear_damping,     restitution,    rolling_friction,
                                         twisting_friction, poisson_ratio,  young_modulus,
                                         normal_stiffness,  shear_stiffness};

/// The same coefficient with its lower bound excluded.
constexpr Coefficient above_zero(Coefficient c) {
    c.low_accepted = false;
    return c;
}

} // namespace bris::coefficients
